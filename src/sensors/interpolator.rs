//! From the physics rate up to the sensor rate, band-limited.

use super::fir::{correlate, kaiser, unit_sum};
use super::stages::{Stage, Stages};
use crate::signal::sinc;

/// Depth [dB] to which images are designed; 80 dB is promised.
const ATTENUATION: f64 = 95.0;
/// Edge of the flat band in input rates.
const PASS: f64 = 0.4;

/// Raises the rate of a stream by a whole factor, by two at a time as long as it is even.
///
/// Flat to 0.1 dB up to 0.4 of the input rate; images of that band stay 80 dB below it. Given
/// samples pass unchanged, new ones between them come from a windowed sinc: over 32 samples at the input
/// rate, and over 12 and 8 where the stages before leave more room between the band and its images. Eight times the rate so costs
/// 88 products an input sample, in one stage it would be 224.
/// The first and last values are held beyond the ends.
pub(super) struct Interpolator {
    stages: Stages<Between>,
}

impl Interpolator {
    pub(super) fn new(factor: u32) -> Self {
        let doublings = factor.trailing_zeros();
        let odd = factor >> doublings;
        let doublers = (0..doublings).map(|k| Between::new(2, f64::from(1 << k)));
        let last = (odd > 1).then(|| Between::new(odd, f64::from(1 << doublings)));
        Self {
            stages: Stages::new(doublers.chain(last).collect()),
        }
    }

    /// Takes samples and appends the outputs that they complete to `out`.
    pub(super) fn push(&mut self, block: &[f64], out: &mut Vec<f64>) {
        self.stages.push(block, out);
    }

    /// Appends the remaining outputs.
    pub(super) fn finish(self, out: &mut Vec<f64>) {
        self.stages.finish(out);
    }
}

/// One filter, between every two samples.
struct Between {
    /// Filters for the places between two samples.
    phases: Vec<Phase>,
    /// Known samples on each side of a new one.
    half: usize,
    buffer: Vec<f64>,
}

struct Phase {
    taps: Vec<f64>,
    /// What it gave for the last block.
    values: Vec<f64>,
}

impl Between {
    /// Raises by `factor` a stream that has been raised by `before`.
    fn new(factor: u32, before: f64) -> Self {
        let room = 1.0 - 2.0 * PASS / before;
        let length = (ATTENUATION - 7.95) / (14.36 * room);
        let half = (0.5 * length).ceil() as usize;
        let weight = |phase: u32, tap: usize| {
            let t = f64::from(phase) / f64::from(factor) - (tap as f64 - (half - 1) as f64);
            sinc(t) * kaiser(t / half as f64, ATTENUATION)
        };
        let phase = |phase| Phase {
            taps: unit_sum((0..2 * half).map(|tap| weight(phase, tap)).collect()),
            values: Vec::new(),
        };
        Self {
            phases: (1..factor).map(phase).collect(),
            half,
            buffer: vec![0.0; half - 1],
        }
    }
}

impl Stage for Between {
    fn push(&mut self, block: &[f64], out: &mut Vec<f64>) {
        self.buffer.extend_from_slice(block);
        let settled = (self.buffer.len() + 1).saturating_sub(2 * self.half);
        for Phase { taps, values } in &mut self.phases {
            correlate(taps, &self.buffer, values);
        }
        let factor = self.phases.len() + 1;
        let begin = out.len();
        out.resize(begin + settled * factor, 0.0);
        let places = &mut out[begin..];
        let given = places.iter_mut().step_by(factor);
        for (place, x) in given.zip(&self.buffer[self.half - 1..]) {
            *place = *x;
        }
        for (number, phase) in self.phases.iter().enumerate() {
            let between = places.iter_mut().skip(number + 1).step_by(factor);
            for (place, x) in between.zip(&phase.values) {
                *place = *x;
            }
        }
        self.buffer.drain(..settled);
    }

    fn finish(&mut self, out: &mut Vec<f64>) {
        let last = self.buffer.last().copied().unwrap_or(0.0);
        self.push(&vec![last; self.half], out);
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::{amplitude, decibels, sine};
    use super::*;

    fn interpolated(input: &[f64], factor: u32) -> Vec<f64> {
        let mut interpolator = Interpolator::new(factor);
        let mut out = Vec::new();
        for block in input.chunks(100) {
            interpolator.push(block, &mut out);
        }
        interpolator.finish(&mut out);
        out
    }

    #[test]
    fn images_stay_80_db_below_a_tone_that_passes_flat_to_a_tenth_of_a_decibel() {
        for (factor, frequency) in [0.01, 0.1, 0.25, 0.35, 0.4]
            .map(|f| (16, f))
            .into_iter()
            .chain([(3, 0.4), (6, 0.4)])
        {
            let out = interpolated(&sine(frequency, 8192), factor);
            let middle = &out[1600..out.len() - 1600];
            let level = |cycles: f64| decibels(amplitude(middle, cycles / f64::from(factor)));
            assert!(level(frequency).abs() < 0.1, "tone at {frequency}");
            for k in 1..factor / 2 {
                for image in [f64::from(k) - frequency, f64::from(k) + frequency] {
                    assert!(level(image) < -80.0, "{frequency}: image at {image}");
                }
            }
        }
    }

    #[test]
    fn given_samples_and_constants_pass_unchanged() {
        let input = sine(0.3, 300);
        let out = interpolated(&input, 4);
        assert_eq!(out.len(), 1200);
        for (k, x) in input.iter().enumerate() {
            // Less and plus the first sample: one rounding of a number of order 1.
            assert!((out[4 * k] - x).abs() < 1e-15);
        }
        assert_eq!(interpolated(&[9.81; 300], 4), [9.81; 1200]);
    }
}
