//! Attribution of the gap in a result to the stages of processing between sensor and result.
//!
//! The result of the measured run lies some distance from that of a simulated one. Parts of the input are
//! replaced, simulated by measured, in every combination; the share of a stage is its marginal contribution
//! to the distance, averaged over all orders of replacement (Shapley 1953). Shares add up to the whole
//! distance; a negative one means that the measured part reduces the distance.
//!
//! ```text
//! φ_i = Σ_S  |S|! (m − |S| − 1)! / m!  ·  (v(S ∪ i) − v(S)),      v(S) = distance of the answer
//! ```
//!
//! - [`vibration`]: raw acceleration = the part removed by the features' bandwidth + the part retained, and
//!   the rotation; the results are the feature vector and the class recognised from it.
//! - [`loads`]: slip, sinkage, pull, load, torque; the result is the identified terrain.

use super::GapError;
use crate::features::reference::Reference;
use crate::features::{Extractor, Settings};
use crate::identification::{Identification, IdentifyError, Parameter, Setting, SteadyLoad};
use crate::recognition::{Method, Recognizer};
use crate::signal::Plans;
use crate::terrain::class::Wtic;
use crate::trace::{Channel, Trace};
use realfft::num_complex::Complex;
use serde::Serialize;

/// A part of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Acceleration above the features' bandwidth.
    AboveBand,
    /// Acceleration within it.
    InBand,
    /// How the wheel turned.
    Rotation,
    /// Slip ratio.
    Slip,
    /// Sinkage.
    Sinkage,
    /// Drawbar pull.
    DrawbarPull,
    /// Vertical load.
    Load,
    /// Driving torque.
    DrivingTorque,
}

/// The part of the distance that a stage brings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StageShare {
    /// The stage.
    pub stage: Stage,
    /// Its part, in the distance's unit.
    pub distance: f64,
    /// Its part of the whole [-]; `None` where there is no distance.
    pub share: Option<f64>,
}

/// A distance by stages.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stages {
    /// The whole distance.
    pub distance: f64,
    /// Stage by stage.
    pub shares: Vec<StageShare>,
}

impl Stages {
    /// From the distance at every combination of real parts, bit `i` for stage `i`.
    fn of(stages: &[Stage], distances: &[f64]) -> Self {
        let whole = distances[distances.len() - 1];
        let parts = shapley(stages.len(), distances);
        let shares = stages.iter().zip(parts).map(|(stage, part)| StageShare {
            stage: *stage,
            distance: part,
            share: (whole > 0.0).then(|| part / whole),
        });
        Self {
            distance: whole,
            shares: shares.collect(),
        }
    }
}

/// Average over all orders of what each of `count` parts adds to `value`.
fn shapley(count: usize, value: &[f64]) -> Vec<f64> {
    let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
    let part = |i: usize| {
        let without = (0..value.len()).filter(|set| set & (1 << i) == 0);
        without
            .map(|set| {
                let size = set.count_ones() as usize;
                let orders = factorial(size) * factorial(count - size - 1) / factorial(count);
                orders * (value[set | (1 << i)] - value[set])
            })
            .sum()
    };
    (0..count).map(part).collect()
}

/// The vibration's answers by stages.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VibrationStages {
    /// Of the feature vector, averaged over windows \[decades\].
    pub features: Stages,
    /// Of the class by the paper's regions: share of windows in which it is another [-].
    pub class: Stages,
}

const VIBRATION: [Stage; 3] = [Stage::AboveBand, Stage::InBand, Stage::Rotation];

