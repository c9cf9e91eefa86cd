//! Vibration of motor and gear that reaches the accelerometer through the axle.
//!
//! ```text
//! a(t) = (ω/ω_0)² (√2 a_m cos n φ + a_b ξ(t)),   ω_0 = 0.1 rad/s
//! ```
//!
//! with the wheel's angle `φ` and speed `ω`: a line of the gear's mesh, `n` times a turn of the wheel, and a broadband
//! part `ξ` of unit root mean square, white noise behind a low pass of first order at 100 Hz. Forces of unbalance and of
//! tooth errors grow with the square of the speed. On a rig such vibration is there on every ground, on the reference
//! too; with it the paper's region of sand (61) can be met, and by a wheel alone it cannot: in a window of LEIS (48) and
//! (52)-(54) make `κ_A` and `κ_mv` the same number, which (61) requires to lie on either side of 0.5.
//!
//! # Size
//! Of a rig it is measured: `lugwheel inspect` sizes it from lifted runs (load 0 N), in which half of the broadband part's
//! variance lies below its corner. Before that, from ISO 10816-1,
//! class I (small machines): 0.71, 1.8 and 4.5 mm/s rms bound its zones at a motor's rated speed. A gear of 100:1 at 3000
//! rpm, its vibration near 100 Hz and the square law put them at 0.5, 1.1 and 2.9 mm/s² at 0.1 rad/s.

use super::noise::LowPassedNoise;
use super::transducer::not_negative;
use crate::quantity::RangeError;
use crate::simulation::WheelState;
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::SQRT_2;

/// Wheel speed [rad/s] at which its size is stated.
pub(crate) const STATED_AT: f64 = 0.1;

/// Corner [Hz] of the broadband part.
pub(crate) const CORNER: f64 = 100.0;

/// Vibration of motor and gear on the axle; the default has none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DriveVibration {
    /// Root mean square [m/s²] of the gear-mesh line at 0.1 rad/s of the wheel.
    pub mesh: f64,
    /// Its periods a turn of the wheel [-].
    pub mesh_order: f64,
    /// Root mean square [m/s²] of the broadband part at 0.1 rad/s of the wheel.
    pub broadband: f64,
}

impl Default for DriveVibration {
    fn default() -> Self {
        Self {
            mesh: 0.0,
            mesh_order: 500.0,
            broadband: 0.0,
        }
    }
}

impl DriveVibration {
    pub(super) fn check(&self) -> Result<(), RangeError> {
        not_negative("gear-mesh vibration", "m/s^2", self.mesh)?;
        RangeError::check("gear-mesh order", "-", self.mesh_order, [1.0, 1.0e5])?;
        not_negative("broadband vibration", "m/s^2", self.broadband)
    }
}

impl DriveVibration {
    /// A magnitude [m/s²] that it does not exceed in these states, six standard deviations of noise counted.
    pub(super) fn bound(&self, states: &[WheelState]) -> f64 {
        let speeds = states.iter().map(|state| state.wheel_speed.abs());
        let speed = speeds.fold(0.0, f64::max) / STATED_AT;
        speed * speed * (SQRT_2 * self.mesh + 6.0 * self.broadband)
    }
}

/// A drive that vibrates.
pub(super) struct Vibrating {
    figures: DriveVibration,
    broadband: Option<LowPassedNoise>,
}

impl Vibrating {
    /// Stepped at `rate` [Hz]; none where nothing vibrates, so that nothing is drawn.
    pub(super) fn new(figures: DriveVibration, rate: f64, rng: ChaCha8Rng) -> Option<Self> {
        if figures.mesh == 0.0 && figures.broadband == 0.0 {
            return None;
        }
        Some(Self {
            figures,
            broadband: LowPassedNoise::new(figures.broadband, CORNER, rate, rng),
        })
    }

    /// Acceleration [m/s²] of the axle, upward, at the next state.
    pub(super) fn acceleration(&mut self, state: &WheelState) -> f64 {
        let DriveVibration {
            mesh, mesh_order, ..
        } = self.figures;
        let speed = state.wheel_speed / STATED_AT;
        let line = SQRT_2 * mesh * libm::cos(mesh_order * state.wheel_angle);
        let broadband = self.broadband.as_mut().map_or(0.0, LowPassedNoise::draw);
        speed * speed * (line + broadband)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;

    /// Accelerations of a wheel that turns at this speed [rad/s] for so many seconds, at 16 kHz.
    fn shaken(figures: DriveVibration, wheel_speed: f64, seconds: f64) -> Vec<f64> {
        let rate = 16_000.0;
        let mut drive = Vibrating::new(figures, rate, Seed(3).rng("test", 0)).unwrap();
        let states = (0..(seconds * rate) as u32).map(|step| WheelState {
            wheel_speed,
            wheel_angle: wheel_speed * f64::from(step) / rate,
            ..WheelState::default()
        });
        states.map(|state| drive.acceleration(&state)).collect()
    }

    fn rms(samples: &[f64]) -> f64 {
        libm::sqrt(samples.iter().map(|x| x * x).sum::<f64>() / samples.len() as f64)
    }

    #[test]
    fn both_parts_have_their_size_at_a_tenth_of_a_radian_a_second_and_grow_with_its_square() {
        let broadband = DriveVibration {
            broadband: 2.0e-3,
            ..DriveVibration::default()
        };
        let mesh = DriveVibration {
            mesh: 2.0e-3,
            ..DriveVibration::default()
        };
        for (figures, tolerance) in [(mesh, 0.01), (broadband, 0.03)] {
            let slow = rms(&shaken(figures, 0.1, 20.0));
            assert!((slow / 2.0e-3 - 1.0).abs() < tolerance, "{slow}");
            let fast = rms(&shaken(figures, 0.3, 20.0));
            assert!((fast / slow / 9.0 - 1.0).abs() < tolerance, "{fast}");
        }
    }

    #[test]
    fn the_mesh_line_stands_at_its_order_of_the_wheel() {
        let figures = DriveVibration {
            mesh: 1.0,
            ..DriveVibration::default()
        };
        let samples = shaken(figures, 0.1, 10.0);
        let upward = samples
            .windows(2)
            .filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0);
        // 500 periods a turn at 0.1 rad/s: 7.96 Hz.
        assert!((upward.count() as f64 - 79.6).abs() <= 1.0);
    }

    #[test]
    fn a_drive_that_does_not_vibrate_draws_no_number() {
        assert!(
            Vibrating::new(DriveVibration::default(), 16.0e3, Seed(3).rng("test", 0)).is_none()
        );
    }
}
