//! Detection of motion and rest of the wheel in a run.
//!
//! A wheel at rest has no slip: rim speed and forward speed are both zero, and their ratio is noise or
//! rounding. Averages over a drive exclude its rests.

use super::encoder::between_steps;
use super::knots::interpolated;
use super::turning::unwrapped;
use super::{Channel, Trace};
use crate::statistics::finite_mean;

/// Length [s] of the blocks in which a wheel moves or rests: starting and stopping take as long.
const BLOCK: f64 = 0.5;

/// Way over that of the fastest block [-] below which a wheel rests: motors hold their speed to 1 %.
const REST: f64 = 0.01;

/// Way [m] of a whole run below which its wheel does not move at all: half a millimetre is what a
/// carriage's play and an encoder's step come to.
const STILL: f64 = 0.5e-3;

/// Samples [-] over which the trembling of an encoder at rest is averaged.
const TREMBLES: usize = 4;

/// Slip [-] up to which a wheel may stand on the command alone while the other channel is not known: with more
/// it spins in place or is dragged.
const ROLLS: f64 = 0.9;

/// The blocks of a run, and whether the wheel moves in them.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Time [s] at which the first block begins.
    start: f64,
    moves: Vec<bool>,
}

impl Motion {
    /// When the wheel moves, by its angle and forward speed; always where neither of them is measured.
    pub fn of(trace: &Trace) -> Self {
        let starts = trace.channels.iter().map(|channel| channel.start);
        let start = starts.reduce(f64::min).unwrap_or(0.0);
        let count = (trace.duration() / BLOCK).ceil().clamp(1.0, 1.0e7) as usize;
        let always = Self {
            start,
            moves: vec![true; count],
        };
        let rim = trace.channel("wheel_angle").map(|angle| {
            let radius = trace.attributes.wheel_radius;
            // A rover wheel's, where it is unknown.
            let radius = if radius > 0.0 { radius } else { 0.1 };
            let angle = turned(angle);
            let angle = Channel {
                samples: between_steps(&angle.samples),
                ..angle
            };
            (
                always.turned_ways(&angle, radius),
                radius * finest_step(&angle),
            )
        });
        let tremble = rim.as_ref().map_or(0.0, |(_, step)| 1.01 * step);
        let rim = rim.map(|(ways, _)| ways);
        let forward = trace
            .channel("forward_speed")
            .map(|speed| always.ways(speed));
        let slips = trace.attributes.slip_ratio.abs() > ROLLS;
        let ways: Vec<Vec<f64>> = match (rim, forward) {
            (Some(rim), Some(forward)) => vec![rim, forward],
            (Some(one), None) | (None, Some(one)) if !slips => vec![one],
            _ => return always,
        };
        let moves_at_all = ways.iter().any(|ways| excursion(ways) > STILL);
        let way = |block: usize| {
            ways.iter()
                .map(|ways| ways[block].abs())
                .fold(0.0, f64::max)
        };
        let fastest = (0..count).map(way).fold(0.0, f64::max);
        let least = (REST * fastest).max(tremble.min(0.25 * fastest));
        let moves = (0..count).map(|block| moves_at_all && way(block) > least);
        Self {
            start,
            moves: without_starts_and_stops(&moves.collect::<Vec<bool>>()),
        }
    }

    /// Way [m] of the rim in each block: between the angles at its ends, which a slow log has beyond them.
    fn turned_ways(&self, angle: &Channel, radius: f64) -> Vec<f64> {
        let mut numbers = numbers_over_time(angle);
        // The last sample stands for its period, as all others do.
        if let [.., [_, before], [time, last]] = numbers[..] {
            numbers.push([time + 1.0 / angle.sample_rate, 2.0 * last - before]);
        }
        let at = |time: f64| interpolated(&numbers, time);
        // An encoder at rest trembles: of the first and the last quarter of a block the means count.
        let quarter = |from: f64| {
            let samples = angle.between(from, from + 0.25 * BLOCK);
            finite_mean(samples).filter(|_| samples.len() >= TREMBLES)
        };
        let way = |index: usize| {
            let start = self.start + BLOCK * index as f64;
            let turned = match (quarter(start), quarter(start + 0.75 * BLOCK)) {
                (Some(first), Some(last)) => (last - first) / 0.75,
                _ => at(start + BLOCK) - at(start),
            };
            radius * turned
        };
        (0..self.moves.len()).map(way).collect()
    }

