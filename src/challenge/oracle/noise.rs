//! Noise of the statistics of a condition, from runs that differ by seed only.
//!
//! A change of the statistics is counted in standard deviations `s` of the mean over the repeats of the condition,
//!
//! ```text
//! s² = σ² / n + r²,     C = D R D + F
//! ```
//!
//! with the standard deviation `σ` of a replicate, the number of repeats `n` and the resolution `r` of the statistic
//! ([`Measure::resolution`](crate::gap::Measure::resolution)), which repeats do not improve. `C` is the covariance in
//! these units, with the shares `F = r² / s²` and `D² = 1 - F` on the diagonal. The correlations `R` are those of the
//! standardised replicates of all conditions of one kind (on the ground or lifted), shrunk towards independence by the
//! share under which replicates that were left out are likeliest (Friedman 1989, J. Am. Stat. Assoc. 84:165-175). The
//! share of Ledoit and Wolf is optimal for the covariance, not for its inverse, on which a distance depends: see
//! `gap::whitening`.

use crate::gap::{Cell, Readings};
use crate::statistics::{mean, mean_and_variance};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Shares [-] of independence that are tried.
const SHARES: [f64; 10] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0];
/// Folds of replicates for the choice of the share.
const FOLDS: usize = 4;
/// Changes [standard deviations] from which on they count by their logarithm, as in the diagnosis.
const LINEAR: f64 = 4.0;
/// Scatter over scale [-] below which replicates are equal up to rounding.
const LEAST: f64 = 1.0e-6;

/// Replicates of one condition.
#[derive(Debug, Clone)]
pub(super) struct Replicates {
    /// Whether the wheel is held off the ground.
    pub is_lifted: bool,
    /// Runs of a case in this condition.
    pub repeats: u32,
    /// One a replicate.
    pub readings: Vec<Readings>,
}

/// A statistic of a condition.
#[derive(Debug, Serialize, Deserialize)]
struct Column {
    cell: Cell,
    /// Standard deviation between replicates, in the cell's unit.
    scatter: f64,
    /// Unit in which changes are counted, in the cell's unit.
    scale: f64,
    /// Share of the squared scale that repeats do not reduce.
    fixed: f64,
}

/// Noise of the statistics of one condition.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Noise {
    columns: Vec<Column>,
    factor: Cholesky<f64, Dyn>,
}

/// The noise of every condition; none where the replicates have no covariance.
pub(super) fn noise(replicates: &[Replicates]) -> Option<Vec<Noise>> {
    let correlations = [false, true].map(|is_lifted| {
        let own = replicates.iter().filter(|it| it.is_lifted == is_lifted);
        Correlations::of(&own.collect::<Vec<_>>())
    });
    let of = |it: &Replicates| Noise::of(it, &correlations[usize::from(it.is_lifted)]);
    replicates.iter().map(of).collect()
}

impl Replicates {
    fn values(&self, cell: &Cell) -> Vec<f64> {
        let readings = self.readings.iter();
        let values = readings.filter_map(|it| Some(it.get(cell)?.value));
        values.collect()
    }

    /// Statistics that every replicate has and that are not zero throughout.
    fn columns(&self) -> Vec<Column> {
        let first = self.readings.first().into_iter().flat_map(Readings::iter);
        first.filter_map(|(cell, _)| self.column(cell)).collect()
    }

    fn column(&self, cell: &Cell) -> Option<Column> {
        let values = self.values(cell);
        if values.len() < self.readings.len() {
            return None;
        }
        let sizes = self.readings.iter().filter_map(|it| it.get(cell));
        let size = mean(sizes.map(|it| it.size))?;
        let [_, variance] = mean_and_variance(&values);
        let resolution = cell.statistic.measure().resolution(size);
        let square = variance / f64::from(self.repeats) + resolution * resolution;
        (square > f64::MIN_POSITIVE).then(|| Column {
            cell: cell.clone(),
            scatter: libm::sqrt(variance),
            scale: libm::sqrt(square),
            fixed: resolution * resolution / square,
        })
    }

