//! What a real drive and a real frame have and ideal ones have not.

use super::Commanded;
use crate::quantity::RangeError;
use libm::{cos, sin};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::{SQRT_2, TAU};

/// Frequency [Hz] at which a servo loop hunts.
const HUNTING: f64 = 2.3;

/// Way [m] by which a guide gives before it slides, as rolling guides do.
const PRE_SLIDING: f64 = 5.0e-6;

/// Deflection [m] at which a frame that stiffens is half way to its greatest stiffness.
const STIFFENING: f64 = 5.0e-6;

/// Damping ratio [-] of a bolted frame on its compliance.
const FRAME_DAMPING: f64 = 0.03;

/// A frame that gives less [m/N] is rigid: on stones, at 8 kHz, the forces of a stiffer one would run
/// away from step to step (2e-8 does, 5e-8 does not).
const RIGID: f64 = 5.0e-8;

/// Departures of carriage and motor from the motion commanded; the default has none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DriveFlaws {
    /// Wheel speed over the one commanded [-].
    pub wheel_scale: f64,
    /// Forward speed over the one commanded [-].
    pub carriage_scale: f64,
    /// Amplitude of the gear's ripple over the wheel speed [-].
    pub cogging: f64,
    /// Amplitude [rad/s] of a ripple of the same order that does not grow with speed, as a
    /// motor's cogging torque gives against a servo of finite stiffness.
    pub cogging_speed: f64,
    /// Ripple periods per wheel revolution [-], of both.
    pub cogging_order: f64,
    /// Root mean square [-] of the 2.3 Hz speed oscillation relative to the wheel speed, as of a speed loop near
    /// its stability limit.
    pub hunting: f64,
    /// The same for a saw-tooth: stick-slip of the drive.
    pub sawtooth: f64,
}

impl Default for DriveFlaws {
    fn default() -> Self {
        Self {
            wheel_scale: 1.0,
            carriage_scale: 1.0,
            cogging: 0.0,
            cogging_speed: 0.0,
            cogging_order: 200.0,
            hunting: 0.0,
            sawtooth: 0.0,
        }
    }
}

impl DriveFlaws {
    /// Whether the motion is the one commanded.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn check(&self) -> Result<(), RangeError> {
        RangeError::check("wheel speed scale", "-", self.wheel_scale, [0.5, 2.0])?;
        RangeError::check("carriage scale", "-", self.carriage_scale, [0.5, 2.0])?;
        RangeError::check("cogging", "-", self.cogging, [0.0, 1.0])?;
        RangeError::check("cogging speed", "rad/s", self.cogging_speed, [0.0, 10.0])?;
        RangeError::check("cogging order", "-", self.cogging_order, [1.0, 1.0e5])?;
        RangeError::check("hunting", "-", self.hunting, [0.0, 0.5])?;
        RangeError::check("sawtooth", "-", self.sawtooth, [0.0, 0.5])?;
        Ok(())
    }

    /// Speed [rad/s] behind gear and motor whose own speed is `speed` under this command, the wheel having turned by
    /// `angle` [rad].
    pub(in crate::simulation) fn wheel_speed(
        &self,
        speed: f64,
        commanded: &Commanded,
        angle: f64,
    ) -> f64 {
        if self.has_no_ripple() {
            return speed;
        }
        let tooth = cos(self.cogging_order * angle);
        speed * (1.0 + self.swing(commanded.time, tooth))
            + commanded.share * self.cogging_speed * tooth
    }

    fn has_no_ripple(&self) -> bool {
        [
            self.cogging,
            self.cogging_speed,
            self.hunting,
            self.sawtooth,
        ] == [0.0; 4]
    }

    /// Part [-] by which the wheel is faster than commanded.
    fn swing(&self, time: f64, tooth: f64) -> f64 {
        let cycles = HUNTING * time;
        // A saw-tooth from -1 to 1 has the root mean square 1/√3.
        let saw = 2.0 * (cycles - cycles.floor()) - 1.0;
        self.cogging * tooth
            + SQRT_2 * self.hunting * sin(TAU * cycles)
            + libm::sqrt(3.0) * self.sawtooth * saw
    }
}

