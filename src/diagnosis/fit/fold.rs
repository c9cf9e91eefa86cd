//! Sums over conditions, all or all but one: weights of strengths and spreads of parameters.

use super::super::emulator::Emulated;
use super::super::grid::Axis;
use super::super::product::{log_sum, product, scaled};
use super::local::Local;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Posterior points that make a prediction, and the log weight under the best from which on.
const PREDICTING: (usize, f64) = (16, -5.0);

/// Sums of one condition, at every point of the grid.
pub(super) struct Terms {
    /// `Jᵀ Λ J`.
    pub information: DMatrix<f64>,
    /// `(r − d)ᵀ Λ (r − d)`.
    pub squares: Vec<f64>,
    /// `Jᵀ Λ (r − d)`, a column a point.
    pub projections: DMatrix<f64>,
}

impl Terms {
    pub fn new(
        emulated: &Emulated,
        Local { jacobian, residual }: &Local,
        precision: &[f64],
        axes: &[(usize, Axis)],
    ) -> Self {
        let count = jacobian.len();
        let weighted: Vec<Vec<f64>> = jacobian
            .iter()
            .map(|column| scaled(column, precision))
            .collect();
        let project = |row: &[f64]| {
            DVector::from_iterator(count, weighted.iter().map(|column| product(column, row)))
        };
        let information = DMatrix::from_fn(count, count, |i, j| {
            product(&weighted[i.max(j)], &jacobian[i.min(j)])
        });
        let weighted_residual = scaled(residual, precision);
        let mut squares = vec![product(&weighted_residual, residual)];
        let mut projections = vec![project(residual)];
        let mut former: Option<Vec<Vec<f64>>> = None;
        for (effect, axis) in axes {
            let changes: Vec<Vec<f64>> = axis
                .strengths
                .iter()
                .map(|strength| emulated.shapes[*effect].at(*strength))
                .collect();
            let own: Vec<_> = changes
                .iter()
                .map(|change| {
                    let weighted = scaled(change, precision);
                    let along = product(&weighted, residual);
                    let square = product(&weighted, change) - 2.0 * along;
                    (square, project(change), weighted)
                })
                .collect();
            let (mut all_squares, mut all_projections) = (Vec::new(), Vec::new());
            for place in 0..squares.len() {
                for (square, projection, weighted) in &own {
                    let cross = former.as_ref().map(|f| product(&f[place], weighted));
                    all_squares.push(squares[place] + square + 2.0 * cross.unwrap_or(0.0));
                    all_projections.push(&projections[place] - projection);
                }
            }
            (squares, projections) = (all_squares, all_projections);
            former = Some(changes);
        }
        let projections =
            DMatrix::from_fn(count, squares.len(), |row, point| projections[point][row]);
        Self {
            information,
            squares,
            projections,
        }
    }
}

/// Weights of strengths and spreads of parameters, given all conditions or all but one.
pub(super) struct Fold {
    /// By spread of the parameters, by point of the grid.
    pub log_weights: Vec<Vec<f64>>,
    /// `Jᵀ Λ (r − d)`, a column a point.
    pub projections: DMatrix<f64>,
    /// By spread: the parameters' precision; none where they do not move.
    pub precisions: Vec<Option<Cholesky<f64, Dyn>>>,
}

impl Fold {
    /// Best parameters [prior standard deviations].
    pub fn offsets(&self, scale: usize, point: usize) -> DVector<f64> {
        match &self.precisions[scale] {
            Some(precision) => precision.solve(&self.projections.column(point)),
            None => DVector::zeros(self.projections.nrows()),
        }
    }

    pub fn best(&self) -> (usize, usize) {
        let mut best = (0, 0);
        for (scale, weights) in self.log_weights.iter().enumerate() {
            for (point, weight) in weights.iter().enumerate() {
                if *weight > self.log_weights[best.0][best.1] {
                    best = (scale, point);
                }
            }
        }
        best
    }

    /// Points that make predictions with their log weights, best first, which sum to one.
    pub fn predicting(&self) -> Vec<(usize, usize, f64)> {
        let mut points: Vec<(usize, usize, f64)> = Vec::new();
        for (scale, weights) in self.log_weights.iter().enumerate() {
            let of_scale = weights.iter().enumerate();
            points.extend(of_scale.map(|(point, weight)| (scale, point, *weight)));
        }
        points.sort_by(|a, b| b.2.total_cmp(&a.2));
        let least = points[0].2 + PREDICTING.1;
        points.retain(|point| point.2 >= least);
        points.truncate(PREDICTING.0);
        let sum = log_sum(points.iter().map(|point| point.2));
        for point in &mut points {
            point.2 -= sum;
        }
        points
    }
}

pub(super) fn log_determinant(cholesky: &Cholesky<f64, Dyn>) -> f64 {
    let diagonal = cholesky.l_dirty().diagonal();
    2.0 * diagonal.iter().map(|x| libm::log(*x)).sum::<f64>()
}
