//! What of noisy changes is change.
//!
//! A change of many numbers, each told by a few streams, is mostly noise where an effect does little:
//! thousands of small errors look like a large signature, which promises to be found and fits
//! nothing. Drawing each number to zero by its own error alone leaves a third of that noise.
//! Numbers of one part of the measurements, a domain of a channel, tell instead how many of them change and by how
//! much (a spike at zero and a normal slab, their weights by maximum likelihood; Johnstone and
//! Silverman 2004, Ann. Statist. 32:1594-1649):
//!
//! ```text
//! m_k ~ (1 − π) N(0, e_k) + π N(0, e_k + τ²),   d_k = w_k τ² / (τ² + e_k) m_k
//! ```
//!
//! with `w_k` the probability that number `k` changes at all. Few loud numbers among many quiet ones stay
//! as they are, faint ones stay where a whole part shows them, and noise goes.

/// Steps of the estimate.
const STEPS: usize = 40;
/// Smallest share [-] of a part's numbers that may change.
const FEWEST: f64 = 1.0e-4;
/// Log likelihood [-] that changes must gain over noise alone: noise gains as much in one part of fifty.
const GAIN: f64 = 3.0;

/// Leaves of `means`, known with variances `errors`, what is no noise; `parts` are the parts they belong to.
pub(super) fn denoise(means: &mut [f64], errors: &[f64], parts: &[usize]) {
    let last = parts.iter().max().map_or(0, |last| last + 1);
    let mut numbers = vec![Vec::new(); last];
    for (place, part) in parts.iter().enumerate() {
        numbers[*part].push((means[place], errors[place]));
    }
    let slabs: Vec<Option<Slab>> = numbers.iter().map(|own| Slab::of(own)).collect();
    for ((mean, error), part) in means.iter_mut().zip(errors).zip(parts) {
        *mean *= match &slabs[*part] {
            Some(slab) => slab.probability(*mean, *error) * slab.kept(*error),
            None => 0.0,
        };
    }
}

/// How numbers of a part change.
#[derive(Debug, Clone, Copy)]
struct Slab {
    /// Share [-] that does.
    share: f64,
    /// Variance of their changes.
    variance: f64,
}

impl Slab {
    /// By maximum likelihood (expectation and maximisation in turn); none where nothing changes.
    fn of(numbers: &[(f64, f64)]) -> Option<Self> {
        let count = numbers.len() as f64;
        let square: f64 = numbers.iter().map(|(mean, _)| mean * mean).sum();
        let mut slab = Self {
            share: 0.5,
            variance: square / count.max(1.0),
        };
        for _ in 0..STEPS {
            if slab.variance <= 0.0 {
                return None;
            }
            let (mut weights, mut squares) = (0.0, 0.0);
            for &(mean, error) in numbers {
                let kept = slab.kept(error);
                let weight = slab.probability(mean, error);
                weights += weight;
                squares += weight * (kept * mean * kept * mean + kept * error);
            }
            slab = Self {
                share: (weights / count).clamp(FEWEST, 1.0 - FEWEST),
                variance: squares / weights.max(f64::MIN_POSITIVE),
            };
        }
        let gain = numbers.iter().map(|&(mean, error)| slab.gain(mean, error));
        (gain.sum::<f64>() > GAIN).then_some(slab)
    }

    /// Log likelihood [-] of a number over that by noise alone.
    fn gain(&self, mean: f64, error: f64) -> f64 {
        libm::log1p(-self.share) - libm::log1p(-self.probability(mean, error))
    }

    /// Probability [-] that a number changes.
    fn probability(&self, mean: f64, error: f64) -> f64 {
        if error <= 0.0 {
            return if mean == 0.0 { 0.0 } else { 1.0 };
        }
        let total = error + self.variance;
        let log_odds = libm::log(self.share / (1.0 - self.share))
            + 0.5 * (libm::log(error / total) + mean * mean * (1.0 / error - 1.0 / total));
        1.0 / (1.0 + libm::exp(-log_odds))
    }

    /// Share [-] of a changed number that is its change.
    fn kept(&self, error: f64) -> f64 {
        self.variance / (self.variance + error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand_distr::{Distribution, StandardNormal};

    const NUMBERS: usize = 400;

    /// Changes seen with unit error, and what is left of them.
    fn left(changes: &[f64]) -> Vec<f64> {
        let mut rng = Seed(3).rng("test", 0);
        let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut means: Vec<f64> = changes.iter().map(|change| change + draw()).collect();
        denoise(&mut means, &vec![1.0; NUMBERS], &vec![0; NUMBERS]);
        means
    }

    fn square(numbers: impl Iterator<Item = f64>) -> f64 {
        numbers.map(|x| x * x).sum()
    }

    #[test]
    fn of_noise_less_than_a_hundredth_is_left() {
        let left = square(left(&[0.0; NUMBERS]).into_iter());
        assert!(left < 0.01 * NUMBERS as f64, "{left}");
    }

    #[test]
    fn few_loud_numbers_stay_as_they_are_seen() {
        let mut changes = vec![0.0; NUMBERS];
        changes[7] = 30.0;
        changes[200] = -20.0;
        let left = left(&changes);
        assert!((left[7] - 30.0).abs() < 3.0 && (left[200] + 20.0).abs() < 3.0);
        let others = square(left.iter().copied()) - square([left[7], left[200]].into_iter());
        assert!(others < 0.05 * NUMBERS as f64, "{others}");
    }

    #[test]
    fn a_faint_change_of_all_numbers_is_kept_for_the_most_part() {
        let changes: Vec<f64> = (0..NUMBERS)
            .map(|k| if k % 2 == 0 { 1.0 } else { -1.0 })
            .collect();
        let along: f64 = left(&changes)
            .iter()
            .zip(&changes)
            .map(|(a, b)| a * b)
            .sum();
        assert!(along > 0.35 * NUMBERS as f64, "{along}");
    }

    #[test]
    fn what_is_known_without_error_is_left_alone_and_parts_do_not_mix() {
        let mut means = vec![2.0, 0.0, 0.3, -0.2];
        denoise(&mut means, &[0.0, 0.0, 1.0, 1.0], &[0, 0, 1, 1]);
        assert_eq!(means[..2], [2.0, 0.0]);
        assert!(means[2].abs() < 0.2 && means[3].abs() < 0.1, "{means:?}");
    }
}
