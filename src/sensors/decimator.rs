//! From the sensor rate down to the output rate, without aliases.

use super::fir::{dot, low_pass, padded};
use super::stages::{Stage, Stages};
use crate::quantity::{RangeError, SampleRate};

/// Depth [dB] to which each stage is designed; 80 dB is promised of the whole.
const ATTENUATION: f64 = 92.0;
/// Edge of the flat band in output rates.
const PASS: f64 = 0.4;
/// Edge of the stop band in output rates: the output's Nyquist frequency.
const STOP: f64 = 0.5;

/// Lowers the rate of a stream by a whole factor, in stages of linear phase.
///
/// Flat to 0.1 dB up to 0.4 of the output rate; everything above half of the output rate, that is
/// everything that could alias, comes out at least 80 dB down. The delay of the filters is taken
/// back: output `k` sits at the time of input `k · factor`. Beyond the ends the first and last
/// values are held.
pub struct Decimator {
    stages: Stages<LowPass>,
}

impl Decimator {
    /// # Errors
    /// `RangeError` where `output` does not divide `input`.
    pub fn new(input: SampleRate, output: SampleRate) -> Result<Self, RangeError> {
        let factor = whole_ratio("output rate", output, "input rate", input)?;
        let mut rate = f64::from(factor);
        let stages = factors(factor).into_iter().map(|factor| {
            let band = [PASS / rate, (rate / f64::from(factor) - STOP) / rate];
            rate /= f64::from(factor);
            LowPass::new(factor, low_pass(band, ATTENUATION))
        });
        Ok(Self::of_stages(stages.collect()))
    }

    /// Takes every `factor`-th sample without a filter, so that frequencies above the output's Nyquist
    /// frequency alias.
    pub(super) fn without_filter(factor: u32) -> Self {
        Self::of_stages(vec![LowPass::new(factor, vec![1.0])])
    }

    /// Keeps the mean over `factor` samples about every `factor`-th, which leaves a fifth of what lies
    /// one and a half output rates high.
    pub(super) fn by_mean(factor: u32) -> Self {
        let width = factor | 1;
        let taps = vec![1.0 / f64::from(width); width as usize];
        Self::of_stages(vec![LowPass::new(factor, taps)])
    }

    fn of_stages(stages: Vec<LowPass>) -> Self {
        Self {
            stages: Stages::new(stages),
        }
    }

    /// Takes samples and appends the outputs that they complete to `out`.
    pub fn push(&mut self, block: &[f64], out: &mut Vec<f64>) {
        self.stages.push(block, out);
    }

    /// Appends the remaining outputs.
    pub fn finish(self, out: &mut Vec<f64>) {
        self.stages.finish(out);
    }
}

/// How many times `slow` goes into `fast`.
///
/// # Errors
/// `RangeError` where it does not, with the nearest rates that do.
pub(super) fn whole_ratio(
    quantity: &'static str,
    slow: SampleRate,
    of: &str,
    fast: SampleRate,
) -> Result<u32, RangeError> {
    if fast.whole().is_multiple_of(slow.whole()) {
        return Ok(fast.whole() / slow.whole());
    }
    let mut divisors: Vec<u32> = (1..=fast.whole())
        .filter(|d| fast.whole().is_multiple_of(*d))
        .collect();
    divisors.sort_by_key(|d| d.abs_diff(slow.whole()));
    divisors.truncate(2);
    let ways_out: Vec<String> = divisors.iter().map(u32::to_string).collect();
    Err(RangeError {
        quantity,
        unit: "Hz",
        range: format!(
            "divide the {of} {} Hz; use {}",
            fast.whole(),
            ways_out.join(" or ")
        ),
        value: slow.hertz(),
    })
}

/// Factors of the stages, largest first: the early ones, where samples are many, then get short
/// filters, and the steep one runs last. Pairs of twos make a stage of four.
fn factors(mut n: u32) -> Vec<u32> {
    let mut found = Vec::new();
    for divisor in [4, 2].into_iter().chain((3..).step_by(2)) {
        if n == 1 {
            break;
        }
        while n.is_multiple_of(divisor) {
            found.push(divisor);
            n /= divisor;
        }
    }
    found.sort_unstable_by(|a, b| b.cmp(a));
    found
}

/// One filter and the choice of every `factor`-th of its outputs.
struct LowPass {
    factor: usize,
    taps: Vec<f64>,
    buffer: Vec<f64>,
    /// Where in the buffer the next window begins; may lie beyond its end.
    next: usize,
    received: usize,
    produced: usize,
}

impl LowPass {
    fn new(factor: u32, taps: Vec<f64>) -> Self {
        Self {
            factor: factor as usize,
            buffer: vec![0.0; taps.len() / 2],
            taps: padded(taps),
            next: 0,
            received: 0,
            produced: 0,
        }
    }

