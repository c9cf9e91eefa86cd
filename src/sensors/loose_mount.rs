//! An accelerometer that is pressed onto its mount and not bolted to it.
//!
//! A preload presses the sensor with an acceleration `p` of its own mass: gravity, a magnet or a clip. The mount's
//! acceleration `a` can pull it down no faster than that:
//!
//! ```text
//! in contact   reads a                      while a > -p
//! in flight    reads -p,  ü = -p - a        from a < -p until the gap u closes
//! at landing   reads a half sine of area (1 + e) |u̇| over the contact time;  u̇ -> -e u̇
//! ```
//!
//! with the restitution `e`. Every landing is a shock, broadband where the axle's vibration is not: the sensor
//! clatters. The mean reading stays what it was, for sensor and mount move together in the long run. Half-wave clipping
//! at `-p` without shocks is what a saturated amplifier gives instead.

use super::transducer::not_negative;
use crate::quantity::RangeError;
use libm::sin;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// How an accelerometer is held; the default is bolted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LooseMount {
    /// Preload over the sensor's mass [m/s²]; `inf` is bolted.
    pub preload: f64,
    /// Coefficient of restitution [-] of a landing.
    pub restitution: f64,
    /// Time \[s\] that a landing takes.
    pub contact_time: f64,
}

impl Default for LooseMount {
    fn default() -> Self {
        Self {
            preload: f64::INFINITY,
            // Steel on steel or aluminium at some mm/s; 10 g on a contact of 1e7 N/m.
            restitution: 0.5,
            contact_time: 1.0e-4,
        }
    }
}

impl LooseMount {
    /// Whether a mount that accelerates by at most `largest` [m/s²] keeps its sensor.
    pub(super) fn holds(&self, largest: f64) -> bool {
        largest <= self.preload
    }

    pub(super) fn check(&self) -> Result<(), RangeError> {
        if self.preload != f64::INFINITY {
            RangeError::positive("preload of the mount", "m/s^2", self.preload)?;
        }
        RangeError::check("restitution", "-", self.restitution, [0.0, 0.95])?;
        not_negative("contact time", "s", self.contact_time)
    }
}

/// A half sine that is being read.
#[derive(Clone, Copy)]
struct Shock {
    /// Peak [m/s²].
    peak: f64,
    /// Samples read of it.
    read: u32,
}

/// A loosely held accelerometer at work at the sensor rate.
pub(super) struct Clatter {
    figures: LooseMount,
    period: f64,
    /// Samples of a landing, and the sum of its half sine over them [-].
    landing: u32,
    area: f64,
    /// Gap [m] between sensor and mount, and its rate [m/s]; none while in contact.
    gap: f64,
    rate: f64,
    is_flying: bool,
    shocks: Vec<Shock>,
}

impl Clatter {
    /// Sampled at `rate` \[Hz\]; none for a bolted sensor.
    pub(super) fn new(figures: LooseMount, rate: f64) -> Option<Self> {
        if figures.preload == f64::INFINITY {
            return None;
        }
        let landing = ((figures.contact_time * rate).round() as u32).max(1);
        Some(Self {
            figures,
            period: 1.0 / rate,
            landing,
            area: (0..landing).map(|k| half_sine(k, f64::from(landing))).sum(),
            gap: 0.0,
            rate: 0.0,
            is_flying: false,
            shocks: Vec::new(),
        })
    }

    /// Turns accelerations of the mount into those of the sensor, in place.
    pub(super) fn apply(&mut self, samples: &mut [f64]) {
        for sample in samples {
            *sample = self.next(*sample) + self.shocks();
        }
    }

    /// Acceleration of the sensor, shocks apart.
    fn next(&mut self, mount: f64) -> f64 {
        let preload = self.figures.preload;
        if !self.is_flying && mount >= -preload {
            return mount;
        }
        self.is_flying = true;
        self.rate -= (preload + mount) * self.period;
        self.gap += self.rate * self.period;
        if self.gap <= 0.0 && self.rate <= 0.0 {
            self.land(mount);
        }
        -preload
    }

