//! Covariance of the statistics of each condition about the emulator.
//!
//! There are more statistics than rigs, so that the correlations `R_c` of a condition `c` are shrunk twice: towards their
//! mean `R̄` over all `m` conditions, which have the same statistics of the same channels, and that towards none,
//!
//! ```text
//! Σ_c = D_c [(1 − β) ((1 − α) R_c + α R̄) + β 1] D_c + ν 1,     α = N / n,   β = N / (n m)
//! ```
//!
//! with the standard deviations `D_c` and `n` rigs. A statistic that a condition lacks is uncorrelated in it, so that `R̄` is a
//! correlation matrix.

use super::place::Place;
use nalgebra::DMatrix;

/// `N`, and bounds of both shares [-].
const SHRINKAGE: f64 = 80.0;
const BOUNDS: [f64; 2] = [0.05, 0.8];
/// `ν`: nothing is known to less than a seventh of its scatter.
const NUGGET: f64 = 0.02;
/// Residuals [standard deviations] beyond which they count as this.
const CLIPPED: f64 = 6.0;
/// Variance [-] below which a statistic does not vary.
const LEAST: f64 = 1.0e-12;

/// The covariance of one condition.
pub struct Covariance {
    /// Its columns.
    pub columns: Vec<usize>,
    /// In the order of these.
    pub matrix: DMatrix<f64>,
}

/// Covariances of the columns of each condition, from residuals of so many rigs.
pub fn covariances(residuals: &DMatrix<f64>, places: &[Place], rigs: usize) -> Vec<Covariance> {
    let count = |of: fn(&Place) -> usize| places.iter().map(of).max().map_or(0, |it| it + 1);
    let scatters = (0..count(|it| it.condition)).map(|condition| {
        let columns = (0..places.len()).filter(|column| places[*column].condition == condition);
        Scatter::of(residuals, columns.collect())
    });
    let mut scatters: Vec<Scatter> = scatters.collect();
    scatters.retain(|it| !it.columns.is_empty());
    let cells = |scatter: &Scatter| -> Vec<usize> {
        let columns = scatter.columns.iter();
        columns.map(|column| places[*column].cell).collect()
    };
    let conditions = scatters.len() as f64;
    let cells_in_all = count(|it| it.cell);
    let mut mean = DMatrix::<f64>::identity(cells_in_all, cells_in_all);
    for scatter in &scatters {
        let cells = cells(scatter);
        for (i, a) in cells.iter().enumerate() {
            for (j, b) in cells.iter().enumerate().filter(|(j, _)| *j != i) {
                mean[(*a, *b)] += scatter.correlations[(i, j)] / conditions;
            }
        }
    }
    let [least, most] = BOUNDS;
    let to_mean = (SHRINKAGE / rigs as f64).clamp(least, most);
    let to_none = (SHRINKAGE / (rigs as f64 * conditions)).clamp(least, most);
    let shrunk = scatters.into_iter().map(|scatter| {
        let cells = cells(&scatter);
        let matrix = DMatrix::from_fn(cells.len(), cells.len(), |i, j| {
            let variance = scatter.deviations[i] * scatter.deviations[j];
            if i == j {
                return variance + NUGGET;
            }
            let own = scatter.correlations[(i, j)];
            let all = mean[(cells[i], cells[j])];
            variance * (1.0 - to_none) * (own + to_mean * (all - own))
        });
        Covariance {
            columns: scatter.columns,
            matrix,
        }
    });
    shrunk.collect()
}

/// Correlations of the columns of a condition, with their standard deviations.
struct Scatter {
    columns: Vec<usize>,
    correlations: DMatrix<f64>,
    deviations: Vec<f64>,
}

impl Scatter {
    fn of(residuals: &DMatrix<f64>, columns: Vec<usize>) -> Self {
        let mut own = residuals.select_columns(&columns);
        clip(&mut own);
        let mut correlations = own.tr_mul(&own) / own.nrows() as f64;
        let variances = correlations.diagonal();
        let deviations: Vec<f64> = variances.iter().map(|it| libm::sqrt(*it)).collect();
        for i in 0..columns.len() {
            for j in 0..columns.len() {
                correlations[(i, j)] = if variances[i].min(variances[j]) > LEAST {
                    correlations[(i, j)] / (deviations[i] * deviations[j])
                } else {
                    0.0
                };
            }
        }
        Self {
            columns,
            correlations,
            deviations,
        }
    }
}

/// Bounds every column to some of its standard deviations.
fn clip(residuals: &mut DMatrix<f64>) {
    for mut column in residuals.column_iter_mut() {
        let bound = CLIPPED * libm::sqrt(column.norm_squared() / column.len() as f64);
        column.iter_mut().for_each(|x| *x = x.clamp(-bound, bound));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use nalgebra::Cholesky;
    use rand_distr::{Distribution, StandardNormal};

    /// Two conditions of three statistics, of which the second condition lacks the last; the first two are correlated.
    fn residuals(rows: usize) -> (DMatrix<f64>, Vec<Place>) {
        let mut rng = Seed(1).rng("residuals", 0);
        let mut drawn = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut residuals = DMatrix::zeros(rows, 5);
        for mut row in residuals.row_iter_mut() {
            for first in [0, 3] {
                let common = drawn();
                row[first] = common;
                row[first + 1] = 2.0 * (0.8 * common + 0.6 * drawn());
            }
            row[2] = drawn();
        }
        let places = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1)];
        let places = places.map(|(condition, cell)| Place {
            condition,
            cell,
            channel: 0,
        });
        (residuals, places.to_vec())
    }

    #[test]
    fn many_rigs_keep_their_correlations_but_for_the_least_shrinkage() {
        let (residuals, places) = residuals(20_000);
        let found = covariances(&residuals, &places, 20_000);
        assert_eq!(found.len(), 2);
        assert_eq!(found[1].columns, [3, 4]);
        for covariance in &found {
            let [scale, shrunk] = [2.0 * 0.8, 1.0 - BOUNDS[0]];
            let most = 1.0 - 0.5 * BOUNDS[0];
            assert!(covariance.matrix[(0, 1)] > 0.97 * scale * shrunk * most);
            assert!(covariance.matrix[(0, 1)] < 1.03 * scale * shrunk);
            assert!((covariance.matrix[(1, 1)] - 4.0 - NUGGET).abs() < 0.1);
        }
    }

    #[test]
    fn a_statistic_that_never_varies_leaves_the_covariance_positive_definite() {
        let (mut residuals, places) = residuals(3);
        residuals.set_column(1, &nalgebra::DVector::zeros(3));
        for covariance in covariances(&residuals, &places, 3) {
            assert!(Cholesky::new(covariance.matrix).is_some());
        }
    }
}
