//! Points at which the emulator was set right by simulating them.
//!
//! An [`Emulator`] adds the changes of each parameter and effect, so it errs where
//! several are off together: a rig whose soil differs by one standard deviation in moduli and
//! exponent sinks otherwise than the sum of both. Two ways out were weighed. Moving its middle to the
//! recalibrated parameters takes all slopes and replicates again, for every campaign. Simulating only
//! the points that fits end at takes a hundredth of that, serves every explanation by the same rule,
//! and comes true where it counts; so it is done, round by round, until the fits rest: first for
//! recalibration alone, which may have far to go, then for all that compete with it.
//!
//! What the emulator lacks at a point, its defect, holds around it ([`Kriging`]), nil at the scenario as
//! shipped and known where it was simulated. The share of its variance that these leave multiplies what
//! the emulator is held to err by.
//!
//! An effect of the sensors needs no new motion. Its changes are told anew at the parameters at which it is first
//! looked at, all its magnitudes at once: what is clipped of a pull depends on the friction by which the wheel pulls,
//! and a pin at a wrong magnitude does not say that a right one explains all.
//!
//! A fit may rest where it should not: on slate a contact three times as stiff has its resonance in
//! another band, and slopes taken at the scenario as shipped do not say which way to go. Where
//! recalibration comes to rest and does not explain all, each parameter is therefore moved once by itself,
//! which tells the slopes there, and it goes on. For the same reason, where a fit with effects ends beside parameters that
//! were simulated nowhere, they are also simulated without the effects: else an effect would be praised
//! for the place to which it led.

use super::check::Check;
use super::emulator::{Emulated, Emulator};
use super::fit::{Fit, Problem};
use super::hypothesis::Hypothesis;
use super::kriging::Kriging;
use super::library::Beside;
use super::product::add;
use super::ranking::{fits, score};
use super::shape::Shape;

/// Recalibration rests on a pin where each parameter is within its own deviation of it, but no less
/// and no more than these distances [prior standard deviations, typical magnitudes]; fits with effects
/// where each effect is, and parameters are within the latter.
const NEAR: [f64; 2] = [0.02, 0.15];
/// Step [prior standard deviations] that each parameter is moved by itself, away from its middle, where
/// recalibration rests, and the distance [likewise] beyond which that is done again.
const STEP: f64 = 0.5;
const ANEW: f64 = 1.0;
/// Streams of each simulation where fits end, the same in all: what their mean is off by chance is then
/// common to all explanations. Drawn anew for each, it parted two that were the same by tens of log
/// score. Around such an end they are fewer: slopes that these do not tell do not matter.
pub(super) const STREAMS: u64 = 4;
const STREAMS_AROUND: u64 = 2;
/// Deviations [-] of a defect's slope beyond which it is no chance of the few runs that tell it.
const BEYOND_CHANCE: f64 = 3.0;
/// Rounds at most in which recalibration alone is simulated and taken up where it ends, and with those
/// in which all fits are.
const RECALIBRATIONS: usize = 12;
pub(super) const ROUNDS: usize = 18;
/// Fits of each kind that are simulated beside recalibration in one round, how much better [log score] than it, and
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
    /// Of each pin's defect in the slope along each parameter.
    pub slopes: Vec<Vec<f64>>,
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
    /// Parameters [prior standard deviations] at which this is, and slopes by number along each.
    pub at: Vec<f64>,
    pub slopes: Vec<Vec<f64>>,
}

impl Defect {
    /// Of an emulator without pins, or where they say nothing.
    pub fn none(numbers: usize) -> Self {
        Self {
            change: vec![0.0; numbers],
            error: vec![0.0; numbers],
            left: 1.0,
            at: Vec::new(),
            slopes: Vec::new(),
        }
    }

    /// By number where parameters are these.
    pub fn change_at(&self, offsets: &[f64]) -> Vec<f64> {
        let mut change = self.change.clone();
        for ((slope, at), offset) in self.slopes.iter().zip(&self.at).zip(offsets) {
            add(&mut change, offset - at, slope);
        }
        change
    }
}

impl Emulator {
    /// What the pins tell of a point.
    pub(super) fn weights(&self, point: &Point) -> Weights {
        let shipped = Point {
            offsets: vec![0.0; self.parameters.len()],
            effects: Vec::new(),
        };
        let all = Kriging::new(self, [&shipped].into_iter().chain(&self.pins).collect());
        let of_pins = |weights: Vec<f64>| weights[1..].to_vec();
        // What the emulator is held to err by is nil at the scenario as shipped by itself.
        let (_, told) = Kriging::new(self, self.pins.iter().collect()).weights(point);
        let slopes = 0..point.offsets.len();
        Weights {
            of_pins: of_pins(all.weights(point).0),
            slopes: slopes
                .map(|parameter| of_pins(all.slope(point, parameter)))
                .collect(),
            left: (1.0 - told).clamp(0.0, 1.0),
        }
    }

