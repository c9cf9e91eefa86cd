//! Parameters in the order of the output.

use crate::identification::{Parameter, TerrainParameters};
use serde::Serializer;

/// The parameters in the order of the output.
pub const ORDER: [Parameter; 8] = [
    Parameter::SinkageModulus,
    Parameter::SinkageExponent,
    Parameter::SinkageExponentSlip,
    Parameter::StressAngle,
    Parameter::StressAngleSlip,
    Parameter::Cohesion,
    Parameter::FrictionAngle,
    Parameter::ShearModulus,
];

/// Serialises values by the names of their parameters.
pub fn values_by_name<S: Serializer>(
    parameters: &TerrainParameters,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(ORDER.map(|of| (of.name(), parameters.get(of))))
}