    /// Standardised replicates of a column; zero where they are equal.
    fn standardised(&self, column: &Column) -> Vec<f64> {
        let values = self.values(&column.cell);
        let [centre, _] = mean_and_variance(&values);
        let is_constant = column.scatter <= LEAST * column.scale;
        let standard = |value: f64| {
            if is_constant {
                0.0
            } else {
                (value - centre) / column.scatter
            }
        };
        values.into_iter().map(standard).collect()
    }
}

/// Correlations of statistics over conditions of one kind.
#[derive(Debug)]
struct Correlations {
    places: BTreeMap<Cell, usize>,
    matrix: DMatrix<f64>,
}

impl Correlations {
    fn of(conditions: &[&Replicates]) -> Self {
        let columns: Vec<Vec<Column>> = conditions.iter().map(|it| it.columns()).collect();
        let cells: BTreeSet<&Cell> = columns.iter().flatten().map(|it| &it.cell).collect();
        let places: BTreeMap<Cell, usize> = cells.into_iter().cloned().zip(0..).collect();
        let counts = conditions.iter().map(|it| it.readings.len());
        let count = counts.max().unwrap_or(0);
        // A statistic that a condition lacks is uncorrelated in it.
        let mut rows = DMatrix::zeros(conditions.len() * count, places.len());
        for (number, (condition, columns)) in conditions.iter().zip(&columns).enumerate() {
            for column in columns {
                let place = places[&column.cell];
                for (replicate, value) in condition.standardised(column).into_iter().enumerate() {
                    rows[(number * count + replicate, place)] = value;
                }
            }
        }
        for mut column in rows.column_iter_mut() {
            let square = column.norm_squared() / column.len() as f64;
            if square > 0.0 {
                column /= libm::sqrt(square);
            }
        }
        let share = likeliest_share(&rows, count);
        Self {
            matrix: shrunk(&rows, share),
            places,
        }
    }
}

/// Correlations of rows, with this share [-] of independence; of unit variance.
fn shrunk(rows: &DMatrix<f64>, share: f64) -> DMatrix<f64> {
    let mut matrix = rows.tr_mul(rows) * ((1.0 - share) / (rows.nrows() as f64).max(1.0));
    matrix.fill_diagonal(1.0);
    matrix
}

/// The share of independence under which replicates are likeliest given those of the other folds; each condition has
/// `count` rows.
fn likeliest_share(rows: &DMatrix<f64>, count: usize) -> f64 {
    let split = |fold: usize, is_out: bool| {
        let own = |row: &usize| ((row % count) % FOLDS == fold) == is_out;
        rows.select_rows(&(0..rows.nrows()).filter(own).collect::<Vec<_>>())
    };
    let folds: Vec<[DMatrix<f64>; 2]> = (0..FOLDS)
        .map(|fold| [split(fold, true), split(fold, false)])
        .collect();
    let density = |share: f64| -> f64 {
        let of_fold = folds.iter().map(|[out, kept]| {
            let factor = Cholesky::new(shrunk(kept, share));
            factor.map_or(f64::NEG_INFINITY, |factor| log_density(&factor, out))
        });
        of_fold.sum()
    };
    let densities = SHARES.map(density);
    let best = (0..SHARES.len()).max_by(|a, b| densities[*a].total_cmp(&densities[*b]));
    best.map_or(1.0, |place| SHARES[place])
}

/// Log density [-] of rows, but for a constant.
fn log_density(factor: &Cholesky<f64, Dyn>, rows: &DMatrix<f64>) -> f64 {
    let mut white = rows.transpose();
    factor.l_dirty().solve_lower_triangular_mut(&mut white);
    let diagonal = factor.l_dirty().diagonal();
    let log: f64 = diagonal.iter().map(|it| libm::log(*it)).sum();
    -0.5 * white.norm_squared() - rows.nrows() as f64 * log
}

