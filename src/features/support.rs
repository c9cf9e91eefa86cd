//! Whether ground carries the wheel, and whether its lugs are in the ground, by other channels than
//! the acceleration.
//!
//! A wheel that hangs in the air vibrates as little as one in sand, and so does a dead
//! accelerometer. Normal force and sinkage part them.

use crate::statistics::finite_mean;
use crate::trace::{Channel, Trace};

/// Normal force over the load [-] below which nothing carries the wheel, and above which ground
/// does.
const CARRIED: [f64; 2] = [0.1, 0.3];
/// Sinkage of the rim over the lug height [-] above which the lugs are in the ground; on hard ground it is
/// -1.
const ENTERED: f64 = -0.5;

/// The channels used.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    normal_force: Option<Channel>,
    sinkage: Option<Channel>,
    load: f64,
    lug_height: f64,
}

impl Support {
    /// Those of a run.
    pub fn of(trace: &Trace) -> Self {
        Self {
            normal_force: trace.channel("normal_force").cloned(),
            sinkage: trace.channel("sinkage").cloned(),
            load: trace.attributes.load,
            lug_height: trace.attributes.lug_height,
        }
    }

    /// Whether ground carries the wheel from `start` to `end` \[s\]: by the normal force over the
    /// commanded load, whatever the force's sign; not where that load is 0. `None` where one of them is
    /// not known, or the force is a small part of the load.
    pub fn carries(&self, [start, end]: [f64; 2]) -> Option<bool> {
        if self.load == 0.0 {
            return Some(false);
        }
        let force = finite_mean(self.normal_force.as_ref()?.between(start, end))?;
        let share = (self.load > 0.0).then(|| force.abs() / self.load)?;
        match share {
            share if share < CARRIED[0] => Some(false),
            share if share > CARRIED[1] => Some(true),
            _ => None,
        }
    }

    /// Whether the rim is so low from `start` to `end` \[s\] that lugs are in the ground; `None`
    /// without sinkage.
    pub fn lugs_are_in_the_ground(&self, [start, end]: [f64; 2]) -> Option<bool> {
        let sinkage = finite_mean(self.sinkage.as_ref()?.between(start, end))?;
        Some(sinkage > ENTERED * self.lug_height)
    }
}
