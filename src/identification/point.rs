//! Where the model is evaluated: parameters, slip and sinkage, with the derivatives asked for.

use super::parameter::{Coordinates, Parameter};
use super::row::SteadyLoad;
use crate::soil::real::{Dual, Real};
use crate::soil::wheel_load::WheelLoad;

/// Number of parameters.
const PARAMETERS: usize = Parameter::ALL.len();
/// Place of the logarithm of the depth among the variables of [`Point::by_all`].
pub(super) const DEPTH: usize = PARAMETERS;
/// Place of the slip among them.
pub(super) const SLIP: usize = PARAMETERS + 1;
/// Number of those variables.
pub(super) const ALL: usize = PARAMETERS + 2;

/// Parameters and a wheel's motion.
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
    /// Parameters `at` under the motion of a row.
    pub fn of(at: &Coordinates, row: &SteadyLoad) -> Self {
        Self {
            at: *at,
            sinkage: row.sinkage,
            slip: row.slip,
        }
    }

    /// Varied in every parameter, in the logarithm of the `depth` [m] that goes with the sinkage,
    /// and in slip.
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

    /// Varied in the logarithm of the `depth` [m] that goes with the sinkage and in slip, the
    /// variables of these places.
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
