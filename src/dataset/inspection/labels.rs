//! What is odd about a run as a whole: channels that contradict the command, the label or their
//! own sign and unit.

use super::doubts::Doubts;
use super::subject::{SIGMAS, Steady, Subject, ZERO};
use super::{Severity, number};
use crate::quantity::GRAVITY;
use crate::quantity::SlipRatio;
use crate::terrain::class::TerrainLabel;
use crate::trace::{RunAttributes, SLIP_TOLERANCE, slip_tolerance};

/// Tolerance of the mean normal force about the load [-].
///
/// Vertical balance controls the mean of a good rig to 1 %; a rig with friction drifts by some 10 %.
const LOAD_TOLERANCE: f64 = 0.1;

/// Tolerance of the speed about the command [-]; motors control it to 1 %.
const SPEED_TOLERANCE: f64 = 0.05;

/// Slip [-] above which the motor drives: with less, a slope or the carriage may drag the wheel.
const DRIVING_SLIP: f64 = 0.05;

/// Braking slip [-] above which the ground retards the wheel on any slope of a rig.
const BRAKING_SLIP: f64 = 0.2;

/// Speed [m/s] beyond which a command is in another unit: no rover drives as fast.
const FASTEST_COMMAND: f64 = 10.0;

/// Pull over load [-] beyond which a unit is wrong, and torque over load at the lugs' tips: a
/// locked wheel that ploughs to its axle drags by twice its load.
const MOST_GRIP: f64 = 5.0;

/// Size [m] of stones that a rover drives over.
const LARGEST_STONE: f64 = 0.1;

/// Checks the attributes of a run, and its channels against them one by one.
pub(super) fn check(subject: &Subject<'_>, doubts: &mut Doubts) {
    check_wheel(&subject.trace.attributes, doubts);
    check_command(&subject.trace.attributes, doubts);
    check_load(subject, doubts);
    check_speed(subject, doubts);
    check_slip(subject, doubts);
    check_signs(subject, doubts);
    check_sizes(subject, doubts);
    check_sinkage(subject, doubts);
    check_class(subject, doubts);
}

/// Checks the pull against the load alone, where nothing else has shown it to be wrong.
pub(super) fn check_grip(subject: &Subject<'_>, doubts: &mut Doubts) {
    let load = subject.trace.attributes.load;
    if let Some(Steady { mean: pull, .. }) = subject.contact("drawbar_pull")
        && pull.abs() > load
        && load > 0.0
        && !doubts.has_any(&["drawbar_pull"])
    {
        let seen = format!(
            "mean is {} N, more than the load of {} N",
            number(pull),
            number(load)
        );
        let guess = "a lug that hooks, a wedged stone?";
        doubts.channel("drawbar_pull", Severity::Warning, &seen, guess);
    }
}

fn check_wheel(attributes: &RunAttributes, doubts: &mut Doubts) {
    let RunAttributes {
        wheel_radius,
        wheel_width,
        plate,
        ..
    } = *attributes;
    if plate.is_some() {
        return;
    }
    for (name, length) in [
        ("wheel_radius_m", wheel_radius),
        ("wheel_width_m", wheel_width),
    ] {
        if length.is_nan() {
            let seen = format!("{name} is not known; what needs it is left out");
            doubts.run(Severity::Info, &seen, "");
        } else if !(0.01..=2.0).contains(&length) {
            let seen = format!("{name} is {}", number(length));
            doubts.run(Severity::Error, &seen, "millimetres?");
        }
    }
    check_lugs(attributes, doubts);
}

fn check_lugs(attributes: &RunAttributes, doubts: &mut Doubts) {
    let (lugs, height) = (attributes.lugs(), attributes.lug_height);
    let Some(count) = lugs.count else {
        let seen = format!("{lugs}; what needs their count is left out");
        return doubts.run(Severity::Info, &seen, "");
    };
    if !height.is_nan() && (count > 0) != (height > 0.0) {
        let seen = format!("{count} lugs of {} m", number(height));
        doubts.run(Severity::Warning, &seen, "one of them is wrong");
    }
}

