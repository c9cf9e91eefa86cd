//! Global tests of a difference between measured runs and replicates, by permutation.
//!
//! Under the null hypothesis the measured run of a condition is exchangeable with its replicates. Labels are
//! therefore permuted within conditions; all other steps, whitening included, do not use the labels.
//!
//! - *Energy distance* of the [whitened](super::whitening::Whitening) runs, summed over conditions:
//!   `2 E|X − Y| − E|X − X'| − E|Y − Y'|` is 0 where both sides have one distribution (Székely and
//!   Rizzo 2013, J. Stat. Plan. Inference 143:1249-1272). It is sensitive to many small differences.
//! - *Strongest cell*: the largest over cells of `Σ (t² − 1) / √(2 C)`, the sum over the `C`
//!   conditions that have the cell (a max-T test, Westfall and Young 1993). It is sensitive to a single large
//!   one, most so if it is present at all conditions.

use super::cell::Cell;
use super::comparison::Table;
use super::distance::apart;
use super::evidence::LEAST_SPREAD;
use super::whitening::Whitening;
use crate::quantity::Seed;
use crate::statistics::mean_and_variance;
use rand::seq::SliceRandom;
use serde::Serialize;
use std::collections::BTreeSet;

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
    /// By the strongest cell.
    pub strongest: Test,
    /// That cell.
    pub at: Option<Cell>,
    /// The smallest p [-] that so few runs can give.
    pub least_p: f64,
}

/// Runs of one condition, without their labels.
struct Pool {
    /// Runs measured; they come first as long as nothing is permuted.
    measured: usize,
    /// Which cells these are of all.
    places: Vec<usize>,
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
    let cells: BTreeSet<&Cell> = tables.iter().flat_map(|table| &table.cells).collect();
    let cells: Vec<&Cell> = cells.into_iter().collect();
    let pools: Vec<Pool> = tables.iter().map(|table| Pool::of(table, &cells)).collect();
    let identity: Vec<Vec<usize>> = pools
        .iter()
        .map(|pool| (0..pool.rows.len()).collect())
        .collect();
    let energy_of = |order: &[Vec<usize>]| -> f64 {
        let pairs = pools.iter().zip(order);
        pairs.map(|(pool, order)| pool.energy(order)).sum()
    };
    let (energy, (strongest, at)) = (energy_of(&identity), strongest(&pools, &identity));
    let mut reached = [1_usize; 2];
    let mut rng = seed.rng("gap.permutation", 0);
    let mut order = identity;
    // Statistics that are equal but for rounding count as reached.
    let reaches = |value: f64, limit: f64| usize::from(value >= limit - 1.0e-9 * limit.abs());
    for _ in 0..PERMUTATIONS {
        order.iter_mut().for_each(|runs| runs.shuffle(&mut rng));
        reached[0] += reaches(energy_of(&order), energy);
        reached[1] += reaches(self::strongest(&pools, &order).0, strongest);
    }
    let share = |count: usize| count as f64 / (PERMUTATIONS + 1) as f64;
    let ways: f64 = pools.iter().map(Pool::ways).product();
    let least_p = (1.0 / ways).max(share(1));
    // A draw may miss permutations that every enumeration has.
    let test = |statistic, count| Test {
        statistic,
        p: share(count).max(least_p),
    };
    Global {
        energy: test(energy, reached[0]),
        strongest: test(strongest, reached[1]),
        at: at.map(|cell| cells[cell].clone()),
        least_p,
    }
}

impl Pool {
    fn of(table: &Table, cells: &[&Cell]) -> Self {
        let runs: Vec<&Vec<f64>> = table.measured.iter().chain(&table.simulated).collect();
        let mut rows = vec![Vec::with_capacity(table.cells.len()); runs.len()];
        for place in 0..table.cells.len() {
            let values: Vec<f64> = runs.iter().map(|run| run[place]).collect();
            let [mean, variance] = mean_and_variance(&values);
            let measure = table.cells[place].statistic.measure();
            let resolution = measure.resolution(table.sizes[place]);
            let deviation = libm::sqrt(variance).max(resolution);
            let deviation = deviation.max(LEAST_SPREAD * table.scale(place));
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
            places: table
                .cells
                .iter()
                .filter_map(|cell| cells.binary_search(&cell).ok())
                .collect(),
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

    /// Adds `t²` of every cell in this order to what other conditions have.
    fn add_squares(&self, order: &[usize], sums: &mut [Squares]) {
        let (real, made) = order.split_at(self.measured);
        let [k, n] = [real.len() as f64, made.len() as f64];
        // The mean of all is 0: that of the others follows from the measured ones'.
        let scale = 1.0 / k + 1.0 / n;
        for (cell, place) in self.places.iter().enumerate() {
            let sum: f64 = real.iter().map(|run| self.rows[*run][cell]).sum();
            sums[*place].sum += sum * sum * scale;
            sums[*place].count += 1.0;
        }
    }
}

/// Sum of `t²` of a cell over conditions.
#[derive(Clone, Copy, Default)]
struct Squares {
    sum: f64,
    count: f64,
}

/// The strongest cell in this order, and how strong it is.
fn strongest(pools: &[Pool], order: &[Vec<usize>]) -> (f64, Option<usize>) {
    let cells = pools.iter().flat_map(|pool| &pool.places).max();
    let mut sums = vec![Squares::default(); cells.map_or(0, |last| last + 1)];
    for (pool, order) in pools.iter().zip(order) {
        pool.add_squares(order, &mut sums);
    }
    let strength = |of: &Squares| (of.sum - of.count) / libm::sqrt(2.0 * of.count);
    let strengths = sums.iter().map(strength).enumerate();
    let best = strengths.max_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or((0.0, None), |(cell, strength)| (strength, Some(cell)))
}
