//! What is odd about a run as a whole: channels that contradict the command, the label or their
//! own sign and unit.

use super::{Doubts, Severity, number};
use crate::quantity::GRAVITY;
use crate::quantity::SlipRatio;
use crate::trace::{Channel, RunAttributes, Trace};
use std::f64::consts::TAU;

/// How far the mean normal force may lie off the load [-].
///
/// Vertical balance holds the mean of a good rig to 1 %; a rig with friction drifts by some 10 %.
const LOAD_TOLERANCE: f64 = 0.1;

/// How far the speed may lie off the command [-]; motors hold it to 1 %.
const SPEED_TOLERANCE: f64 = 0.05;

/// How far the slip may lie off the command [-]; a measured campaign of 24 runs held 0.0015.
pub const SLIP_TOLERANCE: f64 = 0.03;

/// Slip [-] above which the motor drives: with less, a slope or the carriage may drag the wheel.
const DRIVING_SLIP: f64 = 0.05;

/// Braking slip [-] above which the ground holds the wheel back on any slope a rig has.
const BRAKING_SLIP: f64 = 0.2;

/// Sample rate [Hz] of an acceleration below which its time cannot be in seconds: a lug's blow lasts
/// some milliseconds, and no rig records its vibration so seldom.
const SLOWEST_ACCELERATION: f64 = 20.0;

/// Pull over load [-] beyond which a unit is wrong, and torque over load at the lugs' tips: a
/// locked wheel that ploughs to its axle drags by twice its load.
const MOST_GRIP: f64 = 5.0;

pub(super) fn check(trace: &Trace, doubts: &mut Doubts) {
    check_wheel(&trace.attributes, doubts);
    check_load(trace, doubts);
    check_speed(trace, doubts);
    check_slip(trace, doubts);
    check_signs(trace, doubts);
    check_sizes(trace, doubts);
    check_pull(trace, doubts);
    check_acceleration(trace, doubts);
    check_time(trace, doubts);
    check_sinkage(trace, doubts);
    check_class(trace, doubts);
}

fn check_wheel(attributes: &RunAttributes, doubts: &mut Doubts) {
    let RunAttributes {
        wheel_radius,
        wheel_width,
        lug_count,
        lug_height,
        ..
    } = *attributes;
    for (name, length) in [
        ("wheel_radius_m", wheel_radius),
        ("wheel_width_m", wheel_width),
    ] {
        if length.is_nan() {
            let message = format!("{name} is not known; what needs it is left out");
            doubts.run(Severity::Info, message);
        } else if !(0.01..=2.0).contains(&length) {
            let message = format!("{name} is {}: millimetres?", number(length));
            doubts.run(Severity::Error, message);
        }
    }
    if (lug_count > 0) != (lug_height > 0.0) {
        let message = format!(
            "{lug_count} lugs of {} m: one of them is wrong",
            number(lug_height)
        );
        doubts.run(Severity::Warning, message);
    }
}

fn check_load(trace: &Trace, doubts: &mut Doubts) {
    let name = "normal_force";
    let Some(force) = trace.steady_mean(name) else {
        return;
    };
    let load = trace.attributes.load;
    if force < 0.0 && load != 0.0 {
        let message = format!(
            "mean is {} N: the normal force points upward on the wheel; change its sign",
            number(force)
        );
        doubts.channel(name, Severity::Error, message);
    } else if load > 0.0 && (force / load - 1.0).abs() > LOAD_TOLERANCE {
        let (severity, guess) = match factor(force / load) {
            Some(guess) => (Severity::Error, guess),
            None => (
                Severity::Warning,
                "the load was not held, or its label is wrong",
            ),
        };
        let message = format!(
            "mean is {} N, commanded load {} N: {guess}",
            number(force),
            number(load)
        );
        doubts.channel(name, severity, message);
    }
}

/// What a ratio of measured to commanded looks like, to 5 %, if it looks like a mix-up of units.
fn factor(ratio: f64) -> Option<&'static str> {
    const FACTORS: [(f64, &str); 7] = [
        (GRAVITY, "9.8 times: newton against kilogram?"),
        (1.0 / GRAVITY, "a 9.8th: kilogram against newton?"),
        (10.0, "10 times: a gain or a decimal place?"),
        (0.1, "a tenth: a gain or a decimal place?"),
        (1.0e3, "1000 times: a wrong prefix (milli, kilo)?"),
        (1.0e-3, "a 1000th: a wrong prefix (milli, kilo)?"),
        (-1.0, "same size, other sign: which way is forward?"),
    ];
    let off = |factor: f64| (ratio / factor - 1.0).abs();
    let nearest = FACTORS
        .iter()
        .min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
    (off(nearest.0) < 0.05).then_some(nearest.1)
}

