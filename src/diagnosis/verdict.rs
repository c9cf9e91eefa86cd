//! The answer, and how sure it is.
//!
//! Effects that these runs cannot tell apart answer as a set. An explanation whose every refit
//! fails on held-out conditions gives its probability to the unknown, and what rests on too little
//! is undecided for the share that the table of constants says.

use super::calibration::Calibration;
use super::check::Check;
use super::fit::{Fit, Problem};
use super::hypothesis::Hypothesis;
use super::next_run::{FurtherRuns, NextRun};
use super::product::log_sum;
use super::ranking::{Ranked, Ranking, score};
use super::screen::{Alarm, END, Projected, Screen, Screened, alarms};
use super::shrinkage::{Shrinkage, shrinkage};
use crate::gap::{Cell, Condition};
use crate::quantity::Seed;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Cells that locate a remainder.
const LOCATED: usize = 10;
/// Score [-] from which on a cell of a remainder is worth a mention.
const STRONG: f64 = 4.0;

/// Mean square [-] beyond what spread explains from which on there is a gap to explain.
const NOTICEABLE: f64 = 0.2;
/// Share [-] that the unknown keeps where the best refit passes its check or explains the gap.
const DOUBT: f64 = 0.1;
/// Share [-] that stays decided where the simulator refutes the answer.
const REFUTED: f64 = 0.4;

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
        let best = &ranking.ranked[0].hypothesis;
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
            shrinkage: shrunk(problem, ranking, &projected, seed),
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

    /// The two likeliest effects, where the answer leaves open which it is.
    pub fn open_between(&self) -> Option<[&Suspect; 2]> {
        let is_open =
            self.verdict == Answer::Undecided || self.named.iter().any(|set| set.len() > 1);
        match &self.effects[..] {
            [first, second, ..] if is_open => Some([first, second]),
            _ => None,
        }
    }

    /// With the gaps simulated without its effects and with them: effects that leave no narrower one
    /// are not named, and little is decided.
    pub(super) fn tried(mut self, [recalibrated, with_effects]: [f64; 2]) -> Self {
        if self.named.is_empty() || with_effects < recalibrated {
            return self;
        }
        self.reasons.push(format!(
            "simulated with {} the gap is {with_effects:.2}, without it {recalibrated:.2}",
            self.named[0][0]
        ));
        let mut undecided = 0.0;
        for (name, probability) in &mut self.probabilities {
            if name != "unknown" && name != "undecided" {
                undecided += (1.0 - REFUTED) * *probability;
                *probability *= REFUTED;
            }
        }
        let known = self.probabilities.entry("undecided".to_owned());
        *known.or_default() += undecided;
        for suspect in &mut self.effects {
            suspect.probability *= REFUTED;
        }
        self.named.clear();
        self.verdict = Answer::Undecided;
        self
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

/// Probabilities after all reservations.
struct Weighing {
    masses: Vec<(Hypothesis, f64)>,
    undecided: f64,
    /// Effects for which parameters within their priors may stand.
    absorbed: Vec<usize>,
    /// Whether what is left without any effect may be chance, or is little of the gap.
    cleared: bool,
    reasons: Vec<String>,
}

impl Weighing {
    fn of(problem: Problem, ranking: &Ranking, projected: &Projected) -> Self {
        let ranked = ranking.ranked.iter();
        let mut weighing = Self {
            masses: ranked
                .map(|r| (r.hypothesis.clone(), libm::exp(r.log_probability)))
                .collect(),
            undecided: 0.0,
            absorbed: absorbed(problem, healthy(ranking), projected),
            cleared: true,
            reasons: Vec::new(),
        };
        weighing.check(problem, ranking);
        weighing.disagreement(ranking);
        weighing.stand_in(problem);
        for (most, why) in &problem.observation.scarce {
            weighing.keep(*most);
            weighing.reasons.push((*why).to_owned());
        }
        if !weighing.cleared {
            let why = "recalibration alone leaves more than chance would on held-out conditions";
            weighing.reasons.push(why.to_owned());
        }
        weighing
    }

    /// What neither passes its check nor explains the gap gives its share to the unknown; where the best does
    /// either, the unknown has a small share of what it had. That the unknown itself foretells
    /// better than all of them is not asked for: it did not, and a wrong pair was named, where a world
    /// lacked an effect.
    fn check(&mut self, problem: Problem, ranking: &Ranking) {
        let trust = Trust::of(problem, ranking);
        let others = ranking.ranked.iter();
        let mut others = others.filter(|ranked| ranked.hypothesis != Hypothesis::Unknown);
        let all = log_sum(others.clone().map(|ranked| ranked.log_probability));
        let best = others.next().map(|ranked| &ranked.hypothesis);
        let unknown = self.mass(|h| *h == Hypothesis::Unknown);
        let is_good = trust.is_gap() && best.is_some_and(|best| trust.kept(best) == 1.0);
        let of_unknown = if is_good { DOUBT * unknown } else { unknown };
        for ((hypothesis, mass), ranked) in self.masses.iter_mut().zip(&ranking.ranked) {
            *mass = match hypothesis {
                Hypothesis::Unknown => of_unknown,
                _ => (1.0 - of_unknown) * libm::exp(ranked.log_probability - all),
            };
        }
        self.without_seconds(&trust);
        let mut lost = 0.0;
        for (hypothesis, mass) in &mut self.masses {
            let kept = trust.kept(hypothesis);
            lost += (1.0 - kept) * *mass;
            *mass *= kept;
        }
        let mut masses = self.masses.iter_mut();
        if let Some((_, mass)) = masses.find(|(h, _)| *h == Hypothesis::Unknown) {
            *mass += lost;
        }
        if lost >= problem.calibration.presumed {
            let why = "what foretells best fails its check on held-out conditions and leaves much of the gap";
            self.reasons.push(why.to_owned());
        }
        let unknown = self.mass(|h| *h == Hypothesis::Unknown);
        let nearest = best.filter(|best| !best.effects().is_empty());
        if let (Some(nearest), true) = (nearest, unknown >= problem.calibration.confident) {
            self.reasons.push(format!(
                "of what the library has, {} foretells best: it in another form, or what is like it",
                nearest.name(problem.emulator).replace('+', " with ")
            ));
        }
        self.cleared = trust.kept(&healthy(ranking).hypothesis) == 1.0;
    }

    /// Of a pair that fails its check, leaves the effect that explains the gap alone, the better of these,
    /// best first: where the form of the first is off, a second that is not there always helps.
    fn without_seconds(&mut self, trust: &Trust) {
        for place in 0..self.masses.len() {
            let (pair, mass) = self.masses[place].clone();
            if pair.effects().len() < 2 || trust.passes(&pair) {
                continue;
            }
            let alone = |(other, _): &(Hypothesis, f64)| match other.effects() {
                [one] => pair.effects().contains(one) && trust.explains(other),
                _ => false,
            };
            if let Some(single) = self.masses.iter().position(alone) {
                self.masses[single].1 += mass;
                self.masses[place].1 = 0.0;
            }
        }
    }

    /// Says which effects are not named because parameters may stand for them.
    fn stand_in(&mut self, problem: Problem) {
        for &effect in &self.absorbed {
            let probability = self.mass(|h| h.effects().contains(&effect));
            if probability >= problem.calibration.presumed {
                let name = &problem.emulator.candidates[effect].name;
                self.reasons
                    .push(format!("{name} cannot be told from parameters"));
            }
        }
    }

    fn disagreement(&mut self, ranking: &Ranking) {
        let first = |engine: usize| {
            let ranked = ranking.ranked.iter();
            ranked.max_by(|a, b| a.engines[engine].total_cmp(&b.engines[engine]))
        };
        let [refit, forest] = [first(0), first(1)].map(|r| r.map(|r| &r.hypothesis));
        if refit != forest {
            self.reasons
                .push("refit and forest disagree on what is likeliest".to_owned());
        }
    }

    /// Leaves at most this probability decided; the unknown keeps its own.
    fn keep(&mut self, most: f64) {
        for (hypothesis, mass) in &mut self.masses {
            if *hypothesis != Hypothesis::Unknown {
                self.undecided += (1.0 - most) * *mass;
                *mass *= most;
            }
        }
    }

    fn mass(&self, counts: impl Fn(&Hypothesis) -> bool) -> f64 {
        let masses = self
            .masses
            .iter()
            .filter(|(hypothesis, _)| counts(hypothesis));
        masses.map(|(_, mass)| mass).sum()
    }

    /// The answer and the effects it names.
    fn answer(&self, problem: Problem, projected: &Projected) -> (Answer, Vec<usize>) {
        let confident = problem.calibration.confident;
        let [none, parameter, unknown] =
            [Hypothesis::None, Hypothesis::Parameter, Hypothesis::Unknown]
                .map(|known| self.mass(|h| *h == known));
        if self.undecided > 1.0 - confident {
            return (Answer::Undecided, Vec::new());
        }
        let absorbed = self.mass(|h| h.effects().iter().any(|e| self.absorbed.contains(e)));
        if self.cleared && none + parameter + absorbed >= problem.calibration.presumed {
            let answer = match none >= parameter + absorbed {
                true => Answer::None,
                false => Answer::Parameter,
            };
            return (answer, Vec::new());
        }
        if unknown >= confident {
            return (Answer::Unknown, Vec::new());
        }
        let alike = |a: usize, b: usize| a == b || equivalent(problem, projected, a, b);
        let same = |a: &[usize], b: &[usize]| match (a, b) {
            (&[a], &[b]) => alike(a, b),
            (&[a, b], &[c, d]) => (alike(a, c) && alike(b, d)) || (alike(a, d) && alike(b, c)),
            _ => false,
        };
        let likeliest = |of: &dyn Fn(&Hypothesis) -> bool, mass: &dyn Fn(&[usize]) -> f64| {
            let masses = self.masses.iter().filter(|(hypothesis, _)| of(hypothesis));
            masses
                .map(|(hypothesis, own)| {
                    (
                        hypothesis.effects().to_vec(),
                        mass(hypothesis.effects()),
                        *own,
                    )
                })
                .max_by(|a, b| (a.1, a.2).partial_cmp(&(b.1, b.2)).expect("numbers"))
        };
        let pairs = |h: &Hypothesis| h.effects().len() == 2;
        let of_pair = |pair: &[usize]| self.mass(|h| same(h.effects(), pair));
        if let Some((pair, mass, _)) = likeliest(&pairs, &of_pair)
            && mass >= confident
        {
            return (Answer::Effects, pair);
        }
        let singles = |h: &Hypothesis| h.effects().len() == 1;
        let of_single =
            |one: &[usize]| self.mass(|h| h.effects().iter().any(|&e| alike(e, one[0])));
        if let Some((one, mass, _)) = likeliest(&singles, &of_single)
            && mass >= confident
        {
            return (Answer::Effect, one);
        }
        (Answer::Undecided, Vec::new())
    }

    fn told(&self, problem: Problem) -> BTreeMap<String, f64> {
        let named = self
            .masses
            .iter()
            .map(|(hypothesis, mass)| (hypothesis.name(problem.emulator), *mass));
        named
            .chain([("undecided".to_owned(), self.undecided)])
            .collect()
    }

    fn suspects(&self, problem: Problem, ranking: &Ranking, projected: &Projected) -> Vec<Suspect> {
        let table = projected.table(problem.emulator, problem.calibration.equivalent);
        let mut suspects: Vec<Suspect> = table
            .into_iter()
            .enumerate()
            .filter_map(|(number, screened)| {
                let probability = self.mass(|h| h.effects().contains(&number));
                self.suspect(problem, ranking, (number, screened), probability)
            })
            .collect();
        suspects.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        suspects
    }

    /// With the magnitude of the likeliest explanation that has it.
    fn suspect(
        &self,
        problem: Problem,
        ranking: &Ranking,
        (number, screened): (usize, Screened),
        probability: f64,
    ) -> Option<Suspect> {
        let explains = self
            .masses
            .iter()
            .filter(|(h, _)| h.effects().contains(&number));
        let (hypothesis, _) = explains.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let place = hypothesis
            .effects()
            .iter()
            .position(|&effect| effect == number)?;
        let estimate = ranking.fit(hypothesis)?.strengths[place];
        let candidate = &problem.emulator.candidates[number];
        let mut ci95 = estimate.ci95.map(|end| candidate.magnitude(end));
        ci95.sort_by(f64::total_cmp);
        Some(Suspect {
            name: screened.name,
            probability,
            magnitude: candidate.magnitude(estimate.value),
            unit: candidate.seat.unit,
            ci95,
            equivalent_to: screened
                .equivalent
                .into_iter()
                .map(|(name, _)| name)
                .collect(),
            detectable: screened.detectable,
            absorbed: screened.absorbed,
        })
    }
}

/// Which explanations are good enough to be named.
struct Trust<'a> {
    ranking: &'a Ranking,
    calibration: &'a Calibration,
    /// Mean square [-] beyond what spread explains that the scenario as shipped leaves, outlying numbers cut, and that
    /// recalibration does, all numbers whole.
    shipped: f64,
    recalibrated: f64,
}

