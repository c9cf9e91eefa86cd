//! Record of one run: channels with units and rates, ground truth, provenance.

pub mod encoder;
mod knots;
pub mod motion;
pub mod slope;
pub mod steadiness;
pub mod truth;
pub mod turning;
pub mod wheel;

use crate::statistics::finite_mean;
pub use turning::unwrapped;

use crate::terrain::class::{TerrainLabel, Wtic};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wheel::{Lugs, Plate};

/// The standard channels and their units. Other channels are stored unchanged.
///
/// `acceleration_y` points upward and has gravity removed; signs are those of
/// [`Loads`](crate::simulation::Loads) and [`WheelState`](crate::simulation::WheelState).
pub const CHANNELS: [(&str, &str); 9] = [
    ("acceleration_y", "m/s^2"),
    ("normal_force", "N"),
    ("drawbar_pull", "N"),
    ("driving_torque", "N m"),
    ("sinkage", "m"),
    ("slip_ratio", "1"),
    ("wheel_angle", "rad"),
    ("wheel_speed", "rad/s"),
    ("forward_speed", "m/s"),
];

/// Tolerance of the slip about the command [-]; a measured campaign of 24 runs had 0.0015.
pub const SLIP_TOLERANCE: f64 = 0.03;

/// Standard errors of its mean by which a slip differs at least from its label.
const SIGMAS: f64 = 3.0;

/// Tolerance [-] of a mean slip of this standard `error` [-]: over stones that of a short record scatters by more than rigs are off.
pub fn slip_tolerance(error: f64) -> f64 {
    SLIP_TOLERANCE.max(SIGMAS * error)
}

/// The unit of a known channel.
pub fn unit_of(channel: &str) -> Option<&'static str> {
    let known = CHANNELS.iter().find(|(name, _)| *name == channel);
    known.map(|(_, unit)| *unit)
}

/// A unit for use after a number in a text; empty for a dimensionless one.
pub fn behind_number(unit: &str) -> String {
    match unit {
        "-" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// A steady value of a channel \[SI\], 0 where it is below what a simulated mean resolves: rounding of the solver, and
/// the part of a lug pass by which a record is no whole number of them.
pub fn without_rounding(channel: &str, value: f64) -> f64 {
    let least = match channel {
        "normal_force" | "drawbar_pull" | "slip_ratio" => 1.0e-4,
        "driving_torque" => 1.0e-5,
        "sinkage" => 1.0e-8,
        _ => 1.0e-6,
    };
    if value.abs() < least { 0.0 } else { value }
}

/// One measured quantity over time, equally spaced.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name, for example `acceleration_y`.
    pub name: String,
    /// Unit, for example `m/s^2`.
    pub unit: String,
    /// Samples per second \[Hz\].
    pub sample_rate: f64,
    /// Time of the first sample \[s\].
    pub start: f64,
    /// The samples.
    pub samples: Vec<f64>,
}

impl Channel {
    /// Whether run files keep it in single precision: six digits are enough for what a rig measures but the
    /// wheel's angle, which grows from turn to turn.
    pub fn is_single_precision(&self) -> bool {
        let name = self.name.trim_end_matches("_raw");
        unit_of(name).is_some() && name != "wheel_angle"
    }

    /// Time \[s\] of sample `index`.
    pub fn time(&self, index: usize) -> f64 {
        self.start + index as f64 / self.sample_rate
    }

    /// Length of the record \[s\]: its samples times their period.
    pub fn duration(&self) -> f64 {
        self.samples.len() as f64 / self.sample_rate
    }

    /// The samples in `[start, end)` \[s\], none where the channel has none.
    pub fn between(&self, start: f64, end: f64) -> &[f64] {
        let index = |time: f64| {
            // Times are whole multiples of the period up to rounding.
            let samples = (time - self.start) * self.sample_rate - 1.0e-6;
            (samples.ceil().max(0.0) as usize).min(self.samples.len())
        };
        self.samples.get(index(start)..index(end)).unwrap_or(&[])
    }

    /// The middle half of the record, away from starting and stopping.
    pub fn steady(&self) -> &[f64] {
        let quarter = self.samples.len() / 4;
        &self.samples[quarter..self.samples.len() - quarter]
    }

    /// Mean of the numbers among the [`steady`](Self::steady) samples, in the channel's unit;
    /// `None` where there are none.
    pub fn steady_mean(&self) -> Option<f64> {
        finite_mean(self.steady())
    }
}

/// The channels with samples by rate, start and length, those shared by most first.
pub fn by_clock(channels: &[Channel]) -> Vec<Vec<&Channel>> {
    let clock = |channel: &Channel| (channel.sample_rate, channel.start, channel.samples.len());
    let mut clocks: Vec<Vec<&Channel>> = Vec::new();
    let recorded = channels
        .iter()
        .filter(|channel| !channel.samples.is_empty());
    for channel in recorded {
        let known = clocks
            .iter_mut()
            .find(|shared| clock(shared[0]) == clock(channel));
        match known {
            Some(shared) => shared.push(channel),
            None => clocks.push(vec![channel]),
        }
    }
    clocks.sort_by_key(|shared| std::cmp::Reverse(shared.len()));
    clocks
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
    /// Standard deviation within the steady interval; NaN where it is not known.
    pub sd: f64,
    /// Number of samples behind it; 0 where unknown.
    pub n: u64,
}

/// One lug's stay on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Which lug, from 0.
    pub lug: u32,
    /// First touch \[s\].
    pub start: f64,
    /// Last touch \[s\].
    pub end: f64,
    /// Whether its edge went more than 1 mm below the undisturbed soil.
    pub entered: bool,
}

