//! Statistics as functions of parameters and effects, with the scatter about them.
//!
//! In condition `c` the standardised statistics of a rig are
//!
//! ```text
//! z_c = B_c φ(θ) + Σ_e D_ce g(u_e) + ε_c,     ε_c ~ N(0, Σ_c)
//! ```
//!
//! with the rig's parameters `θ` [prior standard deviations], `φ(θ) = (1, θ_i, θ_i θ_j)`, and for each of its effects
//! `g(u) = (R^(u−½), 1, v)`, `v = 2u − 1`, of the size `u` (0 at the low, 1 at the high level), where `R` is how many times
//! farther from neutral the high level is than the low one: an effect that statistics follow linearly needs the first
//! coefficient alone, and the penalty of the others is larger.
//!
//! The coefficients are a ridge regression over all rigs. Rows of a rig share the motion, and with it most of their scatter,
//! so that the regression is one of generalised least squares with equal correlation within rigs: what effects of the
//! sensors do shows in differences between rows of one rig; they are then shrunk to what is more than noise. `Σ_c` is what
//! remains, pooled over rigs: replicates, the solver's step, effects that follow another law, and what the functions do not
//! follow.
//! Conditions are independent given `θ`: they share no ground and no noise.
//!
//! What is whitened by `Σ_c` and projected on the span of all columns of `B` and `D` keeps every likelihood ratio between
//! causes (Heavens, Jimenez and Lahav 2000, MNRAS 317:965): some 200 scores stand for thousands of statistics. Residuals are
//! those of a regression without the rig itself, so that `Σ_c` and the scores' unit have the emulator's own error in them.
//! The scores' covariance is not estimated once more: from some 200 rigs an estimate of it overstates what is known of rigs
//! that had no part in it, and the best linear shrinkage (OAS, Chen et al. 2010, IEEE Trans. Signal Process. 58:5016) of it
//! is the identity.

use super::ablation::Ablation;
use super::covariance::{Covariance, covariances};
use super::place::{CURVE, Place};
use super::shrinkage::{Noise, shrink};
use crate::diagnosis::rigs::{Part, Row};
use crate::statistics::upper_median;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, RowDVector, SymmetricEigen};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Penalty of an effect's coefficients [rows], and of the parameters'.
const RIDGE: [f64; CURVE] = [1.0, 10.0, 10.0];
const PARAMETER_RIDGE: f64 = 0.1;
/// Variance [-] of rows of one rig about each other over that of the motions that they share.
const WITHIN: f64 = 0.1;
/// Bounds of `R`.
const GROWTHS: [f64; 2] = [1.2, 30.0];
/// Noise variance [-] that every statistic has at least.
const LEAST_VARIANCE: f64 = 1.0e-6;
/// Eigenvalue over the largest [-] below which a direction is none.
const RANK: f64 = 1.0e-10;

/// `g(u)`, of an effect that grows so many times from the low to the high level.
fn curve(growth: f64, size: f64) -> [f64; CURVE] {
    let [least, most] = GROWTHS;
    let grown = libm::pow(growth.clamp(least, most), size - 0.5);
    [grown, 1.0, 2.0 * size - 1.0]
}

/// `φ(θ)`.
pub fn features(parameters: &[f64]) -> Vec<f64> {
    let mut features = vec![1.0];
    features.extend(parameters);
    for (i, a) in parameters.iter().enumerate() {
        features.extend(parameters[i..].iter().map(|b| a * b));
    }
    features
}

/// Derivatives of `φ` with respect to the parameters, one a row.
pub fn slopes(parameters: &[f64]) -> DMatrix<f64> {
    let count = parameters.len();
    let mut slopes = DMatrix::zeros(count, features(parameters).len());
    for i in 0..count {
        slopes[(i, 1 + i)] = 1.0;
    }
    let mut place = 1 + count;
    for i in 0..count {
        for j in i..count {
            slopes[(i, place)] += parameters[j];
            slopes[(j, place)] += parameters[i];
            place += 1;
        }
    }
    slopes
}

