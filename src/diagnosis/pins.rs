//! Points at which the emulator was set right by simulating them.
//!
//! An [`Emulator`](super::Emulator) adds the changes of each parameter and effect, so it errs where
//! several are off together: a rig whose soil differs by one standard deviation in moduli and
//! exponent sinks otherwise than the sum of both. Two ways out were weighed. Moving its middle to the
//! recalibrated parameters takes all slopes and replicates again, for every campaign. Simulating only
//! the points that fits end at takes a hundredth of that, serves every explanation by the same rule,
//! and comes true where it counts; so it is done, round by round, until the fits rest: first for
//! recalibration alone, which may have far to go, then for all that compete with it.
//!
//! What the emulator lacks at a point, its defect, holds around it: the defect is taken for a
//! Gaussian process of squared exponential correlation, nil at the scenario as shipped and known
//! where it was simulated (Sacks, Welch, Mitchell and Wynn 1989, Stat. Sci. 4:409-423). The share
//! of its variance that these leave multiplies what the emulator is held to err by.

use super::emulator::{Emulated, Emulator};
use super::fit::{Fit, Problem};
use super::hypothesis::Hypothesis;
use super::library::Beside;
use super::product::add;
use super::ranking::{fits, score};
use nalgebra::{DMatrix, DVector};

/// Distance [prior standard deviations, typical magnitudes] over which a defect changes.
const LENGTH: f64 = 2.0;
/// Recalibration rests on a pin where each parameter is within its own deviation of it, but no less
/// and no more than these distances [prior standard deviations]; fits with effects within the latter.
const NEAR: [f64; 2] = [0.02, 0.15];
/// Variance of a defect's error over its own: pins side by side share what they tell.
const OWN: f64 = 0.005;
/// Rounds at most in which recalibration alone is simulated and taken up where it ends, and with those
/// in which all fits are.
const RECALIBRATIONS: usize = 8;
pub(super) const ROUNDS: usize = 14;
/// Fits that are simulated beside recalibration in one round, how much better [log score] than it, and
/// a pair than each of its effects, they have to be, and how near to the best: what the priors of
/// effects are behind, or no probability turns on them.
const RIVALS: usize = 4;
const BETTER: f64 = 3.0;
const NEAR_BEST: f64 = 15.0;

/// Where parameters and effects are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    /// Parameters [prior standard deviations].
    pub offsets: Vec<f64>,
    /// Effects, by their place among the candidates, and their strengths.
    pub effects: Vec<(usize, f64)>,
}

/// What pins tell of another point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weights {
    /// Of each pin's defect.
    pub of_pins: Vec<f64>,
    /// Share [-] of the emulator's variance that is left.
    pub left: f64,
}

/// What the emulator lacks in one condition.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Defect {
    /// By number.
    pub change: Vec<f64>,
    /// Variance of that.
    pub error: Vec<f64>,
    /// Share [-] of the emulator's variance that is left beside it.
    pub left: f64,
}

impl Defect {
    /// Of an emulator without pins, or where they say nothing.
    pub fn none(numbers: usize) -> Self {
        Self {
            change: vec![0.0; numbers],
            error: vec![0.0; numbers],
            left: 1.0,
        }
    }
}

impl Emulator {
    /// What the pins tell of a point.
    pub(super) fn weights(&self, point: &Point) -> Weights {
        let shipped = Point {
            offsets: vec![0.0; self.parameters.len()],
            effects: Vec::new(),
        };
        let pins: Vec<&Point> = self.pins.iter().collect();
        let all: Vec<&Point> = [&shipped].into_iter().chain(&self.pins).collect();
        let (weights, _) = self.kriged(&all, point);
        // What the emulator is held to err by is nil at the scenario as shipped by itself.
        let (_, told) = self.kriged(&pins, point);
        Weights {
            of_pins: weights.iter().skip(1).copied().collect(),
            left: (1.0 - told).clamp(0.0, 1.0),
        }
    }

    /// Weights of known points, and the share of the variance that they tell.
    fn kriged(&self, known: &[&Point], point: &Point) -> (DVector<f64>, f64) {
        let alike = |a: &Point, b: &Point| {
            let apart = self.apart(a, b) / LENGTH;
            libm::exp(-0.5 * apart * apart)
        };
        let among = DMatrix::from_fn(known.len(), known.len(), |i, j| {
            let own = if i == j { OWN } else { 0.0 };
            alike(known[i], known[j]) + own
        });
        let to_point = DVector::from_iterator(known.len(), known.iter().map(|k| alike(k, point)));
        let weights = among.cholesky().map(|known| known.solve(&to_point));
        let weights = weights.unwrap_or_else(|| DVector::zeros(known.len()));
        let told = weights.dot(&to_point);
        (weights, told)
    }

    /// Distance of two points [prior standard deviations, typical magnitudes].
    fn apart(&self, a: &Point, b: &Point) -> f64 {
        let offsets = a.offsets.iter().zip(&b.offsets);
        let of_offsets: f64 = offsets.map(|(a, b)| (a - b) * (a - b)).sum();
        libm::hypot(libm::sqrt(of_offsets), self.apart_in_effects(a, b))
    }

