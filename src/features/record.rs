//! What features are extracted from: acceleration, wheel angle and wheel of one run, checked.

use super::Window;
use super::support::Support;
use crate::quantity::SlipRatio;
use crate::signal::clipped_levels;
use crate::trace::motion::turned;
use crate::trace::wheel::Lugs;
use crate::trace::{Channel, Trace, turned_along, unit_of};
use crate::wheel::Wheel;
use std::ops::Range;

/// Acceleration and rotation of a wheel, sample by sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// The wheel's outline; its mass is not known.
    pub wheel: Wheel,
    /// Lug angle `α` \[rad\].
    pub lug_angle: f64,
    /// Samples per second \[Hz\].
    pub sample_rate: f64,
    /// Time \[s\] of the first sample.
    pub start: f64,
    /// Vertical acceleration [m/s²], gravity removed.
    pub acceleration: Vec<f64>,
    /// Wheel angle \[rad\] at the same times.
    pub angle: Vec<f64>,
    /// Whether the angle is measured, so that the lugs' positions are known; otherwise it is integrated from
    /// the speed and only the rotation is known.
    pub lugs_known: bool,
    /// What carries the wheel.
    pub support: Support,
    /// Levels [m/s²] at which the acceleration is clipped.
    clipped: Vec<f64>,
}

/// Why a run has no windows.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// There is no acceleration.
    #[error("no channel acceleration_y; vibration cannot be recognised without it")]
    NoAcceleration,
    /// The rotation of the wheel is unknown.
    #[error(
        "neither channel wheel_angle nor forward_speed: the lug-pass rate is unknown; record one of them"
    )]
    NoMotion,
    /// The rotation does not follow from the speed without slip.
    #[error(
        "no channel wheel_angle, and with a slip ratio of {0} the rotation does not follow from forward_speed: give slip_ratio below 1, or record wheel_angle"
    )]
    NoSlip(f64),
    /// The wheel has no lugs.
    #[error("the wheel has no lugs; the classes are the ways in which lugs meet the ground")]
    NoLugs,
    /// The number of lugs is unknown.
    #[error(
        "{0}: classes are recognised by the pulses of single lugs; state lug_count of the wheel in the campaign and import it again"
    )]
    UnknownLugs(Lugs),
    /// The wheel's geometry is not possible.
    #[error("{0} of the run is {1} m; it has to be above 0")]
    Geometry(&'static str, f64),
    /// A channel is in another unit.
    #[error("channel {channel} is in {unit:?}, expected {expected:?}: convert on import")]
    Unit {
        /// Which channel.
        channel: String,
        /// Its unit.
        unit: String,
        /// The unit it should have.
        expected: &'static str,
    },
    /// A channel's sample rate is no rate.
    #[error("channel {channel} has a sample rate of {rate} Hz")]
    Rate {
        /// Which channel.
        channel: String,
        /// Its rate \[Hz\].
        rate: f64,
    },
    /// The channels do not overlap.
    #[error("acceleration_y and {0} share less than two samples' time")]
    NoOverlap(&'static str),
}

/// Why a window has no features.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// Samples that are no numbers.
    #[error("{0} samples of acceleration or wheel angle are no numbers")]
    NotNumbers(usize),
    /// All samples are equal.
    #[error("acceleration is constant: is the sensor connected?")]
    Constant,
    /// Samples at the end of the sensor's range.
    #[error("{0} samples of acceleration are clipped")]
    Clipped(usize),
    /// The converter shows next to no steps.
    #[error(
        "acceleration takes {0} values only: is the sensor alive, and its range not far too wide?"
    )]
    Coarse(usize),
    /// The wheel does not turn.
    #[error("the wheel is at rest")]
    AtRest,
    /// The wheel turned forth and back.
    #[error("the wheel reversed within the window")]
    Reversed,
    /// The wheel turned too little.
    #[error("{passes:.2} lug passes in the window, fewer than {needed}")]
    FewLugPasses {
        /// How far it turned [lug passes].
        passes: f64,
        /// How far it has to.
        needed: f64,
    },
    /// Too few samples per second.
    #[error(
        "sample rate {rate} Hz is below {needed} Hz, which a bandwidth of {bandwidth} Hz needs: record faster, or reduce the bandwidth"
    )]
    SlowRate {
        /// The rate \[Hz\].
        rate: f64,
        /// The rate it takes \[Hz\].
        needed: f64,
        /// Corner of the low-pass \[Hz\].
        bandwidth: f64,
    },
}

