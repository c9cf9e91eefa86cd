//! Shrinkage of what effects show to what is more than noise.
//!
//! An effect moves some channels and leaves others, but its coefficients have noise in all statistics. Of the coefficients
//! `W` of an effect in the `p` statistics of a channel in a condition,
//!
//! ```text
//! max(0, 1 − 3 p / T) W,     T = Σ_j w_jᵀ A⁻¹ w_j / s_j²
//! ```
//!
//! is kept, with the block `A` of the inverse normal matrix and the noise variance `s_j²` of a statistic: without an effect
//! `T` is `3 p` on average (positive part estimator of James and Stein 1961, Proc. 4th Berkeley Symp. 1:361).

use super::place::{CURVE, Place};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Noise of the coefficients of a regression.
pub struct Noise<'a> {
    /// Inverse normal matrix.
    pub inverse: &'a DMatrix<f64>,
    /// Variance of each column's decorrelated rows about the regression.
    pub variances: &'a [f64],
}

/// Shrinks the coefficients of all effects, which follow those of so many parameter features.
pub fn shrink(coefficients: &mut DMatrix<f64>, features: usize, noise: &Noise, places: &[Place]) {
    let blocks = blocks(places);
    for first in (features..coefficients.nrows()).step_by(CURVE) {
        let own = noise.inverse.view((first, first), (CURVE, CURVE));
        let own = Matrix3::from_fn(|i, j| own[(i, j)]);
        let Some(precision) = own.try_inverse() else {
            continue;
        };
        for block in &blocks {
            let squares = block.iter().map(|column| {
                let own = Vector3::from_fn(|i, _| coefficients[(first + i, *column)]);
                own.dot(&(precision * own)) / noise.variances[*column]
            });
            let expected = (CURVE * block.len()) as f64;
            let kept = (1.0 - expected / squares.sum::<f64>()).max(0.0);
            for column in block {
                let mut own = coefficients.view_mut((first, *column), (CURVE, 1));
                own *= kept;
            }
        }
    }
}

/// Columns of each channel in each condition.
fn blocks(places: &[Place]) -> Vec<Vec<usize>> {
    let mut columns: Vec<usize> = (0..places.len()).collect();
    let key = |column: &usize| (places[*column].condition, places[*column].channel);
    columns.sort_by_key(key);
    let blocks = columns.chunk_by(|a, b| key(a) == key(b));
    blocks.map(<[usize]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_vanishes_and_what_stands_out_stays() {
        let channels = [0, 0, 0, 0, 1, 1, 1, 1];
        let places = channels.map(|channel| Place {
            condition: 0,
            cell: channel,
            channel,
        });
        // The first row is that of a parameter.
        let mut coefficients = DMatrix::from_fn(1 + CURVE, 8, |_, column| match channels[column] {
            0 => 0.5,
            _ => 20.0,
        });
        let noise = Noise {
            inverse: &DMatrix::identity(1 + CURVE, 1 + CURVE),
            variances: &[1.0; 8],
        };
        shrink(&mut coefficients, 1, &noise, &places);
        assert_eq!(coefficients[(0, 0)], 0.5);
        assert_eq!(coefficients[(1, 0)], 0.0);
        assert!((coefficients[(3, 5)] - 20.0 * (1.0 - 1.0 / 400.0)).abs() < 1e-9);
    }
}
