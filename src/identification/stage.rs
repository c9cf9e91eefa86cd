//! Stages of the identification.

use super::parameter::Parameter;
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
    /// All of them, in order of dependence.
    pub const ALL: [Self; 3] = [Self::Angles, Self::NormalStress, Self::ShearStress];

    /// The stage that estimates a parameter.
    pub fn of(parameter: Parameter) -> Self {
        let finds = |stage: &Self| stage.parameters().contains(&parameter);
        let found = Self::ALL.into_iter().find(finds);
        found.expect("the stages find all parameters between them")
    }

    /// The parameters of the stage.
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
