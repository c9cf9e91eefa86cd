//! What the wheel's angle contradicts: its unit, its direction, its counter, the unit of time.

use super::doubts::Doubts;
use super::subject::Subject;
use super::{Severity, number};
use crate::quantity::SlipRatio;
use crate::trace::RunAttributes;
use std::f64::consts::TAU;

/// How far a ratio of speeds may lie off a factor between units [-]; slip that was not held changes it.
const NEAR: f64 = 0.1;

/// Sample rate [Hz] of an acceleration below which its time cannot be in seconds: a lug's blow lasts some
/// milliseconds, and who logs an accelerometer once a second learns nothing.
const NO_ACCELERATION: f64 = 2.0;

/// Sample rate [Hz] of an acceleration below which it shows no vibration.
const SLOW_ACCELERATION: f64 = 20.0;

/// Length [s] of a record that no single run has: two hours.
const LONGEST_RUN: f64 = 7200.0;

/// Way [m] that no rig has, and that a rover drives in one run only where it is logged as seldom as
/// [`NO_ACCELERATION`].
const LONGEST_WAY: f64 = 100.0;

pub(super) fn check(subject: &Subject<'_>, doubts: &mut Doubts) {
    check_counter(subject, doubts);
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
            "starts again {} times after {} rad ({} turns); taken for one angle that goes on",
            counter.times,
            number(counter.range),
            number(counter.range / TAU)
        );
        doubts.channel("wheel_angle", Severity::Info, &seen, "");
    }
}

/// Doubts the unit of an angle that turns a factor between units faster than it should.
fn check_unit(subject: &Subject<'_>, doubts: &mut Doubts) -> bool {
    const UNITS: [(f64, &str); 3] = [
        (360.0 / TAU, "in degrees?"),
        (1.0 / TAU, "in turns?"),
        (60.0 / TAU, "integrated from revolutions per minute?"),
    ];
    // Without a command, a speed in mm/s looks the same: it is doubted as a speed.
    const UNITS_OF_TIME: [(f64, &str); 2] = [
        (1.0e-3, "time in milliseconds?"),
        (1.0e3, "in milliradians, or time in thousands of seconds?"),
    ];
    let Some((turning, expected)) = subject.wheel_speed().zip(expected_wheel_speed(subject)) else {
        return false;
    };
    let ratio = (turning / expected).abs();
    let near = |(factor, _): &&(f64, &str)| (ratio / factor - 1.0).abs() < NEAR;
    let units_of_time = match subject.trace.attributes.speed.is_finite() {
        true => &UNITS_OF_TIME[..],
        false => &[],
    };
    let Some((_, guess)) = UNITS.iter().chain(units_of_time).find(near) else {
        return false;
    };
    let seen = format!(
        "turns at {} rad/s, by speed and slip {} rad/s",
        number(turning),
        number(expected)
    );
    doubts.channel("wheel_angle", Severity::Error, &seen, guess);
    true
}

/// Wheel speed [rad/s] by forward speed and slip, as measured, else as commanded.
fn expected_wheel_speed(subject: &Subject<'_>) -> Option<f64> {
    let RunAttributes {
        speed,
        slip_ratio,
        wheel_radius,
        ..
    } = subject.trace.attributes;
    let forward = if speed.is_finite() {
        speed
    } else {
        subject.forward_speed()
    };
    let slip = if slip_ratio.is_finite() {
        slip_ratio
    } else {
        subject.mean("slip_ratio")?
    };
    let speed = SlipRatio::new(slip)
        .ok()?
        .wheel_speed(wheel_radius, forward)?;
    (speed.is_finite() && speed != 0.0).then_some(speed)
}

fn check_direction(subject: &Subject<'_>, doubts: &mut Doubts) {
    let speed = subject.trace.attributes.speed;
    if let Some(turning) = subject.wheel_speed()
        && turning * speed < 0.0
        && !subject.motion.is_rest()
    {
        let seen = format!(
            "turns at {} rad/s while the run is commanded {} mm/s",
            number(turning),
            number(1.0e3 * speed)
        );
        let guess = "the wheel angle grows when driving forward; change its sign";
        doubts.channel("wheel_angle", Severity::Error, &seen, guess);
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
        let rate = number(channel.sample_rate);
        let (severity, guess) = if channel.sample_rate < NO_ACCELERATION {
            (Severity::Error, "time in milliseconds?")
        } else {
            (
                Severity::Warning,
                "too slow to show a vibration, or time in milliseconds?",
            )
        };
        doubts.channel(
            &channel.name,
            severity,
            &format!("sampled at {rate} Hz"),
            guess,
        );
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
    let slow = longest.sample_rate < NO_ACCELERATION;
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
