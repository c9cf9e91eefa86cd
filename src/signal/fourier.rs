//! Fourier transforms of real samples, and spectra under Hann's window.

use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// Plans of transforms, made once for a length.
#[derive(Default)]
pub struct Plans {
    planner: Option<RealFftPlanner<f64>>,
}

/// Transform of as many samples as it is planned for.
pub struct Forward(Arc<dyn RealToComplex<f64>>);

/// Inverse transform to as many samples as it is planned for.
pub struct Backward(Arc<dyn ComplexToReal<f64>>);

impl Plans {
    /// The transform of `length` samples.
    pub fn forward(&mut self, length: usize) -> Forward {
        Forward(self.planner().plan_fft_forward(length))
    }

    /// The inverse transform to `length` samples.
    pub fn backward(&mut self, length: usize) -> Backward {
        Backward(self.planner().plan_fft_inverse(length))
    }

    fn planner(&mut self) -> &mut RealFftPlanner<f64> {
        self.planner.get_or_insert_with(RealFftPlanner::new)
    }
}

impl Forward {
    /// Lines `X_k = Σ_j x_j exp(-2πi j k / N)`, `k` from 0 to `N/2`.
    ///
    /// # Panics
    /// With another number of samples than planned.
    pub fn apply(&self, mut samples: Vec<f64>) -> Vec<Complex<f64>> {
        let mut lines = self.0.make_output_vec();
        let done = self.0.process(&mut samples, &mut lines);
        done.expect("as many samples as planned");
        lines
    }
}

impl Backward {
    /// `N` times the samples of these lines. Imaginary parts at both ends, which real samples do not have, are ignored.
    ///
    /// # Panics
    /// With another number of lines than planned.
    pub fn apply(&self, mut lines: Vec<Complex<f64>>) -> Vec<f64> {
        let mut samples = self.0.make_output_vec();
        let is_even = self.0.len().is_multiple_of(2);
        let last = lines.len() - 1;
        lines[0].im = 0.0;
        if is_even {
            lines[last].im = 0.0;
        }
        let done = self.0.process(&mut lines, &mut samples);
        done.expect("as many lines as planned");
        samples
    }
}

/// The inner lines of a spectrum under Hann's window, which is `(-1, 2, -1)/4` across the lines.
pub fn hann_lines(spectrum: &[Complex<f64>]) -> impl Iterator<Item = Complex<f64>> {
    let lines = spectrum.windows(3);
    lines.map(|around| around[1] * 0.5 - (around[0] + around[2]) * 0.25)
}

/// Power of the spectrum's lines under Hann's window, from the second one to the last but one; they add up to the mean
/// square of what lies in them. The mean is taken off before.
pub fn hann_powers(transform: &Forward, samples: &[f64]) -> Vec<f64> {
    let length = samples.len() as f64;
    let mut spectrum = transform.apply(samples.to_vec());
    spectrum[0] = Complex::default();
    // One-sided, and over the mean square of the window, 3/8.
    let scale = 2.0 / (0.375 * length * length);
    hann_lines(&spectrum)
        .map(|line| line.norm_sqr() * scale)
        .collect()
}

/// Whether a number's only prime factors are 2, 3 and 5: so many samples transform fast.
fn is_smooth(mut n: usize) -> bool {
    for prime in [2, 3, 5] {
        while n > 0 && n.is_multiple_of(prime) {
            n /= prime;
        }
    }
    n == 1
}

/// The smallest even number from `least` on whose only prime factors are 2, 3 and 5.
pub fn smooth_above(least: usize) -> usize {
    let mut even = (least.next_multiple_of(2)..).step_by(2);
    even.find(|n| is_smooth(*n)).unwrap_or(least)
}

/// The largest even number up to `most` whose only prime factors are 2, 3 and 5; 0 where there is none.
pub fn smooth_below(most: usize) -> usize {
    let mut even = (2..=most).rev().filter(|n| n.is_multiple_of(2));
    even.find(|n| is_smooth(*n)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_return_n_times_from_their_lines_at_even_and_odd_lengths() {
        for length in [6, 7] {
            let samples: Vec<f64> = (0..length).map(|i| f64::from(i * i % 5)).collect();
            let mut plans = Plans::default();
            let lines = plans.forward(samples.len()).apply(samples.clone());
            assert!((lines[0].re - samples.iter().sum::<f64>()).abs() < 1e-12);
            let back = plans.backward(samples.len()).apply(lines);
            for (x, y) in samples.iter().zip(back) {
                assert!((f64::from(length) * x - y).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn smooth_numbers_lie_next_to_any_other() {
        assert_eq!([smooth_below(1022), smooth_above(1022)], [1000, 1024]);
        assert_eq!([smooth_below(960), smooth_above(960)], [960, 960]);
        assert_eq!(smooth_below(1), 0);
    }
}
