//! The sinkage exponent where rows leave it open.
//!
//! Rows under one load hardly tell `k_s`, `n_0` and `n_1` apart: along a ridge of the likelihood,
//! on which `k_s zᴺ` stays the same at the sinkages measured, the sum of squares changes by less
//! than its noise, and its minimum stands where the scatter of the rows happens to put it, as a
//! rule at the end of a range. There the exponent is so far from any soil's that the equations
//! multiply each error of the sinkage, and no other load is predicted. Every other point of the
//! ridge explains the rows as well; the one told is that of the greatest posterior density with a
//! wide normal prior for `n_0`.

use super::joint::Joint;
use super::least_squares::{Minimum, Residuals, minimise, minimise_from};
use super::parameter::{Coordinates, Parameter};
use super::precision::Precision;

/// Mean and standard deviation [-] of the sinkage exponents `n_0` of soils.
///
/// A round choice, which holds within 2 deviations what plates gave: 0.11 to 0.73 on clay, 0.2 to
/// 1.1 on loam, 0.79 to 1.1 on sand, 1.4 to 1.6 on snow (Wong, *Theory of Ground Vehicles*, 2008,
/// table of terrain values, as public programs copy it) and 1.0 for nominal lunar soil.
const USUAL: [f64; 2] = [1.0, 0.5];

/// Uncertainty of a force over its size that stands for the scatter where no freedom shows it.
const UNTESTED: f64 = 0.01;

const EXPONENT: Parameter = Parameter::SinkageExponent;

/// The rows and the prior.
struct Preferring<'a> {
    joint: &'a Joint,
    /// Standard deviation of a weighted residual.
    sigma: f64,
}

impl Preferring<'_> {
    /// Weight of a unit of `n_0`.
    fn weight(&self) -> f64 {
        self.sigma / USUAL[1]
    }
}

impl Residuals for Preferring<'_> {
    fn residuals(&self, at: &Coordinates) -> Vec<f64> {
        let mut residuals = self.joint.residuals(at);
        residuals.push(self.weight() * (at[EXPONENT as usize] - USUAL[0]));
        residuals
    }

    fn gradient(&self, at: &Coordinates) -> Vec<Coordinates> {
        let mut gradient = self.joint.gradient(at);
        let mut by = [0.0; 8];
        by[EXPONENT as usize] = self.weight();
        gradient.push(by);
        gradient
    }
}

/// The point with the most usual `n_0` that explains the rows as `best` does, with their sum of
/// squares. `None` where it would explain them worse by more than one standard deviation, and where
/// the model misses them: there the ridge is not that of their noise. Nor where the rows hold `n_0` at
/// the end of its range.
pub(super) fn point(
    joint: &Joint,
    best: &Minimum,
    moved: &[Parameter],
    precision: Precision,
) -> Option<Minimum> {
    if precision.misfit.is_some() {
        return None;
    }
    let sigma = if precision.sigma.is_finite() {
        precision.sigma
    } else {
        UNTESTED
    };
    let preferring = Preferring { joint, sigma };
    let others: Vec<Parameter> = moved.iter().copied().filter(|p| *p != EXPONENT).collect();
    let mut usual = best.at;
    usual[EXPONENT as usize] = USUAL[0];
    let starts = [best.at, minimise(joint, usual, &others).at];
    let found = minimise_from(&preferring, starts, moved)?;
    let chi_square = joint.residuals(&found.at).iter().map(|r| r * r).sum();
    let found = Minimum {
        chi_square,
        ..found
    };
    let moved_off = !EXPONENT.is_at_bound(found.at[EXPONENT as usize]);
    (moved_off && chi_square - best.chi_square <= sigma * sigma).then_some(found)
}
