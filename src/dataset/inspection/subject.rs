//! A run prepared for the checks: angles unwrapped, rests removed, each quantity with its uncertainty.

use crate::quantity::SlipRatio;
use crate::statistics::{batch_means_error, mean};
use crate::terrain::class::TerrainLabel;
use crate::trace::encoder::{between_steps, is_too_coarse};
use crate::trace::motion::Motion;
use crate::trace::slope::Slope;
use crate::trace::turning::Turning;
use crate::trace::{Channel, RunAttributes, Trace};
use std::f64::consts::{PI, TAU};

/// Standard uncertainties [-] beyond which a mean is doubtless of its sign.
pub(super) const SIGMAS: f64 = 3.0;

/// Zero error of pull and torque at the rim, over the load [-], that remains unnoticed.
pub(super) const ZERO: f64 = 0.03;

/// Way [m] over a stone or two.
const FEW_STONES: f64 = 0.05;

/// A run with what several checks need.
pub(super) struct Subject<'t> {
    pub(super) trace: &'t Trace,
    pub(super) motion: Motion,
    /// The wheel angle, continuous and between the steps of its encoder.
    pub(super) turning: Option<(Channel, Turning)>,
    /// What the wheel's own weight does to forces; `None` on a slope with a wheel of unknown mass.
    slope: Option<Slope>,
}

/// A steady value and its standard uncertainty.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steady {
    pub(super) mean: f64,
    /// By the scatter of what it is the mean of; 0 where that is not known.
    pub(super) sd: f64,
}

impl<'t> Subject<'t> {
    pub(super) fn of(trace: &'t Trace) -> Self {
        let turning = trace.channel("wheel_angle").map(|angle| {
            let turning = Turning::of(&angle.samples);
            let continuous = Channel {
                samples: between_steps(&turning.angles),
                ..angle.clone()
            };
            (continuous, turning)
        });
        Self {
            trace,
            motion: Motion::of(trace),
            turning,
            slope: Slope::of(&trace.attributes),
        }
    }

    /// Whether the wheel moves at no time: by its channels, or by the command where none shows it.
    pub(super) fn is_rest(&self) -> bool {
        let RunAttributes {
            speed, slip_ratio, ..
        } = self.trace.attributes;
        let shows = |name: &&str| {
            self.trace.channel(name).is_some()
                || self.trace.means.iter().any(|mean| mean.name == **name)
        };
        let is_shown = ["wheel_angle", "wheel_speed", "forward_speed"]
            .iter()
            .any(shows);
        let is_commanded = speed == 0.0 && (slip_ratio == 0.0 || slip_ratio.is_nan());
        self.motion.is_rest() || (is_commanded && !is_shown)
    }

    /// Steady value of a quantity while the wheel moves; at rest too where it never moves.
    pub(super) fn mean(&self, name: &str) -> Option<f64> {
        self.steady(name).map(|steady| steady.mean)
    }

    /// As [`mean`](Self::mean), with its uncertainty.
    pub(super) fn steady(&self, name: &str) -> Option<Steady> {
        if let Some(mean) = self.trace.means.iter().find(|mean| mean.name == name) {
            let sd = mean.sd / (mean.n.max(1) as f64).sqrt();
            return Some(Steady {
                mean: mean.value,
                sd: if sd > 0.0 { sd } else { 0.0 },
            });
        }
        let channel = self.trace.channel(name)?;
        let numbers = if self.motion.is_rest() {
            channel
                .steady()
                .iter()
                .copied()
                .filter(|x| x.is_finite())
                .collect()
        } else {
            self.motion.steady(channel)
        };
        Steady::of(&numbers)
    }

    /// As [`steady`](Self::steady), of the contact's forces: less the part of the wheel's own weight on a slope.
    pub(super) fn contact(&self, name: &str) -> Option<Steady> {
        let steady = self.steady(name)?;
        let mean = self.without_weight(name, steady.mean)?;
        Some(Steady { mean, ..steady })
    }

    /// What `reading` of a channel has without the wheel's own weight, if that is known.
    pub(super) fn without_weight(&self, name: &str, reading: f64) -> Option<f64> {
        let has_weight = ["drawbar_pull", "normal_force"].contains(&name);
        match (has_weight, self.slope) {
            (true, slope) => Some(slope?.contact(name, reading)),
            (false, _) => Some(reading),
        }
    }

    /// Commanded load [N] that presses on the track.
    pub(super) fn carried(&self) -> f64 {
        let RunAttributes {
            load, slope_deg, ..
        } = self.trace.attributes;
        load * libm::cos(slope_deg.to_radians())
    }

