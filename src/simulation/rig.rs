//! Test rigs: how the wheel is guided, loaded and driven.

pub mod carriage;
pub mod flaws;
pub mod motor;

use crate::quantity::GRAVITY;
use crate::quantity::{RangeError, SampleRate, SlipRatio};
use crate::wheel::Wheel;
use carriage::{Carriage, CarriageDrive};
use flaws::{DriveFlaws, FrameFlaws};
use libm::{cos, sin};
use motor::{Motor, MotorDrive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// How the carriage moves and the motor turns.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Drive {
    /// Forward speed `v` [m/s]; below 0 in reverse.
    pub forward_speed: f64,
    /// Slip ratio [-]. Give this or `wheel_speed`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip: Option<SlipRatio>,
    /// Wheel speed `ω` [rad/s], needed at s = 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wheel_speed: Option<f64>,
    /// Time \[s\] over which speeds grow from rest to their values.
    pub start_up: f64,
    /// Time \[s\] at which the motors stop over one `start_up`; never if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_at: Option<f64>,
    /// The motor that turns the wheel; rigid if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor: Option<Motor>,
    /// The carriage that moves it along the track, on a rover the chassis that pushes the leg; rigid if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub carriage: Option<Carriage>,
    /// Departures from the motion commanded.
    #[serde(rename = "drive_flaws", skip_serializing_if = "DriveFlaws::is_none")]
    #[schemars(default)]
    pub flaws: DriveFlaws,
}

/// The single-wheel test bed (Fig. 9).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SingleWheel {
    /// Motion.
    #[serde(flatten)]
    pub drive: Drive,
    /// Vertical load `W` \[N\] at rest, wheel's weight included.
    pub load: f64,
    /// Mass \[kg\] of all that moves vertically: carriage slide, sensor, motor, wheel.
    pub moving_mass: f64,
    /// Clearance \[m\] at which the wheel is held off the ground; a lifted wheel touches nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lifted: Option<f64>,
    /// Slope of the track [°], above 0 uphill.
    #[schemars(default)]
    pub slope_deg: f64,
    /// Departures of guide and load.
    #[serde(rename = "frame_flaws", skip_serializing_if = "FrameFlaws::is_none")]
    #[schemars(default)]
    pub flaws: FrameFlaws,
}

/// One leg of a rover (Fig. 1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct RoverLeg {
    /// Motion.
    #[serde(flatten)]
    pub drive: Drive,
    /// Vertical load `W` \[N\] at rest, wheel's weight included.
    pub load: f64,
    /// Stiffness `k_w` [N/m] between body and axle.
    pub stiffness: f64,
    /// Damping `c_w` [N·s/m] between body and axle.
    pub damping: f64,
    /// Slope of the track [°], above 0 uphill.
    #[schemars(default)]
    pub slope_deg: f64,
    /// Departures of guide and load.
    #[serde(rename = "frame_flaws", skip_serializing_if = "FrameFlaws::is_none")]
    #[schemars(default)]
    pub flaws: FrameFlaws,
}

/// Spring and damper between the axle and what rides on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    stiffness: f64,
    damping: f64,
    flaws: FrameFlaws,
}

impl Leg {
    /// Force \[N\] of spring and damper on the axle, upward, beyond what they carry at rest, where
    /// the body stands `stretch` \[m\] above its place and rises off the axle at `rate` [m/s]
    /// (Eq. 1).
    pub fn spring_force(&self, stretch: f64, rate: f64) -> f64 {
        self.stiffness * self.flaws.stiffer(stretch) * stretch + self.damping * rate
    }
}

/// How the wheel is guided, loaded and driven.
///
/// Read from a `[rig.single_wheel]` or `[rig.rover_leg]` table, in which the keys of [`Drive`]
/// stand beside those of the rig.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", try_from = "RigTable")]
#[schemars(!try_from, deny_unknown_fields)]
#[non_exhaustive]
pub enum Rig {
    /// The single-wheel test bed.
    SingleWheel(SingleWheel),
    /// One leg of a rover.
    RoverLeg(RoverLeg),
}

/// Why a table does not describe a rig.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// A value has no meaning.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The wheel speed is not determined.
    #[error(
        "missing `slip` [-]; where the wheel spins in place give `wheel_speed` [rad/s] in its stead"
    )]
    NoWheelSpeed,
    /// Two keys determine the wheel speed.
    #[error(
        "`slip` and `wheel_speed` are both given, and each determines the other; omit one of them"
    )]
    TwoWheelSpeeds,
}

