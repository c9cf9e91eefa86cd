//! Spectra of steady signals and their power in fixed bands.

use super::signal::{Signal, mean};
use crate::gap::cell::{Statistic, centre};
use crate::gap::readings::Readings;
use crate::signal::{Plans, hann_lines, smooth_below};
use realfft::num_complex::Complex;

/// Thirds of an octave by number, from 1 Hz to 50 kHz.
const THIRDS: std::ops::RangeInclusive<i16> = 0..=47;
/// Lines of a third below which its level is chance.
const FEWEST_LINES: usize = 4;
/// Least number of lines in a third octave for a median as background.
const FEWEST_FOR_MEDIAN: usize = 10;

/// Spectra of signals, their transforms planned once.
#[derive(Default)]
pub(super) struct Spectra {
    plans: Plans,
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
        let length = smooth_below(samples.len());
        if length < 32 {
            return None;
        }
        let samples = &samples[samples.len() - length..];
        let average = mean(samples);
        let input: Vec<f64> = samples.iter().map(|x| x - average).collect();
        let largest = input.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        if largest <= 1.0e-12 * average.abs() || !largest.is_finite() {
            return None;
        }
        let spectrum = self.plans.forward(length).apply(input);
        // One-sided, and over the root mean square of the window, √(3/8).
        let scale = libm::sqrt(2.0 / 0.375) / length as f64;
        let lines = hann_lines(&spectrum).map(|line| line * scale);
        Some(Spectrum {
            lines: lines.collect(),
            spacing: rate / length as f64,
        })
    }
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
