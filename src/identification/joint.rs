//! All rows and three channels at once (Eq. 62-64).

use super::least_squares::Residuals;
use super::model::Model;
use super::parameter::Coordinates;
use super::row::SteadyLoad;
use super::weight::{Scale, Whitener};
use crate::soil::closed_form::gradient::LoadGradient;
use crate::soil::wheel_load::WheelLoad;

/// The rows' loads against Eq. (62)-(64).
#[derive(Debug, Clone)]
pub(super) struct Joint {
    model: Model,
    rows: Vec<(SteadyLoad, Whitener)>,
}

impl Joint {
    /// The uncertainties of slip and sinkage reach the forces by the model's slopes at `at`.
    pub fn new(model: Model, rows: &[SteadyLoad], at: &Coordinates) -> Self {
        let scale = Scale::of(rows);
        let weighed = |row: &SteadyLoad| (*row, Whitener::new(&model, at, row, scale));
        Self {
            rows: rows.iter().map(weighed).collect(),
            model,
        }
    }

    /// Number of measured forces that count.
    pub fn observations(&self) -> usize {
        let channels = self.rows.iter().map(|(_, whitener)| whitener.channels());
        channels.sum()
    }
}

impl Residuals for Joint {
    fn residuals(&self, at: &Coordinates) -> Vec<f64> {
        let soil = self.model.soil(at);
        let mut residuals = Vec::with_capacity(3 * self.rows.len());
        for (row, whitener) in &self.rows {
            let predicted = self.model.contact(at, row).loads(&soil);
            residuals.extend(whitener.whiten(predicted + measured(row) * -1.0));
        }
        residuals
    }

    fn gradient(&self, at: &Coordinates) -> Vec<Coordinates> {
        let mut gradient = Vec::with_capacity(3 * self.rows.len());
        for (row, whitener) in &self.rows {
            let first = gradient.len();
            gradient.resize(first + whitener.channels(), [0.0; 8]);
            let by = derivatives(&self.model, at, row);
            for (coordinate, derivative) in by.into_iter().enumerate() {
                for (channel, value) in whitener.whiten(derivative).enumerate() {
                    gradient[first + channel][coordinate] = value;
                }
            }
        }
        gradient
    }
}

/// The loads of a row.
pub(super) fn measured(row: &SteadyLoad) -> WheelLoad {
    WheelLoad {
        normal_force: row.load,
        drawbar_pull: row.drawbar_pull,
        driving_torque: row.driving_torque,
    }
}

/// Derivatives of a row's loads by the coordinates, in their order.
pub(super) fn derivatives(model: &Model, at: &Coordinates, row: &SteadyLoad) -> [WheelLoad; 8] {
    let gradient: LoadGradient = model.contact(at, row).load_gradient(&model.soil(at));
    [
        gradient.stress_angle,
        gradient.stress_angle_slip,
        gradient.log_sinkage_modulus,
        gradient.sinkage_exponent,
        gradient.sinkage_exponent_slip,
        gradient.log_cohesion,
        gradient.friction_angle,
        gradient.log_shear_modulus,
    ]
}
