//! The reference: the same wheel's acceleration on flat hard ground (Section 2.2.1).
//!
//! It is computed for the measured rotation of the window, so that it has the same number of lug changes,
//! speed variation and boundaries. It is the derivative of Eq. (10) with its velocity jumps
//! ([`crate::vibration`]): impacts of zero duration on rigid ground under a rigid rig.
//!
//! Real rigs are not ideal. Where runs on the reference terrain (REF) were recorded, or the sensors'
//! properties are known, [`Reference::measured`] compares their statistics with the computed ones and
//! corrects the computed reference accordingly, so that a window on REF reads 1. Between the recorded speeds
//! the correction is interpolated over the logarithm of the lug-pass frequency; beyond them it is constant.

use super::record::{Record, RecordError, Unusable};
use super::spectrum::gaussian_gain;
use super::{Extractor, Settings, Statistics, Window};
use crate::quantity::{RangeError, SampleRate, Seed};
use crate::sensors::{Observed, SensorChain, Sensors};
use crate::simulation::WheelState;
use crate::trace::{RunAttributes, Trace};
use crate::vibration::flat_ground;
use crate::vibration::reference::{LugChange, lug_changes};
use crate::wheel::Wheel;
use std::borrow::Borrow;
use std::f64::consts::{LN_2, PI};
use std::ops::Range;

/// What features are taken over: the computed reference, corrected where REF was measured.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reference {
    /// By rising lug-pass frequency.
    corrections: Vec<Correction>,
}

/// Measured over computed statistics on REF at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Correction {
    /// Natural logarithm of the lug-pass frequency [Hz].
    log_lug_pass: f64,
    /// Of frequency, amplitude sum, mean value, mean square [-].
    ratios: [f64; 4],
}

/// Why runs on REF make no reference.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// A run lacks what features need.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A setting or a sensor's figure is out of its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// No window of these runs can be used.
    #[error("no window of the reference runs can be used: {0}")]
    NoWindow(Unusable),
    /// There are no runs.
    #[error("there are no reference runs")]
    NoRuns,
}

impl Reference {
    /// The computed reference as it is.
    pub fn computed() -> Self {
        Self::default()
    }

    /// The computed reference, corrected by `runs` on the reference terrain: one point for every
    /// speed, from all windows of its runs.
    ///
    /// # Errors
    /// [`ReferenceError`] where there are no runs, or one of them cannot be used.
    pub fn measured(
        runs: impl IntoIterator<Item = impl Borrow<Trace>>,
        settings: Settings,
    ) -> Result<Self, ReferenceError> {
        let mut extractor = Extractor::new(settings)?;
        let mut corrections = Vec::new();
        for run in runs {
            corrections.push(correction(&mut extractor, &Record::of(run.borrow())?)?);
        }
        if corrections.is_empty() {
            return Err(ReferenceError::NoRuns);
        }
        corrections.sort_by(|a, b| a.log_lug_pass.total_cmp(&b.log_lug_pass));
        Ok(Self {
            corrections: merged(&corrections),
        })
    }

    /// The computed reference passed through `sensors`, noise and all, on a wheel that turns at
    /// each of `wheel_speeds` [rad/s]. The noise is a fixed draw of its own.
    ///
    /// # Errors
    /// `Range` for sensors that cannot be; `NoWindow` for a wheel speed of zero.
    pub fn through_sensors(
        wheel: &Wheel,
        sensors: &Sensors,
        wheel_speeds: &[f64],
        settings: Settings,
    ) -> Result<Self, ReferenceError> {
        if wheel_speeds.contains(&0.0) {
            return Err(ReferenceError::NoWindow(Unusable::AtRest));
        }
        let lug_angle = wheel.lug_angle().unwrap_or(2.0 * PI);
        // As long as the windows of runs: the sum of noise's amplitudes grows with a window.
        let duration = |speed: f64| {
            let pass = lug_angle / speed.abs();
            let window = match settings.window {
                Window::Seconds(length) => length,
                Window::LugPasses(passes) => passes * pass,
            };
            (SENSED_PASSES * pass).max(SENSED_WINDOWS * window)
        };
        let traces = wheel_speeds.iter().zip(0..);
        let traces: Result<Vec<Trace>, RangeError> = traces
            .map(|(&speed, run)| sensed(wheel, sensors, [speed, duration(speed)], run))
            .collect();
        Self::measured(traces?, settings)
    }

