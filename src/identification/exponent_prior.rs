//! Prior for the sinkage exponent where the rows do not identify it.
//!
//! Rows under one load hardly separate `k_s`, `n_0` and `n_1`: along a ridge of the likelihood with constant
//! `k_s zᴺ` at the measured sinkages, the sum of squares changes by less than its noise. Its minimum is then
//! determined by the scatter of the rows, typically at a bound, where the exponent is so far from any soil's
//! that it amplifies every error of the sinkage and no other load is predicted. All points of the ridge fit
//! equally well; the estimate is the one of greatest posterior density (maximum a posteriori) with a wide
//! normal prior for `n_0`.

use super::joint::Joint;
use super::least_squares::{Minimum, Residuals, minimise, minimise_from};
use super::parameter::{Coordinates, Parameter};
use super::precision::Precision;

/// Mean and standard deviation [-] of the normal prior for `n_0`.
///
/// A round choice whose 2σ range covers plate tests: 0.11 to 0.73 on clay, 0.2 to 1.1 on loam, 0.79 to 1.1 on
/// sand, 1.4 to 1.6 on snow (Wong, *Theory of Ground Vehicles*, 2008, table of terrain values, as public
/// programs copy it) and 1.0 for nominal lunar soil.
const PRIOR: [f64; 2] = [1.0, 0.5];

/// Relative uncertainty of a force assumed where no degree of freedom gives the scatter.
const UNTESTED: f64 = 0.01;

const EXPONENT: Parameter = Parameter::SinkageExponent;

/// The residuals with the prior as an additional one.
struct WithPrior<'a> {
    joint: &'a Joint,
    /// Standard deviation of a weighted residual.
    sigma: f64,
}

impl WithPrior<'_> {
    /// Weight of a unit of `n_0`.
    fn weight(&self) -> f64 {
        self.sigma / PRIOR[1]
    }
}

impl Residuals for WithPrior<'_> {
    fn residuals(&self, at: &Coordinates) -> Vec<f64> {
        let mut residuals = self.joint.residuals(at);
        residuals.push(self.weight() * (at[EXPONENT as usize] - PRIOR[0]));
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

/// The maximum a posteriori point with its sum of squares. `None` where it fits worse than `best` by more
/// than one standard deviation, where the model misfits the rows (then the ridge is not that of their noise),
/// and where the rows drive `n_0` to a bound.
pub(super) fn maximum_a_posteriori(
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
    let with_prior = WithPrior { joint, sigma };
    let others: Vec<Parameter> = moved.iter().copied().filter(|p| *p != EXPONENT).collect();
    let mut start = best.at;
    start[EXPONENT as usize] = PRIOR[0];
    let starts = [best.at, minimise(joint, start, &others).at];
    let found = minimise_from(&with_prior, starts, moved)?;
    let chi_square = joint.residuals(&found.at).iter().map(|r| r * r).sum();
    let found = Minimum {
        chi_square,
        ..found
    };
    let moved_off = !EXPONENT.is_at_bound(found.at[EXPONENT as usize]);
    (moved_off && chi_square - best.chi_square <= sigma * sigma).then_some(found)
}
