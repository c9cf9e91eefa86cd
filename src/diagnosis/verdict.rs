//! The answer, and how sure it is.
//!
//! Effects that these runs cannot tell apart answer as a set. An explanation whose every refit
//! fails on held-out conditions gives its probability to the unknown, and what rests on too little
//! is undecided for the share that the table of constants says.

mod trust;
mod weighing;

use super::calibration::Calibration;
use super::fit::{Fit, Problem};
use super::hypothesis::{Hypothesis, NONE, PARAMETER, UNKNOWN};
use super::next_run::{FurtherRuns, NextRun};
use super::ranking::{Ranked, Ranking, score};
use super::screen::{Alarm, Projected, Screen, alarms};
use super::shrinkage::{Shrinkage, shrinkage};
use crate::gap::{Cell, Condition};
use crate::quantity::Seed;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use weighing::Weighing;

/// Cells that locate a remainder.
const LOCATED: usize = 10;
/// Score [-] from which on a cell of a remainder is worth a mention.
const STRONG: f64 = 4.0;
/// Name of the probability that no explanation has.
const UNDECIDED: &str = Answer::Undecided.name();
/// Names of what explains by nothing but the scenario.
const PLAIN: [&str; 2] = [NONE, PARAMETER];

/// What explains the measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// Nothing is wrong.
    None,
    /// Parameters are off.
    Parameter,
    /// An effect is missing, one of a set that cannot be told apart.
    Effect,
    /// Two effects are missing.
    Effects,
    /// Something that no effect makes.
    Unknown,
    /// The runs do not tell.
    Undecided,
}

impl Answer {
    /// Its name, also that of its probability; an effect's probability has the effect's own.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Parameter => "parameter",
            Self::Effect => "effect",
            Self::Effects => "effects",
            Self::Unknown => "unknown",
            Self::Undecided => "undecided",
        }
    }
}

/// An effect that may be the cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suspect {
    /// Name with the channel.
    pub name: String,
    /// Probability [-] that it is there, alone or with another.
    pub probability: f64,
    /// Magnitude where it is there, in `unit`.
    pub magnitude: f64,
    /// Unit of the magnitude.
    pub unit: &'static str,
    /// 95 % interval of the magnitude, in `unit`.
    pub ci95: [f64; 2],
    /// Effects that these runs cannot tell from it.
    pub equivalent_to: Vec<String>,
    /// Distance from the neutral magnitude that shows itself with three deviations, in `unit`, or
    /// the magnitude itself where the neutral one is infinite; none where none does.
    pub detectable: Option<f64>,
    /// Share [-] of its signature that parameters absorb.
    pub absorbed: f64,
}

/// One of the things that might be so, and what speaks for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// Its name, as among the probabilities.
    pub name: String,
    /// How well it foretells held-out conditions: log density less the cost of its freedom [-].
    pub log_score: f64,
    /// Probability [-] by refits alone.
    pub by_refit: f64,
    /// Probability [-] by the forest alone.
    pub by_forest: f64,
    /// p-value [-] of what it leaves on held-out conditions; none for the unknown.
    pub p: Option<f64>,
    /// Mean square [-] of that beyond what spread explains.
    pub excess: Option<f64>,
    /// Mean square [-] beyond spread that its fit to all conditions leaves, the loudest numbers whole;
    /// none for the unknown.
    pub left: Option<f64>,
}

/// A parameter as recalibrated under the best explanation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recalibrated {
    /// Its name.
    pub name: String,
    /// Distance from the prior's middle [prior standard deviations].
    pub offset: f64,
    /// Standard deviation of that.
    pub deviation: f64,
}

/// Where something is left that parameters do not explain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Located {
    /// In which condition.
    pub condition: Condition,
    /// In which cell.
    pub cell: Cell,
    /// Measured less predicted [deviations].
    pub deviations: f64,
}

/// The answer with its reasons.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// What explains the measurements.
    pub verdict: Answer,
    /// The effect or effects of the answer, each with what is equivalent to it.
    pub named: Vec<Vec<String>>,
    /// Probability [-] of `none`, `parameter`, `unknown`, `undecided`, each effect and each pair
    /// (`e+f`) tried; they sum to one.
    pub probabilities: BTreeMap<String, f64>,
    /// What was tried, likeliest first before all reservations.
    pub explanations: Vec<Explanation>,
    /// Likeliest first.
    pub effects: Vec<Suspect>,
    /// Parameters under the likeliest explanation.
    pub parameters: Vec<Recalibrated>,
    /// Parameters recalibrated without any effect.
    pub recalibration: Vec<Recalibrated>,
    /// Parameters that look like something else.
    pub alarms: Vec<Alarm>,
    /// Strongest cells of what recalibration leaves.
    pub located: Vec<Located>,
    /// How far the gap shrinks with the likeliest effect or effects; none without candidates.
    pub shrinkage: Option<Shrinkage>,
    /// The run that would tell the two likeliest effects apart, where the answer needs it.
    pub next_run: Option<NextRun>,
    /// Why the answer is less sure than it could be.
    pub reasons: Vec<String>,
}

