//! Relative errors of predictions from load and slip.

use super::prediction::{Predicted, Prediction, Predictor};
use super::row::SteadyLoad;
use crate::terrain::class::Wtic;
use serde::Serialize;

/// Relative errors [%] of predictions by Eq. (62)-(64) from load and slip, with the sinkage solved for.
///
/// Mean absolute error over mean absolute measured value as in [`ForceErrors`](super::ForceErrors); there the
/// loads are evaluated at the measured sinkage, whose errors are amplified by the sinkage exponent, here the
/// sinkage is predicted too. `None` where the soil does not carry a row's load, the channel was not measured,
/// or the class sets the sinkage; rows held by static friction are excluded.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PredictionErrors {
    /// Of the sinkage of the rim.
    pub sinkage: Option<f64>,
    /// Of the drawbar pull.
    pub drawbar_pull: Option<f64>,
    /// Of the driving torque.
    pub driving_torque: Option<f64>,
}

impl Predictor {
    /// Prediction for a row's load and slip; `None` where the soil does not carry the load, or static
    /// friction holds the wheel and the shear law does not apply.
    pub fn of_row(&self, row: &SteadyLoad) -> Option<Prediction> {
        let held = self.setting().is_held(row.slip, self.class());
        (!held).then(|| self.at(row.load, row.slip)).flatten()
    }

    /// Errors over `rows`.
    pub fn errors(&self, rows: &[SteadyLoad]) -> PredictionErrors {
        let counts = |row: &&SteadyLoad| !self.setting().is_held(row.slip, self.class());
        let rows = rows.iter().filter(counts);
        let rows: Vec<(SteadyLoad, Option<Prediction>)> =
            rows.map(|row| (*row, self.of_row(row))).collect();
        let error = |measured: fn(&SteadyLoad) -> f64, of: fn(&Prediction) -> Predicted| {
            let size: f64 = rows.iter().map(|(row, _)| measured(row).abs()).sum();
            let missed = rows.iter().map(|(row, prediction)| {
                let predicted = of(prediction.as_ref()?).value;
                Some((predicted - measured(row)).abs())
            });
            let missed: f64 = missed.sum::<Option<f64>>()?;
            Some(100.0 * missed / size).filter(|error| error.is_finite())
        };
        let sinkage = error(|row| row.sinkage, |prediction| prediction.sinkage);
        PredictionErrors {
            sinkage: sinkage.filter(|_| self.class() == Wtic::Leis),
            drawbar_pull: error(|row| row.drawbar_pull, |prediction| prediction.drawbar_pull),
            driving_torque: error(
                |row| row.driving_torque,
                |prediction| prediction.driving_torque,
            ),
        }
    }
}
