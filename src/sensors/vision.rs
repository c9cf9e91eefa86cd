//! Camera that watches the wheel: sinkage and slip, a few times a second.

use super::noise::WhiteNoise;
use super::sampling::Instants;
use super::transducer::{finite, not_negative, quantised};
use crate::quantity::{RangeError, SlipRatio};
use crate::simulation::WheelState;
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Camera that watches the wheel.
///
/// The default is ideal: ten frames a second without error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Vision {
    /// Frames per second \[Hz\].
    pub frame_rate: f64,
    /// Time \[s\] by which readings lag their time stamps.
    pub delay: f64,
    /// Frames between the two that are matched for slip; 1 matches neighbours.
    pub slip_frames: u32,
    /// Sinkage read over sinkage [-].
    pub sinkage_gain: f64,
    /// Offset \[m\] of the sinkage reading.
    pub sinkage_bias: f64,
    /// Standard deviation \[m\] of the sinkage in a frame.
    pub sinkage_noise: f64,
    /// Step \[m\] of the sinkage; 0 is continuous.
    pub sinkage_resolution: f64,
    /// Standard deviation \[m\] of the wheel's displacement `ΔS` between matched frames.
    pub displacement_noise: f64,
    /// Standard deviation \[m\] of the mean displacement `Δu` of the mark points.
    pub mark_noise: f64,
    /// Radius `r₁` \[m\] on which the mark points lie.
    pub mark_radius: f64,
}

impl Default for Vision {
    fn default() -> Self {
        Self {
            frame_rate: 10.0,
            delay: 0.0,
            slip_frames: 1,
            sinkage_gain: 1.0,
            sinkage_bias: 0.0,
            sinkage_noise: 0.0,
            sinkage_resolution: 0.0,
            displacement_noise: 0.0,
            mark_noise: 0.0,
            mark_radius: 0.1,
        }
    }
}

/// Highest frame rate [Hz]. Sinkage and slip from other sensors than a camera are sampled as fast as forces.
const MOST_FRAMES: f64 = 10_000.0;

impl Vision {
    /// A camera at half a metre with pixels of 0.2 mm on the wheel.
    ///
    /// Ten frames a second, read 0.1 s late; the soil's edge found to 0.5 mm (grains, shadows) in
    /// steps of a pixel; the trace matched to half a pixel (0.1 mm), the mean of several screws
    /// to a quarter (0.05 mm); frames one second apart matched, because neighbours at 10 mm/s
    /// differ by 1 mm and would resolve slip only to 0.1.
    pub fn realistic() -> Self {
        Self {
            delay: 0.1,
            slip_frames: 10,
            sinkage_noise: 5e-4,
            sinkage_resolution: 2e-4,
            displacement_noise: 1e-4,
            mark_noise: 5e-5,
            ..Self::default()
        }
    }

    /// Time [s] between the frames that are matched for slip.
    pub(super) fn baseline(&self) -> f64 {
        f64::from(self.slip_frames) / self.frame_rate
    }

    pub(super) fn check(&self) -> Result<(), RangeError> {
        RangeError::positive("frame rate", "Hz", self.frame_rate)?;
        RangeError::check("frame rate", "Hz", self.frame_rate, [0.0, MOST_FRAMES])?;
        not_negative("vision delay", "s", self.delay)?;
        RangeError::check(
            "slip frames",
            "-",
            f64::from(self.slip_frames),
            [1.0, f64::INFINITY],
        )?;
        finite("sinkage gain", "-", self.sinkage_gain)?;
        finite("sinkage bias", "m", self.sinkage_bias)?;
        not_negative("sinkage noise", "m", self.sinkage_noise)?;
        not_negative("sinkage resolution", "m", self.sinkage_resolution)?;
        not_negative("displacement noise", "m", self.displacement_noise)?;
        not_negative("mark noise", "m", self.mark_noise)?;
        RangeError::positive("mark radius", "m", self.mark_radius).map(drop)
    }

    /// Slip ratio from the displacement `ΔS` \[m\] of a wheel of `radius` \[m\] and the displacement
    /// `Δu` \[m\] of its mark points about the axle (Eq. 77).
    ///
    /// ```text
    /// s = 1 - ΔS / (r arccos(1 - Δu²/2r₁²))
    /// ```
    ///
    /// The same angle is `2 arcsin(Δu/2r₁)`, which keeps its digits when small. `forward` is
    /// the direction of the marks; braking and reverse follow [`SlipRatio`]. A wheel that turns by
    /// more than half a turn between frames looks slower than it is.
    pub fn slip(&self, radius: f64, displacement: f64, mark: f64, forward: bool) -> SlipRatio {
        let half_chord = (mark / (2.0 * self.mark_radius)).clamp(-1.0, 1.0);
        let angle = 2.0 * libm::asin(half_chord.abs());
        let turned = if forward { angle } else { -angle };
        SlipRatio::from_motion(radius, turned, displacement)
    }
}

