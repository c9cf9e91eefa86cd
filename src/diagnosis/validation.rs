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
//! `½ mean d(x_i, x_j)`. The best model that there can be still has the [discrepancy](super::discrepancy) `Δ` between every
//! simulator and every rig, which no effect closes: with effects that are the cause, measured runs are `x_j + Δ`, and what is
//! left is the mean of `G(x_j + Δ, x without x_j)` over draws of `Δ` (posterior predictive: Gelman, Meng and Stern 1996,
//! Stat. Sinica 6:733-807). Effects are judged by the share that they close of the gap above that floor.
//!
//! Parameters and sizes are fitted to all conditions: a handful of numbers to thousands of statistics. With steady means alone
//! they are not so few, and take a part of `Δ` that the floor still has in it: it is too high there, and few effects are refuted.

use super::arm::Arm;
use super::condition::Case;
use super::discrepancy::Discrepancy;
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
    /// What the likeliest effect or effects would leave as the cause, with the assumed discrepancy; none without one.
    #[serde(default)]
    pub floor_with_discrepancy: Option<f64>,
}

impl Gaps {
    /// Whether what is left is no more than the assumed discrepancy would leave.
    pub fn is_within_discrepancy(&self) -> bool {
        self.floor_with_discrepancy
            .is_some_and(|floor| self.with_effect <= floor)
    }
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
    /// The same of the gap above the floor with discrepancy; without a discrepancy the same.
    pub closed_above_discrepancy: Option<Closed>,
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
    /// What moves them from any simulator to any rig; none where that is not assumed.
    pub discrepancy: Option<&'a Discrepancy<'a>>,
}

/// Draws of the discrepancy.
const DRAWS: u64 = 100;

impl Yardstick<'_> {
    /// Statistics of a run of a condition in units of their scatter.
    pub fn standardised(&self, condition: usize, run: &Run) -> Vec<f64> {
        self.model
            .standardised(condition, &self.values(condition, run))
    }

    /// Statistics of a run of a condition in their units, by column; NaN where it lacks one, and in other conditions.
    fn values(&self, condition: usize, run: &Run) -> Vec<f64> {
        let value = |column: &Column| {
            let is_own = column.condition == condition;
            let reading = is_own.then(|| run.readings.get(&column.cell)).flatten();
            reading.map_or(f64::NAN, |reading| reading.value)
        };
        self.columns.iter().map(value).collect()
    }

    /// A row whose Euclidean distances are `d`, from values by column.
    fn row(&self, condition: usize, values: &[f64]) -> Vec<f64> {
        per_statistic(self.model.standardised(condition, values))
    }

    /// Draws of the discrepancy, by column; none where there is none.
    fn moves(&self, seed: Seed) -> Vec<Vec<f32>> {
        let draws = self.discrepancy.into_iter().flat_map(|discrepancy| {
            (0..DRAWS).map(move |draw| discrepancy.drawn(&mut seed.rng("diagnosis.floor", draw)))
        });
        draws.collect()
    }

    /// Rows of runs of a condition, taken in turn, each moved by a draw.
    fn moved<'r>(
        &'r self,
        condition: usize,
        runs: &'r [Vec<f64>],
        moves: &'r [Vec<f32>],
    ) -> impl Iterator<Item = Vec<f64>> + 'r {
        let moved = moves.iter().zip(runs.iter().cycle());
        moved.map(move |(by, run)| {
            let moved = run.iter().zip(by);
            let moved: Vec<f64> = moved.map(|(value, by)| value + f64::from(*by)).collect();
            self.row(condition, &moved)
        })
    }
}

