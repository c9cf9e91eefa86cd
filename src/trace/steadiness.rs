//! Test whether the mean over a stretch of a run is that of a steady state.
//!
//! **The statistic.** Samples `x(t)` of a stretch of length `T` are compared with those of one lag `L` later:
//!
//! ```text
//! d(t) = x(t + L) − x(t),   0 ≤ t < m,   m = min(L, T − L);      rate = mean(d) / L
//! ```
//!
//! The lag is a whole number of lug passes where their period is known, so that what recurs with the lugs
//! cancels exactly; among these it is the one for which `L √m` is largest, which for a steady slope under white
//! noise loses least. Without a period this is `L = 2T/3`: the first third against the last, Bartlett's
//! (1949) choice for lines through points that scatter. The mean of `d` is held against the scatter of
//! [`BLOCKS`] blocks of it about their own line (an exponential approach bends, and its bend is no scatter):
//!
//! ```text
//! t = mean(d) / SE,    SE² = s²/n · (1 + r)/(1 − r)
//! ```
//!
//! with the residuals' variance `s²` and autocorrelation `r` at one block, raised by `6/n` (`2/n` is its bias
//! about a line; all of it keeps false alarms at 2 % up to a correlation over `T/25`, where `2/n` makes 6 %) and
//! not below 0, by Student's t with `(n − 2)(1 − r)/(1 + r)` degrees of freedom, at least 1.
//!
//! **What counts.** A value drifts where this is significant at [`LEVEL`], and where the drift over the
//! stretch exceeds both [`LIMIT`] of the mean and the least change that matters to that quantity: a
//! significant drift of 0.01 N is harmless. A stretch of fewer than [`PASSES`] lug passes that shows no drift is
//! too short to call steady; in one of hardly more than a single pass, a drift may be the lugs' rhythm.
//!
//! A line through block means was tried instead: with less than ten lug passes, which is most runs at
//! rover speeds, its blocks hold the lugs' rhythm as scatter and it finds nothing.
//!
//! **Limits.** Scatter that is correlated over a third of the stretch or longer cannot be distinguished from a drift.
//! An approach that is over within a small part of the stretch is missed; so is one much slower than the
//! stretch, where its change is below the limits. `output/reference/steady.txt` has both errors, by ground.

use super::unwrapped;
use super::{Channel, RunAttributes, Trace};
use crate::quantity::SlipRatio;
use crate::statistics::finite_mean;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::f64::consts::TAU;

/// Blocks into which the differences are cut, where there are so many of them.
pub const BLOCKS: usize = 24;

/// Blocks that a test needs at least.
const FEWEST: usize = 8;

/// Accepted rate of false alarms [-] where scatter is uncorrelated.
pub const LEVEL: f64 = 0.01;

/// Drift over the stretch, as a part of the mean's size [-], below which a value counts as steady.
pub const LIMIT: f64 = 0.02;

/// By how much the autocorrelation of so many blocks is raised, times their number [-].
const RAISED: f64 = 6.0;

/// Least number of lug passes [-] of a stretch whose value may count as steady.
///
/// With fewer, there are too few whole passes to compare: of 1.5 passes of a wheel that still sank into sand, the
/// pull was 20 % below its steady value and looked steady.
pub const PASSES: f64 = 2.5;

/// Lug passes [-] from which samples can be compared with those of the same phase of the lugs.
const ALIGNED: f64 = 1.25;

/// What the test of a steady value came to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum Steadiness {
    /// No drift that matters.
    Steady,
    /// The value still changes.
    Drifting {
        /// Rate of change, in the quantity's unit per second.
        rate: f64,
    },
    /// No drift is significant, but there are too few samples or lug passes to exclude one.
    TooShort,
}

impl Steadiness {
    /// The state by its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Drifting { .. } => "drifting",
            Self::TooShort => "too_short",
        }
    }

    /// Rate of change, where it drifts.
    pub fn rate(self) -> Option<f64> {
        match self {
            Self::Drifting { rate } => Some(rate),
            Self::Steady | Self::TooShort => None,
        }
    }
}

/// A stretch of samples whose mean is to be a steady value.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<'s> {
    /// The samples; those that are not numbers are left out.
    pub samples: &'s [f64],
    /// Samples per second \[Hz\].
    pub sample_rate: f64,
    /// Period of the lug passes \[s\], where it is known.
    pub pass: Option<f64>,
    /// Change of the value, in its unit, below which it counts as steady however small it is.
    pub least_change: f64,
}

