//! One row against the model, its true slip and sinkage taken where they explain the row best.
//!
//! Slip and sinkage are measured like the forces. Their errors could be carried over to the forces
//! by the model's slopes at the measured point, which makes one linear step of what follows; but a
//! tenth of the sinkage is far from linear, and the slopes then depend on where the fit began. So
//! the row's true slip and sinkage are unknowns of the row alone (functional errors in variables:
//! Fuller, *Measurement Error Models*, 1987, chapter 3), found anew for every trial of the
//! parameters, and the fit goes on in what is left (variable projection: Golub and Pereyra, *SIAM
//! J. Numer. Anal.* 10:413, 1973).

use super::model::Model;
use super::parameter::Coordinates;
use super::row::{SteadyLoad, Uncertainty};
use crate::soil::Soil;
use crate::soil::closed_form::gradient::LoadGradient;
use crate::soil::wheel_load::WheelLoad;

/// Most residuals of a row: load, pull, torque, sinkage and slip.
const MOST: usize = 5;

/// Residuals of a row, of which the first few count.
type Column = [f64; MOST];

/// A row with its uncertainties.
#[derive(Debug, Clone, Copy)]
pub(super) struct Observation {
    row: SteadyLoad,
    sd: Uncertainty,
    /// Forces that count: the load; the pull too; the torque too.
    forces: usize,
}

/// Deviations of the true from the measured values: sinkage in logarithms, slip as it is.
#[derive(Debug, Clone, Copy, Default)]
struct Truth {
    log_sinkage: f64,
    slip: f64,
}

/// One of the two.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Latent {
    Sinkage,
    Slip,
}

impl Observation {
    pub fn new(model: &Model, row: &SteadyLoad, sd: Uncertainty) -> Self {
        let forces = match row.has_torque() {
            _ if model.setting.holds(row, model.class) => 1,
            false => 2,
            true => 3,
        };
        Self {
            row: *row,
            sd,
            forces,
        }
    }

    /// Number of measured forces that count.
    pub fn forces(&self) -> usize {
        self.forces
    }

    /// Number of residuals.
    pub fn residual_count(&self) -> usize {
        self.forces + self.latent().count()
    }

    /// Differences between predicted and measured, in units of their uncertainties.
    pub fn residuals(&self, model: &Model, at: &Coordinates) -> impl Iterator<Item = f64> {
        let soil = model.soil(at);
        let truth = self.truth(model, at, &soil);
        let residuals = self.residuals_at(model, at, &soil, truth);
        residuals.into_iter().take(self.residual_count())
    }

