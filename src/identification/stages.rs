//! The paper's three least-squares stages on its decoupled equations (Eq. 73-76).

use super::least_squares::{Minimum, Residuals, Termination, minimise_from};
use super::model::Model;
use super::parameter::{Coordinates, Parameter, TerrainParameters};
use super::row::SteadyLoad;
use super::weight::Scale;
use crate::soil::closed_form::{ArcCoefficients, RimContact, driving_torque};
use nalgebra_lm::{DMatrix, DVector};
use std::fmt;

/// A stage of the identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// `P_I = {c_1, c_2}` from the drawbar pull (Eq. 73).
    Angles,
    /// `P_II = {k_s, n_0, n_1}` from the load (Eq. 74).
    NormalStress,
    /// `P_III = {c, φ, K}` from the driving torque (Eq. 75).
    ShearStress,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Angles => "c1 and c2 (Eq. 73)",
            Self::NormalStress => "k_s, n0 and n1 (Eq. 74)",
            Self::ShearStress => "c, phi and K (Eq. 75)",
        })
    }
}

impl Stage {
    /// All of them, in the order in which each needs those before.
    pub const ALL: [Self; 3] = [Self::Angles, Self::NormalStress, Self::ShearStress];

    /// What the stage finds.
    pub fn parameters(self) -> &'static [Parameter] {
        use Parameter as P;
        match self {
            Self::Angles => &[P::StressAngle, P::StressAngleSlip],
            Self::NormalStress => &[
                P::SinkageModulus,
                P::SinkageExponent,
                P::SinkageExponentSlip,
            ],
            Self::ShearStress => &[P::Cohesion, P::FrictionAngle, P::ShearModulus],
        }
    }
}

/// What the three stages, one after the other, make of the rows: the paper's result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Staged {
    /// The parameters.
    pub parameters: TerrainParameters,
    /// Why each stage stopped.
    pub terminations: [Termination; 3],
}

/// One stage, from the coordinates at which those before ended; `None` where its equation gives
/// no finite number.
pub(super) fn run(
    stage: Stage,
    model: &Model,
    rows: &[SteadyLoad],
    at: Coordinates,
) -> Option<Minimum> {
    let equation = Equation {
        model,
        rows: &model.rows_of(stage, rows),
        stage,
        scale: Scale::of(rows),
    };
    let moved = model.moved_among(stage.parameters());
    minimise_from(&equation, equation.starts(at), &moved)
}

/// One of Eq. (73)-(75) over the rows.
struct Equation<'a> {
    model: &'a Model,
    rows: &'a [SteadyLoad],
    stage: Stage,
    scale: Scale,
}

impl Equation<'_> {
    /// Where the stage begins, `at` first.
    fn starts(&self, at: Coordinates) -> Vec<Coordinates> {
        match self.stage {
            Stage::Angles => with(at, Stage::Angles, &[&[0.2, 0.2], &[0.4, -0.5], &[0.7, 0.0]]),
            Stage::NormalStress => vec![self.logarithmic_solution(at).unwrap_or(at)],
            Stage::ShearStress => {
                // Cohesion [Pa], friction angle [rad], K [m]: sands from loose to crusted.
                let [c, phi, k] = [libm::log, |x| x, libm::log];
                let values = [[100.0, 0.5, 0.005], [1.0e3, 0.5, 0.02], [10.0, 0.6, 0.001]];
                let values = values.map(|v: [f64; 3]| [c(v[0]), phi(v[1]), k(v[2])]);
                let values: Vec<&[f64]> = values.iter().map(|v| &v[..]).collect();
                let mut starts = with(at, Stage::ShearStress, &values);
                // What the class sets stays set.
                for start in &mut starts {
                    self.model.switch(start);
                }
                starts
            }
        }
    }

    /// Eq. (74) solved for the pressure, whose logarithm is linear in `ln k_s`, `n_0` and `n_1`;
    /// `None` where too few rows press downward.
    fn logarithmic_solution(&self, at: Coordinates) -> Option<Coordinates> {
        let surface = self.model.surface();
        let points: Vec<[f64; 3]> = self
            .rows
            .iter()
            .filter_map(|row| {
                let arc = ArcCoefficients::from(self.model.contact(&at, row).angles);
                let lifted = arc.normal_force(0.0, row.driving_torque / surface.radius);
                let pressure = (row.load - lifted) / (arc.a * surface.radius * surface.width);
                let log_sinkage = libm::log(row.sinkage);
                (pressure > 0.0).then(|| {
                    [
                        libm::log(pressure),
                        log_sinkage,
                        log_sinkage * row.slip.abs(),
                    ]
                })
            })
            .collect();
        let [modulus, exponent, by_slip] = [
            Parameter::SinkageModulus,
            Parameter::SinkageExponent,
            Parameter::SinkageExponentSlip,
        ]
        .map(|parameter| parameter as usize);
        let mut found = at;
        // One sinkage for all rows does not split k_s z^n0: the exponent stays where it is.
        let split = self.model.splits_pressure();
        let columns = if split { 3 } else { 2 };
        let design = DMatrix::from_fn(points.len(), columns, |row, column| match column {
            0 => 1.0,
            1 => points[row][2],
            _ => points[row][1],
        });
        let known = if split { 0.0 } else { at[exponent] };
        let target = DVector::from_iterator(
            points.len(),
            points
                .iter()
                .map(|[pressure, log_sinkage, _]| pressure - known * log_sinkage),
        );
        if points.len() < columns {
            return None;
        }
        let solution = design.svd(true, true).solve(&target, 1e-10).ok()?;
        found[modulus] = solution[0];
        found[by_slip] = solution[1];
        if split {
            found[exponent] = solution[2];
        }
        Some(found)
    }
}

