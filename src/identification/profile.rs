//! Profile-likelihood intervals.

use super::directions::Directions;
use super::estimate::{Identified, Unidentifiable};
use super::joint::Joint;
use super::least_squares::{Minimum, minimise_to};
use super::parameter::{Coordinates, Parameter};
use std::cell::Cell;

/// Relative change of the sum of squares at which a fit along the profile ends: of a sum of 100 a thousandth
/// remains, far below the rise at the end of an interval.
const TOLERANCE: f64 = 1e-5;

/// Tolerance on the root of the rise relative to that of the limit [-].
const NEAR: f64 = 1e-3;

/// Least first step, for data without noise.
const SHORTEST_STEP: f64 = 1e-9;

/// The profile of one parameter about a minimum.
pub(super) struct Profile<'a> {
    pub joint: Joint,
    pub best: Minimum,
    /// Local linear model at the minimum.
    pub directions: &'a Directions,
    /// The parameters varied in a fit.
    pub moved: &'a [Parameter],
    /// Rise of the sum of squares at the ends of the interval.
    pub limit: f64,
    /// A lower minimum found along the profile.
    pub lower: Cell<Option<Minimum>>,
}

impl Profile<'_> {
    /// Adds the profile interval of a parameter. It counts as identified only if both covariance and profile
    /// bound it: the covariance is not limited by the ranges of the other parameters, the profile accounts
    /// for nonlinearity.
    pub fn complete(&self, identified: &mut Identified) {
        let parameter = identified.parameter;
        if parameter.is_as_good_as_zero(self.best.at[parameter as usize]) {
            return self.complete_none(identified);
        }
        let ends = self.interval(identified);
        identified.profile = Some(ends.map(|end| end.map(|end| parameter.value(end))));
        let both = ends[0].zip(ends[1]);
        let by_itself = matches!(identified.unidentifiable, None | Some(Unidentifiable::Wide));
        match both {
            None if by_itself => identified.mark_unidentifiable(Unidentifiable::Unbounded),
            Some((low, high)) if by_itself && high - low > 2.0 * parameter.uninformative() => {
                identified.mark_unidentifiable(Unidentifiable::Wide);
            }
            _ => {}
        }
    }

    /// Records a minimum lower by more than the tolerance of a fit.
    fn record(&self, found: Minimum) {
        let known = self.lower.get().unwrap_or(self.best).chi_square;
        if found.chi_square < known - 1e-3 * (1.0 + known) {
            self.lower.set(Some(found));
        }
    }

    /// Upper limit of a parameter estimated as zero.
    fn complete_none(&self, identified: &mut Identified) {
        let parameter = identified.parameter;
        let [_, high] = parameter.bounds();
        let end = self.end(parameter, parameter.uninformative(), high);
        identified.profile = Some([Some(0.0), end.map(|end| parameter.value(end))]);
    }

    /// Coordinates between which the sum of squares rises by less than the limit; `None` where that is so up
    /// to the bound of the search, and for an unbounded parameter.
    fn interval(&self, identified: &Identified) -> [Option<f64>; 2] {
        if !self.limit.is_finite() || !identified.standard_error.is_finite() {
            return [None; 2];
        }
        let parameter = identified.parameter;
        // The half-width in the linear model.
        let own = self.unit(parameter);
        let variance = self.directions.covariance(&own, &own).unwrap_or(0.0);
        let guess = libm::sqrt(self.limit * variance);
        let step = guess.clamp(SHORTEST_STEP, parameter.uninformative());
        let [low, high] = parameter.bounds();
        [
            self.end(parameter, -step, low),
            self.end(parameter, step, high),
        ]
    }

    fn unit(&self, of: Parameter) -> Vec<f64> {
        self.directions
            .function(|parameter| f64::from(u8::from(parameter == of)))
    }

    /// Regression of the other coordinates on that of a parameter in the linear model; zero for one that is
    /// not identified.
    fn way(&self, parameter: Parameter) -> Coordinates {
        let own = self.unit(parameter);
        let variance = self.directions.covariance(&own, &own);
        let Some(variance) = variance.filter(|variance| *variance > 0.0) else {
            return [0.0; 8];
        };
        Parameter::ALL.map(|other| {
            let shared = self.directions.covariance(&self.unit(other), &own);
            shared.map_or(0.0, |shared| shared / variance)
        })
    }

    fn end(&self, parameter: Parameter, step: f64, bound: f64) -> Option<f64> {
        let others: Vec<Parameter> = self
            .moved
            .iter()
            .copied()
            .filter(|p| *p != parameter)
            .collect();
        let start = self.best.at[parameter as usize];
        let reach = (bound - start).abs();
        let mut way = self.way(parameter);
        // In a linear model the root of the rise is linear in the distance.
        let mut excess = |distance: f64| {
            let moved = distance * step.signum();
            let mut trial = self.best.at;
            for (coordinate, way) in trial.iter_mut().zip(way) {
                *coordinate += moved * way;
            }
            trial[parameter as usize] = start + moved;
            let found = minimise_to(TOLERANCE, &self.joint, trial, &others);
            self.record(found);
            let rise = (found.chi_square - self.best.chi_square).max(0.0);
            if rise < self.limit {
                way = std::array::from_fn(|i| {
                    if found.at[i] == self.best.at[i] {
                        0.0
                    } else {
                        (found.at[i] - self.best.at[i]) / moved
                    }
                });
            }
            libm::sqrt(rise / self.limit) - 1.0
        };
        let mut inside = End {
            at: 0.0,
            excess: -1.0,
        };
        let mut distance = step.abs().min(reach);
        let outside = loop {
            let end = End {
                at: distance,
                excess: excess(distance),
            };
            if end.excess.abs() < NEAR {
                return Some(start + distance * step.signum());
            }
            if end.excess > 0.0 {
                break end;
            }
            if distance >= reach {
                return None;
            }
            inside = end;
            // Slightly beyond the linear crossing.
            let straight = 1.02 / (end.excess + 1.0);
            distance = (distance * straight.min(2.0)).min(reach);
        };
        Some(start + crossing(excess, inside, outside) * step.signum())
    }
}

/// An end of the interval that brackets a crossing.
#[derive(Clone, Copy)]
struct End {
    at: f64,
    excess: f64,
}

/// Root of `excess` to [`NEAR`] by false position that halves the value retained twice at an end (Illinois).
fn crossing(mut excess: impl FnMut(f64) -> f64, mut inside: End, mut outside: End) -> f64 {
    const STEPS: u32 = 40;
    let mut kept_inside = false;
    let mut kept_outside = false;
    for _ in 0..STEPS {
        let middle =
            inside.at - inside.excess * (outside.at - inside.at) / (outside.excess - inside.excess);
        let value = excess(middle);
        if value.abs() < NEAR {
            return middle;
        }
        let end = End {
            at: middle,
            excess: value,
        };
        if value < 0.0 {
            inside = end;
            outside.excess *= if kept_outside { 0.5 } else { 1.0 };
            (kept_inside, kept_outside) = (false, true);
        } else {
            outside = end;
            inside.excess *= if kept_inside { 0.5 } else { 1.0 };
            (kept_inside, kept_outside) = (true, false);
        }
    }
    0.5 * (inside.at + outside.at)
}
