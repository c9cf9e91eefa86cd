//! What is locked to the turn of the wheel and to the passing of its lugs.

use super::signal::{Signal, bridged, mean, mean_square};
use crate::gap::cell::Statistic;
use crate::gap::readings::Readings;
use crate::quantity::SlipRatio;
use crate::trace::{Channel, Trace, turned_along};
use realfft::num_complex::Complex;
use std::f64::consts::TAU;
use std::ops::Range;

/// Places within a lug's pass at which the average is taken.
const PLACES: usize = 32;
/// Least number of lug passes to separate an average from the residual about it.
const FEWEST_PASSES: f64 = 3.0;

/// How the wheel of a run turned.
pub(super) struct Turning {
    angle: Channel,
    /// Whether the angle was measured, so that phases are known.
    has_phase: bool,
    lugs: u32,
    waves: Option<Waves>,
}

/// The turn under the samples of a channel, and waves of the orders over it; channels that are
/// sampled at the same times share it.
struct Waves {
    of: Sampling,
    /// Samples that cover whole turns, or otherwise whole lug passes.
    window: Range<usize>,
    /// Wheel angle [rad], sample by sample.
    angle: Vec<f64>,
    orders: Vec<(u32, Vec<Complex<f64>>)>,
}

/// Times of a channel's samples: bits of rate and start, and their number.
#[derive(Clone, Copy, PartialEq)]
struct Sampling {
    rate: u64,
    start: u64,
    length: usize,
}

impl Turning {
    /// From the wheel's unwrapped `angle`, where there is one. `None` where the rotation is unknown.
    pub fn of(trace: &Trace, angle: Option<Channel>) -> Option<Self> {
        // Without a count there are turns and no lug passes.
        let lugs = trace.attributes.lug_count.unwrap_or(0);
        let turning = |angle, has_phase| Self {
            angle,
            has_phase,
            lugs,
            waves: None,
        };
        match angle.and_then(measured) {
            Some(angle) => Some(turning(angle, true)),
            None => Some(turning(summed_up(trace)?, false)),
        }
    }

    /// Reads orders and lug passes of a signal.
    pub fn read(&mut self, signal: &Signal, readings: &mut Readings) {
        let samples = &signal.whole;
        if samples.is_empty() {
            return;
        }
        let key = Sampling {
            rate: signal.rate.to_bits(),
            start: signal.start.to_bits(),
            length: samples.len(),
        };
        if self.waves.as_ref().is_none_or(|waves| waves.of != key) {
            self.waves = self.waves(signal, key);
        }
        let Some(waves) = &self.waves else {
            return;
        };
        let window = &samples[waves.window.clone()];
        let average = mean(window);
        let size = libm::sqrt(mean_square(window, average));
        if size <= signal.floor {
            return;
        }
        for (order, wave) in &waves.orders {
            let scale = 2.0 / window.len() as f64;
            let parts = window
                .iter()
                .zip(wave)
                .map(|(x, wave)| wave * (x - average));
            let part = parts.sum::<Complex<f64>>() * scale;
            let level = signal.level(libm::sqrt(part.norm_sqr()));
            readings.note(&signal.name, Statistic::OrderLevel(*order), level);
            if self.has_phase {
                let cosine = Statistic::OrderCosine(*order);
                readings.note_of_size(&signal.name, cosine, part.re, size);
                let sine = Statistic::OrderSine(*order);
                readings.note_of_size(&signal.name, sine, part.im, size);
            }
        }
        if let Some([average, residue]) = self.lug_average(waves, samples) {
            readings.note(&signal.name, Statistic::LugAverage, signal.level(average));
            readings.note(&signal.name, Statistic::LugResidue, signal.level(residue));
        }
    }

    fn waves(&self, signal: &Signal, of: Sampling) -> Option<Waves> {
        if !covers(&self.angle, signal) {
            return None;
        }
        let times = (0..signal.whole.len()).map(|i| signal.start + i as f64 / signal.rate);
        let angle = angles_at(&self.angle, times);
        let turned = (angle[angle.len() - 1] - angle[0]).abs() / TAU;
        if !turned.is_finite() {
            return None;
        }
        let passes = turned * f64::from(self.lugs);
        // Whole turns contain whole waves of every order, whole passes those of the lugs' orders.
        let (unit, every) = if turned >= 1.0 {
            (TAU, true)
        } else if passes >= 1.0 {
            (TAU / f64::from(self.lugs), false)
        } else {
            return None;
        };
        let window = whole(&angle, unit);
        // Fewer than two samples in the shortest wave do not resolve it.
        let resolved = window.len() as f64 / turned / 2.5;
        let mut orders = orders(self.lugs, every);
        orders.retain(|order| f64::from(*order) < resolved);
        let waves = wave_table(&angle[window.clone()], &orders);
        Some(Waves {
            of,
            window,
            angle,
            orders: orders.into_iter().zip(waves).collect(),
        })
    }