/// A load of 0 N on a rig that cannot be without.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a load of 0 N lifts the wheel, and a rover's leg always carries its rover")]
pub struct CannotLift;

/// Default clearance \[m\] of a lifted wheel: no stone or lug mark reaches it.
pub const CLEARANCE: f64 = 0.02;

/// A `[rig]` table before its checks: flat, so that unknown keys are refused.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum RigTable {
    SingleWheel(SingleWheelTable),
    RoverLeg(RoverLegTable),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SingleWheelTable {
    forward_speed: f64,
    slip: Option<SlipRatio>,
    wheel_speed: Option<f64>,
    start_up: f64,
    stop_at: Option<f64>,
    motor: Option<Motor>,
    carriage: Option<Carriage>,
    load: f64,
    moving_mass: f64,
    lifted: Option<f64>,
    #[serde(default)]
    slope_deg: f64,
    #[serde(default)]
    drive_flaws: DriveFlaws,
    #[serde(default)]
    frame_flaws: FrameFlaws,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RoverLegTable {
    forward_speed: f64,
    slip: Option<SlipRatio>,
    wheel_speed: Option<f64>,
    start_up: f64,
    stop_at: Option<f64>,
    motor: Option<Motor>,
    carriage: Option<Carriage>,
    load: f64,
    stiffness: f64,
    damping: f64,
    #[serde(default)]
    slope_deg: f64,
    #[serde(default)]
    drive_flaws: DriveFlaws,
    #[serde(default)]
    frame_flaws: FrameFlaws,
}

impl RigTable {
    /// The rig, its values unchecked; exactly one key determines the wheel speed.
    pub(crate) fn into_rig(self) -> Result<Rig, RigError> {
        let rig = match self {
            Self::SingleWheel(table) => Rig::SingleWheel(table.into()),
            Self::RoverLeg(table) => Rig::RoverLeg(table.into()),
        };
        match (rig.drive().slip, rig.drive().wheel_speed) {
            (None, None) => Err(RigError::NoWheelSpeed),
            (Some(_), Some(_)) => Err(RigError::TwoWheelSpeeds),
            _ => Ok(rig),
        }
    }

    /// Path of the rig's keys in a scenario.
    pub(crate) fn path(&self) -> &'static str {
        match self {
            Self::SingleWheel(_) => SINGLE_WHEEL_PATH,
            Self::RoverLeg(_) => ROVER_LEG_PATH,
        }
    }
}

const SINGLE_WHEEL_PATH: &str = "rig.single_wheel";
const ROVER_LEG_PATH: &str = "rig.rover_leg";

impl From<SingleWheelTable> for SingleWheel {
    fn from(table: SingleWheelTable) -> Self {
        Self {
            drive: Drive {
                forward_speed: table.forward_speed,
                slip: table.slip,
                wheel_speed: table.wheel_speed,
                start_up: table.start_up,
                stop_at: table.stop_at,
                motor: table.motor,
                carriage: table.carriage,
                flaws: table.drive_flaws,
            },
            load: table.load,
            moving_mass: table.moving_mass,
            lifted: table.lifted,
            slope_deg: table.slope_deg,
            flaws: table.frame_flaws,
        }
    }
}

impl From<RoverLegTable> for RoverLeg {
    fn from(table: RoverLegTable) -> Self {
        Self {
            drive: Drive {
                forward_speed: table.forward_speed,
                slip: table.slip,
                wheel_speed: table.wheel_speed,
                start_up: table.start_up,
                stop_at: table.stop_at,
                motor: table.motor,
                carriage: table.carriage,
                flaws: table.drive_flaws,
            },
            load: table.load,
            stiffness: table.stiffness,
            damping: table.damping,
            slope_deg: table.slope_deg,
            flaws: table.frame_flaws,
        }
    }
}

impl TryFrom<RigTable> for Rig {
    type Error = RigError;
    fn try_from(table: RigTable) -> Result<Self, RigError> {
        let rig = table.into_rig()?;
        rig.check()?;
        Ok(rig)
    }
}

impl SingleWheel {
    /// Mass [kg] of slide, wheel and counterweight.
    fn guided_mass(&self) -> f64 {
        let carried = self.load / GRAVITY;
        let counterweight = (self.moving_mass - carried).max(0.0);
        self.moving_mass.max(carried) + counterweight
    }
}

