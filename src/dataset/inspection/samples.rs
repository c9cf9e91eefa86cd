//! What is odd about the samples by themselves: units, gaps, clipped and constant channels.

use super::doubts::Doubts;
use super::subject::Subject;
use super::{Severity, number};
use crate::signal::clipped_levels;
use crate::trace::{Channel, unit_of};

pub(super) fn check(subject: &Subject<'_>, doubts: &mut Doubts) {
    let trace = subject.trace;
    if trace.channels.is_empty() && trace.means.is_empty() {
        doubts.run(Severity::Warning, "no channels and no means", "");
    }
    for channel in &trace.channels {
        check_unit(&channel.name, &channel.unit, doubts);
        check_channel(subject, channel, doubts);
    }
    for mean in &trace.means {
        check_unit(&mean.name, &mean.unit, doubts);
        if !mean.value.is_finite() {
            let seen = format!("the mean is {}", mean.value);
            doubts.channel(&mean.name, Severity::Warning, &seen, "");
        }
    }
    check_spans(&trace.channels, doubts);
}

fn check_unit(name: &str, unit: &str, doubts: &mut Doubts) {
    match unit_of(name) {
        Some(known) if known == unit => {}
        Some(known) => {
            let seen = format!("unit is {unit:?}, expected {known:?}");
            doubts.channel(name, Severity::Error, &seen, "convert on import");
        }
        None => {
            let seen = "not a channel this program uses; carried along";
            doubts.channel(name, Severity::Info, seen, "");
        }
    }
}

fn check_channel(subject: &Subject<'_>, channel: &Channel, doubts: &mut Doubts) {
    let Channel { name, samples, .. } = channel;
    if samples.is_empty() {
        doubts.channel(name, Severity::Warning, "no samples", "");
        return;
    }
    check_gaps(subject, channel, doubts);
    let mut numbers = samples.iter().filter(|x| x.is_finite());
    let first = numbers.next();
    let is_constant = samples.len() > 1 && numbers.all(|x| Some(x) == first);
    if let Some(value) = first.filter(|_| is_constant) {
        let turns = ["wheel_angle", "wheel_speed"].contains(&name.as_str());
        let is_locked = subject.trace.attributes.slip_ratio == -1.0;
        let hangs = subject.trace.attributes.is_lifted()
            && (name == "sinkage" || name == "normal_force" && subject.trace.is_simulated());
        let stands = subject.is_rest() && !is_force_like(name) || is_locked && turns || hangs;
        if !stands {
            constant(name, *value, doubts);
        }
    } else if is_force_like(name) {
        check_range(channel, doubts);
    }
}

/// Doubts samples that are no numbers; the slip of a wheel at rest is none by right.
fn check_gaps(subject: &Subject<'_>, channel: &Channel, doubts: &mut Doubts) {
    let is_slip = channel.name == "slip_ratio";
    let samples = channel.samples.iter().enumerate();
    let missing: Vec<usize> = samples
        .filter(|(_, sample)| !sample.is_finite())
        .map(|(index, _)| index)
        .filter(|&index| !is_slip || subject.motion.moves_at(channel.time(index)))
        .collect();
    let gaps = missing.chunk_by(|a, b| b - a == 1).map(<[usize]>::len);
    if let Some(longest) = gaps.max() {
        let seen = format!(
            "{} of {} samples are no numbers, longest gap {} s",
            missing.len(),
            channel.samples.len(),
            number(longest as f64 / channel.sample_rate)
        );
        doubts.channel(&channel.name, Severity::Warning, &seen, "");
    }
}

/// Controlled speeds, slips and angles may legitimately stay at their extreme value.
fn is_force_like(name: &str) -> bool {
    const FORCES: [&str; 4] = [
        "acceleration_y",
        "normal_force",
        "drawbar_pull",
        "driving_torque",
    ];
    FORCES.contains(&name) || unit_of(name).is_none()
}

fn constant(name: &str, value: f64, doubts: &mut Doubts) {
    let seen = format!("constant at {}", number(value));
    let (severity, guess) = match name {
        "forward_speed" | "wheel_speed" | "slip_ratio" => {
            (Severity::Info, "a command in place of a measurement?")
        }
        _ => (Severity::Warning, "is the sensor connected?"),
    };
    doubts.channel(name, severity, &seen, guess);
}

/// Doubts a channel that stays at the end of its sensor's range.
fn check_range(channel: &Channel, doubts: &mut Doubts) {
    let samples = &channel.samples;
    for extreme in clipped_levels(samples) {
        let stuck = samples.iter().filter(|&&x| x == extreme).count();
        let seen = format!(
            "{stuck} of {} samples stuck at {}",
            samples.len(),
            number(extreme)
        );
        let guess = "clipped by the sensor's range?";
        doubts.channel(&channel.name, Severity::Warning, &seen, guess);
    }
}

/// Doubts channels that do not start and end together, to two samples of the slower.
fn check_spans(channels: &[Channel], doubts: &mut Doubts) {
    let longest = channels
        .iter()
        .rev()
        .max_by(|a, b| a.duration().total_cmp(&b.duration()));
    let Some(longest) = longest else { return };
    for channel in channels {
        let slack = 2.0 / channel.sample_rate.min(longest.sample_rate);
        let end = |channel: &Channel| channel.start + channel.duration();
        let apart = (channel.start - longest.start).abs() > slack
            || (end(channel) - end(longest)).abs() > slack;
        if apart && !channel.samples.is_empty() {
            let seen = format!(
                "runs from {} s to {} s, {} from {} s to {} s",
                number(channel.start),
                number(end(channel)),
                longest.name,
                number(longest.start),
                number(end(longest))
            );
            doubts.channel(&channel.name, Severity::Warning, &seen, "");
        }
    }
}
