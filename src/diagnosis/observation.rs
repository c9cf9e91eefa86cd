//! Measured runs as departures from the emulator's middle.

use super::calibration::Calibration;
use super::emulator::Emulator;
use super::responses::{DiagnosisError, Library, Measured};

/// Degrees of freedom [-] with which the spread of repeats is held to be that of replicates.
const OF_SPREAD: f64 = 4.0;

/// What was measured, whitened, condition by condition.
#[derive(Debug)]
pub struct Observation {
    pub(super) conditions: Vec<Observed>,
    /// Largest probability [-] of anything named, and why it is not 1.
    pub(super) scarce: Vec<(f64, &'static str)>,
}

/// Measured runs of one condition.
#[derive(Debug)]
pub(super) struct Observed {
    /// Each run's departure.
    pub runs: Vec<Vec<f64>>,
    pub days: Vec<String>,
    /// Mean departure.
    pub residual: Vec<f64>,
    /// Its variance, where the model is right.
    pub variance: Vec<f64>,
    /// Deviation [-] of the mean square of a departure over that variance.
    pub uncertainty: f64,
}

impl Observation {
    /// Measured runs, condition by condition as in the library.
    ///
    /// # Errors
    /// `Shape` and `NotFinite` for rows that do not fit the library's; `NoCondition` where a
    /// condition has no run.
    pub fn new(
        emulator: &Emulator,
        library: &Library,
        measured: &[Measured],
        calibration: &Calibration,
    ) -> Result<Self, DiagnosisError> {
        if measured.len() != emulator.conditions.len()
            || measured.iter().any(|condition| condition.runs.is_empty())
        {
            return Err(DiagnosisError::NoCondition);
        }
        for (responses, measured) in library.conditions.iter().zip(measured) {
            responses.rows("a measured run", &measured.runs)?;
        }
        let departures: Vec<Vec<Vec<f64>>> = measured
            .iter()
            .zip(&emulator.conditions)
            .map(|(measured, emulated)| {
                let runs = measured.runs.iter();
                runs.map(|run| emulated.departure(run)).collect()
            })
            .collect();
        let ratio = spread_of_repeats(emulator, &departures);
        let conditions = departures
            .into_iter()
            .zip(measured)
            .zip(&emulator.conditions);
        let conditions = conditions
            .map(|((runs, measured), emulated)| {
                let count = runs.len() as f64;
                let mut residual = vec![0.0; emulated.cells.len()];
                for run in &runs {
                    super::product::add(&mut residual, 1.0 / count, run);
                }
                let [variance, deviation] = emulated.variance;
                let replicates = emulated.replicates.len() as f64;
                let of_mean = variance * (1.0 / replicates + ratio / count);
                Observed {
                    days: measured.days.clone(),
                    residual,
                    variance: emulated.least.iter().map(|least| of_mean + least).collect(),
                    uncertainty: deviation / variance,
                    runs,
                }
            })
            .collect();
        Ok(Self {
            conditions,
            scarce: scarce(emulator, measured, calibration),
        })
    }
}

/// Variance of repeats over that of replicates [-], at least 1.
fn spread_of_repeats(emulator: &Emulator, departures: &[Vec<Vec<f64>>]) -> f64 {
    let [mut ratios, mut freedom] = [OF_SPREAD, OF_SPREAD];
    for (runs, emulated) in departures.iter().zip(&emulator.conditions) {
        let count = runs.len() as f64;
        for place in 0..emulated.cells.len() {
            let mean = runs.iter().map(|run| run[place]).sum::<f64>() / count;
            let square: f64 = runs
                .iter()
                .map(|run| (run[place] - mean) * (run[place] - mean))
                .sum();
            let share = 1.0 / emulated.cells.len() as f64;
            ratios += share * square / (emulated.variance[0] + emulated.least[place]);
        }
        freedom += count - 1.0;
    }
    (ratios / freedom).max(1.0)
}

fn scarce(
    emulator: &Emulator,
    measured: &[Measured],
    calibration: &Calibration,
) -> Vec<(f64, &'static str)> {
    let mut channels: Vec<&str> = emulator
        .conditions
        .iter()
        .flat_map(|condition| &condition.cells)
        .map(|cell| &*cell.channel)
        .collect();
    channels.sort_unstable();
    channels.dedup();
    let repeated = measured.iter().any(|condition| condition.runs.len() > 1);
    let [one_condition, no_repeats, one_channel] = calibration.scarce;
    [
        (
            emulator.conditions.len() == 1,
            one_condition,
            "one condition: nothing could be held out",
        ),
        (
            !repeated,
            no_repeats,
            "no repeats: measurements are taken to spread as replicates do",
        ),
        (channels.len() == 1, one_channel, "one channel"),
    ]
    .into_iter()
    .filter(|(is, ..)| *is)
    .map(|(_, most, why)| (most, why))
    .collect()
}
