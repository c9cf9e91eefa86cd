//! A whole diagnosis: from measured runs and a scenario to a verdict and what backs it.

use super::ablation::Ablation;
use super::again::{self, InUnits, SimulatedAgain};
use super::arm::Arm;
use super::bank::{Bank, BankError, Progress, Request};
use super::calibration::Calibration;
use super::condition::{Case, CaseError, Cases, statistician};
use super::cost::Cost;
use super::emulator::Emulator;
use super::end_results::{EndResults, Step};
use super::fit::Problem;
use super::forest::Forest;
use super::further::further_runs;
use super::library::{Answers, Beside, Gathered};
use super::next_run::FurtherRuns;
use super::observation::Observation;
use super::parameter::{Offsets, Parameter};
use super::pins::{self, Ends, Point, ROUNDS, unpinned};
use super::plan::{Depth, Plan, TooSmall};
use super::ranking::Ranking;
use super::responses::{DiagnosisError, Library, Responses};
use super::screen::{Screened, isolability, screen};
use super::verdict::{Recalibrated, Verdict};
use crate::effects::{Application, EffectError, seat_of};
use crate::gap::{
    self, Closed, Colour, Comparison, Entry, GapError, Global, Margins, ParameterSpread, Run,
};
use crate::quantity::{RangeError, Seed};
use crate::scenario::Scenario;
use crate::trace::Trace;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::path::Path;

/// Simulated driving [s] of a diagnosis unless the caller says otherwise: some twenty minutes of two
/// cores on sand or hard ground.
pub const BUDGET: f64 = 20_000.0;

/// Replicates of each run that could be made, and streams of what changes in it.
const FURTHER: Depth = Depth {
    replicates: 6,
    streams: 1,
    levels: 1,
};

/// How a diagnosis is made.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Longest part [s] of a run that is compared.
    pub longest: f64,
    /// Simulated driving allowed [s] for the library of responses, and as much again for where fits end.
    pub budget: f64,
    /// Effects that are held to be impossible.
    pub without: Vec<String>,
    /// Where the ground and noise of the simulations begin.
    pub seed: Seed,
    /// The constants.
    pub calibration: Calibration,
    /// A part of the method to do without.
    pub ablation: Option<Ablation>,
}

impl Settings {
    /// The constants, less what is done without.
    fn constants(&self) -> Calibration {
        let mut calibration = self.calibration;
        if let Some(ablation) = self.ablation {
            ablation.of_calibration(&mut calibration);
        }
        calibration
    }
}

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum InvestigationError {
    /// The runs cannot be repeated.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The budget does not do.
    #[error(transparent)]
    Budget(#[from] TooSmall),
    /// The simulations stopped.
    #[error(transparent)]
    Bank(#[from] BankError),
    /// The numbers tell nothing.
    #[error(transparent)]
    Numbers(#[from] DiagnosisError),
    /// The sides cannot be compared.
    #[error("{error}{}", reasons(.failures))]
    Gap {
        /// Why not.
        error: GapError,
        /// Why simulations failed, if some did.
        failures: Vec<String>,
    },
    /// Statistics cannot be taken.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// An effect to be left out that there is not.
    #[error(transparent)]
    NoEffect(#[from] EffectError),
}

fn reasons(failures: &[String]) -> String {
    match failures {
        [] => String::new(),
        failures => format!("; simulations failed: {}", failures.join("; ")),
    }
}

/// Mean energy scores [spreads of replicates per statistic] on held-out conditions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gaps {
    /// Of the scenario as it came.
    pub as_shipped: f64,
    /// With parameters recalibrated.
    pub recalibrated: f64,
    /// With the likeliest effect or effects too.
    pub with_effect: f64,
    /// What a perfect model reaches.
    pub floor: f64,
}

/// What was compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compared {
    /// Conditions with their numbers of measured runs and of statistics.
    pub conditions: Vec<ComparedCondition>,
    /// Parameters that recalibration may move.
    pub parameters: Vec<String>,
    /// Effects that were tried.
    pub candidates: Vec<String>,
    /// How much was simulated of each.
    pub depth: Depth,
    /// What that takes where nothing is there yet.
    pub cost: Cost,
}

/// One condition of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedCondition {
    /// Which.
    pub condition: String,
    /// Measured runs.
    pub runs: usize,
    /// Statistics that both sides have.
    pub cells: usize,
}

/// Where measured runs and simulation differ, why, and how far that closes the gap.
#[derive(Debug, Clone, Serialize)]
pub struct Diagnosis {
    /// The answer.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// How far apart the sides are; none without candidates.
    pub gap: Option<Gaps>,
    /// Share of the recalibrated gap that the likeliest effect or effects close.
    pub closed: Option<Closed>,
    /// Whether the sides differ at all.
    pub global: Global,
    /// Every cell of every condition, against the scenario as it came.
    pub map: Vec<Entry>,
    /// What the screen says of every effect that was tried.
    pub screen: Vec<Screened>,
    /// Cosines of the projected signatures of those effects, row by row.
    pub isolability: Vec<Vec<f64>>,
    /// Recalibration and answer, simulated again.
    pub again: Vec<SimulatedAgain>,
    /// The gap in plain units, fitted to all conditions.
    pub in_units: Vec<InUnits>,
    /// What the gap does to forces, features, class and terrain, step by step.
    pub end_results: Vec<EndResults>,
    /// What was compared.
    pub compared: Compared,
    /// What to keep in mind.
    pub caveats: Vec<String>,
}

impl Diagnosis {
    /// The case in whose condition most cells differ from the scenario as it came, the first of
    /// several; none without cases.
    pub fn widest<'c>(&self, cases: &'c [Case]) -> Option<&'c Case> {
        let gaps = |case: &Case| {
            let own = self
                .map
                .iter()
                .filter(|entry| entry.condition == case.condition);
            own.filter(|entry| entry.colour == Colour::Gap).count()
        };
        // Of equals the last is found.
        cases.iter().rev().max_by_key(|case| gaps(case))
    }
}

