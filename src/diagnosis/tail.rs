//! How far a number may lie from what is predicted of it: Student's t, its degrees of freedom those of its
//! channel and domain.
//!
//! Most means of forces scatter nearly as normal numbers do, levels of vibration on slate with tails far
//! heavier. One tail for all would be the heaviest: an effect that shows in a few numbers by ten
//! deviations each would then tell hardly more than one that shows by three. What replicates cannot show,
//! models are wrong in; so no tail is taken for a normal one. Nor is one taken for heavier than the common one,
//! though levels on slate have three degrees of freedom: by such tails a recalibration that starts far off holds
//! the resonance, which tells it where to go, for numbers that went astray, and rests.

use super::calibration::FREEDOM;
use crate::gap::student_scale;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use statrs::function::gamma::ln_gamma;

/// Degrees of freedom that a tail may have [-].
const FREEDOMS: [f64; 3] = [FREEDOM, 9.0, 14.0];
/// Deviation of the logarithm of the degrees of freedom from the common ones' [-], where few numbers tell.
const KNOWN: f64 = 0.4;

/// Score [-] beyond which it does not matter how far a number lies.
const OUTLYING: f64 = 8.0;
/// Steps in which a scale settles.
const STEPS: usize = 60;

/// Student's t of one deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tail {
    /// Degrees of freedom [-].
    pub freedom: f64,
    /// Log density in the middle [-].
    middle: f64,
}

impl Tail {
    pub fn new(freedom: f64) -> Self {
        let area = ln_gamma(0.5 * (freedom + 1.0)) - ln_gamma(0.5 * freedom);
        Self {
            freedom,
            middle: area - 0.5 * libm::log(freedom * std::f64::consts::PI),
        }
    }

    /// The likeliest of these scores, whatever their scale; one that went astray tells no more than one far out.
    pub fn of(scores: &[f64]) -> Self {
        let scale = student_scale(scores, FREEDOM).max(f64::MIN_POSITIVE);
        let scores = scores
            .iter()
            .map(|z| (z / scale).clamp(-OUTLYING, OUTLYING));
        let scores: &[f64] = &scores.collect::<Vec<_>>();
        let tails = FREEDOMS.map(Self::new);
        let likelihood = |tail: &Self| {
            let scale = student_scale(scores, tail.freedom).max(f64::MIN_POSITIVE);
            let logs = scores.iter().map(|z| tail.log_density(z / scale));
            let apart = libm::log(tail.freedom / FREEDOM) / KNOWN;
            logs.sum::<f64>() - scores.len() as f64 * libm::log(scale) - 0.5 * apart * apart
        };
        let fits = tails.into_iter().map(|tail| (likelihood(&tail), tail));
        let best = fits.max_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(Self::new(FREEDOM), |(_, tail)| tail)
    }

    /// Log density at so many deviations [-].
    pub fn log_density(&self, z: f64) -> f64 {
        self.middle - 0.5 * (self.freedom + 1.0) * libm::log1p(z * z / self.freedom)
    }

    /// What a number tells that departs so far, of this variance: its inverse, less the farther it lies.
    pub fn precision(&self, departure: f64, variance: f64) -> f64 {
        (self.freedom + 1.0) / (self.freedom * variance + departure * departure)
    }

    /// The normal score of what is as improbable.
    pub fn normal_score(&self, z: f64) -> f64 {
        let tails = StudentsT::new(0.0, 1.0, self.freedom).expect("degrees of freedom");
        let beyond = tails.sf(z.abs()).max(f64::MIN_POSITIVE);
        let score = -Normal::standard().inverse_cdf(beyond);
        score.copysign(z)
    }
}

/// Square of the common scale [-] of scores, each with its own tail: of what normal numbers is their mean square, hardly
/// moved by those far out.
pub(super) fn square_of_scale(scores: &[f64], tails: &[Tail]) -> f64 {
    let count = scores.len().max(1) as f64;
    let mut square = scores.iter().map(|z| z * z).sum::<f64>() / count;
    for _ in 0..STEPS {
        let numbers = scores.iter().zip(tails);
        let weighted = numbers.map(|(z, tail)| z * z * square * tail.precision(*z, square));
        square = (weighted.sum::<f64>() / count).max(f64::MIN_POSITIVE);
    }
    square
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand_distr::{Distribution, StandardNormal, StudentT};

    fn drawn(count: usize, freedom: Option<f64>) -> Vec<f64> {
        let mut rng = Seed(3).rng("tail", 0);
        let student = freedom.map(|freedom| StudentT::new(freedom).unwrap());
        let mut draw = || match &student {
            Some(student) => student.sample(&mut rng),
            None => StandardNormal.sample(&mut rng),
        };
        (0..count).map(|_| 7.0 * draw()).collect()
    }

    #[test]
    fn a_tail_is_as_heavy_as_scores_show_and_never_lighter_than_a_model_may_be_wrong() {
        assert_eq!(Tail::of(&drawn(5000, Some(3.0))).freedom, FREEDOM);
        assert_eq!(Tail::of(&drawn(5000, Some(6.0))).freedom, FREEDOM);
        let mut normal = drawn(5000, None);
        normal[7] = 1.0e6;
        assert_eq!(Tail::of(&normal).freedom, 14.0);
    }

    #[test]
    fn few_scores_leave_the_common_tail() {
        let near = Tail::of(&drawn(20, None)).freedom;
        assert!((FREEDOM..=9.0).contains(&near), "{near}");
        assert_eq!(Tail::of(&[]).freedom, FREEDOM);
    }

    #[test]
    fn densities_are_those_of_students_t_and_scores_keep_their_sign() {
        use statrs::distribution::Continuous;
        let tail = Tail::new(9.0);
        let known = StudentsT::new(0.0, 1.0, 9.0).unwrap();
        for z in [0.0, 1.3, -4.0] {
            assert!((tail.log_density(z) - known.ln_pdf(z)).abs() < 1e-12);
        }
        assert!((tail.normal_score(-2.0) + tail.normal_score(2.0)).abs() < 1e-12);
        assert!(tail.normal_score(5.0) < 5.0);
    }
}
