//! Sinkage, pull and torque predicted at a given load and slip.

use super::directions::Directions;
use super::estimate::Estimate;
use super::model::Model;
use super::parameter::Coordinates;
use super::point::{DEPTH, Point, by, values};
use super::row::{RIGID_SINKAGE, Setting, SteadyLoad};
use super::{Identification, LocalModel};
use crate::soil::wheel_load::WheelLoad;
use crate::statistics::student_quantile;
use crate::terrain::class::Wtic;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// A predicted quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Its value.
    pub value: f64,
    /// Half-width of the 95 % prediction interval; infinite where the quantity is not identified or there is
    /// no degree of freedom for its scatter.
    pub half_width: f64,
}

impl Predicted {
    /// The 95 % prediction interval.
    pub fn interval(&self) -> [f64; 2] {
        [self.value - self.half_width, self.value + self.half_width]
    }

    /// Whether the interval covers `value`.
    pub fn covers(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.half_width
    }
}

/// The value and its interval, which is `null` where unbounded.
impl Serialize for Predicted {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let interval = self.half_width.is_finite().then(|| self.interval());
        let mut fields = serializer.serialize_struct("Predicted", 2)?;
        fields.serialize_field("value", &self.value)?;
        fields.serialize_field("interval95", &interval)?;
        fields.end()
    }
}

/// Sinkage, pull and torque at a load and slip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Prediction {
    /// Sinkage `z` \[m\] of the rim; [`RIGID_SINKAGE`] where the class sets it.
    pub sinkage: Predicted,
    /// Drawbar pull `F_DP` \[N\].
    pub drawbar_pull: Predicted,
    /// Driving torque `T_D` [N·m].
    pub driving_torque: Predicted,
}

/// Predicts from an estimate and the rows it was fitted to.
///
/// The sinkage is solved from the vertical equilibrium, then pull and torque follow; where the class sets the
/// sinkage, pull and torque are in proportion to the load. The variance of a prediction is the sum of the
/// propagated covariance of the parameters and the residual variance of the rows.
#[derive(Debug, Clone)]
pub struct Predictor {
    model: Model,
    at: Coordinates,
    directions: Directions,
    /// Standard deviation of a weighted residual [-].
    sigma: f64,
    /// Quantile of the standardised error of a new measurement [-].
    quantile: f64,
    /// Scatter of sinkage [m], pull [N] and torque [N·m] about predictions.
    scatter: [f64; 3],
}

/// Sinkage, pull and torque at a load, with their derivatives by every coordinate.
struct Solution {
    values: [f64; 3],
    slopes: [[f64; 3]; 8],
}

impl Predictor {
    /// `estimate` has to come from `identification`.
    pub fn new(identification: &Identification, estimate: &Estimate) -> Self {
        let model = identification.model;
        let rows = &identification.rows;
        let at = estimate.terrain.coordinates();
        let LocalModel {
            directions,
            precision,
            ..
        } = identification.local_model_of(estimate);
        let rows: Vec<SteadyLoad> = rows
            .iter()
            .filter(|row| !model.setting.holds_by_friction(row, model.class))
            .copied()
            .collect();
        // The degrees of freedom used by the parameters are shared equally by the forces.
        let torques = rows.iter().filter(|row| row.has_torque()).count() as f64;
        let forces = 2.0 + torques / rows.len().max(1) as f64;
        let taken = directions.rank() as f64 / forces;
        let freedom = rows.len() as f64 - taken;
        Self {
            model,
            at,
            sigma: precision.sigma,
            directions,
            quantile: student_quantile(0.975, freedom),
            scatter: scatter(&model, &at, &rows, taken),
        }
    }

    /// The class whose model predicts.
    pub fn class(&self) -> Wtic {
        self.model.class
    }

    /// The setting of the fit.
    pub fn setting(&self) -> &Setting {
        &self.model.setting
    }

    /// Prediction at a `load` \[N\] and `slip` [-] by the rim's radius; `None` where the soil does not carry
    /// the load.
    pub fn at(&self, load: f64, slip: f64) -> Option<Prediction> {
        let slip = self.model.setting.slip_on_cylinder(slip);
        let solution = solve(&self.model, &self.at, load, slip)?;
        let predicted = |channel: usize| {
            let function = self
                .directions
                .function(|parameter| solution.slopes[parameter as usize][channel]);
            let variance = self.directions.covariance(&function, &function);
            let sd = variance.map_or(f64::INFINITY, |v| self.sigma * libm::sqrt(v));
            Predicted {
                value: solution.values[channel],
                half_width: self.quantile * libm::hypot(sd, self.scatter[channel]),
            }
        };
        let mut sinkage = predicted(0);
        if self.model.class == Wtic::Leis {
            sinkage.value -= self.model.setting.offset();
        }
        Some(Prediction {
            sinkage,
            drawbar_pull: predicted(1),
            driving_torque: predicted(2),
        })
    }
}

