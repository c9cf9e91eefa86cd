//! Encoder on the wheel's axle, and the carriage's speed.

use super::noise::WhiteNoise;
use super::sampling::Instants;
use super::transducer::{Transducer, finite, not_negative, quantised};
use crate::quantity::RangeError;
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Motion sensors: the wheel's encoder and the carriage's speed signal.
///
/// The default is ideal.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Encoder {
    /// Counter of the wheel angle, in rad, latched at the output rate.
    pub wheel_angle: Counter,
    /// Analogue channel of the forward speed, in m/s.
    pub forward_speed: Transducer,
}

/// A counter of angle that is latched, not filtered.
///
/// The default is ideal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Counter {
    /// Angle read over angle turned [-]; a wrong number of lines or gear ratio.
    pub gain: f64,
    /// Reading at the start \[rad\].
    pub bias: f64,
    /// Standard deviation \[rad\] of a reading.
    pub noise: f64,
    /// Step \[rad\] between readings; 0 is continuous.
    pub resolution: f64,
    /// Time \[s\] by which readings lag their time stamps.
    pub delay: f64,
}

impl Default for Counter {
    fn default() -> Self {
        Self {
            gain: 1.0,
            bias: 0.0,
            noise: 0.0,
            resolution: 0.0,
            delay: 0.0,
        }
    }
}

impl Encoder {
    /// A 17-bit encoder on the axle (2¹⁷ steps of 4.8e-5 rad a turn), and a carriage whose speed
    /// signal has 100 Hz of bandwidth and 1e-6 m/s/√Hz of noise, 0.03 mm/s rms over 1 kHz.
    pub fn realistic() -> Self {
        Self {
            wheel_angle: Counter {
                resolution: std::f64::consts::TAU / f64::from(1 << 17),
                ..Counter::default()
            },
            forward_speed: Transducer {
                bandwidth: 100.0,
                noise_density: 1e-6,
                ..Transducer::default()
            },
        }
    }

    pub(super) fn check(&self, rate: f64) -> Result<(), RangeError> {
        let Counter {
            gain,
            bias,
            noise,
            resolution,
            delay,
        } = self.wheel_angle;
        finite("encoder gain", "-", gain)?;
        finite("encoder bias", "rad", bias)?;
        not_negative("encoder noise", "rad", noise)?;
        not_negative("encoder resolution", "rad", resolution)?;
        not_negative("encoder delay", "s", delay)?;
        self.forward_speed.check("m/s", rate)
    }
}

/// A [`Counter`] at work.
pub(super) struct Latch {
    counter: Counter,
    instants: Instants,
    noise: Option<WhiteNoise>,
    /// Angle [rad] at the last step.
    last: Option<f64>,
    pub(super) readings: Vec<f64>,
}

impl Latch {
    /// `instants` are those of the output samples; noise draws from `rng`.
    pub(super) fn new(counter: Counter, instants: Instants, rng: ChaCha8Rng) -> Self {
        Self {
            counter,
            instants,
            noise: WhiteNoise::of_deviation(counter.noise, rng),
            last: None,
            readings: Vec::new(),
        }
    }

    /// Takes the `angle` [rad] at `step`.
    pub(super) fn push(&mut self, step: u64, angle: f64) {
        let last = self.last.replace(angle).unwrap_or(angle);
        while let Some(back) = self.instants.due(step) {
            self.read(angle - (angle - last) * back);
        }
    }

    /// Readings so many that the last angle holds to the end.
    pub(super) fn finish(mut self, count: usize) -> Vec<f64> {
        let held = self.last.unwrap_or_default();
        while self.readings.len() < count {
            self.read(held);
        }
        self.readings.truncate(count);
        self.readings
    }

    fn read(&mut self, angle: f64) {
        let Counter {
            gain,
            bias,
            resolution,
            ..
        } = self.counter;
        let noise = self.noise.as_mut().map_or(0.0, WhiteNoise::draw);
        let reading = gain * angle + bias + noise;
        self.readings.push(if resolution > 0.0 {
            quantised(reading, resolution)
        } else {
            reading
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;

    #[test]
    fn readings_stand_on_counts_and_lag_by_the_delay() {
        let counter = Counter {
            resolution: 0.01,
            delay: 0.1,
            ..Counter::default()
        };
        // 1000 steps a second, read 100 times a second, a tenth of a second late.
        let instants = Instants::new(10.0, 100.0);
        let mut latch = Latch::new(counter, instants, Seed(1).rng("encoder", 0));
        for step in 0..1000 {
            latch.push(step, 1e-3 * step as f64);
        }
        let readings = latch.finish(100);
        assert_eq!(readings.len(), 100);
        for (k, reading) in readings.iter().enumerate() {
            let seen = 0.01 * k.saturating_sub(10) as f64;
            assert!((reading - seen).abs() < 1e-12, "{k}: {reading}");
        }
    }
}