/// Arms that a diagnosis ends with, for who wants to see them.
#[derive(Debug, Clone, PartialEq)]
pub struct Arms {
    /// Parameters recalibrated.
    pub recalibrated: Arm,
    /// The effect or effects of the answer too; none where it names none.
    pub with_effect: Option<Arm>,
}

/// A campaign being diagnosed.
#[derive(Debug)]
pub struct Investigation<'a> {
    cases: Vec<Case>,
    measured: Vec<Vec<Run>>,
    caveats: Vec<String>,
    plan: Plan,
    settings: &'a Settings,
    folder: &'a Path,
    version: &'a str,
}

/// Hears how far simulations are; a `Break` stops them.
pub type Hear<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

impl<'a> Investigation<'a> {
    /// Of measured runs against a scenario. Simulated statistics are kept in `folder`; those of
    /// another `version` of the program are not used.
    ///
    /// # Errors
    /// `NoEffect`; `Case` where the runs cannot be repeated; `Budget`.
    pub fn new(
        measured: &[Trace],
        scenario: &Scenario,
        settings: &'a Settings,
        (folder, version): (&'a Path, &'a str),
    ) -> Result<Self, InvestigationError> {
        for name in &settings.without {
            seat_of(name)?;
        }
        let cases = Cases::of(scenario, measured, settings.longest)?;
        let mut statistician = statistician()?;
        let read = |case: &Case| {
            let runs = case.runs.iter().filter_map(|run| measured.get(*run));
            runs.map(|trace| case.read_measured(&mut statistician, trace))
                .collect()
        };
        let runs: Vec<Vec<Run>> = cases.cases.iter().map(read).collect();
        let mut plan = Plan::within(settings.budget, &cases.cases, &settings.without)?;
        if let Some(ablation) = settings.ablation {
            ablation.of_plan(&mut plan);
        }
        Ok(Self {
            plan,
            caveats: cases.caveats.iter().map(ToString::to_string).collect(),
            cases: cases.cases,
            measured: runs,
            settings,
            folder,
            version,
        })
    }

    /// The conditions that are compared.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// What the comparison rests on less than it should, as far as the runs tell it.
    pub fn caveats(&self) -> &[String] {
        &self.caveats
    }