/// Stages of features and class between a measured run and a simulated one of its condition, over
/// the time from their starts that both have.
///
/// # Errors
/// `Range` for settings out of range; `Recognition` for a run without acceleration, rotation or
/// lugs; `Rates` where accelerations are sampled at different rates; `NoFeatures` where some
/// combination leaves no window with features.
pub fn vibration(
    measured: &Trace,
    simulated: &Trace,
    settings: Settings,
    reference: &Reference,
) -> Result<VibrationStages, GapError> {
    let extractor = Extractor::new(settings).map_err(GapError::Range)?;
    let corner = extractor.settings().bandwidth;
    let real = Parts::of(measured, corner)?;
    let made = Parts::of(simulated, corner)?;
    if real.rate != made.rate {
        return Err(GapError::Rates([real.rate, made.rate]));
    }
    let mut recognizer =
        Recognizer::new(settings, reference.clone(), &[Method::Paper]).map_err(GapError::Range)?;
    let mut answers = Vec::new();
    for set in 0..1 << VIBRATION.len() {
        let part = |stage: usize| {
            if set & (1 << stage) == 0 {
                &made
            } else {
                &real
            }
        };
        let hybrid = Parts::joined(part(0), part(1), part(2), simulated);
        let windows = recognizer
            .recognize(&hybrid)
            .map_err(GapError::Recognition)?;
        let features: Vec<Answered> = windows
            .into_iter()
            .filter_map(|window| {
                Some(Answered {
                    class: window.answers.first()?.class,
                    p: window.p.ok()?,
                })
            })
            .collect();
        if features.is_empty() {
            return Err(GapError::NoFeatures);
        }
        answers.push(features);
    }
    let mean = |features: &[Answered]| -> [f64; 4] {
        [0, 1, 2, 3].map(|i| features.iter().map(|of| of.p[i]).sum::<f64>() / features.len() as f64)
    };
    let start = mean(&answers[0]);
    let features: Vec<f64> = answers
        .iter()
        .map(|features| super::distance::apart(&mean(features), &start))
        .collect();
    let class: Vec<f64> = answers
        .iter()
        .map(|features| differing(features, &answers[0]))
        .collect();
    Ok(VibrationStages {
        features: Stages::of(&VIBRATION, &features),
        class: Stages::of(&VIBRATION, &class),
    })
}

/// Features and class of a window.
struct Answered {
    p: [f64; 4],
    class: Wtic,
}

/// Share of windows whose classes differ, of those that both have.
fn differing(one: &[Answered], other: &[Answered]) -> f64 {
    let pairs = one.iter().zip(other);
    let differ = pairs.clone().filter(|(a, b)| a.class != b.class).count();
    differ as f64 / pairs.count().max(1) as f64
}

/// The acceleration of a run by bands, and its rotation, all from time 0 on.
struct Parts {
    rate: f64,
    in_band: Vec<f64>,
    above: Vec<f64>,
    rotation: Vec<Channel>,
}

impl Parts {
    fn of(trace: &Trace, corner: f64) -> Result<Self, GapError> {
        let acceleration = trace
            .channel("acceleration_y")
            .filter(|channel| channel.samples.len() > 1)
            .ok_or(GapError::NoFeatures)?;
        let in_band = low_passed(&acceleration.samples, corner / acceleration.sample_rate);
        let pairs = acceleration.samples.iter().zip(&in_band);
        let rotation = trace.channels.iter().filter(|channel| {
            ["wheel_angle", "forward_speed", "slip_ratio"].contains(&&channel.name[..])
        });
        Ok(Self {
            rate: acceleration.sample_rate,
            above: pairs.map(|(x, low)| x - low).collect(),
            in_band,
            rotation: rotation
                .map(|channel| Channel {
                    start: channel.start - acceleration.start,
                    ..channel.clone()
                })
                .collect(),
        })
    }

    /// A run of these parts, on the wheel of `like`.
    fn joined(above: &Self, in_band: &Self, rotation: &Self, like: &Trace) -> Trace {
        let sums = above.above.iter().zip(&in_band.in_band).map(|(a, b)| a + b);
        let acceleration = Channel {
            name: "acceleration_y".to_owned(),
            unit: "m/s^2".to_owned(),
            sample_rate: in_band.rate,
            start: 0.0,
            samples: sums.collect(),
        };
        let mut channels = vec![acceleration];
        channels.extend(rotation.rotation.iter().cloned());
        Trace {
            attributes: like.attributes.clone(),
            channels,
            ..Trace::default()
        }
    }
}

