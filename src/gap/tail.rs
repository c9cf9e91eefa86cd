//! Empirical tail of the replicates' z-scores.
//!
//! Student's t is exact for normal statistics. Real ones have heavier tails: one more stone under a run
//! changes many cells at once. Each replicate is therefore compared with the others of its condition as if it
//! had been measured (leave-one-out), a scaled t is fitted to the z-scores of all cells of a kind, and a
//! measured run's z is evaluated with it. For normal statistics this is Student's t.

use statrs::distribution::{Continuous, ContinuousCDF, StudentsT};

/// Degrees of freedom tried [-].
const FREEDOMS: [f64; 10] = [
    2.0,
    2.5,
    3.0,
    4.0,
    5.0,
    7.0,
    10.0,
    15.0,
    30.0,
    NORMAL_FREEDOM,
];
/// Degrees of freedom treated as the normal distribution [-].
const NORMAL_FREEDOM: f64 = 1.0e6;
/// Least number of scores to fit a tail.
const FEWEST: usize = 100;
/// Least scale [-]: many cells that hardly vary would let it vanish.
const LEAST: f64 = 0.3;
/// Iterations until the scale converges.
const STEPS: usize = 60;

/// A scaled Student's t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tail {
    scale: f64,
    freedom: f64,
}

impl Tail {
    /// The normal distribution.
    pub const NORMAL: Self = Self {
        scale: 1.0,
        freedom: NORMAL_FREEDOM,
    };

    /// The maximum-likelihood fit to these z; `None` where they are too few.
    pub fn of(scores: &[f64]) -> Option<Self> {
        if scores.len() < FEWEST {
            return None;
        }
        let fits = FREEDOMS.map(|freedom| {
            let scale = scale(scores, freedom).max(LEAST);
            let tail = Self { scale, freedom };
            (tail, tail.log_likelihood(scores))
        });
        let best = fits.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(tail, _)| tail)
    }

    fn log_likelihood(&self, scores: &[f64]) -> f64 {
        let Some(student) = student(self.freedom) else {
            return f64::NEG_INFINITY;
        };
        let logs = scores
            .iter()
            .map(|score| student.ln_pdf(score / self.scale));
        logs.sum::<f64>() - scores.len() as f64 * libm::log(self.scale)
    }

    /// Probability beyond `z`, which would itself have this many degrees of freedom.
    pub fn beyond(&self, z: f64, freedom: f64) -> f64 {
        student(self.freedom.min(freedom)).map_or(1.0, |student| student.sf(z / self.scale))
    }
}

fn student(freedom: f64) -> Option<StudentsT> {
    StudentsT::new(0.0, 1.0, freedom).ok()
}

/// The likeliest scale of Student's t for a number of degrees of freedom: each score weighs less the
/// farther out it lies (the expectation-maximisation of Lange, Little and Taylor 1989, J. Am. Stat.
/// Assoc. 84:881-896).
pub(crate) fn scale(scores: &[f64], freedom: f64) -> f64 {
    let count = scores.len() as f64;
    let mut square = scores.iter().map(|w| w * w).sum::<f64>() / count;
    for _ in 0..STEPS {
        let weighted = scores.iter().map(|w| {
            let weight = (freedom + 1.0) / (freedom + w * w / square);
            weight * w * w
        });
        square = (weighted.sum::<f64>() / count).max(f64::MIN_POSITIVE);
    }
    libm::sqrt(square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand_distr::{Distribution, StudentT};

    #[test]
    fn a_heavy_tail_is_found_and_normal_scores_stay_normal() {
        let drawn = |freedom: f64| -> Vec<f64> {
            let mut rng = Seed(2).rng("tail", 0);
            let student = StudentT::new(freedom).unwrap();
            (0..4000).map(|_| 0.7 * student.sample(&mut rng)).collect()
        };
        let heavy = Tail::of(&drawn(3.0)).unwrap();
        assert_eq!(heavy.freedom, 3.0);
        assert!((heavy.scale - 0.7).abs() < 0.03, "{heavy:?}");
        let light = Tail::of(&drawn(1.0e5)).unwrap();
        assert!(light.freedom >= 30.0, "{light:?}");
    }

    #[test]
    fn too_few_scores_fit_no_tail_and_student_s_is_used() {
        assert_eq!(Tail::of(&[1.0; 20]), None);
        let tail = Tail::NORMAL;
        // The table's 97.5 % quantile of Student's t with 7 degrees.
        assert!((tail.beyond(2.364_624, 7.0) - 0.025).abs() < 1e-6);
        assert!((tail.beyond(-2.364_624, 7.0) - 0.975).abs() < 1e-6);
    }
}
