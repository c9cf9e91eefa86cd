//! Residuals of one row, with its true slip and sinkage as nuisance parameters.
//!
//! Slip and sinkage have measurement errors like the forces. First-order propagation to the forces would
//! linearise at the measured point, but at a relative error of 0.1 in sinkage the model is far from linear,
//! and the weights would depend on the start of the fit. So true slip and sinkage are nuisance parameters of
//! the row (functional errors in variables: Fuller, *Measurement Error Models*, 1987, chapter 3), solved for
//! at every evaluation of the parameters, and the fit minimises the remaining residuals (variable projection:
//! Golub and Pereyra, *SIAM J. Numer. Anal.* 10:413, 1973).

use super::model::Model;
use super::parameter::Coordinates;
use super::point::{DEPTH, Point, SLIP, by};
use super::row::{SteadyLoad, Uncertainty};
use crate::soil::real::{Dual, Real};
use crate::soil::wheel_load::WheelLoad;
use std::cell::Cell;

/// Maximum number of residuals of a row: load, pull, torque, sinkage and slip.
const MOST: usize = 5;

/// Residuals of a row; only the first few are used.
type Column = [f64; MOST];

/// A row with its standard uncertainties.
#[derive(Debug, Clone)]
pub(super) struct Observation {
    row: SteadyLoad,
    sd: Uncertainty,
    /// Number of forces used: load; load and pull; or load, pull and torque.
    forces: usize,
    /// Solution for the parameters of the last evaluation, which starts the next.
    last: Cell<Tried>,
}

/// Deviations of true from measured values: of depth in logarithm, of slip in absolute terms.
#[derive(Debug, Clone, Copy, Default)]
struct Truth {
    log_depth: f64,
    slip: f64,
}

/// Parameters with the nuisance parameters solved for them.
#[derive(Debug, Clone, Copy, Default)]
struct Tried {
    at: Option<Coordinates>,
    truth: Truth,
}

/// A nuisance parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Latent {
    Sinkage,
    Slip,
}

impl Observation {
    pub fn new(model: &Model, row: &SteadyLoad, sd: Uncertainty) -> Self {
        let forces = if model.setting.holds_by_friction(row, model.class) {
            1
        } else if row.has_torque() {
            3
        } else {
            2
        };
        Self {
            row: *row,
            sd,
            forces,
            last: Cell::default(),
        }
    }

    /// Number of measured forces used.
    pub fn forces(&self) -> usize {
        self.forces
    }

    /// Number of residuals.
    pub fn residual_count(&self) -> usize {
        self.forces + self.latent().count()
    }

    /// Predicted minus measured, normalised by the standard uncertainties.
    pub fn residuals(&self, model: &Model, at: &Coordinates) -> impl Iterator<Item = f64> {
        let residuals = self.explained(model, at).residuals;
        residuals.into_iter().take(self.residual_count())
    }

    /// Total derivatives of the residuals by every coordinate, with true slip and sinkage re-solved.
    pub fn gradient(&self, model: &Model, at: &Coordinates) -> Vec<Coordinates> {
        let last = self.last.get();
        let truth = if last.at == Some(*at) {
            last.truth
        } else {
            self.explained(model, at).truth
        };
        let point = self.point(model, at, truth);
        let residuals = self.residuals_at(model, &point.by_all(model.depth(point.sinkage)));
        let column = |variable: usize| residuals.map(|residual| residual.slopes[variable]);
        let directions = orthonormal(self.latent_columns(column, [DEPTH, SLIP]));
        let mut gradient = vec![[0.0; 8]; self.residual_count()];
        for coordinate in 0..8 {
            let mut column = column(coordinate);
            for direction in directions.iter().flatten() {
                let along = dot(&column, direction);
                for (c, d) in column.iter_mut().zip(direction) {
                    *c -= along * d;
                }
            }
            for (by, value) in gradient.iter_mut().zip(column) {
                by[coordinate] = value;
            }
        }
        gradient
    }

    /// The nuisance parameters, in the order of the residuals.
    fn latent(&self) -> impl Iterator<Item = Latent> {
        let sinkage = (self.sd.sinkage > 0.0).then_some(Latent::Sinkage);
        let slip = (self.sd.slip > 0.0).then_some(Latent::Slip);
        sinkage.into_iter().chain(slip)
    }

    /// The columns of the nuisance parameters; `[depth, slip]` are their indices.
    fn latent_columns(
        &self,
        column: impl Fn(usize) -> Column,
        [depth, slip]: [usize; 2],
    ) -> [Option<Column>; 2] {
        let mut columns = self.latent().map(|latent| match latent {
            Latent::Sinkage => column(depth),
            Latent::Slip => column(slip),
        });
        [columns.next(), columns.next()]
    }

    /// The evaluation point at the true slip and sinkage.
    fn point(&self, model: &Model, at: &Coordinates, truth: Truth) -> Point<f64> {
        let depth = model.depth(self.row.sinkage) * libm::exp(truth.log_depth);
        Point {
            at: *at,
            sinkage: model.sinkage(depth),
            slip: (self.row.slip + truth.slip).clamp(-1.0, 1.0),
        }
    }

