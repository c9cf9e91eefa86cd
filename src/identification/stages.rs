//! The paper's three least-squares stages on its decoupled equations (Eq. 73-76).

use super::least_squares::{Minimum, Residuals, Termination, minimise_from};
use super::model::Model;
use super::parameter::{Coordinates, Parameter, TerrainParameters};
use super::point::Point;
use super::row::SteadyLoad;
use super::stage::Stage;
use super::weight::Scale;
use crate::soil::closed_form::{ArcCoefficients, Rim, driving_torque};
use crate::soil::real::Real;
use nalgebra_lm::{DMatrix, DVector};

/// Starts of the first stage: maximum-stress angles `[c_1, c_2]` [-].
pub(super) const ANGLES: [[f64; 2]; 3] = [[0.2, 0.2], [0.4, -0.5], [0.7, 0.0]];

/// Starts of the third stage: `c` [Pa], `φ` [°] and `K` [m] of sands from loose to crusted.
pub(super) const STRENGTHS: [[f64; 3]; 3] = [
    [100.0, 28.0, 0.005],
    [1.0e3, 28.0, 0.02],
    [10.0, 34.0, 0.001],
];

/// Result of the three stages in sequence, as in the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Staged {
    /// The parameters.
    pub parameters: TerrainParameters,
    /// Why each stage stopped.
    pub terminations: [Termination; 3],
}

/// One stage, from the result of those before; `None` where its equation gives no finite number.
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

/// One of Eq. (73)-(75) as a least-squares problem over the rows.
struct Equation<'a> {
    model: &'a Model,
    rows: &'a [SteadyLoad],
    stage: Stage,
    scale: Scale,
}

impl Equation<'_> {
    /// Starts of the stage, `at` first.
    fn starts(&self, at: Coordinates) -> Vec<Coordinates> {
        let others = match self.stage {
            Stage::Angles => ANGLES.map(|[c_1, c_2]| [c_1, c_2, 0.0]),
            Stage::NormalStress => return vec![self.logarithmic_solution(at).unwrap_or(at)],
            Stage::ShearStress => STRENGTHS,
        };
        let begun = others.map(|values| {
            let mut start = at;
            for (&parameter, value) in self.stage.parameters().iter().zip(values) {
                start[parameter as usize] = parameter.coordinate(value);
            }
            // Values set by the class are not changed.
            self.model.switch(&mut start);
            start
        });
        [&[at], &begun[..]].concat()
    }

    /// Eq. (74) solved for the pressure, whose logarithm is linear in `ln k_s`, `n_0` and `n_1`; `None` where
    /// too few rows have a positive pressure.
    fn logarithmic_solution(&self, at: Coordinates) -> Option<Coordinates> {
        let points = self.pressures(&at);
        let moved = self.model.moved_among(Stage::NormalStress.parameters());
        if points.len() < moved.len() || moved.is_empty() {
            return None;
        }
        let slope = |point: &LogPressure, parameter: Parameter| match parameter {
            Parameter::SinkageModulus => 1.0,
            Parameter::SinkageExponent => point.sinkage,
            _ => point.sinkage * point.slip,
        };
        let kept = |point: &LogPressure| -> f64 {
            let parameters = Stage::NormalStress.parameters().iter();
            let kept = parameters.filter(|parameter| !moved.contains(parameter));
            kept.map(|&p| at[p as usize] * slope(point, p)).sum()
        };
        let design = DMatrix::from_fn(points.len(), moved.len(), |row, column| {
            slope(&points[row], moved[column])
        });
        let target = points.iter().map(|point| point.pressure - kept(point));
        let target = DVector::from_iterator(points.len(), target);
        let solution = design.svd(true, true).solve(&target, 1e-10).ok()?;
        let mut found = at;
        for (parameter, value) in moved.iter().zip(solution.iter()) {
            found[*parameter as usize] = *value;
        }
        Some(found)
    }

    /// Pressures of the rows by Eq. (74), where positive.
    fn pressures(&self, at: &Coordinates) -> Vec<LogPressure> {
        let Rim { radius, width } = self.model.surface();
        let pressure = |row: &SteadyLoad| {
            let arc = ArcCoefficients::from(self.model.contact(&Point::of(at, row)).angles);
            let lifted = arc.normal_force(0.0, row.driving_torque / radius);
            let pressure = (row.load - lifted) / (arc.a * radius * width);
            (pressure > 0.0).then(|| LogPressure {
                pressure: libm::log(pressure),
                sinkage: libm::log(row.sinkage),
                slip: row.slip.abs(),
            })
        };
        self.rows.iter().filter_map(pressure).collect()
    }
}

/// Pressure of one row at the peak: logarithms of pressure [Pa] and sinkage [m], and slip [-].
struct LogPressure {
    pressure: f64,
    sinkage: f64,
    slip: f64,
}

impl Equation<'_> {
    /// Predicted minus measured, normalised by the row's uncertainty.
    fn residual<T: Real>(&self, point: &Point<T>, row: &SteadyLoad) -> T {
        let sd = self.scale.of_row(row);
        let soil = self.model.soil(&point.at);
        let surface = self.model.surface();
        let contact = self.model.contact(point);
        let arc = ArcCoefficients::from(contact.angles);
        let rim_force = T::constant(row.driving_torque / surface.radius);
        let load = T::constant(row.load);
        match self.stage {
            Stage::Angles => {
                (arc.drawbar_pull(load, rim_force) - row.drawbar_pull) / sd.drawbar_pull
            }
            Stage::NormalStress => {
                let area = surface.radius * surface.width;
                let predicted = arc.normal_force(contact.pressure(&soil) * area, rim_force);
                (predicted - row.load) / sd.load
            }
            Stage::ShearStress => {
                let given = [load, contact.mobilised(&soil)];
                let predicted = driving_torque(surface, &soil, arc, given);
                (predicted - row.driving_torque) / sd.driving_torque
            }
        }
    }
}

impl Residuals for Equation<'_> {
    fn residuals(&self, at: &Coordinates) -> Vec<f64> {
        let rows = self.rows.iter();
        rows.map(|row| self.residual(&Point::of(at, row), row))
            .collect()
    }

    fn gradient(&self, at: &Coordinates) -> Vec<Coordinates> {
        let derivatives = |row: &SteadyLoad| {
            let point = Point::of(at, row).by_all(row.sinkage);
            let slopes = self.residual(&point, row).slopes;
            // Parameters of earlier stages are fixed.
            let mut by = [0.0; 8];
            for &parameter in self.stage.parameters() {
                by[parameter as usize] = slopes[parameter as usize];
            }
            by
        };
        self.rows.iter().map(derivatives).collect()
    }
}
