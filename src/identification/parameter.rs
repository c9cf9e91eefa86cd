//! The terrain parameters, the coordinates of the fit, and which parameters a class sets.

use crate::quantity::RangeError;
use crate::soil::{Soil, StressConvention};
use crate::terrain::class::Wtic;
use serde::Serialize;

/// A terrain parameter of Eq. (62)-(66), in the order of Table 6.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub enum Parameter {
    /// Maximum-stress angle coefficient `c_1` [-].
    #[serde(rename = "c1")]
    StressAngle,
    /// Maximum-stress angle coefficient of slip `c_2` [-].
    #[serde(rename = "c2")]
    StressAngleSlip,
    /// Sinkage modulus `k_s` [N·m⁻⁽ᴺ⁺²⁾].
    #[serde(rename = "k_s")]
    SinkageModulus,
    /// Sinkage exponent at zero slip `n_0` [-].
    #[serde(rename = "n0")]
    SinkageExponent,
    /// Growth of the sinkage exponent with slip `n_1` [-].
    #[serde(rename = "n1")]
    SinkageExponentSlip,
    /// Cohesion `c` \[Pa\].
    #[serde(rename = "c")]
    Cohesion,
    /// Friction angle `φ` [°].
    #[serde(rename = "phi")]
    FrictionAngle,
    /// Shear deformation modulus `K` \[m\].
    #[serde(rename = "K")]
    ShearModulus,
}

