//! Tones in, amplitudes out: how the tests of this module measure a response.

use super::fir::kaiser;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Unit sine of `frequency` [cycles per sample].
pub(super) fn sine(frequency: f64, length: usize) -> Vec<f64> {
    let at = |i| libm::sin(TAU * frequency * i as f64 + 0.3);
    (0..length).map(at).collect()
}

/// Amplitude of the tone of `frequency` [cycles per sample] in `samples`: weighted least squares
/// over a constant, a sine and a cosine. Periods need not be whole, and the weights, a Kaiser
/// window of 140 dB, keep other tones out.
pub(super) fn amplitude(samples: &[f64], frequency: f64) -> f64 {
    let middle = (samples.len() - 1) as f64 / 2.0;
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (i, sample) in samples.iter().enumerate() {
        let (sine, cosine) = libm::sincos(TAU * frequency * i as f64);
        let basis = Vector3::new(1.0, sine, cosine);
        let weight = kaiser((i as f64 - middle) / middle, 140.0);
        normal += weight * basis * basis.transpose();
        right += weight * *sample * basis;
    }
    let found = normal.lu().solve(&right).expect("a tone below Nyquist");
    libm::hypot(found[1], found[2])
}

/// A ratio of amplitudes in dB.
pub(super) fn decibels(ratio: f64) -> f64 {
    20.0 * libm::log10(ratio)
}