impl Rig {
    /// # Errors
    /// `RangeError` for a load, mass or stiffness that is not positive, a negative damping,
    /// clearance or time, a slope beyond ±35°, and a slip of 1.
    pub fn check(&self) -> Result<(), RangeError> {
        self.drive().check()?;
        self.drive().flaws.check()?;
        self.frame().check()?;
        RangeError::positive("load", "N", self.load())?;
        match *self {
            Self::SingleWheel(rig) => {
                RangeError::positive("moving mass", "kg", rig.moving_mass)?;
                RangeError::check(
                    "lifted clearance",
                    "m",
                    rig.lifted.unwrap_or(0.0),
                    [0.0, 1.0],
                )?;
            }
            Self::RoverLeg(rig) => {
                RangeError::positive("leg stiffness", "N/m", rig.stiffness)?;
                RangeError::check("leg damping", "N·s/m", rig.damping, [0.0, 1.0e9])?;
            }
        }
        RangeError::check("slope", "°", self.slope_deg(), [-35.0, 35.0])?;
        Ok(())
    }

    /// Whether steps of this rate resolve the oscillations of carriage and gear with this wheel.
    ///
    /// # Errors
    /// `RangeError` for a stiffness that they do not.
    pub fn check_rate(&self, wheel: &Wheel, rate: SampleRate) -> Result<(), RangeError> {
        self.carriage_drive(wheel, rate)?;
        self.motor_drive(wheel, rate).map(drop)
    }

    /// The carriage at work, at steps of this rate; `None` where it is rigid.
    pub(super) fn carriage_drive(
        &self,
        wheel: &Wheel,
        rate: SampleRate,
    ) -> Result<Option<CarriageDrive>, RangeError> {
        let carriage = self.drive().carriage.filter(|c| !c.is_rigid());
        let mass = self.moving_mass(wheel);
        let drive = carriage.map(|carriage| CarriageDrive::new(carriage, mass, rate));
        drive.transpose()
    }

    /// The motor at work, at steps of this rate; `None` where it is rigid.
    pub(super) fn motor_drive(
        &self,
        wheel: &Wheel,
        rate: SampleRate,
    ) -> Result<Option<MotorDrive>, RangeError> {
        let motor = self.drive().motor.filter(|m| !m.is_rigid());
        let drive = motor.map(|motor| MotorDrive::new(motor, wheel.inertia, rate));
        drive.transpose()
    }

    /// Path of the rig's keys in a scenario, for example `rig.single_wheel`.
    pub fn path(&self) -> &'static str {
        match self {
            Self::SingleWheel(_) => SINGLE_WHEEL_PATH,
            Self::RoverLeg(_) => ROVER_LEG_PATH,
        }
    }

    /// Motion.
    pub fn drive(&self) -> &Drive {
        match self {
            Self::SingleWheel(rig) => &rig.drive,
            Self::RoverLeg(rig) => &rig.drive,
        }
    }

    /// Motion, to be edited.
    pub fn drive_mut(&mut self) -> &mut Drive {
        match self {
            Self::SingleWheel(rig) => &mut rig.drive,
            Self::RoverLeg(rig) => &mut rig.drive,
        }
    }

    /// Departures of guide and load.
    pub fn frame(&self) -> &FrameFlaws {
        match self {
            Self::SingleWheel(rig) => &rig.flaws,
            Self::RoverLeg(rig) => &rig.flaws,
        }
    }

    /// Departures of guide and load, to be edited.
    pub fn frame_mut(&mut self) -> &mut FrameFlaws {
        match self {
            Self::SingleWheel(rig) => &mut rig.flaws,
            Self::RoverLeg(rig) => &mut rig.flaws,
        }
    }

    /// Vertical load `W` \[N\] at rest, to be edited.
    pub fn load_mut(&mut self) -> &mut f64 {
        match self {
            Self::SingleWheel(rig) => &mut rig.load,
            Self::RoverLeg(rig) => &mut rig.load,
        }
    }

    /// Load \[N\] of the wheel on the ground at rest: 0 for a lifted wheel.
    pub fn carried(&self) -> f64 {
        if self.clearance() > 0.0 {
            0.0
        } else {
            self.load()
        }
    }

    /// Clearance \[m\] of the lifted wheel, or that it would have.
    pub fn lifting_clearance(&self) -> f64 {
        match self.clearance() {
            0.0 => CLEARANCE,
            own => own,
        }
    }

    /// Puts so much load \[N\] on the ground; under none the wheel is held off it, by this clearance \[m\] where one
    /// is given.
    ///
    /// # Errors
    /// `CannotLift` for no load on a rig without a carriage that could be clamped.
    pub fn carry(&mut self, load: f64, clearance: Option<f64>) -> Result<(), CannotLift> {
        let lifted = (load == 0.0).then(|| clearance.unwrap_or(self.lifting_clearance()));
        match self {
            Self::SingleWheel(rig) => rig.lifted = lifted,
            Self::RoverLeg(_) if lifted.is_some() => return Err(CannotLift),
            Self::RoverLeg(_) => {}
        }
        if lifted.is_none() {
            *self.load_mut() = load;
        }
        Ok(())
    }

    /// Vertical load `W` \[N\] at rest.
    pub fn load(&self) -> f64 {
        match self {
            Self::SingleWheel(rig) => rig.load,
            Self::RoverLeg(rig) => rig.load,
        }
    }
}

