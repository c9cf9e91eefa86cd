//! Which run would separate two effects.
//!
//! Each run that could be made is simulated with either effect, at the sizes and parameters that explain the measured runs.
//! Their mean statistics differ by
//!
//! ```text
//! d² = Σ ((z_a − z_b) / σ)² / N − 2 / n
//! ```
//!
//! scatters per statistic, over `N` statistics and `n` realisations a side, whose own scatter is taken off. The same number
//! of the runs at hand stands beside it.

use super::arm::Arm;
use super::bank::{Bank, BankError, Progress};
use super::condition::Case;
use super::further::further_runs;
use super::simulated_runs::SimulatedRuns;
use super::validation::Yardstick;
use crate::gap::Run;
use serde::Serialize;
use std::ops::ControlFlow;

/// Realisations of each side.
const REALISATIONS: u64 = 2;

/// A run to make.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextRun {
    /// What it is.
    pub run: String,
    /// What it separates.
    pub between: [String; 2],
    /// Difference of the two [scatters per statistic], in the best of the runs at hand and in it.
    pub separation: [f64; 2],
}

/// An effect that may be the cause, with the variant that has it.
#[derive(Debug, Clone)]
pub struct Rival {
    /// Its name.
    pub name: String,
    /// The scenario with it.
    pub arm: Arm,
}

/// Where the search takes place.
pub struct Search<'a> {
    /// What runs are judged by.
    pub yardstick: Yardstick<'a>,
    /// A cache of the conditions at hand, and one maker of caches of others.
    pub bank: &'a dyn Fn(Vec<Case>) -> Result<Bank, BankError>,
    /// Callback with the progress.
    pub progress: &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync),
}

impl Search<'_> {
    /// The run that separates two effects best; none where the rig can make no other that does so better than those at hand.
    ///
    /// # Errors
    /// Those of simulations that are stopped or cannot be kept.
    pub fn between(
        &self,
        rivals: [&Rival; 2],
        cases: &[Case],
    ) -> Result<Option<NextRun>, BankError> {
        let on_ground = cases.iter().position(|case| !case.is_lifted());
        let Some(base) = on_ground else {
            return Ok(None);
        };
        let runs = further_runs(&cases[base]);
        let names: Vec<String> = runs
            .iter()
            .map(|run| format!("{} ({})", run.name, run.case.condition))
            .collect();
        let further: Vec<Case> = runs.into_iter().map(|run| run.case).collect();
        let count = further.len();
        let at_hand = self.separations(rivals, cases.to_vec(), |condition| condition)?;
        // Statistics of a new condition are judged by the scatter in the one that it is derived from.
        let new = self.separations(rivals, further, |_| base)?;
        let best = (0..count).max_by(|a, b| new[*a].total_cmp(&new[*b]));
        let at_hand = at_hand.iter().copied().fold(0.0, f64::max);
        let better = best.filter(|best| new[*best] > at_hand);
        Ok(better.map(|best| NextRun {
            run: names[best].clone(),
            between: rivals.map(|rival| rival.name.clone()),
            separation: [at_hand, new[best]],
        }))
    }

    fn separations(
        &self,
        rivals: [&Rival; 2],
        cases: Vec<Case>,
        judged_as: impl Fn(usize) -> usize,
    ) -> Result<Vec<f64>, BankError> {
        let bank = (self.bank)(cases)?;
        let mut simulated = SimulatedRuns::default();
        let arms = rivals.map(|rival| &rival.arm);
        simulated.simulate(&bank, &arms, REALISATIONS, self.progress)?;
        let separation = |case: usize| {
            let condition = judged_as(case);
            let mean = |arm: &Arm| self.mean(condition, simulated.of(arm, case));
            let [a, b] = arms.map(mean);
            let squares = a?.into_iter().zip(b?).map(|(a, b)| (a - b) * (a - b));
            let squares: Vec<f64> = squares.collect();
            let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
            Some(libm::sqrt((mean - 2.0 / REALISATIONS as f64).max(0.0)))
        };
        let cases = 0..bank.cases().len();
        Ok(cases.map(|case| separation(case).unwrap_or(0.0)).collect())
    }

    fn mean<'r>(&self, condition: usize, runs: impl Iterator<Item = &'r Run>) -> Option<Vec<f64>> {
        let rows = runs.map(|run| self.yardstick.standardised(condition, run));
        let rows: Vec<Vec<f64>> = rows.collect();
        let first = rows.first()?;
        let mean =
            |place: usize| rows.iter().map(|row| row[place]).sum::<f64>() / rows.len() as f64;
        Some((0..first.len()).map(mean).collect())
    }
}
