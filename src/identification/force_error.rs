//! Relative errors of the loads predicted (Table 7).

use super::model::Model;
use super::observation::measured;
use super::row::{self, SteadyLoad};
use crate::soil::Soil;
use crate::soil::closed_form;
use crate::soil::wheel_load::WheelLoad;

/// Relative errors [%] of the loads that Eq. (62)-(64) predict from sinkage and slip.
///
/// The paper does not say how it computes Table 7. Here it is the mean size of the error over the
/// mean size of the measured values, which a value near 0 does not upset; on hard ground (ALCT)
/// without the rows at slip 0 for pull and torque, as in the paper's Fig. 25b. `None` where no
/// row is left, all its values are 0, or the channel was not measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceErrors {
    /// Of the drawbar pull.
    pub drawbar_pull: Option<f64>,
    /// Of the load.
    pub load: Option<f64>,
    /// Of the driving torque.
    pub driving_torque: Option<f64>,
}

impl ForceErrors {
    pub(super) fn new(model: &Model, soil: &Soil, rows: &[SteadyLoad]) -> Self {
        let error = |channel: fn(&WheelLoad) -> f64, counts: &dyn Fn(&SteadyLoad) -> bool| {
            let (mut missed, mut size) = (0.0, 0.0);
            for row in rows.iter().filter(|row| counts(row)) {
                let at = (row.sinkage, row.slip);
                let predicted = closed_form::loads(model.surface(), soil, at.0, at.1);
                let value = channel(&measured(row));
                if value.is_nan() {
                    return None;
                }
                missed += (channel(&predicted) - value).abs();
                size += value.abs();
            }
            (size > 0.0).then(|| 100.0 * missed / size)
        };
        let slips = |row: &SteadyLoad| row::slips(row, model.class);
        Self {
            drawbar_pull: error(|load| load.drawbar_pull, &slips),
            load: error(|load| load.normal_force, &|_| true),
            driving_torque: error(|load| load.driving_torque, &slips),
        }
    }
}
