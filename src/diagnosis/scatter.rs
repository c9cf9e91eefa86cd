//! How runs that had no part in a whitening lie under it.
//!
//! Replicates are left out by turns and whitened by the others, as a measured run is. Three things
//! are learned from them.
//!
//! Their spread, each number's drawn to that of its channel and domain. A wheel that slips off a
//! joint's edge once shows in some numbers of one run, by tens of deviations, and a mean square would
//! be that of this run. The spread is the scale of the Student's t that the fits use, which a few
//! outlying numbers hardly move; its [tail](super::tail) is that of channel and domain.
//!
//! Their loudness. On slate a wheel meets a joint or does not, and all numbers of a run are larger or
//! smaller alike: mean squares of left-out runs range from 1 to 17. A run's loudness is the square of
//! the scale of all its numbers; what a measured run may have is what left-out runs have.
//!
//! How many numbers count. Replicates whiten many statistics in part only; what is left correlated
//! would be counted as often as it shows. The product of two runs has, its numbers independent, the
//! mean square `Σ vᵢ²`, their variances squared; else `tr C²` of their covariance (Chen and Qin 2010,
//! Ann. Stat. 38:808-835). By as much as it is larger, log likelihoods are scaled down (a magnitude
//! adjustment of a composite likelihood, as by Pauli, Racugno and Ventura 2011, Stat. Sinica
//! 21:149-164), each channel and domain by its own part of both sums: two hundred levels of one spectrum
//! that move together leave a mean torque what it tells. Loudness is taken out before: it makes all log
//! densities rise and fall together, but hides nothing once it is known. Left in, 3 to 40 of 450 numbers
//! counted on slate, and an effect on one precise mean was lost.

use super::calibration::FREEDOM;
use super::product::{add, middle, scores};
use super::tail::{Tail, square_of_scale};
use crate::gap::{Cell, moments, student_scale};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::collections::BTreeMap;

/// Rounds in which spreads and loudness settle.
const SETTLING: usize = 4;
/// Runs that the spread of all numbers of a channel and domain counts as, beside a number's own.
const OF_GROUP: f64 = 20.0;
/// Least weight of a number [-].
const LEAST: f64 = 1.0e-3;
/// Numbers [-] of all that the weight of a channel's and domain's is drawn to.
const OF_ALL: f64 = 2.0;
/// Score [-] beyond which a number counts no more in a mean square: one cell is no misfit.
const OUTLYING: f64 = 5.0;

/// Left-out runs of one condition.
#[derive(Debug)]
pub(super) struct Scatter {
    /// Square of the scale [-], by number, of a run of common loudness.
    spread: Vec<f64>,
    /// Variance [-] below which a number says nothing.
    least: Vec<f64>,
    /// Tail of each number.
    pub tails: Vec<Tail>,
    /// What each number counts as [-], of one that is independent of all others.
    pub weights: Vec<f64>,
    /// The runs, whitened; none where there were too few to leave any out.
    runs: Vec<Vec<f64>>,
}

/// How loud runs of a condition are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loudness {
    /// Mean and deviation of its logarithm [-].
    pub log: [f64; 2],
    /// Least and largest.
    range: [f64; 2],
}

impl Loudness {
    /// What these runs have.
    fn range(loudness: &[f64]) -> Self {
        let logs: Vec<f64> = loudness.iter().map(|l| libm::log(*l)).collect();
        let [mean, variance] = moments(&logs);
        Self {
            log: [mean, libm::sqrt(variance)],
            range: [
                loudness.iter().copied().fold(f64::INFINITY, f64::min),
                loudness.iter().copied().fold(0.0, f64::max),
            ],
        }
    }

    /// The nearest to this that a run has had.
    pub fn possible(&self, loudness: f64) -> f64 {
        let [least, most] = self.range;
        loudness.clamp(least, most)
    }
}

