//! Low pass of first order: a resistor and a capacitor.

use realfft::num_complex::Complex;

/// `1/(1 + s/ω)` by the bilinear transform, exact at its corner; it starts settled at its first
/// sample.
pub(super) struct SinglePole {
    b: f64,
    a: f64,
    state: f64,
    reference: Option<f64>,
}

impl SinglePole {
    /// `corner` and `rate` [Hz]. No filter for an infinite corner.
    pub(super) fn new(corner: f64, rate: f64) -> Option<Self> {
        if corner.is_infinite() {
            return None;
        }
        let k = libm::tan(std::f64::consts::PI * corner / rate);
        Some(Self {
            b: k / (1.0 + k),
            a: (k - 1.0) / (1.0 + k),
            state: 0.0,
            reference: None,
        })
    }

    /// Its response where a step back in time is `z⁻¹`.
    pub(super) fn response(&self, step_back: Complex<f64>) -> Complex<f64> {
        self.b * (1.0 + step_back) / (1.0 + self.a * step_back)
    }

    /// Filters in place.
    pub(super) fn apply(&mut self, samples: &mut [f64]) {
        let Some(&first) = samples.first() else {
            return;
        };
        let reference = *self.reference.get_or_insert(first);
        for sample in samples {
            let x = self.b * (*sample - reference);
            let y = x + self.state;
            self.state = x - self.a * y;
            *sample = y + reference;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::{amplitude, sine};
    use super::*;

    #[test]
    fn gain_is_3_db_down_at_the_corner_and_20_db_a_decade_above() {
        let gain = |frequency: f64| {
            let mut samples = sine(frequency / 128_000.0, 64_000);
            SinglePole::new(100.0, 128_000.0)
                .unwrap()
                .apply(&mut samples);
            amplitude(&samples[32_000..], frequency / 128_000.0)
        };
        assert!((gain(100.0) - 0.5_f64.sqrt()).abs() < 1e-6);
        // 0.5 %: the asymptote is 1/√(1 + 100) at ten times the corner.
        assert!((gain(1000.0) * 10.0 - 1.0).abs() < 0.01, "{}", gain(1000.0));
    }
}
