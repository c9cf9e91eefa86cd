//! What carriage and motor do to the wheel, step by step.

use super::contact::Mobility;
use super::motion::WheelMotion;
use super::rig::carriage::CarriageDrive;
use super::rig::flaws::DriveFlaws;
use super::rig::motor::MotorDrive;
use super::rig::{Commanded, Rig};
use crate::quantity::{RangeError, SampleRate};
use crate::wheel::Wheel;

/// What a drive does to one coordinate of the wheel over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Action {
    /// It imposes this speed [m/s or rad/s].
    Speed(f64),
    /// It exerts this force or torque [N or N·m].
    Force(f64),
}

/// What carriage and motor do over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Actions {
    /// The carriage, along the track.
    pub along: Action,
    /// The motor, about the axle; positive where it drives forward.
    pub about: Action,
}

impl Actions {
    /// Nothing guides the wheel.
    #[cfg(test)]
    pub const NONE: Self = Self {
        along: Action::Force(0.0),
        about: Action::Force(0.0),
    };
}

/// Carriage and motor at work; rigid where the rig gives them no stiffness.
pub(super) struct Mount {
    carriage: Option<CarriageDrive>,
    motor: Option<MotorDrive>,
    flaws: DriveFlaws,
    dt: f64,
}

impl Mount {
    /// # Errors
    /// `RangeError` for a stiffness that steps at `rate` cannot resolve.
    pub fn new(rig: &Rig, wheel: &Wheel, rate: SampleRate) -> Result<Self, RangeError> {
        Ok(Self {
            carriage: rig.carriage_drive(wheel, rate)?,
            motor: rig.motor_drive(wheel, rate)?,
            flaws: rig.drive().flaws,
            dt: rate.period(),
        })
    }

    /// What carriage and motor do to a wheel in `motion` over the next step.
    pub fn act(&mut self, commanded: &Commanded, motion: &WheelMotion) -> Actions {
        let along = match &mut self.carriage {
            None => Action::Speed(commanded.forward_speed),
            Some(carriage) => {
                Action::Force(carriage.push(commanded.forward_speed, motion.vx, self.dt))
            }
        };
        let rippled = |speed| self.flaws.wheel_speed(speed, commanded, motion.angle);
        let about = match &mut self.motor {
            None => Action::Speed(rippled(commanded.wheel_speed)),
            Some(motor) => {
                motor.follow(commanded.wheel_speed, self.dt);
                Action::Force(motor.turn(rippled(motor.speed()), motion.omega, self.dt))
            }
        };
        Actions { along, about }
    }

    /// Mass [kg] of a carriage that yields.
    pub fn carriage_mass(&self) -> f64 {
        self.carriage.as_ref().map_or(0.0, CarriageDrive::mass)
    }

    /// How much a force moves a wheel of this mass [kg] and inertia [kg·m²] on this mount.
    pub fn mobility(&self, mass: f64, inertia: f64) -> Mobility {
        let carried = |carriage: &CarriageDrive| 1.0 / (mass + carriage.mass());
        Mobility {
            along: self.carriage.as_ref().map_or(0.0, carried),
            vertical: 1.0 / mass,
            turning: self.motor.as_ref().map_or(0.0, |_| 1.0 / inertia),
        }
    }

    /// Energy and powers now, for balances.
    #[cfg(test)]
    pub fn account(&self, commanded: &Commanded, motion: &WheelMotion) -> Account {
        let carriage = self.carriage.as_ref().expect("a carriage that yields");
        let motor = self.motor.as_ref().expect("a motor that yields");
        let [pushed, belt] = carriage.power(commanded.forward_speed, motion.vx);
        let [turned, gear] = motor.power(motion.omega);
        Account {
            carriage: pushed,
            motor: turned,
            belt_loss: belt,
            gear_loss: gear,
            belt: carriage.stored() + 0.5 * carriage.mass() * motion.vx * motion.vx,
            gear: motor.stored(),
        }
    }

    /// Whether the carriage's force, and the motor's torque, are at their limits.
    pub fn at_limits(&self) -> AtLimits {
        AtLimits {
            carriage: self.carriage.as_ref().is_some_and(CarriageDrive::at_limit),
            motor: self.motor.as_ref().is_some_and(MotorDrive::at_limit),
        }
    }
}

/// Which drives are at their limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AtLimits {
    /// The carriage, at its force.
    pub carriage: bool,
    /// The motor, at its torque.
    pub motor: bool,
}

/// Powers [W] of the drives and of their losses, and energies [J] that they hold.
#[cfg(test)]
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Account {
    pub carriage: f64,
    pub motor: f64,
    pub belt_loss: f64,
    pub gear_loss: f64,
    /// In the belt and the carriage's motion.
    pub belt: f64,
    /// In the gear and the rotor's motion.
    pub gear: f64,
}
