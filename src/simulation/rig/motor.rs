//! The motor that turns the wheel: rotor, speed loop, torque limit, and the gear's spring.
//!
//! All at the gear's output, where rotor inertia counts with the square of the gear ratio:
//!
//! ```text
//! J dω_m/dt = T - T_g,              |T| ≤ T_max
//! T   = K_p (ω_c - ω_m) + K_i ∫(ω_c - ω_m) dt
//! T_g = k (θ_m - θ) + c (ω_m - ω),  c = 2 ζ √(k I)
//! ```
//!
//! with the wheel's angle `θ`, speed `ω` and inertia `I`. `K_p = 2π f (J + I)` puts the crossover of the loop at the
//! bandwidth `f`; `K_i = 2π f K_p / 4` leaves 76 degrees of phase there (the symmetrical optimum's ratio). The
//! integral stands still while the torque is at its limit and the error would drive it further (conditional
//! integration), so that a wheel that comes free does not race. Ripple of gear and motor stands between rotor and
//! spring: the loop, which sees the rotor, does not take it out.
//!
//! On stone the friction of a lug couples the wheel's torsion on `k` with its vertical motion on the contact. Where both
//! have near the same frequency, friction drives them to flutter: on slate at slip 0.1 a wheel of 0.05 kg·m² whose contact
//! rings at 150 Hz shakes five times louder at 125 Hz with k = 1.6e4 N·m/rad (the gear alone, 107 Hz with the rotor)
//! than with 5e3 (the gear, a torque transducer and couplings), 2.5e3 or a rigid drive.
//!
//! The encoder sits on the wheel's axle, behind the spring; the torque transducer in the hub reads `T_g` less what
//! spins the wheel up.

use super::resolved;
use crate::quantity::{RangeError, SampleRate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A geared motor with its speed loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Inertia [kg·m²] of rotor and gear at the output.
    pub rotor_inertia: f64,
    /// Torsional stiffness [N·m/rad] between rotor and wheel: gear, torque transducer and couplings in series; `inf`
    /// is rigid, and its speed loop ideal.
    pub stiffness: f64,
    /// Damping ratio [-] of the wheel on it.
    pub damping_ratio: f64,
    /// Largest torque [N·m] at the output, either way.
    pub torque_limit: f64,
    /// Bandwidth \[Hz\] of the speed loop.
    pub bandwidth: f64,
}

impl Motor {
    /// Whether the wheel follows its command exactly, whatever the torque.
    pub fn is_rigid(&self) -> bool {
        self.stiffness == f64::INFINITY
    }

    pub(super) fn check(&self) -> Result<(), RangeError> {
        RangeError::check(
            "rotor inertia",
            "kg·m²",
            self.rotor_inertia,
            [1.0e-4, 1.0e3],
        )?;
        RangeError::check(
            "motor stiffness",
            "N·m/rad",
            self.stiffness,
            [10.0, f64::INFINITY],
        )?;
        RangeError::check("motor damping ratio", "-", self.damping_ratio, [0.0, 1.0])?;
        RangeError::check(
            "torque limit",
            "N·m",
            self.torque_limit,
            [0.1, f64::INFINITY],
        )?;
        RangeError::check("speed loop bandwidth", "Hz", self.bandwidth, [0.1, 500.0])?;
        Ok(())
    }
}

/// A motor at work.
#[derive(Debug, Clone, Copy)]
pub(in crate::simulation) struct MotorDrive {
    motor: Motor,
    /// Damping of the gear [N·m·s/rad].
    damping: f64,
    /// Gains of the loop [N·m·s/rad] and [N·m/rad].
    proportional: f64,
    integral: f64,
    /// Torque of the integral [N·m].
    held: f64,
    /// Torque of the motor, and through the gear to the wheel, in the last step [N·m].
    torque: f64,
    transmitted: f64,
    /// Speed of the rotor at the output [rad/s].
    speed: f64,
    /// How far the gear's input is ahead of the wheel [rad].
    wind_up: f64,
}

impl MotorDrive {
    /// A motor on a wheel of this inertia [kg·m²], at steps of this rate.
    ///
    /// # Errors
    /// `RangeError` for a gear stiffness that such steps cannot resolve.
    pub fn new(motor: Motor, inertia: f64, rate: SampleRate) -> Result<Self, RangeError> {
        let reduced = 1.0 / (1.0 / inertia + 1.0 / motor.rotor_inertia);
        resolved("motor stiffness", "N·m/rad", motor.stiffness, reduced, rate)?;
        let crossover = TAU * motor.bandwidth;
        let proportional = crossover * (motor.rotor_inertia + inertia);
        Ok(Self {
            motor,
            damping: 2.0 * motor.damping_ratio * libm::sqrt(motor.stiffness * inertia),
            proportional,
            integral: 0.25 * crossover * proportional,
            held: 0.0,
            torque: 0.0,
            transmitted: 0.0,
            speed: 0.0,
            wind_up: 0.0,
        })
    }

