//! Evaluation point of the model: parameters, slip and sinkage, with derivatives.

use super::parameter::{Coordinates, Parameter};
use super::row::SteadyLoad;
use crate::soil::real::{Dual, Real};
use crate::soil::wheel_load::WheelLoad;

/// Number of parameters.
const PARAMETERS: usize = Parameter::ALL.len();
/// Index of the log depth among the variables of [`Point::by_all`].
pub(super) const DEPTH: usize = PARAMETERS;
/// Index of the slip.
pub(super) const SLIP: usize = PARAMETERS + 1;
/// Number of variables.
pub(super) const ALL: usize = PARAMETERS + 2;

/// Parameters and motion of the wheel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point<T> {
    /// The parameters in the coordinates of the fit.
    pub at: [T; PARAMETERS],
    /// Sinkage [m].
    pub sinkage: T,
    /// Slip ratio [-].
    pub slip: T,
}

impl Point<f64> {
    /// Parameters `at` with the slip and sinkage of a row.
    pub fn of(at: &Coordinates, row: &SteadyLoad) -> Self {
        Self {
            at: *at,
            sinkage: row.sinkage,
            slip: row.slip,
        }
    }

    /// Differentiated by every parameter, the logarithm of the `depth` [m] for this sinkage, and slip.
    pub fn by_all(self, depth: f64) -> Point<Dual<ALL>> {
        let mut at = self.at.map(Dual::constant);
        for (place, coordinate) in at.iter_mut().enumerate() {
            coordinate.slopes[place] = 1.0;
        }
        Point {
            at,
            ..self.by_motion(depth, [DEPTH, SLIP])
        }
    }

    /// Differentiated by the logarithm of the `depth` [m] and by slip, at these indices.
    pub fn by_motion<const N: usize>(
        self,
        depth: f64,
        [log_depth, slip]: [usize; 2],
    ) -> Point<Dual<N>> {
        let mut sinkage = Dual::constant(self.sinkage);
        sinkage.slopes[log_depth] = depth;
        Point {
            at: self.at.map(Dual::constant),
            sinkage,
            slip: Dual::variable(self.slip, slip),
        }
    }
}

/// The derivatives of loads by one variable.
pub(super) fn by<const N: usize>(loads: &WheelLoad<Dual<N>>, variable: usize) -> WheelLoad {
    WheelLoad {
        normal_force: loads.normal_force.slopes[variable],
        drawbar_pull: loads.drawbar_pull.slopes[variable],
        driving_torque: loads.driving_torque.slopes[variable],
    }
}

/// The loads without derivatives.
pub(super) fn values<const N: usize>(loads: &WheelLoad<Dual<N>>) -> WheelLoad {
    WheelLoad {
        normal_force: loads.normal_force.value,
        drawbar_pull: loads.drawbar_pull.value,
        driving_torque: loads.driving_torque.value,
    }
}