/// The true class over a stretch of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClassWindow {
    /// Start \[s\].
    pub start: f64,
    /// End \[s\].
    pub end: f64,
    /// How the lugs met the ground.
    pub class: Wtic,
    /// What the ground was under the axle for most of it.
    pub terrain: TerrainLabel,
    /// The lugs behind the class, where they were counted.
    pub lugs: Option<LugTally>,
}

/// Lugs that passed the bottom in a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LugTally {
    /// How many passed.
    pub passed: u32,
    /// How many of them touched the ground.
    pub touched: u32,
    /// How many of them entered it.
    pub entered: u32,
}

/// Ground truth of a simulation, which no sensor measures.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Truth {
    /// Every contact of every lug.
    pub contacts: Vec<Contact>,
    /// The class, window by window.
    pub class_windows: Vec<ClassWindow>,
    /// Terrain parameters by name.
    pub parameters: BTreeMap<String, f64>,
    /// The ground before the wheel came: position \[m\], height \[m\].
    pub profile: Vec<[f64; 2]>,
    /// How much of the run the drives were at their limits.
    pub at_limit: AtLimit,
}

/// Shares of a run [-] in which a drive gave all it has, so that the wheel did not move as commanded.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct AtLimit {
    /// The carriage, at its force.
    pub carriage: f64,
    /// The motor, at its torque.
    pub motor: f64,
}

impl AtLimit {
    /// Whether a drive ever was at its limit.
    pub fn any(&self) -> bool {
        self.carriage > 0.0 || self.motor > 0.0
    }
}

/// Attributes of a run in its file. Unknown numbers are NaN.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunAttributes {
    /// Rim radius \[m\].
    pub wheel_radius: f64,
    /// Wheel width \[m\].
    pub wheel_width: f64,
    /// Number of lugs; 0 on a smooth wheel, `None` where it is unknown.
    pub lug_count: Option<u32>,
    /// Lug height \[m\].
    pub lug_height: f64,
    /// Lug thickness \[m\] along the circumference; `None` where it is unknown.
    pub lug_thickness: Option<f64>,
    /// Mass \[kg\] on the wheel's side of the force sensors, the wheel's and what turns or hangs with
    /// it; 0 where the forces are those of the contact alone, `None` where it is unknown.
    pub wheel_mass: Option<f64>,
    /// The plate pressed into the soil; `None` where it was a wheel.
    pub plate: Option<Plate>,
    /// Slope of the track [°], above 0 uphill.
    pub slope_deg: f64,
    /// Commanded load \[N\]; 0 for a lifted wheel.
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
    /// Steps per second of the simulation \[Hz\]; `None` on a measured run.
    pub physics_rate: Option<f64>,
    /// Whether the wheel angle was summed up from the wheel's speed, so that it is unknown where its
    /// zero lies: it has turn and no position of the lugs.
    pub angle_zero_unknown: bool,
    /// What the import of a measured run took for granted or did to its data.
    pub import_notes: Vec<String>,
}

impl RunAttributes {
    /// Whether the wheel is lifted off the ground.
    pub fn is_lifted(&self) -> bool {
        self.load == 0.0
    }

    /// The wheel's lugs.
    pub fn lugs(&self) -> Lugs {
        Lugs {
            count: self.lug_count,
            height: self.lug_height,
        }
    }
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

    /// Steady value of the quantity `name`, in its unit: its mean where one was measured, else
    /// the mean of the finite samples in the middle half of its channel.
    pub fn steady_mean(&self, name: &str) -> Option<f64> {
        let measured = self.means.iter().find(|mean| mean.name == name);
        measured
            .map(|mean| mean.value)
            .or_else(|| self.channel(name)?.steady_mean())
    }

    /// Slip ratio [-]: the measured steady one, else that commanded.
    pub fn slip(&self) -> f64 {
        self.steady_mean("slip_ratio")
            .unwrap_or(self.attributes.slip_ratio)
    }

    /// Whether it is the result of a simulation and marked as such.
    pub fn is_simulated(&self) -> bool {
        self.truth.is_some() || self.attributes.physics_rate.is_some()
    }

    /// Length of the longest channel \[s\]; 0 where there is none.
    pub fn duration(&self) -> f64 {
        let durations = self.channels.iter().map(Channel::duration);
        durations.fold(0.0, f64::max)
    }

    /// Rounded to the precision of a run file, so that a run has the same values before and after storage.
    pub fn as_kept(mut self) -> Self {
        let channels = self.channels.iter_mut();
        for channel in channels.filter(|channel| channel.is_single_precision()) {
            for sample in &mut channel.samples {
                *sample = f64::from(*sample as f32);
            }
        }
        self
    }

