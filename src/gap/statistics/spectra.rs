//! Spectra of steady signals and their power in fixed bands.

use super::signal::{Signal, mean};
use crate::gap::cell::{Statistic, centre};
use crate::gap::readings::Readings;
use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// Thirds of an octave by number, from 1 Hz to 50 kHz.
const THIRDS: std::ops::RangeInclusive<i16> = 0..=47;
/// Lines of a third below which its level is chance.
const FEWEST_LINES: usize = 4;
/// Least number of lines in a third octave for a median as background.
const FEWEST_FOR_MEDIAN: usize = 10;

/// Caches the plans of Fourier transforms.
#[derive(Default)]
pub(super) struct Spectra {
    planner: Option<RealFftPlanner<f64>>,
    plans: Vec<(usize, Arc<dyn RealToComplex<f64>>)>,
}

/// The spectrum of a steady signal under a Hann window, without its mean.
pub(super) struct Spectrum {
    /// Lines from the second on; powers add up to the mean square.
    pub lines: Vec<Complex<f64>>,
    /// Distance of the lines [Hz].
    pub spacing: f64,
}

impl Spectra {
    /// None of a signal with too many gaps, or that does not vary.
    pub fn of(&mut self, signal: &Signal) -> Option<Spectrum> {
        self.of_samples(&signal.whole, signal.rate)
    }

    /// The spectrum of these samples; of so many of them as transform fast.
    pub fn of_samples(&mut self, samples: &[f64], rate: f64) -> Option<Spectrum> {
        let length = smooth(samples.len());
        if length < 32 {
            return None;
        }
        let samples = &samples[samples.len() - length..];
        let average = mean(samples);
        let mut input: Vec<f64> = samples.iter().map(|x| x - average).collect();
        let largest = input.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        if largest <= 1.0e-12 * average.abs() || !largest.is_finite() {
            return None;
        }
        let plan = self.plan(length);
        let mut spectrum = plan.make_output_vec();
        plan.process(&mut input, &mut spectrum)
            .expect("lengths are the plan's");
        // One-sided, and over the root mean square of the window, √(3/8).
        let scale = libm::sqrt(2.0 / 0.375) / length as f64;
        let hann = spectrum
            .windows(3)
            .map(|around| (around[1] * 0.5 - (around[0] + around[2]) * 0.25) * scale);
        Some(Spectrum {
            lines: hann.collect(),
            spacing: rate / length as f64,
        })
    }

    fn plan(&mut self, length: usize) -> Arc<dyn RealToComplex<f64>> {
        if let Some((_, plan)) = self.plans.iter().find(|(of, _)| *of == length) {
            return Arc::clone(plan);
        }
        let planner = self.planner.get_or_insert_with(RealFftPlanner::new);
        let plan = planner.plan_fft_forward(length);
        self.plans.push((length, Arc::clone(&plan)));
        plan
    }
}

/// The largest even number up to `length` whose only prime factors are 2, 3 and 5.
fn smooth(length: usize) -> usize {
    let is_smooth = |mut n: usize| {
        for prime in [2, 3, 5] {
            while n > 0 && n.is_multiple_of(prime) {
                n /= prime;
            }
        }
        n == 1
    };
    let mut even = (2..=length).rev().filter(|n| n.is_multiple_of(2));
    even.find(|n| is_smooth(*n)).unwrap_or(0)
}

impl Spectrum {
    /// Reads the levels of thirds of an octave, and their highest lines.
    pub fn read(&self, signal: &Signal, readings: &mut Readings) {
        let channel = &signal.name;
        let mut powers: Vec<f64> = self.lines.iter().map(Complex::norm_sqr).collect();
        for third in THIRDS {
            let [from, to] = [-0.5, 0.5].map(|half| {
                let edge = centre(third) * libm::pow(10.0, 0.1 * half);
                (edge / self.spacing - 1.0).ceil().max(0.0) as usize
            });
            if to > powers.len() {
                return;
            }
            let lines = &mut powers[from..to];
            if lines.len() < FEWEST_LINES {
                continue;
            }
            let level = signal.level(libm::sqrt(lines.iter().sum()));
            readings.note(channel, Statistic::Band(third), level);
            if lines.len() >= FEWEST_FOR_MEDIAN {
                let middle = lines.len() / 2;
                let (_, median, above) = lines.select_nth_unstable_by(middle, f64::total_cmp);
                let highest = above.iter().fold(*median, |most, line| most.max(*line));
                let [median, highest] =
                    [*median, highest].map(|power| signal.level(libm::sqrt(power)));
                readings.note(channel, Statistic::Line(third), highest - median);
            }
        }
    }
}
