//! The impacts of a window over the turn of the wheel, however the wheel angle is zeroed.
//!
//! The vertical acceleration is low-passed and sorted into a fortieth of a lug pass each (a lug pass
//! is the turn from one lug straight down to the next). It is stated in pulses of the reference: what
//! the same low-pass makes of the velocity jump `Δv = 2 |ω| (r + l) sin(α/2)` of Eq. (10) at the
//! wheel's speed `ω` there,
//!
//! ```text
//! a_ref = Δv · f_c · √(2 π / ln 2)        f_c the low-pass' corner
//! ```
//!
//! Nothing here takes the zero of the wheel angle for known; where lugs strike is found by
//! [`super::rhythm`].

use super::record::{Record, Unusable};
use super::spectrum::Spectra;
use crate::statistics::{quantile_upper, sorted, upper_median};
use crate::vibration::reference::lug_changes;
use std::f64::consts::{LN_2, PI};
use std::ops::Range;

/// Corner [Hz] of the low-pass behind which impacts are measured: below the resonances of rigs,
/// above the lug-pass frequency of rovers.
const CORNER: f64 = 30.0;

/// Bins in a lug pass [-].
pub(super) const BINS: usize = 40;

/// Bins within which impacts are one: a quarter of a lug pass.
const ONE_IMPACT: usize = BINS / 4;

/// Time [s] at either end of a window that the low-pass, which goes on periodically, spoils.
const EDGE: f64 = 0.02;

/// Least wheel speed over its mean in the window [-] that pulses are stated by: a wheel that comes
/// to rest strikes nothing.
const SLOWEST: f64 = 0.25;

/// A normal distribution's standard deviation over its median deviation [-].
const PER_MEDIAN: f64 = 1.482_602_218_505_602;

/// The impacts of a window.
#[derive(Debug, Clone, PartialEq)]
pub struct Pulses {
    /// Largest upward acceleration in each bin, over the reference's pulse [-].
    pub(super) upward: Vec<f64>,
    /// Largest downward acceleration in each bin, over the same [-].
    pub(super) downward: Vec<f64>,
    /// Turn at the begin of the first bin [lug passes], growing whichever way the wheel turns.
    pub(super) begin: f64,
    /// 1 where the wheel angle grows, else -1.
    pub(super) direction: f64,
    /// Lug angle [rad].
    pub(super) lug_angle: f64,
    /// Where in a pass lugs strike flat hard ground [lug passes after straight down].
    pub(super) strikes: Vec<f64>,
    /// Mean wheel speed [rad/s], signed.
    pub wheel_speed: f64,
    /// Standard deviation of the vibration between pulses, over the reference's pulse [-].
    pub background: f64,
    /// Standard deviation of the sensor's noise, were it white, over the same [-].
    pub noise: f64,
    /// Fourth moment over the squared second one [-]: 3 for noise.
    pub kurtosis: f64,
}

/// The impacts within the samples `window`; see [`super::Extractor::pulses`].
pub(super) fn pulses(
    record: &Record,
    window: Range<usize>,
    spectra: &mut Spectra,
) -> Result<Option<Pulses>, Unusable> {
    record.usable(window.clone(), CORNER)?;
    let acceleration = &record.acceleration[window.clone()];
    let filtered = spectra.low_passed(acceleration, CORNER / record.sample_rate);
    let edge = (EDGE * record.sample_rate) as usize;
    let inner = edge..window.len().saturating_sub(edge).max(edge);
    let angles = &record.angle[window][inner.clone()];
    let Some(turn) = Turn::of(angles, record) else {
        return Ok(None);
    };
    let noise = low_passed_noise(acceleration, record.sample_rate);
    Ok(Some(turn.pulses(&filtered.samples()[inner], noise, record)))
}

/// The turn of the wheel in a window, by bins.
struct Turn {
    direction: f64,
    /// Number of the first whole bin, counted from a wheel angle of 0.
    first: f64,
    /// First sample of every whole bin, and of the one behind them.
    starts: Vec<usize>,
    sample_rate: f64,
    lug_angle: f64,
}

impl Turn {
    fn of(angles: &[f64], record: &Record) -> Option<Self> {
        let (begin, end) = (angles.first()?, angles.last()?);
        let direction = if end >= begin { 1.0 } else { -1.0 };
        let bin = |angle: f64| (direction * angle / record.lug_angle * BINS as f64).floor();
        let first = bin(*begin) + 1.0;
        let mut starts = Vec::new();
        for (sample, angle) in angles.iter().enumerate() {
            while first + starts.len() as f64 <= bin(*angle) {
                starts.push(sample);
            }
        }
        (starts.len() > 1).then_some(Self {
            direction,
            first,
            starts,
            sample_rate: record.sample_rate,
            lug_angle: record.lug_angle,
        })
    }

    /// Wheel speed [rad/s] in `bin`, averaged over a lug pass centred on it.
    fn speed(&self, bin: usize) -> f64 {
        let last = self.starts.len() - 1;
        self.speed_between(bin.saturating_sub(BINS / 2), (bin + BINS / 2).min(last))
    }

    fn speed_between(&self, from: usize, to: usize) -> f64 {
        let turned = (to - from) as f64 * self.lug_angle / BINS as f64;
        let samples = (self.starts[to] - self.starts[from]).max(1);
        turned * self.sample_rate / samples as f64
    }

