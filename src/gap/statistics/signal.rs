//! Preparation of a channel: its steady part, gaps interpolated, the wheel angle detrended.

use crate::trace::Channel;
use std::ops::Range;
use std::sync::Arc;

/// Samples in the steady part below which only a mean is computed.
const FEWEST: usize = 32;
/// Share of samples [-] that may be missing where their order matters.
const MISSING: f64 = 0.2;

/// Relative amplitude [-] at which a level is floored: 120 dB below the channel's size, where no sensor
/// resolves it and a simulation has only rounding.
const ROUNDING: f64 = 1.0e-6;

/// The steady part of a channel.
pub(super) struct Signal {
    /// The channel's name.
    pub name: Arc<str>,
    /// Samples per second [Hz].
    pub rate: f64,
    /// Time [s] of the first sample of the steady part.
    pub start: f64,
    /// The finite samples before the steady part.
    pub opening: Vec<f64>,
    /// The finite samples of the steady part, as measured.
    pub measured: Vec<f64>,
    /// The steady samples, gaps interpolated; empty where too many are missing.
    pub whole: Vec<f64>,
    /// Amplitude [own unit] below which everything is rounding: [`ROUNDING`] of the channel's size.
    pub floor: f64,
}

/// The run without its first and last tenth.
pub(super) fn settled(length: usize) -> Range<usize> {
    let tenth = length / 10;
    tenth..length - tenth
}

impl Signal {
    /// None where the channel is too short or has no rate. The wheel angle is one without jumps.
    pub fn of(channel: &Channel) -> Option<Self> {
        let rate = channel.sample_rate;
        if !(rate > 0.0 && rate.is_finite() && channel.start.is_finite()) {
            return None;
        }
        let turning;
        let samples = match channel.name.as_str() {
            "wheel_angle" => {
                turning = less_steady_turning(&channel.samples);
                &turning[..]
            }
            _ => &channel.samples[..],
        };
        let part = settled(samples.len());
        let numbers = |samples: &[f64]| -> Vec<f64> {
            let mut numbers = samples.to_vec();
            numbers.retain(|x| x.is_finite());
            numbers
        };
        let measured = numbers(&samples[part.clone()]);
        if measured.len() < FEWEST {
            return None;
        }
        let missing = part.len() - measured.len();
        let whole = if missing as f64 > MISSING * part.len() as f64 {
            Vec::new()
        } else {
            bridged(&samples[part.clone()])
        };
        // Of an angle less its turning the turn itself is the size.
        let size = match channel.name.as_str() {
            "wheel_angle" => 1.0,
            _ => libm::sqrt(mean_square(&measured, 0.0)),
        };
        Some(Self {
            floor: ROUNDING * size,
            name: Arc::from(channel.name.as_str()),
            rate,
            start: channel.time(part.start),
            opening: numbers(&samples[..part.start]),
            measured,
            whole,
        })
    }
}

/// The angle minus the straight line through its steady part.
fn less_steady_turning(angle: &[f64]) -> Vec<f64> {
    let part = settled(angle.len());
    let middle = 0.5 * (part.start + part.end) as f64;
    let [level, slope] = straight_line(&angle[part.clone()]);
    angle
        .iter()
        .enumerate()
        .map(|(i, x)| x - level - slope * (i as f64 + 0.5 - middle))
        .collect()
}

/// Mean, and slope per sample, of the numbers among `samples`.
pub(super) fn straight_line(samples: &[f64]) -> [f64; 2] {
    let middle = 0.5 * samples.len() as f64;
    let place = |i: usize| i as f64 + 0.5 - middle;
    let (mut count, mut places, mut values) = (0.0, 0.0, 0.0);
    let numbers = || samples.iter().enumerate().filter(|(_, x)| x.is_finite());
    for (i, x) in numbers() {
        count += 1.0;
        places += place(i);
        values += x;
    }
    let (centre, mean) = (places / count, values / count);
    let (mut square, mut product) = (0.0, 0.0);
    for (i, x) in numbers() {
        let away = place(i) - centre;
        square += away * away;
        product += away * (x - mean);
    }
    let slope = if square > 0.0 { product / square } else { 0.0 };
    [mean - slope * centre, slope]
}

/// Gaps on straight lines between their neighbours, at the ends as the next number.
pub(super) fn bridged(samples: &[f64]) -> Vec<f64> {
    let mut whole = samples.to_vec();
    if whole.iter().all(|x| x.is_finite()) {
        return whole;
    }
    let mut before: Option<usize> = None;
    for i in 0..whole.len() {
        if !whole[i].is_finite() {
            continue;
        }
        match before {
            None => {
                let first = whole[i];
                whole[..i].fill(first);
            }
            Some(last) => {
                let (from, step) = (whole[last], (whole[i] - whole[last]) / (i - last) as f64);
                for (place, sample) in whole[last + 1..i].iter_mut().enumerate() {
                    *sample = from + step * (place + 1) as f64;
                }
            }
        }
        before = Some(i);
    }
    if let Some(last) = before {
        let end = whole[last];
        whole[last + 1..].fill(end);
    }
    whole
}

/// Level [dB] of an amplitude; not finite where it is 0.
pub(super) fn decibel(amplitude: f64) -> f64 {
    20.0 * libm::log10(amplitude)
}

impl Signal {
    /// Level [dB] of an amplitude in the channel's unit, rounding added.
    pub fn level(&self, amplitude: f64) -> f64 {
        decibel(libm::hypot(amplitude, self.floor))
    }
}

/// Sums that are taken side by side: one alone waits for each addition to end.
const LANES: usize = 8;

/// Sum of a function of numbers.
pub(super) fn sum(samples: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let (chunks, rest) = samples.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for chunk in chunks {
        for lane in 0..LANES {
            lanes[lane] += of(chunk[lane]);
        }
    }
    lanes.iter().sum::<f64>() + rest.iter().map(|x| of(*x)).sum::<f64>()
}

/// Mean of numbers.
pub(super) fn mean(samples: &[f64]) -> f64 {
    sum(samples, |x| x) / samples.len() as f64
}

/// Mean square of `samples` about `centre`.
pub(super) fn mean_square(samples: &[f64], centre: f64) -> f64 {
    sum(samples, |x| (x - centre) * (x - centre)) / samples.len() as f64
}
