//! Whitening of statistics: each counts by the standard deviation of replicates, and correlated ones count once.

use super::evidence::LEAST_SPREAD;
use nalgebra::DMatrix;

/// Transforms statistics to unit variance without correlation, by a covariance shrunk toward a multiple of
/// the identity.
///
/// The shrinkage maximises the leave-one-out predictive density: the sum of log densities of each replicate
/// given the others (Friedman 1989, J. Am. Stat. Assoc. 84:165-175, for discriminant analysis). The shrinkage
/// of Ledoit and Wolf (2004) is optimal for the covariance and not for its inverse: with many more statistics
/// than replicates it places a held-out run some five standard deviations away.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitening {
    /// Directions in which replicates vary, and the gain along each [-].
    directions: Vec<(Vec<f64>, f64)>,
    /// Gain across them [-].
    rest: f64,
    /// Share [-] of the identity in the covariance.
    shrinkage: f64,
}

impl Whitening {
    /// Whitening of rows of numbers that are centred, each of about unit spread.
    pub fn of_rows(rows: &[Vec<f64>]) -> Self {
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
    pub fn apply(&self, row: &[f64]) -> Vec<f64> {
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

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand_distr::{Distribution, StandardNormal};

    /// Rows of `columns` standard normal numbers; `common` is the share of variance of what they have in common.
    fn rows(count: usize, columns: usize, common: f64, run: u64) -> Vec<Vec<f64>> {
        let mut rng = Seed(2).rng("whitening", run);
        let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
        let row = |_| {
            let shared = libm::sqrt(common) * draw();
            let own = libm::sqrt(1.0 - common);
            (0..columns).map(|_| shared + own * draw()).collect()
        };
        (0..count).map(row).collect()
    }

    fn mean_square(whitening: &Whitening, rows: &[Vec<f64>]) -> f64 {
        let square = |row: &Vec<f64>| whitening.apply(row).iter().map(|x| x * x).sum::<f64>();
        rows.iter().map(square).sum::<f64>() / rows.len() as f64
    }

    #[test]
    fn whitened_rows_that_were_left_out_have_unit_variance_per_statistic() {
        for common in [0.0, 0.9] {
            let whitening = Whitening::of_rows(&rows(60, 10, common, 0));
            let square = mean_square(&whitening, &rows(200, 10, common, 1));
            assert!((square - 1.0).abs() < 0.25, "{common}: {square}");
        }
    }

    #[test]
    fn correlated_statistics_count_once() {
        let correlated = Whitening::of_rows(&rows(60, 10, 0.9, 0));
        let independent = Whitening::of_rows(&rows(60, 10, 0.0, 0));
        assert!(correlated.shrinkage < 0.5 && independent.shrinkage > 0.5);
        // The variance along their common direction is 0.9 * 10 + 0.1; shrunk by half at most, it is above 5.
        let common = [vec![1.0; 10]];
        let ratio = mean_square(&correlated, &common) / mean_square(&independent, &common);
        assert!((1.0 / 9.1..1.0 / 4.0).contains(&ratio), "{ratio}");
    }
}
