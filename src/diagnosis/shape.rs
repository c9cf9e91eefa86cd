//! The change that an effect makes, as a function of its strength.
//!
//! Per number a monotone cubic through zero at the neutral strength and the levels simulated
//! (Fritsch and Carlson 1980, SIAM J. Numer. Anal. 17:238-246); straight beyond the last one; odd
//! on a side without levels.

/// What an effect does to the whitened statistics of one condition.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    knots: Vec<Knot>,
    /// Numbers.
    length: usize,
}

/// A strength simulated.
#[derive(Debug, Clone)]
pub(super) struct Knot {
    /// Its strength.
    pub at: f64,
    /// Change of each number.
    pub value: Vec<f64>,
    /// Slope of each number, per unit.
    pub slope: Vec<f64>,
    /// Variance of each change.
    pub error: Vec<f64>,
    /// How many runs of it have as much variance as one [-]: as many as were simulated where the motion is the same,
    /// and noise that an effect adds is its own in each; none where both sides have all of the scatter.
    pub streams: f64,
}

impl Knot {
    /// Its slope follows from its neighbours.
    pub fn new(at: f64, (value, error): (Vec<f64>, Vec<f64>), streams: f64) -> Self {
        Self {
            streams,
            slope: vec![0.0; value.len()],
            at,
            value,
            error,
        }
    }
}

impl Shape {
    /// Through the levels; without any it is zero everywhere.
    pub fn new(length: usize, levels: Vec<Knot>) -> Self {
        let mut knots = levels;
        knots.retain(|knot| knot.at != 0.0);
        if !knots.is_empty() {
            knots.push(Knot {
                at: 0.0,
                value: vec![0.0; length],
                slope: vec![0.0; length],
                error: vec![0.0; length],
                streams: 0.0,
            });
            for sign in [-1.0, 1.0] {
                mirror(&mut knots, sign);
            }
            knots.sort_by(|a, b| a.at.total_cmp(&b.at));
            knots.dedup_by(|a, b| a.at == b.at);
            slopes(&mut knots);
        }
        Self { knots, length }
    }

    /// Adds the change at strength `x` to `sums`, times `factor`.
    pub fn add(&self, x: f64, factor: f64, sums: &mut [f64]) {
        let Some((a, b, t)) = self.interval(x) else {
            return;
        };
        if !(0.0..=1.0).contains(&t) {
            let end = if t < 0.0 { a } else { b };
            let beyond = x - end.at;
            for ((sum, value), slope) in sums.iter_mut().zip(&end.value).zip(&end.slope) {
                *sum += factor * (value + slope * beyond);
            }
            return;
        }
        let width = b.at - a.at;
        let (t2, t3) = (t * t, t * t * t);
        let of = [
            2.0 * t3 - 3.0 * t2 + 1.0,
            3.0 * t2 - 2.0 * t3,
            width * (t3 - 2.0 * t2 + t),
            width * (t3 - t2),
        ];
        for (place, sum) in sums.iter_mut().enumerate() {
            let change = of[0] * a.value[place]
                + of[1] * b.value[place]
                + of[2] * a.slope[place]
                + of[3] * b.slope[place];
            *sum += factor * change;
        }
    }

    /// The change at `strength`.
    pub fn at(&self, strength: f64) -> Vec<f64> {
        let mut change = vec![0.0; self.length];
        self.add(strength, 1.0, &mut change);
        change
    }

    /// Adds the variance of the change at strength `x` to `sums`.
    pub fn add_error(&self, x: f64, sums: &mut [f64]) {
        self.add_variance(x, |_| 1.0, sums);
    }

    /// Adds the variance that the change itself has in the mean of so many runs.
    pub fn add_scatter(&self, x: f64, runs: usize, sums: &mut [f64]) {
        self.add_variance(x, |knot| knot.streams / runs as f64, sums);
    }

