//! A hypothesis fitted to all conditions, and to all but each one of them.
//!
//! Numbers are whitened, so that with precisions `Λ` the log likelihood of parameters `θ` and
//! strengths `m` is `−½ (r − d(m) − J θ)ᵀ Λ (r − d(m) − J θ)`. It is exact in `θ` where the
//! change bends little, else taken about the best fit of the round before; its prior is normal of one
//! of a few spreads; strengths are tried on a grid that closes in on where the
//! posterior is. `Λ` holds the spread of measurements and replicates, the emulator's error at the
//! best fit, less where [pins](super::pins) set it right; is scaled by how loud the runs of a condition
//! were; and is less the farther a number lies from the fit (Student's t; Lange, Little and Taylor
//! 1989, J. Am. Stat. Assoc. 84:881-896), so that no cell decides alone. An effect also has an error of
//! [form](super::form). Few replicates whiten many statistics in part only, and what is left correlated
//! would be counted as often as it shows: each condition's log likelihood is weighed by the share of its
//! numbers that are independent, which replicates left out of the whitening tell
//! ([`Scatter`](super::scatter::Scatter)).
//!
//! All terms are sums over conditions: leaving one out is a subtraction. What the others say of it
//! is a predictive density, Laplace's approximation over the parameters.

mod fold;
mod held_out;
mod local;
mod model;
mod posterior;

pub(super) use held_out::HeldOut;

use super::calibration::Calibration;
use super::emulator::{Emulated, Emulator};
use super::form;
use super::hypothesis::Hypothesis;
use super::observation::{Observation, Observed};
use super::pins::{Defect, Point};
use super::product::{add, product, scaled};
use local::Local;
use model::{Model, Spread, sum};
use posterior::{Estimate, Posterior};

/// Rounds in which precisions settle.
const ROUNDS: usize = 3;
/// More of them at most, one a pin.
const PINNED: usize = 2;

/// What is to be explained, by what, with which constants.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    /// What the simulator says.
    pub emulator: &'a Emulator,
    /// What was measured.
    pub observation: &'a Observation,
    /// The constants.
    pub calibration: &'a Calibration,
}

impl<'a> Problem<'a> {
    /// Conditions, emulated and observed.
    pub(super) fn conditions(self) -> impl Iterator<Item = (&'a Emulated, &'a Observed)> {
        let observed = &self.observation.conditions;
        self.emulator.conditions.iter().zip(observed)
    }

    /// Departures, condition by condition, as they would be were all changes straight: less what is
    /// bent or lacking where the best explanation so far ends.
    pub(super) fn straightened(self) -> Vec<Vec<f64>> {
        let mut residuals: Vec<Vec<f64>> = self
            .conditions()
            .map(|(_, observed)| observed.residual.clone())
            .collect();
        let Some(middle) = &self.emulator.middle else {
            return residuals;
        };
        let defects = self.emulator.defects(middle);
        for ((residual, (emulated, _)), defect) in
            residuals.iter_mut().zip(self.conditions()).zip(defects)
        {
            let mut lacking = defect.change;
            emulated.add_bends(&middle.offsets, &mut lacking);
            add(residual, -1.0, &lacking);
        }
        residuals
    }
}

/// A hypothesis, fitted.
#[derive(Debug)]
pub(super) struct Fit {
    pub hypothesis: Hypothesis,
    /// Cosine [-] of the effects' laws in the catalogue and on the rig: of the [form](super::form) that says most.
    pub likeness: f64,
    /// What all forms together score above this one [-].
    pub forms: f64,
    /// Where it ends.
    pub best: Point,
    /// Of each effect.
    pub strengths: Vec<Estimate>,
    /// Of each parameter [prior standard deviations], with its deviation.
    pub offsets: Vec<[f64; 2]>,
    /// Log evidence less log likelihood at the best fit [-]: what the freedom of the fit costs.
    pub occam: f64,
    /// Parameters and strengths that the measurements determine [-].
    pub determined: f64,
    /// Log likelihood [-] that each effect adds to that without it.
    pub gains: Vec<f64>,
    /// What it can score at most [-].
    pub most: f64,
    /// Mean square [-] that it leaves of all conditions beyond what measurements and replicates spread.
    pub left: f64,
    /// What the other conditions say of each.
    pub held_out: Vec<HeldOut>,
    /// Of each condition's numbers.
    spreads: Vec<Spread>,
}

