//! Precision of each direction in parameter space: singular values of the weighted Jacobian.

use super::least_squares::Residuals;
use super::parameter::{Coordinates, Parameter};
use nalgebra_lm::DMatrix;

/// Singular directions of the weighted Jacobian at a minimum.
#[derive(Debug, Clone)]
pub(super) struct Directions {
    free: Vec<Parameter>,
    /// Singular values; their inverses are standard deviations along the directions.
    singular: Vec<f64>,
    /// One direction a row, in the order of `free`.
    directions: DMatrix<f64>,
    floor: f64,
}

impl Directions {
    pub fn new(residuals: &impl Residuals, at: &Coordinates, free: &[Parameter]) -> Self {
        let gradient = residuals.gradient(at);
        // At least as many rows as columns, so that directions without data appear too.
        let rows = gradient.len().max(free.len());
        let jacobian = DMatrix::from_fn(rows, free.len(), |row, column| {
            gradient
                .get(row)
                .map_or(0.0, |by| by[free[column] as usize])
        });
        let svd = jacobian.svd(false, true);
        let singular: Vec<f64> = svd.singular_values.iter().copied().collect();
        // Two proportional columns differ by rounding, about 1e-16 of the largest singular value; directions
        // identified by real data are above 1e-6 of it.
        let floor = 1e-10 * singular.iter().copied().fold(0.0, f64::max);
        let size = free.len();
        let directions = svd.v_t.unwrap_or_else(|| DMatrix::identity(size, size));
        Self {
            free: free.to_vec(),
            singular,
            directions,
            floor,
        }
    }

    /// The free parameters.
    pub fn free(&self) -> &[Parameter] {
        &self.free
    }

    /// Number of identified directions.
    pub fn rank(&self) -> usize {
        let fixed = self.singular.iter().filter(|&&s| s > self.floor);
        fixed.count()
    }

    /// Covariance of two linear functions of the free parameters for unit standard deviation of the
    /// residuals; `None` where one has a component in a direction that is not identified.
    pub fn covariance(&self, one: &[f64], other: &[f64]) -> Option<f64> {
        let mut sum = 0.0;
        for (index, &singular) in self.singular.iter().enumerate() {
            let along = |function: &[f64]| -> f64 {
                let direction = self.directions.row(index);
                direction.iter().zip(function).map(|(v, g)| v * g).sum()
            };
            let (one_part, other_part) = (along(one), along(other));
            if singular > self.floor {
                sum += one_part * other_part / (singular * singular);
            } else if one_part.abs() > part(one) || other_part.abs() > part(other) {
                return None;
            }
        }
        Some(sum)
    }

    /// A linear function of the free parameters from its derivative by each.
    pub fn function(&self, slope: impl Fn(Parameter) -> f64) -> Vec<f64> {
        self.free
            .iter()
            .map(|&parameter| slope(parameter))
            .collect()
    }
}

/// Relative length below which a component counts as zero: rounding of the directions.
fn part(function: &[f64]) -> f64 {
    let square: f64 = function.iter().map(|g| g * g).sum();
    1e-6 * libm::sqrt(square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Parameter::{SinkageExponent, SinkageModulus, StressAngle};

    /// Measures `2 k_s + 6 n_0` and `4 c_1`, in coordinates.
    struct Sum;

    impl Residuals for Sum {
        fn residuals(&self, _: &Coordinates) -> Vec<f64> {
            vec![0.0; 2]
        }
        fn gradient(&self, _: &Coordinates) -> Vec<Coordinates> {
            let mut gradient = vec![[0.0; 8]; 2];
            gradient[0][SinkageModulus as usize] = 2.0;
            gradient[0][SinkageExponent as usize] = 6.0;
            gradient[1][StressAngle as usize] = 4.0;
            gradient
        }
    }

    #[test]
    fn a_sum_is_fixed_where_its_parts_are_not() {
        let free = [StressAngle, SinkageModulus, SinkageExponent];
        let directions = Directions::new(&Sum, &[0.0; 8], &free);
        assert_eq!(directions.rank(), 2);
        let variance = |function: [f64; 3]| directions.covariance(&function, &function);
        assert_eq!(variance([0.0, 1.0, 0.0]), None);
        assert_eq!(variance([0.0, 0.0, 1.0]), None);
        assert!((variance([0.0, 1.0, 3.0]).unwrap() - 0.25).abs() < 1e-12);
        assert!((variance([1.0, 0.0, 0.0]).unwrap() - 0.0625).abs() < 1e-12);
    }
}