/// Doubts commands in another unit; where the run has them only, no channel contradicts them.
fn check_command(attributes: &RunAttributes, doubts: &mut Doubts) {
    let RunAttributes {
        speed, slip_ratio, ..
    } = *attributes;
    if slip_ratio.abs() > 1.0 {
        let seen = format!("slip_ratio is {}, outside [-1, 1]", number(slip_ratio));
        doubts.run(Severity::Error, &seen, "per cent?");
    }
    if speed.abs() > FASTEST_COMMAND {
        let seen = format!("speed_m_s is {}", number(speed));
        doubts.run(Severity::Error, &seen, "in mm/s?");
    }
}

fn check_load(subject: &Subject<'_>, doubts: &mut Doubts) {
    let name = "normal_force";
    let Some(force) = subject.mean(name) else {
        return;
    };
    let load = subject.trace.attributes.load;
    let expected = expected_force(&subject.trace.attributes, force);
    if force < 0.0 && load != 0.0 {
        let seen = format!("mean is {} N", number(force));
        let guess = "the normal force points upward on the wheel; change its sign";
        doubts.channel(name, Severity::Error, &seen, guess);
    } else if load > 0.0 && (force / expected - 1.0).abs() > LOAD_TOLERANCE {
        let (severity, guess) = match factor(force / expected) {
            Some(guess) => (Severity::Error, guess),
            None => (
                Severity::Warning,
                "the load was not held, or its label is wrong",
            ),
        };
        let seen = format!(
            "mean is {} N, commanded load {} N",
            number(force),
            number(load)
        );
        doubts.channel(name, severity, &seen, guess);
    }
}

/// Normal force [N] that sensors tared on the level read of the commanded load, where they read `force` [N]: on a slope
/// that of the load's part across it and of the wheel's weight, of which only the bounds are known without its mass.
fn expected_force(attributes: &RunAttributes, force: f64) -> f64 {
    let RunAttributes {
        load,
        slope_deg,
        wheel_mass,
        ..
    } = *attributes;
    let cos = libm::cos(slope_deg.to_radians());
    match wheel_mass {
        Some(mass) => load * cos + mass * GRAVITY * (1.0 - cos),
        None => force.max(load * cos).min(load),
    }
}

/// The unit confusion that explains a ratio of measured to commanded to 5 %, if any.
fn factor(ratio: f64) -> Option<&'static str> {
    const FACTORS: [(f64, &str); 8] = [
        (GRAVITY, "9.8 times: newton against kilogram?"),
        (1.0 / GRAVITY, "a 9.8th: kilogram against newton?"),
        (10.0, "10 times: a gain or a decimal place?"),
        (0.1, "a tenth: a gain or a decimal place?"),
        (1.0e3, "1000 times: a wrong prefix (milli, kilo)?"),
        (1.0e-3, "a 1000th: a wrong prefix (milli, kilo)?"),
        (3.6, "3.6 times: km/h against m/s?"),
        (-1.0, "same size, other sign: which way is forward?"),
    ];
    let off = |factor: f64| (ratio / factor - 1.0).abs();
    let nearest = FACTORS
        .iter()
        .min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
    (off(nearest.0) < 0.05).then_some(nearest.1)
}

