//! How far measured runs lie from replicates, in one number, and how much of it is closed.
//!
//! Statistics are whitened, so that each counts by the spread of replicates and correlated ones
//! count once, and the number is the energy score (Gneiting and Raftery 2007, J. Am. Stat. Assoc.
//! 102:359-378): the mean distance of a measured run from replicates less half of their own. It is
//! least where replicates are spread as measured runs are.

use super::GapError;
use super::cell::Cell;
use super::comparison::FEWEST_REPLICATES;
use super::condition::Condition;
use super::evidence::{LEAST_SPREAD, moments};
use super::moderation::Priors;
use super::readings::{Reading, Readings};
use crate::quantity::Seed;
use nalgebra::DMatrix;
use rand::RngExt;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Transforms statistics to unit variance without correlation, by a covariance shrunk toward a multiple of
/// the identity.
///
/// The shrinkage maximises the leave-one-out predictive density: the sum of log densities of each replicate
/// given the others (Friedman 1989, J. Am. Stat. Assoc. 84:165-175, for discriminant analysis). The shrinkage
/// of Ledoit and Wolf (2004) is optimal for the covariance and not for its inverse: with many more statistics
/// than replicates it places a held-out run some five standard deviations away.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitening {
    cells: Vec<Cell>,
    means: Vec<f64>,
    spreads: Vec<f64>,
    /// Directions in which replicates vary, and the gain along each [-].
    directions: Vec<(Vec<f64>, f64)>,
    /// Gain across them [-].
    rest: f64,
    /// Share [-] of the identity in the covariance.
    pub shrinkage: f64,
}

impl Whitening {
    /// Whitening of the cells that all these replicates of one condition have.
    ///
    /// # Errors
    /// `TooFewReplicates` for fewer than three.
    pub fn of(replicates: &[&Readings]) -> Result<Self, GapError> {
        if replicates.len() < FEWEST_REPLICATES {
            return Err(GapError::TooFewReplicates(replicates.len()));
        }
        let everywhere = |cell: &Cell| replicates.iter().all(|run| run.get(cell).is_some());
        let cells: Vec<Cell> = replicates[0]
            .iter()
            .map(|(cell, _)| cell.clone())
            .filter(everywhere)
            .collect();
        let (means, spreads) = spreads(&cells, replicates);
        let mut whitening = Self {
            cells,
            means,
            spreads,
            directions: Vec::new(),
            rest: 1.0,
            shrinkage: 1.0,
        };
        let rows: Vec<Vec<f64>> = replicates
            .iter()
            .filter_map(|run| whitening.standardised(run))
            .collect();
        let Self {
            directions,
            rest,
            shrinkage,
            ..
        } = Self::of_rows(&rows);
        (whitening.directions, whitening.rest, whitening.shrinkage) = (directions, rest, shrinkage);
        Ok(whitening)
    }

    /// Whitening of rows of numbers that are centred, each of about unit spread.
    pub(super) fn of_rows(rows: &[Vec<f64>]) -> Self {
        let (n, p) = (rows.len(), rows.first().map_or(0, Vec::len));
        let gram = DMatrix::from_fn(n, n, |i, j| product(&rows[i], &rows[j]));
        let [runs, cells] = [n as f64, (p as f64).max(1.0)];
        let mean = gram.trace() / runs / cells;
        let shrinkage = likeliest_shrinkage(&gram, p);
        let floor = LEAST_SPREAD * LEAST_SPREAD;
        let inverse_root = |variance: f64| 1.0 / libm::sqrt(variance.max(floor));
        let eigen = gram.symmetric_eigen();
        let mut directions = Vec::new();
        for (number, value) in eigen.eigenvalues.iter().enumerate() {
            if *value <= 1.0e-9 * eigen.eigenvalues.max() {
                continue;
            }
            let weights = eigen.eigenvectors.column(number);
            let scale = 1.0 / libm::sqrt(*value);
            let mut direction = vec![0.0; p];
            for (weight, row) in weights.iter().zip(rows) {
                for (sum, x) in direction.iter_mut().zip(row) {
                    *sum += scale * weight * x;
                }
            }
            let variance = (1.0 - shrinkage) * value / runs + shrinkage * mean;
            directions.push((direction, inverse_root(variance)));
        }
        Self {
            cells: Vec::new(),
            means: Vec::new(),
            spreads: Vec::new(),
            directions,
            // Without shrinkage the runs span all directions, or carry no information on the others.
            rest: if shrinkage > 0.0 {
                inverse_root(shrinkage * mean)
            } else {
                0.0
            },
            shrinkage,
        }
    }

    /// The whitened numbers of a row, over the root of their count.
    pub(super) fn apply(&self, row: &[f64]) -> Vec<f64> {
        let scale = 1.0 / libm::sqrt((row.len() as f64).max(1.0));
        let mut white: Vec<f64> = row.iter().map(|x| scale * self.rest * x).collect();
        for (direction, gain) in &self.directions {
            let along = scale * (gain - self.rest) * product(direction, row);
            for (sum, part) in white.iter_mut().zip(direction) {
                *sum += along * part;
            }
        }
        white
    }

    /// Cells that count.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// The whitened readings of a run [-]; their distance is in spreads of replicates, per
    /// statistic. None where it lacks a cell.
    pub fn whitened(&self, run: &Readings) -> Option<Vec<f64>> {
        Some(self.apply(&self.standardised(run)?))
    }