    /// Simulates what is not in the folder yet, and weighs it.
    ///
    /// # Errors
    /// `Bank` where simulations stop or cannot be kept; `Gap` and `Numbers` where the sides have
    /// nothing in common.
    pub fn run(&self, hear: Hear) -> Result<(Diagnosis, Arms), InvestigationError> {
        let bank = self.bank(self.cases.clone())?;
        let mut answers = Answers::default();
        ask(&bank, self.plan.requests(), hear, &mut answers)?;
        let gathered = answers.gather(&self.plan, &self.cases, &self.measured);
        let comparison = self.comparison(&answers)?;
        let calibration = &self.settings.constants();
        let library = &gathered.library;
        let mut emulator = Emulator::new(library)?;
        let observation = Observation::new(&emulator, library, &gathered.measured, calibration)?;
        let forest = Forest::train(
            problem(&emulator, &observation, calibration),
            self.settings.seed,
        );
        let mut driven = 0.0;
        for round in 0..ROUNDS {
            if driven > self.settings.budget {
                break;
            }
            let problem = problem(&emulator, &observation, calibration);
            let mut ends = unpinned(problem, round);
            ends.streams = ends.streams.min(self.plan.depth.replicates);
            driven += self.driving(&ends);
            emulator.middle.clone_from(&ends.best);
            let ask = (&bank, hear);
            let stale = std::mem::take(&mut ends.stale);
            let pinned = !ends.unpinned.is_empty()
                && self.pin(&mut emulator, (library, ends), ask, &mut answers)?;
            if !pinned && stale.is_empty() {
                break;
            }
            self.tell_anew(&mut emulator, (library, stale), ask, &mut answers)?;
        }
        let problem = problem(&emulator, &observation, calibration);
        let ranking = Ranking::new(problem, &forest);
        let verdict = Verdict::of(problem, &ranking, self.settings.seed);
        let uncertain = uncertain(library, &verdict.recalibration);
        let map = comparison.map(&Margins::default(), &uncertain, self.settings.seed);
        let gap = verdict.shrinkage.as_ref().map(|it| Gaps {
            as_shipped: it.as_shipped,
            recalibrated: it.recalibrated,
            with_effect: it.with_effect,
            floor: it.floor,
        });
        let predicted = gap.map_or([f64::INFINITY; 2], |gap| {
            [gap.recalibrated, gap.with_effect]
        });
        let places = self.places(library);
        let simulate = |arm: &Arm, predicted: f64, answers: &mut Answers| {
            ask(&bank, self.all_cases(arm, 0..again::STREAMS), hear, answers)?;
            Ok::<_, BankError>(again::simulated(
                problem,
                answers,
                (arm, &places),
                predicted,
            ))
        };
        let recalibrated = offset(offsets(&verdict.recalibration));
        let healthy = simulate(&recalibrated, predicted[0], &mut answers)?;
        let verdict = match &healthy {
            Some(healthy) => verdict.recalibrated(healthy.gap, calibration),
            None => verdict,
        };
        let further = self.further(&verdict, library, hear)?;
        let verdict = verdict.with_next_run(problem, &further);
        let with_effect = answered(&verdict);
        let mended = match &with_effect {
            Some(arm) => simulate(arm, predicted[1], &mut answers)?,
            None => None,
        };
        let verdict = match (&healthy, &mended) {
            (Some(healthy), Some(mended)) => {
                verdict.tried([healthy.gap, mended.gap], calibration.refuted)
            }
            _ => verdict,
        };
        let again: Vec<SimulatedAgain> = healthy.into_iter().chain(mended).collect();
        let arms = Arms {
            recalibrated,
            with_effect,
        };
        let requests = [Some(&arms.recalibrated), arms.with_effect.as_ref()];
        let diagnosis = Diagnosis {
            gap,
            closed: verdict.shrinkage.as_ref().and_then(|it| it.closed),
            global: map.global,
            map: map.entries,
            screen: screen(problem),
            isolability: isolability(problem),
            again,
            in_units: again::in_units(problem, &answers, &gathered.measured, requests, &places),
            end_results: self.end_results(requests, &answers),
            compared: self.compared(&gathered),
            caveats: self.told(&gathered, &answers, &map.caveats),
            verdict,
        };
        Ok((diagnosis, arms))
    }

    /// Of the scenario as shipped and of these arms.
    fn end_results(&self, arms: [Option<&Arm>; 2], answers: &Answers) -> Vec<EndResults> {
        let shipped = Arm::as_shipped();
        let [recalibrated, with_effect] = arms;
        let steps = [
            (Step::AsShipped, Some(&shipped)),
            (Step::Recalibrated, recalibrated),
            (Step::WithEffect, with_effect),
        ];
        let steps = steps.into_iter().filter_map(|(step, arm)| {
            let step = (step, arm?);
            Some(EndResults::of(step, &self.cases, &self.measured, answers))
        });
        steps.collect()
    }