    fn residuals_at<T: Real>(&self, model: &Model, point: &Point<T>) -> [T; MOST] {
        let predicted = model.loads(point);
        let forces = [
            (predicted.normal_force - self.row.load) / self.sd.load,
            (predicted.drawbar_pull - self.row.drawbar_pull) / self.sd.drawbar_pull,
            (predicted.driving_torque - self.row.driving_torque) / self.sd.driving_torque,
        ];
        let mut residuals = [T::constant(0.0); MOST];
        residuals[..self.forces].copy_from_slice(&forces[..self.forces]);
        for (index, latent) in self.latent().enumerate() {
            residuals[self.forces + index] = match latent {
                Latent::Sinkage => (point.sinkage - self.row.sinkage) / self.sd.sinkage,
                Latent::Slip => (point.slip - self.row.slip) / self.sd.slip,
            };
        }
        residuals
    }

    /// Residuals and their derivatives by the nuisance parameters.
    fn linear(&self, model: &Model, at: &Coordinates, truth: Truth) -> Linear {
        let point = self.point(model, at, truth);
        let residuals: [Dual<2>; MOST] =
            self.residuals_at(model, &point.by_motion(model.depth(point.sinkage), [0, 1]));
        let column = |variable: usize| residuals.map(|residual| residual.slopes[variable]);
        Linear {
            residuals: residuals.map(|residual| residual.value),
            slopes: self.latent_columns(column, [0, 1]),
        }
    }

    /// Where to begin: the last solution, or the measured point where that explains more: after parameters far off,
    /// the last solution may lie in another basin.
    fn start(&self, model: &Model, at: &Coordinates) -> (Truth, Linear) {
        let [last, measured] = [self.last.get().truth, Truth::default()]
            .map(|truth| (truth, self.linear(model, at, truth)));
        if last.1.squares() <= measured.1.squares() {
            last
        } else {
            measured
        }
    }

    /// Solves for the true slip and sinkage by damped Gauss-Newton.
    fn explained(&self, model: &Model, at: &Coordinates) -> Explained {
        const STEPS: u32 = 15;
        const HALVINGS: u32 = 12;
        let (mut truth, mut here) = self.start(model, at);
        for _ in 0..STEPS {
            let step = solved(here.slopes, &here.residuals);
            // Below the resolution of the outer fit.
            if here.gain(step) < 1e-12 * (1.0 + here.squares()) {
                break;
            }
            let mut part = 1.0;
            let better = (0..HALVINGS).find_map(|_| {
                let trial = self.moved(truth, step, part);
                let found = self.linear(model, at, trial);
                part *= 0.5;
                (found.squares() < here.squares()).then_some((trial, found))
            });
            let Some(better) = better else { break };
            (truth, here) = better;
        }
        self.last.set(Tried {
            at: Some(*at),
            truth,
        });
        Explained {
            truth,
            residuals: here.residuals,
        }
    }

    /// `truth` moved by `part` of a step; by no more than a factor e of depth.
    fn moved(&self, mut truth: Truth, step: [f64; 2], part: f64) -> Truth {
        for (latent, step) in self.latent().zip(step) {
            match latent {
                Latent::Sinkage => truth.log_depth += part * step.clamp(-1.0, 1.0),
                Latent::Slip => truth.slip += part * step,
            }
        }
        truth
    }
}

/// A row at its true slip and sinkage.
struct Explained {
    truth: Truth,
    residuals: Column,
}

/// Linearised residuals in the nuisance parameters.
struct Linear {
    residuals: Column,
    slopes: [Option<Column>; 2],
}

impl Linear {
    fn squares(&self) -> f64 {
        dot(&self.residuals, &self.residuals)
    }

