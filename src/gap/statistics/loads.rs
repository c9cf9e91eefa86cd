//! Steady loads, of time series as of means.

use super::signal::{settled, straight_line};
use crate::gap::cell::Statistic;
use crate::gap::readings::Readings;
use crate::trace::{Channel, Trace};
use std::collections::BTreeSet;
use std::sync::Arc;

/// `angle` is the wheel's without jumps.
pub(super) fn read(trace: &Trace, angle: Option<&Channel>, readings: &mut Readings) {
    let channels = trace.channels.iter().map(|channel| &channel.name[..]);
    let means = trace.means.iter().map(|mean| &mean.name[..]);
    let names: BTreeSet<&str> = channels.chain(means).collect();
    // The mean of an acceleration is its sensor's bias, that of an angle nothing.
    let steady = |name: &&str| !["acceleration_y", "wheel_angle"].contains(name);
    for name in names.into_iter().filter(steady) {
        if let Some(mean) = trace.steady_mean(name) {
            let statistic = Statistic::SteadyMean;
            readings.note_of_size(&Arc::from(name), statistic, mean, mean.abs());
        }
    }
    if !trace.attributes.is_lifted() {
        per_load(trace, readings);
    }
    if let Some(angle) = angle {
        turning_speed(angle, readings);
    }
}

fn per_load(trace: &Trace, readings: &mut Readings) {
    let load = trace
        .steady_mean("normal_force")
        .unwrap_or(trace.attributes.load);
    for (name, arm) in [
        ("drawbar_pull", 1.0),
        ("driving_torque", trace.attributes.wheel_radius),
    ] {
        if let Some(mean) = trace.steady_mean(name) {
            let share = mean / (load * arm);
            readings.note_of_size(&Arc::from(name), Statistic::PerLoad, share, share.abs());
        }
    }
}

fn turning_speed(angle: &Channel, readings: &mut Readings) {
    let part = &angle.samples[settled(angle.samples.len())];
    if part.iter().filter(|angle| angle.is_finite()).count() > 1 {
        let [_, slope] = straight_line(part);
        let speed = slope * angle.sample_rate;
        let name = Arc::from("wheel_angle");
        readings.note_of_size(&name, Statistic::TurningSpeed, speed, speed.abs());
    }
}
