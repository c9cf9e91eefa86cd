//! How far the gap shrinks on held-out conditions once an effect is added.
//!
//! Replicates, shifted by what the other conditions predict, are held against every measured run
//! by the energy score (Gneiting and Raftery 2007, J. Am. Stat. Assoc. 102:359-378) of whitened
//! statistics, each over its deviation: what the replicates do not spread in counts by its resolution.

use super::emulator::Emulated;
use super::fit::{Fit, Problem};
use super::observation::Observed;
use crate::gap::{Closed, Scores, closed};
use crate::quantity::Seed;
use serde::Serialize;

/// Mean energy scores [spreads of replicates per statistic], and what is closed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Shrinkage {
    /// The effect or effects that are added: those of the likeliest explanation that has any.
    pub effects: Vec<String>,
    /// Of the scenario as it came.
    pub as_shipped: f64,
    /// With parameters recalibrated.
    pub recalibrated: f64,
    /// With the effect or effects too.
    pub with_effect: f64,
    /// What a perfect model reaches.
    pub floor: f64,
    /// Whether the floor is that of measured repeats, in every condition; else of replicates.
    pub floor_is_measured: bool,
    /// Share of the gap closed; none where recalibration leaves none.
    pub closed: Option<Closed>,
    /// The largest share that another effect closes, outside of the equivalence set.
    pub placebo: Option<f64>,
}

/// The gap by each arm; `wrong` are other effects.
pub(super) fn shrinkage(
    problem: Problem,
    recalibrated: &Fit,
    with_effect: &Fit,
    wrong: &[&Fit],
    seed: Seed,
) -> Shrinkage {
    let shipped = gaps(problem, None);
    let of_parameters = gaps(problem, Some(recalibrated));
    let of_effect = gaps(problem, Some(with_effect));
    let floors = floors(problem);
    let scores = |arm: &[Vec<f64>]| -> Vec<Scores> {
        let conditions = problem.conditions().enumerate();
        conditions
            .flat_map(|(number, (emulated, observed))| {
                let runs = observed.days.iter().enumerate();
                let floor = floors[number].0;
                let recalibrated = &of_parameters[number];
                runs.map(move |(run, day)| Scores {
                    condition: emulated.condition.clone(),
                    day: day.clone(),
                    recalibrated: recalibrated[run],
                    with_effect: arm[number][run],
                    floor,
                })
            })
            .collect()
    };
    let placebo = wrong.iter().filter_map(|fit| {
        let scores = scores(&gaps(problem, Some(fit)));
        let sum = |of: fn(&Scores) -> f64| scores.iter().map(of).sum::<f64>();
        let open = sum(|s| s.recalibrated - s.floor);
        (open > 0.0).then(|| sum(|s| s.recalibrated - s.with_effect) / open)
    });
    let floor = floors.iter().map(|(floor, _)| floor).sum::<f64>() / floors.len() as f64;
    let added = with_effect.hypothesis.effects().iter();
    Shrinkage {
        effects: added
            .map(|&effect| problem.emulator.candidates[effect].name.clone())
            .collect(),
        as_shipped: mean(&shipped),
        recalibrated: mean(&of_parameters),
        with_effect: mean(&of_effect),
        floor,
        floor_is_measured: floors.iter().all(|(_, measured)| *measured),
        closed: closed(&scores(&of_effect), seed),
        placebo: placebo.reduce(f64::max),
    }
}

fn mean(gaps: &[Vec<f64>]) -> f64 {
    let means = gaps
        .iter()
        .map(|runs| runs.iter().sum::<f64>() / runs.len() as f64);
    means.sum::<f64>() / gaps.len() as f64
}

/// Energy score of every measured run, condition by condition.
fn gaps(problem: Problem, fit: Option<&Fit>) -> Vec<Vec<f64>> {
    problem
        .conditions()
        .enumerate()
        .map(|(number, (emulated, observed))| {
            let among = 0.5 * emulated.among(&emulated.replicates);
            let shift = fit.map(|fit| &fit.held_out[number].shift);
            let off = |run: &Vec<f64>| {
                let run: Vec<f64> = match shift {
                    Some(shift) => run
                        .iter()
                        .zip(shift)
                        .map(|(run, shift)| run - shift)
                        .collect(),
                    None => run.clone(),
                };
                let sum: f64 = emulated
                    .replicates
                    .iter()
                    .map(|made| emulated.apart(&run, made))
                    .sum();
                sum / emulated.replicates.len() as f64 - among
            };
            observed.runs.iter().map(off).collect()
        })
        .collect()
}

fn floors(problem: Problem) -> Vec<(f64, bool)> {
    let conditions = problem.conditions();
    conditions
        .map(|(emulated, observed)| floor(emulated, observed))
        .collect()
}

/// What a perfect model reaches, and whether that is known from repeats.
pub(super) fn floor(emulated: &Emulated, observed: &Observed) -> (f64, bool) {
    let among = emulated.among(&emulated.replicates);
    let floor = reach(emulated, observed, &emulated.replicates) - 0.5 * among;
    (floor, observed.runs.len() > 1)
}

/// How far a measured run lies from runs `made` by a perfect model.
///
/// Replicates had a part in the whitening and lie closer together than runs that had none: with mean
/// squares `ρ` of those made and `β` of those measured about their middle, that is `√(ρ + β)`, while
/// those made lie `√2ρ` from each other. Where a run was made or measured once, its square is that of
/// replicates left out of the whitening.
pub(super) fn reach(emulated: &Emulated, observed: &Observed, made: &[Vec<f64>]) -> f64 {
    let square = |runs: &[Vec<f64>]| match runs.len() {
        1 => emulated.scatter.square(1),
        _ => {
            let among = emulated.among(runs);
            0.5 * among * among
        }
    };
    libm::sqrt(square(made) + square(&observed.runs))
}

impl Emulated {
    /// Mean distance of two of these.
    pub(super) fn among(&self, rows: &[Vec<f64>]) -> f64 {
        let pairs = rows.iter().enumerate();
        let sum: f64 = pairs
            .flat_map(|(i, a)| rows[..i].iter().map(move |b| self.apart(a, b)))
            .sum();
        sum / (0.5 * rows.len() as f64 * (rows.len() - 1) as f64).max(1.0)
    }

    /// Distance per root of a number, each over the deviation of a run that had no part in the
    /// whitening.
    pub(super) fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let numbers = a.iter().zip(b).zip(self.scatter.variance(1.0));
        let square: f64 = numbers
            .map(|((a, b), variance)| (a - b) * (a - b) / variance)
            .sum();
        libm::sqrt(square / (a.len() as f64).max(1.0))
    }
}
