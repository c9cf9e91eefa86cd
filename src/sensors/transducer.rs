//! What every analogue channel has: bandwidth, gain, bias, noise, range, resolution.

use super::noise::{LowPassedNoise, WhiteNoise};
use super::second_order::SecondOrder;
use super::single_pole::SinglePole;
use crate::quantity::{RangeError, nearest_whole};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Corner [Hz] of slow noise.
const RUMBLE: f64 = 20.0;

/// Frequency [Hz] of the mains.
const MAINS: f64 = 50.0;

/// One analogue channel from quantity to sample; `unit` is the channel's.
///
/// The default is ideal: it changes nothing and draws no random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Transducer {
    /// Corner \[Hz\], -3 dB, of a Butterworth low pass of second order; `inf` passes everything.
    pub bandwidth: f64,
    /// Corner \[Hz\], -3 dB, of a low pass of first order after it; `inf` passes everything.
    pub single_pole: f64,
    /// Reading over quantity [-].
    pub gain: f64,
    /// Relative change [1/unit] of the gain per unit of the quantity.
    pub curvature: f64,
    /// Reading at zero [unit].
    pub bias: f64,
    /// Growth of the bias [unit/s].
    pub drift: f64,
    /// Density [unit/√Hz] of white noise, one-sided, up to half the sensor rate.
    pub noise_density: f64,
    /// Root mean square [unit] of slow noise: white noise behind a low pass of first order at
    /// 20 Hz.
    pub rumble: f64,
    /// Amplitude [unit] of 50 Hz hum from the mains.
    pub hum: f64,
    /// Amplitude [unit] of 100 Hz ripple from a rectifier.
    pub ripple: f64,
    /// Largest reading [unit], either way; beyond it the channel clips.
    pub range: f64,
    /// Saturation level `R` [unit] of the reading `R tanh(x/R)`, either way.
    pub soft_range: f64,
    /// Quantisation step [unit] with rounding; 0 is continuous.
    pub resolution: f64,
    /// Quantisation step [unit] with truncation toward zero; 0 is continuous.
    pub truncation: f64,
    /// Time \[s\] by which readings lag their time stamps.
    pub delay: f64,
    /// Time \[s\] for which a reading is held until the next is taken; 0 takes every one.
    pub hold: f64,
}

impl Default for Transducer {
    fn default() -> Self {
        Self {
            bandwidth: f64::INFINITY,
            single_pole: f64::INFINITY,
            gain: 1.0,
            curvature: 0.0,
            bias: 0.0,
            drift: 0.0,
            noise_density: 0.0,
            rumble: 0.0,
            hum: 0.0,
            ripple: 0.0,
            range: f64::INFINITY,
            soft_range: f64::INFINITY,
            resolution: 0.0,
            truncation: 0.0,
            delay: 0.0,
            hold: 0.0,
        }
    }
}

impl Transducer {
    /// Whether a channel in `unit` that is sampled at `rate` [Hz] can have these figures.
    ///
    /// # Errors
    /// `RangeError` for the first that it cannot.
    pub(super) fn check(&self, unit: &'static str, rate: f64) -> Result<(), RangeError> {
        corner("bandwidth", self.bandwidth, rate)?;
        corner("single pole", self.single_pole, rate)?;
        finite("gain", "-", self.gain)?;
        finite("curvature per", unit, self.curvature)?;
        finite("bias", unit, self.bias)?;
        finite("drift per second", unit, self.drift)?;
        not_negative("noise density per root hertz", unit, self.noise_density)?;
        not_negative("rumble", unit, self.rumble)?;
        finite("hum", unit, self.hum)?;
        finite("ripple", unit, self.ripple)?;
        for (quantity, range) in [("range", self.range), ("soft range", self.soft_range)] {
            if range != f64::INFINITY {
                RangeError::positive(quantity, unit, range)?;
            }
        }
        not_negative("resolution", unit, self.resolution)?;
        not_negative("truncation", unit, self.truncation)?;
        not_negative("delay", "s", self.delay)?;
        not_negative("hold", "s", self.hold)
    }
}

impl Transducer {
    /// Its bandwidth as a Butterworth low pass at the sensor `rate` [Hz].
    pub(super) fn low_pass(&self, rate: f64) -> Option<SecondOrder> {
        SecondOrder::new(self.bandwidth, FRAC_1_SQRT_2, rate)
    }
}