/// Values of all parameters in the coordinates of the fit: logarithms of `k_s`, `c` and `K`,
/// `φ` in radians, the others as they are.
pub(super) type Coordinates = [f64; Parameter::ALL.len()];

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::StressAngle,
        Self::StressAngleSlip,
        Self::SinkageModulus,
        Self::SinkageExponent,
        Self::SinkageExponentSlip,
        Self::Cohesion,
        Self::FrictionAngle,
        Self::ShearModulus,
    ];

    /// Its name in results: `c1`, `c2`, `k_s`, `n0`, `n1`, `c`, `phi`, `K`.
    pub fn name(self) -> &'static str {
        ["c1", "c2", "k_s", "n0", "n1", "c", "phi", "K"][self as usize]
    }

    /// Its unit in results: `1`, `N/m^(N+2)`, `Pa`, `deg` or `m`.
    pub fn unit(self) -> &'static str {
        ["1", "1", "N/m^(N+2)", "1", "1", "Pa", "deg", "m"][self as usize]
    }

    /// Bounds of the search, in [`unit`](Self::unit).
    ///
    /// Wider than for any soil, so that an estimate near a natural limit (`n_1 = 0`) is not biased; for `c_1`
    /// and `c_2` so wide that hard ground, which carries almost no information on them, does not bias `φ`
    /// through a bound.
    pub fn range(self) -> [f64; 2] {
        match self {
            Self::StressAngle => [-10.0, 10.0],
            Self::StressAngleSlip => [-30.0, 30.0],
            Self::SinkageModulus => [1.0e2, 1.0e13],
            Self::SinkageExponent => [0.01, 4.0],
            Self::SinkageExponentSlip => [-3.0, 6.0],
            Self::Cohesion => [0.01, 1.0e6],
            Self::FrictionAngle => [0.5, 70.0],
            Self::ShearModulus => [1.0e-7, 1.0],
        }
    }

    /// Half-width of a 95 % interval, in the coordinate of the fit, above which it is uninformative: ends a
    /// factor of ten apart for `k_s`, `c` and `K`, the spread of published values of one kind of soil; 15°
    /// for `φ`, half of the contact for `c_1`, half of the contact per unit of slip for `c_2`, and 0.5 and 1
    /// for `n_0` and `n_1`.
    pub fn uninformative(self) -> f64 {
        match self {
            Self::StressAngle | Self::SinkageExponent => 0.5,
            Self::StressAngleSlip | Self::SinkageExponentSlip => 1.0,
            Self::SinkageModulus | Self::Cohesion | Self::ShearModulus => {
                0.5 * std::f64::consts::LN_10
            }
            Self::FrictionAngle => 15.0_f64.to_radians(),
        }
    }

    /// The coordinate of a `value` in [`unit`](Self::unit).
    pub fn coordinate(self, value: f64) -> f64 {
        match self {
            Self::SinkageModulus | Self::Cohesion | Self::ShearModulus => libm::log(value),
            Self::FrictionAngle => value.to_radians(),
            _ => value,
        }
    }

    /// The value, in [`unit`](Self::unit), at a `coordinate`.
    pub fn value(self, coordinate: f64) -> f64 {
        match self {
            Self::SinkageModulus | Self::Cohesion | Self::ShearModulus => libm::exp(coordinate),
            Self::FrictionAngle => coordinate.to_degrees(),
            _ => coordinate,
        }
    }

    /// A value within [`range`](Self::range), or 0 for cohesion and the shear deformation modulus.
    ///
    /// # Errors
    /// `RangeError` for any other.
    pub fn checked(self, value: f64) -> Result<f64, RangeError> {
        let may_be_zero = matches!(self, Self::Cohesion | Self::ShearModulus);
        if may_be_zero && value == 0.0 {
            return Ok(value);
        }
        RangeError::check(self.name(), self.unit(), value, self.range())
    }

    /// Whether a fit ended at zero cohesion: a natural limit and not a bound of the search.
    pub(super) fn is_as_good_as_zero(self, coordinate: f64) -> bool {
        let [low, high] = self.bounds();
        self == Self::Cohesion && coordinate - low < 1e-3 * (high - low)
    }

    /// Coordinates of the [`range`](Self::range).
    pub(super) fn bounds(self) -> [f64; 2] {
        self.range().map(|value| self.coordinate(value))
    }

    /// Whether a coordinate is at a bound of the search.
    pub(super) fn is_at_bound(self, coordinate: f64) -> bool {
        self.bound_at(coordinate).is_some()
    }

    /// The bound, in its unit, at which a coordinate is.
    pub(super) fn bound_at(self, coordinate: f64) -> Option<f64> {
        let [low, high] = self.bounds();
        let [least, most] = self.range();
        let near = 1e-3 * (high - low);
        let ends = [(coordinate - low, least), (high - coordinate, most)];
        ends.into_iter()
            .find(|(distance, _)| *distance < near)
            .map(|(_, end)| end)
    }

    /// Whether the parameter is fitted for this class or set by it (Table 4): `c = K = 0` where all lugs
    /// touch, `c = 0` where some do.
    pub fn is_free(self, class: Wtic) -> bool {
        match class {
            Wtic::Alct => !matches!(self, Self::Cohesion | Self::ShearModulus),
            Wtic::Slct => self != Self::Cohesion,
            Wtic::Leis | Wtic::Uwtic => true,
        }
    }
}

/// The terrain parameters of Table 6.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TerrainParameters {
    /// Maximum-stress angle coefficient `c_1` [-].
    pub stress_angle: f64,
    /// Maximum-stress angle coefficient of slip `c_2` [-].
    pub stress_angle_slip: f64,
    /// Sinkage modulus `k_s` [N·m⁻⁽ᴺ⁺²⁾].
    pub sinkage_modulus: f64,
    /// Sinkage exponent at zero slip `n_0` [-].
    pub sinkage_exponent: f64,
    /// Growth of the sinkage exponent with slip `n_1` [-].
    pub sinkage_exponent_slip: f64,
    /// Cohesion `c` \[Pa\].
    pub cohesion: f64,
    /// Friction angle `φ` [°].
    pub friction_angle_deg: f64,
    /// Shear deformation modulus `K` \[m\].
    pub shear_modulus: f64,
}