    /// The statistics `computed` at a `lug_pass` frequency [Hz], as REF would read.
    pub(super) fn correct(&self, computed: Statistics, lug_pass: f64) -> Statistics {
        let [frequency, amplitude_sum, mean_value, mean_square] = self.ratios(libm::log(lug_pass));
        Statistics {
            frequency: computed.frequency * frequency,
            amplitude_sum: computed.amplitude_sum * amplitude_sum,
            mean_value: computed.mean_value * mean_value,
            mean_square: computed.mean_square * mean_square,
        }
    }

    fn ratios(&self, log_lug_pass: f64) -> [f64; 4] {
        let after = self
            .corrections
            .partition_point(|point| point.log_lug_pass < log_lug_pass);
        let before = after.checked_sub(1).and_then(|i| self.corrections.get(i));
        match (before, self.corrections.get(after)) {
            (Some(a), Some(b)) => {
                let share = (log_lug_pass - a.log_lug_pass) / (b.log_lug_pass - a.log_lug_pass);
                std::array::from_fn(|i| a.ratios[i] + share * (b.ratios[i] - a.ratios[i]))
            }
            (Some(only), None) | (None, Some(only)) => only.ratios,
            (None, None) => [1.0; 4],
        }
    }
}

/// Ratio of lug-pass frequencies up to which runs on REF count as repeats.
const REPEATS: f64 = 1.05;

/// Repeats at one speed as their mean; `corrections` are in order.
fn merged(corrections: &[Correction]) -> Vec<Correction> {
    let near =
        |a: &Correction, b: &Correction| b.log_lug_pass - a.log_lug_pass < libm::log(REPEATS);
    let mean = |repeats: &[Correction]| {
        let n = repeats.len() as f64;
        let of = |f: &dyn Fn(&Correction) -> f64| repeats.iter().map(f).sum::<f64>() / n;
        Correction {
            log_lug_pass: of(&|point| point.log_lug_pass),
            ratios: std::array::from_fn(|i| of(&|point| point.ratios[i])),
        }
    };
    corrections.chunk_by(near).map(mean).collect()
}

/// How the windows of a run on REF compare with the computed reference, on average.
fn correction(extractor: &mut Extractor, record: &Record) -> Result<Correction, ReferenceError> {
    let settings = *extractor.settings();
    let (mut ratios, mut lug_pass, mut count) = ([0.0; 4], 0.0, 0.0);
    let mut trouble = Unusable::AtRest;
    for window in record.windows(settings.window) {
        let features = extractor.features(record, window.clone(), &Reference::computed());
        match features {
            Ok(features) => {
                let now = [
                    features.kappa_f,
                    features.kappa_a,
                    features.kappa_mv,
                    features.kappa_ms,
                ];
                ratios = std::array::from_fn(|i| ratios[i] + now[i]);
                lug_pass += record.lug_passes(&window) / record.seconds(&window);
                count += 1.0;
            }
            Err(reason) => trouble = reason,
        }
    }
    if count == 0.0 {
        return Err(ReferenceError::NoWindow(trouble));
    }
    Ok(Correction {
        log_lug_pass: libm::log(lug_pass / count),
        ratios: ratios.map(|sum| sum / count),
    })
}

/// Lug passes and windows in a computed reference run [-], at least.
const SENSED_PASSES: f64 = 6.0;
const SENSED_WINDOWS: f64 = 2.0;
/// Steps per second of such a run [Hz]: far above any bandwidth of features.
const SENSED_RATE: f64 = 16_000.0;