    fn add_variance(&self, x: f64, factor: impl Fn(&Knot) -> f64, sums: &mut [f64]) {
        let Some((a, b, t)) = self.interval(x) else {
            return;
        };
        let beyond = |end: &Knot| if end.at == 0.0 { 0.0 } else { x / end.at };
        let [of_a, of_b] = match t {
            t if t < 0.0 => [beyond(a), 0.0],
            t if t > 1.0 => [0.0, beyond(b)],
            t => [1.0 - t, t],
        };
        for (place, sum) in sums.iter_mut().enumerate() {
            *sum += of_a * of_a * factor(a) * a.error[place];
            *sum += of_b * of_b * factor(b) * b.error[place];
        }
    }

    /// The knots about `x` and its place between them, beyond `[0, 1]` outside of them.
    fn interval(&self, x: f64) -> Option<(&Knot, &Knot, f64)> {
        let after = self.knots.iter().position(|knot| knot.at >= x);
        let last = self.knots.len().checked_sub(1)?;
        let b = after.unwrap_or(last).max(1);
        let (a, b) = (&self.knots[b - 1], &self.knots[b]);
        Some((a, b, (x - a.at) / (b.at - a.at)))
    }
}

/// Where one side of the neutral strength has no knots, those of the other with their signs turned.
fn mirror(knots: &mut Vec<Knot>, sign: f64) {
    if knots.iter().any(|knot| sign * knot.at > 0.0) {
        return;
    }
    let turned: Vec<Knot> = knots
        .iter()
        .filter(|knot| knot.at != 0.0)
        .map(|knot| Knot {
            at: -knot.at,
            value: knot.value.iter().map(|value| -value).collect(),
            slope: knot.slope.clone(),
            error: knot.error.clone(),
            streams: knot.streams,
        })
        .collect();
    knots.extend(turned);
}

/// Harmonic means of the neighbouring secants, zero where those differ in sign; at the ends the
/// secant itself.
fn slopes(knots: &mut [Knot]) {
    let secant = |knots: &[Knot], left: usize, place: usize| {
        let (a, b) = (&knots[left], &knots[left + 1]);
        (b.value[place] - a.value[place]) / (b.at - a.at)
    };
    let last = knots.len() - 1;
    for number in 0..=last {
        for place in 0..knots[number].value.len() {
            let slope = if number == 0 {
                secant(knots, 0, place)
            } else if number == last {
                secant(knots, last - 1, place)
            } else {
                let [before, after] = [number - 1, number].map(|left| secant(knots, left, place));
                let [h0, h1] = [number - 1, number].map(|left| knots[left + 1].at - knots[left].at);
                let weights = [2.0 * h1 + h0, h1 + 2.0 * h0];
                match before * after > 0.0 {
                    true => (weights[0] + weights[1]) / (weights[0] / before + weights[1] / after),
                    false => 0.0,
                }
            };
            knots[number].slope[place] = slope;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(at: f64, value: f64) -> Knot {
        Knot {
            at,
            value: vec![value],
            slope: vec![0.0],
            error: vec![0.01],
            streams: 4.0,
        }
    }

    #[test]
    fn a_change_is_nil_at_neutral_met_at_the_levels_monotone_between_and_straight_beyond() {
        let levels = vec![knot(1.0, 1.0), knot(2.0, 4.0), knot(4.0, 5.0)];
        let shape = Shape::new(1, levels);
        for (strength, change) in [(0.0, 0.0), (1.0, 1.0), (2.0, 4.0), (4.0, 5.0)] {
            assert!((shape.at(strength)[0] - change).abs() < 1e-12);
        }
        let steps: Vec<f64> = (0..=80).map(|i| shape.at(0.05 * f64::from(i))[0]).collect();
        assert!(steps.windows(2).all(|pair| pair[1] >= pair[0]));
        // The last secant is 0.5 per unit; the other side is odd.
        assert!((shape.at(6.0)[0] - 6.0).abs() < 1e-12);
        assert!((shape.at(-2.0)[0] + 4.0).abs() < 1e-12);
    }

    #[test]
    fn the_error_of_a_change_grows_from_nil_through_the_levels_and_on_beyond() {
        let shape = Shape::new(1, vec![knot(1.0, 1.0), knot(2.0, 4.0)]);
        let error = |strength| {
            let mut sums = vec![0.0];
            shape.add_error(strength, &mut sums);
            sums[0]
        };
        assert_eq!([error(0.0), error(1.0), error(4.0)], [0.0, 0.01, 0.04]);
    }
}
