//! What holds, loads and drives the wheel.

use super::GRAVITY;
use crate::quantity::{RangeError, SlipRatio};
use crate::wheel::Wheel;
use libm::{cos, sin};
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

impl Rig {
    /// Slope of the track [rad], above 0 uphill.
    fn slope(&self) -> f64 {
        match self {
            Self::SingleWheel(rig) => rig.slope_deg.to_radians(),
            Self::RoverLeg(rig) => rig.slope_deg.to_radians(),
        }
    }

    /// Load at rest normal to the track [N]. The carriage carries what acts along it.
    pub fn normal_load(&self) -> f64 {
        self.load() * cos(self.slope())
    }

    /// Gravity along and away from the track [m/s²].
    pub fn gravity(&self) -> [f64; 2] {
        [-GRAVITY * sin(self.slope()), -GRAVITY * cos(self.slope())]
    }

    /// Clearance [m] at which the wheel is held off the ground; 0 where it stands on it.
    pub fn clearance(&self) -> f64 {
        match self {
            Self::SingleWheel(rig) => rig.lifted.unwrap_or(0.0),
            Self::RoverLeg(_) => 0.0,
        }
    }

    /// Mass [kg] that moves vertically with the axle.
    ///
    /// On the test bed a counterweight over a pulley takes what the moving mass weighs beyond the
    /// load, and moves with it; where the moving mass weighs less, dead weight makes up for it.
    pub fn moving_mass(&self, wheel: &Wheel) -> f64 {
        match self {
            Self::SingleWheel(rig) => {
                let carried = rig.load / GRAVITY;
                let counterweight = (rig.moving_mass - carried).max(0.0);
                rig.moving_mass.max(carried) + counterweight
            }
            Self::RoverLeg(_) => wheel.mass,
        }
    }

    /// Mass [kg] on the leg's spring; `None` on a rig without one.
    pub fn sprung_mass(&self, wheel: &Wheel) -> Option<f64> {
        match self {
            Self::SingleWheel(_) => None,
            Self::RoverLeg(rig) => Some((rig.load / GRAVITY - wheel.mass).max(0.1)),
        }
    }

    /// Weight [N] below the leg's spring, normal to the track.
    pub(super) fn unsprung_weight(&self, wheel: &Wheel) -> f64 {
        wheel.mass * GRAVITY * cos(self.slope())
    }
}

/// Speeds commanded over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    full: [f64; 2],
    start_up: f64,
    stop_at: Option<f64>,
}

impl Command {
    /// What `drive` commands on a rim of `radius` [m].
    ///
    /// # Errors
    /// `RangeError` where neither slip nor wheel speed tells how fast the wheel turns.
    pub fn new(drive: &Drive, radius: f64) -> Result<Self, RangeError> {
        let full = [drive.forward_speed, drive.full_wheel_speed(radius)?];
        Ok(Self { full, start_up: drive.start_up, stop_at: drive.stop_at })
    }

    /// Forward speed [m/s] and wheel speed [rad/s] at `time` [s]: both rise and fall together,
    /// smoothly, so that slip holds from the first motion on.
    pub fn at(&self, time: f64) -> [f64; 2] {
        let rise = |since: f64| {
            if since >= self.start_up { 1.0 } else { 0.5 - 0.5 * cos(std::f64::consts::PI * since.max(0.0) / self.start_up) }
        };
        let share = rise(time) - self.stop_at.map_or(0.0, |stop| if time > stop { rise(time - stop) } else { 0.0 });
        self.full.map(|speed| speed * share)
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