/// Sample rate over bandwidth [-]: at 0.4 of the rate, where anti-alias filters take over, the
/// Gaussian low-pass is 19 dB down.
const RATE_PER_BANDWIDTH: f64 = 6.25;

/// Turn back [lug angles] from which a wheel reversed.
const TURN_BACK: f64 = 0.5;

/// Turn in a window [rad] below which a wheel is at rest: a step of a coarse encoder.
const AT_REST: f64 = 1.0e-3;

impl Record {
    /// The acceleration of a run and how its wheel turned.
    ///
    /// The angle is that of `wheel_angle`, interpolated where its samples lie at other times. A
    /// run without it has it summed up from `forward_speed` and the slip ratio (channel, mean or
    /// command), as [`SlipRatio::wheel_speed`] has it.
    ///
    /// # Errors
    /// [`RecordError`] for what is missing or in another unit.
    pub fn of(trace: &Trace) -> Result<Self, RecordError> {
        let wheel = wheel(trace)?;
        let lug_angle = wheel.lug_angle().ok_or(RecordError::NoLugs)?;
        let acceleration = known(trace, "acceleration_y")?.ok_or(RecordError::NoAcceleration)?;
        let (rotation, lugs_known) = rotation(trace, &wheel)?;
        let span =
            overlap(acceleration, &rotation).ok_or(RecordError::NoOverlap(if lugs_known {
                "wheel_angle"
            } else {
                "forward_speed"
            }))?;
        let samples = acceleration.samples[span.clone()].to_vec();
        let times = span.clone().map(|index| acceleration.time(index));
        Ok(Self {
            wheel,
            lug_angle,
            sample_rate: acceleration.sample_rate,
            start: acceleration.time(span.start),
            clipped: clipped_levels(&samples),
            acceleration: samples,
            angle: at_times(&rotation, times),
            lugs_known,
            support: Support::of(trace),
        })
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.acceleration.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.acceleration.is_empty()
    }

    /// Time \[s\] at which a sample's period begins.
    pub fn time(&self, sample: usize) -> f64 {
        self.start + sample as f64 / self.sample_rate
    }

    /// Length of a window \[s\].
    pub fn seconds(&self, window: &Range<usize>) -> f64 {
        window.len() as f64 / self.sample_rate
    }

    /// Lug passes in a window [-]: how far the wheel turned, in lug angles.
    pub fn lug_passes(&self, window: &Range<usize>) -> f64 {
        let angle = &self.angle[window.clone()];
        match (angle.first(), angle.last()) {
            (Some(first), Some(last)) => (last - first).abs() / self.lug_angle,
            _ => 0.0,
        }
    }

    /// The windows, one after another from the first sample on. The last counts when at least
    /// half of it was recorded; a shorter record is one window.
    pub fn windows(&self, window: Window) -> Vec<Range<usize>> {
        match window {
            Window::Seconds(length) => self.windows_of_time(length),
            Window::LugPasses(passes) => self.windows_of_angle(passes),
        }
    }

    fn windows_of_time(&self, length: f64) -> Vec<Range<usize>> {
        let bound = |number: f64| (number * length * self.sample_rate).round() as usize;
        let count = (self.len() as f64 / (length * self.sample_rate))
            .round()
            .max(1.0) as usize;
        let ranges = (0..count).map(|n| bound(n as f64)..bound(n as f64 + 1.0).min(self.len()));
        ranges.filter(|window| !window.is_empty()).collect()
    }

    fn windows_of_angle(&self, passes: f64) -> Vec<Range<usize>> {
        let turn = passes * self.lug_angle;
        let (mut windows, mut start) = (Vec::new(), 0);
        for sample in 0..self.len() {
            if (self.angle[sample] - self.angle[start]).abs() >= turn {
                windows.push(start..sample);
                start = sample;
            }
        }
        let rest = start..self.len();
        if windows.is_empty() || self.lug_passes(&rest) >= 0.5 * passes {
            windows.push(rest);
        }
        windows
    }

