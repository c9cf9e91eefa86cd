//! Wheel-soil mechanics: pressure-sinkage, shear, and their integral over the wheel.
//!
//! The simulator evaluates these equations, and the identification of soil from loads inverts the same functions.
//!
//! Symbols of the whole project, SI units, angles \[rad\] at the axle from straight down, positive
//! ahead:
//!
//! | symbol | quantity | unit | here |
//! |---|---|---|---|
//! | `r`, `b` | rim radius, width | m | [`closed_form::Rim`] |
//! | `l`, `n_l`, `t` | lug height, number, thickness | m, -, m | [`crate::wheel::Lugs`] |
//! | `r_s` | shear radius | m | [`lug_action::shear_radius`] |
//! | `z` | sinkage of the rim, positive down | m | `sinkage` |
//! | `h`, `d` | thickness of the soil carried by lugs, depth dug by it | m | [`carried_soil`] |
//! | `s` | slip ratio by the rim | - | [`crate::quantity::SlipRatio`] |
//! | `k_c`, `k_φ`, `k_s` | cohesive, frictional, sinkage modulus | N·m⁻⁽ᴺ⁺¹⁾, N·m⁻⁽ᴺ⁺²⁾ twice | [`Soil::sinkage_modulus`] |
//! | `n_0`, `n_1`, `N` | sinkage exponent `N = n_0 + n_1 abs(s)` | - | [`Soil::exponent`] |
//! | `c`, `φ` | cohesion, internal friction angle | Pa, ° | [`shear::Shear`] |
//! | `K` | shear deformation modulus | m | [`shear::Shear`] |
//! | `j`, `E` | shear displacement, part of the strength it mobilises | m, - | [`shear`] |
//! | `θ_1`, `θ_m`, `θ_2` | entry, maximum stress, exit | rad | [`contact::ContactAngles`] |
//! | `c_1`, `c_2`, `c_3` | `θ_m = (c_1 + c_2 s) θ_1`, `θ_2 = c_3 θ_1` | - | [`contact::ContactAngles`] |
//! | `σ`, `τ`, `σ_m` | normal, shear, maximum normal stress | Pa | [`wheel_load::Contact`] |
//! | `A`, `B`, `C` | coefficients of Eq. (65) | - | [`closed_form::ArcCoefficients`] |
//! | `F_N`, `W` | normal force, load | N | [`wheel_load::WheelLoad`] |
//! | `F_DP` | drawbar pull | N | [`wheel_load::WheelLoad`] |
//! | `M_R`, `T_D` | resistance moment, driving torque | N·m | [`wheel_load::WheelLoad`] |

pub mod bulldozing;
pub mod carried_soil;
pub mod closed_form;
pub mod contact;
pub mod departures;
pub mod hard_base;
pub mod law;
pub mod lug_action;
pub mod penetration_rate;
pub(crate) mod power;
pub mod pressure_sinkage;
pub mod real;
pub mod rolling;
pub mod shear;
pub mod table_6;
pub mod wheel_load;

use crate::quantity::RangeError;
use departures::Departures;
use real::Real;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which distribution of stress over the contact arc the soil follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StressConvention {
    /// Wong-Reece: `σ = k_s rᴺ (cos θ - cos θ_1)ᴺ` ahead of `θ_m`, mirrored behind it.
    WongReece,
    /// The paper's triangles: linear from 0 at `θ_1` and `θ_2` to `k_s zᴺ` at `θ_m` (Eq. 62-65).
    Triangular,
}

/// A soil as wheel-soil mechanics describes it.
///
/// What can be identified from a wheel's loads is of the type `T`, so that loads can be had with
/// their derivatives by it ([`real::Dual`]).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Soil<T = f64> {
    /// Stress distribution over the contact arc.
    pub convention: StressConvention,
    /// Cohesive modulus `k_c` [N·m⁻⁽ᴺ⁺¹⁾].
    pub cohesive_modulus: T,
    /// Frictional modulus `k_φ` [N·m⁻⁽ᴺ⁺²⁾]; `k_s = k_c/b + k_φ`.
    pub frictional_modulus: T,
    /// Sinkage exponent at zero slip `n_0` [-].
    pub sinkage_exponent: T,
    /// Growth of the sinkage exponent with slip `n_1` [-]: `N = n_0 + n_1 |s|`.
    pub sinkage_exponent_slip: T,
    /// Cohesion `c` \[Pa\].
    pub cohesion: T,
    /// Internal friction angle `φ` [°].
    pub friction_angle_deg: T,
    /// Shear deformation modulus `K` \[m\].
    pub shear_modulus: T,
    /// Maximum-stress angle coefficient `c_1` [-]: `θ_m = (c_1 + c_2 s) θ_1`.
    pub stress_angle: T,
    /// Maximum-stress angle coefficient of slip `c_2` [-].
    pub stress_angle_slip: T,
    /// Exit angle coefficient `c_3` [-]: `θ_2 = c_3 θ_1`, zero or below.
    pub exit_angle: f64,
    /// Stiffness on unloading and reloading [Pa/m].
    pub unloading_stiffness: f64,
    /// Viscous damping of the ground beneath the contact [Pa·s/m].
    pub damping: f64,
    /// Bulk density [kg/m³].
    pub bulk_density: f64,
    /// Angle of repose [°] to which loose slopes relax.
    pub repose_angle_deg: f64,
    /// Additional soil effects; none by default.
    #[serde(default, skip_serializing_if = "Departures::is_none")]
    pub departures: Departures,
}

