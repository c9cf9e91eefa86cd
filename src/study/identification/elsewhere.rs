//! Predictions for the rows of one group by an estimate from another.
//!
//! Where the class sets the sinkage, `k_s zᴺ` is the fitted load and does not depend on the load. For another
//! load such ground gives only pull and torque in proportion to it (Eq. 68, 69): they are predicted at the
//! measured load, and the load is that of the fit.

use super::fit::GroupRows;
use crate::identification::{
    Estimate, Force, Identification, IdentifyError, PredictedForce, SteadyLoad, Uncertainty,
};
use crate::terrain::class::Wtic;

impl GroupRows {
    /// The forces of another group as an estimate from this one predicts them.
    pub fn predict(
        &self,
        estimate: &Estimate,
        other: &Self,
    ) -> Result<Vec<PredictedForce>, IdentifyError> {
        let class = estimate.class;
        let own = self.loads(class, |_| true);
        let identification = Identification::new(&own, class, &self.setting)?;
        let mut predicted = Vec::new();
        for row in other.loads(class, |_| true) {
            let predict = |row| identification.predict_on(&other.setting, estimate, &[row]);
            let forces = predict(row)?;
            predicted.extend(match class {
                Wtic::Leis => forces,
                _ => at_measured_load(forces, row, predict)?,
            });
        }
        Ok(predicted)
    }
}

/// Forces predicted for a row, with pull and torque scaled to the measured load.
fn at_measured_load(
    forces: Vec<PredictedForce>,
    row: SteadyLoad,
    predict: impl Fn(SteadyLoad) -> Result<Vec<PredictedForce>, IdentifyError>,
) -> Result<Vec<PredictedForce>, IdentifyError> {
    let of_load = forces.into_iter().find(|of| of.force == Force::Load);
    let Some(load) = of_load else {
        return Ok(Vec::new());
    };
    let ratio = load.measured / load.predicted;
    let others = predict(times(row, 1.0 / ratio))?;
    let others = others.into_iter().filter(|of| of.force != Force::Load);
    let others = others.map(|of| PredictedForce {
        force: of.force,
        measured: of.measured * ratio,
        predicted: of.predicted * ratio,
        uncertainty: of.uncertainty.map(|sd| sd * ratio),
        half_width: of.half_width.map(|half_width| half_width * ratio),
    });
    Ok(std::iter::once(load).chain(others).collect())
}

/// A row whose forces and their uncertainties are so many times as large.
fn times(row: SteadyLoad, factor: f64) -> SteadyLoad {
    let uncertainty = |uncertainty: Uncertainty| Uncertainty {
        drawbar_pull: factor * uncertainty.drawbar_pull,
        load: factor * uncertainty.load,
        driving_torque: factor * uncertainty.driving_torque,
        ..uncertainty
    };
    SteadyLoad {
        drawbar_pull: factor * row.drawbar_pull,
        load: factor * row.load,
        driving_torque: factor * row.driving_torque,
        uncertainty: row.uncertainty.map(uncertainty),
        ..row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_predicts_pull_at_a_load_that_was_not_fitted() {
        let row = SteadyLoad {
            slip: 0.2,
            sinkage: f64::NAN,
            drawbar_pull: 180.0,
            load: 300.0,
            driving_torque: 25.2,
            uncertainty: None,
        };
        // Fitted at 100 N, where the pull is 60 N and known to 3 N.
        let predict = |row: SteadyLoad| {
            let force = |force, measured, predicted| PredictedForce {
                force,
                measured,
                predicted,
                uncertainty: None,
                half_width: Some(3.0),
            };
            Ok(vec![
                force(Force::DrawbarPull, row.drawbar_pull, 60.0),
                force(Force::Load, row.load, 100.0),
            ])
        };
        let forces = at_measured_load(predict(row).unwrap(), row, predict).unwrap();
        let [load, pull] = forces[..] else {
            panic!("{forces:?}");
        };
        assert_eq!((load.measured, load.predicted), (300.0, 100.0));
        assert!((pull.predicted - 180.0).abs() < 1e-9 && (pull.measured - 180.0).abs() < 1e-9);
        assert_eq!(pull.half_width, Some(9.0));
    }
}