impl Noise {
    fn of(replicates: &Replicates, correlations: &Correlations) -> Option<Self> {
        let columns = replicates.columns();
        let places = columns.iter().map(|it| correlations.places[&it.cell]);
        let places: Vec<usize> = places.collect();
        let varying: Vec<f64> = columns
            .iter()
            .map(|it| libm::sqrt((1.0 - it.fixed).max(0.0)))
            .collect();
        let matrix = DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
            if i == j {
                1.0
            } else {
                varying[i] * varying[j] * correlations.matrix[(places[i], places[j])]
            }
        });
        Some(Self {
            factor: Cholesky::new(matrix)?,
            columns,
        })
    }

    /// How many statistics there are.
    pub(super) fn size(&self) -> usize {
        self.columns.len()
    }

    /// The change of the statistics from one run to another, in units of the noise and without correlation. A
    /// statistic that only one of them has does not count.
    pub(super) fn white(&self, with: &Readings, without: &Readings) -> DVector<f64> {
        let change = self.columns.iter().map(|column| {
            let [with, without] = [with, without].map(|it| it.get(&column.cell));
            let change = with.zip(without).map(|(a, b)| a.value - b.value);
            LINEAR * libm::asinh(change.unwrap_or(0.0) / (LINEAR * column.scale))
        });
        let mut change = DVector::from_iterator(self.columns.len(), change);
        self.factor
            .l_dirty()
            .solve_lower_triangular_mut(&mut change);
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::{Reading, Statistic};
    use crate::quantity::Seed;
    use rand_distr::{Distribution, StandardNormal};

    const CELLS: [Statistic; 3] = [
        Statistic::Skewness,
        Statistic::Kurtosis,
        Statistic::Coherence,
    ];

    fn readings(values: [f64; 3]) -> Readings {
        let cells = CELLS.map(|statistic| Cell::new("normal_force", statistic));
        let reading = |value| Reading { value, size: 1.0 };
        cells.into_iter().zip(values.map(reading)).collect()
    }

    /// Runs whose first two statistics have a correlation of 0.8, with a standard deviation of ten resolutions.
    fn replicates(count: usize, repeats: u32) -> Replicates {
        let mut rng = Seed(1).rng("replicates", 0);
        let mut drawn = || -> f64 { StandardNormal.sample(&mut rng) };
        let run = |_| {
            let [a, b, c] = [drawn(), drawn(), drawn()];
            readings([0.1 * a, 0.1 * (0.8 * a + 0.6 * b), 0.1 * c])
        };
        Replicates {
            is_lifted: false,
            repeats,
            readings: (0..count).map(run).collect(),
        }
    }

    fn square(repeats: u32, change: [f64; 3]) -> f64 {
        let noise = noise(&[replicates(4000, repeats)]).unwrap();
        let white = noise[0].white(&readings(change), &readings([0.0; 3]));
        white.norm_squared()
    }

    #[test]
    fn a_distance_is_that_of_mahalanobis_for_the_covariance_of_the_replicates() {
        // Δᵀ C⁻¹ Δ of a standard deviation along both correlated statistics is 2 / (1 + 0.8), across them 2 / (1 - 0.8).
        for (change, exact) in [
            ([0.1, 0.1, 0.0], 2.0 / 1.8),
            ([0.1, -0.1, 0.0], 2.0 / 0.2),
            ([0.0, 0.0, 0.1], 1.0),
        ] {
            // The least share of independence is 5 %, the resolution 1 % of the variance, the asinh 2 %.
            let found = square(1, change);
            assert!((found / exact - 1.0).abs() < 0.3, "{found} for {exact}");
        }
    }

    #[test]
    fn repeats_reduce_the_noise_and_not_the_resolution() {
        let [one, four] = [1, 4].map(|repeats| square(repeats, [0.0, 0.0, 0.05]));
        let [one_exact, four_exact] = [1.0, 4.0].map(|n| 0.05 * 0.05 / (0.01 / n + 1.0e-4));
        assert!((one / one_exact - 1.0).abs() < 0.1, "{one} for {one_exact}");
        assert!(
            (four / four_exact - 1.0).abs() < 0.1,
            "{four} for {four_exact}"
        );
    }
}