/// Departures of what guides and loads the wheel; the default has none.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FrameFlaws {
    /// Compliance [m/N] between the wheel and what rides on it; less than 5e-8 is rigid.
    pub compliance: f64,
    /// How much stiffer the leg is at large deflections, as part of its stiffness [-]; half of it
    /// at 5 µm.
    pub stiffening: f64,
    /// Coulomb friction \[N\] of the vertical guide.
    pub friction: f64,
    /// Friction coefficient [-] of the guide relative to the drawbar pull, in addition to `friction`.
    pub friction_of_pull: f64,
    /// Part of the drawbar pull that the linkage adds to the load [-].
    pub load_transfer: f64,
}

impl FrameFlaws {
    /// Whether the frame is ideal.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn check(&self) -> Result<(), RangeError> {
        RangeError::check("frame compliance", "m/N", self.compliance, [0.0, 1.0e-3])?;
        RangeError::check("frame stiffening", "-", self.stiffening, [0.0, 100.0])?;
        RangeError::check("guide friction", "N", self.friction, [0.0, 1.0e4])?;
        let part = self.friction_of_pull;
        RangeError::check("guide friction over pull", "-", part, [0.0, 10.0])?;
        RangeError::check("load transfer", "-", self.load_transfer, [-1.0, 1.0])?;
        Ok(())
    }

    /// Stiffness [N/m] and damping [N·s/m] of the frame over a wheel of `mass` [kg]; `None` where
    /// it is rigid.
    pub(super) fn spring(&self, mass: f64) -> Option<[f64; 2]> {
        (self.compliance >= RIGID).then(|| {
            let stiffness = 1.0 / self.compliance;
            [
                stiffness,
                2.0 * FRAME_DAMPING * libm::sqrt(stiffness * mass),
            ]
        })
    }

    /// Factor [-] on the stiffness of a leg that is deflected by `stretch` [m].
    pub(super) fn stiffer(&self, stretch: f64) -> f64 {
        let part = stretch * stretch;
        1.0 + self.stiffening * part / (part + STIFFENING * STIFFENING)
    }
}

/// Friction of the vertical guide: elastic up to its Coulomb limit.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::simulation) struct GuideFriction {
    /// Elastic deflection over its largest [-].
    stretch: f64,
}

impl GuideFriction {
    /// Friction [N] on a wheel that rises at `speed` [m/s] for `dt` [s], upward, where the guide
    /// carries `pull` [N] across.
    pub fn push(&mut self, flaws: &FrameFlaws, speed: f64, pull: f64, dt: f64) -> f64 {
        self.stretch = (self.stretch + speed * dt / PRE_SLIDING).clamp(-1.0, 1.0);
        -(flaws.friction + flaws.friction_of_pull * pull.abs()) * self.stretch
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swings_have_the_root_mean_square_they_are_named_by() {
        let rms = |flaws: DriveFlaws| {
            let swings = (0..23_000).map(|k| flaws.swing(f64::from(k) / 2_300.0, 0.0));
            libm::sqrt(swings.map(|s| s * s).sum::<f64>() / 23_000.0)
        };
        let hunting = DriveFlaws {
            hunting: 0.02,
            ..DriveFlaws::default()
        };
        let sawtooth = DriveFlaws {
            sawtooth: 0.02,
            ..DriveFlaws::default()
        };
        // 1000 samples a period.
        assert!((rms(hunting) - 0.02).abs() < 1e-6);
        assert!((rms(sawtooth) - 0.02).abs() < 1e-6);
    }

    #[test]
    fn a_guide_resists_motion_either_way_with_its_coulomb_friction() {
        let flaws = FrameFlaws {
            friction: 2.0,
            friction_of_pull: 0.1,
            ..FrameFlaws::default()
        };
        let mut guide = GuideFriction::default();
        let mut slide =
            |speed: f64| (0..1000).fold(0.0, |_, _| guide.push(&flaws, speed, -30.0, 1e-4));
        assert_eq!(slide(1.0e-3), -5.0);
        assert_eq!(slide(-1.0e-3), 5.0);
    }
}