/// Speed [m/s] of rim and axle below which the wheel counts as standing and its slip is NaN.
///
/// A wheel that has stopped swings on belt and soil by micrometres; the slowest that a rover drives is a hundred times
/// faster than this.
const STANDS: f64 = 3.0e-5;

/// What one frame shows.
#[derive(Clone, Copy)]
struct Frame {
    position: f64,
    wheel_angle: f64,
    sinkage: f64,
}

impl Frame {
    fn of(state: &WheelState) -> Self {
        Self {
            position: state.position,
            wheel_angle: state.wheel_angle,
            sinkage: state.sinkage,
        }
    }

    /// The frame `back` steps before this one, `last` being one step before.
    fn before(&self, last: &Self, back: f64) -> Self {
        let between = |new: f64, old: f64| new - (new - old) * back;
        Self {
            position: between(self.position, last.position),
            wheel_angle: between(self.wheel_angle, last.wheel_angle),
            sinkage: between(self.sinkage, last.sinkage),
        }
    }
}

/// A [`Vision`] at work.
pub(super) struct Camera {
    vision: Vision,
    wheel_radius: f64,
    instants: Instants,
    sinkage_noise: Option<WhiteNoise>,
    displacement_noise: Option<WhiteNoise>,
    mark_noise: Option<WhiteNoise>,
    last: Option<Frame>,
    /// Frames that wait for their partner, oldest first.
    frames: VecDeque<Frame>,
    pub(super) sinkage: Vec<f64>,
    pub(super) slip_ratio: Vec<f64>,
}

impl Camera {
    pub(super) fn new(
        vision: Vision,
        wheel_radius: f64,
        instants: Instants,
        rng: impl Fn(&str) -> ChaCha8Rng,
    ) -> Self {
        let noise = |deviation, stage| WhiteNoise::of_deviation(deviation, rng(stage));
        Self {
            vision,
            wheel_radius,
            instants,
            sinkage_noise: noise(vision.sinkage_noise, "sensors.vision.sinkage"),
            displacement_noise: noise(vision.displacement_noise, "sensors.vision.displacement"),
            mark_noise: noise(vision.mark_noise, "sensors.vision.mark"),
            last: None,
            frames: VecDeque::new(),
            sinkage: Vec::new(),
            slip_ratio: Vec::new(),
        }
    }

    /// Takes the state at `step`.
    pub(super) fn push(&mut self, step: u64, state: &WheelState) {
        let now = Frame::of(state);
        let last = self.last.replace(now).unwrap_or(now);
        while let Some(back) = self.instants.due(step) {
            self.take(now.before(&last, back));
        }
    }

    fn take(&mut self, frame: Frame) {
        let sinkage = self.read_sinkage(frame.sinkage);
        self.sinkage.push(sinkage);
        self.frames.push_back(frame);
        if self.frames.len() > self.vision.slip_frames as usize {
            let slip = self
                .frames
                .pop_front()
                .map(|earlier| self.match_frames(&earlier, &frame));
            self.slip_ratio.extend(slip);
        }
    }

    fn read_sinkage(&mut self, sinkage: f64) -> f64 {
        let Vision {
            sinkage_gain,
            sinkage_bias,
            sinkage_resolution,
            ..
        } = self.vision;
        let reading = sinkage_gain * sinkage + sinkage_bias + drawn(&mut self.sinkage_noise);
        if sinkage_resolution > 0.0 {
            return quantised(reading, sinkage_resolution);
        }
        reading
    }

    /// Slip ratio between two frames; NaN where the wheel is at rest, as it is not defined.
    fn match_frames(&mut self, earlier: &Frame, later: &Frame) -> f64 {
        let turned = later.wheel_angle - earlier.wheel_angle;
        let chord = 2.0 * self.vision.mark_radius * libm::sin(turned.abs() / 2.0).abs();
        let mark = chord + drawn(&mut self.mark_noise);
        let moved = later.position - earlier.position;
        let displacement = moved + drawn(&mut self.displacement_noise);
        let way = moved.abs().max(self.wheel_radius * turned.abs());
        if way < STANDS * self.vision.baseline() {
            return f64::NAN;
        }
        self.vision
            .slip(self.wheel_radius, displacement, mark, turned >= 0.0)
            .get()
    }
}

