//! Whether a fit is good enough: what it predicts of held-out conditions against what is there.

use super::fit::{Fit, Problem};
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::BTreeMap;

/// How well a fit predicts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Check {
    /// p-value of its held-out departures.
    pub p: f64,
    /// Mean square of them beyond what spread explains [-].
    pub excess: f64,
}

impl Check {
    /// Two tests of held-out departures, the smaller p-value doubled: their loudness, against that of
    /// replicates left out; and the largest mean departure of a cell over conditions, that loudness
    /// taken out, each of Student's t as the fit has it.
    pub fn of(problem: Problem, fit: &Fit) -> Self {
        let [mut sum, mut uncertain, mut excess] = [0.0, 0.0, 0.0];
        let mut cells = BTreeMap::<_, (f64, f64)>::new();
        let normal = Normal::standard();
        for ((emulated, observed), held_out) in problem.conditions().zip(&fit.held_out) {
            let adapted = held_out.scores.len() as f64 / held_out.freedom;
            excess += adapted * held_out.square / observed.square - 1.0;
            let [mean, deviation] = observed.loudness.log;
            sum += libm::log(adapted * held_out.loudness) - mean;
            // The mean is known from as many replicates, and the run has its own.
            let known = 1.0 + 1.0 / emulated.replicates.len() as f64;
            let own = 2.0 / held_out.freedom;
            uncertain += known * (deviation * deviation).max(own);
            let numbers = emulated.cells.iter().zip(&held_out.scores);
            for ((cell, z), tail) in numbers.zip(&emulated.scatter.tails) {
                let (sum, count) = cells.entry(cell).or_default();
                *sum += tail.normal_score(*z);
                *count += 1.0;
            }
        }
        let overall = normal.sf(sum / libm::sqrt(uncertain));
        let largest = cells
            .values()
            .map(|(sum, count)| sum.abs() / libm::sqrt(*count));
        let largest = largest.fold(0.0, f64::max);
        let local = (2.0 * normal.sf(largest) * cells.len() as f64).min(1.0);
        Self {
            p: (2.0 * overall.min(local)).min(1.0),
            excess: (excess / fit.held_out.len() as f64).max(0.0),
        }
    }
}
