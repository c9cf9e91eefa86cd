//! Variances of many cells from few replicates, each drawn toward what cells of its kind have.
//!
//! With variances `s²` of `d` degrees of freedom, of which the true ones scatter as a scaled
//! inverse χ² of `d_0` degrees about `s_0²`, the moderated variance is
//!
//! ```text
//! s̃² = (d_0 s_0² + d s²) / (d_0 + d)
//! ```
//!
//! and a difference over it follows Student's t with `d_0 + d` degrees of freedom. `d_0` and
//! `s_0²` come from mean and variance of `ln s²`.
//!
//! # Reference
//! Smyth (2004), Stat. Appl. Genet. Mol. Biol. 3(1):3, Section 6.2.

use super::cell::{Cell, Domain, Measure};
use crate::statistics::upper_median;
use statrs::function::gamma::digamma;
use std::collections::BTreeMap;

/// Degrees of freedom treated as infinite.
pub(super) const MANY: f64 = 1.0e6;
/// Share of the median variance below which none is taken: it would be an infinity in `ln s²`.
const LEAST: f64 = 1.0e-5;

/// A sample variance and its degrees of freedom [-].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Variance {
    value: f64,
    freedom: f64,
}

/// What cells of one kind have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Prior {
    /// `s_0²`, in the unit of the variances.
    variance: f64,
    /// `d_0` [-], from 0 to [`MANY`].
    freedom: f64,
}

impl Prior {
    /// From sample variances of equal or unequal degrees of freedom.
    fn of(variances: &[Variance]) -> Self {
        let values = || variances.iter().map(|of| of.value);
        let median = upper_median(values()).unwrap_or(0.0);
        let varying = values().filter(|variance| *variance > 0.0);
        // Where most do not vary at all, those that do set the scale.
        let scale = if median > 0.0 {
            Some(median)
        } else {
            varying.reduce(f64::min)
        };
        let Some(scale) = scale else {
            return Self {
                variance: 0.0,
                freedom: 0.0,
            };
        };
        let logs: Vec<(f64, f64)> = variances
            .iter()
            .map(|of| {
                let d = of.freedom;
                let log = libm::log(of.value.max(LEAST * scale));
                (
                    log - digamma(0.5 * d) + libm::log(0.5 * d),
                    trigamma(0.5 * d),
                )
            })
            .collect();
        let count = logs.len() as f64;
        let mean = logs.iter().map(|(e, _)| e / count).sum::<f64>();
        if logs.len() < 2 {
            return Self {
                variance: libm::exp(mean),
                freedom: 0.0,
            };
        }
        let scatter = logs.iter().map(|(e, _)| (e - mean) * (e - mean));
        let expected = logs.iter().map(|(_, noise)| noise / count).sum::<f64>();
        let beyond = scatter.sum::<f64>() / (count - 1.0) - expected;
        if beyond <= trigamma(0.5 * MANY) {
            // All have one variance: the pooled one.
            let freedom: f64 = variances.iter().map(|of| of.freedom).sum();
            let pooled = variances.iter().map(|of| of.value * of.freedom / freedom);
            return Self {
                variance: pooled.sum(),
                freedom: MANY,
            };
        }
        let half = inverse_trigamma(beyond);
        Self {
            variance: libm::exp(mean + digamma(half) - libm::log(half)),
            freedom: 2.0 * half,
        }
    }

    /// The moderated variance, and its degrees of freedom.
    fn moderate(&self, variance: f64, freedom: f64) -> (f64, f64) {
        let total = self.freedom + freedom;
        let moderated = (self.freedom * self.variance + freedom * variance) / total;
        (moderated, total)
    }
}

/// Priors of all kinds of cells. Of one kind are cells of a domain that are counted alike: their
/// variances over their sizes squared are comparable.
pub(super) struct Priors(BTreeMap<Kind, Prior>);

/// A kind of cells.
pub(super) type Kind = (Domain, Measure);

