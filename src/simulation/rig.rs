//! What holds, loads and drives the wheel.

use crate::quantity::{RangeError, SlipRatio};
use serde::{Deserialize, Serialize};

/// How the carriage moves and the motor turns.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Forward speed `v` [m/s]; below 0 in reverse.
    pub forward_speed: f64,
    /// Slip ratio [-]. Give this or `wheel_speed`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip: Option<SlipRatio>,
    /// Wheel speed `ω` [rad/s], needed at s = 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wheel_speed: Option<f64>,
    /// Time [s] over which speeds grow from rest to their values.
    pub start_up: f64,
    /// Time [s] at which the motors stop over one `start_up`; never if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_at: Option<f64>,
}

/// The single-wheel test bed (Fig. 9).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SingleWheel {
    /// Motion.
    #[serde(flatten)]
    pub drive: Drive,
    /// Vertical load `W` [N] at rest, wheel's weight included.
    pub load: f64,
    /// Mass [kg] of all that moves vertically: carriage slide, sensor, motor, wheel.
    pub moving_mass: f64,
    /// Clearance [m] at which the wheel is held off the ground; a lifted wheel touches nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lifted: Option<f64>,
    /// Slope of the track [°], above 0 uphill.
    #[serde(default)]
    pub slope_deg: f64,
}

/// One leg of a rover (Fig. 1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RoverLeg {
    /// Motion.
    #[serde(flatten)]
    pub drive: Drive,
    /// Vertical load `W` [N] at rest, wheel's weight included.
    pub load: f64,
    /// Stiffness `k_w` [N/m] between body and axle.
    pub stiffness: f64,
    /// Damping `c_w` [N·s/m] between body and axle.
    pub damping: f64,
    /// Slope of the track [°], above 0 uphill.
    #[serde(default)]
    pub slope_deg: f64,
}

/// What holds, loads and drives the wheel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Rig {
    /// The single-wheel test bed.
    SingleWheel(SingleWheel),
    /// One leg of a rover.
    RoverLeg(RoverLeg),
}

impl Rig {
    /// Motion.
    pub fn drive(&self) -> &Drive {
        match self {
            Self::SingleWheel(rig) => &rig.drive,
            Self::RoverLeg(rig) => &rig.drive,
        }
    }

    /// Vertical load `W` [N] at rest.
    pub fn load(&self) -> f64 {
        match self {
            Self::SingleWheel(rig) => rig.load,
            Self::RoverLeg(rig) => rig.load,
        }
    }
}

impl Drive {
    /// Commanded wheel speed [rad/s] at full speed on a rim of `radius` [m].
    ///
    /// # Errors
    /// `RangeError` where neither slip nor wheel speed tells it.
    pub fn full_wheel_speed(&self, radius: f64) -> Result<f64, RangeError> {
        let from_slip = || {
            self.slip
                .and_then(|slip| slip.wheel_speed(radius, self.forward_speed))
        };
        self.wheel_speed.or_else(from_slip).ok_or(RangeError {
            quantity: "slip ratio",
            unit: "-",
            range: "below 1, or give wheel_speed [rad/s] in its place".to_owned(),
            value: self.slip.map_or(f64::NAN, SlipRatio::get),
        })
    }
}