impl Trace {
    /// Whether the steady value of the quantity `name` is one; `None` where there is no time series of it or one
    /// without numbers, and of acceleration and angle, which have none.
    pub fn steadiness(&self, name: &str) -> Option<Steadiness> {
        if ["acceleration_y", "wheel_angle"].contains(&name) {
            return None;
        }
        self.steadiness_between(name, steady_interval(self.channel(name)?))
    }

    /// Whether the mean of the quantity `name` over an interval \[s\] is a steady value; `None` where there is no
    /// time series of it or one without numbers.
    pub fn steadiness_between(&self, name: &str, interval: [f64; 2]) -> Option<Steadiness> {
        let channel = self.channel(name)?;
        let samples = channel.between(interval[0], interval[1]);
        finite_mean(samples)?;
        let stretch = Stretch {
            samples,
            sample_rate: channel.sample_rate,
            pass: self.lug_pass(interval),
            least_change: least_change(name, &self.attributes),
        };
        Some(stretch.steadiness())
    }

    /// Whether the mean square of a channel over its middle half is a steady value.
    pub fn steadiness_of_square(&self, channel: &Channel) -> Steadiness {
        let squares: Vec<f64> = channel.steady().iter().map(|x| x * x).collect();
        Stretch {
            samples: &squares,
            sample_rate: channel.sample_rate,
            pass: self.lug_pass(steady_interval(channel)),
            least_change: 0.0,
        }
        .steadiness()
    }

    /// Period of the lug passes [s] over an interval [s], by the wheel's turning or else by the command; `None`
    /// without lugs, or where their number or the turning is unknown.
    fn lug_pass(&self, interval: [f64; 2]) -> Option<f64> {
        let RunAttributes {
            lug_count,
            wheel_radius,
            speed,
            slip_ratio,
            ..
        } = self.attributes;
        let commanded = || {
            SlipRatio::new(slip_ratio)
                .ok()?
                .wheel_speed(wheel_radius, speed)
        };
        let angle = self.channel("wheel_angle");
        let turning = angle.and_then(|angle| wheel_speed(angle, interval));
        let pass = TAU / f64::from(lug_count?) / turning.or_else(commanded)?.abs();
        pass.is_finite().then_some(pass)
    }
}

/// Begin and end [s] of the middle half of a channel.
fn steady_interval(channel: &Channel) -> [f64; 2] {
    let quarter = channel.samples.len() / 4;
    [quarter, channel.samples.len() - quarter].map(|index| channel.time(index))
}

/// Mean wheel speed [rad/s] over an interval [s].
fn wheel_speed(wheel_angle: &Channel, interval: [f64; 2]) -> Option<f64> {
    let angles = unwrapped(wheel_angle.between(interval[0], interval[1]));
    let known = || (0..angles.len()).filter(|&index| angles[index].is_finite());
    let (first, last) = (known().next()?, known().next_back()?);
    let turned = angles[last] - angles[first];
    (last > first).then(|| turned * wheel_angle.sample_rate / (last - first) as f64)
}

/// Least relevant change of a steady value: the calibration uncertainty of a force or speed, the resolution
/// of a rig's sinkage or slip.
fn least_change(name: &str, attributes: &RunAttributes) -> f64 {
    const PART: f64 = 0.01;
    const SINKAGE: f64 = 1.0e-4;
    const SLIP: f64 = 0.005;
    let least = match name {
        "normal_force" | "drawbar_pull" => PART * attributes.load,
        "driving_torque" => PART * attributes.load * attributes.wheel_radius,
        "forward_speed" => PART * attributes.speed.abs(),
        "sinkage" => SINKAGE,
        "slip_ratio" => SLIP,
        _ => 0.0,
    };
    if least.is_finite() { least } else { 0.0 }
}

