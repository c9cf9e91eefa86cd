//! Whether measured runs and replicates differ at all: two tests by permutation.
//!
//! Were nothing wrong, any run of a condition could be the measured one. Labels are therefore
//! exchanged within conditions; everything else, whitening included, does not know them.
//!
//! - *Energy distance* of the [whitened](super::distance::Whitening) runs, summed over conditions:
//!   `2 E|X − Y| − E|X − X'| − E|Y − Y'|` is 0 where both sides have one distribution (Székely and
//!   Rizzo 2013, J. Stat. Plan. Inference 143:1249-1272). It sees many small differences.
//! - *Largest |t|* over all cells and conditions (Westfall and Young 1993). It sees a single large
//!   one.

use super::cell::Cell;
use super::comparison::Table;
use super::condition::Condition;
use super::distance::{Whitening, apart};
use super::map::{LEAST_SPREAD, moments};
use crate::quantity::Seed;
use rand::seq::SliceRandom;
use serde::Serialize;

/// Permutations drawn.
pub const PERMUTATIONS: usize = 999;

/// A test by permutation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Test {
    /// The statistic of the measured runs [-].
    pub statistic: f64,
    /// Share of the permutations, the measured labels among them, that reach it [-].
    pub p: f64,
}

/// Whether the sides differ at all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Global {
    /// By energy distance.
    pub energy: Test,
    /// By the largest |t|.
    pub largest: Test,
    /// Where |t| is largest.
    pub at: Option<(Condition, Cell)>,
    /// The smallest p [-] that so few runs can give.
    pub least_p: f64,
}

/// Runs of one condition, without their labels.
struct Pool {
    /// Runs measured; they come first as long as nothing is permuted.
    measured: usize,
    /// Cells over their deviations among all runs, run by run.
    rows: Vec<Vec<f64>>,
    /// Distances of the whitened runs.
    distances: Vec<Vec<f64>>,
}

pub(super) fn test(tables: &[Table], seed: Seed) -> Global {
    // Campaigns are made of the same runs again.
    let tables: Vec<&Table> = tables
        .iter()
        .filter(|t| !t.condition.is_campaign())
        .collect();
    let pools: Vec<Pool> = tables.iter().map(|table| Pool::of(table)).collect();
    let identity: Vec<Vec<usize>> = pools
        .iter()
        .map(|pool| (0..pool.rows.len()).collect())
        .collect();
    let (energy, largest) = (energy(&pools, &identity), largest(&pools, &identity));
    let mut reached = [1_usize; 2];
    let mut rng = seed.rng("gap.permutation", 0);
    let mut order = identity;
    // Statistics that are equal but for rounding count as reached.
    let reaches = |value: f64, limit: f64| usize::from(value >= limit * (1.0 - 1.0e-9));
    for _ in 0..PERMUTATIONS {
        order.iter_mut().for_each(|runs| runs.shuffle(&mut rng));
        reached[0] += reaches(self::energy(&pools, &order), energy);
        reached[1] += reaches(self::largest(&pools, &order).0, largest.0);
    }
    let share = |count: usize| count as f64 / (PERMUTATIONS + 1) as f64;
    let ways: f64 = pools.iter().map(Pool::ways).product();
    Global {
        energy: Test {
            statistic: energy,
            p: share(reached[0]),
        },
        largest: Test {
            statistic: largest.0,
            p: share(reached[1]),
        },
        at: largest.1.map(|(pool, cell)| {
            (
                tables[pool].condition.clone(),
                tables[pool].cells[cell].clone(),
            )
        }),
        least_p: (1.0 / ways).max(share(1)),
    }
}

impl Pool {
    fn of(table: &Table) -> Self {
        let runs: Vec<&Vec<f64>> = table.measured.iter().chain(&table.simulated).collect();
        let mut rows = vec![Vec::with_capacity(table.cells.len()); runs.len()];
        for place in 0..table.cells.len() {
            let values: Vec<f64> = runs.iter().map(|run| run[place]).collect();
            let [mean, variance] = moments(&values);
            let deviation = libm::sqrt(variance).max(LEAST_SPREAD * table.scale(place));
            for (row, run) in rows.iter_mut().zip(&runs) {
                row.push((run[place] - mean) / deviation);
            }
        }
        let whitening = Whitening::of_rows(&rows);
        let white: Vec<Vec<f64>> = rows.iter().map(|row| whitening.apply(row)).collect();
        let distances = white
            .iter()
            .map(|one| white.iter().map(|other| apart(one, other)).collect())
            .collect();
        Self {
            measured: table.measured.len(),
            rows,
            distances,
        }
    }

    /// Ways to label so many runs as measured.
    fn ways(&self) -> f64 {
        let (n, k) = (self.rows.len(), self.measured);
        (0..k).map(|i| (n - i) as f64 / (k - i) as f64).product()
    }

    /// Energy distance of the first runs in this order from the others.
    fn energy(&self, order: &[usize]) -> f64 {
        let (real, made) = order.split_at(self.measured);
        let mean = |some: &[usize], others: &[usize]| {
            let pairs = some
                .iter()
                .flat_map(|a| others.iter().map(|b| self.distances[*a][*b]));
            pairs.sum::<f64>() / (some.len() * others.len()) as f64
        };
        2.0 * mean(real, made) - mean(real, real) - mean(made, made)
    }

    /// The largest |t| in this order, and its cell.
    fn largest(&self, order: &[usize]) -> (f64, usize) {
        let (real, made) = order.split_at(self.measured);
        let [k, n] = [real.len() as f64, made.len() as f64];
        let scale = libm::sqrt(1.0 / k + 1.0 / n);
        let cells = self.rows.first().map_or(0, Vec::len);
        let mut best = (0.0, 0);
        for cell in 0..cells {
            // The mean of all is 0: that of the others follows.
            let sum: f64 = real.iter().map(|run| self.rows[*run][cell]).sum();
            let t = (sum / k + sum / n).abs() / scale;
            if t > best.0 {
                best = (t, cell);
            }
        }
        best
    }
}

fn energy(pools: &[Pool], order: &[Vec<usize>]) -> f64 {
    pools
        .iter()
        .zip(order)
        .map(|(pool, order)| pool.energy(order))
        .sum()
}

/// The largest |t| over all pools, its pool and cell.
fn largest(pools: &[Pool], order: &[Vec<usize>]) -> (f64, Option<(usize, usize)>) {
    let mut best = (0.0, None);
    for (number, (pool, order)) in pools.iter().zip(order).enumerate() {
        let (t, cell) = pool.largest(order);
        if t > best.0 {
            best = (t, Some((number, cell)));
        }
    }
    best
}