    /// Distance of their effects alone [typical magnitudes].
    fn apart_in_effects(&self, a: &Point, b: &Point) -> f64 {
        let strength = |point: &Point, effect: usize| {
            let of = point.effects.iter().filter(|(own, _)| *own == effect);
            of.map(|(_, strength)| strength).sum::<f64>()
        };
        let candidates = self.candidates.iter().enumerate();
        let squares = candidates.map(|(effect, candidate)| {
            let typical = candidate.typical();
            let off = (strength(a, effect) - strength(b, effect)) / typical;
            off * off
        });
        libm::sqrt(squares.sum())
    }

    /// Whether a fit of parameters alone rests on a pin.
    fn rests(&self, fit: &Fit) -> bool {
        let [least, most] = NEAR;
        let near = |pin: &Point| {
            let mut offsets = fit.offsets.iter().zip(&pin.offsets);
            offsets.all(|([offset, deviation], pin)| {
                (offset - pin).abs() < deviation.clamp(least, most)
            })
        };
        let mut pins = self.pins.iter();
        pins.any(|pin| pin.effects.is_empty() && near(pin))
    }

    /// A point with the parameters of the nearest pin, where one is near: effects of sensors then see
    /// the motion that was simulated there, and chance is the same with them as without.
    pub(super) fn beside_pin(&self, point: &Point) -> Point {
        let apart = |pin: &Point| {
            let offsets = pin.offsets.iter().zip(&point.offsets);
            offsets.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let nearest = self
            .pins
            .iter()
            .min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let near = nearest.filter(|pin| apart(pin) < NEAR[1]);
        Point {
            offsets: near.unwrap_or(point).offsets.clone(),
            effects: point.effects.clone(),
        }
    }

    /// What is lacking at a point, condition by condition.
    pub(super) fn defects(&self, point: &Point) -> Vec<Defect> {
        let weights = self.weights(point);
        let defect = |emulated: &Emulated| {
            let mut defect = Defect::none(emulated.cells.len());
            defect.left = weights.left;
            for (pinned, weight) in emulated.pinned.iter().zip(&weights.of_pins) {
                add(&mut defect.change, *weight, &pinned.change);
                add(&mut defect.error, weight * weight, &pinned.error);
            }
            defect
        };
        self.conditions.iter().map(defect).collect()
    }

    /// Sets itself right at a point by what was simulated there: by condition, a pair of runs a
    /// stream.
    pub(super) fn pin(&mut self, point: Point, runs: &[Vec<Beside>]) {
        for (emulated, runs) in self.conditions.iter_mut().zip(runs) {
            let pinned = emulated.lacking(&point, runs);
            emulated.pinned.push(pinned);
        }
        self.pins.push(point);
    }
}

/// Where fits end.
#[derive(Debug)]
pub(super) struct Ends {
    /// The one that scores best.
    pub best: Option<Point>,
    /// Those that are to be simulated.
    pub unpinned: Vec<Point>,
}

/// What is to be simulated in a round: where recalibration alone ends, until it rests or has had its
/// rounds; then where all fits do.
pub(super) fn unpinned(problem: Problem, round: usize) -> Ends {
    let recalibrated = (round < RECALIBRATIONS).then(|| recalibrated_end(problem));
    recalibrated.flatten().unwrap_or_else(|| ends(problem))
}

/// Where recalibration alone ends; none where it rests on a pin or nothing can be recalibrated.
fn recalibrated_end(problem: Problem) -> Option<Ends> {
    let emulator = problem.emulator;
    if emulator.parameters.is_empty() {
        return None;
    }
    let fit = Fit::new(problem, Hypothesis::Parameter);
    (!emulator.rests(&fit)).then(|| Ends {
        best: Some(fit.best.clone()),
        unpinned: vec![fit.best],
    })
}

/// Where fits end that matter and rest on no pin: recalibration, and the best with effects where they
/// are better. Each fit is taken at its own word of how far the emulator errs: what may
/// turn out right is worth a look.
fn ends(problem: Problem) -> Ends {
    let mut fits = fits(problem, None);
    fits.sort_by(|a, b| score(b).total_cmp(&score(a)));
    let recalibrated = fits
        .iter()
        .find(|fit| fit.hypothesis == Hypothesis::Parameter);
    let rivals = fits.iter().filter(|fit| is_rival(fit, &fits)).take(RIVALS);
    let emulator = problem.emulator;
    let mut unpinned: Vec<Point> = Vec::new();
    for fit in recalibrated.into_iter().chain(rivals) {
        let end = emulator.beside_pin(&fit.best);
        let mut pins = emulator.pins.iter().chain(&unpinned);
        if pins.all(|pin| emulator.apart(pin, &end) >= NEAR[1]) {
            unpinned.push(end);
        }
    }
    Ends {
        best: fits.first().map(|fit| fit.best.clone()),
        unpinned,
    }
}

/// Whether a fit with effects, of these, best first, may come out likeliest.
fn is_rival(fit: &Fit, fits: &[Fit]) -> bool {
    let simpler = |other: &&Fit| {
        let within = |effect| fit.hypothesis.effects().contains(effect);
        other.hypothesis != fit.hypothesis && other.hypothesis.effects().iter().all(within)
    };
    let better = |other: &Fit| score(fit) > score(other) + BETTER;
    !fit.hypothesis.effects().is_empty()
        && score(fit) > score(&fits[0]) - NEAR_BEST
        && fits.iter().filter(simpler).all(better)
}