impl Stretch<'_> {
    /// The test of this stretch.
    pub fn steadiness(&self) -> Steadiness {
        let duration = self.samples.len() as f64 / self.sample_rate;
        let passes = self.pass.map_or(f64::INFINITY, |pass| duration / pass);
        let (Some(differences), Some(mean)) = (self.differences(), finite_mean(self.samples))
        else {
            return Steadiness::TooShort;
        };
        let drift = (differences.rate() * duration).abs();
        let matters = drift > (LIMIT * mean.abs()).max(self.least_change);
        if matters && differences.chance() < LEVEL {
            Steadiness::Drifting {
                rate: differences.rate(),
            }
        } else if passes < PASSES {
            Steadiness::TooShort
        } else {
            Steadiness::Steady
        }
    }

    /// Lag [samples] between what is compared.
    fn lag(&self) -> usize {
        let count = self.samples.len() as f64;
        let pass = self.pass.map(|pass| pass * self.sample_rate);
        let Some(pass) = pass.filter(|pass| *pass >= 1.0 && ALIGNED * pass <= count) else {
            return (2.0 / 3.0 * count).round() as usize;
        };
        let power = |lag: f64| lag * lag * lag.min(count - lag);
        let best = 2.0 / 3.0 * count / pass;
        let candidates = [best.floor().max(1.0) * pass, best.ceil() * pass];
        let lag = if power(candidates[1]) > power(candidates[0]) {
            candidates[1]
        } else {
            candidates[0]
        };
        lag.round() as usize
    }

    fn differences(&self) -> Option<Differences> {
        let lag = self.lag();
        let count = lag.min(self.samples.len().checked_sub(lag)?);
        let differences: Vec<f64> = (0..count)
            .map(|index| self.samples[index + lag] - self.samples[index])
            .collect();
        if count < FEWEST {
            return None;
        }
        let number = count.min(BLOCKS);
        let edge = |block: usize| block * count / number;
        let block = |index| finite_mean(&differences[edge(index)..edge(index + 1)]);
        Some(Differences {
            blocks: (0..number).map(block).collect::<Option<_>>()?,
            lag: lag as f64 / self.sample_rate,
        })
    }
}

/// Block means of the differences over a lag.
struct Differences {
    blocks: Vec<f64>,
    /// The lag [s].
    lag: f64,
}

impl Differences {
    fn count(&self) -> f64 {
        self.blocks.len() as f64
    }

    fn mean(&self) -> f64 {
        self.blocks.iter().sum::<f64>() / self.count()
    }

    /// Rate of change, per second.
    fn rate(&self) -> f64 {
        self.mean() / self.lag
    }

    /// Residuals of the blocks about their line.
    fn residuals(&self) -> Vec<f64> {
        let middle = 0.5 * (self.count() - 1.0);
        let blocks = || {
            (0..)
                .map(|index| f64::from(index) - middle)
                .zip(&self.blocks)
        };
        let squares: f64 = blocks().map(|(at, _)| at * at).sum();
        let products: f64 = blocks().map(|(at, block)| at * block).sum();
        let (mean, slope) = (self.mean(), products / squares);
        blocks()
            .map(|(at, block)| block - mean - slope * at)
            .collect()
    }