    /// Length [s] of what these ends ask to be driven, in the bank or not: a campaign has one answer.
    fn driving(&self, ends: &Ends) -> f64 {
        let cases = self.cases.iter().map(|case| case.scenario.driven());
        let runs = ends.unpinned.len() as f64 * ends.streams as f64;
        runs * cases.sum::<f64>()
    }

    /// Simulates these points and pins the emulator to those that could be; whether there are any.
    fn pin(
        &self,
        emulator: &mut Emulator,
        (library, ends): (&Library, Ends),
        (bank, hear): (&Bank, Hear),
        answers: &mut Answers,
    ) -> Result<bool, InvestigationError> {
        let places = self.places(library);
        let streams = 0..ends.streams;
        let arms = ends
            .unpinned
            .into_iter()
            .filter_map(|point| Some((arm_at(emulator, &point)?, point)));
        let arms: Vec<(Arm, Point)> = arms.collect();
        // All at once: those that differ in their sensors share a motion.
        let requests = arms
            .iter()
            .flat_map(|(arm, _)| self.all_cases(arm, streams.clone()));
        ask(bank, requests.collect(), hear, answers)?;
        let mut pinned = false;
        for (arm, point) in arms {
            let conditions = library.conditions.iter().zip(&places);
            let runs: Vec<Vec<Beside>> = conditions
                .map(|(responses, case)| {
                    let runs = answers.beside(&arm, *case, &responses.cells);
                    runs.into_values().collect()
                })
                .collect();
            if runs.iter().all(|streams| !streams.is_empty()) {
                emulator.pin(point, &runs);
                pinned = true;
            }
        }
        Ok(pinned)
    }

    /// Takes the changes of these effects of the sensors anew, each where parameters are these.
    fn tell_anew(
        &self,
        emulator: &mut Emulator,
        (library, stale): (&Library, Vec<(usize, Vec<f64>)>),
        (bank, hear): (&Bank, Hear),
        answers: &mut Answers,
    ) -> Result<(), InvestigationError> {
        let streams = pins::STREAMS.min(self.plan.depth.replicates);
        let anew = stale
            .iter()
            .map(|(effect, offsets)| (*effect, Anew::of(emulator, *effect, offsets)));
        let anew: Vec<(usize, Option<Anew>)> = anew.collect();
        // All at once: those at the same parameters share a motion.
        let possible = anew.iter().filter_map(|(_, anew)| anew.as_ref());
        let arms = possible.flat_map(Anew::arms);
        let requests = arms.flat_map(|arm| self.all_cases(arm, 0..streams));
        ask(bank, requests.collect(), hear, answers)?;
        let places = self.places(library);
        for (effect, anew) in anew {
            let levels = anew.map(|anew| anew.levels(answers, library, &places));
            emulator.tell_anew(effect, &levels.unwrap_or_default());
        }
        Ok(())
    }

    fn bank(&self, cases: Vec<Case>) -> Result<Bank, BankError> {
        Bank::open(self.folder, cases, self.settings.seed, self.version)
    }

    fn comparison(&self, answers: &Answers) -> Result<Comparison, InvestigationError> {
        let shipped = Arm::as_shipped();
        let cases = 0..self.cases.len();
        let simulated: Vec<Run> = cases
            .flat_map(|case| answers.of(&shipped, case).map(|(_, run)| run.clone()))
            .collect();
        let measured: Vec<Run> = self.measured.iter().flatten().cloned().collect();
        Comparison::new(&measured, &simulated).map_err(|error| InvestigationError::Gap {
            error,
            failures: answers.failures().collect(),
        })
    }

