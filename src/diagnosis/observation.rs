//! Measured runs as departures from the emulator's middle.

use super::calibration::Calibration;
use super::emulator::{Emulated, Emulator};
use super::product::{mean, middle, product};
use super::responses::{DiagnosisError, Library, Measured};
use super::scatter::{Loudness, mean_square};

/// Degrees of freedom [-] with which the spread of repeats is held to be that of replicates.
const OF_SPREAD: f64 = 4.0;
/// Numbers [-] whose squares a condition's own spread is taken to be the mean of.
const OF_NUMBERS: f64 = 10.0;

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
    /// Sum of squares over that variance [-] that these repeats alone let it have; none of a single run.
    pub scattered: f64,
    /// Mean square [-] of a departure over that variance, outlying numbers cut.
    pub square: f64,
    /// How loud such a departure is.
    pub loudness: Loudness,
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
        let ratios = spreads_of_repeats(emulator, &departures);
        let conditions = departures
            .into_iter()
            .zip(measured)
            .zip(&emulator.conditions)
            .zip(ratios);
        let conditions = conditions
            .map(|(((runs, measured), emulated), ratio)| {
                let count = runs.len() as f64;
                let replicates = emulated.replicates.len() as f64;
                let share = 1.0 / replicates + ratio / count;
                let variance: Vec<f64> = emulated.scatter.variance(share).collect();
                let (_, of_repeats) = mean(&runs);
                Observed {
                    days: measured.days.clone(),
                    residual: middle(&runs),
                    scattered: product(&of_repeats, &emulated.scatter.precision(&variance)),
                    variance,
                    square: emulated.scatter.square(runs.len()),
                    loudness: emulated.scatter.loudness(runs.len()),
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

/// Variance of repeats over that of replicates [-], at least 1, by condition: its own, drawn to
/// that of all conditions, so that a run that went astray makes its condition count less.
fn spreads_of_repeats(emulator: &Emulator, departures: &[Vec<Vec<f64>>]) -> Vec<f64> {
    let own: Vec<[f64; 2]> = departures
        .iter()
        .zip(&emulator.conditions)
        .map(|(runs, emulated)| spread_of_repeats(emulated, runs))
        .collect();
    let sum = |part: usize| own.iter().map(|own| own[part]).sum::<f64>();
    let common = (OF_SPREAD + sum(0)) / (OF_SPREAD + sum(1));
    let drawn = |[squares, freedom]: &[f64; 2]| {
        let [squares, freedom] = [squares, freedom].map(|part| OF_NUMBERS * part);
        ((OF_SPREAD * common + squares) / (OF_SPREAD + freedom)).max(1.0)
    };
    own.iter().map(drawn).collect()
}

/// Sum of squares of repeats about their mean over that of replicates, the mean of all numbers, and
/// its degrees of freedom [-].
fn spread_of_repeats(emulated: &Emulated, runs: &[Vec<f64>]) -> [f64; 2] {
    let count = runs.len() as f64;
    let freedom = count - 1.0;
    let middle = middle(runs);
    // Of independent runs, the departure from their mean is smaller than that from the truth.
    let larger = count / freedom.max(1.0);
    let square =
        |run: &Vec<f64>| {
            let numbers = run.iter().zip(&middle).zip(emulated.scatter.variance(1.0));
            mean_square(numbers.map(|((number, middle), variance)| {
                (number - middle) * libm::sqrt(larger / variance)
            }))
        };
    let of_replicates = emulated.scatter.square(1);
    let mean = runs.iter().map(square).sum::<f64>() / count / of_replicates;
    [freedom * mean, freedom]
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