/// What is known of a rig.
#[derive(Debug, Clone, Copy)]
pub struct Labels<'a> {
    /// Its parameters.
    pub parameters: &'a [f64],
    /// Its effects.
    pub effects: &'a [Part],
}

impl<'a> From<&'a Row> for Labels<'a> {
    fn from(row: &'a Row) -> Self {
        Self {
            parameters: &row.parameters,
            effects: &row.effects,
        }
    }
}

/// A trained emulator, in whitened scores.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Emulator {
    /// Number of parameters, and of their features.
    parameters: usize,
    features: usize,
    /// `R` of each effect.
    growths: Vec<f64>,
    /// Scores of standardised statistics: columns by scores.
    projection: DMatrix<f64>,
    /// Coefficients of the scores: parameter features, then each effect's.
    pub coefficients: DMatrix<f64>,
    /// Coefficients of the standardised statistics for parameters only.
    of_parameters: DMatrix<f64>,
    /// Standard deviation of the standardised statistics about the emulator.
    deviations: Vec<f64>,
}

/// Where the regression takes place.
pub struct Training<'a> {
    /// Standardised statistics, a row a measurement.
    pub standardised: DMatrix<f64>,
    /// Labels of the rows.
    pub labels: Vec<Labels<'a>>,
    /// Where each column belongs.
    pub places: &'a [Place],
    /// `R` of each candidate.
    pub growths: &'a [f64],
    /// Rig of each row.
    pub rigs: Vec<u64>,
    /// A part of the model that is left out.
    pub ablation: Option<Ablation>,
}

impl Training<'_> {
    fn design(&self) -> DMatrix<f64> {
        let first = self.labels.first();
        let count = first.map_or(1, |it| features(it.parameters).len());
        let mut design = DMatrix::zeros(self.labels.len(), count + CURVE * self.growths.len());
        for (row, labels) in self.labels.iter().enumerate() {
            for (place, feature) in features(labels.parameters).into_iter().enumerate() {
                design[(row, place)] = feature;
            }
            for part in labels.effects {
                let curve = curve(self.growths[part.candidate], part.size);
                for (place, value) in curve.into_iter().enumerate() {
                    design[(row, count + CURVE * part.candidate + place)] += value;
                }
            }
        }
        design
    }
}

impl Emulator {
    /// The regression, its residuals' covariance and the projection.
    pub fn train(training: &Training) -> Option<Self> {
        let design = training.design();
        let features = design.ncols() - CURVE * training.growths.len();
        let groups = groups(&training.rigs);
        let regression = Regression {
            independent: decorrelated(&design, &groups),
            target: decorrelated(&training.standardised, &groups),
            features,
        };
        let solved = regression.solve()?;
        let standardised = &training.standardised;
        let residuals = match training.ablation {
            Some(Ablation::EmulatorError) => standardised - &design * &solved.coefficients,
            _ => solved.left_out(standardised, &design, &groups)?,
        };
        let coefficients = solved.shrunk(training.places);
        let columns = training.places.len();
        let mut whitened = DMatrix::zeros(coefficients.nrows(), columns);
        let mut factors = Vec::new();
        let mut deviations = vec![1.0; columns];
        for mut covariance in covariances(&residuals, training.places, groups.len()) {
            if training.ablation == Some(Ablation::Correlations) {
                covariance.matrix = DMatrix::from_diagonal(&covariance.matrix.diagonal());
            }
            let Covariance {
                columns: own,
                matrix,
            } = covariance;
            for (place, column) in own.iter().enumerate() {
                deviations[*column] = libm::sqrt(matrix[(place, place)]);
            }
            let factor = Cholesky::new(matrix)?.unpack();
            let part = coefficients.select_columns(&own).transpose();
            let part = factor.solve_lower_triangular(&part)?.transpose();
            for (place, column) in own.iter().enumerate() {
                whitened.set_column(*column, &part.column(place));
            }
            factors.push((own, factor));
        }
        let basis = basis(&whitened)?;
        // P = L⁻ᵀ V, condition by condition: scores are zᵀ P.
        let mut projection = DMatrix::zeros(columns, basis.ncols());
        for (own, factor) in &factors {
            let part = basis.select_rows(own);
            let part = factor.tr_solve_lower_triangular(&part)?;
            for (place, column) in own.iter().enumerate() {
                projection.set_row(*column, &part.row(place));
            }
        }
        let unit = unit(&(&residuals * &projection));
        Some(Self {
            parameters: training.labels.first()?.parameters.len(),
            features,
            growths: training.growths.to_vec(),
            coefficients: &whitened * &basis / unit,
            projection: projection / unit,
            of_parameters: coefficients.rows(0, features).into_owned(),
            deviations,
        })
    }