fn check_speed(subject: &Subject<'_>, doubts: &mut Doubts) {
    let name = "forward_speed";
    let Some(speed) = subject.mean(name).filter(|_| !subject.is_rest()) else {
        return;
    };
    let commanded = subject.trace.attributes.speed;
    let turning = commanded
        .is_nan()
        .then(|| speed_by_turning(subject))
        .flatten();
    let expected = turning.unwrap_or(commanded);
    let known = expected.is_finite() && expected != 0.0;
    if !known || (speed / expected - 1.0).abs() <= SPEED_TOLERANCE {
        return;
    }
    let (severity, guess) = match factor(speed / expected) {
        Some(guess) => (Severity::Error, guess),
        None => (
            Severity::Warning,
            "commanded value incorrect? use the measured value",
        ),
    };
    let [speed, expected] = [speed, expected].map(|speed| number(1.0e3 * speed));
    let seen = if turning.is_some() {
        format!("mean is {speed} mm/s, by wheel angle and slip {expected} mm/s")
    } else {
        format!("commanded {expected} mm/s, measured {speed} mm/s")
    };
    doubts.channel(name, severity, &seen, guess);
}

/// Forward speed [m/s] by the wheel's turning and its measured slip.
fn speed_by_turning(subject: &Subject<'_>) -> Option<f64> {
    let driving = 0.0..1.0;
    let slip = subject
        .mean("slip_ratio")
        .filter(|slip| driving.contains(slip))?;
    let rim = subject.trace.attributes.wheel_radius * subject.wheel_speed()?;
    Some(rim * (1.0 - slip))
}

fn check_slip(subject: &Subject<'_>, doubts: &mut Doubts) {
    let Some((channel, slip)) = subject.shown_slip() else {
        return;
    };
    let is_by_turning = channel != "slip_ratio";
    if is_by_turning && doubts.has_any(&[channel, "forward_speed"]) {
        return;
    }
    let RunAttributes {
        speed: ordered,
        slip_ratio: commanded,
        ..
    } = subject.trace.attributes;
    let scatter = subject
        .steady("slip_ratio")
        .filter(|_| !is_by_turning)
        .map_or(0.0, |steady| steady.sd);
    if !(-1.0..=1.0).contains(&slip) {
        let seen = format!("mean is {}, outside [-1, 1]", number(slip));
        doubts.channel(channel, Severity::Error, &seen, "per cent?");
    } else if (slip - commanded).abs() > slip_tolerance(scatter) {
        let measured = subject.mean("forward_speed").unwrap_or(ordered);
        let ordered = if ordered.is_nan() { measured } else { ordered };
        let rim = |slip, forward| match rim_speed(slip, forward) {
            Some(speed) => format!(" (rim at {} mm/s)", number(1.0e3 * speed)),
            None => String::new(),
        };
        let seen = format!(
            "commanded slip {}{}, measured slip {}{}",
            number(commanded),
            rim(commanded, ordered),
            number(slip),
            rim(slip, measured)
        );
        let guess = if (slip + commanded).abs() <= SLIP_TOLERANCE && !is_by_turning {
            "same size, other sign: slip is above 0 where the rim is faster than the wheel"
        } else {
            "commanded value incorrect? use the measured value"
        };
        doubts.channel(channel, Severity::Warning, &seen, guess);
    }
}

/// Rim speed [m/s] at `slip` and `forward_speed` [m/s], where it follows from the slip.
fn rim_speed(slip: f64, forward_speed: f64) -> Option<f64> {
    let slip = SlipRatio::new(slip).ok()?;
    let speed = slip.wheel_speed(1.0, forward_speed)?;
    speed.is_finite().then_some(speed)
}

