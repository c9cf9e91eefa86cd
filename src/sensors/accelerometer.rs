//! Accelerometer on the axle.

use super::drive_vibration::DriveVibration;
use super::loose_mount::LooseMount;
use super::second_order::SecondOrder;
use super::transducer::{Transducer, corner, finite};
use crate::quantity::GRAVITY;
use crate::quantity::RangeError;
use crate::simulation::WheelState;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Accelerometer on the axle, its axis up; reads m/s² with gravity removed.
///
/// The default is ideal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Accelerometer {
    /// Angle [°] by which the axis leans from the vertical toward the direction of travel. The
    /// gravity removed is that of an upright sensor.
    pub tilt_deg: f64,
    /// Share [-] of forward acceleration that shows in the reading.
    pub cross_axis: f64,
    /// Resonance \[Hz\] of the sensor on its mount; `inf` is rigid.
    pub mounting_frequency: f64,
    /// Damping ratio [-] of the mount.
    pub mounting_damping: f64,
    /// How it is held on its mount.
    pub loose_mount: LooseMount,
    /// Vibration of motor and gear that reaches it.
    pub drive_vibration: DriveVibration,
    /// The analogue channel, in m/s².
    pub acceleration_y: Transducer,
}

impl Default for Accelerometer {
    fn default() -> Self {
        Self {
            tilt_deg: 0.0,
            cross_axis: 0.0,
            mounting_frequency: f64::INFINITY,
            mounting_damping: 0.05,
            loose_mount: LooseMount::default(),
            drive_vibration: DriveVibration::default(),
            acceleration_y: Transducer::default(),
        }
    }
}

impl Accelerometer {
    /// A calibrated piezoelectric (IEPE) accelerometer of 50 g on a stud, into a 24-bit converter.
    ///
    /// Figures typical of the kind, not of one product:
    /// - noise 5 µg/√Hz (4.9e-5 m/s²/√Hz): between quiet piezoelectric sensors, a few µg/√Hz, and
    ///   MEMS ones for vibration, 25 µg/√Hz;
    /// - bandwidth 10 kHz; stud mount at 30 kHz, damping ratio 0.05;
    /// - range ±50 g (490 m/s²), in 2²⁴ steps of 5.8e-5 m/s²;
    /// - transverse sensitivity 2 %, of at most 5 % in data sheets;
    /// - gain 1 and bias 0, as calibrated and tared; drift none, upright.
    pub fn realistic() -> Self {
        Self {
            cross_axis: 0.02,
            mounting_frequency: 30_000.0,
            acceleration_y: Transducer {
                bandwidth: 10_000.0,
                noise_density: 4.9e-5,
                range: 490.0,
                resolution: 5.8e-5,
                ..Transducer::default()
            },
            ..Self::default()
        }
    }

    pub(super) fn check(&self, rate: f64) -> Result<(), RangeError> {
        RangeError::check("tilt", "°", self.tilt_deg, [-180.0, 180.0])?;
        finite("cross-axis sensitivity", "-", self.cross_axis)?;
        corner("mounting frequency", self.mounting_frequency, rate)?;
        RangeError::positive("mounting damping ratio", "-", self.mounting_damping)?;
        self.loose_mount.check()?;
        self.drive_vibration.check()?;
        self.acceleration_y.check("m/s^2", rate)
    }

    /// Resonance of the mount at the sensor `rate` [Hz].
    pub(super) fn mount(&self, rate: f64) -> Option<SecondOrder> {
        SecondOrder::new(self.mounting_frequency, self.mounting_damping, rate)
    }

    /// How this sensor weighs what acts on it.
    pub(super) fn axis(&self) -> Axis {
        let (sine, cosine) = libm::sincos(self.tilt_deg.to_radians());
        Axis {
            upward: cosine,
            forward: sine + self.cross_axis,
            offset: GRAVITY * (cosine - 1.0),
        }
    }
}

/// Sensitive axis: weights of the accelerations and the residual of gravity under a tilt [m/s²].
#[derive(Clone, Copy)]
pub(super) struct Axis {
    upward: f64,
    forward: f64,
    offset: f64,
}

impl Axis {
    /// Weights of the upward and the forward acceleration [-], and what is added [m/s²].
    pub(super) fn weights(&self) -> [f64; 3] {
        [self.upward, self.forward, self.offset]
    }

    /// Acceleration [m/s²] along the axis.
    pub(super) fn along(&self, state: &WheelState) -> f64 {
        self.upward * state.vertical_acceleration
            + self.forward * state.forward_acceleration
            + self.offset
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_axis_mixes_accelerations_and_misses_part_of_gravity() {
        let state = WheelState {
            vertical_acceleration: 2.0,
            forward_acceleration: 1.0,
            ..WheelState::default()
        };
        let tilted = Accelerometer {
            tilt_deg: 30.0,
            ..Accelerometer::default()
        };
        let expected = 2.0 * 0.75_f64.sqrt() + 0.5 + 9.806_65 * (0.75_f64.sqrt() - 1.0);
        assert!((tilted.axis().along(&state) - expected).abs() < 1e-12);
        let crossed = Accelerometer {
            cross_axis: 0.02,
            ..Accelerometer::default()
        };
        assert_eq!(crossed.axis().along(&state), 2.02);
    }
}