    /// Derivatives of the residuals by every coordinate, the true slip and sinkage following.
    pub fn gradient(&self, model: &Model, at: &Coordinates) -> Vec<Coordinates> {
        let soil = model.soil(at);
        let truth = self.truth(model, at, &soil);
        let seen = self.seen(truth);
        let by = in_order(model.contact(at, &seen).load_gradient(&soil));
        let directions = orthonormal(self.slopes(model, at, &soil, truth));
        let mut gradient = vec![[0.0; 8]; self.residual_count()];
        for (coordinate, derivative) in by.into_iter().enumerate() {
            let mut column = self.weighed(derivative);
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

    /// What is not exact of slip and sinkage, in the order of the residuals.
    fn latent(&self) -> impl Iterator<Item = Latent> {
        let sinkage = (self.sd.sinkage > 0.0).then_some(Latent::Sinkage);
        let slip = (self.sd.slip > 0.0).then_some(Latent::Slip);
        sinkage.into_iter().chain(slip)
    }

    /// The row with its true slip and sinkage.
    fn seen(&self, truth: Truth) -> SteadyLoad {
        SteadyLoad {
            sinkage: self.row.sinkage * libm::exp(truth.log_sinkage),
            slip: (self.row.slip + truth.slip).clamp(-1.0, 1.0),
            ..self.row
        }
    }

    fn residuals_at(&self, model: &Model, at: &Coordinates, soil: &Soil, truth: Truth) -> Column {
        let seen = self.seen(truth);
        let predicted = model.contact(at, &seen).loads(soil);
        let mut residuals = self.weighed(predicted + measured(&self.row) * -1.0);
        for (index, latent) in self.latent().enumerate() {
            residuals[self.forces + index] = match latent {
                Latent::Sinkage => (seen.sinkage - self.row.sinkage) / self.sd.sinkage,
                Latent::Slip => (seen.slip - self.row.slip) / self.sd.slip,
            };
        }
        residuals
    }

    /// Forces in units of their uncertainties, those that do not count 0.
    fn weighed(&self, loads: WheelLoad) -> Column {
        let weighed = [
            loads.normal_force / self.sd.load,
            loads.drawbar_pull / self.sd.drawbar_pull,
            loads.driving_torque / self.sd.driving_torque,
        ];
        let mut column = [0.0; MOST];
        column[..self.forces].copy_from_slice(&weighed[..self.forces]);
        column
    }

    /// The true slip and sinkage that explain the row best: Gauss and Newton's steps, halved
    /// while they do not help.
    fn truth(&self, model: &Model, at: &Coordinates, soil: &Soil) -> Truth {
        const STEPS: u32 = 15;
        const HALVINGS: u32 = 12;
        let mut truth = Truth::default();
        if self.latent().next().is_none() {
            return truth;
        }
        let mut residuals = self.residuals_at(model, at, soil, truth);
        for _ in 0..STEPS {
            let step = solved(self.slopes(model, at, soil, truth), &residuals);
            let mut part = 1.0;
            let better = (0..HALVINGS).find_map(|_| {
                let trial = self.moved(truth, step, part);
                let found = self.residuals_at(model, at, soil, trial);
                part *= 0.5;
                (dot(&found, &found) < dot(&residuals, &residuals)).then_some((trial, found))
            });
            let Some((trial, found)) = better else { break };
            let gained = dot(&residuals, &residuals) - dot(&found, &found);
            (truth, residuals) = (trial, found);
            // Below what the outer fit can tell of the sum.
            if gained < 1e-12 * (1.0 + dot(&residuals, &residuals)) {
                break;
            }
        }
        truth
    }

    /// `truth` moved by `part` of a step of what is latent; by no more than a factor e of sinkage.
    fn moved(&self, mut truth: Truth, step: [f64; 2], part: f64) -> Truth {
        for (latent, step) in self.latent().zip(step) {
            match latent {
                Latent::Sinkage => truth.log_sinkage += part * step.clamp(-1.0, 1.0),
                Latent::Slip => truth.slip += part * step,
            }
        }
        truth
    }

    /// Derivatives of the residuals by what is latent.
    fn slopes(
        &self,
        model: &Model,
        at: &Coordinates,
        soil: &Soil,
        truth: Truth,
    ) -> [Option<Column>; 2] {
        // Central differences of functions with some 1e-13 of relative rounding.
        const STEP: f64 = 1e-5;
        let mut latent = self.latent();
        let mut slope = || {
            let latent = latent.next()?;
            let stepped = |step: f64| {
                let truth = match latent {
                    Latent::Sinkage => Truth {
                        log_sinkage: truth.log_sinkage + step,
                        ..truth
                    },
                    Latent::Slip => Truth {
                        slip: truth.slip + step,
                        ..truth
                    },
                };
                self.residuals_at(model, at, soil, truth)
            };
            let (high, low) = (stepped(STEP), stepped(-STEP));
            Some(std::array::from_fn(|i| (high[i] - low[i]) / (2.0 * STEP)))
        };
        [slope(), slope()]
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

/// Derivatives in the order of the coordinates.
pub(super) fn in_order(gradient: LoadGradient) -> [WheelLoad; 8] {
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

/// Variances [N²; torque N²·m²] of a row's forces, errors of slip and sinkage included to first
/// order.
pub(super) fn variances(
    model: &Model,
    at: &Coordinates,
    row: &SteadyLoad,
    sd: Uncertainty,
) -> WheelLoad {
    let own = Uncertainty {
        drawbar_pull: 1.0,
        load: 1.0,
        driving_torque: 1.0,
        ..sd
    };
    let observation = Observation {
        forces: 3,
        ..Observation::new(model, row, own)
    };
    let slopes = observation.slopes(model, at, &model.soil(at), Truth::default());
    let spread = |latent: Latent| match latent {
        Latent::Sinkage => sd.sinkage / row.sinkage,
        Latent::Slip => sd.slip,
    };
    let spreads: Vec<f64> = observation.latent().map(spread).collect();
    let carried = |force: usize| -> f64 {
        let parts = slopes.iter().flatten().zip(&spreads);
        parts
            .map(|(slope, spread)| slope[force] * slope[force] * spread * spread)
            .sum()
    };
    WheelLoad {
        normal_force: sd.load * sd.load + carried(0),
        drawbar_pull: sd.drawbar_pull * sd.drawbar_pull + carried(1),
        driving_torque: sd.driving_torque * sd.driving_torque + carried(2),
    }
}

fn dot(one: &Column, other: &Column) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

/// Orthonormal columns that span the same (Gram and Schmidt).
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

/// The step that least squares takes along the columns from `residuals`.
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

    /// What the sand carries at 12 mm and slip 0.3, read at another sinkage and slip.
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
        // One sd of sinkage and one and a half of slip off.
        let observation = read(0.014, 0.27);
        let truth = observation.truth(&model(), &at(), &model().soil(&at()));
        let seen = observation.seen(truth);
        assert!((seen.sinkage - 0.012).abs() < 2e-5, "{}", seen.sinkage);
        assert!((seen.slip - 0.3).abs() < 2e-3, "{}", seen.slip);
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
    fn exact_slip_and_sinkage_stay_and_count_no_residual() {
        let observation = read(0.012, 0.3);
        let exact = Observation {
            sd: Uncertainty {
                slip: 0.0,
                sinkage: 0.0,
                ..observation.sd
            },
            ..observation
        };
        assert_eq!(exact.residual_count(), 3);
        assert!(squares(&exact, &at()) < 1e-12);
    }
}