impl<'a> Trust<'a> {
    fn of(problem: Problem<'a>, ranking: &'a Ranking) -> Self {
        Self {
            ranking,
            calibration: problem.calibration,
            shipped: Check::of(problem, &ranking.fits[0]).excess,
            recalibrated: healthy(ranking).left,
        }
    }

    /// Whether there is a gap to explain.
    fn is_gap(&self) -> bool {
        self.shipped > NOTICEABLE
    }

    fn checked(&self, hypothesis: &Hypothesis) -> Option<Check> {
        let mut ranked = self.ranking.ranked.iter();
        ranked
            .find(|ranked| ranked.hypothesis == *hypothesis)?
            .check
    }

    fn passes(&self, hypothesis: &Hypothesis) -> bool {
        let check = self.checked(hypothesis);
        check.is_none_or(|check| check.p >= self.calibration.failed)
    }

    /// Whether an explanation leaves little of the gap: recalibration of that as shipped, effects of what
    /// recalibration leaves. An effect's loudest numbers count whole: it is there that one of another form is
    /// told from a wrong one.
    fn explains(&self, hypothesis: &Hypothesis) -> bool {
        let left_over = self.calibration.left_over;
        match hypothesis.effects() {
            [] => {
                let check = self.checked(hypothesis);
                check.is_some_and(|check| check.excess < left_over * self.shipped)
            }
            _ => {
                let fit = self.ranking.fit(hypothesis);
                fit.is_some_and(|fit| fit.left < left_over * self.recalibrated)
            }
        }
    }