fn check_speed(trace: &Trace, doubts: &mut Doubts) {
    let name = "forward_speed";
    let commanded = trace.attributes.speed;
    let Some(speed) = trace.steady_mean(name) else {
        return;
    };
    let known = commanded != 0.0 && !commanded.is_nan();
    if !known || (speed / commanded - 1.0).abs() <= SPEED_TOLERANCE {
        return;
    }
    let (severity, guess) = match factor(speed / commanded) {
        Some(guess) => (Severity::Error, guess),
        None => (Severity::Warning, "the label is wrong; trust the channel"),
    };
    let message = format!(
        "the run commanded {} mm/s ran at {} mm/s: {guess}",
        number(1.0e3 * commanded),
        number(1.0e3 * speed)
    );
    doubts.channel(name, severity, message);
}

fn check_slip(trace: &Trace, doubts: &mut Doubts) {
    if let Some(message) = unit_of_angle(trace) {
        doubts.channel("wheel_angle", Severity::Error, message);
    }
    let Some((channel, slip)) = shown_slip(trace) else {
        return;
    };
    let commanded = trace.attributes.slip_ratio;
    if channel == "wheel_angle" && unit_of_angle(trace).is_some() {
        return;
    }
    if !(-1.0..=1.0).contains(&slip) {
        let message = format!("mean is {}, outside [-1, 1]: per cent?", number(slip));
        doubts.channel(channel, Severity::Error, message);
    } else if (slip - commanded).abs() > SLIP_TOLERANCE {
        let ordered = trace.attributes.speed;
        let measured = trace.steady_mean("forward_speed").unwrap_or(ordered);
        let ordered = if ordered.is_nan() { measured } else { ordered };
        let rim = |slip, forward| match rim_speed(slip, forward) {
            Some(speed) => format!(" (rim at {} mm/s)", number(1.0e3 * speed)),
            None => String::new(),
        };
        let message = format!(
            "the run commanded slip {}{} ran at slip {}{}: the label is wrong; trust the channel",
            number(commanded),
            rim(commanded, ordered),
            number(slip),
            rim(slip, measured)
        );
        doubts.channel(channel, Severity::Warning, message);
    }
}

/// What the unit of the wheel angle must be for the wheel to turn as commanded, if not radian.
fn unit_of_angle(trace: &Trace) -> Option<String> {
    let RunAttributes {
        speed,
        slip_ratio,
        wheel_radius,
        ..
    } = trace.attributes;
    let turning = wheel_speed(trace.channel("wheel_angle")?)?;
    let commanded = rim_speed(slip_ratio, speed)? / wheel_radius;
    let ratio = (turning / commanded).abs();
    let units = [("degrees", 360.0 / TAU), ("turns", 1.0 / TAU)];
    let (unit, _) = units
        .iter()
        .find(|(_, size)| (ratio / size - 1.0).abs() < 0.1)?;
    Some(format!(
        "turns at {} rad/s, commanded {} rad/s: in {unit}?",
        number(turning),
        number(commanded)
    ))
}

/// The slip that the channels show, and the channel that shows it: slip itself, else the wheel's
/// turning against the forward speed, measured or commanded.
fn shown_slip(trace: &Trace) -> Option<(&'static str, f64)> {
    if let Some(slip) = trace.steady_mean("slip_ratio") {
        return Some(("slip_ratio", slip));
    }
    let wheel_speed = wheel_speed(trace.channel("wheel_angle")?)?;
    let measured = trace.steady_mean("forward_speed");
    let forward = measured.unwrap_or(trace.attributes.speed);
    let radius = trace.attributes.wheel_radius;
    let known = [radius, wheel_speed, forward].iter().all(|x| x.is_finite());
    known.then(|| {
        let slip = SlipRatio::from_motion(radius, wheel_speed, forward);
        ("wheel_angle", slip.get())
    })
}

/// Mean wheel speed [rad/s] over the middle half of the wheel angle.
fn wheel_speed(wheel_angle: &Channel) -> Option<f64> {
    let steady = wheel_angle.steady();
    let numbers = || steady.iter().enumerate().filter(|(_, x)| x.is_finite());
    let (first, from) = numbers().next()?;
    let (last, to) = numbers().next_back()?;
    (last > first).then(|| (to - from) * wheel_angle.sample_rate / (last - first) as f64)
}

/// Rim speed [m/s] at `slip` and `forward_speed` [m/s], where the slip tells it.
fn rim_speed(slip: f64, forward_speed: f64) -> Option<f64> {
    let slip = SlipRatio::new(slip).ok()?;
    let speed = slip.wheel_speed(1.0, forward_speed)?;
    speed.is_finite().then_some(speed)
}