    /// Chance [-] of so large a mean difference where nothing drifts.
    fn chance(&self) -> f64 {
        let residuals = self.residuals();
        let squares: f64 = residuals.iter().map(|x| x * x).sum();
        if squares <= 0.0 {
            return if self.mean() == 0.0 { 1.0 } else { 0.0 };
        }
        let pairs: f64 = residuals.windows(2).map(|pair| pair[0] * pair[1]).sum();
        let correlation = (pairs / squares + RAISED / self.count()).clamp(0.0, 0.95);
        let inflation = (1.0 + correlation) / (1.0 - correlation);
        let freedom = self.count() - 2.0;
        let variance = squares / freedom / self.count() * inflation;
        if !variance.is_finite() {
            // The squares of such samples exceed the range of numbers: nothing is known.
            return 1.0;
        }
        let student = StudentsT::new(0.0, 1.0, (freedom / inflation).max(1.0));
        let student = student.expect("at least one degree of freedom");
        2.0 * student.sf(self.mean().abs() / libm::sqrt(variance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand::RngExt;

    const RATE: f64 = 100.0;

    fn stretch(samples: &[f64], pass: Option<f64>) -> Steadiness {
        Stretch {
            samples,
            sample_rate: RATE,
            pass,
            least_change: 0.0,
        }
        .steadiness()
    }

    fn is_drifting(found: Steadiness) -> bool {
        found.rate().is_some()
    }

    /// A stretch of 7.5 s about 20 with a scatter of 1 of this correlation time [s].
    fn scatter(run: u64, correlation: f64) -> Vec<f64> {
        let mut rng = Seed(1).rng("steadiness", run);
        let keep = libm::exp(-1.0 / (RATE * correlation));
        let step = libm::sqrt(12.0 * (1.0 - keep * keep));
        let mut x = 0.0;
        let mut next = || {
            x = keep * x + step * (rng.random::<f64>() - 0.5);
            20.0 + x
        };
        for _ in 0..2000 {
            next();
        }
        (0..750).map(|_| next()).collect()
    }

    fn alarms(series: impl Fn(u64) -> Vec<f64>, pass: Option<f64>) -> usize {
        (0..1000)
            .filter(|run| is_drifting(stretch(&series(*run), pass)))
            .count()
    }

    #[test]
    fn stationary_scatter_drifts_in_under_three_of_a_hundred_stretches() {
        for (correlation, most) in [(0.01, 15), (0.1, 25), (0.3, 30)] {
            let found = alarms(|run| scatter(run, correlation), None);
            println!("correlation {correlation} s: {found} of 1000");
            assert!(found <= most, "{found} of 1000 at {correlation} s");
        }
    }

    #[test]
    fn a_rhythm_of_the_lugs_is_no_drift_and_hides_none() {
        for pass in [0.9, 2.1, 2.9] {
            let rhythm = |i: usize| 10.0 * libm::sin(TAU * i as f64 / RATE / pass + 0.7).powi(3);
            let steady: Vec<f64> = scatter(3, 0.05)
                .into_iter()
                .enumerate()
                .map(|(i, x)| x + rhythm(i))
                .collect();
            assert_eq!(stretch(&steady, Some(pass)), Steadiness::Steady, "{pass}");
            let ramp: Vec<f64> = steady
                .iter()
                .enumerate()
                .map(|(i, x)| x + 0.8 * i as f64 / RATE)
                .collect();
            let rate = stretch(&ramp, Some(pass)).rate().unwrap();
            assert!((rate - 0.8).abs() < 0.2, "{rate} at {pass} s");
        }
    }

    #[test]
    fn a_value_that_approaches_its_steady_state_drifts_while_it_is_far_from_it() {
        let approach = |constant: f64| {
            move |run| {
                let scatter = scatter(run, 0.05).into_iter().enumerate();
                scatter
                    .map(|(i, x)| x - 10.0 * libm::exp(-(i as f64) / RATE / constant))
                    .collect()
            }
        };
        for (constant, least) in [(1.0, 600), (3.0, 950), (10.0, 900)] {
            let found = alarms(approach(constant), None);
            println!("time constant {constant} s: {found} of 1000");
            assert!(found >= least, "{found} of 1000 at {constant} s");
        }
    }

    #[test]
    fn a_ramp_drifts_at_its_rate_and_a_constant_is_steady() {
        let ramp: Vec<f64> = (0..750).map(|i| 10.0 + 3.0 * f64::from(i) / RATE).collect();
        let rate = stretch(&ramp, None).rate().unwrap();
        assert!((rate - 3.0).abs() < 1e-6, "{rate}");
        assert_eq!(stretch(&[20.0; 750], None), Steadiness::Steady);
    }

    #[test]
    fn samples_whose_squares_exceed_the_range_of_numbers_show_no_drift() {
        let mut samples = [20.0; 750];
        samples.iter_mut().step_by(7).for_each(|it| *it = 1.0e300);
        assert!(!is_drifting(stretch(&samples, None)));
    }

    #[test]
    fn a_drift_below_what_matters_is_steady() {
        let ramp: Vec<f64> = (0..750)
            .map(|i| 0.02 * f64::from(i) / RATE - 0.07)
            .collect();
        assert!(is_drifting(stretch(&ramp, None)));
        let with_least = Stretch {
            samples: &ramp,
            sample_rate: RATE,
            pass: None,
            least_change: 1.0,
        };
        assert_eq!(with_least.steadiness(), Steadiness::Steady);
    }

    #[test]
    fn less_than_two_and_a_half_lug_passes_or_a_handful_of_samples_are_too_short_to_call_steady() {
        let samples = [20.0; 750];
        assert_eq!(stretch(&samples, Some(3.1)), Steadiness::TooShort);
        assert_eq!(stretch(&samples, Some(2.9)), Steadiness::Steady);
        assert_eq!(stretch(&[], None), Steadiness::TooShort);
        assert_eq!(stretch(&[20.0; 20], None), Steadiness::TooShort);
        // Whatever the lugs' phase, what rises so far is not steady.
        let ramp: Vec<f64> = (0..750).map(|i| f64::from(i) / RATE).collect();
        assert!(is_drifting(stretch(&ramp, Some(15.0))));
    }
}