    /// Runs that would tell the two likeliest effects apart, simulated with both and with every
    /// parameter.
    fn further(
        &self,
        verdict: &Verdict,
        library: &Library,
        hear: Hear,
    ) -> Result<FurtherRuns, InvestigationError> {
        let Some(pair) = verdict.open_between() else {
            return Ok(FurtherRuns::default());
        };
        let mut on_ground = self.cases.iter().filter(|case| !case.is_lifted());
        let runs = further_runs(on_ground.next().unwrap_or(&self.cases[0]));
        let cases: Vec<Case> = runs.iter().map(|run| run.case.clone()).collect();
        let mut plan = self.plan.clone();
        plan.depth = FURTHER;
        plan.cases = cases.len();
        for signature in &mut plan.signatures {
            if pair.iter().all(|suspect| suspect.name != signature.name()) {
                signature.magnitudes.clear();
                signature.arms.clear();
            }
        }
        let bank = self.bank(cases.clone())?;
        let mut answers = Answers::default();
        ask(&bank, plan.requests(), hear, &mut answers)?;
        // Both sides are replicates: nothing was measured there yet.
        let shipped = Arm::as_shipped();
        let replicates: Vec<Vec<Run>> = (0..cases.len())
            .map(|case| {
                answers
                    .of(&shipped, case)
                    .map(|(_, run)| run.clone())
                    .collect()
            })
            .collect();
        let gathered = answers.gather(&plan, &cases, &replicates);
        let mut further = gathered.library;
        further.candidates.clone_from(&library.candidates);
        let told: Vec<String> = further
            .conditions
            .iter()
            .map(|it| it.condition.to_string())
            .collect();
        let name = |condition: &String| {
            let run = runs
                .iter()
                .find(|run| run.case.condition.as_str() == condition)?;
            Some(format!("{} ({condition})", run.name))
        };
        let names = told.iter().filter_map(name).collect();
        Ok(FurtherRuns::new(names, &further)?)
    }

    /// An arm in all cases, with these streams.
    fn all_cases(&self, arm: &Arm, streams: impl Iterator<Item = u64> + Clone) -> Vec<Request> {
        let cases = 0..self.cases.len();
        let request = |case| {
            let arm = arm.clone();
            streams.clone().map(move |stream| Request {
                arm: arm.clone(),
                case,
                stream,
            })
        };
        cases.flat_map(request).collect()
    }

    /// The case of each condition of the library.
    fn places(&self, library: &Library) -> Vec<usize> {
        let conditions = library.conditions.iter();
        let place = |responses: &super::Responses| {
            let mut cases = self.cases.iter();
            cases.position(|case| case.condition == responses.condition)
        };
        conditions.filter_map(place).collect()
    }

    fn compared(&self, gathered: &Gathered) -> Compared {
        let library = &gathered.library;
        let conditions = library.conditions.iter().zip(&gathered.measured);
        Compared {
            conditions: conditions
                .map(|(responses, measured)| ComparedCondition {
                    condition: responses.condition.to_string(),
                    runs: measured.runs.len(),
                    cells: responses.cells.len(),
                })
                .collect(),
            parameters: library.parameters.clone(),
            candidates: library
                .candidates
                .iter()
                .map(|it| it.name.clone())
                .collect(),
            depth: self.plan.depth,
            cost: self.plan.cost(&self.cases),
        }
    }

    fn told(&self, gathered: &Gathered, answers: &Answers, of_map: &[gap::Caveat]) -> Vec<String> {
        let without_cells = gathered
            .without_cells
            .iter()
            .map(|condition| format!("{condition}: no statistic that both sides have"));
        let failures = answers.failures().map(|it| format!("not simulated: {it}"));
        let of_map = of_map.iter().map(ToString::to_string);
        let caveats = self.caveats.iter().cloned();
        let mut told: Vec<String> = Vec::new();
        for caveat in caveats.chain(of_map).chain(without_cells).chain(failures) {
            if !told.contains(&caveat) {
                told.push(caveat);
            }
        }
        told
    }
}

/// An effect of the sensors at its magnitudes, and the same without it.
struct Anew {
    alone: Arm,
    levels: Vec<(f64, Arm)>,
}

impl Anew {
    /// None where the parameters cannot be these.
    fn of(emulator: &Emulator, effect: usize, offsets: &[f64]) -> Option<Self> {
        let at = |effects: Vec<(usize, f64)>| {
            let offsets = offsets.to_vec();
            arm_at(emulator, &Point { offsets, effects })
        };
        let levels = emulator.candidates[effect].levels().into_iter();
        let levels = levels.filter_map(|strength| Some((strength, at(vec![(effect, strength)])?)));
        Some(Self {
            alone: at(Vec::new())?,
            levels: levels.collect(),
        })
    }

    fn arms(&self) -> impl Iterator<Item = &Arm> {
        let levels = self.levels.iter().map(|(_, arm)| arm);
        levels.chain([&self.alone])
    }