/// What rows leave as models of one another: the mean energy score of rows that were moved, in turn, by all but the one that was
/// moved. None of fewer than three or where none was moved.
fn left(moved: impl Iterator<Item = Vec<f64>>, rows: &[Vec<f64>]) -> Option<f64> {
    let scores = moved.enumerate().map(|(draw, row)| {
        let mut others = rows.to_vec();
        others.remove(draw % rows.len());
        energy_score(&row, &others)
    });
    let scores: Vec<f64> = scores.collect::<Option<_>>()?;
    mean(scores)
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
    let best = variants.with_effect.as_ref().unwrap_or(recalibrated);
    let (mut scores, mut scores_above_discrepancy) = (Vec::new(), Vec::new());
    let mut of_shipped = Vec::new();
    let moves = yardstick.moves(seed);
    for (condition, case) in cases.iter().enumerate() {
        let values = |arm: &Arm| -> Vec<Vec<f64>> {
            let runs = simulated.of(arm, condition);
            runs.map(|run| yardstick.values(condition, run)).collect()
        };
        let row = |values: &Vec<f64>| yardstick.row(condition, values);
        let runs = [&shipped, recalibrated, best].map(values);
        let [shipped, recalibrated, with_effect] = runs
            .each_ref()
            .map(|runs| runs.iter().map(row).collect::<Vec<_>>());
        // The better model has the scatter of a perfect one.
        let floor = least_energy_score(&with_effect)?;
        let moved = yardstick.moved(condition, &runs[2], &moves);
        let of_discrepancy = left(moved, &with_effect);
        for run in &measured[condition] {
            let row = row(&yardstick.values(condition, run));
            of_shipped.push(energy_score(&row, &shipped)?);
            let score = Scores {
                condition: case.condition.clone(),
                day: run.attributes.day.clone(),
                recalibrated: energy_score(&row, &recalibrated)?,
                with_effect: energy_score(&row, &with_effect)?,
                floor,
            };
            scores_above_discrepancy.push(of_discrepancy.map(|above| Scores {
                floor: above.max(floor),
                ..score.clone()
            }));
            scores.push(score);
        }
    }
    let average = |of: &dyn Fn(&Scores) -> f64, scores: &[Scores]| {
        scores.iter().map(of).sum::<f64>() / scores.len() as f64
    };
    // A condition of two runs has no floor with discrepancy.
    let above: Option<Vec<Scores>> = scores_above_discrepancy.into_iter().collect();
    let has_effects = variants.with_effect.is_some();
    let closed = |scores: &[Scores]| has_effects.then(|| closed(scores, seed)).flatten();
    let of_gap = closed(&scores);
    let effects = variants.with_effect.iter().flat_map(|arm| arm.effects());
    Some(Validation {
        effects: effects.map(|effect| effect.name()).collect(),
        gaps: Gaps {
            as_shipped: of_shipped.iter().sum::<f64>() / of_shipped.len() as f64,
            recalibrated: average(&|it| it.recalibrated, &scores),
            with_effect: average(&|it| it.with_effect, &scores),
            floor: average(&|it| it.floor, &scores),
            floor_with_discrepancy: above.as_ref().map(|it| average(&|it| it.floor, it)),
        },
        closed: of_gap,
        closed_above_discrepancy: match yardstick.discrepancy {
            None => of_gap,
            Some(_) => above.as_deref().and_then(closed),
        },
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

    #[test]
    fn a_cause_leaves_the_floor_where_simulator_and_rig_agree_and_their_distance_where_they_do_not()
    {
        let runs: Vec<Vec<f64>> = (0..40)
            .map(|run| vec![libm::sin(f64::from(run)), libm::cos(1.7 * f64::from(run))])
            .collect();
        let moved = |by: f64| runs.iter().map(move |run| vec![run[0] + by, run[1]]);
        let floor = least_energy_score(&runs).unwrap();
        assert!((left(moved(0.0), &runs).unwrap() / floor - 1.0).abs() < 1.0e-9);
        // Far away the scatter adds little to the distance, and half of its mean is taken off.
        let far = left(moved(1000.0), &runs).unwrap();
        assert!((far - (1000.0 - floor)).abs() < 1.0e-2, "{far} {floor}");
        assert_eq!(left(moved(0.0).take(2), &runs[..2]), None);
    }
}