    /// Number of lug passes of a window that is usable at this `bandwidth` [Hz].
    ///
    /// # Errors
    /// [`Unusable`] with the reason.
    pub(crate) fn usable(&self, window: Range<usize>, bandwidth: f64) -> Result<f64, Unusable> {
        let needed = RATE_PER_BANDWIDTH * bandwidth;
        if self.sample_rate < needed {
            let rate = self.sample_rate;
            return Err(Unusable::SlowRate {
                rate,
                needed,
                bandwidth,
            });
        }
        self.sound(window.clone())?;
        self.turns(&window)?;
        let passes = self.lug_passes(&window);
        if passes < 1.0 {
            return Err(Unusable::FewLugPasses {
                passes,
                needed: 1.0,
            });
        }
        Ok(passes)
    }

    /// Whether the wheel turns in a window, and one way.
    pub(crate) fn turns(&self, window: &Range<usize>) -> Result<(), Unusable> {
        let angle = &self.angle[window.clone()];
        let bounds = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = angle
            .iter()
            .fold(bounds, |[low, high], a| [low.min(*a), high.max(*a)]);
        let turned = self.lug_passes(window) * self.lug_angle;
        // A reading that trembles about one place comes back to it.
        let trembles = turned < 0.5 * (high - low) && high - low < TURN_BACK * self.lug_angle;
        if high - low < AT_REST || trembles {
            return Err(Unusable::AtRest);
        }
        if high - low > turned + TURN_BACK * self.lug_angle {
            return Err(Unusable::Reversed);
        }
        Ok(())
    }

    /// Whether the samples of a window are numbers, vary, and stay within the sensor's range.
    pub(crate) fn sound(&self, window: Range<usize>) -> Result<(), Unusable> {
        let acceleration = &self.acceleration[window.clone()];
        let pairs = acceleration.iter().zip(&self.angle[window]);
        let missing = pairs.filter(|(a, angle)| !a.is_finite() || !angle.is_finite());
        match missing.count() {
            0 => {}
            missing => return Err(Unusable::NotNumbers(missing)),
        }
        if acceleration.iter().all(|a| *a == acceleration[0]) {
            return Err(Unusable::Constant);
        }
        if let Some(values) = few_values(acceleration) {
            return Err(Unusable::Coarse(values));
        }
        let clipped = acceleration.iter().filter(|a| self.clipped.contains(a));
        match clipped.count() {
            0 => Ok(()),
            clipped => Err(Unusable::Clipped(clipped)),
        }
    }
}

/// Values [-] that an acceleration takes at least, unless its converter is far too coarse.
const VALUES: usize = 9;

/// How many different values there are, where they are fewer than [`VALUES`].
fn few_values(samples: &[f64]) -> Option<usize> {
    let mut values: Vec<f64> = Vec::with_capacity(VALUES);
    for sample in samples {
        if !values.contains(sample) {
            values.push(*sample);
        }
        if values.len() == VALUES {
            return None;
        }
    }
    Some(values.len())
}

fn wheel(trace: &Trace) -> Result<Wheel, RecordError> {
    let run = &trace.attributes;
    let above_zero = |name, value: f64| {
        if value > 0.0 {
            Ok(value)
        } else {
            Err(RecordError::Geometry(name, value))
        }
    };
    let radius = above_zero("wheel_radius_m", run.wheel_radius)?;
    let lug_count = run.lug_count.ok_or(RecordError::UnknownLugs(run.lugs()))?;
    if lug_count > 0 {
        above_zero("lug_height_m", run.lug_height)?;
    }
    Ok(Wheel::of_outline(
        radius,
        run.wheel_width,
        lug_count,
        run.lug_height,
    ))
}

/// A channel of a name with a standard unit.
fn known<'t>(trace: &'t Trace, name: &str) -> Result<Option<&'t Channel>, RecordError> {
    let Some(channel) = trace.channel(name) else {
        return Ok(None);
    };
    match unit_of(name) {
        Some(expected) if channel.unit != expected => Err(RecordError::Unit {
            channel: name.to_owned(),
            unit: channel.unit.clone(),
            expected,
        }),
        _ if !(channel.sample_rate > 0.0 && channel.sample_rate.is_finite()) => {
            Err(RecordError::Rate {
                channel: name.to_owned(),
                rate: channel.sample_rate,
            })
        }
        _ => Ok(Some(channel)),
    }
}