    /// Way [m] in each block by the mean of its speeds [m/s]; where it has none, by those before and after it.
    fn ways(&self, speed: &Channel) -> Vec<f64> {
        let numbers = numbers_over_time(speed);
        let of_block = |index: usize| {
            let start = self.start + BLOCK * index as f64;
            let within = speed.between(start, start + BLOCK);
            let mean = finite_mean(within);
            let mean = mean.unwrap_or_else(|| interpolated(&numbers, start + 0.5 * BLOCK));
            mean * BLOCK
        };
        (0..self.moves.len()).map(of_block).collect()
    }

    /// Whether the wheel moves at no time.
    pub fn is_rest(&self) -> bool {
        !self.moves.contains(&true)
    }

    /// Whether the wheel moves at `time` \[s\].
    pub fn moves_at(&self, time: f64) -> bool {
        let block = ((time - self.start) / BLOCK + 1.0e-9).max(0.0) as usize;
        self.moves[block.min(self.moves.len() - 1)]
    }

    /// The numbers of the steady part of `channel` in which the wheel moves, or of all of it where it moves
    /// in none of that part.
    pub fn steady(&self, channel: &Channel) -> Vec<f64> {
        let quarter = channel.samples.len() / 4;
        let moving = |range: std::ops::Range<usize>| -> Vec<f64> {
            let indices = range.filter(|&index| self.moves_at(channel.time(index)));
            indices
                .map(|index| channel.samples[index])
                .filter(|x| x.is_finite())
                .collect()
        };
        let steady = moving(quarter..channel.samples.len() - quarter);
        if steady.is_empty() {
            moving(0..channel.samples.len())
        } else {
            steady
        }
    }

    /// Mean of [`steady`](Self::steady); `None` where the wheel never moves or there are no numbers.
    pub fn steady_mean(&self, channel: &Channel) -> Option<f64> {
        finite_mean(&self.steady(channel))
    }
}

/// The blocks in which a wheel moves all the time: those beside a rest hold its start or stop, and count where
/// there are no others.
fn without_starts_and_stops(moves: &[bool]) -> Vec<bool> {
    let at = |index: usize| moves.get(index).copied().unwrap_or(true);
    let within = |index: usize| at(index) && at(index.wrapping_sub(1)) && at(index + 1);
    let steadily: Vec<bool> = (0..moves.len()).map(within).collect();
    if steadily.contains(&true) {
        steadily
    } else {
        moves.to_vec()
    }
}

/// Smallest step [rad] of a wheel angle, by which it trembles at rest.
fn finest_step(angle: &Channel) -> f64 {
    let steps = angle
        .samples
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs());
    let finest = steps
        .filter(|&step| step > 0.0)
        .fold(f64::INFINITY, f64::min);
    if finest.is_finite() { finest } else { 0.0 }
}

/// How far [m] the ways of all blocks lead apart: an encoder that trembles leads nowhere.
fn excursion(ways: &[f64]) -> f64 {
    let mut place = 0.0;
    let [mut low, mut high] = [0.0_f64; 2];
    for way in ways {
        place += way;
        low = low.min(place);
        high = high.max(place);
    }
    high - low
}

/// Times [s] and values of the samples that are numbers.
fn numbers_over_time(channel: &Channel) -> Vec<[f64; 2]> {
    let samples = channel.samples.iter().enumerate();
    samples
        .filter(|(_, sample)| sample.is_finite())
        .map(|(index, &sample)| [channel.time(index), sample])
        .collect()
}

/// A wheel angle without the jumps of an encoder that starts again.
pub fn turned(wheel_angle: &Channel) -> Channel {
    Channel {
        samples: unwrapped(&wheel_angle.samples),
        ..wheel_angle.clone()
    }
}
