//! What is known of a magnitude before any measurement.

use super::Seat;
use libm::{erf, exp, log, sqrt};
use rand::Rng;
use rand_distr::{Distribution, LogNormal, Normal, Uniform};
use serde::Serialize;
use std::f64::consts::{PI, SQRT_2};
use std::fmt;

/// A distribution of magnitudes, in their unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Prior {
    /// About a mean, either way.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// From 0 up, the likelier the smaller.
    HalfNormal {
        /// Root of the mean square.
        scale: f64,
    },
    /// Above 0, its logarithm normal.
    LogNormal {
        /// Median.
        median: f64,
        /// Factor [-] of one standard deviation.
        factor: f64,
    },
    /// Alike between two ends.
    Uniform {
        /// Least.
        low: f64,
        /// Largest.
        high: f64,
    },
}

impl Prior {
    /// About 0, either way.
    pub(super) const fn normal(sd: f64) -> Self {
        Self::Normal { mean: 0.0, sd }
    }

    /// From 0 up.
    pub(super) const fn half_normal(scale: f64) -> Self {
        Self::HalfNormal { scale }
    }

    /// Above 0.
    pub(super) const fn log_normal(median: f64, factor: f64) -> Self {
        Self::LogNormal { median, factor }
    }
}

impl fmt::Display for Prior {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Normal { mean, sd } => write!(f, "normal, {mean} ± {sd}"),
            Self::HalfNormal { scale } => write!(f, "half-normal, root mean square {scale}"),
            Self::LogNormal { median, factor } => {
                write!(
                    f,
                    "log-normal, median {median}, geometric standard deviation {factor}"
                )
            }
            Self::Uniform { low, high } => write!(f, "uniform, {low} to {high}"),
        }
    }
}

impl Prior {
    /// Density [1/unit] at `x`, on the whole line.
    fn density(self, x: f64) -> f64 {
        let bell = |z: f64| exp(-0.5 * z * z) / sqrt(2.0 * PI);
        match self {
            Self::Normal { mean, sd } => bell((x - mean) / sd) / sd,
            Self::HalfNormal { scale } if x >= 0.0 => 2.0 * bell(x / scale) / scale,
            Self::LogNormal { median, factor } if x > 0.0 => {
                bell(log(x / median) / log(factor)) / (x * log(factor))
            }
            Self::Uniform { low, high } if (low..=high).contains(&x) => 1.0 / (high - low),
            _ => 0.0,
        }
    }

    /// Probability [-] below `x`.
    fn below(self, x: f64) -> f64 {
        let normal = |z: f64| 0.5 + 0.5 * erf(z / SQRT_2);
        match self {
            Self::Normal { mean, sd } => normal((x - mean) / sd),
            Self::HalfNormal { scale } => erf(x.max(0.0) / scale / SQRT_2),
            Self::LogNormal { .. } if x <= 0.0 => 0.0,
            Self::LogNormal { median, factor } => normal(log(x / median) / log(factor)),
            Self::Uniform { low, high } => ((x - low) / (high - low)).clamp(0.0, 1.0),
        }
    }

    fn sample(self, rng: &mut impl Rng) -> f64 {
        let sound = "the catalogue's priors are distributions";
        match self {
            Self::Normal { mean, sd } => Normal::new(mean, sd).expect(sound).sample(rng),
            Self::HalfNormal { scale } => Normal::new(0.0, scale).expect(sound).sample(rng).abs(),
            Self::LogNormal { median, factor } => LogNormal::new(log(median), log(factor))
                .expect(sound)
                .sample(rng),
            Self::Uniform { low, high } => Uniform::new(low, high).expect(sound).sample(rng),
        }
    }
}

impl Seat {
    /// Density [1/unit] of the prior at `magnitude`, 0 outside the range allowed.
    pub fn density(&self, magnitude: f64) -> f64 {
        let [low, high] = self.range;
        if !(low..=high).contains(&magnitude) {
            return 0.0;
        }
        self.prior.density(magnitude) / (self.prior.below(high) - self.prior.below(low))
    }

    /// Draws a magnitude from the prior, within the range allowed.
    pub fn draw(&self, rng: &mut impl Rng) -> f64 {
        let [low, high] = self.range;
        loop {
            let magnitude = self.prior.sample(rng);
            if (low..=high).contains(&magnitude) {
                return magnitude;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::catalogue;
    use crate::quantity::Seed;

    #[test]
    fn every_prior_is_in_its_range_and_reaches_the_typical_level() {
        for effect in catalogue() {
            for seat in effect.seats {
                let [low, high] = seat.range;
                let inside = seat.prior.below(high) - seat.prior.below(low);
                assert!(inside > 0.5, "{} {}: {inside}", effect.name, seat.channel);
                for level in seat.levels {
                    assert!(seat.density(level) > 0.0, "{}: {level}", effect.name);
                }
            }
        }
    }

    #[test]
    fn draws_fall_below_each_level_as_often_as_the_density_says() {
        let mut rng = Seed(1).rng("prior", 0);
        for effect in catalogue() {
            for seat in effect.seats {
                let draws: Vec<f64> = (0..400).map(|_| seat.draw(&mut rng)).collect();
                let base = seat.prior.below(seat.range[0]);
                let mass = seat.prior.below(seat.range[1]) - base;
                for level in seat.levels {
                    let found = draws.iter().filter(|draw| **draw < level).count() as f64 / 400.0;
                    let expected = (seat.prior.below(level) - base) / mass;
                    // Five standard errors of a share of 400, the largest being 0.025.
                    let error = 5.0 * (expected * (1.0 - expected) / 400.0).sqrt() + 1.0 / 400.0;
                    assert!((found - expected).abs() < error, "{}: {level}", effect.name);
                }
            }
        }
    }

    #[test]
    fn a_density_integrates_to_the_probability_below() {
        for effect in catalogue() {
            for seat in effect.seats {
                let [from, _, to] = seat.levels;
                let steps = 20_000;
                let width = (to - from) / f64::from(steps);
                let sum: f64 = (0..steps)
                    .map(|i| seat.prior.density(from + (f64::from(i) + 0.5) * width) * width)
                    .sum();
                let expected = seat.prior.below(to) - seat.prior.below(from);
                // The midpoint rule on 20 000 intervals of a smooth bell.
                assert!(
                    (sum - expected).abs() < 1e-4,
                    "{}: {sum} {expected}",
                    effect.name
                );
            }
        }
    }
}