/// The wheel angle as a channel, and whether its zero is that of a lug.
fn rotation(trace: &Trace, wheel: &Wheel) -> Result<(Channel, bool), RecordError> {
    if let Some(angle) = known(trace, "wheel_angle")? {
        return Ok((turned(angle), !trace.attributes.angle_zero_unknown));
    }
    let speed = known(trace, "forward_speed")?.ok_or(RecordError::NoMotion)?;
    let slip = trace.slip();
    let per_speed = SlipRatio::new(slip)
        .ok()
        .and_then(|slip| slip.wheel_speed(wheel.radius, 1.0))
        .ok_or(RecordError::NoSlip(slip))?;
    Ok((turned_along(speed, per_speed), false))
}

/// The samples of `channel` that lie within the time of `other`.
fn overlap(channel: &Channel, other: &Channel) -> Option<Range<usize>> {
    if other.samples.is_empty() {
        return None;
    }
    let last = other.time(other.samples.len() - 1);
    let index = |time: f64| (time - channel.start) * channel.sample_rate;
    let slack = 1.0e-6;
    let first = (index(other.start) - slack).ceil().max(0.0) as usize;
    let end = ((index(last) + slack).floor() + 1.0).max(0.0) as usize;
    let end = end.min(channel.samples.len());
    (first + 2 <= end).then_some(first..end)
}