impl Rig {
    /// Slope of the track [°], above 0 uphill.
    pub fn slope_deg(&self) -> f64 {
        match self {
            Self::SingleWheel(rig) => rig.slope_deg,
            Self::RoverLeg(rig) => rig.slope_deg,
        }
    }

    /// Slope of the track [°], to be edited.
    pub fn slope_deg_mut(&mut self) -> &mut f64 {
        match self {
            Self::SingleWheel(rig) => &mut rig.slope_deg,
            Self::RoverLeg(rig) => &mut rig.slope_deg,
        }
    }

    /// Slope of the track [rad], above 0 uphill.
    fn slope(&self) -> f64 {
        self.slope_deg().to_radians()
    }

    /// Load at rest normal to the track \[N\]. The carriage carries what acts along it.
    pub fn normal_load(&self) -> f64 {
        self.load() * cos(self.slope())
    }

    /// Gravity along and away from the track [m/s²].
    pub fn gravity(&self) -> [f64; 2] {
        [-GRAVITY * sin(self.slope()), -GRAVITY * cos(self.slope())]
    }

    /// Clearance \[m\] at which the wheel is held off the ground; 0 where it stands on it.
    pub fn clearance(&self) -> f64 {
        match self {
            Self::SingleWheel(rig) => rig.lifted.unwrap_or(0.0),
            Self::RoverLeg(_) => 0.0,
        }
    }

    /// Mass \[kg\] that moves vertically with the axle.
    ///
    /// On the test bed a counterweight over a pulley takes what the moving mass weighs beyond the
    /// load, and moves with it; where the moving mass weighs less, dead weight makes up for it. On a
    /// frame that gives, the wheel moves without them.
    pub fn moving_mass(&self, wheel: &Wheel) -> f64 {
        match self {
            Self::SingleWheel(rig) if self.leg(wheel).is_none() => rig.guided_mass(),
            _ => wheel.mass,
        }
    }

    /// Mass \[kg\] on the leg's spring; `None` on a rig without one.
    pub fn sprung_mass(&self, wheel: &Wheel) -> Option<f64> {
        self.leg(wheel)?;
        let mass = match self {
            Self::SingleWheel(rig) => rig.guided_mass(),
            Self::RoverLeg(rig) => rig.load / GRAVITY,
        };
        Some((mass - wheel.mass).max(0.1))
    }

    /// What springs between the axle and what rides on it; `None` on a rigid rig.
    pub fn leg(&self, wheel: &Wheel) -> Option<Leg> {
        let (stiffness, damping) = match self {
            Self::SingleWheel(rig) => {
                let [stiffness, damping] = rig.flaws.spring(wheel.mass)?;
                (stiffness, damping)
            }
            // The frame's compliance and the leg's spring give one after the other.
            Self::RoverLeg(rig) => (
                rig.stiffness / (1.0 + rig.flaws.compliance * rig.stiffness),
                rig.damping,
            ),
        };
        Some(Leg {
            stiffness,
            damping,
            flaws: *self.frame(),
        })
    }