    /// Rebounds, or stays where the preload stops the rebound within a sample.
    fn land(&mut self, mount: f64) {
        let approach = -self.rate;
        let rebound = self.figures.restitution * approach;
        let stays = rebound <= (self.figures.preload + mount) * self.period;
        self.is_flying = !stays;
        self.rate = if stays { 0.0 } else { rebound };
        self.gap = 0.0;
        self.shock(approach + self.rate);
    }

    /// Begins a shock that changes the velocity by so much [m/s].
    fn shock(&mut self, velocity: f64) {
        self.shocks.push(Shock {
            peak: velocity / (self.area * self.period),
            read: 0,
        });
    }

    /// Sum of the shocks at this sample [m/s²].
    fn shocks(&mut self) -> f64 {
        let count = f64::from(self.landing);
        let mut sum = 0.0;
        for shock in &mut self.shocks {
            sum += shock.peak * half_sine(shock.read, count);
            shock.read += 1;
        }
        self.shocks.retain(|shock| shock.read < self.landing);
        sum
    }
}

/// A half sine of `count` samples at sample `k` [-].
fn half_sine(k: u32, count: f64) -> f64 {
    sin(PI * (f64::from(k) + 0.5) / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use libm::cos;
    use std::f64::consts::TAU;

    const RATE: f64 = 128_000.0;

    fn read(figures: LooseMount, mount: &[f64]) -> Vec<f64> {
        let mut samples = mount.to_vec();
        if let Some(mut clatter) = Clatter::new(figures, RATE) {
            samples
                .chunks_mut(100)
                .for_each(|block| clatter.apply(block));
        }
        samples
    }

    fn loose(preload: f64, restitution: f64) -> LooseMount {
        LooseMount {
            preload,
            restitution,
            ..LooseMount::default()
        }
    }

    /// A vibration of this amplitude [m/s²] at 100 Hz for so many periods.
    fn vibration(amplitude: f64, periods: u32) -> Vec<f64> {
        let count = periods * 1280;
        let phase = |k: u32| TAU * f64::from(k) / 1280.0;
        (0..count).map(|k| amplitude * cos(phase(k))).collect()
    }

    #[test]
    fn a_bolted_sensor_and_one_that_is_never_pulled_off_read_the_mount() {
        let mount = vibration(5.0, 3);
        assert_eq!(read(LooseMount::default(), &mount), mount);
        assert_eq!(read(loose(5.1, 0.5), &mount), mount);
    }

    #[test]
    fn a_sensor_without_rebound_lands_after_the_flight_of_a_thrown_body() {
        // The mount stands still, drops by 20 m/s² for 5 ms and stands still again.
        let mut mount = vec![0.0; 128];
        mount.extend([-20.0; 640]);
        mount.extend([0.0; 6400]);
        let read = read(loose(9.806_65, 0.0), &mount);
        // Gap at 5 ms: (20 - g) t²/2, opening at (20 - g) t; then it closes under -g.
        let (t, g) = (5.0e-3, 9.806_65);
        let opening = (20.0 - g) * t;
        let fall = libm::sqrt(opening * opening + 2.0 * g * 0.5 * opening * t);
        let landing = t + (opening + fall) / g;
        let first = read.iter().rposition(|a| *a < -9.0).unwrap();
        let found = (first as f64 - 128.0) / RATE;
        assert!((found - landing).abs() < 1.0e-4, "{found} is not {landing}");
        // The shock stops the closing speed.
        let shock: f64 = read[first + 1..].iter().sum::<f64>() / RATE;
        assert!((shock / fall - 1.0).abs() < 0.02, "{shock} is not {fall}");
    }

    #[test]
    fn the_velocity_of_sensor_and_mount_stays_the_same_in_the_long_run() {
        let mount = vibration(20.0, 400);
        for restitution in [0.0, 0.5] {
            let read = read(loose(9.8, restitution), &mount);
            let drift = read.iter().sum::<f64>() / read.len() as f64;
            // Of a flight that is not over at the end: at most some 0.1 m/s in 4 s.
            assert!(drift.abs() < 0.03, "{drift}");
            let high = read.iter().fold(0.0_f64, |most, a| most.max(*a));
            assert!(high > 100.0, "no shock: {high}");
        }
    }
}