    /// Scores of one standardised row.
    pub fn scores(&self, standardised: &[f64]) -> DVector<f64> {
        let row = RowDVector::from_row_slice(standardised);
        (row * &self.projection).transpose()
    }

    /// Number of scores.
    pub fn len(&self) -> usize {
        self.projection.ncols()
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// Number of effects.
    pub fn effects(&self) -> usize {
        self.growths.len()
    }

    /// `g(u)` of an effect.
    pub fn curve(&self, effect: usize, size: f64) -> [f64; CURVE] {
        curve(self.growths[effect], size)
    }

    /// Scores at these parameters without effects, and their derivatives, one parameter a row.
    pub fn at(&self, parameters: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
        let own = self.coefficients.rows(0, self.features);
        let features = RowDVector::from_row_slice(&features(parameters));
        ((features * own).transpose(), slopes(parameters) * own)
    }

    /// Coefficients of an effect's curve, one a column.
    pub fn effect(&self, effect: usize) -> DMatrix<f64> {
        let first = self.features + CURVE * effect;
        self.coefficients.rows(first, CURVE).transpose()
    }

    /// Standard deviations of the standardised statistics about the emulator.
    pub fn deviations(&self) -> &[f64] {
        &self.deviations
    }

    /// Standardised statistics at these parameters without effects.
    pub fn statistics(&self, parameters: &[f64]) -> Vec<f64> {
        let features = RowDVector::from_row_slice(&features(parameters));
        let row = features * &self.of_parameters;
        row.iter().copied().collect()
    }

    /// Derivatives of the standardised statistics with respect to the parameters, one a row.
    pub fn statistic_slopes(&self, parameters: &[f64]) -> DMatrix<f64> {
        slopes(parameters) * &self.of_parameters
    }
}

/// Rows of each rig.
fn groups(rigs: &[u64]) -> Vec<Vec<usize>> {
    let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (row, rig) in rigs.iter().enumerate() {
        groups.entry(*rig).or_default().push(row);
    }
    groups.into_values().collect()
}

/// Rows in which those of one rig are no longer correlated: less a part of their mean, and in units of their scatter about
/// each other.
fn decorrelated(rows: &DMatrix<f64>, groups: &[Vec<usize>]) -> DMatrix<f64> {
    let mut decorrelated = rows.clone();
    for own in groups {
        let count = own.len() as f64;
        let part = 1.0 - libm::sqrt(WITHIN / (WITHIN + count));
        let mean = rows.select_rows(own).row_mean() * part;
        for row in own {
            let mut row = decorrelated.row_mut(*row);
            row -= &mean;
        }
    }
    decorrelated / libm::sqrt(WITHIN / (1.0 + WITHIN))
}

/// A ridge regression of decorrelated rows.
struct Regression {
    independent: DMatrix<f64>,
    target: DMatrix<f64>,
    /// Number of parameter features, which come first.
    features: usize,
}

/// Penalty of a coefficient: none of the constant.
fn penalty(place: usize, features: usize) -> f64 {
    match place.checked_sub(features) {
        Some(of_effect) => RIDGE[of_effect % CURVE],
        None if place == 0 => 0.0,
        None => PARAMETER_RIDGE,
    }
}

/// A regression with its coefficients.
struct Solved {
    regression: Regression,
    normal: Cholesky<f64, Dyn>,
    coefficients: DMatrix<f64>,
}

impl Regression {
    fn solve(self) -> Option<Solved> {
        let mut normal = self.independent.tr_mul(&self.independent);
        for place in 0..normal.nrows() {
            normal[(place, place)] += penalty(place, self.features);
        }
        let normal = Cholesky::new(normal)?;
        Some(Solved {
            coefficients: normal.solve(&self.independent.tr_mul(&self.target)),
            normal,
            regression: self,
        })
    }
}

impl Solved {
    /// The coefficients, those of effects shrunk to what is more than noise.
    fn shrunk(&self, places: &[Place]) -> DMatrix<f64> {
        let Regression {
            independent,
            target,
            features,
        } = &self.regression;
        let inverse = self.normal.inverse();
        let penalties =
            (0..inverse.nrows()).map(|place| penalty(place, *features) * inverse[(place, place)]);
        let free = independent.nrows() as f64 - inverse.nrows() as f64 + penalties.sum::<f64>();
        let residuals = target - independent * &self.coefficients;
        let variance = |column: usize| residuals.column(column).norm_squared() / free.max(1.0);
        let variances = (0..places.len()).map(|column| variance(column).max(LEAST_VARIANCE));
        let mut coefficients = self.coefficients.clone();
        let noise = Noise {
            inverse: &inverse,
            variances: &variances.collect::<Vec<f64>>(),
        };
        shrink(&mut coefficients, *features, &noise, places);
        coefficients
    }