impl Fit {
    /// A fit whose predictions are held against its own variances, effects nearly of the catalogue's form.
    pub fn new(problem: Problem, hypothesis: Hypothesis) -> Self {
        Self::beside(problem, (hypothesis, form::NEAR), None)
    }

    /// A fit of effects as like the catalogue's, whose predictions are held against the variances of `another`:
    /// of two explanations the one that claims less error would win by that alone.
    pub fn beside(
        problem: Problem,
        (hypothesis, likeness): (Hypothesis, f64),
        another: Option<&Self>,
    ) -> Self {
        let mut spreads: Vec<Spread> = Vec::new();
        let mut precisions: Vec<Vec<f64>> = problem
            .conditions()
            .map(|(emulated, observed)| emulated.scatter.precision(&observed.variance))
            .collect();
        let nowhere = vec![0.0; problem.emulator.parameters.len()];
        let none = |(emulated, _): (&Emulated, &Observed)| Defect::none(emulated.cells.len());
        let mut defects: Vec<Defect> = problem.conditions().map(none).collect();
        let mut about = Local::all(problem, &nowhere, &defects);
        let mut posterior = Posterior::new(problem, &hypothesis, (&about, &precisions), None);
        // A pin draws the fit to it, and its defect changes a little on the way.
        let rounds = ROUNDS + problem.emulator.pins.len().min(PINNED);
        for _ in 1..rounds {
            let best = posterior.best();
            defects = problem.emulator.defects(&best);
            let conditions = problem.conditions().zip(&defects);
            (spreads, precisions) = conditions
                .map(|((emulated, observed), defect)| {
                    let model = Model::new(emulated, &best, defect);
                    let departure = model.departure(observed);
                    let form = (likeness, problem.calibration);
                    let spread = model.spread((emulated, observed), &departure, form);
                    let own = sum(&spread.own, &spread.form);
                    let precision = emulated.scatter.precision_at(&departure, &own);
                    (spread, precision)
                })
                .unzip();
            about = Local::all(problem, &best.offsets, &defects);
            let axes = Some(posterior.axes);
            posterior = Posterior::new(problem, &hypothesis, (&about, &precisions), axes);
        }
        let best = posterior.best();
        let held_out = problem.conditions().enumerate();
        let held_out = held_out
            .map(|(number, _)| {
                let against = another.map_or(&spreads, |another| &another.spreads);
                let variances = against[number].with_form(&spreads[number].form);
                posterior.predict(problem, number, (&variances, &defects[number]))
            })
            .collect();
        Self {
            strengths: posterior.estimates(),
            offsets: posterior.offsets(),
            occam: posterior.occam(),
            // What is not held out has not paid.
            determined: match posterior.holds_out(problem) {
                true => posterior.determined(),
                false => 0.0,
            },
            gains: Gains {
                problem,
                fitted: &posterior,
                best: &best,
                about: &about,
                precisions: &precisions,
                defects: &defects,
                spreads: &spreads,
                likeness,
            }
            .all(),
            likeness,
            forms: 0.0,
            most: f64::INFINITY,
            left: left(problem, &best),
            best,
            held_out,
            spreads,
            hypothesis,
        }
    }

    /// What the best fit leaves of the runs' means, condition by condition.
    pub fn departures(&self, problem: Problem) -> Vec<Vec<f64>> {
        departures(problem, &self.best)
    }

    /// Variances of that, but for what effects may be off in form.
    pub fn variances(&self) -> impl Iterator<Item = &[f64]> {
        self.spreads.iter().map(|spread| &*spread.own)
    }
}