impl Scatter {
    /// Of these runs, whitened without them, a number about each cell, none of which tells anything
    /// below its `least` variance.
    pub fn of(runs: Vec<Vec<f64>>, cells: &[Cell], least: Vec<f64>) -> Self {
        let mut scatter = Self {
            spread: vec![1.0; cells.len()],
            tails: vec![Tail::new(FREEDOM); cells.len()],
            // Where nothing tells it, all of a run's numbers are as good as two.
            weights: vec![(2.0 / cells.len() as f64).min(1.0); cells.len()],
            least,
            runs,
        };
        if scatter.runs.is_empty() {
            return scatter;
        }
        let groups = groups(cells);
        let mut quiet = scatter.runs.clone();
        for _ in 0..SETTLING {
            groups
                .iter()
                .for_each(|group| scatter.spread_of(group, &quiet));
            let loudness = scatter.loudnesses(1);
            let [common, _] = Loudness::range(&loudness).log;
            for ((run, quiet), loudness) in scatter.runs.iter().zip(&mut quiet).zip(loudness) {
                let factor = libm::sqrt(libm::exp(common) / loudness);
                *quiet = run.iter().map(|z| factor * z).collect();
            }
            groups
                .iter()
                .for_each(|group| scatter.tail_of(group, &quiet));
        }
        groups
            .iter()
            .for_each(|group| scatter.spread_of(group, &quiet));
        let scores = quiet.iter().map(|run| scatter.scores(run, 1));
        let scores: Vec<Vec<f64>> = scores.collect();
        let resolution = scatter.least.iter().zip(scatter.variance(1.0));
        let resolution: Vec<f64> = resolution.map(|(least, all)| least / all).collect();
        scatter.weights = weights(&scores, &groups, &resolution);
        scatter
    }

    /// Sets the tail of the numbers of these places to what runs show.
    fn tail_of(&mut self, group: &[usize], runs: &[Vec<f64>]) {
        let over_spread = |&place: &usize| {
            let deviation = libm::sqrt(self.spread[place]);
            runs.iter().map(move |run| run[place] / deviation)
        };
        let scores: Vec<f64> = group.iter().flat_map(over_spread).collect();
        let tail = Tail::of(&scores);
        group.iter().for_each(|place| self.tails[*place] = tail);
    }

    /// Sets the spread of the numbers of these places to what runs show, each drawn to that of all.
    fn spread_of(&mut self, group: &[usize], runs: &[Vec<f64>]) {
        let freedom = self.tails[group[0]].freedom;
        let square = |numbers: &[f64]| libm::pow(student_scale(numbers, freedom), 2.0);
        let numbers = |place: &usize| runs.iter().map(|run| run[*place]).collect::<Vec<_>>();
        let numbers: Vec<Vec<f64>> = group.iter().map(numbers).collect();
        let common = square(&numbers.concat());
        let own = runs.len() as f64 / (runs.len() as f64 + OF_GROUP);
        for (place, numbers) in group.iter().zip(numbers) {
            let spread = own * square(&numbers) + (1.0 - own) * common;
            self.spread[*place] = spread.max(f64::MIN_POSITIVE);
        }
    }

    /// Loudness of the means of so many runs each.
    fn loudnesses(&self, together: usize) -> Vec<f64> {
        let of = |mean: Vec<f64>| self.loudness_of(&self.scores(&mean, together));
        self.means(together).map(of).collect()
    }

    /// Loudness of a departure over its deviations.
    pub fn loudness_of(&self, scores: &[f64]) -> f64 {
        square_of_scale(scores, &self.tails)
    }

    /// How loud means of so many runs are; as they should be where nothing tells it.
    pub fn loudness(&self, together: usize) -> Loudness {
        if self.runs.len() <= together {
            return Loudness {
                log: [0.0, 1.0],
                range: [1.0, 1.0],
            };
        }
        Loudness::range(&self.loudnesses(together))
    }

    /// Means of so many runs each, one after the other.
    fn means(&self, together: usize) -> impl Iterator<Item = Vec<f64>> {
        let count = self.runs.len();
        (0..count).map(move |first| {
            let runs = (0..together).map(|next| &self.runs[(first + next) % count]);
            middle(&runs.collect::<Vec<_>>())
        })
    }

    /// Variance of each number of a mean that has this share of the variance of a run of common
    /// loudness. None is known better than its resolution.
    pub fn variance(&self, share: f64) -> impl Iterator<Item = f64> {
        let numbers = self.spread.iter().zip(&self.least);
        numbers.map(move |(spread, least)| share * spread + least)
    }