/// `at`, and `at` with a stage's parameters at each of `values`.
fn with(at: Coordinates, stage: Stage, values: &[&[f64]]) -> Vec<Coordinates> {
    let mut starts = vec![at];
    for values in values {
        let mut start = at;
        for (&parameter, &value) in stage.parameters().iter().zip(*values) {
            start[parameter as usize] = value;
        }
        starts.push(start);
    }
    starts
}

impl Residuals for Equation<'_> {
    fn residuals(&self, at: &Coordinates) -> Vec<f64> {
        let soil = self.model.soil(at);
        let surface = self.model.surface();
        let residual = |row: &SteadyLoad| {
            let contact = self.model.contact(at, row);
            let arc = ArcCoefficients::from(contact.angles);
            let rim_force = row.driving_torque / surface.radius;
            match self.stage {
                Stage::Angles => {
                    (arc.drawbar_pull(row.load, rim_force) - row.drawbar_pull)
                        / self.scale.of_row(row).drawbar_pull
                }
                Stage::NormalStress => {
                    let area = surface.radius * surface.width;
                    let predicted = arc.normal_force(area * contact.pressure(&soil), rim_force);
                    (predicted - row.load) / self.scale.of_row(row).load
                }
                Stage::ShearStress => {
                    let given = [row.load, contact.mobilised(&soil)];
                    (driving_torque(surface, &soil, arc, given) - row.driving_torque)
                        / self.scale.of_row(row).driving_torque
                }
            }
        };
        self.rows.iter().map(residual).collect()
    }

    fn gradient(&self, at: &Coordinates) -> Vec<Coordinates> {
        let soil = self.model.soil(at);
        let derivatives = |row: &SteadyLoad| {
            let contact = self.model.contact(at, row);
            let mut by = [0.0; 8];
            let (values, scale) = match self.stage {
                Stage::Angles => {
                    let rim_force = row.driving_torque / contact.rim.radius;
                    let by_peak =
                        contact.pull_by_peak([row.load, rim_force]) * contact.angles.entry;
                    let values = [by_peak, by_peak * row.slip, 0.0];
                    (values, self.scale.of_row(row).drawbar_pull)
                }
                Stage::NormalStress => {
                    let values = pressure_gradient(&contact, contact.pressure(&soil));
                    (values, self.scale.of_row(row).load)
                }
                Stage::ShearStress => {
                    let values = contact.torque_gradient(&soil, row.load);
                    (values, self.scale.of_row(row).driving_torque)
                }
            };
            for (&parameter, value) in self.stage.parameters().iter().zip(values) {
                by[parameter as usize] = value / scale;
            }
            by
        };
        self.rows.iter().map(derivatives).collect()
    }
}

/// Derivatives of `A r b k_s zᴺ` [N] by `ln k_s`, `n_0` and `n_1`.
fn pressure_gradient(contact: &RimContact, pressure: f64) -> [f64; 3] {
    let arc = ArcCoefficients::from(contact.angles);
    let force = arc.a * contact.rim.radius * contact.rim.width * pressure;
    let log_sinkage = libm::log(contact.sinkage);
    [
        force,
        force * log_sinkage,
        force * log_sinkage * contact.slip.abs(),
    ]
}