/// Log likelihood [-] that each effect of a fit adds to that without it, the emulator as it is for both: what
/// pins are off by chance is in neither. Beside others it has to show where their error of form does not.
struct Gains<'a> {
    problem: Problem<'a>,
    fitted: &'a Posterior,
    best: &'a Point,
    about: &'a [Local],
    precisions: &'a [Vec<f64>],
    defects: &'a [Defect],
    spreads: &'a [Spread],
    likeness: f64,
}

impl Gains<'_> {
    fn all(&self) -> Vec<f64> {
        let gain = |effect: &usize| {
            let others = self.best.effects.iter().copied();
            let others: Vec<(usize, f64)> = others.filter(|(other, _)| other != effect).collect();
            let without: Vec<usize> = others.iter().map(|(other, _)| *other).collect();
            if others.is_empty() {
                let plain = self.posterior(&without, self.precisions);
                return self.fitted.likelihood() - plain.likelihood() + self.of_form(&plain.best());
            }
            let beside = self.beside(&others);
            let likelihood = |effects: &[usize]| self.posterior(effects, &beside).likelihood();
            likelihood(&self.fitted.effects) - likelihood(&without)
        };
        self.fitted.effects.iter().map(gain).collect()
    }

    fn posterior(&self, effects: &[usize], precisions: &[Vec<f64>]) -> Posterior {
        let hypothesis = Hypothesis::Effects(effects.to_vec());
        Posterior::new(self.problem, &hypothesis, (self.about, precisions), None)
    }

    /// Log likelihood [-] that the variance of the error of form adds to what is left without effects, all by
    /// itself: another law is told by where it changes numbers, not by how.
    fn of_form(&self, plain: &Point) -> f64 {
        let conditions = self.problem.conditions().zip(self.spreads);
        let density = |(((emulated, observed), spread), defect): (
            ((&Emulated, &Observed), &Spread),
            &Defect,
        )| {
            let departure = Model::new(emulated, plain, defect).departure(observed);
            let [_, wide] = spread.with_form(&spread.form);
            let of = |variance: &[f64]| emulated.scatter.log_density(&departure, variance);
            of(&wide) - of(&spread.own)
        };
        conditions.zip(self.defects).map(density).sum()
    }

    /// What the numbers tell beside the whole error of form of some of the effects.
    fn beside(&self, others: &[(usize, f64)]) -> Vec<Vec<f64>> {
        let departures = departures(self.problem, self.best);
        let conditions = self.problem.conditions().zip(self.spreads).zip(&departures);
        conditions
            .map(|(((emulated, _), spread), departure)| {
                let [_, mut variance] = spread.with_form(&spread.form);
                let aligned = form::aligned(emulated, others, self.likeness);
                add(&mut variance, 1.0, &aligned);
                emulated.scatter.precision_at(departure, &variance)
            })
            .collect()
    }
}

/// What a point leaves of the runs' means, condition by condition.
fn departures(problem: Problem, point: &Point) -> Vec<Vec<f64>> {
    let defects = problem.emulator.defects(point);
    let conditions = problem.conditions().zip(&defects);
    let departure = |((emulated, observed), defect): ((&Emulated, &Observed), &Defect)| {
        Model::new(emulated, point, defect).departure(observed)
    };
    conditions.map(departure).collect()
}

/// Mean square [-] that a fit which ends here leaves of all conditions beyond what measurements and replicates
/// spread, or beyond what repeats do where they scatter more: a lug that caught in a joint in one of two
/// runs is as far off under every explanation, and none could be seen to leave little.
fn left(problem: Problem, best: &Point) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for ((emulated, observed), departure) in problem.conditions().zip(departures(problem, best)) {
        let mut variance = observed.variance.clone();
        emulated.add_scatter(&best.effects, observed.runs.len(), &mut variance);
        let precision = emulated.scatter.precision(&variance);
        let numbers = emulated.scatter.independent();
        let square = product(&departure, &scaled(&departure, &precision));
        sum += square - observed.scattered.max(numbers);
        count += numbers;
    }
    (sum / count).max(0.0)
}