/// Root mean square residual of predictions per degree of freedom; the parameters use up the fraction `taken`
/// of the degrees of freedom of each quantity.
fn scatter(model: &Model, at: &Coordinates, rows: &[SteadyLoad], taken: f64) -> [f64; 3] {
    let mut squares = [0.0; 3];
    let mut counts = [0.0; 3];
    for row in rows {
        let Some(solution) = solve(model, at, row.load, row.slip) else {
            return [f64::INFINITY; 3];
        };
        let measured = [row.sinkage, row.drawbar_pull, row.driving_torque];
        let channels = squares.iter_mut().zip(&mut counts);
        for ((sums, value), measured) in channels.zip(solution.values).zip(measured) {
            if !measured.is_nan() {
                *sums.0 += (value - measured) * (value - measured);
                *sums.1 += 1.0;
            }
        }
    }
    std::array::from_fn(|channel| match counts[channel] {
        // Not measured: no residual variance is added.
        0.0 if !rows.is_empty() => 0.0,
        count if count <= taken => f64::INFINITY,
        count => libm::sqrt(squares[channel] / (count - taken)),
    })
}

/// Loads at the sinkage that carries `load`, and their derivatives by the parameters.
fn solve(model: &Model, at: &Coordinates, load: f64, slip: f64) -> Option<Solution> {
    match model.class {
        Wtic::Leis => sunk(model, at, load, slip),
        _ => Some(on_top(model, at, load, slip)),
    }
}

fn sunk(model: &Model, at: &Coordinates, load: f64, slip: f64) -> Option<Solution> {
    let point = |log_depth: f64| Point {
        at: *at,
        sinkage: model.sinkage(libm::exp(log_depth)),
        slip,
    };
    let surplus = |log_depth: f64| model.loads(&point(log_depth)).normal_force - load;
    let log_depth = first_root(surplus, model.depth(model.surface().radius))?;
    let derivatives = model.derivatives(point(log_depth));
    let (here, by_depth) = (values(&derivatives), by(&derivatives, DEPTH));
    // At constant load, a change of a parameter is compensated by the depth.
    let slopes = std::array::from_fn(|parameter| {
        let by = by(&derivatives, parameter);
        let part = -by.normal_force / by_depth.normal_force;
        let WheelLoad {
            drawbar_pull,
            driving_torque,
            ..
        } = by + by_depth * part;
        [libm::exp(log_depth) * part, drawbar_pull, driving_torque]
    });
    Some(Solution {
        values: [
            point(log_depth).sinkage,
            here.drawbar_pull,
            here.driving_torque,
        ],
        slopes,
    })
}

fn on_top(model: &Model, at: &Coordinates, load: f64, slip: f64) -> Solution {
    let derivatives = model.derivatives(Point::of(at, &SteadyLoad::at(slip, RIGID_SINKAGE)));
    let here = values(&derivatives);
    let part = load / here.normal_force;
    let slopes = std::array::from_fn(|parameter| {
        let by = by(&derivatives, parameter);
        let of_load = by.normal_force / here.normal_force;
        let scaled = |by: f64, value: f64| part * (by - of_load * value);
        [
            0.0,
            scaled(by.drawbar_pull, here.drawbar_pull),
            scaled(by.driving_torque, here.driving_torque),
        ]
    });
    Solution {
        values: [
            RIGID_SINKAGE,
            part * here.drawbar_pull,
            part * here.driving_torque,
        ],
        slopes,
    }
}

