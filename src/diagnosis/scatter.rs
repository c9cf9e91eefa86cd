//! How runs that had no part in a whitening lie under it.
//!
//! Replicates are left out by turns and whitened by the others, as a measured run is. Two things are
//! learned from them.
//!
//! Their spread. A wheel that slips off a joint's edge once shows in some numbers of one run, by
//! tens of deviations, and a mean square would be that of this run. The spread is the scale of the
//! Student's t that the fits use, which a few outlying numbers hardly move.
//!
//! How many numbers count. Replicates whiten many statistics in part only, and a run may be louder
//! than others in all numbers alike; what is left correlated would be counted as often as it shows.
//! Were the numbers independent, the log density of a left-out run had the sum of their variances.
//! By as much as it scatters more, log likelihoods are scaled down (a magnitude adjustment of a
//! composite likelihood, as by Pauli, Racugno and Ventura 2011, Stat. Sinica 21:149-164).
//!
//! Two other measures were tried on slate. The scatter of mean squares leaves 0 to 30 of 450 numbers,
//! since one outlying number makes it. The scatter along the signatures of parameters and effects,
//! which is all that a fit sees of noise, leaves 350; but then what an emulator lacks, which is
//! correlated too, counts as often as it shows, and a rig with nothing but other parameters was
//! called unknown by 290. Log densities leave 3 to 70.

use super::calibration::FREEDOM;
use super::product::add;
use crate::gap::{moments, student_scale};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

/// Score [-] beyond which a number counts no more in a mean square: one cell is no misfit.
const OUTLYING: f64 = 5.0;

/// Left-out runs of one condition.
#[derive(Debug)]
pub(super) struct Scatter {
    /// Square of the scale [-].
    pub variance: f64,
    /// Share [-] of the numbers that are independent.
    pub independent: f64,
    numbers: usize,
    /// The runs, whitened; none where there were too few to leave any out.
    runs: Vec<Vec<f64>>,
}

impl Scatter {
    /// Of these runs of so many numbers, whitened without them.
    pub fn of(runs: Vec<Vec<f64>>, numbers: usize) -> Self {
        let (variance, independent) = match runs.is_empty() {
            // Nothing tells it: all of a run's numbers are as good as two.
            true => (1.0, (2.0 / numbers as f64).min(1.0)),
            false => {
                let numbers: Vec<f64> = runs.iter().flatten().copied().collect();
                let scale = student_scale(&numbers, FREEDOM).max(f64::MIN_POSITIVE);
                let variance = scale * scale;
                (variance, independent(&runs, variance))
            }
        };
        Self {
            variance,
            independent,
            numbers,
            runs,
        }
    }

    /// A departure [-] over the variance's root as the mean of so many runs has it, times the root
    /// of their number: that of some of these runs.
    pub fn drawn(&self, together: usize, rng: &mut impl Rng) -> Vec<f64> {
        let mut sum = vec![0.0; self.numbers];
        if self.runs.is_empty() {
            return sum.iter().map(|_| StandardNormal.sample(rng)).collect();
        }
        let weight = 1.0 / libm::sqrt(together as f64 * self.variance);
        for _ in 0..together {
            let run = &self.runs[rng.random_range(0..self.runs.len())];
            add(&mut sum, weight, run);
        }
        sum
    }

    /// Mean square [-] over the variance, outlying numbers cut, of the mean of so many runs, times
    /// their number; and its deviation.
    pub fn squares(&self, together: usize) -> [f64; 2] {
        let count = self.runs.len();
        if count <= together {
            return [1.0, 1.0];
        }
        let squares: Vec<f64> = (0..count)
            .map(|first| {
                let runs = (0..together).map(|next| &self.runs[(first + next) % count]);
                let mut sum = vec![0.0; self.runs[0].len()];
                let weight = 1.0 / libm::sqrt(together as f64 * self.variance);
                runs.for_each(|run| add(&mut sum, weight, run));
                mean_square(sum.into_iter())
            })
            .collect();
        let [mean, variance] = moments(&squares);
        [mean.max(f64::MIN_POSITIVE), libm::sqrt(variance)]
    }
}

/// Mean square of scores, outlying ones cut.
pub(super) fn mean_square(scores: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for score in scores {
        let cut = score.clamp(-OUTLYING, OUTLYING);
        sum += cut * cut;
        count += 1.0;
    }
    sum / f64::max(count, 1.0)
}

/// Variance that a run's log density would have were its numbers independent, over that which it
/// has; at most 1.
fn independent(runs: &[Vec<f64>], variance: f64) -> f64 {
    let log = |z: f64| libm::log1p(z * z / (FREEDOM * variance));
    let of_runs = runs.iter().map(|run| run.iter().map(|z| log(*z)).sum());
    let [_, together] = moments(&of_runs.collect::<Vec<f64>>());
    let alone = (0..runs[0].len()).map(|place| {
        let of_number = runs.iter().map(|run| log(run[place]));
        let [_, variance] = moments(&of_number.collect::<Vec<f64>>());
        variance
    });
    let alone: f64 = alone.sum();
    if together <= alone {
        1.0
    } else {
        alone / together
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand_distr::{Distribution, StandardNormal};

    const NUMBERS: usize = 200;

    /// Runs of independent normal numbers, each run louder or less by a factor of this spread.
    fn runs(count: usize, loudness: f64) -> Vec<Vec<f64>> {
        let mut rng = Seed(5).rng("scatter", 0);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
        (0..count)
            .map(|_| {
                let factor = libm::exp(loudness * normal());
                (0..NUMBERS).map(|_| factor * normal()).collect()
            })
            .collect()
    }

    #[test]
    fn independent_numbers_all_count_and_one_that_went_astray_changes_neither_spread_nor_count() {
        let mut runs = runs(80, 0.0);
        let clean = Scatter::of(runs.clone(), NUMBERS);
        assert!(clean.independent > 0.7, "{}", clean.independent);
        runs[3][7] = 1.0e6;
        let astray = Scatter::of(runs, NUMBERS);
        assert!((astray.variance / clean.variance - 1.0).abs() < 0.01);
        assert!(astray.independent > 0.5, "{}", astray.independent);
        assert!((astray.squares(1)[0] / clean.squares(1)[0] - 1.0).abs() < 0.02);
    }

    #[test]
    fn numbers_of_runs_that_are_louder_by_turns_count_less() {
        let loud = Scatter::of(runs(80, 0.3), NUMBERS);
        assert!(loud.independent < 0.15, "{}", loud.independent);
    }

    #[test]
    fn a_mean_of_runs_spreads_by_the_root_of_their_number_and_too_few_runs_tell_nothing() {
        let scatter = Scatter::of(runs(30, 0.0), NUMBERS);
        let [one, _] = scatter.squares(1);
        let [two, _] = scatter.squares(2);
        assert!((two / one - 1.0).abs() < 0.1, "{one} {two}");
        assert_eq!(scatter.squares(30), [1.0, 1.0]);
        assert_eq!(Scatter::of(Vec::new(), NUMBERS).variance, 1.0);
    }
}
