//! Channels as rows of a figure.

/// A channel and how it is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ChannelRow {
    /// Name of the channel.
    pub channel: &'static str,
    /// Header of its panel, with the unit shown.
    pub header: &'static str,
    /// Factor from the channel's unit to the unit shown.
    pub factor: f64,
}

impl ChannelRow {
    /// The unit shown.
    pub fn unit(&self) -> &'static str {
        let unit = self.header.split_once('[');
        unit.map_or("-", |(_, unit)| unit.trim_end_matches(']'))
    }
}

const fn row(channel: &'static str, header: &'static str, factor: f64) -> ChannelRow {
    ChannelRow {
        channel,
        header,
        factor,
    }
}

pub(super) const ACCELERATION: ChannelRow = row(
    "acceleration_y",
    "Vertical acceleration of the axle [m/s²]",
    1.0,
);
pub(super) const NORMAL_FORCE: ChannelRow = row("normal_force", "Normal force [N]", 1.0);
pub(super) const DRAWBAR_PULL: ChannelRow = row("drawbar_pull", "Drawbar pull [N]", 1.0);
pub(super) const DRIVING_TORQUE: ChannelRow = row("driving_torque", "Driving torque [N·m]", 1.0);
pub(super) const SINKAGE: ChannelRow = row("sinkage", "Sinkage of the rim [mm]", 1.0e3);