/// Whether a filter's corner [Hz] lies below half the sensor `rate` [Hz], or is `inf`.
pub(super) fn corner(quantity: &'static str, value: f64, rate: f64) -> Result<(), RangeError> {
    if value == f64::INFINITY || (value > 0.0 && value < rate / 2.0) {
        return Ok(());
    }
    Err(RangeError {
        quantity,
        unit: "Hz",
        range: format!(
            "above 0 and below half the sensor rate, {} Hz, or inf",
            rate / 2.0
        ),
        value,
    })
}

/// Whether a number is one.
pub(super) fn finite(
    quantity: &'static str,
    unit: &'static str,
    value: f64,
) -> Result<(), RangeError> {
    RangeError::check(quantity, unit, value, [f64::MIN, f64::MAX]).map(drop)
}

/// Whether a number is finite and 0 or more.
pub(super) fn not_negative(
    quantity: &'static str,
    unit: &'static str,
    value: f64,
) -> Result<(), RangeError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(RangeError {
        quantity,
        unit,
        range: "0 or more and finite".to_owned(),
        value,
    })
}

/// Nearest multiple of `resolution`, halves to even; the value itself where the resolution is 0.
pub(super) fn quantised(value: f64, resolution: f64) -> f64 {
    const LARGEST: f64 = (1_u64 << 51) as f64;
    let steps = value / resolution;
    if steps.abs() < LARGEST {
        nearest_whole(steps) * resolution
    } else {
        value
    }
}

/// The stream of random numbers beside that of `rng`.
fn beside(rng: &ChaCha8Rng) -> ChaCha8Rng {
    let mut beside = rng.clone();
    beside.set_stream(1);
    beside
}

/// A [`Transducer`] at work on samples at the sensor rate.
pub(super) struct Reading {
    figures: Transducer,
    low_pass: Option<SecondOrder>,
    single_pole: Option<SinglePole>,
    noise: Option<WhiteNoise>,
    rumble: Option<LowPassedNoise>,
    /// The reading that is held.
    held: f64,
    period: f64,
    taken: u64,
}

impl Reading {
    /// Sampled at `rate` [Hz]; noise draws from `rng`.
    pub(super) fn new(figures: Transducer, rate: f64, rng: ChaCha8Rng) -> Self {
        Self {
            figures,
            single_pole: SinglePole::new(figures.single_pole, rate),
            rumble: LowPassedNoise::new(figures.rumble, RUMBLE, rate, beside(&rng)),
            held: 0.0,
            low_pass: figures.low_pass(rate),
            noise: WhiteNoise::of_density(figures.noise_density, rate, rng),
            period: 1.0 / rate,
            taken: 0,
        }
    }

    /// Turns quantities into readings, in place.
    pub(super) fn read(&mut self, samples: &mut [f64]) {
        if let Some(low_pass) = &mut self.low_pass {
            low_pass.apply(samples);
        }
        if let Some(single_pole) = &mut self.single_pole {
            single_pole.apply(samples);
        }
        self.amplify(samples);
        for (frequency, amplitude) in [
            (MAINS, self.figures.hum),
            (2.0 * MAINS, self.figures.ripple),
        ] {
            if amplitude != 0.0 {
                self.add_hum(samples, frequency, amplitude);
            }
        }
        if let Some(rumble) = &mut self.rumble {
            rumble.add_to(samples);
        }
        if let Some(noise) = &mut self.noise {
            noise.add_to(samples);
        }
        self.digitise(samples);
        self.hold(samples);
        self.taken += samples.len() as u64;
    }

    fn time(&self) -> f64 {
        self.taken as f64 * self.period
    }

    fn amplify(&self, samples: &mut [f64]) {
        let Transducer {
            gain,
            curvature,
            bias,
            drift,
            ..
        } = self.figures;
        if curvature != 0.0 {
            samples
                .iter_mut()
                .for_each(|x| *x += curvature * *x * x.abs());
        }
        let (bias, step) = (bias + drift * self.time(), drift * self.period);
        for (i, sample) in (0_u32..).zip(samples) {
            *sample = gain * *sample + (bias + step * f64::from(i));
        }
    }

    /// One sine of the mains, turned on from sample to sample.
    fn add_hum(&self, samples: &mut [f64], frequency: f64, amplitude: f64) {
        let cycles = frequency * self.time();
        let (mut sine, mut cosine) = libm::sincos(TAU * (cycles - cycles.floor()));
        let (turn_sine, turn_cosine) = libm::sincos(TAU * frequency * self.period);
        for sample in samples {
            *sample += amplitude * sine;
            (sine, cosine) = (
                sine * turn_cosine + cosine * turn_sine,
                cosine * turn_cosine - sine * turn_sine,
            );
        }
    }