    /// Without what a rig cannot know of a run: truth, class, physics rate, and remarks, which may describe
    /// the simulation.
    pub fn as_measured(mut self) -> Self {
        self.truth = None;
        self.attributes.class = None;
        self.attributes.physics_rate = None;
        self.attributes.notes.clear();
        self
    }
}

impl Truth {
    /// The class of the whole run, if its windows agree.
    pub fn class(&self) -> Option<Wtic> {
        let first = self.class_windows.first()?.class;
        let agree = self.class_windows.iter().all(|w| w.class == first);
        agree.then_some(first)
    }

    /// The class window in which `[start, end]` \[s\] lies for the most part.
    pub fn window_of(&self, [start, end]: [f64; 2]) -> Option<&ClassWindow> {
        let overlap = |other: &ClassWindow| end.min(other.end) - start.max(other.start);
        let windows = self.class_windows.iter();
        let most = windows.max_by(|a, b| overlap(a).total_cmp(&overlap(b)));
        most.filter(|truth| overlap(truth) >= 0.5 * (end - start))
    }
}

impl LugTally {
    /// The shares [-] of the lugs that passed which touched and which entered; NaN where none passed.
    pub fn shares(self) -> [f64; 2] {
        [self.touched, self.entered].map(|some| f64::from(some) / f64::from(self.passed))
    }
}

/// The angle \[rad\] that a wheel turns through along a channel of `speed`, with `per_speed` the wheel
/// speed per unit of it: [rad/m] for a forward speed [m/s], 1 for a wheel speed [rad/s].
///
/// The speed is taken as linear between samples (trapezoidal rule), over gaps as well; within a gap the
/// angle is NaN.
pub fn turned_along(speed: &Channel, per_speed: f64) -> Channel {
    let mut turned = 0.0;
    let mut last: Option<(usize, f64)> = None;
    let samples = speed.samples.iter().enumerate().map(|(i, &now)| {
        if !now.is_finite() {
            return f64::NAN;
        }
        if let Some((before, then)) = last.replace((i, now)) {
            let steps = (i - before) as f64;
            turned += 0.5 * (then + now) * steps * per_speed / speed.sample_rate;
        }
        turned
    });
    Channel {
        samples: samples.collect(),
        ..speed.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Channel {
        Channel {
            name: "sinkage".to_owned(),
            unit: "m".to_owned(),
            sample_rate: 1000.0,
            start: 0.5,
            samples: (0..1000).map(f64::from).collect(),
        }
    }

    #[test]
    fn a_window_holds_the_samples_from_its_start_to_before_its_end() {
        let channel = ramp();
        assert_eq!(channel.between(0.5, 0.503), [0.0, 1.0, 2.0]);
        // 0.7 and 0.1 + 0.6 differ by a rounding error; both are the time of sample 200.
        assert_eq!(
            channel.between(0.1 + 0.6, 0.701),
            channel.between(0.7, 0.701)
        );
        assert_eq!(channel.between(0.7, 0.701), [200.0]);
        assert_eq!(channel.between(1.498, 9.0), [998.0, 999.0]);
        assert!(channel.between(0.0, 0.5).is_empty() && channel.between(2.0, 1.0).is_empty());
        let windows: usize = (0..10)
            .map(|i| 0.5 + 0.1 * f64::from(i))
            .map(|start| channel.between(start, start + 0.1).len())
            .sum();
        assert_eq!(windows, 1000);
    }

    #[test]
    fn a_speed_is_summed_up_exactly_where_it_is_linear_and_over_gaps() {
        let mut speed = ramp();
        speed.samples = (0..1000).map(|i| 2.0 + 0.01 * f64::from(i)).collect();
        speed.samples[300..350].fill(f64::NAN);
        let turned = turned_along(&speed, 0.5);
        for i in [0, 1, 299, 350, 999] {
            let time = i as f64 / 1000.0;
            let expected = 0.5 * (2.0 * time + 5.0 * time * time);
            assert!((turned.samples[i] - expected).abs() < 1e-12, "{i}");
        }
        assert!(turned.samples[300..350].iter().all(|angle| angle.is_nan()));
    }

    #[test]
    fn a_steady_mean_prefers_the_measured_mean_and_leaves_gaps_out() {
        let mut channel = ramp();
        channel.samples[500] = f64::NAN;
        let mut trace = Trace {
            channels: vec![channel],
            ..Trace::default()
        };
        // Samples 250 to 749 without sample 500.
        let expected = (499.5 * 500.0 - 500.0) / 499.0;
        assert!((trace.steady_mean("sinkage").unwrap() - expected).abs() < 1e-9);
        assert_eq!(trace.steady_mean("normal_force"), None);
        assert_eq!(trace.duration(), 1.0);
        trace.means.push(Mean {
            name: "sinkage".to_owned(),
            unit: "m".to_owned(),
            value: 3.0,
            sd: 0.1,
            n: 10,
        });
        assert_eq!(trace.steady_mean("sinkage"), Some(3.0));
    }
}
