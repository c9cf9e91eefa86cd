//! The values that a scenario's own ground has for what is identified.

use crate::identification::{Identified, Parameter};
use crate::scenario::Scenario;
use crate::terrain::TerrainSpec;

/// The value that a scenario's own ground has for a parameter, in its unit.
pub(super) fn own_value(scenario: &Scenario, parameter: Parameter) -> Option<f64> {
    match &scenario.terrain {
        TerrainSpec::Sand { soil, .. } | TerrainSpec::GravelInSand { soil, .. } => {
            Some(match parameter {
                Parameter::StressAngle => soil.stress_angle,
                Parameter::StressAngleSlip => soil.stress_angle_slip,
                Parameter::SinkageModulus => soil.sinkage_modulus(scenario.wheel.width),
                Parameter::SinkageExponent => soil.sinkage_exponent,
                Parameter::SinkageExponentSlip => soil.sinkage_exponent_slip,
                Parameter::Cohesion => soil.cohesion,
                Parameter::FrictionAngle => soil.friction_angle_deg,
                Parameter::ShearModulus => soil.shear_modulus,
            })
        }
        TerrainSpec::Hard { .. } | TerrainSpec::Reference { .. } => (parameter
            == Parameter::FrictionAngle)
            .then(|| libm::atan(scenario.wheel.friction).to_degrees()),
        _ => None,
    }
}

/// Whether the 95 % interval of a parameter holds a value, in its unit.
pub(super) fn holds(identified: &Identified, value: f64) -> bool {
    let [low, high] = identified.ci95();
    low.is_none_or(|low| low <= value) && high.is_none_or(|high| value <= high)
}