    /// Weights over variances, number by number.
    pub fn precision(&self, variance: &[f64]) -> Vec<f64> {
        let numbers = self.weights.iter().zip(variance);
        numbers.map(|(weight, v)| weight / v).collect()
    }

    /// The same of numbers that depart so far: less, the farther they lie.
    pub fn precision_at(&self, departure: &[f64], variance: &[f64]) -> Vec<f64> {
        let numbers = departure.iter().zip(variance).zip(&self.tails);
        let numbers = numbers.zip(&self.weights);
        numbers
            .map(|(((e, v), tail), weight)| weight * tail.precision(*e, *v))
            .collect()
    }

    /// How many independent numbers all of them are [-].
    pub fn independent(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Log density [-] of these departures of these variances.
    pub fn log_density(&self, departure: &[f64], variance: &[f64]) -> f64 {
        let numbers = departure.iter().zip(variance).zip(&self.tails);
        let numbers = numbers.zip(&self.weights);
        numbers
            .map(|(((e, v), tail), weight)| {
                weight * (tail.log_density(e / libm::sqrt(*v)) - 0.5 * libm::log(*v))
            })
            .sum()
    }

    /// A departure of a mean of so many runs over its deviations [-]: that of some of these runs.
    pub fn drawn(&self, together: usize, rng: &mut impl Rng) -> Vec<f64> {
        if self.runs.is_empty() {
            return self
                .spread
                .iter()
                .map(|_| StandardNormal.sample(rng))
                .collect();
        }
        let runs: Vec<&Vec<f64>> = (0..together)
            .map(|_| &self.runs[rng.random_range(0..self.runs.len())])
            .collect();
        self.scores(&middle(&runs), together)
    }

    /// Mean square [-] of the mean of so many runs over its deviations, outlying numbers cut.
    pub fn square(&self, together: usize) -> f64 {
        if self.runs.len() <= together {
            return 1.0;
        }
        let squares: Vec<f64> = self
            .means(together)
            .map(|mean| mean_square(self.scores(&mean, together).into_iter()))
            .collect();
        let [mean, _] = moments(&squares);
        mean.max(f64::MIN_POSITIVE)
    }

    /// A mean of so many runs over its deviations.
    fn scores(&self, mean: &[f64], together: usize) -> Vec<f64> {
        scores(mean, self.variance(1.0 / together as f64))
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

/// Places of the numbers of each channel and domain.
fn groups(cells: &[Cell]) -> Vec<Vec<usize>> {
    let mut groups = BTreeMap::<_, Vec<usize>>::new();
    for (place, cell) in cells.iter().enumerate() {
        let group = (&*cell.channel, cell.domain());
        groups.entry(group).or_default().push(place);
    }
    groups.into_values().collect()
}

/// What each number of these runs, over their deviations, counts as [-]: `Σ vᵢ²` over the part of `tr C²` that
/// its group has, at most 1. What is added to the variances by the numbers' resolution is independent.
fn weights(runs: &[Vec<f64>], groups: &[Vec<usize>], resolution: &[f64]) -> Vec<f64> {
    let cut = |run: &Vec<f64>| run.iter().map(|z| z.clamp(-OUTLYING, OUTLYING)).collect();
    let runs: Vec<Vec<f64>> = runs.iter().map(cut).collect();
    let sum = |group: &Vec<usize>, of: &dyn Fn(usize) -> f64| -> f64 {
        group.iter().map(|place| of(*place)).sum()
    };
    let square = |place: usize| {
        let squares = runs.iter().map(|run| run[place] * run[place]);
        squares.sum::<f64>() / runs.len() as f64
    };
    let squares: Vec<f64> = (0..runs[0].len()).map(square).collect();
    let moved = |place: usize| squares[place] * squares[place];
    let with_resolution = |place: usize| libm::pow(squares[place] + resolution[place], 2.0);
    let alone: Vec<f64> = groups.iter().map(|g| sum(g, &with_resolution)).collect();
    let together = together(&runs, groups).into_iter().zip(groups);
    let together: Vec<f64> = together
        .map(|(together, group)| together + sum(group, &|k| with_resolution(k) - moved(k)))
        .collect();
    let share = |alone: f64, together: f64| match together <= alone {
        true => 1.0,
        false => (alone / together).max(LEAST),
    };
    let of_all = libm::log(share(alone.iter().sum(), together.iter().sum()));
    let mut weights = vec![1.0; runs[0].len()];
    for ((group, alone), together) in groups.iter().zip(alone).zip(together) {
        let own = group.len() as f64 / (group.len() as f64 + OF_ALL);
        let log = own * libm::log(share(alone, together)) + (1.0 - own) * of_all;
        group
            .iter()
            .for_each(|place| weights[*place] = libm::exp(log));
    }
    weights
}

/// The part of `tr C²` of each group of numbers: their products of two runs times those of all numbers.
fn together(runs: &[Vec<f64>], groups: &[Vec<usize>]) -> Vec<f64> {
    let count = runs.len() as f64;
    let mut sums = vec![0.0; groups.len()];
    for (place, a) in runs.iter().enumerate() {
        for b in &runs[..place] {
            let part = |group: &Vec<usize>| group.iter().map(|k| a[*k] * b[*k]).sum::<f64>();
            let parts: Vec<f64> = groups.iter().map(part).collect();
            add(&mut sums, parts.iter().sum(), &parts);
        }
    }
    let pairs = (0.5 * count * (count - 1.0)).max(1.0);
    sums.iter().map(|sum| sum / pairs).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::Statistic;
    use crate::quantity::Seed;
    use rand_distr::{Distribution, StandardNormal};

    const NUMBERS: usize = 200;

    /// Half of them vibration, half mean forces.
    fn cells() -> Vec<Cell> {
        let of = |(channel, statistic): (&str, fn(usize) -> Statistic)| {
            let channel = channel.to_owned();
            (0..NUMBERS / 2).map(move |place| Cell::new(channel.as_str(), statistic(place)))
        };
        let vibration = of(("acceleration_y", |band| Statistic::Band(band as i16)));
        vibration
            .chain(of(("normal_force", |_| Statistic::Mean)))
            .collect()
    }

    /// Runs of independent normal numbers, each run louder or less by a factor of this spread.
    fn runs(count: usize, spread: f64) -> Vec<Vec<f64>> {
        let mut rng = Seed(5).rng("scatter", 0);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
        (0..count)
            .map(|_| {
                let factor = libm::exp(spread * normal());
                (0..NUMBERS).map(|_| factor * normal()).collect()
            })
            .collect()
    }

    impl Scatter {
        fn share(&self) -> f64 {
            self.independent() / self.weights.len() as f64
        }
    }

    /// Of runs whose numbers have no resolution.
    fn scatter(runs: Vec<Vec<f64>>) -> Scatter {
        Scatter::of(runs, &cells(), vec![0.0; NUMBERS])
    }

    #[test]
    fn numbers_below_their_resolution_do_not_count_as_correlated() {
        let mut runs = runs(80, 0.0);
        let mut rng = Seed(6).rng("scatter", 1);
        for run in &mut runs {
            // All of them move together, by less than can be told.
            let moved: f64 = StandardNormal.sample(&mut rng);
            run[NUMBERS / 2..].fill(1.0e-3 * moved);
        }
        let told = Scatter::of(runs.clone(), &cells(), vec![0.0; NUMBERS]);
        let least = (0..NUMBERS).map(|place| if place < NUMBERS / 2 { 0.0 } else { 1.0 });
        let resolved = Scatter::of(runs, &cells(), least.collect());
        assert!(told.weights[NUMBERS - 1] < 0.05, "{}", told.share());
        assert!(resolved.weights[NUMBERS - 1] > 0.7, "{}", resolved.share());
    }

    #[test]
    fn independent_numbers_all_count_and_one_that_went_astray_changes_neither_spread_nor_count() {
        let mut runs = runs(80, 0.0);
        let clean = scatter(runs.clone());
        assert!(clean.share() > 0.7, "{}", clean.share());
        runs[3][7] = 1.0e6;
        let astray = scatter(runs);
        assert!((astray.spread[7] / clean.spread[7] - 1.0).abs() < 0.25);
        assert!(astray.share() > 0.5, "{}", astray.share());
        assert!((astray.square(1) / clean.square(1) - 1.0).abs() < 0.02);
    }

    #[test]
    fn numbers_of_runs_that_are_louder_by_turns_count_once_the_loudness_is_taken_out() {
        let clean = scatter(runs(80, 0.0));
        let loud = scatter(runs(80, 0.3));
        assert!(loud.share() > 0.7, "{}", loud.share());
        let [mean, deviation] = loud.loudness(1).log;
        assert!(
            mean.abs() < 0.1 && (deviation - 0.6).abs() < 0.15,
            "{mean} {deviation}"
        );
        assert!(clean.loudness(1).log[1] < 0.2);
        assert!((loud.spread[7] / clean.spread[7] - 1.0).abs() < 0.2);
    }

    #[test]
    fn numbers_that_are_the_same_twice_count_half() {
        let mut runs = runs(80, 0.0);
        for run in &mut runs {
            run.copy_within(..NUMBERS / 2, NUMBERS / 2);
        }
        let it = scatter(runs);
        assert!((it.share() - 0.5).abs() < 0.15, "{}", it.share());
    }

    #[test]
    fn forces_keep_what_they_tell_where_levels_of_vibration_move_together() {
        let mut runs = runs(80, 0.0);
        for run in &mut runs {
            let moved = run[0];
            run[..NUMBERS / 2].fill(moved);
        }
        let it = scatter(runs);
        let [vibration, force] = [it.weights[0], it.weights[NUMBERS - 1]];
        assert!(vibration < 0.05 && force > 0.7, "{vibration} {force}");
    }

    #[test]
    fn each_channel_and_domain_has_its_own_tail() {
        let mut runs = runs(80, 0.0);
        for run in &mut runs {
            run[..NUMBERS / 2].iter_mut().for_each(|z| *z *= z.abs());
        }
        let it = scatter(runs);
        let [vibration, force] = [0, NUMBERS - 1].map(|place| it.tails[place].freedom);
        assert!(vibration < 7.0 && force > 10.0, "{vibration} {force}");
    }

    #[test]
    fn a_run_is_held_to_be_no_louder_than_any_that_was_left_out() {
        let loudness = scatter(runs(80, 0.3)).loudness(1);
        assert_eq!(loudness.possible(1.0), 1.0);
        assert!(loudness.possible(1.0e6) < 20.0 && loudness.possible(0.0) > 0.05);
    }

    #[test]
    fn channels_and_domains_have_spreads_of_their_own() {
        let mut runs = runs(80, 0.0);
        for run in &mut runs {
            run[NUMBERS / 2..].iter_mut().for_each(|z| *z *= 0.1);
        }
        let it = scatter(runs);
        let [vibration, forces] = [0, NUMBERS / 2].map(|first| {
            let group = &it.spread[first..first + NUMBERS / 2];
            group.iter().sum::<f64>() / group.len() as f64
        });
        assert!(
            (forces / vibration / 0.01 - 1.0).abs() < 0.1,
            "{forces} {vibration}"
        );
    }

    #[test]
    fn a_number_that_is_wider_than_its_fellows_is_held_to_be_so() {
        let mut runs = runs(80, 0.0);
        runs.iter_mut().for_each(|run| run[7] *= 10.0);
        let it = scatter(runs);
        let ratio = it.spread[7] / it.spread[8];
        assert!((50.0..120.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_mean_of_runs_spreads_by_the_root_of_their_number_and_too_few_runs_tell_nothing() {
        let it = scatter(runs(30, 0.0));
        let (one, two) = (it.square(1), it.square(2));
        assert!((two / one - 1.0).abs() < 0.1, "{one} {two}");
        assert_eq!(it.square(30), 1.0);
        let none = scatter(Vec::new());
        assert!(none.spread.iter().all(|v| *v == 1.0));
        assert_eq!(none.weights, vec![2.0 / NUMBERS as f64; NUMBERS]);
        assert_eq!(none.loudness(1).possible(9.0), 1.0);
    }
}