    fn standardised(&self, run: &Readings) -> Option<Vec<f64>> {
        let places = self.cells.iter().zip(&self.means).zip(&self.spreads);
        let value = |((cell, mean), spread): ((&Cell, &f64), &f64)| {
            Some((run.get(cell)?.value - mean) / spread)
        };
        places.map(value).collect()
    }

    /// Energy score [spreads of replicates] of a measured run against replicates; smaller is
    /// nearer. None where one of them lacks a cell, or there are fewer than two replicates.
    pub fn energy_score(&self, measured: &Readings, replicates: &[&Readings]) -> Option<f64> {
        let run = self.whitened(measured)?;
        let made: Option<Vec<_>> = replicates.iter().map(|run| self.whitened(run)).collect();
        energy_score(&run, &made?)
    }
}

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

/// Shares [-] of the identity that are tried.
const SHARES: [f64; 16] = [
    0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0,
];

/// The share under which rows of `p` numbers with these products are likeliest, each given the
/// others.
fn likeliest_shrinkage(gram: &DMatrix<f64>, p: usize) -> f64 {
    let mut sums = [0.0; SHARES.len()];
    for left_out in 0..gram.nrows() {
        let densities = log_densities(gram, p, left_out);
        for (sum, density) in sums.iter_mut().zip(densities) {
            *sum += density;
        }
    }
    let best = (0..SHARES.len()).max_by(|a, b| sums[*a].total_cmp(&sums[*b]));
    best.map_or(1.0, |place| SHARES[place])
}

/// Log densities [-], but for a constant, of a row given the others, by share of the identity.
fn log_densities(gram: &DMatrix<f64>, p: usize, left_out: usize) -> [f64; SHARES.len()] {
    let others = gram.clone().remove_row(left_out).remove_column(left_out);
    let count = others.nrows() as f64;
    let mean = others.trace() / count / p as f64;
    // About the mean of the others it lies farther out than about that of all.
    let scale = (count + 1.0) / count;
    let products = gram.column(left_out).remove_row(left_out) * scale;
    let square = gram[(left_out, left_out)] * scale * scale;
    let eigen = others.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let known: Vec<(f64, f64)> = eigen
        .eigenvalues
        .iter()
        .enumerate()
        .filter(|(_, value)| **value > 1.0e-9 * largest)
        .map(|(number, value)| {
            let along = eigen.eigenvectors.column(number).dot(&products);
            (value / count, along * along / value)
        })
        .collect();
    let across = square - known.iter().map(|(_, along)| along).sum::<f64>();
    let rest = p.saturating_sub(known.len()) as f64;
    SHARES.map(|share| {
        let identity = (share * mean).max(f64::MIN_POSITIVE);
        let along = known.iter().map(|(variance, square)| {
            let variance = (1.0 - share) * variance + identity;
            square / variance + libm::log(variance)
        });
        let across = if rest > 0.0 {
            across.max(0.0) / identity + rest * libm::log(identity)
        } else {
            0.0
        };
        -0.5 * (along.sum::<f64>() + across)
    })
}

/// Means and moderated deviations of cells, in their units.
fn spreads(cells: &[Cell], replicates: &[&Readings]) -> (Vec<f64>, Vec<f64>) {
    let freedom = (replicates.len() - 1) as f64;
    let of = |cell: &Cell| {
        let readings: Vec<Reading> = replicates.iter().filter_map(|run| run.get(cell)).collect();
        let values: Vec<f64> = readings.iter().map(|reading| reading.value).collect();
        let [mean, variance] = moments(&values);
        let size = readings
            .iter()
            .map(|reading| reading.size)
            .fold(0.0, f64::max);
        let scale = [size, mean.abs(), 1.0].into_iter().find(|s| *s > 0.0);
        let scale = scale.unwrap_or(1.0);
        (mean, variance / (scale * scale), scale)
    };
    let moments: Vec<(f64, f64, f64)> = cells.iter().map(of).collect();
    let places = || cells.iter().zip(&moments);
    let priors = Priors::of(places().map(|(cell, (_, variance, _))| (cell, *variance, freedom)));
    let spreads = places().map(|(cell, (_, variance, scale))| {
        let (moderated, _) = priors.moderate(cell, *variance, freedom);
        // What hardly varies is still known no better than to its resolution.
        let resolution = cell.statistic.measure().resolution(*scale);
        (scale * libm::sqrt(moderated)).max(resolution)
    });
    (
        moments.iter().map(|(mean, ..)| *mean).collect(),
        spreads.collect(),
    )
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
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
    let mut resampled: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| {
            let draws = (0..clusters.len()).map(|_| &clusters[rng.random_range(0..clusters.len())]);
            share(draws.fold([0.0, 0.0], add))
        })
        .collect();
    if resampled.len() as f64 <= (1.0 - NOTHING_OPEN) * RESAMPLES as f64 {
        return None;
    }
    resampled.sort_by(f64::total_cmp);
    let quantile = |part: f64| {
        let place = (part * resampled.len() as f64) as usize;
        resampled[place.min(resampled.len() - 1)]
    };
    Some(Closed {
        value,
        ci95: [quantile(0.025), quantile(0.975)],
        clusters: clusters.len(),
    })
}
