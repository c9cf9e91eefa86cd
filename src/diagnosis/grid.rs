//! Strengths at which a fit is tried: coarse over the prior first, then where it holds.

use super::responses::Candidate;

/// First strengths, as shares of the high level.
const SHARES: [f64; 13] = [
    0.0, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.4, 2.0, 3.0, 5.0,
];
/// Strengths of a finer look, and of one at about the same place.
const NODES: usize = 16;
const WIDE: usize = 24;
/// Log weight [-] under the largest below which a strength counts no more: one in ten thousand.
const NEGLIGIBLE: f64 = -9.2;
/// Strengths that have to count for a posterior to be resolved.
const RESOLVED: usize = 6;

/// Strengths of one effect, ascending.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub strengths: Vec<f64>,
    /// Whether they are spread over where the posterior is.
    pub resolved: bool,
}

impl Axis {
    /// Over the prior of a candidate.
    pub fn over(candidate: &Candidate) -> Self {
        let reach = candidate.levels().map(f64::abs);
        let reach = reach.into_iter().fold(0.0, f64::max);
        let backward = SHARES.iter().rev().map(|share| -share);
        let mut strengths: Vec<f64> = backward
            .chain(SHARES.into_iter().skip(1))
            .map(|share| share * reach)
            .filter(|strength| candidate.density(*strength) > 0.0)
            .collect();
        strengths.dedup();
        Self {
            resolved: strengths.len() < 2,
            strengths,
        }
    }

    /// As far again to each side.
    pub fn widened(mut self) -> Self {
        let ([first, .., last], false) = (self.strengths.as_slice(), self.strengths.len() < 2)
        else {
            return self;
        };
        let (middle, reach) = (0.5 * (first + last), last - first);
        let step = 2.0 * reach / (WIDE - 1) as f64;
        self.strengths = (0..WIDE)
            .map(|i| middle - reach + step * i as f64)
            .collect();
        self.resolved = false;
        self
    }

    /// Log prior probability [-] of each strength's neighbourhood.
    pub fn log_prior(&self, candidate: &Candidate) -> Vec<f64> {
        let places = &self.strengths;
        let last = places.len() - 1;
        let widths = (0..=last).map(|i| 0.5 * (places[(i + 1).min(last)] - places[i.max(1) - 1]));
        let mass = |(width, place): (f64, &f64)| {
            let width = if last == 0 { 1.0 } else { width };
            libm::log(candidate.density(*place) * width)
        };
        widths.zip(places).map(mass).collect()
    }

    /// A finer look about the strengths that count, given the largest log weight of each under
    /// the best.
    pub fn refine(&mut self, log_weights: &[f64], first: bool) {
        let counts: Vec<usize> = (0..log_weights.len())
            .filter(|&i| log_weights[i] > NEGLIGIBLE)
            .collect();
        let (Some(&from), Some(&to)) = (counts.first(), counts.last()) else {
            self.resolved = true;
            return;
        };
        if self.resolved || (counts.len() >= RESOLVED && !first) {
            self.resolved = true;
            return;
        }
        let from = self.strengths[from.max(1) - 1];
        let to = self.strengths[(to + 1).min(self.strengths.len() - 1)];
        let step = (to - from) / (NODES - 1) as f64;
        self.strengths = (0..NODES).map(|i| from + step * i as f64).collect();
    }
}
