//! Identifiable combinations of parameters that are not identifiable one by one.

use super::directions::Directions;
use super::model::Model;
use super::parameter::{Coordinates, Parameter};
use super::row::SteadyLoad;
use crate::soil::closed_form::Rim;
use crate::soil::contact::entry_angle;
use serde::Serialize;
use std::f64::consts::LN_2;

/// A combination identified by the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Combination {
    /// Its formula in the project's symbols, for example `k_s z^n0`.
    pub name: &'static str,
    /// Where it is evaluated, for example `z = 1e-5 m`; empty where it does not depend on that.
    #[serde(rename = "at")]
    pub place: String,
    /// Its value.
    pub value: f64,
    /// Its 95 % interval.
    #[serde(rename = "ci95")]
    pub interval: [f64; 2],
    /// Its unit.
    pub unit: &'static str,
}

/// A function of the coordinates and its derivatives, to be tested for identifiability.
struct Candidate {
    name: &'static str,
    place: String,
    unit: &'static str,
    /// The function; its logarithm for a positive quantity.
    value: f64,
    logarithmic: bool,
    slopes: Vec<(Parameter, f64)>,
}

/// What the rows resolve: parameters identified one by one, and the width of intervals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Resolution<'a> {
    /// The parameters that are identified one by one.
    pub identified: &'a [Parameter],
    /// Half-width of a 95 % interval in standard deviations for unit residuals.
    pub half_width: f64,
}

/// Combinations with at least one parameter that is not identifiable alone, known to better than a factor of
/// two (0.2 for shares of an angle).
pub(super) fn fixed(
    model: &Model,
    at: &Coordinates,
    rows: &[SteadyLoad],
    directions: &Directions,
    resolution: Resolution,
) -> Vec<Combination> {
    let is_open = |candidate: &Candidate| {
        let parameters = candidate.slopes.iter().map(|(parameter, _)| parameter);
        let free = |parameter: &&Parameter| directions.free().contains(parameter);
        let mut free = parameters.filter(free);
        free.any(|parameter| !resolution.identified.contains(parameter))
    };
    let open = candidates(model, at, rows).into_iter().filter(is_open);
    open.filter_map(|candidate| candidate.with_interval(directions, resolution.half_width))
        .collect()
}

impl Candidate {
    fn with_interval(self, directions: &Directions, half_width: f64) -> Option<Combination> {
        let function = directions.function(|parameter| {
            let known = self.slopes.iter().find(|(of, _)| *of == parameter);
            known.map_or(0.0, |(_, slope)| *slope)
        });
        let half = half_width * libm::sqrt(directions.covariance(&function, &function)?);
        let widest = if self.logarithmic { LN_2 } else { 0.2 };
        let to_value = |x: f64| if self.logarithmic { libm::exp(x) } else { x };
        (half <= widest).then(|| Combination {
            name: self.name,
            place: self.place,
            unit: self.unit,
            value: to_value(self.value),
            interval: [to_value(self.value - half), to_value(self.value + half)],
        })
    }
}

/// The combinations to test, at the mean sinkage (of the logarithms) and mean absolute slip of the rows.
fn candidates(model: &Model, at: &Coordinates, rows: &[SteadyLoad]) -> Vec<Candidate> {
    let count = rows.len() as f64;
    let sunk = rows.iter().filter(|row| row.sinkage > 0.0);
    let log_sinkage =
        sunk.clone().map(|row| libm::log(row.sinkage)).sum::<f64>() / sunk.count().max(1) as f64;
    let slip = rows.iter().map(|row| row.slip.abs()).sum::<f64>() / count;
    let [at_rest, slipping] = pressures(at, log_sinkage, slip);
    let log_pressure = slipping.value;
    let mut candidates = vec![at_rest, slipping];
    // A peak at an end of the contact carries no information on c1, c2.
    let is_free = model.peak_at_end(at, rows).is_none();
    if is_free {
        candidates.push(peak_share(at, slip));
    }
    if Parameter::Cohesion.is_free(model.class) {
        let pressure = match model.own() {
            Some(_) => mean_pressure(model, rows),
            None => libm::exp(log_pressure),
        };
        candidates.push(strength(model, at, pressure));
    }
    let is_ahead = at[Parameter::StressAngle as usize] < 1.0;
    if is_free && Parameter::ShearModulus.is_free(model.class) && is_ahead {
        candidates.push(shear_over_peak(at));
    }
    candidates
}

