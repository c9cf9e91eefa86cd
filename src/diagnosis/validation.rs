//! How far the gap closes, by simulation of the scenario as it is, recalibrated, and with the effects found.
//!
//! A measured run `y` is held against `n` simulated runs `x_i` of its condition by the energy score (Gneiting and Raftery
//! 2007, J. Am. Stat. Assoc. 102:359-378)
//!
//! ```text
//! G = mean_i d(y, x_i) − ½ mean_(i<j) d(x_i, x_j),     d(a, b)² = mean over statistics of ((z_a − z_b) / σ)²
//! ```
//!
//! with standardised statistics `z` and their scatter `σ` between rigs of one kind. A perfect model scores the floor,
//! `½ mean d(x_i, x_j)`. Parameters and sizes are fitted to all conditions: a handful of numbers to thousands of statistics.

use super::arm::Arm;
use super::condition::Case;
use super::inference::Model;
use super::rigs::Column;
use super::simulated_runs::SimulatedRuns;
use crate::gap::{
    Cell, Closed, Condition, Run, Scores, Statistic, closed, energy_score, least_energy_score,
};
use crate::quantity::Seed;
use crate::statistics::mean;
use serde::{Deserialize, Serialize};

/// Mean energy scores [scatters per statistic].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gaps {
    /// Of the scenario as it is.
    pub as_shipped: f64,
    /// With parameters recalibrated.
    pub recalibrated: f64,
    /// With the likeliest effect or effects too; as recalibrated where none is likely.
    pub with_effect: f64,
    /// What a perfect model reaches.
    pub floor: f64,
}

/// The gap and how far it closes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Validation {
    /// Effects that were added.
    pub effects: Vec<String>,
    /// The gap.
    pub gaps: Gaps,
    /// Share of the recalibrated gap that the effects close; none without effects, or where recalibration leaves no gap.
    pub closed: Option<Closed>,
}

/// The variants that are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Variants {
    /// Parameters recalibrated.
    pub recalibrated: Arm,
    /// The likeliest effect or effects too; none where none is likely.
    pub with_effect: Option<Arm>,
}

/// What runs are judged by.
#[derive(Clone, Copy)]
pub struct Yardstick<'a> {
    /// The model that standardises statistics.
    pub model: &'a Model,
    /// Its columns.
    pub columns: &'a [Column],
}

impl Yardstick<'_> {
    fn row(&self, condition: usize, run: &Run) -> Vec<f64> {
        let row = self
            .model
            .standardised(self.columns, condition, &run.readings);
        per_statistic(row)
    }
}

/// The gaps of measured runs, condition by condition; none where a variant has too few runs.
pub fn validate(
    yardstick: Yardstick,
    measured: &[Vec<Run>],
    simulated: &SimulatedRuns,
    variants: &Variants,
    cases: &[Case],
    seed: Seed,
) -> Option<Validation> {
    let shipped = Arm::as_shipped();
    let recalibrated = &variants.recalibrated;
    let with_effect = variants.with_effect.as_ref().unwrap_or(recalibrated);
    let mut scores = Vec::new();
    let mut of_shipped = Vec::new();
    for (condition, case) in cases.iter().enumerate() {
        let rows = |arm: &Arm| -> Vec<Vec<f64>> {
            let runs = simulated.of(arm, condition);
            runs.map(|run| yardstick.row(condition, run)).collect()
        };
        let [shipped, recalibrated, with_effect] = [&shipped, recalibrated, with_effect].map(rows);
        // The better model has the scatter of a perfect one.
        let floor = least_energy_score(&with_effect)?;
        for run in &measured[condition] {
            let row = yardstick.row(condition, run);
            of_shipped.push(energy_score(&row, &shipped)?);
            scores.push(Scores {
                condition: case.condition.clone(),
                day: run.attributes.day.clone(),
                recalibrated: energy_score(&row, &recalibrated)?,
                with_effect: energy_score(&row, &with_effect)?,
                floor,
            });
        }
    }
    let mean =
        |of: &dyn Fn(&Scores) -> f64| scores.iter().map(of).sum::<f64>() / scores.len() as f64;
    let effects = variants.with_effect.iter().flat_map(|arm| arm.effects());
    Some(Validation {
        effects: effects.map(|effect| effect.name()).collect(),
        gaps: Gaps {
            as_shipped: of_shipped.iter().sum::<f64>() / of_shipped.len() as f64,
            recalibrated: mean(&|it| it.recalibrated),
            with_effect: mean(&|it| it.with_effect),
            floor: mean(&|it| it.floor),
        },
        closed: variants
            .with_effect
            .as_ref()
            .and_then(|_| closed(&scores, seed)),
    })
}

/// A row whose Euclidean distances are `d`.
fn per_statistic(mut row: Vec<f64>) -> Vec<f64> {
    let root = libm::sqrt(row.len().max(1) as f64);
    row.iter_mut().for_each(|z| *z /= root);
    row
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
    /// Of the scenario as it is.
    pub as_shipped: f64,
    /// With parameters recalibrated; none where that could not be simulated.
    pub recalibrated: Option<f64>,
    /// With the effect or effects of the answer; none where there is none.
    pub with_effect: Option<f64>,
}

/// Means, deviations and steady means of all channels, condition by condition.
pub fn in_units(
    columns: &[Column],
    measured: &[Vec<Run>],
    simulated: &SimulatedRuns,
    variants: &Variants,
    cases: &[Case],
) -> Vec<InUnits> {
    let is_plain = |column: &&Column| {
        let statistic = column.cell.statistic;
        matches!(statistic, Statistic::SteadyMean | Statistic::Deviation)
    };
    let rows = columns.iter().filter(is_plain).filter_map(|column| {
        let cell = &column.cell;
        let of_arm = |arm: &Arm| mean_of(simulated.of(arm, column.condition), cell);
        Some(InUnits {
            condition: cases[column.condition].condition.clone(),
            unit: cell.unit(),
            measured: mean_of(measured[column.condition].iter(), cell)?,
            as_shipped: of_arm(&Arm::as_shipped())?,
            recalibrated: of_arm(&variants.recalibrated),
            with_effect: variants.with_effect.as_ref().and_then(of_arm),
            cell: cell.clone(),
        })
    });
    rows.collect()
}

fn mean_of<'r>(runs: impl Iterator<Item = &'r Run>, cell: &Cell) -> Option<f64> {
    mean(runs.filter_map(|run| Some(run.readings.get(cell)?.value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_like_the_others_scores_the_floor_and_one_far_away_its_distance() {
        let score =
            |row: [f64; 2], made: &[Vec<f64>]| energy_score(&per_statistic(row.to_vec()), made);
        let made = [vec![0.0, 0.0], vec![2.0, 0.0]].map(per_statistic);
        let apart = 2.0 * least_energy_score(&made).unwrap();
        assert!((apart - libm::sqrt(2.0)).abs() < 1e-12);
        // From one of two equal distances half of each.
        assert!((score([0.0, 0.0], &made).unwrap()).abs() < 1e-12);
        let far = score([1001.0, 0.0], &made).unwrap();
        assert!((far - (1000.0 / libm::sqrt(2.0) - 0.5 * apart)).abs() < 1e-3);
        assert_eq!(least_energy_score(&made[..1]), None);
    }
}
