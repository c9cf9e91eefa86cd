//! The channels of a run in groups that share a panel over time, and what of them cannot be drawn.

use super::envelope::bounds;
use super::figure::PALETTE;
use crate::trace::{Channel, RunAttributes, Trace};

/// One panel over time: what is drawn together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Group {
    /// The quantity.
    pub name: &'static str,
    /// The quantity in as few letters as a narrow panel has room for.
    pub short: &'static str,
    /// Unit in which it is drawn.
    pub unit: &'static str,
    /// Factor from the channel's unit to `unit`.
    pub factor: f64,
    /// Height of the panel [px].
    pub height: f64,
    /// The channels.
    pub lines: &'static [Line],
}

/// A channel in a group.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// The channel.
    pub channel: &'static str,
    /// Its name in the legend; empty where the group's name suffices.
    pub name: &'static str,
    /// Its symbol, indices as in `F_{N}`.
    pub symbol: &'static str,
    /// Its colour.
    pub colour: &'static str,
}

impl Group {
    /// Quantity and unit.
    pub fn header(&self) -> String {
        format!("{} [{}]", self.name, self.unit)
    }

    /// Quantity and unit for a narrow panel.
    pub fn short_header(&self) -> String {
        format!("{} [{}]", self.short, self.unit)
    }

    /// What was commanded of the quantity, in the group's unit.
    pub fn command(&self, run: &RunAttributes) -> Option<(&'static str, f64)> {
        let command = match self.lines[0].channel {
            "normal_force" => ("load commanded", run.load),
            "slip_ratio" => ("slip commanded", run.slip_ratio),
            _ => return None,
        };
        command.1.is_finite().then_some(command)
    }

    /// Whether the run has something of it to draw.
    pub fn is_drawable(&self, trace: &Trace) -> bool {
        let mut lines = self.lines.iter();
        lines.any(|line| drawable(trace, line.channel).is_some())
    }
}

/// A group of a single channel.
macro_rules! lone {
    ($name:literal, $short:literal, $unit:literal, $factor:literal, $height:literal,
     $channel:literal, $symbol:literal, $colour:literal) => {
        Group {
            name: $name,
            short: $short,
            unit: $unit,
            factor: $factor,
            height: $height,
            lines: &[Line {
                channel: $channel,
                name: "",
                symbol: $symbol,
                colour: PALETTE[$colour],
            }],
        }
    };
}

/// What every drawing of a run shows.
pub(super) const GROUPS: [Group; 5] = [
    lone!(
        "Vertical acceleration of the axle",
        "Acceleration a_{y}",
        "m/s²",
        1.0,
        170.0,
        "acceleration_y",
        "a_{y}",
        0
    ),
    Group {
        name: "Forces",
        short: "Forces",
        unit: "N",
        factor: 1.0,
        height: 150.0,
        lines: &[
            Line {
                channel: "normal_force",
                name: "normal force F_{N}",
                symbol: "F_{N}",
                colour: PALETTE[0],
            },
            Line {
                channel: "drawbar_pull",
                name: "drawbar pull F_{DP}",
                symbol: "F_{DP}",
                colour: PALETTE[1],
            },
        ],
    },
    lone!(
        "Driving torque",
        "Torque T_{D}",
        "N·m",
        1.0,
        95.0,
        "driving_torque",
        "T_{D}",
        2
    ),
    lone!(
        "Sinkage of the rim",
        "Sinkage z_{}",
        "mm",
        1e3,
        95.0,
        "sinkage",
        "z",
        3
    ),
    lone!(
        "Slip ratio",
        "Slip ratio s_{}",
        "-",
        1.0,
        95.0,
        "slip_ratio",
        "s",
        1
    ),
];

/// What shows how the wheel moved, where there is room for it.
pub(super) const MOTION: [Group; 3] = [
    lone!(
        "Wheel angle",
        "Wheel angle",
        "rad",
        1.0,
        95.0,
        "wheel_angle",
        "",
        4
    ),
    lone!(
        "Wheel speed",
        "Wheel speed",
        "rad/s",
        1.0,
        95.0,
        "wheel_speed",
        "",
        4
    ),
    lone!(
        "Forward speed",
        "Forward speed v_{}",
        "mm/s",
        1e3,
        95.0,
        "forward_speed",
        "v",
        5
    ),
];

/// A channel with at least one finite sample and a rate.
pub(super) fn is_drawable(channel: &Channel) -> bool {
    let timed =
        channel.sample_rate > 0.0 && channel.sample_rate.is_finite() && channel.start.is_finite();
    timed && channel.samples.iter().any(|sample| sample.is_finite())
}

/// The channel of this name, if it can be drawn.
pub(super) fn drawable<'a>(trace: &'a Trace, name: &str) -> Option<&'a Channel> {
    trace.channel(name).filter(|channel| is_drawable(channel))
}

/// Remarks on channels that are absent or broken.
pub(super) fn remarks_on_channels(trace: &Trace) -> Vec<String> {
    const EXPECTED: [&str; 2] = ["wheel_angle", "forward_speed"];
    let names: Vec<&str> = GROUPS
        .iter()
        .flat_map(|group| group.lines.iter().map(|line| line.channel))
        .chain(EXPECTED)
        .collect();
    let mut absent = names.clone();
    absent.retain(|name| trace.channel(name).is_none());
    let absent = (!absent.is_empty()).then(|| format!("Not recorded: {}.", absent.join(", ")));
    let present = names.iter().filter_map(|name| trace.channel(name));
    let faults =
        present.filter_map(|channel| Some(format!("{}: {}.", channel.name, fault(channel)?)));
    absent.into_iter().chain(faults).collect()
}

/// What is wrong with a channel.
fn fault(channel: &Channel) -> Option<String> {
    let count = channel.samples.len();
    let finite = channel.samples.iter().filter(|s| s.is_finite()).count();
    if count == 0 {
        return Some("no samples".to_owned());
    }
    if finite == 0 {
        return Some(format!("none of {count} samples is a finite number"));
    }
    if !is_drawable(channel) {
        let Channel {
            sample_rate, start, ..
        } = channel;
        return Some(format!(
            "a sample rate of {sample_rate} Hz from {start} s cannot be drawn"
        ));
    }
    (finite < count).then(|| {
        let broken = count - finite;
        format!("{broken} of {count} samples are no finite numbers and leave gaps")
    })
}

/// First and last time [s] of all that can be drawn.
pub(super) fn time_range(trace: &Trace) -> Option<[f64; 2]> {
    let ends: Vec<f64> = trace
        .channels
        .iter()
        .filter(|channel| is_drawable(channel))
        .flat_map(|channel| [channel.start, channel.time(channel.samples.len() - 1)])
        .collect();
    bounds(&ends)
}