fn check_signs(subject: &Subject<'_>, doubts: &mut Doubts) {
    let RunAttributes {
        slip_ratio,
        load,
        wheel_radius,
        ..
    } = subject.trace.attributes;
    if subject.is_rest() || subject.is_over_one_stone() {
        return;
    }
    let slip_ratio = if slip_ratio.is_finite() {
        slip_ratio
    } else {
        subject.slip()
    };
    let direction = subject.direction();
    let along = |name: &str, load: f64| {
        let steady = subject.contact(name)?;
        let least = SIGMAS * steady.sd + ZERO * load.max(0.0);
        (steady.mean.abs() > least).then_some(direction * steady.mean)
    };
    if slip_ratio > DRIVING_SLIP
        && let Some(torque) = along("driving_torque", load * wheel_radius)
        && torque < 0.0
    {
        let seen = format!(
            "mean is {} N m while driving with slip {}",
            number(direction * torque),
            number(slip_ratio)
        );
        let guess = "a motor that drives forward has a torque above 0; change its sign";
        doubts.channel("driving_torque", Severity::Warning, &seen, guess);
    }
    if slip_ratio < -BRAKING_SLIP
        && let Some(pull) = along("drawbar_pull", load)
        && pull > 0.0
    {
        let seen = format!(
            "mean is {} N while braking with slip {}",
            number(direction * pull),
            number(slip_ratio)
        );
        let guess = "a wheel that brakes pulls backward; change its sign";
        doubts.channel("drawbar_pull", Severity::Warning, &seen, guess);
    }
}

/// Doubts a pull or a torque that no ground can give at this load.
fn check_sizes(subject: &Subject<'_>, doubts: &mut Doubts) {
    let RunAttributes {
        load, wheel_radius, ..
    } = subject.trace.attributes;
    let tip_radius = wheel_radius + tallest_lugs(&subject.trace.attributes);
    for (name, unit, most, guess) in [
        ("drawbar_pull", "N", load, "a wrong prefix (milli, kilo)?"),
        (
            "driving_torque",
            "N m",
            load * tip_radius,
            "newton millimetres?",
        ),
    ] {
        if let Some(mean) = subject.mean(name)
            && mean.abs() > MOST_GRIP * most
            && load > 0.0
        {
            let seen = format!(
                "mean is {} {unit} at a load of {} N",
                number(mean),
                number(load)
            );
            doubts.channel(name, Severity::Error, &seen, guess);
        }
    }
}

fn check_sinkage(subject: &Subject<'_>, doubts: &mut Doubts) {
    let name = "sinkage";
    let Some(sinkage) = subject.mean(name) else {
        return;
    };
    let attributes = &subject.trace.attributes;
    let wheel_radius = attributes.wheel_radius;
    let lowest = -(tallest_lugs(attributes) + highest_rise(attributes));
    if sinkage > wheel_radius {
        let seen = format!(
            "mean is {} m, above the wheel's radius {} m",
            number(sinkage),
            number(wheel_radius)
        );
        doubts.channel(name, Severity::Error, &seen, "millimetres?");
    } else if !attributes.is_lifted() && sinkage < lowest {
        let seen = format!(
            "mean is {} m: the rim stands above the ground by more than its lugs",
            number(sinkage)
        );
        let guess = "change its sign or tare it";
        doubts.channel(name, Severity::Warning, &seen, guess);
    }
}

/// Lug height [m]; where it is unknown, as tall as lugs of rovers are over their wheel's radius.
fn tallest_lugs(attributes: &RunAttributes) -> f64 {
    match attributes.lug_height {
        unknown if unknown.is_nan() => 0.25 * attributes.wheel_radius,
        height => height,
    }
}

/// Height [m] of the lugs' tips above the mean surface of the ground: that of the stones, where there may be
/// any.
fn highest_rise(attributes: &RunAttributes) -> f64 {
    let radius = attributes.wheel_radius;
    match attributes.terrain {
        Some(TerrainLabel::Reference | TerrainLabel::Hard | TerrainLabel::Sand) => 0.1 * radius,
        _ => LARGEST_STONE.max(0.1 * radius),
    }
}

fn check_class(subject: &Subject<'_>, doubts: &mut Doubts) {
    let trace = subject.trace;
    let shown = trace.truth.as_ref().and_then(|truth| truth.class());
    if let (Some(label), Some(shown)) = (trace.attributes.class, shown)
        && label != shown
    {
        let seen = format!("labelled {label}, but every window of its ground truth is {shown}");
        doubts.run(Severity::Warning, &seen, "");
    }
}