    /// Distance of two points [prior standard deviations, typical magnitudes].
    pub(super) fn apart(&self, a: &Point, b: &Point) -> f64 {
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

    /// Whether a fit rests on a pin.
    fn rests(&self, fit: &Fit) -> bool {
        let [least, most] = NEAR;
        let alone = fit.best.effects.is_empty();
        let parameters = |pin: &Point| {
            let mut offsets = fit.offsets.iter().zip(&pin.offsets);
            offsets.all(|([offset, deviation], pin)| {
                let near = if alone {
                    deviation.clamp(least, most)
                } else {
                    most
                };
                (offset - pin).abs() < near
            })
        };
        let effects = |pin: &Point| {
            let all = fit.best.effects.iter().zip(&pin.effects);
            let mut all = all.zip(&fit.strengths);
            pin.effects.len() == fit.best.effects.len()
                && all.all(|((&(own, strength), &(effect, pinned)), estimate)| {
                    let typical = self.candidates[own].typical().abs();
                    let near = (estimate.deviation() / typical).clamp(least, most);
                    own == effect && (strength - pinned).abs() < near * typical
                })
        };
        let mut pins = self.pins.iter();
        pins.any(|pin| effects(pin) && parameters(pin))
    }

    /// Each parameter moved once by itself about a point; none where that was done near it.
    fn around(&self, point: &Point) -> Vec<Point> {
        let near = |pin: &&Point| {
            let mut offsets = pin.offsets.iter().zip(&point.offsets);
            pin.effects.is_empty() && offsets.all(|(pin, own)| (pin - own).abs() < ANEW)
        };
        // The point itself, and one a parameter.
        if self.pins.iter().filter(near).count() > self.parameters.len() {
            return Vec::new();
        }
        let middle = self.beside_pin(point);
        let moved = |(parameter, offset): (usize, &f64)| {
            let mut moved = middle.clone();
            moved.offsets[parameter] += STEP.copysign(*offset);
            moved
        };
        point.offsets.iter().enumerate().map(moved).collect()
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

    /// Effects of sensors at a point away from the scenario as shipped, whose changes are those there and were not
    /// looked at yet.
    fn stale(&self, point: &Point) -> Vec<usize> {
        let is_away = point.offsets.iter().any(|offset| offset.abs() > NEAR[1]);
        let effects = point.effects.iter().map(|(effect, _)| *effect);
        let is_stale = |effect: &usize| {
            let mut pinned = self.pins.iter().flat_map(|pin| &pin.effects);
            self.candidates[*effect].of_sensors
                && !self.told_anew.contains(effect)
                && !pinned.any(|(own, _)| own == effect)
        };
        effects
            .filter(|effect| is_away && is_stale(effect))
            .collect()
    }

    /// Takes an effect's changes at these strengths as they are in these runs: by strength and condition, a
    /// pair of runs a stream. Without runs they stay as they were.
    pub(super) fn tell_anew(&mut self, effect: usize, levels: &[(f64, Vec<Vec<Beside>>)]) {
        self.told_anew.push(effect);
        if levels.is_empty() {
            return;
        }
        for (place, emulated) in self.conditions.iter_mut().enumerate() {
            let knots = levels
                .iter()
                .map(|(at, runs)| emulated.knot(*at, &runs[place]));
            emulated.shapes[effect] = Shape::new(emulated.cells.len(), knots.collect());
        }
    }

    /// What is lacking at a point, condition by condition.
    pub(super) fn defects(&self, point: &Point) -> Vec<Defect> {
        let weights = self.weights(point);
        let defect = |emulated: &Emulated| {
            let mut defect = Defect::none(emulated.cells.len());
            defect.left = weights.left;
            (defect.change, defect.error) = weighted(emulated, &weights.of_pins);
            defect.at.clone_from(&point.offsets);
            let slopes = weights.slopes.iter().map(|weights| {
                let (mut slope, error) = weighted(emulated, weights);
                for (slope, error) in slope.iter_mut().zip(error) {
                    if slope.abs() < BEYOND_CHANCE * libm::sqrt(error) {
                        *slope = 0.0;
                    }
                }
                slope
            });
            defect.slopes = slopes.collect();
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

/// Defects of all pins by these weights, and the variance of that.
fn weighted(emulated: &Emulated, weights: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut change = vec![0.0; emulated.cells.len()];
    let mut error = change.clone();
    for (pinned, weight) in emulated.pinned.iter().zip(weights) {
        add(&mut change, *weight, &pinned.change);
        add(&mut error, weight * weight, &pinned.error);
    }
    (change, error)
}

/// Where fits end.
#[derive(Debug)]
pub(super) struct Ends {
    /// The one that scores best.
    pub best: Option<Point>,
    /// Those that are to be simulated.
    pub unpinned: Vec<Point>,
    /// Effects of sensors whose changes are to be told anew, at which parameters.
    pub stale: Vec<(usize, Vec<f64>)>,
    /// With so many streams each.
    pub streams: u64,
}

/// What is to be simulated in a round: where recalibration alone ends, until it rests or has had its
/// rounds; then where all fits do.
pub(super) fn unpinned(problem: Problem, round: usize) -> Ends {
    let recalibrated = (round < RECALIBRATIONS).then(|| recalibrated_end(problem));
    recalibrated.flatten().unwrap_or_else(|| ends(problem))
}

/// Where recalibration alone ends, or what is around it; none where that rests on a pin and explains all
/// or is known, or nothing can be recalibrated.
fn recalibrated_end(problem: Problem) -> Option<Ends> {
    let emulator = problem.emulator;
    if emulator.parameters.is_empty() {
        return None;
    }
    let fit = Fit::new(problem, Hypothesis::Parameter);
    let good = || Check::of(problem, &fit).p >= problem.calibration.failed;
    let (unpinned, streams) = match emulator.rests(&fit) {
        true if good() => return None,
        true => (emulator.around(&fit.best), STREAMS_AROUND),
        false => (vec![fit.best.clone()], STREAMS),
    };
    (!unpinned.is_empty()).then_some(Ends {
        best: Some(fit.best),
        unpinned,
        stale: Vec::new(),
        streams,
    })
}

/// Where fits end that matter and rest on no pin: recalibration, the best with effects where they are better, and
/// the single effect that fits best and was simulated nowhere. Each fit is taken at its own word of how far the
/// emulator errs, as what may turn out right is worth a look; and as all are ranked in the end, as no answer may rest
/// on what was not simulated.
fn ends(problem: Problem) -> Ends {
    let freest = Fit::new(problem, Hypothesis::freest(problem.emulator));
    let [own_word, ranked] = [None, Some(&freest)].map(|another| {
        let mut fits = fits(problem, another);
        fits.sort_by(|a, b| score(b).total_cmp(&score(a)));
        fits
    });
    let emulator = problem.emulator;
    let mut unpinned: Vec<Point> = Vec::new();
    let mut stale: Vec<(usize, Vec<f64>)> = Vec::new();
    let rivals = [&own_word, &ranked].map(|fits| rivals(emulator, fits));
    let competing = [&freest].into_iter().chain(rivals.into_iter().flatten());
    for fit in competing.chain(unseen(emulator, &own_word)) {
        if emulator.rests(fit) {
            continue;
        }
        let end = emulator.beside_pin(&fit.best);
        let old = emulator.stale(&end);
        if !old.is_empty() {
            stale.extend(old.into_iter().map(|effect| (effect, end.offsets.clone())));
            continue;
        }
        let alone = Point {
            effects: Vec::new(),
            ..end.clone()
        };
        let near = |pin: &Point| emulator.apart(pin, &alone) < NEAR[1];
        if !emulator.pins.iter().chain(&unpinned).any(near) {
            unpinned.push(alone);
        }
        if !unpinned.contains(&end) {
            unpinned.push(end);
        }
    }
    // Of several places the first, the likeliest's.
    stale.sort_by_key(|(effect, _)| *effect);
    stale.dedup_by_key(|(effect, _)| *effect);
    Ends {
        best: own_word.first().map(|fit| fit.best.clone()),
        unpinned,
        stale,
        streams: STREAMS,
    }
}

/// The single effect that adds most to the likelihood of all conditions, where no pin has it alone. It may foretell
/// held-out conditions worse than recalibration because the emulator errs about it: lugs worn by a third change where
/// each meets the slab, which no line between three magnitudes has.
pub(super) fn unseen<'f>(emulator: &Emulator, fits: &'f [Fit]) -> Option<&'f Fit> {
    let gain = |fit: &Fit| match fit.gains[..] {
        [gain] => gain,
        _ => f64::NEG_INFINITY,
    };
    let best = fits.iter().max_by(|a, b| gain(a).total_cmp(&gain(b)))?;
    let is_it = |pin: &Point| {
        let effects = pin.effects.iter().map(|(effect, _)| effect);
        effects.eq(best.hypothesis.effects())
    };
    let is_new = gain(best) > NEAR_BEST && !emulator.pins.iter().any(is_it);
    is_new.then_some(best)
}

/// Fits with effects, of these, best first, that may come out likeliest, or what is to be looked at
/// before them.
fn rivals<'f>(emulator: &'f Emulator, fits: &'f [Fit]) -> impl Iterator<Item = &'f Fit> {
    let rivals = fits.iter().filter(|fit| is_rival(fit, fits)).take(RIVALS);
    rivals.map(|fit| first(emulator, fit, fits))
}

/// What is looked at first of a fit: for a pair the better of its effects alone, of these fits, best
/// first, until that rests. Where the emulator errs about one strong effect, a second that is not
/// there takes up what it lacks.
fn first<'f>(emulator: &Emulator, fit: &'f Fit, fits: &'f [Fit]) -> &'f Fit {
    let within = |other: &&Fit| match other.hypothesis.effects() {
        [one] => fit.hypothesis.effects().contains(one),
        _ => false,
    };
    let alone = fits.iter().find(within);
    alone.filter(|alone| !emulator.rests(alone)).unwrap_or(fit)
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