    /// Residuals of rows by the regression without their rig, whose coefficients are `B − A⁻¹ X_gᵀ (1 − H_gg)⁻¹ e_g`, with the
    /// rig's block of the hat matrix.
    fn left_out(
        &self,
        rows: &DMatrix<f64>,
        design: &DMatrix<f64>,
        groups: &[Vec<usize>],
    ) -> Option<DMatrix<f64>> {
        let Regression {
            independent,
            target,
            ..
        } = &self.regression;
        let mut residuals = rows - design * &self.coefficients;
        for own in groups {
            let used = independent.select_rows(own);
            let solved = self.normal.solve(&used.transpose());
            let rest = DMatrix::identity(own.len(), own.len()) - &used * &solved;
            let error = target.select_rows(own) - &used * &self.coefficients;
            let change = design.select_rows(own) * solved * rest.lu().solve(&error)?;
            for (place, row) in own.iter().enumerate() {
                let mut row = residuals.row_mut(*row);
                row += change.row(place);
            }
        }
        Some(residuals)
    }
}

/// Root mean square of the scores of a row about the emulator, the median over rows: in some, effects follow another law.
fn unit(scores: &DMatrix<f64>) -> f64 {
    let squares = scores.row_iter().map(|row| row.norm_squared());
    let median = upper_median(squares).unwrap_or(1.0);
    libm::sqrt(median / scores.ncols() as f64)
}

/// Orthonormal columns that span all rows but the first, which is what all causes have in common: from the smaller of both
/// Gram matrices, as the other is singular.
fn basis(rows: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let rows = rows.rows(1, rows.nrows() - 1);
    let is_tall = rows.nrows() > rows.ncols();
    let gram = if is_tall {
        rows.tr_mul(&rows)
    } else {
        rows * rows.transpose()
    };
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = SymmetricEigen::<f64, Dyn>::new(gram);
    let largest = eigenvalues.max();
    let kept: Vec<usize> = (0..eigenvalues.len())
        .filter(|place| eigenvalues[*place] > RANK * largest)
        .collect();
    if kept.is_empty() {
        return None;
    }
    let vectors = eigenvectors.select_columns(&kept);
    let mut basis = if is_tall {
        vectors
    } else {
        rows.tr_mul(&vectors)
    };
    for mut column in basis.column_iter_mut() {
        let norm = column.norm();
        column.unscale_mut(norm);
    }
    // The decomposition of a matrix that is no number has none.
    basis.iter().all(|x| x.is_finite()).then_some(basis)
}
