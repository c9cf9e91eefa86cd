//! Combinations of parameters that data fix where they do not fix the parameters one by one.

use super::directions::Directions;
use super::model::Model;
use super::parameter::{Coordinates, Parameter};
use super::row::SteadyLoad;
use crate::soil::closed_form::Rim;
use crate::soil::contact::entry_angle;
use std::f64::consts::LN_2;

/// A combination that the data fix.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// What it is, in the project's symbols, for example `k_s z^n0`.
    pub name: &'static str,
    /// Where it was taken, for example `z = 1e-5 m`; empty where that does not matter.
    pub place: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
}

/// A combination that may be fixed: a function of the coordinates and its slopes.
struct Candidate {
    name: &'static str,
    place: String,
    unit: &'static str,
    /// The function; its logarithm where it is a positive quantity.
    value: f64,
    logarithmic: bool,
    slopes: Vec<(Parameter, f64)>,
}

/// The combinations that hold a parameter which is not `identified`, and that the data fix to
/// better than a factor of two (or 0.2 where they are angles' shares).
///
/// `reach` is the half-width of a 95 % interval in standard deviations of weighted errors.
pub(super) fn fixed(
    model: &Model,
    at: &Coordinates,
    rows: &[SteadyLoad],
    directions: &Directions,
    (identified, reach): (&[Parameter], f64),
) -> Vec<Combination> {
    let open = |candidate: &Candidate| {
        let parameters = candidate.slopes.iter().map(|(parameter, _)| parameter);
        let free = |parameter: &&Parameter| directions.free().contains(parameter);
        let mut free = parameters.filter(free);
        free.any(|parameter| !identified.contains(parameter))
    };
    let told = candidates(model, at, rows).into_iter().filter(open);
    told.filter_map(|candidate| candidate.with_interval(directions, reach))
        .collect()
}

impl Candidate {
    fn with_interval(self, directions: &Directions, reach: f64) -> Option<Combination> {
        let function = directions.function(|parameter| {
            let known = self.slopes.iter().find(|(of, _)| *of == parameter);
            known.map_or(0.0, |(_, slope)| *slope)
        });
        let half = reach * libm::sqrt(directions.covariance(&function, &function)?);
        let widest = if self.logarithmic { LN_2 } else { 0.2 };
        let told = |x: f64| if self.logarithmic { libm::exp(x) } else { x };
        (half <= widest).then(|| Combination {
            name: self.name,
            place: self.place,
            unit: self.unit,
            value: told(self.value),
            interval: [told(self.value - half), told(self.value + half)],
        })
    }
}

fn candidates(model: &Model, at: &Coordinates, rows: &[SteadyLoad]) -> Vec<Candidate> {
    let of = |parameter: Parameter| at[parameter as usize];
    let count = rows.len() as f64;
    let sunk = rows.iter().filter(|row| row.sinkage > 0.0);
    let log_sinkage =
        sunk.clone().map(|row| libm::log(row.sinkage)).sum::<f64>() / sunk.count().max(1) as f64;
    let slip = rows.iter().map(|row| row.slip.abs()).sum::<f64>() / count;
    let at_rest = of(Parameter::SinkageModulus) + of(Parameter::SinkageExponent) * log_sinkage;
    let log_pressure = at_rest + of(Parameter::SinkageExponentSlip) * slip * log_sinkage;
    let sinkage = format!("z = {:.3e} m", libm::exp(log_sinkage));
    let slipping = format!("s = {slip:.3}");
    let modulus = [
        (Parameter::SinkageModulus, 1.0),
        (Parameter::SinkageExponent, log_sinkage),
    ];
    let mut candidates = vec![
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
            place: format!("{sinkage}, {slipping}"),
            unit: "Pa",
            value: log_pressure,
            logarithmic: true,
            slopes: [
                &modulus[..],
                &[(Parameter::SinkageExponentSlip, slip * log_sinkage)],
            ]
            .concat(),
        },
    ];
    // Held by the contact, shares say nothing of the rows.
    let is_free = model.peak_at_end(at, rows).is_none();
    if is_free {
        candidates.push(Candidate {
            name: "c1 + c2 s",
            place: slipping,
            unit: "1",
            value: of(Parameter::StressAngle) + of(Parameter::StressAngleSlip) * slip,
            logarithmic: false,
            slopes: vec![
                (Parameter::StressAngle, 1.0),
                (Parameter::StressAngleSlip, slip),
            ],
        });
    }
    if Parameter::Cohesion.is_free(model.class) {
        let pressure = match model.own() {
            Some(_) => mean_pressure(model, rows),
            None => libm::exp(log_pressure),
        };
        candidates.push(strength(model, at, pressure));
    }
    if is_free && Parameter::ShearModulus.is_free(model.class) && of(Parameter::StressAngle) < 1.0 {
        let ahead = 1.0 - of(Parameter::StressAngle);
        candidates.push(Candidate {
            // To first order of a short contact, j(θ_m) = r s θ_1 (1 - c_1).
            name: "K/(1 - c1)",
            place: String::new(),
            unit: "m",
            value: of(Parameter::ShearModulus) - libm::log(ahead),
            logarithmic: true,
            slopes: vec![
                (Parameter::ShearModulus, 1.0),
                (Parameter::StressAngle, 1.0 / ahead),
            ],
        });
    }
    candidates
}

/// Mean of the loads over the area [m²] of the rim's contact, between entry and exit [Pa].
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