fn check_signs(trace: &Trace, doubts: &mut Doubts) {
    let RunAttributes {
        speed, slip_ratio, ..
    } = trace.attributes;
    let wheel_speed = trace.channel("wheel_angle").and_then(wheel_speed);
    if let Some(turning) = wheel_speed
        && turning * speed < 0.0
    {
        let message = format!(
            "turns at {} rad/s while the run is commanded {} mm/s: the wheel angle grows when \
             driving forward; change its sign",
            number(turning),
            number(1.0e3 * speed)
        );
        doubts.channel("wheel_angle", Severity::Error, message);
    }
    // Where nobody knows the speed, forward is the common case.
    let direction = if speed.is_nan() { 1.0 } else { speed };
    if let Some(torque) = trace.steady_mean("driving_torque")
        && torque * direction < 0.0
        && slip_ratio > DRIVING_SLIP
    {
        let message = format!(
            "mean is {} N m while driving with slip {}: a motor that drives forward has a torque \
             above 0; change its sign",
            number(torque),
            number(slip_ratio)
        );
        doubts.channel("driving_torque", Severity::Warning, message);
    }
    if let Some(pull) = trace.steady_mean("drawbar_pull")
        && pull * direction > 0.0
        && slip_ratio < -BRAKING_SLIP
    {
        let message = format!(
            "mean is {} N while braking with slip {}: a wheel that brakes pulls backward; change \
             its sign",
            number(pull),
            number(slip_ratio)
        );
        doubts.channel("drawbar_pull", Severity::Warning, message);
    }
}

/// Doubts a pull or a torque that no ground can give at this load.
fn check_sizes(trace: &Trace, doubts: &mut Doubts) {
    let RunAttributes {
        load,
        wheel_radius,
        lug_height,
        ..
    } = trace.attributes;
    let tip_radius = wheel_radius + lug_height;
    for (name, unit, most, guess) in [
        ("drawbar_pull", "N", load, "a wrong prefix (milli, kilo)?"),
        (
            "driving_torque",
            "N m",
            load * tip_radius,
            "newton millimetres?",
        ),
    ] {
        let most = MOST_GRIP * most;
        if let Some(mean) = trace.steady_mean(name)
            && mean.abs() > most
            && load > 0.0
        {
            let message = format!(
                "mean is {} {unit} at a load of {} N: {guess}",
                number(mean),
                number(load)
            );
            doubts.channel(name, Severity::Error, message);
        }
    }
}

/// Doubts a pull beyond the load, which a unit does not explain.
fn check_pull(trace: &Trace, doubts: &mut Doubts) {
    let load = trace.attributes.load;
    if let Some(pull) = trace.steady_mean("drawbar_pull")
        && (load..=MOST_GRIP * load).contains(&pull.abs())
        && load > 0.0
    {
        let message = format!(
            "mean is {} N, more than the load of {} N: a lug that hooks, a wedged stone?",
            number(pull),
            number(load)
        );
        doubts.channel("drawbar_pull", Severity::Warning, message);
    }
}

fn check_acceleration(trace: &Trace, doubts: &mut Doubts) {
    let name = "acceleration_y";
    let Some(mean) = trace.steady_mean(name) else {
        return;
    };
    const GUESSES: [(f64, &str); 5] = [
        (GRAVITY, "gravity is still in it; subtract it on import"),
        (1.0, "in units of g, with gravity in it?"),
        (
            GRAVITY * GRAVITY,
            "converted from g twice, with gravity in it?",
        ),
        (1.0e2 * GRAVITY, "in cm/s^2, with gravity in it?"),
        (1.0e3 * GRAVITY, "in mm/s^2 or milli-g, with gravity in it?"),
    ];
    let near = |(value, _): &&(f64, &str)| (mean.abs() / value - 1.0).abs() < 0.05;
    let Some((_, guess)) = GUESSES.iter().find(near) else {
        return;
    };
    let message = format!("mean is {} m/s^2: {guess}", number(mean));
    doubts.channel(name, Severity::Error, message);
}

fn check_time(trace: &Trace, doubts: &mut Doubts) {
    let name = "acceleration_y";
    let rate = trace.channel(name).map(|channel| channel.sample_rate);
    if let Some(rate) = rate.filter(|rate| *rate < SLOWEST_ACCELERATION) {
        let message = format!("sampled at {} Hz: time in milliseconds?", number(rate));
        doubts.channel(name, Severity::Error, message);
    }
}

fn check_sinkage(trace: &Trace, doubts: &mut Doubts) {
    let name = "sinkage";
    let Some(sinkage) = trace.steady_mean(name) else {
        return;
    };
    let RunAttributes {
        wheel_radius,
        lug_height,
        ..
    } = trace.attributes;
    if sinkage > wheel_radius {
        let message = format!(
            "mean is {} m, above the wheel's radius {} m: millimetres?",
            number(sinkage),
            number(wheel_radius)
        );
        doubts.channel(name, Severity::Error, message);
    } else if !trace.attributes.is_lifted() && sinkage < -(lug_height + 0.1 * wheel_radius) {
        let message = format!(
            "mean is {} m: the rim stands above the ground by more than its lugs; change its sign \
             or tare it",
            number(sinkage)
        );
        doubts.channel(name, Severity::Warning, message);
    }
}

fn check_class(trace: &Trace, doubts: &mut Doubts) {
    let shown = trace.truth.as_ref().and_then(|truth| truth.class());
    if let (Some(label), Some(shown)) = (trace.attributes.class, shown)
        && label != shown
    {
        let message = format!("labelled {label}, but every window of its ground truth is {shown}");
        doubts.run(Severity::Warning, message);
    }
}
