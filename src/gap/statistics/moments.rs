//! Statistics of the samples of one channel, and how they change along the run.

use super::signal::{Signal, decibel, mean, mean_square, straight_line, sum};
use crate::gap::cell::Statistic;
use crate::gap::readings::Readings;
use crate::trace::Trace;

/// Samples that are the same, or at the rail, by chance.
const CHANCE: usize = 5;
/// Share of the range [-] within which a sample is at the rail.
const RAIL: f64 = 0.01;
/// Quantile of the steps used as the smallest, robust to single ones.
const SMALL_STEPS: usize = 20;

pub(super) fn read(signal: &Signal, trace: &Trace, readings: &mut Readings) {
    let samples = &signal.measured[..];
    let name = &signal.name;
    let average = mean(samples);
    let deviation = libm::sqrt(mean_square(samples, average));
    let size = libm::hypot(average, deviation);
    if name.as_ref() == "acceleration_y" {
        readings.note_of_size(name, Statistic::Mean, average, size);
    }
    readings.note(name, Statistic::Deviation, signal.level(deviation));
    // What varies by its rounding only has no shape.
    if deviation <= signal.floor {
        return;
    }
    shape(signal, [average, deviation], readings);
    steps(signal, readings);
    let quarter = samples.len() / 4;
    let drift = mean(&samples[samples.len() - quarter..]) - mean(&samples[..quarter]);
    readings.note_of_size(name, Statistic::Drift, drift, size);
    if !signal.opening.is_empty() {
        let start = mean(&signal.opening) - average;
        readings.note_of_size(name, Statistic::Transient, start, size);
    }
    history(signal, size, trace, readings);
}

fn shape(signal: &Signal, [average, deviation]: [f64; 2], readings: &mut Readings) {
    let count = signal.measured.len() as f64;
    let scaled = |x: f64| (x - average) / deviation;
    let moment = |of: fn(f64) -> f64| sum(&signal.measured, |x| of(scaled(x))) / count;
    let third = moment(|d| d * d * d);
    let fourth = moment(|d| d * d * d * d);
    let [low, high] = range(&signal.measured);
    let crest = scaled(high).max(-scaled(low));
    let name = &signal.name;
    // A cube root: the skewness of impacts spans decades.
    readings.note(name, Statistic::Skewness, libm::cbrt(third));
    readings.note(name, Statistic::Kurtosis, libm::log(fourth));
    readings.note(name, Statistic::Crest, decibel(crest));
}

/// Least and greatest of numbers.
fn range(samples: &[f64]) -> [f64; 2] {
    let bounds = [f64::INFINITY, f64::NEG_INFINITY];
    samples
        .iter()
        .fold(bounds, |[low, high], x| [low.min(*x), high.max(*x)])
}

fn steps(signal: &Signal, readings: &mut Readings) {
    let samples = &signal.measured;
    let name = &signal.name;
    let mut steps: Vec<f64> = samples
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    let all = steps.len();
    steps.retain(|step| *step > 0.0);
    readings.note(name, Statistic::Held, share_level(all - steps.len(), all));
    if !steps.is_empty() {
        let place = steps.len() / SMALL_STEPS;
        let (_, step, _) = steps.select_nth_unstable_by(place, f64::total_cmp);
        readings.note(name, Statistic::Step, signal.level(*step));
    }
    let [low, high] = range(samples);
    let reach = RAIL * (high - low);
    let rails = samples
        .iter()
        .filter(|x| **x < low + reach || **x > high - reach);
    readings.note(
        name,
        Statistic::Rails,
        share_level(rails.count(), samples.len()),
    );
}

/// 10 lg of a share, with a few samples and a thousandth added: fewer are chance, and none is no
/// infinity.
fn share_level(count: usize, of: usize) -> f64 {
    10.0 * libm::log10((count + CHANCE) as f64 / of as f64 + 1.0e-3)
}

fn history(signal: &Signal, size: f64, trace: &Trace, readings: &mut Readings) {
    let samples = &signal.measured;
    let (first, second) = samples.split_at(samples.len() / 2);
    let level = |half: &[f64]| signal.level(libm::sqrt(mean_square(half, mean(half))));
    readings.note(
        &signal.name,
        Statistic::Growth,
        level(second) - level(first),
    );
    let speed = trace
        .steady_mean("forward_speed")
        .unwrap_or(trace.attributes.speed)
        .abs();
    // A wheel that spins in place makes no way.
    if speed > 0.0 && !signal.whole.is_empty() {
        let [_, slope] = straight_line(&signal.whole);
        let per_metre = slope * signal.rate / speed;
        let way = signal.whole.len() as f64 / signal.rate * speed;
        readings.note_of_size(&signal.name, Statistic::PerMetre, per_metre, size / way);
    }
}