    /// Speed of the rotor at the output [rad/s].
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// One step of `dt` [s] of rotor and speed loop towards a `commanded` speed [rad/s].
    pub fn follow(&mut self, commanded: f64, dt: f64) {
        let Motor {
            torque_limit,
            rotor_inertia,
            ..
        } = self.motor;
        let error = commanded - self.speed;
        let wanted = self.proportional * error + self.held;
        self.torque = wanted.clamp(-torque_limit, torque_limit);
        if self.torque == wanted || wanted * error < 0.0 {
            self.held += self.integral * error * dt;
        }
        self.speed += (self.torque - self.transmitted) / rotor_inertia * dt;
    }

    /// Torque [N·m] of the gear, whose input turns at `input`, on a wheel that turns at `speed` [rad/s].
    pub fn turn(&mut self, input: f64, speed: f64, dt: f64) -> f64 {
        self.wind_up += (input - speed) * dt;
        self.transmitted = self.motor.stiffness * self.wind_up + self.damping * (input - speed);
        self.transmitted
    }

    /// Whether the motor gives all the torque it has.
    pub fn at_limit(&self) -> bool {
        self.torque.abs() >= self.motor.torque_limit
    }

    /// Energy [J] in the gear's spring and in the rotor.
    #[cfg(test)]
    pub fn stored(&self) -> f64 {
        0.5 * self.motor.stiffness * self.wind_up * self.wind_up
            + 0.5 * self.motor.rotor_inertia * self.speed * self.speed
    }

    /// Power [W] that the motor puts in, and that the gear's damping takes out, where the wheel turns at `speed`
    /// [rad/s].
    #[cfg(test)]
    pub fn power(&self, speed: f64) -> [f64; 2] {
        let lag = self.speed - speed;
        [self.torque * self.speed, self.damping * lag * lag]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GEARED: Motor = Motor {
        rotor_inertia: 0.12,
        stiffness: 1.6e4,
        damping_ratio: 0.05,
        torque_limit: 54.0,
        bandwidth: 30.0,
    };
    const INERTIA: f64 = 0.06;
    const DT: f64 = 1.0 / 16.0e3;

    /// Speed of the wheel [rad/s] at every step, under this load [N·m] over time [s].
    fn turned(commanded: f64, seconds: f64, load: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut motor = MotorDrive::new(GEARED, INERTIA, SampleRate::new(16.0e3).unwrap()).unwrap();
        let mut speed = 0.0;
        let steps = (seconds / DT) as usize;
        (0..steps)
            .map(|step| {
                motor.follow(commanded, DT);
                let torque = motor.turn(motor.speed(), speed, DT);
                speed += (torque - load(step as f64 * DT)) / INERTIA * DT;
                speed
            })
            .collect()
    }

    #[test]
    fn a_load_that_stays_costs_no_speed() {
        let speeds = turned(0.2, 3.0, |_| 10.0);
        assert!((speeds[speeds.len() - 1] / 0.2 - 1.0).abs() < 1.0e-4);
    }

    #[test]
    fn a_load_that_swings_turns_the_wheel_by_what_the_loop_and_the_gear_yield() {
        // Mobility C = jω/(K_i + jω K_p - ω² J) + jω/k of rotor and gear, and C/(1 + jω I C) with the wheel on them.
        use nalgebra::Complex;
        let s = Complex::new(0.0, TAU * 5.0);
        let proportional = TAU * 30.0 * (0.12 + INERTIA);
        let integral = 0.25 * TAU * 30.0 * proportional;
        let driven = s / (s * s * 0.12 + s * proportional + integral) + s / 1.6e4;
        let expected = (driven / (s * INERTIA * driven + 1.0)).norm();
        let omega = s.im;
        let speeds = turned(0.2, 4.0, |t| libm::sin(omega * t));
        let late = &speeds[speeds.len() / 2..];
        let swing = late.iter().map(|v| (v - 0.2).abs()).fold(0.0, f64::max);
        assert!((swing / expected - 1.0).abs() < 0.01, "{swing} {expected}");
    }

    #[test]
    fn a_motor_at_its_limit_stalls_and_does_not_race_when_it_comes_free() {
        // Held for 2 s by a brake that turns with nothing, then free.
        let mut motor = MotorDrive::new(GEARED, INERTIA, SampleRate::new(16.0e3).unwrap()).unwrap();
        let mut greatest: f64 = 0.0;
        for _ in 0..32_000 {
            motor.follow(0.2, DT);
            greatest = greatest.max(motor.turn(motor.speed(), 0.0, DT));
        }
        assert!(motor.at_limit());
        assert!(greatest < 1.05 * 54.0, "{greatest}");
        let mut speed = 0.0;
        let mut fastest: f64 = 0.0;
        for step in 0..16_000 {
            motor.follow(0.2, DT);
            speed += motor.turn(motor.speed(), speed, DT) / INERTIA * DT;
            // The gear springs back at once; the loop has then a tenth of a second.
            if step > 1600 {
                fastest = fastest.max(speed);
            }
        }
        assert!(fastest < 2.0 * 0.2, "{fastest}");
        assert!((speed / 0.2 - 1.0).abs() < 0.01, "{speed}");
    }
}
