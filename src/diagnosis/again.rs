//! The answer simulated: what an emulator predicted has to come true.
//!
//! Parameters and magnitudes are fitted to all conditions, so what is closed here is not held out;
//! it tells whether the emulator can be believed, and the gap in plain units.

use super::arm::Arm;
use super::emulator::Emulated;
use super::fit::Problem;
use super::library::Answers;
use super::observation::Observed;
use super::responses::Measured;
use super::shrinkage::{floor, reach};
use crate::gap::{Cell, Condition, Run, Statistic};
use serde::Serialize;

/// Streams simulated again.
pub(super) const STREAMS: u64 = 3;

/// Largest difference [spreads of replicates per statistic] between the gap predicted and the one
/// simulated that counts as kept.
const KEPT: f64 = 0.15;

/// Gaps of an arm, simulated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimulatedAgain {
    /// What was simulated.
    pub arm: Arm,
    /// Mean energy score [spreads of replicates per statistic] of measured runs against it, from the
    /// same floor as the gaps of the emulator.
    pub gap: f64,
    /// Whether that is what the emulator has for the same fit, or less.
    pub as_predicted: bool,
}

/// A number of one condition in its own unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InUnits {
    /// Which condition.
    pub condition: Condition,
    /// Which number.
    pub cell: Cell,
    /// Its unit.
    pub unit: String,
    /// Mean of the measured runs.
    pub measured: f64,
    /// Of the scenario as it came.
    pub as_shipped: f64,
    /// With parameters recalibrated; none where that could not be simulated.
    pub recalibrated: Option<f64>,
    /// With the effect or effects of the answer; none where there is none.
    pub with_effect: Option<f64>,
}

/// Mean gap of measured runs against runs of an arm; none where a condition has no run of it.
pub(super) fn simulated(
    problem: Problem,
    answers: &Answers,
    (arm, places): (&Arm, &[usize]),
    predicted: f64,
) -> Option<SimulatedAgain> {
    let gaps: Option<Vec<f64>> = problem
        .conditions()
        .zip(places)
        .map(|(condition, case)| gap(condition, answers, arm, *case))
        .collect();
    let gaps = gaps?;
    let gap = gaps.iter().sum::<f64>() / gaps.len() as f64;
    Some(SimulatedAgain {
        arm: arm.clone(),
        gap,
        as_predicted: gap < predicted + KEPT,
    })
}

fn gap(
    (emulated, observed): (&Emulated, &Observed),
    answers: &Answers,
    arm: &Arm,
    case: usize,
) -> Option<f64> {
    let row = |run: &Run| -> Option<Vec<f64>> {
        let values = emulated
            .cells
            .iter()
            .map(|cell| Some(run.readings.get(cell)?.value));
        Some(emulated.departure(&values.collect::<Option<Vec<f64>>>()?))
    };
    let made: Vec<Vec<f64>> = answers
        .of(arm, case)
        .filter_map(|(_, run)| row(run))
        .collect();
    if made.is_empty() {
        return None;
    }
    let mean = |run: &Vec<f64>| {
        let sum: f64 = made.iter().map(|made| emulated.apart(run, made)).sum();
        sum / made.len() as f64
    };
    let runs = &observed.runs;
    let apart = runs.iter().map(mean).sum::<f64>() / runs.len() as f64;
    // These had no part in the whitening: a perfect model's lie farther from a run than replicates do.
    let (floor, _) = floor(emulated, observed);
    Some(floor + apart - reach(emulated, observed, &made))
}

/// Means, deviations and steady means of all channels, condition by condition.
pub(super) fn in_units(
    problem: Problem,
    answers: &Answers,
    measured: &[Measured],
    arms: [Option<&Arm>; 2],
    places: &[usize],
) -> Vec<InUnits> {
    let mut rows = Vec::new();
    for (((emulated, _), measured), case) in problem.conditions().zip(measured).zip(places) {
        for (place, cell) in emulated.cells.iter().enumerate() {
            if !matches!(cell.statistic, Statistic::SteadyMean | Statistic::Deviation) {
                continue;
            }
            let of_arm = |arm: &Arm| {
                let runs = answers.of(arm, *case);
                let values = runs.filter_map(|(_, run)| Some(run.readings.get(cell)?.value));
                mean(values)
            };
            let [recalibrated, with_effect] = arms.map(|arm| arm.and_then(of_arm));
            let runs = measured.runs.iter().map(|row| row[place]);
            let (Some(measured), Some(as_shipped)) = (mean(runs), of_arm(&Arm::as_shipped()))
            else {
                continue;
            };
            rows.push(InUnits {
                condition: emulated.condition.clone(),
                cell: cell.clone(),
                unit: cell.unit(),
                measured,
                as_shipped,
                recalibrated,
                with_effect,
            });
        }
    }
    rows
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