    fn pulses(&self, filtered: &[f64], noise: f64, record: &Record) -> Pulses {
        let bins = self.starts.len() - 1;
        let mean_speed = self.speed_between(0, bins);
        let (strikes, jump_per_speed) = flat_hard_ground(record);
        let pulse_per_speed = jump_per_speed * CORNER * libm::sqrt(2.0 * PI / LN_2);
        let (mut upward, mut downward) = (vec![0.0_f64; bins], vec![0.0_f64; bins]);
        let mut scaled = Vec::with_capacity(filtered.len());
        for bin in 0..bins {
            let speed = self.speed(bin).max(SLOWEST * mean_speed);
            for a in &filtered[self.starts[bin]..self.starts[bin + 1]] {
                let a = a / (pulse_per_speed * speed);
                upward[bin] = upward[bin].max(a);
                downward[bin] = downward[bin].max(-a);
                scaled.push(a);
            }
        }
        let moment = |power: i32| {
            let powers = scaled.iter().map(|a| a.powi(power));
            powers.sum::<f64>() / scaled.len().max(1) as f64
        };
        let (square, fourth) = (moment(2), moment(4));
        let background = PER_MEDIAN * upper_median(scaled.iter().map(|a| a.abs())).unwrap_or(0.0);
        Pulses {
            upward,
            downward,
            begin: self.first / BINS as f64,
            direction: self.direction,
            lug_angle: self.lug_angle,
            strikes,
            wheel_speed: self.direction * mean_speed,
            background,
            noise: noise / (pulse_per_speed * mean_speed),
            kurtosis: fourth / (square * square),
        }
    }
}

/// Where in a pass lugs strike [lug passes after straight down], and the velocity jump per wheel
/// speed [m].
fn flat_hard_ground(record: &Record) -> (Vec<f64>, f64) {
    // One pass at 1 rad/s, finely: times are wheel angles.
    let steps = 100 * BINS;
    let step = record.lug_angle / steps as f64;
    let angles: Vec<f64> = (0..=steps).map(|i| i as f64 * step).collect();
    let changes = lug_changes(&record.wheel, &angles, 1.0 / step);
    let jump = changes.iter().map(|change| change.velocity_jump);
    let places = changes.iter().map(|change| change.time / record.lug_angle);
    (places.collect(), jump.fold(0.0, f64::max))
}

impl Pulses {
    /// Lug angle \[rad\].
    pub fn lug_angle(&self) -> f64 {
        self.lug_angle
    }

    /// How far the wheel turned [lug passes].
    pub fn passes(&self) -> f64 {
        self.upward.len() as f64 / BINS as f64
    }

    /// Largest acceleration of each bin, either way, over the reference's pulse [-].
    fn either_way(&self) -> Vec<f64> {
        let pairs = self.upward.iter().zip(&self.downward);
        pairs.map(|(up, down)| up.max(*down)).collect()
    }

    /// Largest acceleration of each whole lug pass, either way, over the reference's pulse [-].
    pub fn loudest(&self) -> Vec<f64> {
        let bins = self.either_way();
        let passes = bins.chunks_exact(BINS);
        passes
            .map(|pass| pass.iter().copied().fold(0.0, f64::max))
            .collect()
    }

    /// Heights of the impacts above `threshold`, either way, over the reference's pulse [-]. Of those
    /// within a quarter of a lug pass the highest counts: a wheel rebounds, and rings.
    pub fn impacts(&self, threshold: f64) -> Vec<f64> {
        let mut impacts: Vec<f64> = Vec::new();
        let mut highest_at = 0;
        let bins = self.either_way().into_iter().enumerate();
        for (bin, height) in bins.filter(|(_, height)| *height > threshold) {
            match impacts.last_mut() {
                Some(last) if bin - highest_at < ONE_IMPACT => {
                    if height > *last {
                        *last = height;
                        highest_at = bin;
                    }
                }
                _ => {
                    impacts.push(height);
                    highest_at = bin;
                }
            }
        }
        impacts
    }
}

/// Length [s] of the blocks used to estimate the sensor's noise.
const BLOCK: f64 = 0.05;

/// Standard deviation [m/s²] of the sensor's noise after the low-pass, if it were white.
///
/// Second differences suppress the signal and have six times the noise variance; the estimate is the lower
/// decile over blocks, those without impacts.
fn low_passed_noise(acceleration: &[f64], rate: f64) -> f64 {
    let block = ((BLOCK * rate) as usize).max(3);
    let variance = |samples: &[f64]| {
        let differences = samples.windows(3).map(|x| x[0] - 2.0 * x[1] + x[2]);
        differences.map(|d| d * d).sum::<f64>() / (6 * (samples.len() - 2)) as f64
    };
    let blocks = sorted(acceleration.chunks_exact(block).map(variance));
    let Some(quiet) = quantile_upper(&blocks, 0.1) else {
        return 0.0;
    };
    // A Gaussian low-pass lets through as much as a rectangular one 1.064 times as wide.
    let share = libm::sqrt(PI / LN_2) / 2.0 * CORNER / (0.5 * rate);
    libm::sqrt(quiet * share)
}
