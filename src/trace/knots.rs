//! Values on straight lines between knots.

/// The value at `at` between knots (place, value) in order of place; beyond the ends theirs, and 0 without knots.
pub(super) fn interpolated(knots: &[[f64; 2]], at: f64) -> f64 {
    let after = knots.partition_point(|knot| knot[0] <= at);
    match (after.checked_sub(1).map(|i| knots[i]), knots.get(after)) {
        (Some([from, before]), Some([to, next])) => {
            before + (next - before) * (at - from) / (to - from)
        }
        (Some([_, value]), None) | (None, Some(&[_, value])) => value,
        (None, None) => 0.0,
    }
}
