//! Many samples in few columns, without losing a spike.

/// Smallest and largest finite sample of each of `columns` equal stretches; `None` where a stretch
/// has none.
///
/// Every finite sample lies within its column's bounds, so drawing the bounds hides nothing.
pub fn envelope(samples: &[f64], columns: usize) -> Vec<Option<[f64; 2]>> {
    let columns = columns.clamp(1, samples.len().max(1));
    (0..columns)
        .map(|column| {
            let start = column * samples.len() / columns;
            let end = (column + 1) * samples.len() / columns;
            bounds(&samples[start..end])
        })
        .collect()
}

/// Smallest and largest finite value; `None` without any.
pub fn bounds(values: &[f64]) -> Option<[f64; 2]> {
    values
        .iter()
        .filter(|value| value.is_finite())
        .fold(None, |bounds, &value| match bounds {
            None => Some([value, value]),
            Some([low, high]) => Some([value.min(low), value.max(high)]),
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_column_count_hides_a_spike(
            length in 1..5000usize, columns in 0..1500usize, place in 0.0..1.0f64, spike in -9.0..9.0f64,
        ) {
            let mut samples = vec![0.0; length];
            let index = (place * length as f64) as usize;
            samples[index] = spike;
            let columns = envelope(&samples, columns);
            let seen = columns.iter().flatten().any(|[low, high]| *low == spike || *high == spike);
            prop_assert!(seen);
        }
    }

    #[test]
    fn a_stretch_of_nan_is_a_gap_and_nothing_else() {
        let samples = [1.0, 2.0, f64::NAN, f64::INFINITY, 3.0, f64::NAN];
        let expected = [Some([1.0, 2.0]), None, Some([3.0, 3.0])];
        assert_eq!(envelope(&samples, 3), expected);
        assert_eq!(envelope(&[], 3), [None]);
    }
}
