//! Sensors that do not read zero where nothing acts on them.

use super::{Doubts, Severity, number};
use crate::trace::{Channel, RunAttributes, Trace};

/// How many times its noise [-] a sensor must read to have an offset: chance does so once in 400.
const NOISES: f64 = 3.0;

/// Shortest rest [s] that tells an offset.
const REST: f64 = 0.5;

/// Turning [rad] within which a wheel stands still: a fifth of a degree is 0.5 mm of rim.
const STILL: f64 = 3.5e-3;

/// Share of the load [-], at the rim for a torque, below which an offset does not matter.
const NEGLIGIBLE: f64 = 0.02;

/// Change of vertical speed [m/s] that no wheel of a rover makes: a mean acceleration that
/// integrates to more is an offset.
const FASTEST: f64 = 0.2;

pub(super) fn check(trace: &Trace, doubts: &mut Doubts) {
    check_unloaded(trace, doubts);
    check_standing(trace, doubts);
    if let Some(acceleration) = trace.channel("acceleration_y") {
        check_drift(acceleration, doubts);
    }
}

/// Doubts forces on a wheel that carries none: all of them at rest; those from the ground anyway.
fn check_unloaded(trace: &Trace, doubts: &mut Doubts) {
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
        if idle(name, unit) && reading.is_offset() {
            let message = format!(
                "reads {} without load: subtract it on import",
                reading.told(unit)
            );
            doubts.channel(name, Severity::Warning, message);
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

/// Doubts a pull or torque on a wheel that stands before it begins to turn.
fn check_standing(trace: &Trace, doubts: &mut Doubts) {
    let Some(rest) = trace.channel("wheel_angle").and_then(rest) else {
        return;
    };
    let RunAttributes {
        load, wheel_radius, ..
    } = trace.attributes;
    for (name, size) in [
        ("drawbar_pull", load),
        ("driving_torque", load * wheel_radius),
    ] {
        let Some(channel) = trace.channel(name) else {
            continue;
        };
        let Some(reading) = Reading::of(channel.between(rest.start, rest.end)) else {
            continue;
        };
        if reading.is_offset() && reading.mean.abs() > NEGLIGIBLE * size {
            let message = format!(
                "reads {} for {} s before the wheel turns: an offset, or a force left from \
                 before; tare it",
                reading.told(&channel.unit),
                number(rest.end - rest.start)
            );
            doubts.channel(name, Severity::Warning, message);
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

/// Doubts an acceleration whose mean carries the wheel away.
///
/// A mean of half of gravity or more is a matter of gravity and units instead.
fn check_drift(acceleration: &Channel, doubts: &mut Doubts) {
    let Some(mean) = acceleration.steady_mean() else {
        return;
    };
    let seconds = acceleration.steady().len() as f64 / acceleration.sample_rate;
    let gained = mean * seconds;
    if gained.abs() > FASTEST && mean.abs() < 0.9 {
        let message = format!(
            "mean is {} m/s^2, which makes {} m/s of vertical speed in {} s: an offset; subtract \
             it on import",
            number(mean),
            number(gained),
            number(seconds)
        );
        doubts.channel(&acceleration.name, Severity::Warning, message);
    }
}

/// What a sensor reads where nothing acts on it.
#[derive(Debug, Clone, Copy)]
struct Reading {
    mean: f64,
    /// Standard deviation around the mean; NaN where it is not known.
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
        self.mean.abs() > NOISES * self.noise
    }

    fn told(self, unit: &str) -> String {
        let Self { mean, noise } = self;
        format!("{} {unit} (noise {})", number(mean), number(noise))
    }
}