/// What `sensors` make of the computed reference at a steady wheel speed [rad/s], for some time [s].
fn sensed(
    wheel: &Wheel,
    sensors: &Sensors,
    [wheel_speed, duration]: [f64; 2],
    run: u64,
) -> Result<Trace, RangeError> {
    let rate = SampleRate::new(SENSED_RATE)?;
    let steps = (duration * rate.hertz()) as usize;
    let angle = |step: usize| wheel_speed * rate.period() * step as f64;
    let angles: Vec<f64> = (0..steps).map(angle).collect();
    let mut jumps = lug_changes(wheel, &angles, rate.hertz())
        .into_iter()
        .peekable();
    let observed = Observed {
        physics_rate: rate,
        wheel_radius: wheel.radius,
        seed: Seed(0),
        run,
    };
    let mut chain = SensorChain::new(sensors, &observed)?;
    for (step, &wheel_angle) in angles.iter().enumerate() {
        let time = step as f64 * rate.period();
        let mut upward = flat_ground::acceleration(wheel, wheel_angle, wheel_speed, 0.0);
        while let Some(jump) = jumps.next_if(|jump| jump.time <= time) {
            upward += jump.velocity_jump * rate.hertz();
        }
        chain.push(&WheelState {
            time,
            wheel_angle,
            wheel_speed,
            forward_speed: wheel_speed * wheel.radius,
            vertical_acceleration: upward,
            ..WheelState::default()
        });
    }
    Ok(Trace {
        attributes: RunAttributes {
            wheel_radius: wheel.radius,
            wheel_width: wheel.width,
            lug_count: Some(wheel.lug_count()),
            lug_height: wheel.lug_height(),
            ..RunAttributes::default()
        },
        channels: chain.finish(),
        ..Trace::default()
    })
}

/// The reference in a window: velocity jumps, and the smooth acceleration between them.
pub(super) struct Train {
    changes: Vec<LugChange>,
    smooth: Vec<f64>,
    sample_rate: f64,
}

/// Points of the smooth part in a window.
const POINTS: usize = 512;
/// Points to either side over which the wheel speed is taken.
const SPEED_POINTS: usize = 4;
/// Pulse width over which it is summed up, times the bandwidth: beyond, it is below 1e-15.
const PULSE: f64 = 1.12;

/// The reference for the turn of the wheel in a window.
pub(super) fn train(record: &Record, window: Range<usize>) -> Result<Train, Unusable> {
    let angle = &record.angle[window.clone()];
    let changes = lug_changes(&record.wheel, angle, record.sample_rate);
    if changes.is_empty() {
        let passes = record.lug_passes(&window);
        return Err(Unusable::FewLugPasses {
            passes,
            needed: 1.0,
        });
    }
    Ok(Train {
        changes,
        smooth: smooth(record, angle),
        sample_rate: record.sample_rate,
    })
}

/// Acceleration [m/s²] between lug changes at every sample.
fn smooth(record: &Record, angle: &[f64]) -> Vec<f64> {
    let last = angle.len() - 1;
    let stride = (angle.len() / POINTS).max(1);
    let at = |point: usize| (point * stride).min(last);
    let value = |point: usize| {
        let (from, to) = (
            at(point.saturating_sub(SPEED_POINTS)),
            at(point + SPEED_POINTS),
        );
        let turned = angle[to] - angle[from];
        let speed = turned * record.sample_rate / (to - from).max(1) as f64;
        flat_ground::acceleration(&record.wheel, angle[at(point)], speed, 0.0)
    };
    let points: Vec<f64> = (0..=last / stride + 1).map(value).collect();
    let mut samples = Vec::with_capacity(points.len() * stride);
    for pair in points.windows(2) {
        let shares = (0..stride).map(|step| step as f64 / stride as f64);
        samples.extend(shares.map(|share| pair[0] * (1.0 - share) + pair[1] * share));
    }
    samples.truncate(last + 1);
    samples
}

impl Train {
    /// The acceleration [m/s²] at every sample behind a Gaussian low-pass with its corner at
    /// `bandwidth` [Hz]; the smooth part lies far below it.
    pub fn low_passed(&self, bandwidth: f64) -> Vec<f64> {
        let mut samples = self.smooth.clone();
        let peak = bandwidth * libm::sqrt(2.0 * PI / LN_2);
        let reach = (PULSE / bandwidth * self.sample_rate).ceil();
        for change in &self.changes {
            let centre = change.time * self.sample_rate;
            let first = (centre - reach).ceil().max(0.0) as usize;
            let end = ((centre + reach).floor() as usize + 1).min(samples.len());
            for (sample, value) in samples.iter_mut().enumerate().take(end).skip(first) {
                let time = (sample as f64 - centre) / self.sample_rate;
                *value += change.velocity_jump * peak * pulse(time * bandwidth);
            }
        }
        samples
    }
}

