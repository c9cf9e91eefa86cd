//! Low-passed accelerations and the sums of their amplitudes.

use crate::signal::{Backward, Forward, Plans, hann_lines, hann_powers};
use realfft::num_complex::Complex;
use std::f64::consts::LN_2;

/// Caches the plans of Fourier transforms.
#[derive(Default)]
pub(super) struct Spectra {
    plans: Plans,
    plan: Option<Plan>,
}

struct Plan {
    length: usize,
    forward: Forward,
    backward: Backward,
    /// The low-pass: its corner over the sample rate, and its gain at every line up to where it
    /// lets nothing through.
    low_pass: Option<(f64, Vec<f64>)>,
}

/// A window's acceleration less its mean, low-passed.
pub(super) struct Filtered {
    samples: Vec<f64>,
    /// Sum over the lines of a Hann-windowed spectrum.
    pub amplitude_sum: f64,
}

/// Gain [-] of a Gaussian low-pass at a frequency over its corner, 3 dB down at 1.
pub(super) fn gaussian_gain(frequency: f64) -> f64 {
    libm::exp(-0.5 * LN_2 * frequency * frequency)
}

/// The frequency [Hz per Hz of corner] where that gain has fallen to 1e-15.
const NO_GAIN: f64 = 10.0;

impl Spectra {
    /// `samples` through a Gaussian low-pass whose corner lies at `corner` times the sample rate,
    /// as if they went on periodically.
    pub fn low_passed(&mut self, samples: &[f64], corner: f64) -> Filtered {
        let plan = self.plan(samples.len());
        let mut spectrum = plan.forward.apply(samples.to_vec());
        let gains = plan.gains(corner);
        let (passed, stopped) = spectrum.split_at_mut(gains.len());
        for (value, gain) in passed.iter_mut().zip(gains) {
            *value *= gain;
        }
        stopped.fill(Complex::default());
        spectrum[0] = Complex::default();
        let amplitude_sum = hann_amplitudes(&spectrum);
        let scale = 1.0 / samples.len() as f64;
        let filtered = plan.backward.apply(spectrum).into_iter();
        Filtered {
            amplitude_sum,
            samples: filtered.map(|sample| sample * scale).collect(),
        }
    }

    /// `samples` less their mean; they are low-passed already.
    pub fn as_they_are(&mut self, samples: &[f64]) -> Filtered {
        let plan = self.plan(samples.len());
        let mut spectrum = plan.forward.apply(samples.to_vec());
        spectrum[0] = Complex::default();
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        Filtered {
            amplitude_sum: hann_amplitudes(&spectrum),
            samples: samples.iter().map(|x| x - mean).collect(),
        }
    }

    /// Powers of the spectrum's lines: see [`hann_powers`].
    pub fn powers(&mut self, samples: &[f64]) -> Vec<f64> {
        hann_powers(&self.plan(samples.len()).forward, samples)
    }

    fn plan(&mut self, length: usize) -> &mut Plan {
        if self.plan.as_ref().is_none_or(|plan| plan.length != length) {
            self.plan = Some(Plan {
                length,
                forward: self.plans.forward(length),
                backward: self.plans.backward(length),
                low_pass: None,
            });
        }
        self.plan.as_mut().expect("it was made above")
    }
}

impl Plan {
    /// Gains of the low-pass with this `corner` over the sample rate, line by line.
    fn gains(&mut self, corner: f64) -> &[f64] {
        let known = matches!(&self.low_pass, Some((of, _)) if *of == corner);
        if !known {
            let length = self.length as f64;
            let frequencies = (0..=self.length / 2).map(|line| line as f64 / length / corner);
            let passed = frequencies.take_while(|frequency| *frequency <= NO_GAIN);
            self.low_pass = Some((corner, passed.map(gaussian_gain).collect()));
        }
        self.low_pass.as_ref().map_or(&[], |(_, gains)| gains)
    }
}

/// Sum of the amplitudes under a Hann window.
fn hann_amplitudes(spectrum: &[Complex<f64>]) -> f64 {
    // Not `norm`: the system's `hypot` differs between machines, and is slow.
    hann_lines(spectrum)
        .map(|line| libm::sqrt(line.norm_sqr()))
        .sum()
}

impl Filtered {
    /// The samples, their mean taken off.
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Mean of the rectified samples.
    pub fn rectified_mean(&self) -> f64 {
        self.samples.iter().map(|x| x.abs()).sum::<f64>() / self.samples.len() as f64
    }

    /// Mean of the squared samples.
    pub fn mean_square(&self) -> f64 {
        self.samples.iter().map(|x| x * x).sum::<f64>() / self.samples.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn tone(cycles: f64, length: usize) -> Vec<f64> {
        let phase = |i: usize| TAU * cycles * i as f64 / length as f64;
        (0..length).map(|i| 3.0 * phase(i).sin()).collect()
    }

    #[test]
    fn a_tone_at_the_corner_loses_3_db_and_one_far_above_everything() {
        let mut spectra = Spectra::default();
        let at_corner = spectra.low_passed(&tone(50.0, 1000), 0.05);
        assert!((at_corner.mean_square() - 4.5 / 2.0).abs() < 1e-9);
        assert!(spectra.low_passed(&tone(400.0, 1000), 0.02).mean_square() < 1e-20);
    }

    #[test]
    fn amplitudes_of_two_tones_far_apart_add_up_and_a_constant_counts_nothing() {
        let mut spectra = Spectra::default();
        let sum = |cycles: &[f64], spectra: &mut Spectra| {
            let mut samples = vec![7.0; 1000];
            for &cycles in cycles {
                for (sample, tone) in samples.iter_mut().zip(tone(cycles, 1000)) {
                    *sample += tone;
                }
            }
            spectra.as_they_are(&samples).amplitude_sum
        };
        let (one, two) = (sum(&[40.0], &mut spectra), sum(&[40.0, 90.0], &mut spectra));
        assert!((two / one - 2.0).abs() < 1e-9);
        assert!(sum(&[], &mut spectra) < 1e-9);
    }

    #[test]
    fn an_impulse_becomes_a_pulse_of_one_sign_so_its_rectified_mean_keeps_its_area() {
        let mut spectra = Spectra::default();
        for (length, corner) in [(2000, 0.05), (2001, 0.05), (2000, 0.02)] {
            let mut samples = vec![0.0; length];
            samples[length / 3] = 1.0;
            let filtered = spectra.low_passed(&samples, corner);
            // Twice the area: the pulse, and the mean taken off it, which counts as much again;
            // 2 % of the record lie under the pulse.
            let rectified = filtered.rectified_mean() * length as f64;
            assert!((rectified - 2.0).abs() < 0.05, "{rectified}");
        }
    }
}