/// The least log depth at which `surplus` turns positive; `None` if it does not up to `deepest` [m].
fn first_root(surplus: impl Fn(f64) -> f64, deepest: f64) -> Option<f64> {
    const PARTS: u32 = 80;
    let [from, to] = [libm::log(RIGID_SINKAGE), libm::log(deepest)];
    let edge = |part: u32| from + (to - from) * f64::from(part) / f64::from(PARTS);
    let mut low = from;
    let high = (1..=PARTS).map(edge).find(|&high| {
        let crossed = surplus(low) < 0.0 && surplus(high) >= 0.0;
        if !crossed {
            low = high;
        }
        crossed
    })?;
    let mut ends = [low, high];
    // 2^-50 of a part is below rounding.
    for _ in 0..50 {
        let middle = 0.5 * (ends[0] + ends[1]);
        ends[usize::from(surplus(middle) >= 0.0)] = middle;
    }
    Some(0.5 * (ends[0] + ends[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::{Known, Parameter, identify};
    use crate::soil::closed_form::{self, Rim};
    use crate::soil::table_6;
    use crate::soil::wheel_load::sinkage_at;
    use crate::wheel::Wheel;

    const SLIPS: [f64; 6] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.6];

    fn smooth() -> Wheel {
        Wheel {
            lugs: None,
            ..Wheel::rover()
        }
    }

    fn row(load: f64, slip: f64) -> SteadyLoad {
        let sand = table_6::sand();
        let sinkage = sinkage_at(&smooth(), &sand, load, slip).unwrap();
        let loads = closed_form::loads(Rim::from(&smooth()), &sand, sinkage, slip);
        SteadyLoad::new(slip, sinkage, loads)
    }

    fn rows(loads: &[f64]) -> Vec<SteadyLoad> {
        let rows = loads
            .iter()
            .flat_map(|&load| SLIPS.map(|slip| row(load, slip)));
        rows.collect()
    }

    fn setting() -> Setting {
        Setting::new(Rim::from(&smooth()))
    }

    fn predictor(rows: &[SteadyLoad], setting: &Setting) -> Predictor {
        let identification = Identification::new(rows, Wtic::Leis, setting).unwrap();
        Predictor::new(&identification, &identification.estimate().unwrap())
    }

    #[test]
    fn noiseless_loads_predict_a_held_out_load_and_slip() {
        let predictor = predictor(&rows(&[60.0, 200.0]), &setting());
        let found = predictor.at(109.0, 0.25).unwrap();
        let truth = row(109.0, 0.25);
        let close = |found: Predicted, truth: f64| (found.value / truth - 1.0).abs() < 1e-4;
        assert!(close(found.sinkage, truth.sinkage), "{found:?}");
        assert!(close(found.drawbar_pull, truth.drawbar_pull), "{found:?}");
        assert!(
            close(found.driving_torque, truth.driving_torque),
            "{found:?}"
        );
    }

    #[test]
    fn slopes_of_a_prediction_are_those_of_its_values() {
        let predictor = predictor(&rows(&[60.0, 200.0]), &setting());
        let solved = |at: &Coordinates| sunk(&predictor.model, at, 109.0, 0.25).unwrap();
        let here = solved(&predictor.at);
        for parameter in Parameter::ALL {
            let moved = |step: f64| {
                let mut at = predictor.at;
                at[parameter as usize] += step;
                solved(&at).values
            };
            let (high, low) = (moved(1e-5), moved(-1e-5));
            for channel in 0..3 {
                let slope = (high[channel] - low[channel]) / 2e-5;
                let claimed = here.slopes[parameter as usize][channel];
                let size = slope.abs().max(1e-3 * here.values[channel].abs());
                assert!(
                    (claimed - slope).abs() < 1e-3 * size,
                    "{}: {claimed}, not {slope}",
                    parameter.name()
                );
            }
        }
    }

    #[test]
    fn errors_are_mean_errors_over_mean_values_and_none_where_nothing_was_measured() {
        let predictor = predictor(&rows(&[60.0, 200.0]), &setting());
        let mut off = rows(&[109.0]);
        for row in &mut off {
            row.sinkage *= 1.25;
            row.drawbar_pull *= -1.0;
            row.driving_torque = f64::NAN;
        }
        let errors = predictor.errors(&off);
        // Truth over 1.25 times the truth, and over its negative.
        assert!((errors.sinkage.unwrap() - 20.0).abs() < 0.02, "{errors:?}");
        assert!((errors.drawbar_pull.unwrap() - 200.0).abs() < 0.1);
        assert_eq!(errors.driving_torque, None);
        off[0].load = 1e6;
        assert_eq!(predictor.errors(&off).sinkage, None);
    }

    #[test]
    fn a_prediction_far_from_the_rows_is_less_sure_and_a_soil_too_soft_gives_none() {
        let mut rows = rows(&[60.0, 200.0]);
        for (index, row) in rows.iter_mut().enumerate() {
            row.drawbar_pull += if index % 3 == 0 { 1.0 } else { -0.5 };
        }
        let predictor = predictor(&rows, &setting());
        let half = |load: f64| predictor.at(load, 0.3).unwrap().drawbar_pull.half_width;
        assert!(half(1000.0) > 2.0 * half(120.0));
        assert_eq!(predictor.at(1e6, 0.3), None);
    }

    #[test]
    fn loads_and_pulls_alone_give_back_what_they_fix_where_plates_gave_the_rest() {
        let truth = table_6::sand();
        let known = Known::default()
            .with(Parameter::SinkageModulus, truth.frictional_modulus)
            .with(Parameter::SinkageExponent, truth.sinkage_exponent);
        let setting = Setting { known, ..setting() };
        let mut rows = rows(&[60.0, 109.0, 200.0]);
        rows.iter_mut()
            .for_each(|row| row.driving_torque = f64::NAN);
        let estimate = identify(&rows, Wtic::Leis, &setting).unwrap();
        let phi = estimate.terrain.friction_angle_deg;
        assert!((phi / truth.friction_angle_deg - 1.0).abs() < 1e-3, "{phi}");
        assert_eq!(estimate.staged, None);
        assert_eq!(estimate.force_errors.driving_torque, None);
        let predicted = predictor(&rows, &setting).at(109.0, 0.25).unwrap();
        let torque = row(109.0, 0.25).driving_torque;
        assert!((predicted.driving_torque.value / torque - 1.0).abs() < 1e-3);
    }
}