impl Verdict {
    /// The verdict on measured runs; which run to make next it does not say yet.
    pub(super) fn of(problem: Problem, ranking: &Ranking, seed: Seed) -> Self {
        let screen = Screen::new(problem);
        let projected = screen.projected();
        let weighing = Weighing::of(problem, ranking, &projected);
        let (verdict, effects) = weighing.answer(problem, &projected);
        let sets = effects
            .iter()
            .map(|&effect| set(problem, &projected, effect));
        let named: Vec<Vec<usize>> = sets.collect();
        let suspects = weighing.suspects(problem, ranking, &projected);
        // What is named need not be what scores best.
        let answered = (!effects.is_empty()).then(|| Hypothesis::Effects(effects.clone()));
        let best = answered.as_ref().unwrap_or(&ranking.ranked[0].hypothesis);
        let name = |&number: &usize| problem.emulator.candidates[number].name.clone();
        Self {
            named: named
                .iter()
                .map(|set| set.iter().map(name).collect())
                .collect(),
            probabilities: weighing.told(problem),
            parameters: ranking
                .fit(best)
                .map_or_else(Vec::new, |fit| recalibrated(problem, fit)),
            recalibration: recalibrated(problem, healthy(ranking)),
            alarms: alarms(problem),
            located: located(problem, healthy(ranking)),
            shrinkage: shrunk(problem, ranking, (answered.as_ref(), &projected), seed),
            next_run: None,
            reasons: weighing.reasons,
            explanations: ranking
                .ranked
                .iter()
                .map(|it| told(problem, ranking, it))
                .collect(),
            effects: suspects,
            verdict,
        }
    }

    /// Probability [-] of an answer that names no effect; 0 where it has none.
    pub fn probability(&self, answer: Answer) -> f64 {
        let told = self.probabilities.get(answer.name());
        told.copied().unwrap_or_default()
    }

    /// The two likeliest effects, where the answer leaves open which it is.
    pub fn open_between(&self) -> Option<[&Suspect; 2]> {
        let is_open =
            self.verdict == Answer::Undecided || self.named.iter().any(|set| set.len() > 1);
        match &self.effects[..] {
            [first, second, ..] if is_open => Some([first, second]),
            _ => None,
        }
    }

    /// With the gap that recalibration leaves when it is simulated. Where that is the floor's, nothing is missing that
    /// could be seen in it, and what a cause adds to the score, also an unknown one, may be what the emulator errs by of
    /// parameters far from their middle: only where an effect foretells very much better does the answer stand.
    pub(super) fn recalibrated(mut self, gap: f64, calibration: &Calibration) -> Self {
        let floor = self.shrinkage.as_ref().map_or(0.0, |it| it.floor);
        let may_be_cause = !matches!(self.verdict, Answer::None | Answer::Parameter);
        let is_decided = self.probability(Answer::Undecided) <= 1.0 - calibration.confident;
        let leaves_nothing = gap <= (1.0 + calibration.at_floor) * floor;
        let stands_out = self.gain() > calibration.beyond_floor;
        if !(may_be_cause && is_decided && leaves_nothing) || stands_out {
            return self;
        }
        self.reasons.push(format!(
            "other causes foretell better, yet the recalibrated scenario, simulated, leaves {gap:.2} where {floor:.2} is the floor"
        ));
        let (answer, heir) = match self.recalibration.is_empty() {
            true => (Answer::None, NONE),
            false => (Answer::Parameter, PARAMETER),
        };
        self.refute(calibration.refuted, &[UNDECIDED], heir);
        self.verdict = answer;
        self
    }

    /// Log score [-] of the best explanation by effects over the best without.
    fn gain(&self) -> f64 {
        let best = |is_plain: bool| {
            let told = self.explanations.iter();
            let told =
                told.filter(|it| it.name != UNKNOWN && is_plain == PLAIN.contains(&&*it.name));
            told.fold(f64::NEG_INFINITY, |best, it| best.max(it.log_score))
        };
        best(false) - best(true)
    }

    /// With the gaps simulated without its effects and with them: effects that leave no narrower one
    /// are not named, and only this share stays decided.
    pub(super) fn tried(mut self, [recalibrated, with_effects]: [f64; 2], refuted: f64) -> Self {
        if self.named.is_empty() || with_effects < recalibrated {
            return self;
        }
        self.reasons.push(format!(
            "simulated with {} the gap is {with_effects:.2}, without it {recalibrated:.2}",
            self.named[0][0]
        ));
        self.refute(refuted, &[UNKNOWN, UNDECIDED], UNDECIDED);
        self.verdict = Answer::Undecided;
        self
    }