/// Pressure without slip, and at this slip [-], at a log sinkage [m].
fn pressures(at: &Coordinates, log_sinkage: f64, slip: f64) -> [Candidate; 2] {
    let of = |parameter: Parameter| at[parameter as usize];
    let at_rest = of(Parameter::SinkageModulus) + of(Parameter::SinkageExponent) * log_sinkage;
    let sinkage = format!("z = {:.3e} m", libm::exp(log_sinkage));
    let modulus = [
        (Parameter::SinkageModulus, 1.0),
        (Parameter::SinkageExponent, log_sinkage),
    ];
    let growth = [(Parameter::SinkageExponentSlip, slip * log_sinkage)];
    [
        Candidate {
            name: "k_s z^n0",
            place: sinkage.clone(),
            unit: "Pa",
            value: at_rest,
            logarithmic: true,
            slopes: modulus.to_vec(),
        },
        Candidate {
            name: "k_s z^(n0 + n1 s)",
            place: format!("{sinkage}, {}", slip_text(slip)),
            unit: "Pa",
            value: at_rest + of(Parameter::SinkageExponentSlip) * slip * log_sinkage,
            logarithmic: true,
            slopes: [&modulus[..], &growth].concat(),
        },
    ]
}

/// `θ_m/θ_1` at a slip [-].
fn peak_share(at: &Coordinates, slip: f64) -> Candidate {
    let of = |parameter: Parameter| at[parameter as usize];
    Candidate {
        name: "c1 + c2 s",
        place: slip_text(slip),
        unit: "1",
        value: of(Parameter::StressAngle) + of(Parameter::StressAngleSlip) * slip,
        logarithmic: false,
        slopes: vec![
            (Parameter::StressAngle, 1.0),
            (Parameter::StressAngleSlip, slip),
        ],
    }
}

/// `K` over the part of the contact ahead of the peak: to first order of a short contact,
/// `j(θ_m) = r s θ_1 (1 - c_1)`.
fn shear_over_peak(at: &Coordinates) -> Candidate {
    let of = |parameter: Parameter| at[parameter as usize];
    let ahead = 1.0 - of(Parameter::StressAngle);
    Candidate {
        name: "K/(1 - c1)",
        place: String::new(),
        unit: "m",
        value: of(Parameter::ShearModulus) - libm::log(ahead),
        logarithmic: true,
        slopes: vec![
            (Parameter::ShearModulus, 1.0),
            (Parameter::StressAngle, 1.0 / ahead),
        ],
    }
}

fn slip_text(slip: f64) -> String {
    format!("s = {slip:.3}")
}

/// Mean pressure [Pa]: load over the area of the rim's contact between entry and exit.
fn mean_pressure(model: &Model, rows: &[SteadyLoad]) -> f64 {
    let Rim { radius, width } = model.surface();
    let pressures = rows.iter().filter_map(|row| {
        let entry = entry_angle(radius, row.sinkage);
        let exit = model.setting.exit_angle * entry;
        let area = width * radius * (libm::sin(entry) - libm::sin(exit));
        (area > 0.0).then(|| row.load / area)
    });
    let pressures: Vec<f64> = pressures.collect();
    pressures.iter().sum::<f64>() / pressures.len().max(1) as f64
}

/// Shear strength `c + σ tan φ` under a `pressure` [Pa].
fn strength(model: &Model, at: &Coordinates, pressure: f64) -> Candidate {
    let soil = model.soil(at);
    let (tan_phi, strength) = (soil.tan_friction_angle(), soil.shear().strength(pressure));
    Candidate {
        name: "c + sigma tan(phi)",
        place: format!("sigma = {pressure:.4e} Pa"),
        unit: "Pa",
        value: libm::log(strength),
        logarithmic: true,
        slopes: vec![
            (Parameter::Cohesion, soil.cohesion / strength),
            (
                Parameter::FrictionAngle,
                pressure * (1.0 + tan_phi * tan_phi) / strength,
            ),
        ],
    }
}
