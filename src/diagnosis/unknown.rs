//! Differences of no known form: any number may be off, how many and how far is learned.
//!
//! To what no effect predicts each cell answers with probability `1 − π` as the spread has it, else
//! with a spread `τ` times larger. `π` and `τ` come from the other conditions. This competes with
//! the hypotheses on held-out conditions and is never named as a cause.

use super::fit::{Fit, HeldOut, Problem};
use super::product::log_sum;
use super::scatter::Scatter;

/// Shares of cells that are off, and how far [deviations].
const SHARES: [f64; 5] = [0.03, 0.1, 0.3, 0.6, 1.0];
const SIZES: [f64; 4] = [3.0, 8.0, 25.0, 80.0];

/// Log score [-] of the free differences, beside what a fit without effects leaves.
pub(super) fn score(problem: Problem, fit: &Fit) -> f64 {
    let choices: Vec<(f64, f64)> = SHARES
        .iter()
        .flat_map(|share| SIZES.map(|size| (*share, size)))
        .collect();
    let densities: Vec<Vec<f64>> = choices
        .iter()
        .map(|choice| {
            let held_out = problem.conditions().zip(&fit.held_out);
            held_out
                .map(|((emulated, _), held_out)| density(held_out, &emulated.scatter, *choice))
                .collect()
        })
        .collect();
    let sums: Vec<f64> = densities.iter().map(|of| of.iter().sum()).collect();
    let conditions = fit.held_out.len();
    // One condition cannot be told from none: all choices count alike.
    let alone = conditions == 1;
    let predicted = (0..conditions).map(|number| {
        let weights = densities.iter().zip(&sums).map(|(of, sum)| match alone {
            true => 0.0,
            false => sum - of[number],
        });
        let joint = weights
            .clone()
            .zip(&densities)
            .map(|(weight, of)| weight + of[number]);
        log_sum(joint) - log_sum(weights)
    });
    let held_out: f64 = predicted.sum();
    let largest = sums.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    let volume = log_sum(sums.iter().copied()) - largest - libm::log(choices.len() as f64);
    held_out + if alone { 0.0 } else { volume } + fit.occam + fit.determined
}

/// Log density of a condition where a share of its numbers is off by a size.
fn density(held_out: &HeldOut, scatter: &Scatter, (share, size): (f64, f64)) -> f64 {
    let wide = libm::sqrt(1.0 + size * size);
    let numbers = held_out.scores.iter().zip(&scatter.tails);
    let numbers = numbers.zip(&scatter.weights).map(|((z, tail), weight)| {
        let right = libm::log1p(-share) + tail.log_density(*z);
        let off = libm::log(share / wide) + tail.log_density(z / wide);
        let larger = right.max(off);
        weight * (larger + libm::log1p(libm::exp(right.min(off) - larger)))
    });
    numbers.sum::<f64>() - held_out.log_spread
}
