//! Relative errors of what is predicted from load and slip.

use super::prediction::{Predicted, Prediction, Predictor};
use super::row::SteadyLoad;
use crate::terrain::class::Wtic;
use serde::Serialize;

/// Relative errors [%] of what Eq. (62)-(64) predict from load and slip, sinkage solved for.
///
/// As in [`ForceErrors`](super::ForceErrors) the mean size of the error over the mean size of the
/// measured values; but there the sinkage is the one measured, whose errors the sinkage exponent
/// multiplies, and here it is predicted like the others. `None` where a row's load is not carried,
/// the channel was not measured, or the class sets the sinkage; rows held by static friction do
/// not count.
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
    /// What is predicted for a row's load and slip; `None` where the soil does not carry the load,
    /// or static friction holds the wheel, so that no shear law says its pull.
    pub fn of_row(&self, row: &SteadyLoad) -> Option<Prediction> {
        let held = self.setting().is_held(row.slip, self.class());
        (!held).then(|| self.at(row.load, row.slip)).flatten()
    }

    /// Errors over `rows`.
    pub fn errors(&self, rows: &[SteadyLoad]) -> PredictionErrors {
        let counts = |row: &&SteadyLoad| !self.setting().is_held(row.slip, self.class());
        let told = rows.iter().filter(counts);
        let told: Vec<(SteadyLoad, Option<Prediction>)> =
            told.map(|row| (*row, self.of_row(row))).collect();
        let error = |measured: fn(&SteadyLoad) -> f64, of: fn(&Prediction) -> Predicted| {
            let size: f64 = told.iter().map(|(row, _)| measured(row).abs()).sum();
            let missed = told.iter().map(|(row, prediction)| {
                let predicted = of(prediction.as_ref()?).value;
                Some((predicted - measured(row)).abs())
            });
            let missed: f64 = missed.sum::<Option<f64>>()?;
            Some(100.0 * missed / size).filter(|error| error.is_finite())
        };
        let sinkage = error(|row| row.sinkage, |told| told.sinkage);
        PredictionErrors {
            sinkage: sinkage.filter(|_| self.class() == Wtic::Leis),
            drawbar_pull: error(|row| row.drawbar_pull, |told| told.drawbar_pull),
            driving_torque: error(|row| row.driving_torque, |told| told.driving_torque),
        }
    }
}
