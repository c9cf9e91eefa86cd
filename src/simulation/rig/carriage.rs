//! The carriage that moves the wheel along the track, on its belt or screw.
//!
//! ```text
//! F = k (x_c - x) + c (v_c - v),   c = 2 ζ √(k m),   |F| ≤ F_max
//! ```
//!
//! `x_c` is the integral of the commanded speed `v_c`, `m` the mass that moves along the track: carriage, slide
//! and wheel. A drive at its limit falls behind its command: `x_c` stays within `F_max / k` of the carriage, so that
//! a carriage that comes free goes on from where it is and does not jump after what it missed.
//!
//! Between carriage and wheel stands the vertical guide, rigid along the track; the force transducer sits below it,
//! at the wheel's hub, and does not read the carriage's inertia.

use super::resolved;
use crate::quantity::{RangeError, SampleRate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A carriage and its drive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Carriage {
    /// Mass \[kg\] that moves along the track and not vertically.
    pub mass: f64,
    /// Stiffness [N/m] of belt or screw; `inf` is rigid.
    pub stiffness: f64,
    /// Damping ratio [-] of all that moves along the track on it.
    pub damping_ratio: f64,
    /// Largest force \[N\] of the drive, either way.
    pub force_limit: f64,
}

impl Carriage {
    /// Whether the carriage follows its command exactly, whatever the force.
    pub fn is_rigid(&self) -> bool {
        self.stiffness == f64::INFINITY
    }

    pub(super) fn check(&self) -> Result<(), RangeError> {
        RangeError::check("carriage mass", "kg", self.mass, [0.1, 1.0e4])?;
        RangeError::check(
            "carriage stiffness",
            "N/m",
            self.stiffness,
            [1.0e3, f64::INFINITY],
        )?;
        RangeError::check(
            "carriage damping ratio",
            "-",
            self.damping_ratio,
            [0.0, 1.0],
        )?;
        RangeError::check(
            "carriage force limit",
            "N",
            self.force_limit,
            [1.0, f64::INFINITY],
        )?;
        Ok(())
    }
}

/// A carriage at work.
#[derive(Debug, Clone, Copy)]
pub(in crate::simulation) struct CarriageDrive {
    carriage: Carriage,
    /// Damping [N·s/m].
    damping: f64,
    /// How far the drive is ahead of the carriage [m].
    stretch: f64,
    /// Force on the carriage in the last step [N].
    force: f64,
}

impl CarriageDrive {
    /// A drive that moves `mass` [kg] besides the carriage's own, at steps of this rate.
    ///
    /// # Errors
    /// `RangeError` for a stiffness that such steps cannot resolve.
    pub fn new(carriage: Carriage, mass: f64, rate: SampleRate) -> Result<Self, RangeError> {
        let mass = mass + carriage.mass;
        resolved("carriage stiffness", "N/m", carriage.stiffness, mass, rate)?;
        Ok(Self {
            carriage,
            damping: 2.0 * carriage.damping_ratio * libm::sqrt(carriage.stiffness * mass),
            stretch: 0.0,
            force: 0.0,
        })
    }

    /// Force [N] on a carriage that moves at `speed` where `commanded` [m/s] is, over a step of `dt` [s].
    pub fn push(&mut self, commanded: f64, speed: f64, dt: f64) -> f64 {
        let Carriage {
            stiffness,
            force_limit,
            ..
        } = self.carriage;
        let farthest = force_limit / stiffness;
        self.stretch = (self.stretch + (commanded - speed) * dt).clamp(-farthest, farthest);
        let force = stiffness * self.stretch + self.damping * (commanded - speed);
        self.force = force.clamp(-force_limit, force_limit);
        self.force
    }

    /// The carriage's own mass [kg].
    pub fn mass(&self) -> f64 {
        self.carriage.mass
    }

    /// Whether the drive gives all the force it has.
    pub fn at_limit(&self) -> bool {
        self.force.abs() >= self.carriage.force_limit
    }

    /// Energy [J] in belt or screw.
    #[cfg(test)]
    pub fn stored(&self) -> f64 {
        0.5 * self.carriage.stiffness * self.stretch * self.stretch
    }

    /// Power [W] that the drive puts in, and that its damping takes out, where the carriage moves at `speed` and
    /// `commanded` [m/s] is.
    #[cfg(test)]
    pub fn power(&self, commanded: f64, speed: f64) -> [f64; 2] {
        let lag = commanded - speed;
        [self.force * commanded, self.damping * lag * lag]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BELT: Carriage = Carriage {
        mass: 30.0,
        stiffness: 5.0e5,
        damping_ratio: 0.05,
        force_limit: 1000.0,
    };

    fn drive() -> CarriageDrive {
        CarriageDrive::new(BELT, 12.0, SampleRate::new(16.0e3).unwrap()).unwrap()
    }

    #[test]
    fn a_carriage_struck_rings_at_its_natural_frequency_and_damping_ratio() {
        let (mass, dt) = (42.0, 1.0 / 16.0e3);
        let mut drive = drive();
        // The command jumps by 0.1 mm in the first step.
        let commanded = |step: i32| if step == 0 { 1.0e-4 / dt } else { 0.0 };
        let (mut x, mut v) = (0.0, 0.0);
        let mut peaks: Vec<[f64; 2]> = Vec::new();
        for step in 0..16_000 {
            let before = v;
            v += drive.push(commanded(step), v, dt) / mass * dt;
            x += v * dt;
            if before > 0.0 && v <= 0.0 {
                peaks.push([f64::from(step) * dt, x - 1.0e-4]);
            }
        }
        let [first, tenth] = [peaks[0], peaks[9]];
        let natural = libm::sqrt(5.0e5 / 42.0);
        let period = (tenth[0] - first[0]) / 9.0;
        let expected = std::f64::consts::TAU / (natural * libm::sqrt(1.0 - 0.0025));
        assert!(
            (period / expected - 1.0).abs() < 0.005,
            "{period} {expected}"
        );
        // Logarithmic decrement 2π ζ/√(1 - ζ²).
        let decrement = libm::log(first[1] / tenth[1]) / 9.0;
        assert!(
            (decrement / (0.05 * std::f64::consts::TAU) - 1.0).abs() < 0.03,
            "{decrement}"
        );
    }

    #[test]
    fn a_blocked_carriage_is_pushed_with_the_limit_and_comes_free_without_a_jump() {
        let dt = 1.0 / 16.0e3;
        let mut drive = drive();
        // Blocked for 2 s at a command of 10 mm/s: 20 mm, ten times what the belt gives.
        let pushes = (0..32_000).map(|_| drive.push(0.01, 0.0, dt));
        let greatest = pushes.fold(0.0, f64::max);
        assert_eq!(greatest, 1000.0);
        assert!(drive.at_limit());
        // Free, it goes 2 mm ahead and some overshoot, not 20.
        let (mut x, mut v) = (0.0, 0.0);
        let mut farthest: f64 = 0.0;
        for _ in 0..8_000 {
            v += drive.push(0.0, v, dt) / 42.0 * dt;
            x += v * dt;
            farthest = farthest.max(x);
        }
        assert!((x - 0.002).abs() < 2.0e-4, "{x}");
        assert!(farthest < 0.004, "{farthest}");
    }

    #[test]
    fn a_stiffness_that_the_steps_cannot_resolve_is_refused_with_the_way_out() {
        let stiff = Carriage {
            stiffness: 1.0e11,
            ..BELT
        };
        let refused = CarriageDrive::new(stiff, 12.0, SampleRate::new(16.0e3).unwrap());
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("carriage stiffness"), "{message}");
        assert!(message.contains("or inf"), "{message}");
    }
}