impl<T: Real> Soil<T> {
    /// `k_s = k_c/b + k_φ` [N·m⁻⁽ᴺ⁺²⁾] under a plate or wheel of `width` \[m\].
    pub fn sinkage_modulus(&self, width: f64) -> T {
        self.cohesive_modulus / width + self.frictional_modulus
    }

    /// This soil as a wheel of `diameter` \[m\] meets it: its moduli are of flat plates.
    pub fn under_wheel_of(&self, diameter: f64) -> Self {
        let factor = self.departures.diameter_factor(diameter);
        Self {
            cohesive_modulus: self.cohesive_modulus * factor,
            frictional_modulus: self.frictional_modulus * factor,
            departures: Departures {
                diameter_exponent: 0.0,
                ..self.departures
            },
            ..*self
        }
    }

    /// Sinkage exponent `N` [-] at `slip`.
    pub fn exponent(&self, slip: T) -> T {
        self.sinkage_exponent + self.sinkage_exponent_slip * slip.magnitude()
    }

    /// Tangent of the internal friction angle [-].
    pub fn tan_friction_angle(&self) -> T {
        self.friction_angle_deg.radians().tan()
    }
}

impl Soil {
    /// # Errors
    /// `RangeError` for a parameter outside its physical range.
    pub fn checked(self) -> Result<Self, RangeError> {
        let infinity = f64::INFINITY;
        RangeError::check(
            "cohesive modulus",
            "N/m^(N+1)",
            self.cohesive_modulus,
            [0.0, infinity],
        )?;
        RangeError::check(
            "frictional modulus",
            "N/m^(N+2)",
            self.frictional_modulus,
            [0.0, infinity],
        )?;
        RangeError::positive(
            "sum of the soil moduli",
            "N/m^(N+2)",
            self.cohesive_modulus + self.frictional_modulus,
        )?;
        RangeError::check("sinkage exponent", "-", self.sinkage_exponent, [0.1, 3.0])?;
        RangeError::check(
            "sinkage exponent slip",
            "-",
            self.sinkage_exponent_slip,
            [0.0, 5.0],
        )?;
        RangeError::check("cohesion", "Pa", self.cohesion, [0.0, 1.0e6])?;
        not_in_kilopascal("cohesion", self.cohesion)?;
        RangeError::check("friction angle", "°", self.friction_angle_deg, [0.0, 60.0])?;
        not_in_radians("friction angle", self.friction_angle_deg)?;
        RangeError::check(
            "shear deformation modulus",
            "m",
            self.shear_modulus,
            [0.0, 1.0],
        )?;
        RangeError::check("exit angle coefficient", "-", self.exit_angle, [-1.0, 0.0])?;
        RangeError::check(
            "stress angle coefficient",
            "-",
            self.stress_angle,
            [-1.0, 1.0],
        )?;
        RangeError::check(
            "stress angle slip coefficient",
            "-",
            self.stress_angle_slip,
            [-2.0, 2.0],
        )?;
        RangeError::positive("unloading stiffness", "Pa/m", self.unloading_stiffness)?;
        RangeError::check("soil damping", "Pa·s/m", self.damping, [0.0, 1.0e9])?;
        RangeError::positive("bulk density", "kg/m³", self.bulk_density)?;
        not_in_radians("angle of repose", self.repose_angle_deg)?;
        RangeError::check("angle of repose", "°", self.repose_angle_deg, [5.0, 60.0])?;
        self.departures.check()?;
        Ok(self)
    }
}

/// Least cohesion [Pa] of a soil that has any: 10 Pa bear a layer of sand 0.6 mm thick. Published ones are
/// from some 100 Pa to 100 kPa, mostly in kPa.
const LEAST_COHESION: f64 = 10.0;

/// Least angle of friction or repose [°] of a soil that has any: the flattest published ones, of saturated
/// clays, are some 5°, and 2 rad are steeper than a wall.
const LEAST_ANGLE: f64 = 2.0;

/// # Errors
/// `RangeError` for a `value` [Pa] too small for a soil unless it is in kPa.
fn not_in_kilopascal(quantity: &'static str, value: f64) -> Result<(), RangeError> {
    if value == 0.0 || value >= LEAST_COHESION {
        return Ok(());
    }
    let pascal = (1.0e6 * value).round() / 1.0e3;
    Err(RangeError {
        quantity,
        unit: "Pa",
        range: format!("0, or {LEAST_COHESION} or more ({value} kPa are {pascal} Pa)"),
        value,
    })
}

/// # Errors
/// `RangeError` for a `value` [°] too small for a soil unless it is in rad.
fn not_in_radians(quantity: &'static str, value: f64) -> Result<(), RangeError> {
    let is_flatter = value > 0.0 && value < LEAST_ANGLE;
    if !is_flatter {
        return Ok(());
    }
    let degrees = (10.0 * value.to_degrees()).round() / 10.0;
    Err(RangeError {
        quantity,
        unit: "°",
        range: format!("0, or {LEAST_ANGLE} or more ({value} rad are {degrees}°)"),
        value,
    })
}