/// Height [-] of a unit pulse behind the Gaussian low-pass at a time times its corner frequency.
fn pulse(time: f64) -> f64 {
    // The Fourier transform of the gain.
    gaussian_gain(2.0 * PI * time / LN_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(wheel: Wheel, wheel_speed: f64, seconds: f64) -> Record {
        let angle = |i: u32| wheel_speed * f64::from(i) / 2000.0 + 0.03;
        let samples = (seconds * 2000.0) as u32;
        let sensed = sensed(&wheel, &Sensors::default(), [0.5, 3.0], 0).unwrap();
        let mut record = Record::of(&sensed).unwrap();
        record.angle = (0..samples).map(angle).collect();
        record
    }

    #[test]
    fn pulses_integrate_to_the_velocity_jumps_and_the_smooth_part_reverses_them() {
        let wheel = Wheel::single_wheel();
        let record = record(wheel, 0.2, 22.0);
        let whole = 0..record.angle.len();
        let train = train(&record, whole).unwrap();
        let gained: f64 = train.low_passed(100.0).iter().sum::<f64>() / 2000.0;
        let jump = 0.4 * wheel.tip_radius() * libm::sin(record.lug_angle / 2.0);
        // Between two lug changes the velocity is fully regained; at the ends less than one jump remains.
        assert!(gained.abs() < jump, "{gained} {jump}");
        let jumps: f64 = train
            .changes
            .iter()
            .map(|change| change.velocity_jump)
            .sum();
        assert!((jumps / train.changes.len() as f64 / jump - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_pulse_has_the_area_of_its_jump() {
        let area: f64 = (-4000..4000)
            .map(|i| 1e-3 * libm::sqrt(2.0 * PI / LN_2) * pulse(f64::from(i) * 1e-3))
            .sum();
        assert!((area - 1.0).abs() < 1e-9, "{area}");
    }

    #[test]
    fn ideal_sensors_do_not_change_the_computed_reference() {
        let wheel = Wheel::rover();
        let speeds = [0.05, 0.2];
        let reference =
            Reference::through_sensors(&wheel, &Sensors::default(), &speeds, Settings::default());
        for correction in reference.unwrap().corrections {
            for ratio in correction.ratios {
                // 1 %: the chain places impacts on its grid, and its window ends elsewhere.
                assert!((ratio - 1.0).abs() < 0.01, "{correction:?}");
            }
        }
    }

    #[test]
    fn a_wheel_at_rest_has_no_reference() {
        let (wheel, sensors) = (Wheel::rover(), Sensors::default());
        let none = Reference::through_sensors(&wheel, &sensors, &[0.1, 0.0], Settings::default());
        assert!(matches!(
            none,
            Err(ReferenceError::NoWindow(Unusable::AtRest))
        ));
    }

    #[test]
    fn noise_lifts_the_reference_at_low_speed_most() {
        let wheel = Wheel::rover();
        let mut sensors = Sensors::default();
        sensors.accelerometer.acceleration_y.noise_density = 5.0e-4;
        let speeds = [0.04, 0.4];
        let reference =
            Reference::through_sensors(&wheel, &sensors, &speeds, Settings::default()).unwrap();
        let [slow, fast] = [0, 1].map(|i| reference.corrections[i].ratios[3]);
        // The noise alone has 1.3 times the mean square of the slow reference.
        assert!(slow > 1.2 && (fast - 1.0).abs() < 0.02, "{slow} {fast}");
    }

    #[test]
    fn repeats_at_one_speed_count_as_their_mean() {
        let point = |lug_pass: f64, ratio| Correction {
            log_lug_pass: libm::log(lug_pass),
            ratios: [ratio; 4],
        };
        let points = merged(&[point(0.1, 1.0), point(0.101, 2.0), point(0.2, 3.0)]);
        let ratios: Vec<f64> = points.iter().map(|point| point.ratios[0]).collect();
        assert_eq!(ratios, [1.5, 3.0]);
    }

    #[test]
    fn corrections_are_interpolated_between_speeds_and_stay_beyond_them() {
        let point = |lug_pass: f64, ratio| Correction {
            log_lug_pass: libm::log(lug_pass),
            ratios: [ratio; 4],
        };
        let reference = Reference {
            corrections: vec![point(0.1, 1.0), point(1.0, 2.0)],
        };
        for (lug_pass, expected) in [(0.01, 1.0), (0.1, 1.0), (0.316_227_766, 1.5), (5.0, 2.0)] {
            let ratio = reference.ratios(libm::log(lug_pass))[0];
            assert!((ratio - expected).abs() < 1e-9, "{ratio}");
        }
    }
}
