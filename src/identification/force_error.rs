//! Relative errors of the loads predicted (Table 7).

use super::model::Model;
use super::parameter::Coordinates;
use super::prediction::{Force, Predicted, forces};
use super::row::SteadyLoad;
use serde::Serialize;

/// Relative errors [%] of the loads that Eq. (62)-(64) predict from sinkage and slip.
///
/// The paper does not say how it computes Table 7. Here it is the mean size of the error over the
/// mean size of the measured values, which a value near 0 does not upset; on hard ground (ALCT)
/// without the rows at slip 0 for pull and torque, as in the paper's Fig. 25b. `None` where no
/// row is left or all its values are 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ForceErrors {
    /// Of the drawbar pull.
    pub drawbar_pull: Option<f64>,
    /// Of the load.
    pub load: Option<f64>,
    /// Of the driving torque.
    pub driving_torque: Option<f64>,
}

impl ForceErrors {
    /// The errors of some predictions.
    pub fn of(predicted: &[Predicted]) -> Self {
        let error = |force: Force| {
            let (mut missed, mut size) = (0.0, 0.0);
            for told in predicted.iter().filter(|told| told.force == force) {
                missed += (told.predicted - told.measured).abs();
                size += told.measured.abs();
            }
            (size > 0.0).then(|| 100.0 * missed / size)
        };
        Self {
            drawbar_pull: error(Force::DrawbarPull),
            load: error(Force::Load),
            driving_torque: error(Force::DrivingTorque),
        }
    }

    /// The error [%] of one force.
    pub fn get(&self, force: Force) -> Option<f64> {
        match force {
            Force::DrawbarPull => self.drawbar_pull,
            Force::Load => self.load,
            Force::DrivingTorque => self.driving_torque,
        }
    }

    pub(super) fn new(model: &Model, at: &Coordinates, rows: &[SteadyLoad]) -> Self {
        let predicted = rows.iter().flat_map(|row| forces(model, at, row));
        Self::of(&predicted.collect::<Vec<_>>())
    }
}