impl TerrainParameters {
    /// The parameters of a `soil` under a wheel of `width` \[m\].
    pub fn of(soil: &Soil, width: f64) -> Self {
        Self {
            stress_angle: soil.stress_angle,
            stress_angle_slip: soil.stress_angle_slip,
            sinkage_modulus: soil.sinkage_modulus(width),
            sinkage_exponent: soil.sinkage_exponent,
            sinkage_exponent_slip: soil.sinkage_exponent_slip,
            cohesion: soil.cohesion,
            friction_angle_deg: soil.friction_angle_deg,
            shear_modulus: soil.shear_modulus,
        }
    }

    /// The value of a parameter, in its [`unit`](Parameter::unit).
    pub fn get(&self, parameter: Parameter) -> f64 {
        self.values()[parameter as usize]
    }

    /// `base` with these parameters and the paper's triangular stress.
    ///
    /// `k_s` is taken as frictional: one wheel width cannot separate `k_c` from `k_φ`.
    pub fn on(&self, base: &Soil) -> Soil {
        Soil {
            convention: StressConvention::Triangular,
            cohesive_modulus: 0.0,
            frictional_modulus: self.sinkage_modulus,
            sinkage_exponent: self.sinkage_exponent,
            sinkage_exponent_slip: self.sinkage_exponent_slip,
            cohesion: self.cohesion,
            friction_angle_deg: self.friction_angle_deg,
            shear_modulus: self.shear_modulus,
            stress_angle: self.stress_angle,
            stress_angle_slip: self.stress_angle_slip,
            ..*base
        }
    }

    fn values(&self) -> [f64; 8] {
        [
            self.stress_angle,
            self.stress_angle_slip,
            self.sinkage_modulus,
            self.sinkage_exponent,
            self.sinkage_exponent_slip,
            self.cohesion,
            self.friction_angle_deg,
            self.shear_modulus,
        ]
    }

    pub(super) fn coordinates(&self) -> Coordinates {
        let values = self.values();
        Parameter::ALL.map(|parameter| parameter.coordinate(values[parameter as usize]))
    }

    pub(super) fn at(coordinates: &Coordinates) -> Self {
        let value = |parameter: Parameter| parameter.value(coordinates[parameter as usize]);
        Self {
            stress_angle: value(Parameter::StressAngle),
            stress_angle_slip: value(Parameter::StressAngleSlip),
            sinkage_modulus: value(Parameter::SinkageModulus),
            sinkage_exponent: value(Parameter::SinkageExponent),
            sinkage_exponent_slip: value(Parameter::SinkageExponentSlip),
            cohesion: value(Parameter::Cohesion),
            friction_angle_deg: value(Parameter::FrictionAngle),
            shear_modulus: value(Parameter::ShearModulus),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::table_6;

    fn sand() -> TerrainParameters {
        TerrainParameters::of(&table_6::sand(), 0.15)
    }

    #[test]
    fn coordinates_give_the_parameters_back() {
        let back = TerrainParameters::at(&sand().coordinates());
        for parameter in Parameter::ALL {
            let (value, expected) = (back.get(parameter), sand().get(parameter));
            assert!(
                (value / expected - 1.0).abs() < 1e-14,
                "{value}, not {expected}"
            );
        }
    }

    #[test]
    fn cohesion_and_shear_modulus_of_zero_survive_their_logarithms() {
        let hard = TerrainParameters {
            cohesion: 0.0,
            shear_modulus: 0.0,
            ..sand()
        };
        let back = TerrainParameters::at(&hard.coordinates());
        assert_eq!([back.cohesion, back.shear_modulus], [0.0, 0.0]);
    }

    #[test]
    fn the_class_frees_the_parameters_that_table_4_does_not_set() {
        let free = |class| Parameter::ALL.map(|p| p.is_free(class)).map(u8::from);
        assert_eq!(free(Wtic::Alct), [1, 1, 1, 1, 1, 0, 1, 0]);
        assert_eq!(free(Wtic::Slct), [1, 1, 1, 1, 1, 0, 1, 1]);
        assert_eq!(free(Wtic::Leis), [1; 8]);
    }
}
