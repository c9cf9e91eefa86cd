//! Pairs of channels: whether they move together, which follows, and force over acceleration.

use super::signal::{Signal, decibel};
use super::spectra::{Spectra, Spectrum};
use crate::gap::cell::Statistic;
use crate::gap::readings::Readings;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Pairs that rig, sensor or ground couple.
const PAIRS: [(&str, &str); 7] = [
    ("acceleration_y", "normal_force"),
    ("normal_force", "drawbar_pull"),
    ("normal_force", "driving_torque"),
    ("drawbar_pull", "driving_torque"),
    ("normal_force", "sinkage"),
    ("slip_ratio", "drawbar_pull"),
    ("slip_ratio", "driving_torque"),
];
/// Lines over which a coherence is taken.
const BLOCK: usize = 16;
/// Blocks below which there is none.
const FEWEST_BLOCKS: usize = 3;
/// Highest frequency [Hz] used: above it sensor dynamics dominate.
const HIGHEST: f64 = 200.0;

/// Channels that a channel is paired with.
pub(super) fn partners(name: &str) -> impl Iterator<Item = &'static str> {
    PAIRS
        .into_iter()
        .filter_map(move |(first, second)| match name {
            _ if name == first => Some(second),
            _ if name == second => Some(first),
            _ => None,
        })
}

pub(super) fn read(
    signals: &[Signal],
    spectra: &[Option<Spectrum>],
    plans: &mut Spectra,
    readings: &mut Readings,
) {
    let place = |name: &str| signals.iter().position(|signal| &*signal.name == name);
    for (first, second) in PAIRS {
        let (Some(a), Some(b)) = (place(first), place(second)) else {
            continue;
        };
        let name: Arc<str> = Arc::from(format!("{first}~{second}"));
        let (one, other) = (&signals[a], &signals[b]);
        if same_times(one, other) {
            if let (Some(x), Some(y)) = (&spectra[a], &spectra[b]) {
                read_pair(&name, x, y, readings);
            }
        } else if let Some([x, y]) = on_one_grid(one, other, plans) {
            read_pair(&name, &x, &y, readings);
        }
    }
}

fn same_times(one: &Signal, other: &Signal) -> bool {
    let apart = (one.start - other.start).abs() * one.rate;
    one.rate == other.rate && one.whole.len() == other.whole.len() && apart < 1.0e-3
}

/// Spectra of the time both share, at the slower rate; the faster is averaged over its period.
fn on_one_grid(one: &Signal, other: &Signal, plans: &mut Spectra) -> Option<[Spectrum; 2]> {
    let rate = one.rate.min(other.rate);
    let end = |signal: &Signal| signal.start + signal.whole.len() as f64 / signal.rate;
    let from = one.start.max(other.start);
    let count = ((end(one).min(end(other)) - from) * rate).floor().max(0.0) as usize;
    let resampled = |signal: &Signal| -> Vec<f64> {
        let edge = |i: usize| {
            let place = (from - signal.start + i as f64 / rate) * signal.rate;
            (place.round().max(0.0) as usize).min(signal.whole.len())
        };
        (0..count)
            .map_while(|i| {
                let part = signal.whole.get(edge(i)..edge(i + 1).max(edge(i) + 1))?;
                Some(part.iter().sum::<f64>() / part.len() as f64)
            })
            .collect()
    };
    let (mut x, mut y) = (resampled(one), resampled(other));
    let shared = x.len().min(y.len());
    x.truncate(shared);
    y.truncate(shared);
    Some([plans.of_samples(&x, rate)?, plans.of_samples(&y, rate)?])
}

/// Powers of both and cross power in a block of lines.
struct Block {
    frequency: f64,
    xx: f64,
    yy: f64,
    xy: Complex<f64>,
}

fn read_pair(name: &Arc<str>, x: &Spectrum, y: &Spectrum, readings: &mut Readings) {
    let blocks = blocks(x, y);
    if blocks.len() < FEWEST_BLOCKS {
        return;
    }
    let sum = |of: &dyn Fn(&Block) -> f64| blocks.iter().map(of).sum::<f64>();
    let [xx, yy, cross] = [
        sum(&|block| block.xx),
        sum(&|block| block.yy),
        sum(&|block| block.xy.re),
    ];
    let correlation = cross / libm::sqrt(xx * yy);
    readings.note(name, Statistic::Correlation, atanh(correlation));
    let square = |block: &Block| block.xy.norm_sqr() / (block.xx * block.yy);
    let coherence = libm::sqrt(sum(&square) / blocks.len() as f64);
    readings.note(name, Statistic::Coherence, atanh(coherence));
    let (lag, period) = lag(&blocks);
    readings.note_of_size(name, Statistic::Lag, lag, period);
    if name.as_ref() == "acceleration_y~normal_force" {
        let force = sum(&|block| libm::sqrt(block.xy.norm_sqr()));
        readings.note(name, Statistic::ApparentMass, decibel(force / xx));
    }
}

fn blocks(x: &Spectrum, y: &Spectrum) -> Vec<Block> {
    let chunks = x.lines.chunks_exact(BLOCK).zip(y.lines.chunks_exact(BLOCK));
    let all = chunks.enumerate().map(|(number, (of_x, of_y))| {
        let block = Block::of(of_x, of_y);
        Block {
            frequency: ((number * BLOCK + 1) as f64 + block.frequency) * x.spacing,
            ..block
        }
    });
    all.filter(|block| block.frequency.is_finite())
        .take_while(|block| block.frequency <= HIGHEST)
        .collect()
}

impl Block {
    /// A block whose frequency is in lines from its first.
    fn of(x: &[Complex<f64>], y: &[Complex<f64>]) -> Self {
        let products: Vec<Complex<f64>> = x.iter().zip(y).map(|(x, y)| x.conj() * y).collect();
        let (mut place, mut weight) = (0.0, 0.0);
        for (line, product) in products.iter().enumerate() {
            let strength = libm::sqrt(product.norm_sqr());
            place += strength * line as f64;
            weight += strength;
        }
        Self {
            // Where the cross power lies: a phase belongs to the frequency that bears it.
            frequency: place / weight,
            xx: x.iter().map(Complex::norm_sqr).sum(),
            yy: y.iter().map(Complex::norm_sqr).sum(),
            xy: products.iter().sum(),
        }
    }
}

/// Time [s] by which the second follows the first, from the slope of the cross spectrum's phase,
/// and the period [s] of the frequencies behind it. An opposite sign is no lag: phases count
/// within a quarter of a turn of 0 or of half a turn.
fn lag(blocks: &[Block]) -> (f64, f64) {
    let (mut product, mut square, mut weight) = (0.0, 0.0, 0.0);
    for Block { frequency, xy, .. } in blocks {
        let strength = libm::sqrt(xy.norm_sqr());
        let sign = if xy.re < 0.0 { -1.0 } else { 1.0 };
        let phase = libm::atan2(sign * xy.im, sign * xy.re);
        let omega = TAU * frequency;
        product += strength * phase * omega;
        square += strength * omega * omega;
        weight += strength;
    }
    (-product / square, TAU / libm::sqrt(square / weight))
}

/// Inverse hyperbolic tangent, of what is 1 up to rounding a large number.
fn atanh(value: f64) -> f64 {
    libm::atanh(value.clamp(-1.0 + 1.0e-9, 1.0 - 1.0e-9))
}
