//! Whether a fit is good enough: what it predicts of held-out conditions against what is there.

use super::fit::{Fit, Problem};
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::BTreeMap;

/// Score [-] beyond which a number counts no more in the mean square: one cell is no misfit.
const OUTLYING: f64 = 5.0;

/// How well a fit predicts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Check {
    /// p-value of its held-out departures.
    pub p: f64,
    /// Mean square of them beyond what spread explains [-].
    pub excess: f64,
}

impl Check {
    /// Two tests of held-out departures, the smaller p-value doubled: their mean square, against
    /// what replicates left out show; and the largest mean departure of a cell over conditions.
    pub fn of(problem: Problem, fit: &Fit) -> Self {
        let [mut sum, mut uncertain] = [0.0, 0.0];
        let mut cells = BTreeMap::<_, (f64, f64)>::new();
        for ((emulated, observed), held_out) in problem.conditions().zip(&fit.held_out) {
            let clipped = held_out.scores.iter().map(|z| z.clamp(-OUTLYING, OUTLYING));
            let square: f64 = clipped.clone().map(|z| z * z).sum();
            sum += square / held_out.freedom - 1.0;
            // The spread is known from as many replicates as were left out, and the run has its own.
            let known = 1.0 + 1.0 / emulated.replicates.len().min(12) as f64;
            let own = 2.0 / held_out.freedom;
            uncertain += known * (observed.uncertainty * observed.uncertainty).max(own);
            for (cell, z) in emulated.cells.iter().zip(clipped) {
                let (sum, count) = cells.entry(cell).or_default();
                *sum += z;
                *count += 1.0;
            }
        }
        let normal = Normal::standard();
        let overall = normal.sf(sum / libm::sqrt(uncertain));
        let largest = cells
            .values()
            .map(|(sum, count)| sum.abs() / libm::sqrt(*count));
        let largest = largest.fold(0.0, f64::max);
        // Heavier tails of real readings make the largest look larger than the normal has it.
        let scale = libm::sqrt(1.0 + (sum / fit.held_out.len() as f64).clamp(0.0, 0.2));
        let local = (2.0 * normal.sf(largest / scale) * cells.len() as f64).min(1.0);
        Self {
            p: (2.0 * overall.min(local)).min(1.0),
            excess: (sum / fit.held_out.len() as f64).max(0.0),
        }
    }
}
