//! What is odd about the samples by themselves: units, gaps, clipped and constant channels.

use super::{Doubts, Severity, number};
use crate::trace::{Channel, Trace, unit_of};

/// Samples in a row at an extreme value that look like a stay [-].
const STAY: usize = 3;

/// Times as many samples at the extreme value as at the next one, from which it is clipped [-].
///
/// A sine that is only quantised has at most 1 / (√2 - 1) = 2.4 times as many at its crest.
const CROWD: usize = 5;

pub(super) fn check(trace: &Trace, doubts: &mut Doubts) {
    if trace.channels.is_empty() && trace.means.is_empty() {
        doubts.run(Severity::Warning, "no channels and no means".to_owned());
    }
    for channel in &trace.channels {
        check_unit(&channel.name, &channel.unit, doubts);
        check_channel(channel, doubts);
    }
    for mean in &trace.means {
        check_unit(&mean.name, &mean.unit, doubts);
        if !mean.value.is_finite() {
            let message = format!("the mean is {}", mean.value);
            doubts.channel(&mean.name, Severity::Warning, message);
        }
    }
    check_spans(&trace.channels, doubts);
}

fn check_unit(name: &str, unit: &str, doubts: &mut Doubts) {
    match unit_of(name) {
        Some(known) if known == unit => {}
        Some(known) => {
            let message = format!("unit is {unit:?}, expected {known:?}: convert on import");
            doubts.channel(name, Severity::Error, message);
        }
        None => {
            let message = "not a channel this program uses; carried along".to_owned();
            doubts.channel(name, Severity::Info, message);
        }
    }
}

fn check_channel(channel: &Channel, doubts: &mut Doubts) {
    let Channel { name, samples, .. } = channel;
    if samples.is_empty() {
        doubts.channel(name, Severity::Warning, "no samples".to_owned());
        return;
    }
    let longest = samples.split(|x| x.is_finite()).map(<[f64]>::len).max();
    if let Some(longest @ 1..) = longest {
        let missing = samples.iter().filter(|x| !x.is_finite()).count();
        let seconds = number(longest as f64 / channel.sample_rate);
        let message = format!(
            "{missing} of {} samples are no numbers, longest gap {seconds} s",
            samples.len()
        );
        doubts.channel(name, Severity::Warning, message);
    }
    match levels(samples) {
        Some([low, _, _, high]) if low == high && samples.len() > 1 => constant(name, low, doubts),
        Some([low, above_low, below_high, high]) if is_force_like(name) => {
            clipped(channel, [low, above_low], doubts);
            clipped(channel, [high, below_high], doubts);
        }
        _ => {}
    }
}

/// Speeds, slips and angles that a motor holds stay at their extreme value by right.
fn is_force_like(name: &str) -> bool {
    const FORCES: [&str; 4] = [
        "acceleration_y",
        "normal_force",
        "drawbar_pull",
        "driving_torque",
    ];
    FORCES.contains(&name) || unit_of(name).is_none()
}

/// The lowest, next to lowest, next to highest and highest of the numbers among `samples`.
fn levels(samples: &[f64]) -> Option<[f64; 4]> {
    let finite = || samples.iter().copied().filter(|x| x.is_finite());
    let low = finite().reduce(f64::min)?;
    let high = finite().reduce(f64::max)?;
    let above_low = finite().filter(|&x| x > low).fold(high, f64::min);
    let below_high = finite().filter(|&x| x < high).fold(low, f64::max);
    Some([low, above_low, below_high, high])
}

fn constant(name: &str, value: f64, doubts: &mut Doubts) {
    let value = number(value);
    let (severity, guess) = match name {
        "forward_speed" | "slip_ratio" => (Severity::Info, "a command in place of a measurement?"),
        _ => (Severity::Warning, "is the sensor connected?"),
    };
    let message = format!("constant at {value}: {guess}");
    doubts.channel(name, severity, message);
}

/// Doubts a channel that stays at its extreme value.
fn clipped(channel: &Channel, levels: [f64; 2], doubts: &mut Doubts) {
    let [extreme, _] = levels;
    if let Some(stuck) = stuck_at(&channel.samples, levels) {
        let message = format!(
            "{stuck} of {} samples stuck at {}: clipped by the sensor's range?",
            channel.samples.len(),
            number(extreme)
        );
        doubts.channel(&channel.name, Severity::Warning, message);
    }
}

/// How many samples lie at the `extreme` value, where they stay there and the `next` one is far
/// rarer. Zero is where a force ends by nature.
fn stuck_at(samples: &[f64], [extreme, next]: [f64; 2]) -> Option<usize> {
    if extreme == 0.0 {
        return None;
    }
    let count = |level: f64| samples.iter().filter(|&&x| x == level).count();
    let mut stays = samples.chunk_by(|a, b| a == b);
    let stuck = stays.any(|stay| stay.len() >= STAY && stay[0] == extreme);
    (stuck && count(extreme) >= CROWD * count(next)).then(|| count(extreme))
}

/// The levels at which `samples` are clipped: none, one or both ends of a sensor's range.
pub(crate) fn clipped_levels(samples: &[f64]) -> Vec<f64> {
    let Some([low, above_low, below_high, high]) = levels(samples) else {
        return Vec::new();
    };
    let ends = [[low, above_low], [high, below_high]].into_iter();
    ends.filter(|&levels| stuck_at(samples, levels).is_some())
        .map(|[extreme, _]| extreme)
        .collect()
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
            let message = format!(
                "runs from {} s to {} s, {} from {} s to {} s",
                number(channel.start),
                number(end(channel)),
                longest.name,
                number(longest.start),
                number(end(longest))
            );
            doubts.channel(&channel.name, Severity::Warning, message);
        }
    }
}