    /// What a slope changes in the weight [N] of the wheel beyond a transducer tared on the level:
    /// how much less presses it off the track, and how much pulls it down the slope.
    pub(super) fn wheel_weight(&self, wheel: &Wheel) -> [f64; 2] {
        let weight = wheel.mass * GRAVITY;
        [
            weight * (1.0 - cos(self.slope())),
            weight * sin(self.slope()),
        ]
    }

    /// Weight [N] below the leg's spring, normal to the track.
    pub(super) fn unsprung_weight(&self, wheel: &Wheel) -> f64 {
        wheel.mass * GRAVITY * cos(self.slope())
    }
}

/// Speeds at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// Forward speed [m/s].
    pub forward: f64,
    /// Wheel speed [rad/s].
    pub wheel: f64,
}

/// Speeds over time that a user brings, such as a logged manoeuvre.
pub trait DriveProfile: fmt::Debug + Send + Sync {
    /// What is commanded at `time` \[s\] after the wheel was let down, lead-in included. A rigid carriage or motor follows
    /// at once, so that a jump of the speed is an impact.
    fn speeds(&self, time: f64) -> Speeds;
}

/// Speeds commanded over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    full: [f64; 2],
    /// What of a speed comes to the carriage and to the wheel [-].
    scale: [f64; 2],
    start_up: f64,
    stop_at: Option<f64>,
}

/// What is commanded at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Commanded {
    /// When \[s\].
    pub time: f64,
    /// Forward speed [m/s].
    pub forward_speed: f64,
    /// Wheel speed [rad/s].
    pub wheel_speed: f64,
    /// Both as a share of the full speeds [-].
    pub share: f64,
}

impl Commanded {
    /// The wheel stands.
    pub(super) const REST: Self = Self {
        time: 0.0,
        forward_speed: 0.0,
        wheel_speed: 0.0,
        share: 0.0,
    };
}

impl Command {
    /// What `drive` commands on a rim of `radius` \[m\].
    ///
    /// # Errors
    /// `RangeError` where neither slip nor wheel speed is given.
    pub fn new(drive: &Drive, radius: f64) -> Result<Self, RangeError> {
        let DriveFlaws {
            carriage_scale,
            wheel_scale,
            ..
        } = drive.flaws;
        let full = [
            drive.forward_speed * carriage_scale,
            drive.full_wheel_speed(radius)? * wheel_scale,
        ];
        Ok(Self {
            full,
            scale: [carriage_scale, wheel_scale],
            start_up: drive.start_up,
            stop_at: drive.stop_at,
        })
    }

    /// Command at `time` \[s\] of a profile that commands these speeds then.
    pub(super) fn of(&self, speeds: Speeds, time: f64) -> Commanded {
        let wheel_speed = speeds.wheel * self.scale[1];
        let share = wheel_speed / self.full[1];
        Commanded {
            time,
            forward_speed: speeds.forward * self.scale[0],
            wheel_speed,
            share: if share.is_finite() { share } else { 0.0 },
        }
    }

    /// Command at `time` \[s\]: both speeds rise and fall together, smoothly, so that slip is constant from the
    /// first motion on.
    pub fn at(&self, time: f64) -> Commanded {
        let rise = |since: f64| {
            if since >= self.start_up {
                1.0
            } else {
                0.5 - 0.5 * cos(std::f64::consts::PI * since.max(0.0) / self.start_up)
            }
        };
        let share = rise(time)
            - self.stop_at.map_or(
                0.0,
                |stop| if time > stop { rise(time - stop) } else { 0.0 },
            );
        let [forward_speed, wheel_speed] = self.full.map(|speed| speed * share);
        Commanded {
            time,
            forward_speed,
            wheel_speed,
            share,
        }
    }
}

impl Drive {
    /// # Errors
    /// `RangeError` for a speed that is not finite or absurd, a slip of 1, and a negative time.
    pub fn check(&self) -> Result<(), RangeError> {
        RangeError::check("forward speed", "m/s", self.forward_speed, [-10.0, 10.0])?;
        let given = self.wheel_speed.unwrap_or(0.0);
        RangeError::check("wheel speed", "rad/s", given, [-1000.0, 1000.0])?;
        self.full_wheel_speed(1.0)?;
        RangeError::check("start-up time", "s", self.start_up, [0.0, 1.0e4])?;
        let earliest = self.start_up;
        RangeError::check(
            "stop time",
            "s",
            self.stop_at.unwrap_or(earliest),
            [earliest, 1.0e6],
        )?;
        self.motor.map_or(Ok(()), |motor| motor.check())?;
        self.carriage.map_or(Ok(()), |carriage| carriage.check())
    }

