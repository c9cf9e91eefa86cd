//! Relative errors of the fitted loads (Table 7).

use super::forces::{Force, PredictedForce, forces};
use super::model::Model;
use super::parameter::Coordinates;
use super::row::SteadyLoad;
use serde::Serialize;
use std::f64::consts::PI;

/// Relative errors [%] of the loads by Eq. (62)-(64) at the measured sinkage and slip.
///
/// The paper does not define the error of Table 7. Here it is the mean absolute error over the mean absolute
/// measured value, which is robust to values near 0; on hard ground (ALCT) rows at slip 0 are excluded for
/// pull and torque, as in the paper's Fig. 25b. `None` where no row remains, all values are 0, or the channel
/// was not measured.
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
    /// Errors of a set of predictions.
    pub fn of(predicted: &[PredictedForce]) -> Self {
        Self::by(predicted, |force| {
            Some((force.predicted - force.measured).abs())
        })
    }

    /// Expected errors of a correct model given the stated uncertainties: `√(2/π)` times these. `None` where
    /// a row states none.
    pub fn of_scatter(predicted: &[PredictedForce]) -> Self {
        let mean_size = libm::sqrt(2.0 / PI);
        Self::by(predicted, |force| Some(mean_size * force.uncertainty?))
    }

    fn by(predicted: &[PredictedForce], missed: impl Fn(&PredictedForce) -> Option<f64>) -> Self {
        let error = |force: Force| {
            let of_force = || {
                predicted
                    .iter()
                    .filter(move |predicted| predicted.force == force)
            };
            let size: f64 = of_force().map(|force| force.measured.abs()).sum();
            let missed: Option<f64> = of_force().map(&missed).sum();
            missed
                .filter(|_| size > 0.0)
                .map(|missed| 100.0 * missed / size)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn load(measured: f64, predicted: f64, uncertainty: Option<f64>) -> PredictedForce {
        PredictedForce {
            force: Force::Load,
            measured,
            predicted,
            uncertainty,
            half_width: None,
        }
    }

    #[test]
    fn force_errors_are_mean_errors_over_mean_values() {
        let predicted = [
            load(125.0, 100.0, Some(10.0)),
            load(75.0, 100.0, Some(10.0)),
        ];
        let errors = ForceErrors::of(&predicted);
        assert_eq!((errors.load, errors.drawbar_pull), (Some(25.0), None));
        // The mean absolute value of a normal error is 0.798 of its standard deviation.
        let scatter = ForceErrors::of_scatter(&predicted).load.unwrap();
        assert!((scatter - 7.98).abs() < 0.01, "{scatter}");
        let unstated = [load(125.0, 100.0, None), predicted[1]];
        assert_eq!(ForceErrors::of_scatter(&unstated).load, None);
    }

    #[test]
    fn the_mean_of_rows_is_surer_than_each_by_the_root_of_their_number() {
        let rows = [load(125.0, 90.0, Some(2.0)), load(75.0, 90.0, Some(2.0))];
        let means = PredictedForce::means(&rows);
        assert_eq!(means.len(), 1);
        assert_eq!((means[0].measured, means[0].predicted), (100.0, 90.0));
        let expected = 2.0 / libm::sqrt(2.0);
        assert!((means[0].uncertainty.unwrap() - expected).abs() < 1e-12);
    }
}