/// Values of a channel at `times` [s], between samples on straight lines.
fn at_times(channel: &Channel, times: impl Iterator<Item = f64>) -> Vec<f64> {
    let last = channel.samples.len() - 1;
    let value = |time: f64| {
        let place = ((time - channel.start) * channel.sample_rate).clamp(0.0, last as f64);
        let nearest = place.round();
        if (place - nearest).abs() < 1.0e-6 {
            return channel.samples[nearest as usize];
        }
        let before = place as usize;
        let share = place - before as f64;
        channel.samples[before] * (1.0 - share) + channel.samples[before + 1] * share
    };
    times.map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{Mean, RunAttributes};

    fn channel(name: &str, sample_rate: f64, samples: Vec<f64>) -> Channel {
        Channel {
            name: name.to_owned(),
            unit: unit_of(name).unwrap().to_owned(),
            sample_rate,
            start: 0.0,
            samples,
        }
    }

    /// 10 s at 1 kHz, turning at 0.2 rad/s.
    fn trace() -> Trace {
        let acceleration = (0..10_000).map(|i| f64::from(i % 13)).collect();
        let angle = (0..10_000).map(|i| 2.0e-4 * f64::from(i)).collect();
        Trace {
            attributes: RunAttributes {
                wheel_radius: 0.14,
                wheel_width: 0.15,
                lug_count: Some(28),
                lug_height: 0.015,
                slip_ratio: 0.2,
                ..RunAttributes::default()
            },
            channels: vec![
                channel("acceleration_y", 1000.0, acceleration),
                channel("wheel_angle", 1000.0, angle),
            ],
            ..Trace::default()
        }
    }

    #[test]
    fn windows_follow_each_other_and_the_last_counts_from_half_its_length() {
        let record = Record::of(&trace()).unwrap();
        let windows = |length| record.windows(Window::Seconds(length));
        assert_eq!(windows(4.0), [0..4000, 4000..8000, 8000..10_000]);
        assert_eq!(windows(4.2), [0..4200, 4200..8400]);
        assert_eq!(windows(60.0), vec![0..10_000]);
        // 2 rad are 8.9 lug passes.
        let passes = record.windows(Window::LugPasses(3.0));
        assert_eq!(passes.len(), 3);
        assert!((record.lug_passes(&passes[0]) - 3.0).abs() < 0.01);
    }

    #[test]
    fn without_an_encoder_speed_and_slip_give_the_rotation_but_not_the_lugs_positions() {
        let mut run = trace();
        run.channels[1] = channel("forward_speed", 500.0, vec![0.0224; 5000]);
        let record = Record::of(&run).unwrap();
        assert!(!record.lugs_known);
        // 0.0224 / (0.14 * 0.8) = 0.2 rad/s; a measured slip goes before the command.
        let turned = record.angle[9000] - record.angle[0];
        assert!((turned - 1.8).abs() < 1e-3, "{turned}");
        run.means.push(Mean {
            name: "slip_ratio".to_owned(),
            unit: "1".to_owned(),
            value: 0.6,
            sd: 0.0,
            n: 1,
        });
        assert!((Record::of(&run).unwrap().angle[9000] - 3.6).abs() < 1e-3);
    }

    #[test]
    fn a_braked_wheel_turns_slower_than_it_rolls_and_a_slip_of_one_gives_no_rotation() {
        let turned = |slip: f64| {
            let mut run = trace();
            run.channels[1] = channel("forward_speed", 500.0, vec![0.028; 5000]);
            run.attributes.slip_ratio = slip;
            Record::of(&run).map(|record| record.angle[9000] - record.angle[0])
        };
        assert!((turned(-0.5).unwrap() - 0.9).abs() < 1e-3);
        for slip in [1.0, f64::NAN] {
            assert!(matches!(turned(slip), Err(RecordError::NoSlip(_))));
        }
    }

    #[test]
    fn an_angle_at_another_rate_is_interpolated_over_the_time_both_share() {
        let mut run = trace();
        let slow = (0..100).map(|i| 0.02 * f64::from(i)).collect();
        run.channels[1] = channel("wheel_angle", 10.0, slow);
        run.channels[1].start = 1.0;
        let record = Record::of(&run).unwrap();
        assert_eq!(record.start, 1.0);
        assert!((record.angle[50] - 0.01).abs() < 1e-12);
        assert_eq!(record.len(), 9000);
    }

    #[test]
    fn missing_channels_and_wrong_units_are_reported() {
        let message = |edit: &dyn Fn(&mut Trace)| {
            let mut run = trace();
            edit(&mut run);
            Record::of(&run).unwrap_err().to_string()
        };
        assert!(
            message(&|run| drop(run.channels.remove(0))).starts_with("no channel acceleration_y")
        );
        assert!(
            message(&|run| drop(run.channels.remove(1))).starts_with("neither channel wheel_angle")
        );
        assert!(message(&|run| run.attributes.lug_count = Some(0)).contains("no lugs"));
        let unknown = message(&|run| run.attributes.lug_count = None);
        assert!(
            unknown.starts_with("lugs of 15 mm, count not given"),
            "{unknown}"
        );
        assert!(message(&|run| run.attributes.wheel_radius = 0.0).contains("wheel_radius_m"));
        assert!(
            message(&|run| run.channels[0].unit = "g".to_owned()).contains("convert on import")
        );
        assert!(message(&|run| run.channels[0].sample_rate = f64::NAN).contains("NaN Hz"));
        assert!(message(&|run| run.channels[1].start = 10.0).contains("share less than"));
    }

    #[test]
    fn an_unusable_window_has_a_reason() {
        let reason = |edit: &dyn Fn(&mut Trace), bandwidth: f64| {
            let mut run = trace();
            edit(&mut run);
            let record = Record::of(&run).unwrap();
            record.usable(0..record.len(), bandwidth).unwrap_err()
        };
        let samples = |f: &'static dyn Fn(usize) -> f64| {
            move |run: &mut Trace| run.channels[0].samples = (0..10_000).map(f).collect()
        };
        assert_eq!(
            reason(&|run| run.channels[0].samples[5] = f64::NAN, 100.0),
            Unusable::NotNumbers(1)
        );
        assert_eq!(reason(&samples(&|_| 3.0), 100.0), Unusable::Constant);
        let clipped = samples(&|i| (f64::from(i as u32) * 0.01).sin().min(0.9));
        assert!(matches!(reason(&clipped, 100.0), Unusable::Clipped(n) if n > 1000));
        let still = |run: &mut Trace| run.channels[1].samples = vec![0.3; 10_000];
        assert_eq!(reason(&still, 100.0), Unusable::AtRest);
        let back = |run: &mut Trace| run.channels[1].samples[5000..].reverse();
        assert_eq!(reason(&back, 100.0), Unusable::Reversed);
        let slow = |run: &mut Trace| run.channels[1].samples.iter_mut().for_each(|a| *a *= 0.1);
        assert!(matches!(
            reason(&slow, 100.0),
            Unusable::FewLugPasses { .. }
        ));
        assert!(matches!(
            reason(&|_| (), 200.0),
            Unusable::SlowRate { needed: 1250.0, .. }
        ));
    }
}
