//! From the physics rate up to the sensor rate, band-limited.

use super::fir::{dot, kaiser, sinc, unit_sum};

/// Known samples on each side of a new one.
const HALF: usize = 16;
/// Depth [dB] to which images are designed; 80 dB is promised.
const ATTENUATION: f64 = 95.0;

/// Raises the rate of a stream by a whole factor.
///
/// Flat to 0.1 dB up to 0.4 of the input rate; images of that band stay 80 dB below it. Given
/// samples pass unchanged, new ones between them come from a windowed sinc over 32 samples. The
/// first and last values are held beyond the ends.
pub(super) struct Interpolator {
    phases: Vec<Vec<f64>>,
    /// Samples less the first one, so that a constant passes exactly.
    buffer: Vec<f64>,
    reference: Option<f64>,
}

impl Interpolator {
    pub(super) fn new(factor: u32) -> Self {
        let weight = |phase: u32, tap: usize| {
            let t = f64::from(phase) / f64::from(factor) - (tap as f64 - (HALF - 1) as f64);
            sinc(t) * kaiser(t / HALF as f64, ATTENUATION)
        };
        let phases = (1..factor)
            .map(|phase| unit_sum((0..2 * HALF).map(|tap| weight(phase, tap)).collect()))
            .collect();
        Self {
            phases,
            buffer: vec![0.0; HALF - 1],
            reference: None,
        }
    }

    /// Takes samples and appends those that they settle to `out`.
    pub(super) fn push(&mut self, block: &[f64], out: &mut Vec<f64>) {
        let Some(&first) = block.first() else { return };
        let reference = *self.reference.get_or_insert(first);
        self.buffer.extend(block.iter().map(|x| x - reference));
        self.settle(reference, out);
    }

    /// Appends what the last samples leave open.
    pub(super) fn finish(mut self, out: &mut Vec<f64>) {
        let (Some(reference), Some(&last)) = (self.reference, self.buffer.last()) else {
            return;
        };
        self.buffer.extend([last; HALF]);
        self.settle(reference, out);
    }

    fn settle(&mut self, reference: f64, out: &mut Vec<f64>) {
        for window in self.buffer.windows(2 * HALF) {
            out.push(reference + window[HALF - 1]);
            out.extend(self.phases.iter().map(|taps| reference + dot(taps, window)));
        }
        let settled = (self.buffer.len() + 1).saturating_sub(2 * HALF);
        self.buffer.drain(..settled);
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
        let factor = 16;
        for frequency in [0.01, 0.1, 0.25, 0.35, 0.4] {
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