    /// By strength and condition, a pair of runs a stream; strengths that all conditions have.
    fn levels(
        &self,
        answers: &Answers,
        library: &Library,
        places: &[usize],
    ) -> Vec<(f64, Vec<Vec<Beside>>)> {
        let beside = |arm: &Arm, (responses, case): (&super::Responses, &usize)| {
            let with = answers.beside(arm, *case, &responses.cells);
            let mut without = answers.beside(&self.alone, *case, &responses.cells);
            let pairs = with.into_iter().filter_map(|(stream, run)| {
                let without = without.remove(&stream)?.with;
                Some(Beside { without, ..run })
            });
            Some(pairs.collect::<Vec<_>>()).filter(|pairs| !pairs.is_empty())
        };
        let levels = self.levels.iter().filter_map(|(strength, arm)| {
            let conditions = library.conditions.iter().zip(places);
            let runs = conditions.map(|condition| beside(arm, condition));
            Some((*strength, runs.collect::<Option<Vec<_>>>()?))
        });
        levels.collect()
    }
}

/// The arm at a point; none where a magnitude is beyond its range.
fn arm_at(emulator: &Emulator, point: &Point) -> Option<Arm> {
    let named = emulator.parameters.iter().zip(&point.offsets);
    let arm = offset(named.map(|(name, offset)| (name.as_str(), *offset)));
    point
        .effects
        .iter()
        .try_fold(arm, |arm, (effect, strength)| {
            let candidate = &emulator.candidates[*effect];
            let effect = Application::new(&candidate.name, candidate.magnitude(*strength)).ok()?;
            Some(arm.with_effect(effect))
        })
}

/// Standard deviations of the cells, in their units, by what recalibration leaves open of the parameters, taken
/// for independent.
fn uncertain(library: &Library, parameters: &[Recalibrated]) -> ParameterSpread {
    let of_cell = |responses: &Responses, cell: usize| {
        let moved = responses.parameters.iter().zip(parameters);
        let parts = moved.map(|(moved, parameter)| {
            let slopes = moved.slope.iter().map(|row| row[cell]);
            let slope = slopes.sum::<f64>() / moved.slope.len().max(1) as f64;
            slope * parameter.deviation
        });
        libm::sqrt(parts.map(|part| part * part).sum())
    };
    let of_condition = |responses: &Responses| {
        let cells = responses.cells.iter().enumerate();
        let cells = cells.map(|(place, cell)| (cell.clone(), of_cell(responses, place)));
        (responses.condition.clone(), cells.collect())
    };
    library.conditions.iter().map(of_condition).collect()
}

/// The arm of the effects that an answer names; none where it names none.
fn answered(verdict: &Verdict) -> Option<Arm> {
    let named = verdict.named.iter().filter_map(|set| {
        let name = set.first()?;
        verdict.effects.iter().find(|suspect| suspect.name == *name)
    });
    let effects =
        named.filter_map(|suspect| Application::new(&suspect.name, suspect.magnitude).ok());
    let effects: Vec<Application> = effects.collect();
    let recalibrated = offset(offsets(&verdict.parameters));
    let arm = effects
        .iter()
        .fold(recalibrated, |arm, effect| arm.with_effect(*effect));
    (!effects.is_empty()).then_some(arm)
}

fn offsets(parameters: &[Recalibrated]) -> impl Iterator<Item = (&str, f64)> {
    parameters.iter().map(|it| (it.name.as_str(), it.offset))
}

/// The arm of parameters off by so many prior standard deviations.
fn offset<'n>(parameters: impl Iterator<Item = (&'n str, f64)>) -> Arm {
    let known = parameters.filter_map(|(name, offset)| Some((Parameter::find(name)?, offset)));
    Arm::of_offsets(known.fold(Offsets::default(), |all, (parameter, offset)| {
        all.with(parameter, offset * parameter.sd)
    }))
}

fn problem<'a>(
    emulator: &'a Emulator,
    observation: &'a Observation,
    calibration: &'a Calibration,
) -> Problem<'a> {
    Problem {
        emulator,
        observation,
        calibration,
    }
}

fn ask(
    bank: &Bank,
    requests: Vec<Request>,
    hear: Hear,
    answers: &mut Answers,
) -> Result<(), BankError> {
    let outcomes = bank.readings(&requests, hear)?;
    answers.add(&requests, outcomes);
    Ok(())
}