fn drawn(noise: &mut Option<WhiteNoise>) -> f64 {
    noise.as_mut().map_or(0.0, WhiteNoise::draw)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;

    const RADIUS: f64 = 0.14;

    /// Frames of a wheel at `forward_speed` [m/s] that slips by `slip`, over 20 s at 1 kHz.
    fn watched(vision: Vision, forward_speed: f64, slip: f64) -> Camera {
        let wheel_speed = SlipRatio::new(slip)
            .unwrap()
            .wheel_speed(RADIUS, forward_speed);
        let steps_per_frame = 1000.0 / vision.frame_rate;
        let instants = Instants::new(steps_per_frame, 1000.0 * vision.delay);
        let mut camera = Camera::new(vision, RADIUS, instants, |stage| Seed(3).rng(stage, 0));
        for step in 0..20_000_u32 {
            let time = f64::from(step) / 1000.0;
            let state = WheelState {
                position: forward_speed * time,
                wheel_angle: wheel_speed.unwrap() * time,
                sinkage: 0.01 + 1e-4 * time,
                ..WheelState::default()
            };
            camera.push(step.into(), &state);
        }
        camera
    }

    #[test]
    fn ideal_frames_give_driving_braking_and_reverse_slip() {
        for forward_speed in [0.014, -0.014] {
            for slip in [0.0, 0.2, 0.6, -0.3] {
                let camera = watched(Vision::default(), forward_speed, slip);
                assert_eq!(camera.sinkage.len(), 200);
                assert_eq!(camera.slip_ratio.len(), 199);
                for found in camera.slip_ratio {
                    assert!((found - slip).abs() < 1e-10, "{slip}: {found}");
                }
            }
        }
    }

    #[test]
    fn a_wheel_that_stands_has_no_slip_and_one_that_is_dragged_or_spins_or_crawls_has_one() {
        let mut camera = watched(Vision::default(), 1.0e-8, 0.0);
        assert!(camera.slip_ratio.iter().all(|slip| slip.is_nan()));
        camera = watched(Vision::realistic(), 0.0, 0.0);
        assert!(camera.slip_ratio.iter().all(|slip| slip.is_nan()));
        camera = watched(Vision::default(), 1.0e-4, 0.3);
        assert!(
            camera
                .slip_ratio
                .iter()
                .all(|slip| (slip - 0.3).abs() < 1e-6)
        );
        camera = watched(Vision::default(), 0.01, -1.0);
        assert!(camera.slip_ratio.iter().all(|slip| *slip == -1.0));
    }

    #[test]
    fn sinkage_may_be_sampled_as_fast_as_forces() {
        let at = |frame_rate| Vision {
            frame_rate,
            ..Vision::default()
        };
        assert!(at(2000.0).check().is_ok());
        assert!(at(20_000.0).check().is_err());
    }

    #[test]
    fn equation_77_is_recovered() {
        let vision = Vision::default();
        let (displacement, mark) = (0.012, 0.01);
        let angle = libm::acos(1.0 - mark * mark / (2.0 * 0.1 * 0.1));
        let expected = 1.0 - displacement / (angle * RADIUS);
        let found = vision.slip(RADIUS, displacement, mark, true).get();
        assert!((found - expected).abs() < 1e-12, "{found}");
    }

    #[test]
    fn noise_of_slip_is_what_the_noise_of_both_displacements_makes_of_it() {
        let vision = Vision::realistic();
        let camera = watched(vision, 0.014, 0.2);
        let n = camera.slip_ratio.len() as f64;
        let mean = camera.slip_ratio.iter().sum::<f64>() / n;
        let variance = camera
            .slip_ratio
            .iter()
            .map(|s| (s - mean).powi(2))
            .sum::<f64>()
            / n;
        // ds = (1 - s)(-dS/ΔS + dθ/Δθ), over one second.
        let (displacement, turned) = (0.014, 0.014 / (RADIUS * 0.8));
        let expected = 0.8
            * libm::hypot(
                vision.displacement_noise / displacement,
                vision.mark_noise / vision.mark_radius / turned,
            );
        // 191 readings: a standard deviation is known to 5 %; four of those.
        assert!((variance.sqrt() / expected - 1.0).abs() < 0.2, "{variance}");
        assert!((mean - 0.2).abs() < 4.0 * expected / n.sqrt(), "{mean}");
    }

    #[test]
    fn a_frame_shows_what_was_there_one_delay_ago() {
        let vision = Vision {
            delay: 0.5,
            ..Vision::default()
        };
        let camera = watched(vision, 0.014, 0.0);
        for k in 5..200 {
            let seen = 0.01 + 1e-4 * (0.1 * k as f64 - 0.5);
            assert!((camera.sinkage[k] - seen).abs() < 1e-12);
        }
        assert_eq!(camera.sinkage[..5], [0.01; 5]);
    }
}