    /// Predicted decrease of the sum of squares by a Gauss-Newton step in the linear model.
    fn gain(&self, step: [f64; 2]) -> f64 {
        let slopes = self.slopes.iter().zip(step);
        slopes
            .filter_map(|(slope, step)| Some(-step * dot(slope.as_ref()?, &self.residuals)))
            .sum()
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

/// Variances [N²; torque N²·m²] of a row's forces with first-order propagation of the errors of slip and
/// sinkage.
pub(super) fn variances(
    model: &Model,
    at: &Coordinates,
    row: &SteadyLoad,
    sd: Uncertainty,
) -> WheelLoad {
    let derivatives = model.derivatives(Point::of(at, row));
    let carried = |force: fn(&WheelLoad) -> f64| {
        let by_sinkage = force(&by(&derivatives, DEPTH)) * sd.sinkage / model.depth(row.sinkage);
        let by_slip = force(&by(&derivatives, SLIP)) * sd.slip;
        by_sinkage * by_sinkage + by_slip * by_slip
    };
    WheelLoad {
        normal_force: sd.load * sd.load + carried(|loads| loads.normal_force),
        drawbar_pull: sd.drawbar_pull * sd.drawbar_pull + carried(|loads| loads.drawbar_pull),
        driving_torque: sd.driving_torque * sd.driving_torque
            + carried(|loads| loads.driving_torque),
    }
}

fn dot(one: &Column, other: &Column) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

/// Orthonormal basis of the columns (Gram-Schmidt).
fn orthonormal([first, second]: [Option<Column>; 2]) -> [Option<Column>; 2] {
    let first = first.and_then(unit);
    let second = second.and_then(|mut column| {
        if let Some(first) = first {
            let along = dot(&column, &first);
            for (c, f) in column.iter_mut().zip(first) {
                *c -= along * f;
            }
        }
        unit(column)
    });
    [first, second]
}

fn unit(column: Column) -> Option<Column> {
    let length = libm::sqrt(dot(&column, &column));
    (length > 0.0).then(|| column.map(|c| c / length))
}

/// The least-squares step along the columns for `residuals`.
fn solved([first, second]: [Option<Column>; 2], residuals: &Column) -> [f64; 2] {
    let Some(first) = first else {
        return [0.0; 2];
    };
    let [a, p] = [dot(&first, &first), -dot(&first, residuals)];
    let Some(second) = second else {
        return [p / a, 0.0];
    };
    let [b, c, q] = [
        dot(&first, &second),
        dot(&second, &second),
        -dot(&second, residuals),
    ];
    let determinant = a * c - b * b;
    [(c * p - b * q) / determinant, (a * q - b * p) / determinant]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::parameter::TerrainParameters;
    use crate::identification::{Parameter, Setting};
    use crate::soil::closed_form::{self, Rim};
    use crate::soil::table_6;
    use crate::terrain::class::Wtic;
    use crate::wheel::Wheel;

    fn model() -> Model {
        Model {
            class: Wtic::Leis,
            setting: Setting::new(Rim::from(&Wheel::rover())),
        }
    }

    fn at() -> Coordinates {
        TerrainParameters::of(&table_6::sand(), model().surface().width).coordinates()
    }

    /// Loads of the sand at 12 mm and slip 0.3, with another sinkage and slip as measured.
    fn read(sinkage: f64, slip: f64) -> Observation {
        let loads = closed_form::loads(model().surface(), &table_6::sand(), 0.012, 0.3);
        let row = SteadyLoad::new(slip, sinkage, loads);
        let sd = Uncertainty {
            slip: 0.02,
            sinkage: 0.002,
            drawbar_pull: 0.01,
            load: 0.01,
            driving_torque: 0.001,
        };
        Observation::new(&model(), &row, sd)
    }

    fn squares(observation: &Observation, at: &Coordinates) -> f64 {
        observation.residuals(&model(), at).map(|r| r * r).sum()
    }

    #[test]
    fn forces_measured_well_put_slip_and_sinkage_right() {
        // Errors of one sd of sinkage and one and a half of slip.
        let observation = read(0.014, 0.27);
        let truth = observation.explained(&model(), &at()).truth;
        let point = observation.point(&model(), &at(), truth);
        assert!((point.sinkage - 0.012).abs() < 2e-5, "{}", point.sinkage);
        assert!((point.slip - 0.3).abs() < 2e-3, "{}", point.slip);
        assert!((squares(&observation, &at()) - 3.25).abs() < 0.1);
    }

    #[test]
    fn the_gradient_of_the_sum_of_squares_is_that_of_its_residuals() {
        let observation = read(0.0125, 0.31);
        let gradient = observation.gradient(&model(), &at());
        let residuals: Vec<f64> = observation.residuals(&model(), &at()).collect();
        for parameter in Parameter::ALL {
            let index = parameter as usize;
            let claimed: f64 = gradient
                .iter()
                .zip(&residuals)
                .map(|(g, r)| 2.0 * g[index] * r)
                .sum();
            let moved = |step: f64| {
                let mut at = at();
                at[index] += step;
                squares(&observation, &at)
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!(
                (claimed - slope).abs() < 1e-3 * slope.abs().max(1.0),
                "{}: {claimed}, not {slope}",
                parameter.name()
            );
        }
    }

    #[test]
    fn residuals_do_not_depend_on_the_parameters_evaluated_before() {
        let fresh = squares(&read(0.014, 0.27), &at());
        for (parameter, by) in [
            (Parameter::SinkageModulus, -300.0),
            (Parameter::SinkageModulus, 20.0),
            (Parameter::SinkageExponent, -50.0),
            (Parameter::SinkageExponent, 3.0),
            (Parameter::ShearModulus, -12.0),
        ] {
            let mut far = at();
            far[parameter as usize] += by;
            let observation = read(0.014, 0.27);
            squares(&observation, &far);
            let after = squares(&observation, &at());
            assert!(
                (after - fresh).abs() < 1e-6,
                "{} {by}: {after}, not {fresh}",
                parameter.name()
            );
        }
    }

    #[test]
    fn exact_slip_and_sinkage_stay_and_count_no_residual() {
        let observation = read(0.012, 0.3);
        let exact = Observation {
            sd: Uncertainty {
                slip: 0.0,
                sinkage: 0.0,
                ..observation.sd
            },
            ..observation.clone()
        };
        assert_eq!(exact.residual_count(), 3);
        assert!(squares(&exact, &at()) < 1e-12);
    }
}
