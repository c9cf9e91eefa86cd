//! What one run leaves behind: channels with units and rates, ground truth, provenance.

use crate::terrain::class::{TerrainLabel, Wtic};
use std::collections::BTreeMap;

/// One measured quantity over time, equally spaced.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name, for example `acceleration_y`.
    pub name: String,
    /// Unit, for example `m/s^2`.
    pub unit: String,
    /// Samples per second [Hz].
    pub sample_rate: f64,
    /// Time of the first sample [s].
    pub start: f64,
    /// The samples.
    pub samples: Vec<f64>,
}

/// A steady-state value where there is no time series.
#[derive(Debug, Clone, PartialEq)]
pub struct Mean {
    /// Name of the quantity, as a channel would have it.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Mean.
    pub value: f64,
    /// Standard deviation within the steady interval.
    pub sd: f64,
    /// Number of samples behind it.
    pub n: u64,
}

/// One lug's stay on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Which lug, from 0.
    pub lug: u32,
    /// First touch [s].
    pub start: f64,
    /// Last touch [s].
    pub end: f64,
    /// Whether its edge went more than 1 mm below the undisturbed soil.
    pub entered: bool,
}

/// The true class over a stretch of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClassWindow {
    /// Start [s].
    pub start: f64,
    /// End [s].
    pub end: f64,
    /// How the lugs met the ground.
    pub class: Wtic,
    /// What the ground was under the axle for most of it.
    pub terrain: TerrainLabel,
}

/// What a simulation knows and a rig does not.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Truth {
    /// Every contact of every lug.
    pub contacts: Vec<Contact>,
    /// The class, window by window.
    pub class_windows: Vec<ClassWindow>,
    /// Terrain parameters by name.
    pub parameters: BTreeMap<String, f64>,
    /// The ground before the wheel came: position [m], height [m].
    pub profile: Vec<[f64; 2]>,
}

/// What a run's file says of it besides its channels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunAttributes {
    /// Rim radius [m].
    pub wheel_radius: f64,
    /// Wheel width [m].
    pub wheel_width: f64,
    /// Number of lugs.
    pub lug_count: u32,
    /// Lug height [m].
    pub lug_height: f64,
    /// Commanded load [N].
    pub load: f64,
    /// Commanded forward speed [m/s].
    pub speed: f64,
    /// Commanded slip ratio [-].
    pub slip_ratio: f64,
    /// Label, if known.
    pub terrain: Option<TerrainLabel>,
    /// Class of the whole run, if it has one.
    pub class: Option<Wtic>,
    /// Which repeat of its condition.
    pub repeat: u32,
    /// When it was measured.
    pub day: String,
    /// Remarks.
    pub notes: String,
    /// Steps per second of the simulation [Hz]; `None` on a measured run.
    pub physics_rate: Option<f64>,
}

/// One run, simulated or measured.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// Wheel, condition, label.
    pub attributes: RunAttributes,
    /// Time series.
    pub channels: Vec<Channel>,
    /// Steady-state values.
    pub means: Vec<Mean>,
    /// Ground truth; only in simulated data.
    pub truth: Option<Truth>,
}

impl Trace {
    /// The channel of this name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }
}