    fn digitise(&self, samples: &mut [f64]) {
        let Transducer {
            range,
            soft_range,
            resolution,
            truncation,
            ..
        } = self.figures;
        if soft_range.is_finite() {
            samples
                .iter_mut()
                .for_each(|x| *x = soft_range * libm::tanh(*x / soft_range));
        }
        if range.is_finite() {
            samples.iter_mut().for_each(|x| *x = x.clamp(-range, range));
        }
        if resolution > 0.0 {
            samples
                .iter_mut()
                .for_each(|x| *x = quantised(*x, resolution));
        }
        if truncation > 0.0 {
            samples
                .iter_mut()
                .for_each(|x| *x = (*x / truncation).trunc() * truncation);
        }
    }

    /// Gives every sample the value of the last reading taken.
    fn hold(&mut self, samples: &mut [f64]) {
        let every = (self.figures.hold / self.period).round() as u64;
        if every < 2 {
            return;
        }
        for (index, sample) in (self.taken..).zip(samples) {
            if index % every == 0 {
                self.held = *sample;
            }
            *sample = self.held;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::amplitude;
    use super::*;
    use crate::quantity::Seed;

    fn read(figures: Transducer, quantity: &[f64]) -> Vec<f64> {
        let mut samples = quantity.to_vec();
        let mut reading = Reading::new(figures, 128_000.0, Seed(1).rng("sensors", 0));
        samples
            .chunks_mut(100)
            .for_each(|block| reading.read(block));
        samples
    }

    #[test]
    fn a_held_reading_stands_until_the_next_is_taken() {
        let quantity: Vec<f64> = (0..1000).map(f64::from).collect();
        // 25 samples at 128 kHz, in blocks of 100 and across them.
        for every in [25, 30] {
            let figures = Transducer {
                hold: f64::from(every) / 128_000.0,
                ..Transducer::default()
            };
            for (k, held) in (0..).zip(read(figures, &quantity)) {
                assert_eq!(held, f64::from(k - k % every));
            }
        }
    }

    #[test]
    fn an_ideal_transducer_changes_no_bit() {
        let quantity: Vec<f64> = (0..1000).map(|i| libm::sin(f64::from(i)) * 1e3).collect();
        assert_eq!(read(Transducer::default(), &quantity), quantity);
    }

    #[test]
    fn readings_clip_at_the_range_and_sit_on_multiples_of_the_resolution() {
        let figures = Transducer {
            range: 2.0,
            resolution: 0.25,
            ..Transducer::default()
        };
        let readings = read(figures, &[0.1, 0.13, -0.13, 1.9, 2.5, -7.0]);
        assert_eq!(readings, [0.0, 0.25, -0.25, 2.0, 2.0, -2.0]);
    }

    #[test]
    fn gain_bias_and_drift_are_a_line_in_quantity_and_time() {
        let figures = Transducer {
            gain: 1.01,
            bias: 0.2,
            drift: 3.0,
            ..Transducer::default()
        };
        let readings = read(figures, &[10.0; 1280]);
        for (i, reading) in readings.iter().enumerate() {
            let line = 1.01 * 10.0 + 0.2 + 3.0 * i as f64 / 128_000.0;
            assert!((reading - line).abs() < 1e-12);
        }
    }

    #[test]
    fn hum_is_a_tone_of_50_hz_across_blocks() {
        let figures = Transducer {
            hum: 0.3,
            ..Transducer::default()
        };
        let readings = read(figures, &[1.0; 12_800]);
        let found = amplitude(&readings, 50.0 / 128_000.0);
        assert!((found - 0.3).abs() < 1e-9, "{found}");
    }

    #[test]
    fn noise_has_the_stated_density() {
        let figures = Transducer {
            noise_density: 0.01,
            ..Transducer::default()
        };
        let readings = read(figures, &[0.0; 200_000]);
        let square = readings.iter().map(|x| x * x).sum::<f64>() / 200_000.0;
        let density = (square / 64_000.0).sqrt();
        // Five standard errors: 5 / sqrt(2 n).
        assert!((density / 0.01 - 1.0).abs() < 0.008, "{density}");
    }

    #[test]
    fn a_bandwidth_beyond_nyquist_says_what_is_possible() {
        let figures = Transducer {
            bandwidth: 70_000.0,
            ..Transducer::default()
        };
        assert_eq!(
            figures.check("N", 128_000.0).unwrap_err().to_string(),
            "bandwidth [Hz] must be above 0 and below half the sensor rate, 64000 Hz, or inf, \
             got 70000"
        );
    }
}
