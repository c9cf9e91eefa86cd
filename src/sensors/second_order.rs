//! Low pass of second order: a sensor's bandwidth, or the resonance of its mount.

use realfft::num_complex::Complex;
use std::f64::consts::PI;

/// `ω²/(s² + 2ζωs + ω²)` by the bilinear transform, exact at its corner.
///
/// It starts settled at its first sample.
pub(super) struct SecondOrder {
    b0: f64,
    a: [f64; 2],
    state: [f64; 2],
    reference: Option<f64>,
}

impl SecondOrder {
    /// `corner` and `rate` [Hz], `damping` ratio ζ [-]. No filter for an infinite corner.
    pub(super) fn new(corner: f64, damping: f64, rate: f64) -> Option<Self> {
        if corner.is_infinite() {
            return None;
        }
        let k = libm::tan(PI * corner / rate);
        let scale = 1.0 / (1.0 + 2.0 * damping * k + k * k);
        Some(Self {
            b0: k * k * scale,
            a: [
                2.0 * (k * k - 1.0) * scale,
                (1.0 - 2.0 * damping * k + k * k) * scale,
            ],
            state: [0.0; 2],
            reference: None,
        })
    }

    /// Its response where a step back in time is `z⁻¹`.
    pub(super) fn response(&self, step_back: Complex<f64>) -> Complex<f64> {
        let [a1, a2] = self.a;
        let both = step_back * step_back;
        self.b0 * (1.0 + 2.0 * step_back + both) / (1.0 + a1 * step_back + a2 * both)
    }

    /// Filters in place.
    pub(super) fn apply(&mut self, samples: &mut [f64]) {
        let Some(&first) = samples.first() else {
            return;
        };
        let reference = *self.reference.get_or_insert(first);
        let (b0, [a1, a2], [mut s1, mut s2]) = (self.b0, self.a, self.state);
        for sample in samples {
            let x = b0 * (*sample - reference);
            let y = x + s1;
            s1 = 2.0 * x - a1 * y + s2;
            s2 = x - a2 * y;
            *sample = y + reference;
        }
        self.state = [s1, s2];
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::{amplitude, sine};
    use super::*;

    fn gain(corner: f64, damping: f64, frequency: f64) -> f64 {
        let rate = 128_000.0;
        let mut samples = sine(frequency / rate, 64_000);
        let mut filter = SecondOrder::new(corner, damping, rate).unwrap();
        filter.apply(&mut samples);
        amplitude(&samples[32_000..], frequency / rate)
    }

    #[test]
    fn gain_at_the_corner_is_one_over_twice_the_damping() {
        for (corner, damping) in [(1_000.0, 0.5_f64.sqrt()), (12_000.0, 0.05)] {
            let found = gain(corner, damping, corner) * 2.0 * damping;
            assert!((found - 1.0).abs() < 1e-6, "{corner} Hz: {found}");
        }
    }

    #[test]
    fn two_decades_above_the_corner_80_db_are_gone_and_below_it_nothing() {
        // 2 %: at a tenth of the rate the bilinear transform falls faster than the analogue.
        let analogue = (100.0_f64 / 4_000.0).powi(2);
        let found = gain(100.0, 0.5_f64.sqrt(), 4_000.0);
        assert!((found / analogue - 1.0).abs() < 0.02, "{found}");
        assert!((gain(100.0, 0.5_f64.sqrt(), 1.0) - 1.0).abs() < 1e-6);
    }
}
