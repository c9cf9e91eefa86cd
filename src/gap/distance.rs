//! How far measured runs lie from replicates, in one number, and how much of it is closed.
//!
//! The number is the energy score (Gneiting and Raftery 2007, J. Am. Stat. Assoc. 102:359-378): the mean distance of a measured
//! run from replicates less half of their own. It is least where replicates are spread as measured runs are.

use super::condition::Condition;
use crate::quantity::Seed;
use crate::statistics::{bootstrap, quantile_upper};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Energy score of a run against simulated ones, all as rows of numbers; none against fewer than two.
pub fn energy_score(run: &[f64], made: &[Vec<f64>]) -> Option<f64> {
    let off: f64 = made.iter().map(|other| apart(run, other)).sum();
    Some(off / made.len() as f64 - least_energy_score(made)?)
}

/// What a run that is one of these scores in the mean: half of their mean distance; none of fewer than two.
pub fn least_energy_score(made: &[Vec<f64>]) -> Option<f64> {
    let pairs = made.iter().enumerate();
    let among = pairs.flat_map(|(i, a)| made[..i].iter().map(move |b| apart(a, b)));
    let count = made.len() as f64;
    (made.len() > 1).then(|| among.sum::<f64>() / (count * (count - 1.0)))
}

/// Euclidean distance.
pub(super) fn apart(a: &[f64], b: &[f64]) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    libm::sqrt(square)
}

/// Energy scores of one measured run, by three models of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Scores {
    /// Its condition.
    pub condition: Condition,
    /// Its day; runs of one condition and day are drawn together.
    pub day: String,
    /// With parameters recalibrated, `G_rec` [-].
    pub recalibrated: f64,
    /// With parameters recalibrated and the effect added, `G_eff` [-].
    pub with_effect: f64,
    /// What repeats reach among themselves, `G_floor` [-].
    pub floor: f64,
}

/// How much of the gap an effect closes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Closed {
    /// `(G_rec − G_eff) / (G_rec − G_floor)` [-]: 0 closes nothing, 1 all; below 0 it widens.
    pub value: f64,
    /// 95 % interval [-] over conditions and days.
    pub ci95: [f64; 2],
    /// Number of clusters resampled; with one the interval is degenerate.
    pub clusters: usize,
}

impl Closed {
    /// Whether it is shown that some of the gap is closed: the interval lies above 0. One cluster has no interval and shows
    /// nothing.
    pub fn is_shown(&self) -> bool {
        self.clusters > 1 && self.ci95[0] > 0.0
    }
}

/// Resamples behind an interval.
const RESAMPLES: usize = 2000;
/// Share of resamples [-] that may have nothing to close.
const NOTHING_OPEN: f64 = 0.025;

/// The share of the gap closed, with a cluster bootstrap interval over condition and day that resamples all
/// three scores together. `None` without runs, or where the gap after recalibration is not above the floor in
/// 97.5 % of the resamples: then there is no gap to close.
pub fn closed(runs: &[Scores], seed: Seed) -> Option<Closed> {
    let mut clusters = BTreeMap::<(&Condition, &str), [f64; 2]>::new();
    for run in runs {
        let sums = clusters.entry((&run.condition, &run.day)).or_default();
        sums[0] += run.recalibrated - run.with_effect;
        sums[1] += run.recalibrated - run.floor;
    }
    let clusters: Vec<[f64; 2]> = clusters.into_values().collect();
    let share = |[gained, open]: [f64; 2]| (open > 0.0).then(|| gained / open);
    let add = |[a, b]: [f64; 2], [c, d]: &[f64; 2]| [a + c, b + d];
    let value = share(clusters.iter().fold([0.0, 0.0], add))?;
    let mut rng = seed.rng("gap.closed", 0);
    let resampled = bootstrap(&clusters, RESAMPLES, &mut rng, |drawn| {
        share(drawn.iter().copied().fold([0.0, 0.0], add))
    });
    if resampled.len() as f64 <= (1.0 - NOTHING_OPEN) * RESAMPLES as f64 {
        return None;
    }
    let [low, high] = [0.025, 0.975].map(|end| quantile_upper(&resampled, end));
    Some(Closed {
        value,
        ci95: [low?, high?],
        clusters: clusters.len(),
    })
}