/// What lies below `corner` times the sample rate, as if the samples went on periodically.
fn low_passed(samples: &[f64], corner: f64) -> Vec<f64> {
    let length = samples.len();
    let mut plans = Plans::default();
    let mut spectrum = plans.forward(length).apply(samples.to_vec());
    let kept = ((corner * length as f64) as usize + 1).min(length.div_ceil(2));
    spectrum[kept..].fill(Complex::default());
    let scale = 1.0 / length as f64;
    let low = plans.backward(length).apply(spectrum).into_iter();
    low.map(|x| x * scale).collect()
}

const LOADS: [Stage; 5] = [
    Stage::Slip,
    Stage::Sinkage,
    Stage::DrawbarPull,
    Stage::Load,
    Stage::DrivingTorque,
];

/// Stages of the identified terrain between measured and simulated rows of the same conditions, in the same
/// order. The distance is the root mean square, over the parameters identified from the simulated rows, of
/// their difference over the [uninformative half-width](Parameter::uninformative).
///
/// # Errors
/// `Rows` where the numbers of rows differ; `Identify` where some combination cannot be
/// identified.
pub fn loads(
    measured: &[SteadyLoad],
    simulated: &[SteadyLoad],
    class: Wtic,
    setting: &Setting,
) -> Result<Stages, GapError> {
    if measured.len() != simulated.len() {
        return Err(GapError::Rows([measured.len(), simulated.len()]));
    }
    let estimate = |rows: &[SteadyLoad]| {
        let identification = Identification::new(rows, class, setting);
        identification.and_then(|identification| identification.estimate())
    };
    let start = estimate(simulated).map_err(GapError::Identify)?;
    let known: Vec<Parameter> = Parameter::ALL
        .into_iter()
        .filter(|parameter| start.of(*parameter).is_identifiable())
        .collect();
    let distance = |set: usize| -> Result<f64, IdentifyError> {
        let pairs = measured.iter().zip(simulated);
        let rows: Vec<SteadyLoad> = pairs.map(|(real, made)| swapped(made, real, set)).collect();
        let hybrid = estimate(&rows)?;
        let square = known.iter().map(|parameter| {
            let at = |value: f64| parameter.coordinate(value);
            let moved = at(hybrid.of(*parameter).value) - at(start.of(*parameter).value);
            (moved / parameter.uninformative()) * (moved / parameter.uninformative())
        });
        Ok(libm::sqrt(square.sum::<f64>() / known.len().max(1) as f64))
    };
    let distances: Result<Vec<f64>, IdentifyError> = (0..1 << LOADS.len()).map(distance).collect();
    Ok(Stages::of(&LOADS, &distances.map_err(GapError::Identify)?))
}

/// A simulated row with the real quantities of this set.
fn swapped(made: &SteadyLoad, real: &SteadyLoad, set: usize) -> SteadyLoad {
    let of = |stage: usize| if set & (1 << stage) == 0 { made } else { real };
    SteadyLoad {
        slip: of(0).slip,
        sinkage: of(1).sinkage,
        drawbar_pull: of(2).drawbar_pull,
        load: of(3).load,
        driving_torque: of(4).driving_torque,
        uncertainty: made.uncertainty,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapley_s_shares_add_up_and_a_part_that_never_matters_has_none() {
        // The first part counts 1, the second 2, together 1 more; the third nothing.
        let value = [0.0, 1.0, 2.0, 4.0, 0.0, 1.0, 2.0, 4.0];
        let parts = shapley(3, &value);
        let expected = [1.5, 2.5, 0.0];
        for (part, expected) in parts.iter().zip(expected) {
            assert!((part - expected).abs() < 1e-12, "{parts:?}");
        }
    }

    #[test]
    fn the_two_bands_of_an_acceleration_are_its_tones_below_and_above_the_corner() {
        let tone =
            |cycles: f64, i: usize| libm::sin(0.002 * std::f64::consts::PI * cycles * i as f64);
        let sum: Vec<f64> = (0..1000)
            .map(|i| tone(30.0, i) + 0.5 * tone(300.0, i))
            .collect();
        for (i, low) in low_passed(&sum, 0.1).iter().enumerate() {
            assert!((low - tone(30.0, i)).abs() < 1e-9, "{i}: {low}");
        }
    }
}