    /// Share [-] of its probability that an explanation keeps.
    fn kept(&self, hypothesis: &Hypothesis) -> f64 {
        match self.checked(hypothesis) {
            Some(check) if !self.explains(hypothesis) => {
                (check.p / self.calibration.failed).min(1.0)
            }
            _ => 1.0,
        }
    }
}

fn equivalent(problem: Problem, projected: &Projected, a: usize, b: usize) -> bool {
    projected.equivalent(problem.emulator, a, b, problem.calibration.equivalent)
}

/// Effects that parameters absorb as far as equivalent effects would each other, where
/// recalibration keeps to the priors.
fn absorbed(problem: Problem, recalibrated: &Fit, projected: &Projected) -> Vec<usize> {
    let at_end = |[offset, _]: &[f64; 2]| offset.abs() > END;
    if recalibrated.offsets.iter().any(at_end) {
        return Vec::new();
    }
    let most = problem.calibration.equivalent * problem.calibration.equivalent;
    let all = 0..problem.emulator.candidates.len();
    all.filter(|&effect| projected.absorbed(effect) > most)
        .collect()
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

/// With the likeliest effects; the placebo is every other single effect.
fn shrunk(
    problem: Problem,
    ranking: &Ranking,
    projected: &Projected,
    seed: Seed,
) -> Option<Shrinkage> {
    let named = |h: &Hypothesis| !h.effects().is_empty();
    let best = ranking
        .ranked
        .iter()
        .find(|ranked| named(&ranked.hypothesis))?;
    let effects = best.hypothesis.effects();
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
    let with_effect = ranking.fit(&best.hypothesis)?;
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