    /// Names no effect: all causes but the spared keep this share of their probability, the rest is another's.
    fn refute(&mut self, kept: f64, spared: &[&str], heir: &str) {
        let mut lost = 0.0;
        for (name, probability) in &mut self.probabilities {
            if !spared.contains(&&**name) && !PLAIN.contains(&&**name) {
                lost += (1.0 - kept) * *probability;
                *probability *= kept;
            }
        }
        *self.probabilities.entry(heir.to_owned()).or_default() += lost;
        for suspect in &mut self.effects {
            suspect.probability *= kept;
        }
        self.named.clear();
    }

    /// With the one of further runs that would tell them apart.
    pub fn with_next_run(mut self, problem: Problem, further: &FurtherRuns) -> Self {
        self.next_run = self
            .open_between()
            .and_then(|pair| next_run(problem, further, pair));
        self
    }
}

fn told(problem: Problem, ranking: &Ranking, ranked: &Ranked) -> Explanation {
    let [by_refit, by_forest] = ranked.engines;
    Explanation {
        name: ranked.hypothesis.name(problem.emulator),
        log_score: ranked.log_score,
        by_refit,
        by_forest,
        p: ranked.check.map(|check| check.p),
        excess: ranked.check.map(|check| check.excess),
        left: ranking.fit(&ranked.hypothesis).map(|fit| fit.left),
    }
}

fn equivalent(problem: Problem, projected: &Projected, a: usize, b: usize) -> bool {
    projected.equivalent(problem.emulator, a, b, problem.calibration.equivalent)
}

/// An effect and all that cannot be told from it.
fn set(problem: Problem, projected: &Projected, effect: usize) -> Vec<usize> {
    let all = 0..problem.emulator.candidates.len();
    let others =
        all.filter(|&other| other != effect && equivalent(problem, projected, effect, other));
    [effect].into_iter().chain(others).collect()
}

/// The fit without effects that says held-out conditions better: a recalibration that carries over to
/// none of them is not made.
fn healthy(ranking: &Ranking) -> &Fit {
    let shipped = &ranking.fits[0];
    let recalibrated = ranking.fit(&Hypothesis::Parameter);
    let better = recalibrated.filter(|fit| score(fit) > score(shipped));
    better.unwrap_or(shipped)
}

fn recalibrated(problem: Problem, fit: &Fit) -> Vec<Recalibrated> {
    let named = problem.emulator.parameters.iter().zip(&fit.offsets);
    named
        .map(|(name, [offset, deviation])| Recalibrated {
            name: name.clone(),
            offset: *offset,
            deviation: *deviation,
        })
        .collect()
}

fn located(problem: Problem, fit: &Fit) -> Vec<Located> {
    let mut located: Vec<Located> = problem
        .conditions()
        .zip(&fit.held_out)
        .flat_map(|((emulated, _), held_out)| {
            let cells = emulated.cells.iter().zip(&held_out.scores);
            cells
                .filter(|(_, z)| z.abs() > STRONG)
                .map(|(cell, z)| Located {
                    condition: emulated.condition.clone(),
                    cell: cell.clone(),
                    deviations: *z,
                })
        })
        .collect();
    located.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    located.truncate(LOCATED);
    located
}

/// With the effects answered, else the likeliest; the placebo is every other single effect.
fn shrunk(
    problem: Problem,
    ranking: &Ranking,
    (answered, projected): (Option<&Hypothesis>, &Projected),
    seed: Seed,
) -> Option<Shrinkage> {
    let mut ranked = ranking.ranked.iter().map(|ranked| &ranked.hypothesis);
    let best = answered.or_else(|| ranked.find(|h| !h.effects().is_empty()))?;
    let effects = best.effects();
    let wrong: Vec<&Fit> = ranking
        .fits
        .iter()
        .filter(|fit| match fit.hypothesis.effects() {
            [other] => effects
                .iter()
                .all(|e| e != other && !equivalent(problem, projected, *e, *other)),
            _ => false,
        })
        .collect();
    let with_effect = ranking.fit(best)?;
    Some(shrinkage(
        problem,
        healthy(ranking),
        with_effect,
        &wrong,
        seed,
    ))
}

fn next_run(
    problem: Problem,
    further: &FurtherRuns,
    [first, second]: [&Suspect; 2],
) -> Option<NextRun> {
    let emulator = problem.emulator;
    let place = |suspect: &Suspect| emulator.candidates().position(|name| name == suspect.name);
    let (a, b) = (place(first)?, place(second)?);
    let candidate = &emulator.candidates[a];
    let typical = candidate.typical();
    let strength = candidate.strength(first.magnitude) / typical;
    further.between(emulator, &Screen::new(problem), [a, b], strength.abs())
}