    fn settle(&mut self, limit: usize, out: &mut Vec<f64>) {
        while self.produced < limit && self.next + self.taps.len() <= self.buffer.len() {
            out.push(dot(&self.taps, &self.buffer[self.next..]));
            self.next += self.factor;
            self.produced += 1;
        }
        let done = self.next.min(self.buffer.len());
        self.buffer.drain(..done);
        self.next -= done;
    }
}

impl Stage for LowPass {
    fn push(&mut self, block: &[f64], out: &mut Vec<f64>) {
        self.buffer.extend_from_slice(block);
        self.received += block.len();
        self.settle(usize::MAX, out);
    }

    fn finish(&mut self, out: &mut Vec<f64>) {
        let last = self.buffer.last().copied().unwrap_or(0.0);
        let limit = self.received.div_ceil(self.factor);
        let held = self.taps.len() + self.factor;
        while self.produced < limit {
            self.buffer.resize(self.buffer.len() + held, last);
            self.settle(limit, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::{amplitude, decibels, sine};
    use super::*;

    fn rate(hertz: u32) -> SampleRate {
        SampleRate::new(f64::from(hertz)).unwrap()
    }

    fn decimated(input: &[f64], mut decimator: Decimator) -> Vec<f64> {
        let mut out = Vec::new();
        for block in input.chunks(1000) {
            decimator.push(block, &mut out);
        }
        decimator.finish(&mut out);
        out
    }

    /// Level [dB] at which a tone of `frequency` [output rates] comes out, wherever it comes out.
    fn level(factor: u32, frequency: f64) -> f64 {
        let input = sine(frequency / f64::from(factor), 1200 * factor as usize);
        let decimator = Decimator::new(rate(factor * 100), rate(100)).unwrap();
        let out = decimated(&input, decimator);
        decibels(amplitude(&out[300..900], frequency))
    }

    #[test]
    fn tones_are_flat_to_a_tenth_of_a_decibel_up_to_four_tenths_of_the_output_rate() {
        for factor in [2, 3, 5, 16, 50, 64] {
            for step in 0..=16 {
                let frequency = 0.4 * f64::from(step) / 16.0 + 1e-3;
                let found = level(factor, frequency.min(0.4));
                assert!(found.abs() < 0.1, "{factor}, {frequency}: {found} dB");
            }
        }
    }

    #[test]
    fn nothing_above_the_outputs_nyquist_frequency_aliases_above_minus_80_db() {
        for factor in [2, 5, 16, 50, 64] {
            // Just above Nyquist, then around every multiple of the output rate, where aliases of
            // the flat band come from.
            let around =
                (1..=factor / 2).flat_map(|k| [-0.43, -0.31, 0.07, 0.23].map(|d| f64::from(k) + d));
            let top = f64::from(factor) / 2.0;
            for frequency in [0.501, 0.53].into_iter().chain(around).filter(|f| *f < top) {
                let found = level(factor, frequency);
                assert!(found < -80.0, "{factor}, {frequency}: {found} dB");
            }
        }
    }

    #[test]
    fn output_k_sits_at_the_time_of_input_k_times_the_factor() {
        let input = sine(0.2 / 64.0, 64 * 600);
        let out = decimated(&input, Decimator::new(rate(128_000), rate(2_000)).unwrap());
        assert_eq!(out.len(), 600);
        for k in 200..400 {
            // 1e-3 is a thousandth of an output sample's phase; the ripple allows 1e-4.
            assert!((out[k] - input[64 * k]).abs() < 2e-4, "sample {k}");
        }
    }

    #[test]
    fn ends_are_held_and_every_length_gives_one_output_per_started_factor() {
        for length in [1, 2, 63, 64, 65, 1000, 5000] {
            let decimator = Decimator::new(rate(128_000), rate(2_000)).unwrap();
            let out = decimated(&vec![9.81; length], decimator);
            assert_eq!(out, vec![9.81; length.div_ceil(64)]);
        }
    }

    #[test]
    fn without_a_filter_a_tone_above_nyquist_aliases_at_full_level() {
        let input = sine(1.2 / 64.0, 64 * 1200);
        let out = decimated(&input, Decimator::without_filter(64));
        assert_eq!(out[7], input[7 * 64]);
        assert!(decibels(amplitude(&out[300..900], 0.2)).abs() < 0.01);
    }

    #[test]
    fn factors_multiply_to_the_whole_and_fall() {
        assert_eq!(factors(64), [4, 4, 4]);
        assert_eq!(factors(50), [5, 5, 2]);
        assert_eq!(factors(32), [4, 4, 2]);
        assert_eq!(factors(1), [0; 0]);
    }
}