impl Priors {
    /// From cells with their variances, over their sizes squared, and degrees of freedom.
    pub fn of<'c>(variances: impl Iterator<Item = (&'c Cell, f64, f64)>) -> Self {
        let mut kinds = BTreeMap::<_, Vec<Variance>>::new();
        for (cell, variance, freedom) in variances {
            kinds.entry(kind(cell)).or_default().push(Variance {
                value: variance,
                freedom,
            });
        }
        let prior = |(kind, variances): (_, Vec<_>)| (kind, Prior::of(&variances));
        Self(kinds.into_iter().map(prior).collect())
    }

    /// A cell's moderated variance over its size squared, and its degrees of freedom.
    pub fn moderate(&self, cell: &Cell, variance: f64, freedom: f64) -> (f64, f64) {
        let prior = self.0.get(&kind(cell));
        prior.map_or((variance, freedom), |prior| {
            prior.moderate(variance, freedom)
        })
    }
}

/// The kind of a cell.
pub(super) fn kind(cell: &Cell) -> Kind {
    (cell.domain(), cell.statistic.measure())
}

/// Derivative of the digamma function, of a positive argument: recurrence up to 8, then the
/// asymptotic series (Abramowitz and Stegun 6.4.6, 6.4.12).
fn trigamma(x: f64) -> f64 {
    let (mut x, mut sum) = (x, 0.0);
    while x < 8.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    let series = 1.0 / 6.0 - r * (1.0 / 30.0 - r * (1.0 / 42.0 - r / 30.0));
    sum + (1.0 + 0.5 / x + r * series) / x
}

/// Inverse of [`trigamma`] by Newton's iteration on its reciprocal, which is convex (Smyth 2004,
/// appendix).
fn inverse_trigamma(y: f64) -> f64 {
    let derivative = |x: f64| {
        let step = 1.0e-4 * x;
        (trigamma(x + step) - trigamma(x - step)) / (2.0 * step)
    };
    let mut x = 0.5 + 1.0 / y;
    for _ in 0..50 {
        let value = trigamma(x);
        let step = value * (1.0 - value / y) / derivative(x);
        x += step;
        if step.abs() < 1.0e-10 * x {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand_distr::{ChiSquared, Distribution};
    use std::f64::consts::PI;

    #[test]
    fn trigamma_of_one_half_and_one_are_the_known_ones_and_its_inverse_gives_them_back() {
        assert!((trigamma(0.5) - PI * PI / 2.0).abs() < 1e-9);
        assert!((trigamma(1.0) - PI * PI / 6.0).abs() < 1e-9);
        for x in [0.3, 1.0, 4.0, 60.0] {
            assert!((inverse_trigamma(trigamma(x)) / x - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_prior_of_made_up_variances_is_the_one_they_were_drawn_from() {
        let mut rng = Seed(3).rng("moderation", 0);
        let chi =
            |freedom: f64, rng: &mut _| ChiSquared::new(freedom).unwrap().sample(rng) / freedom;
        // 4 degrees of freedom each, true variances about 2 with 6 degrees.
        let variances: Vec<Variance> = (0..4000)
            .map(|_| Variance {
                value: 2.0 / chi(6.0, &mut rng) * chi(4.0, &mut rng),
                freedom: 4.0,
            })
            .collect();
        let prior = Prior::of(&variances);
        // The freedom's error is about 1.5 times its share of 4000 trials.
        assert!((prior.freedom / 6.0 - 1.0).abs() < 0.15, "{prior:?}");
        assert!((prior.variance / 2.0 - 1.0).abs() < 0.05, "{prior:?}");
    }

    #[test]
    fn cells_of_one_variance_share_it_and_a_single_cell_keeps_its_own() {
        let variance = |value| Variance {
            value,
            freedom: 5.0,
        };
        let equal = [0.9, 1.1, 1.0, 1.05].map(variance);
        let (moderated, freedom) = Prior::of(&equal).moderate(3.0, 5.0);
        assert!(
            freedom >= MANY && (moderated - 1.0).abs() < 0.2,
            "{moderated}"
        );
        let (own, freedom) = Prior::of(&[variance(0.4)]).moderate(0.4, 5.0);
        assert!((own - 0.4).abs() < 1e-12 && freedom == 5.0);
    }
}
