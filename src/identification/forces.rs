//! Forces predicted by an estimate from slip and sinkage, also for rows not used in the fit.

use super::directions::Directions;
use super::model::Model;
use super::observation::{measured, variances};
use super::parameter::Coordinates;
use super::point::{Point, by};
use super::precision::Precision;
use super::row::{SteadyLoad, Uncertainty};
use super::weight::Scale;
use crate::soil::wheel_load::WheelLoad;
use serde::Serialize;

/// A force of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Force {
    /// Drawbar pull \[N\].
    DrawbarPull,
    /// Vertical load \[N\].
    Load,
    /// Driving torque [N·m].
    DrivingTorque,
}

impl Force {
    /// All of them, in the order of Table 7.
    pub const ALL: [Self; 3] = [Self::DrawbarPull, Self::Load, Self::DrivingTorque];

    /// Its name in results.
    pub fn name(self) -> &'static str {
        ["drawbar_pull", "load", "driving_torque"][self as usize]
    }

    /// Its standard uncertainty [N; torque N·m] among a row's.
    fn uncertainty(self, of: &Uncertainty) -> f64 {
        match self {
            Self::DrawbarPull => of.drawbar_pull,
            Self::Load => of.load,
            Self::DrivingTorque => of.driving_torque,
        }
    }

    /// Its value [N; torque N·m] among the loads of a wheel.
    fn of(self, loads: &WheelLoad) -> f64 {
        match self {
            Self::DrawbarPull => loads.drawbar_pull,
            Self::Load => loads.normal_force,
            Self::DrivingTorque => loads.driving_torque,
        }
    }
}

/// A force of a row, measured and predicted [N; torque N·m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedForce {
    /// Which force.
    pub force: Force,
    /// Measured.
    pub measured: f64,
    /// Predicted from the row's slip and sinkage.
    pub predicted: f64,
    /// Standard uncertainty of the measured value, where the row states it.
    pub uncertainty: Option<f64>,
    /// Half-width of the 95 % prediction interval; `None` where a parameter it depends on is not identified.
    pub half_width: Option<f64>,
}

impl PredictedForce {
    /// Mean of each force over several rows, without intervals; uncertainties are treated as independent.
    pub fn means(predicted: &[Self]) -> Vec<Self> {
        let mean = |force: Force| {
            let of_force = || {
                predicted
                    .iter()
                    .filter(move |predicted| predicted.force == force)
            };
            let count = of_force().count() as f64;
            let mean = |value: fn(&Self) -> f64| of_force().map(value).sum::<f64>() / count;
            let squares: Option<f64> = of_force()
                .map(|force| force.uncertainty.map(|sd| sd * sd))
                .sum();
            (count > 0.0).then(|| Self {
                force,
                measured: mean(|force| force.measured),
                predicted: mean(|force| force.predicted),
                uncertainty: squares.map(|squares| libm::sqrt(squares) / count),
                half_width: None,
            })
        };
        Force::ALL.into_iter().filter_map(mean).collect()
    }

    /// Whether the interval covers the measured value; `None` without an interval.
    pub fn is_covered(&self) -> Option<bool> {
        let miss = (self.predicted - self.measured).abs();
        self.half_width.map(|half_width| miss <= half_width)
    }
}

/// The forces of a row described by the model of the class (Eq. 62-64), without intervals: all that were
/// measured; on hard ground only the load where static friction holds the wheel.
pub(super) fn forces(
    model: &Model,
    at: &Coordinates,
    row: &SteadyLoad,
) -> impl Iterator<Item = PredictedForce> + use<> {
    let predicted = model.loads(&Point::of(at, row));
    let measured = measured(row);
    let uncertainty = row.uncertainty;
    let slips = !model.setting.holds_by_friction(row, model.class);
    let forces = Force::ALL.into_iter();
    forces
        .filter(move |force| slips || *force == Force::Load)
        .filter(move |force| !force.of(&measured).is_nan())
        .map(move |force| PredictedForce {
            force,
            measured: force.of(&measured),
            predicted: force.of(&predicted),
            uncertainty: uncertainty.map(|uncertainty| force.uncertainty(&uncertainty)),
            half_width: None,
        })
}

/// Local model of an estimate, for the intervals of its predictions.
pub(super) struct Knowledge<'a> {
    pub model: &'a Model,
    pub at: Coordinates,
    pub directions: Directions,
    pub precision: Precision,
    pub scale: Scale,
}

impl Knowledge<'_> {
    /// The forces of a row with intervals from the uncertainty of the estimate and the scatter of the rows
    /// fitted.
    pub fn forces(&self, row: &SteadyLoad) -> impl Iterator<Item = PredictedForce> {
        let derivatives = self.model.derivatives(Point::of(&self.at, row));
        let scatter = variances(self.model, &self.at, row, self.scale.of_row(row));
        forces(self.model, &self.at, row).map(move |predicted| {
            let force = predicted.force;
            let function = self
                .directions
                .function(|p| force.of(&by(&derivatives, p as usize)));
            let own = self.directions.covariance(&function, &function);
            let half_width =
                own.map(|own| self.precision.half_width() * libm::sqrt(own + force.of(&scatter)));
            PredictedForce {
                half_width: half_width.filter(|half_width| half_width.is_finite()),
                ..predicted
            }
        })
    }
}
