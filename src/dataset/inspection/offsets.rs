//! Sensors that do not read zero where nothing acts on them.

use super::doubts::Doubts;
use super::subject::Subject;
use super::{Severity, number};
use crate::trace::{Channel, RunAttributes};

/// How many times its noise [-] a sensor must read to have an offset: chance does so once in 400.
const NOISES: f64 = 3.0;

/// Force [N] or torque [N·m] below which a reading is made of rounding: no sensor resolves it.
const ROUNDING: f64 = 1.0e-9;

/// Shortest rest [s] to determine an offset.
const REST: f64 = 0.5;

/// Least number of readings [-] at rest to determine a sensor's noise: one or two of a slow log do not.
const FEWEST: usize = 5;

/// Rotation [rad] within which a wheel counts as standing still: a fifth of a degree is 0.5 mm of rim.
const STILL: f64 = 3.5e-3;

/// Share of the load [-], at the rim for a torque, below which an offset does not matter.
const NEGLIGIBLE: f64 = 0.02;

pub(super) fn check(subject: &Subject<'_>, doubts: &mut Doubts) {
    check_unloaded(subject, doubts);
    check_standing(subject, doubts);
}

/// Doubts forces on a wheel that carries none: all of them at rest; those from the ground anyway.
fn check_unloaded(subject: &Subject<'_>, doubts: &mut Doubts) {
    let trace = subject.trace;
    if !trace.attributes.is_lifted() {
        return;
    }
    let RunAttributes {
        speed, slip_ratio, ..
    } = trace.attributes;
    let rests = speed == 0.0 && (slip_ratio == 0.0 || slip_ratio.is_nan());
    let from_ground = |name: &str| ["normal_force", "drawbar_pull"].contains(&name);
    let is_force = |unit: &str| ["N", "N m"].contains(&unit);
    let idle = |name: &str, unit: &str| is_force(unit) && (rests || from_ground(name));
    let mut doubt = |name: &str, unit: &str, reading: Reading| {
        let Some(weightless) = subject.without_weight(name, reading.mean) else {
            return;
        };
        let reading = Reading {
            mean: weightless,
            ..reading
        };
        if idle(name, unit) && reading.is_offset() {
            let seen = format!("reads {} without load", reading.described(unit));
            let guess = "subtract it on import";
            doubts.channel(name, Severity::Warning, &seen, guess);
        }
    };
    for mean in &trace.means {
        let reading = Reading {
            mean: mean.value,
            noise: mean.sd,
        };
        doubt(&mean.name, &mean.unit, reading);
    }
    for channel in &trace.channels {
        if let Some(reading) = Reading::of(channel.steady()) {
            doubt(&channel.name, &channel.unit, reading);
        }
    }
}

/// Checks pull and torque of a standing wheel before it begins to turn; on a slope they are not 0.
fn check_standing(subject: &Subject<'_>, doubts: &mut Doubts) {
    let trace = subject.trace;
    let RunAttributes {
        load,
        wheel_radius,
        slope_deg,
        ..
    } = trace.attributes;
    if slope_deg != 0.0 || subject.is_turning_unresolved() {
        return;
    }
    let Some(rest) = subject.turning.as_ref().and_then(|(angle, _)| rest(angle)) else {
        return;
    };
    for (name, size) in [
        ("drawbar_pull", load),
        ("driving_torque", load * wheel_radius),
    ] {
        let Some(channel) = trace.channel(name) else {
            continue;
        };
        let readings = channel.between(rest.start, rest.end);
        let Some(reading) = Reading::of(readings).filter(|_| readings.len() >= FEWEST) else {
            continue;
        };
        if reading.is_offset() && reading.mean.abs() > NEGLIGIBLE * size {
            let seen = format!(
                "reads {} for {} s before the wheel turns",
                reading.described(&channel.unit),
                number(rest.end - rest.start)
            );
            let guess = "an offset, or a force left from before; tare it";
            doubts.channel(name, Severity::Warning, &seen, guess);
        }
    }
}

/// The first half [s] of the time before the wheel turns, as the motor strains before it does;
/// `None` where that is too short, or all of the run.
fn rest(wheel_angle: &Channel) -> Option<std::ops::Range<f64>> {
    let first = *wheel_angle.samples.first()?;
    let turns = |angle: &f64| (angle - first).abs() > STILL;
    let moving = wheel_angle.samples.iter().position(turns)?;
    let start = wheel_angle.start;
    let half = 0.5 * (wheel_angle.time(moving) - start);
    (half >= REST).then_some(start..start + half)
}

/// What a sensor reads where nothing acts on it.
#[derive(Debug, Clone, Copy)]
struct Reading {
    mean: f64,
    /// Standard deviation about the mean; NaN where unknown.
    noise: f64,
}

impl Reading {
    /// Mean and noise of the numbers among `samples`, `None` where there are none.
    fn of(samples: &[f64]) -> Option<Self> {
        let finite = || samples.iter().filter(|x| x.is_finite());
        let count = finite().count() as f64;
        let mean = finite().sum::<f64>() / count;
        let variance = finite().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
        let noise = variance.sqrt();
        (count > 0.0).then_some(Self { mean, noise })
    }

    fn is_offset(self) -> bool {
        self.mean.abs() > (NOISES * self.noise).max(ROUNDING)
    }

    fn described(self, unit: &str) -> String {
        let Self { mean, noise } = self;
        format!("{} {unit} (noise {})", number(mean), number(noise))
    }
}