    /// The channel that shows how fast the wheel turns: the angle, or the speed from which it was integrated.
    pub(super) fn turning_channel(&self) -> &'static str {
        let is_integrated = self.trace.attributes.angle_zero_unknown;
        if self.turning.is_some() && !is_integrated {
            "wheel_angle"
        } else {
            "wheel_speed"
        }
    }

    /// Whether the sampling or resolution of the wheel's angle is too coarse for its speed.
    pub(super) fn is_turning_unresolved(&self) -> bool {
        let (Some((angle, turning)), Some(readings)) =
            (&self.turning, self.trace.channel("wheel_angle"))
        else {
            return false;
        };
        let numbers = || readings.samples.iter().copied().filter(|x| x.is_finite());
        let span =
            numbers().fold(f64::NEG_INFINITY, f64::max) - numbers().fold(f64::INFINITY, f64::min);
        let step = self.expected_wheel_speed().map_or(0.0, f64::abs) / angle.sample_rate;
        let loses_turns = step > PI && (0.1..=TAU).contains(&span);
        !turning.is_resolved || loses_turns || is_too_coarse(&turning.angles)
    }

    /// Wheel speed [rad/s] by forward speed and slip, as commanded, else as measured.
    pub(super) fn expected_wheel_speed(&self) -> Option<f64> {
        let RunAttributes {
            speed,
            slip_ratio,
            wheel_radius,
            ..
        } = self.trace.attributes;
        let forward = if speed.is_finite() {
            speed
        } else {
            self.forward_speed()
        };
        let slip = if slip_ratio.is_finite() {
            slip_ratio
        } else {
            self.mean("slip_ratio")?
        };
        let speed = SlipRatio::new(slip)
            .ok()?
            .wheel_speed(wheel_radius, forward)?;
        (speed.is_finite() && speed != 0.0).then_some(speed)
    }

    /// Wheel speed [rad/s] over the steady part while it moves: the slope between the ends of its longest
    /// stretch of motion.
    pub(super) fn wheel_speed(&self) -> Option<f64> {
        let Some((angle, _)) = &self.turning else {
            return self.mean("wheel_speed");
        };
        if self.is_turning_unresolved() {
            return None;
        }
        let quarter = angle.samples.len() / 4;
        self.speed_within(angle, quarter..angle.samples.len() - quarter)
            .or_else(|| self.speed_within(angle, 0..angle.samples.len()))
    }

    fn speed_within(&self, angle: &Channel, range: std::ops::Range<usize>) -> Option<f64> {
        let moves =
            |index: &usize| self.motion.is_rest() || self.motion.moves_at(angle.time(*index));
        let indices: Vec<usize> = range.filter(moves).collect();
        let stretches = indices.chunk_by(|a, b| b - a == 1);
        let longest = stretches.max_by_key(|stretch| stretch.len())?;
        let known = || {
            longest
                .iter()
                .filter(|&&index| angle.samples[index].is_finite())
        };
        let (&first, &last) = (known().next()?, known().next_back()?);
        let turned = angle.samples[last] - angle.samples[first];
        (last > first).then(|| turned * angle.sample_rate / (last - first) as f64)
    }

    /// Forward speed [m/s]: measured, else commanded; NaN where neither is known.
    pub(super) fn forward_speed(&self) -> f64 {
        let measured = self.mean("forward_speed");
        measured.unwrap_or(self.trace.attributes.speed)
    }

    /// Whether the loads are those of a stone or two of gravel, down which a wheel may roll by itself.
    pub(super) fn is_over_one_stone(&self) -> bool {
        let has_stones = matches!(
            self.trace.attributes.terrain,
            Some(
                TerrainLabel::Gravel | TerrainLabel::HardWithGravel | TerrainLabel::SandWithGravel
            )
        );
        let is_load = |channel: &&Channel| {
            ["drawbar_pull", "driving_torque"].contains(&channel.name.as_str())
        };
        let loads = self.trace.channels.iter().find(is_load);
        let seconds = loads.map_or(f64::NAN, |channel| {
            self.motion.steady(channel).len() as f64 / channel.sample_rate
        });
        has_stones && (self.forward_speed() * seconds).abs() < FEW_STONES
    }

    /// The slip that the channels show, and the channel that shows it: slip itself, else the wheel's turning
    /// against the forward speed, measured or commanded. None of a wheel at rest.
    pub(super) fn shown_slip(&self) -> Option<(&'static str, f64)> {
        if self.is_rest() {
            return None;
        }
        if let Some(slip) = self.mean("slip_ratio") {
            return Some(("slip_ratio", slip));
        }
        let (wheel_speed, forward) = (self.wheel_speed()?, self.forward_speed());
        let radius = self.trace.attributes.wheel_radius;
        let known = [radius, wheel_speed, forward].iter().all(|x| x.is_finite());
        known.then(|| {
            let slip = SlipRatio::from_motion(radius, wheel_speed, forward);
            (self.turning_channel(), slip.get())
        })
    }

    /// The slip of the run: that which the channels show, else that commanded.
    pub(super) fn slip(&self) -> f64 {
        let shown = self.shown_slip().map(|(_, slip)| slip);
        shown.unwrap_or(self.trace.attributes.slip_ratio)
    }

    /// 1 forward, also where the speed is unknown; -1 in reverse.
    pub(super) fn direction(&self) -> f64 {
        let speed = self.trace.attributes.speed;
        let speed = if speed.is_finite() {
            speed
        } else {
            self.forward_speed()
        };
        let speed = if speed.is_finite() {
            Some(speed)
        } else {
            self.wheel_speed()
        };
        if speed.is_some_and(|speed| speed < 0.0) {
            -1.0
        } else {
            1.0
        }
    }
}

impl Steady {
    /// Mean of all `numbers`, and its uncertainty by the scatter of the means of batches.
    fn of(numbers: &[f64]) -> Option<Self> {
        Some(Self {
            mean: mean(numbers.iter().copied())?,
            sd: batch_means_error(numbers),
        })
    }
}