    /// Commanded slip ratio [-] on a rim of `radius` \[m\].
    pub fn commanded_slip(&self, radius: f64) -> f64 {
        let from_speeds =
            |wheel_speed| SlipRatio::from_motion(radius, wheel_speed, self.forward_speed);
        self.slip
            .or_else(|| self.wheel_speed.map(from_speeds))
            .map_or(f64::NAN, SlipRatio::get)
    }

    /// Commanded wheel speed [rad/s] at full speed on a rim of `radius` \[m\].
    ///
    /// # Errors
    /// `RangeError` where neither slip nor wheel speed is given.
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

/// Whether steps of this rate resolve the oscillation of an inertia on a spring of this stiffness: at most half a
/// radian a step.
fn resolved(
    quantity: &'static str,
    unit: &'static str,
    stiffness: f64,
    inertia: f64,
    rate: SampleRate,
) -> Result<(), RangeError> {
    let per_step = 0.5 * rate.hertz();
    let most = per_step * per_step * inertia;
    if stiffness <= most {
        return Ok(());
    }
    Err(RangeError {
        quantity,
        unit,
        range: format!(
            "at most {most:.3e} at a physics rate of {} Hz, or inf for a rigid one",
            rate.hertz()
        ),
        value: stiffness,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(keys: &str) -> Result<Rig, toml::de::Error> {
        let rest = "start_up = 1.0\nload = 100.0\nmoving_mass = 12.0";
        toml::from_str(&format!(
            "[single_wheel]\nforward_speed = 0.01\n{rest}\n{keys}"
        ))
    }

    #[test]
    fn a_wheel_that_is_lifted_carries_nothing_until_it_is_loaded_and_a_rovers_leg_cannot_be() {
        let mut rig = read("slip = 0.2").unwrap();
        rig.carry(0.0, None).unwrap();
        assert_eq!((rig.carried(), rig.clearance()), (0.0, CLEARANCE));
        rig.carry(0.0, Some(0.05)).unwrap();
        rig.carry(0.0, None).unwrap();
        assert_eq!(rig.clearance(), 0.05);
        rig.carry(60.0, None).unwrap();
        assert_eq!((rig.carried(), rig.clearance()), (60.0, 0.0));
        let leg = "[rover_leg]\nforward_speed = 0.01\nslip = 0.2\nstart_up = 1.0\nload = 284.0\n\
                   stiffness = 5e4\ndamping = 500.0";
        let mut leg: Rig = toml::from_str(leg).unwrap();
        let refused = leg.carry(0.0, None).unwrap_err().to_string();
        assert!(
            refused.contains("a rover's leg always carries"),
            "{refused}"
        );
    }

    #[test]
    fn a_rig_comes_back_from_its_own_file() {
        let keys = "slip = 0.2\nstop_at = 9.0\nlifted = 0.01\nslope_deg = 5.0\n\
                    carriage = { mass = 30.0, stiffness = 5e5, damping_ratio = 0.05, force_limit = 1e3 }";
        let rig = read(keys).unwrap();
        let again: Rig = toml::from_str(&toml::to_string(&rig).unwrap()).unwrap();
        assert_eq!(again, rig);
    }

    #[test]
    fn a_wheel_that_spins_in_place_is_commanded_by_its_wheel_speed() {
        assert_eq!(read("wheel_speed = 0.1").unwrap().drive().slip, None);
        let message = read("slip = 1.0").unwrap_err().to_string();
        assert!(
            message.contains("below 1, or give wheel_speed [rad/s]"),
            "{message}"
        );
    }

    #[test]
    fn exactly_one_key_determines_the_wheel_speed() {
        let message = read("").unwrap_err().to_string();
        assert!(message.contains("missing `slip`"), "{message}");
        let message = read("slip = 0.1\nwheel_speed = 0.1")
            .unwrap_err()
            .to_string();
        assert!(message.contains("omit one of them"), "{message}");
    }

    #[test]
    fn keys_of_the_other_rig_are_refused() {
        let message = read("slip = 0.1\nstiffness = 1e6").unwrap_err().to_string();
        assert!(message.contains("unknown field `stiffness`"), "{message}");
    }
}
