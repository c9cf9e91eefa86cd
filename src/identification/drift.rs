//! Drift within the interval of a row and its contribution to the uncertainty.

use super::row::SteadyLoad;
use crate::trace::{Trace, unit_of};
use serde::Serialize;
use std::fmt;

/// A row cut from a run.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyRow {
    /// The means over the interval.
    pub load: SteadyLoad,
    /// From when to when \[s\]; from and to 0 in a run of means.
    pub interval: [f64; 2],
    /// Channels that drift.
    pub drifts: Vec<Drift>,
}

/// A quantity that drifts within the interval of a row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Drift {
    /// Its channel.
    pub channel: &'static str,
    /// Rate of change, in the channel's unit per second.
    pub rate: f64,
}

impl SteadyRow {
    /// Whether no channel drifts.
    pub fn is_steady(&self) -> bool {
        self.drifts.is_empty()
    }

    /// Adds every change over the interval to the uncertainty, where that is known: the mean of a drifting
    /// quantity is off its steady value by at least about so much. The interval cannot show by how much more.
    pub fn widen(&mut self) {
        let Some(uncertainty) = &mut self.load.uncertainty else {
            return;
        };
        let duration = self.interval[1] - self.interval[0];
        for Drift { channel, rate } in &self.drifts {
            let sd = match *channel {
                "drawbar_pull" => &mut uncertainty.drawbar_pull,
                "normal_force" => &mut uncertainty.load,
                "driving_torque" => &mut uncertainty.driving_torque,
                _ => &mut uncertainty.sinkage,
            };
            *sd = libm::hypot(*sd, rate * duration);
        }
    }
}

impl Drift {
    /// Channels tested for drift.
    pub const CHANNELS: [&str; 4] = ["drawbar_pull", "normal_force", "driving_torque", "sinkage"];

    /// Drifts of the channels of a run within an interval.
    pub(super) fn within(trace: &Trace, interval: [f64; 2]) -> Vec<Self> {
        let drift = |channel| {
            let steadiness = trace.steadiness_between(channel, interval)?;
            Some(Self {
                channel,
                rate: steadiness.rate()?,
            })
        };
        Self::CHANNELS.into_iter().filter_map(drift).collect()
    }

    /// Unit of the rate.
    pub fn unit(&self) -> String {
        format!("{}/s", unit_of(self.channel).unwrap_or_default())
    }
}

impl fmt::Display for Drift {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { channel, rate } = self;
        write!(f, "{channel} changes by {rate:.2e} {}", self.unit())
    }
}
