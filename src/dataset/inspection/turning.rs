//! What the wheel's angle contradicts: its unit, its direction, its counter, the unit of time.

use super::doubts::Doubts;
use super::subject::Subject;
use super::{Severity, number};
use crate::trace::RunAttributes;
use std::f64::consts::TAU;

/// Tolerance of a ratio of speeds about a unit factor [-]; a poorly controlled slip changes it.
const NEAR: f64 = 0.1;

/// Sample rate [Hz] of an acceleration below which it shows no vibration: a lug's blow lasts some milliseconds.
const SLOW_ACCELERATION: f64 = 20.0;

/// Sample rate [Hz] below which a log is slow: a rover's own, or one whose time is in milliseconds.
const SLOW_LOG: f64 = 2.0;

/// Length [s] of a record that no single run has: two hours.
const LONGEST_RUN: f64 = 7200.0;

/// Way [m] that no rig has, and that a rover drives in one run only where it is logged as seldom as
/// [`SLOW_LOG`].
const LONGEST_WAY: f64 = 100.0;

pub(super) fn check(subject: &Subject<'_>, doubts: &mut Doubts) {
    check_counter(subject, doubts);
    check_resolution(subject, doubts);
    let is_other_unit = check_unit(subject, doubts);
    check_direction(subject, doubts);
    if !is_other_unit {
        check_time(subject, doubts);
    }
}

/// States a counter that rolls over at another angle than a turn.
fn check_counter(subject: &Subject<'_>, doubts: &mut Doubts) {
    let roll_over = subject
        .turning
        .as_ref()
        .and_then(|(_, turning)| turning.roll_over);
    if let Some(counter) = roll_over {
        let seen = format!(
            "starts again {} after {} rad ({} turns); unwrapped",
            match counter.times {
                1 => "once".to_owned(),
                times => format!("{times} times"),
            },
            number(counter.range),
            number(counter.range / TAU)
        );
        doubts.channel("wheel_angle", Severity::Info, &seen, "");
    }
}

/// Reports an angle too coarse for the wheel's speed.
fn check_resolution(subject: &Subject<'_>, doubts: &mut Doubts) {
    if subject.is_turning_unresolved() && !subject.is_rest() {
        let seen = "is read too seldom or in too large steps to determine how fast the wheel turns; what needs that is \
                    left out";
        doubts.channel("wheel_angle", Severity::Info, seen, "");
    }
}

/// A ratio of the turning to the one expected, and the unit that would explain it.
type Guess = (f64, &'static str);

/// Units of an angle.
const ANGLES: [Guess; 3] = [
    (360.0 / TAU, "in degrees?"),
    (1.0 / TAU, "in turns?"),
    (60.0 / TAU, "integrated from revolutions per minute?"),
];

/// Units of time, for an angle over time. Without a command, a forward speed in mm/s has the same effect: it
/// is reported as a speed.
const TIMES: [Guess; 4] = [
    (10.0, "sample rate or time wrong by a factor of 10?"),
    (0.1, "sample rate or time wrong by a factor of 10?"),
    (1.0e-3, "time in milliseconds?"),
    (1.0e3, "in milliradians, or time in thousands of seconds?"),
];

/// Units of a wheel speed.
const SPEEDS: [Guess; 3] = [
    (360.0 / TAU, "in degrees per second?"),
    (1.0 / TAU, "in turns per second?"),
    (60.0 / TAU, "in revolutions per minute?"),
];

/// Doubts the unit of an angle or of a wheel speed that turns a factor between units faster than it should.
fn check_unit(subject: &Subject<'_>, doubts: &mut Doubts) -> bool {
    let turning = subject.wheel_speed().filter(|_| !subject.is_rest());
    let Some((turning, expected)) = turning.zip(subject.expected_wheel_speed()) else {
        return false;
    };
    let off = |factor: f64| ((turning / expected).abs() / factor - 1.0).abs();
    let guesses = guesses(subject).into_iter();
    let nearest = guesses.min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
    let Some((_, guess)) = nearest.filter(|(factor, _)| off(*factor) < NEAR) else {
        return false;
    };
    let seen = format!(
        "turns at {} rad/s, by speed and slip {} rad/s",
        number(turning),
        number(expected)
    );
    doubts.channel(subject.turning_channel(), Severity::Error, &seen, guess);
    true
}

/// What may be wrong with the unit of what shows the wheel's turning.
fn guesses(subject: &Subject<'_>) -> Vec<Guess> {
    let RunAttributes {
        speed,
        wheel_radius,
        ..
    } = subject.trace.attributes;
    match subject.turning_channel() {
        "wheel_angle" if speed.is_finite() => [&ANGLES[..], &TIMES[..]].concat(),
        "wheel_angle" => ANGLES.to_vec(),
        _ => [&SPEEDS[..], &[(wheel_radius, "the rim's speed in m/s?")]].concat(),
    }
}

fn check_direction(subject: &Subject<'_>, doubts: &mut Doubts) {
    let speed = subject.trace.attributes.speed;
    if let Some(turning) = subject.wheel_speed()
        && turning * speed < 0.0
        && !subject.is_rest()
    {
        let seen = format!(
            "turns at {} rad/s while the run is commanded {} mm/s",
            number(turning),
            number(1.0e3 * speed)
        );
        let guess = "the wheel turns above 0 when driving forward; change its sign";
        doubts.channel(subject.turning_channel(), Severity::Error, &seen, guess);
    }
}

/// Doubts the unit of time where nothing turns that would show it.
fn check_time(subject: &Subject<'_>, doubts: &mut Doubts) {
    let trace = subject.trace;
    let acceleration = trace
        .channel("acceleration_y")
        .filter(|channel| channel.samples.len() > 1);
    if let Some(channel) = acceleration
        && channel.sample_rate < SLOW_ACCELERATION
    {
        let seen = format!("sampled at {} Hz", number(channel.sample_rate));
        let guess = "too slow to show a vibration, or time in milliseconds?";
        doubts.channel(&channel.name, Severity::Warning, &seen, guess);
        return;
    }
    let Some(longest) = trace
        .channels
        .iter()
        .max_by(|a, b| a.duration().total_cmp(&b.duration()))
    else {
        return;
    };
    let duration = longest.duration();
    let way = (subject.forward_speed() * duration).abs();
    let slow = longest.sample_rate < SLOW_LOG;
    if duration > LONGEST_RUN || (slow && way > LONGEST_WAY) {
        let way = if way.is_finite() {
            format!(" and {} m", number(way))
        } else {
            String::new()
        };
        let seen = format!(
            "lasts {} s{way}, sampled at {} Hz",
            number(duration),
            number(longest.sample_rate)
        );
        let guess = "time in milliseconds?";
        doubts.run(Severity::Warning, &seen, guess);
    }
}
