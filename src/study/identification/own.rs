//! The values that a scenario's own ground has for what is identified.

use crate::identification::{Identified, Parameter, TerrainParameters};
use crate::scenario::Scenario;
use crate::soil::Soil;
use crate::terrain::TerrainSpec;

/// The soil of a scenario, where its ground is one.
pub(super) fn soil(scenario: &Scenario) -> Option<&Soil> {
    match &scenario.terrain {
        TerrainSpec::Sand { soil, .. } | TerrainSpec::GravelInSand { soil, .. } => Some(soil),
        _ => None,
    }
}

/// The value that a scenario's own ground has for a parameter, in its unit.
pub(super) fn own_value(scenario: &Scenario, parameter: Parameter) -> Option<f64> {
    if let Some(soil) = soil(scenario) {
        let own = TerrainParameters::of(soil, scenario.wheel.width);
        return Some(own.get(parameter));
    }
    match &scenario.terrain {
        TerrainSpec::Hard { .. } | TerrainSpec::Reference { .. } => (parameter
            == Parameter::FrictionAngle)
            .then(|| libm::atan(scenario.wheel.friction).to_degrees()),
        _ => None,
    }
}

/// Whether the 95 % interval of a parameter covers a value, in its unit.
pub(super) fn holds(identified: &Identified, value: f64) -> bool {
    let [low, high] = identified.ci95();
    low.is_none_or(|low| low <= value) && high.is_none_or(|high| value <= high)
}