    /// Effective values of the average over the lug's pass, and of what varies about it.
    fn lug_average(&self, waves: &Waves, samples: &[f64]) -> Option<[f64; 2]> {
        let lugs = f64::from(self.lugs);
        let turned = (waves.angle[samples.len() - 1] - waves.angle[0]).abs() / TAU;
        if turned * lugs < FEWEST_PASSES {
            return None;
        }
        let place = |angle: f64| {
            let pass = angle * lugs / TAU;
            (((pass - pass.floor()) * PLACES as f64) as usize).min(PLACES - 1)
        };
        let mut sums = [(0.0, 0_u32); PLACES];
        let places: Vec<usize> = waves.angle.iter().map(|angle| place(*angle)).collect();
        for (x, &at) in samples.iter().zip(&places) {
            sums[at] = (sums[at].0 + x, sums[at].1 + 1);
        }
        if sums.iter().any(|(_, count)| *count < 2) {
            return None;
        }
        let averages = sums.map(|(sum, count)| sum / f64::from(count));
        let residue = samples.iter().zip(&places).map(|(x, &at)| {
            let rest = x - averages[at];
            rest * rest
        });
        let residue = libm::sqrt(residue.sum::<f64>() / samples.len() as f64);
        let average = libm::sqrt(mean_square(&averages, mean(&averages)));
        Some([average, residue])
    }
}

/// The angle without gaps.
fn measured(angle: Channel) -> Option<Channel> {
    let samples = bridged(&angle.samples);
    let rate = angle.sample_rate;
    let known = samples.len() > 1 && samples[0].is_finite() && rate > 0.0 && rate.is_finite();
    known.then_some(Channel { samples, ..angle })
}

/// Orders to read: of whole turns all, else the lugs' only.
fn orders(lugs: u32, every: bool) -> Vec<u32> {
    let mut orders = match (lugs, every) {
        (0, _) => vec![1, 2, 3],
        (n, true) => vec![1, 2, 3, n - 1, n, n + 1, 2 * n, 3 * n],
        (n, false) => vec![n, 2 * n, 3 * n],
    };
    orders.retain(|order| *order > 0);
    orders.sort_unstable();
    orders.dedup();
    orders
}

/// `e^{i k θ}` of each order at each angle; orders that are sums of smaller ones by products, multiples of the
/// smallest by powers.
fn wave_table(angle: &[f64], orders: &[u32]) -> Vec<Vec<Complex<f64>>> {
    let mut known: Vec<(u32, Vec<Complex<f64>>)> = Vec::new();
    for &order in orders {
        let sum = known.iter().find_map(|(a, first)| {
            let rest = order - a;
            let (_, second) = known.iter().find(|(b, _)| *b == rest)?;
            Some(first.iter().zip(second).map(|(a, b)| a * b).collect())
        });
        let power = || {
            let (smallest, wave) = known.first()?;
            let times = order / smallest;
            let whole = order.is_multiple_of(*smallest);
            whole.then(|| wave.iter().map(|wave| wave.powu(times)).collect())
        };
        let wave = sum.or_else(power).unwrap_or_else(|| {
            let wave = |angle: &f64| {
                let (sine, cosine) = libm::sincos(f64::from(order) * angle);
                Complex::new(cosine, sine)
            };
            angle.iter().map(wave).collect()
        });
        known.push((order, wave));
    }
    known.into_iter().map(|(_, wave)| wave).collect()
}

/// Samples up to the last over which the wheel turned by whole units.
fn whole(angle: &[f64], unit: f64) -> Range<usize> {
    let turned = |i: usize| (angle[i] - angle[0]).abs();
    let last = turned(angle.len() - 1);
    let wanted = (last / unit).floor() * unit;
    let end = (0..angle.len())
        .rev()
        .take_while(|&i| turned(i) >= wanted)
        .last();
    0..end.unwrap_or(angle.len()).max(1)
}

/// Angle from speed and slip, as it comes to be; from the command where no speed was measured.
fn summed_up(trace: &Trace) -> Option<Channel> {
    let radius = trace.attributes.wheel_radius;
    let per_speed = SlipRatio::new(trace.slip())
        .ok()
        .and_then(|slip| slip.wheel_speed(radius, 1.0))
        .filter(|per_speed| radius > 0.0 && per_speed.is_finite())?;
    let speed = match trace.channel("forward_speed") {
        Some(channel) if channel.samples.iter().all(|v| v.is_finite()) => channel.clone(),
        _ => commanded(trace)?,
    };
    let steps = speed.samples.iter();
    let turned: f64 = steps.map(|v| v * per_speed / speed.sample_rate).sum();
    let turns = speed.samples.len() > 1 && turned.abs() > 0.0;
    turns.then(|| turned_along(&speed, per_speed))
}

/// The commanded speed as a channel over the run.
fn commanded(trace: &Trace) -> Option<Channel> {
    let longest = trace
        .channels
        .iter()
        .filter(|channel| channel.sample_rate > 0.0)
        .max_by(|a, b| a.duration().total_cmp(&b.duration()))?;
    let speed = trace.attributes.speed;
    speed.is_finite().then(|| Channel {
        samples: vec![speed; longest.samples.len()],
        ..longest.clone()
    })
}

/// Whether the angle is known at all times of a signal, up to a sample at either end.
fn covers(angle: &Channel, signal: &Signal) -> bool {
    let slack = 1.0 / angle.sample_rate + 1.0 / signal.rate;
    let end = signal.start + signal.whole.len() as f64 / signal.rate;
    angle.start <= signal.start + slack && angle.start + angle.duration() >= end - slack
}

/// Angles at `times` [s], between samples on straight lines, which go on at the ends.
fn angles_at(angle: &Channel, times: impl Iterator<Item = f64>) -> Vec<f64> {
    let last = angle.samples.len() - 2;
    let at = |time: f64| {
        let place = (time - angle.start) * angle.sample_rate;
        let before = (place.max(0.0) as usize).min(last);
        let [from, to] = [angle.samples[before], angle.samples[before + 1]];
        from + (to - from) * (place - before as f64)
    };
    times.map(at).collect()
}
