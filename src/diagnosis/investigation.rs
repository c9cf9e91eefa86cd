//! A whole diagnosis: from measured runs and a scenario to a verdict and what backs it.

use super::arm::Arm;
use super::bank::{self, Bank, BankError, Failure, Request};
use super::candidate::{Candidate, candidates};
use super::condition::{Case, CaseError, Cases, statistician};
use super::discrepancy::{self, Discrepancy};
use super::end_results::{EndResults, Step};
use super::inference::{
    Ablation, BaseRates, FEWEST_RIGS, Fit, Judgement, Model, OfColumn, SelfTest, Signatures,
    TrainingError, TrainingSettings,
};
use super::model_file;
use super::next_run::{Rival, Search};
use super::parameter::{Offsets, Parameter, parameters};
use super::rigs::{self, Column, Origin, Part, Population, RigError, RigSet};
use super::screen::{Screened, screen};
use super::simulated_runs::SimulatedRuns;
use super::validation::{Gaps, InUnits, Validation, Variants, Yardstick, in_units, validate};
use super::verdict::{Answer, Chosen, Grounds, Located, Recalibrated, Verdict};
use crate::effects::{EffectError, seat_of};
use crate::gap::{
    self, Closed, Colour, Comparison, Entry, GapError, GapMap, Global, Margins, ParameterSpread,
    Run,
};
use crate::quantity::{RangeError, Seed};
use crate::scenario::Scenario;
use crate::trace::Trace;
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Instant;

/// Simulated driving \[s\] of a diagnosis by default: some seven minutes of two cores for a campaign of
/// seven conditions of 10 s on sand or hard ground.
pub const BUDGET: f64 = 32_000.0;

/// Realisations of the scenario as it is, which all campaigns of a layout share, and of each variant of one.
const REPLICATES: u64 = 12;
const REALISATIONS: u64 = 3;

/// Mean time of a motion of a rig, measured by some six sets of sensors, over that of the scenario as it is, measured once:
/// on hard ground.
const PER_MOTION: f64 = 1.3;

/// Share of the candidates [-] that may be left out of rigs that have all.
const FEW: f64 = 0.25;

/// Cells that locate a remainder, and the score [deviations] from which on one is worth a mention.
const LOCATED: usize = 10;
const STRONG: f64 = 4.0;

/// Share [-] that an effect closes at least, if it is the cause, of the gap above the floor with discrepancy: the larger part.
const LEAST_CLOSED: f64 = 0.5;

/// How a diagnosis is made.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Longest part \[s\] of a run that is compared.
    pub longest: f64,
    /// Simulated driving allowed \[s\]: of rigs to learn from.
    pub budget: f64,
    /// Effects that are held to be impossible.
    pub without: Vec<String>,
    /// Where the ground and noise of the simulations begin.
    pub seed: Seed,
    /// How often causes are met.
    pub rates: BaseRates,
    /// Discrepancy between any rig and any simulator, in margins of equivalence [-].
    pub discrepancy: f64,
    /// A part of the model that is left out, to measure what it is worth.
    pub ablation: Option<Ablation>,
    /// Whether the run that separates the most probable effects is not searched for.
    pub without_next_run: bool,
}

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InvestigationError {
    /// The runs cannot be repeated.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The budget does not do.
    #[error(
        "{budget:.0} s of driving are too few: the least is {least:.0} s for {FEWEST_RIGS} random rigs; allow more, or \
         compare fewer or shorter runs"
    )]
    Budget {
        /// Driving allowed \[s\].
        budget: f64,
        /// Driving of the fewest rigs \[s\].
        least: f64,
    },
    /// The scenario cannot be simulated.
    #[error("the scenario cannot be simulated at the measured conditions: {0}")]
    Nominal(Failure),
    /// The rigs could not be simulated.
    #[error(transparent)]
    Rigs(#[from] RigError),
    /// Nothing can be learned from them.
    #[error(transparent)]
    Training(#[from] TrainingError),
    /// The simulations stopped.
    #[error(transparent)]
    Bank(#[from] BankError),
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

impl InvestigationError {
    /// Whether the caller stopped it.
    pub fn is_stopped(&self) -> bool {
        matches!(
            self,
            Self::Bank(BankError::Stopped { .. }) | Self::Rigs(RigError::Stopped { .. })
        )
    }

    /// Whether the file system refused.
    pub fn is_refused(&self) -> bool {
        matches!(
            self,
            Self::Bank(BankError::File { .. }) | Self::Rigs(RigError::File { .. })
        )
    }
}

fn reasons(failures: &[String]) -> String {
    match failures {
        [] => String::new(),
        failures => format!("; simulations failed: {}", failures.join("; ")),
    }
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
    /// Random rigs that were simulated.
    pub rigs: usize,
    /// Driving of them \[s\].
    pub driven: f64,
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
    /// How far apart the sides are; none where variants could not be simulated.
    pub gap: Option<Gaps>,
    /// Share of the recalibrated gap that the likeliest effect or effects close.
    pub closed: Option<Closed>,
    /// Effects that the gap was closed with: the likeliest, named or not.
    pub closed_with: Vec<String>,
    /// Whether the sides differ at all.
    pub global: Global,
    /// Every cell of every condition, against the scenario as it came.
    pub map: Vec<Entry>,
    /// What can be seen of every effect that was tried.
    pub screen: Vec<Screened>,
    /// Detection limit of each effect, in its unit; none where no magnitude is detectable.
    pub limits: BTreeMap<String, Option<f64>>,
    /// Cosines of the projected signatures of those effects, row by row.
    pub isolability: Vec<Vec<f64>>,
    /// What may be expected of diagnoses of this layout.
    pub self_test: SelfTest,
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

/// What a diagnosis takes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Random rigs.
    pub rigs: usize,
    /// Driving of one \[s\].
    pub driven_per_rig: f64,
    /// Time of one core that one takes \[s\], estimated.
    pub seconds_per_rig: f64,
}

/// What a diagnosis is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Random rigs are simulated.
    Rigs,
    /// The answer is simulated.
    Validation,
}

/// How far it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// With what.
    pub stage: Stage,
    /// Steps done.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
}

/// Callback with the progress of simulations; a `Break` stops them.
pub type OnProgress<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// A campaign being diagnosed.
#[derive(Debug)]
pub struct Investigation<'a> {
    cases: Vec<Case>,
    measured: Vec<Vec<Run>>,
    caveats: Vec<String>,
    parameters: Vec<&'static Parameter>,
    /// Effects that are tried.
    candidates: Vec<Candidate>,
    /// Effects of the rigs.
    of_rigs: Vec<Candidate>,
    rigs: usize,
    settings: &'a Settings,
    origin: Origin<'a>,
}

/// The measured campaign in the model of the rigs.
struct Fitted<'m> {
    yardstick: Yardstick<'m>,
    /// Measured statistics, in the order of the columns.
    values: &'m [f32],
    judgement: Judgement,
    /// Fit of the parameters without effects.
    healthy: Fit,
    /// Fit of the parameters with the chosen effects.
    answered: Fit,
    signatures: Signatures,
    screen: Vec<Screened>,
    variants: Variants,
}

impl<'a> Investigation<'a> {
    /// Of measured runs against a scenario. What is simulated is kept at its origin.
    ///
    /// # Errors
    /// `NoEffect`; `Case` where the runs cannot be repeated; `Budget`.
    pub fn new(
        measured: &[Trace],
        scenario: &Scenario,
        settings: &'a Settings,
        origin: Origin<'a>,
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
        let all = candidates(&cases.cases);
        let tried = all.iter().filter(|it| it.is_none_of(&settings.without));
        let tried: Vec<Candidate> = tried.copied().collect();
        // Rigs of all effects serve where a few are left out, and then every time.
        let excluded = all.len() - tried.len();
        let of_rigs = if excluded as f64 > FEW * all.len() as f64 {
            tried.clone()
        } else {
            all
        };
        let driven = driven(&cases.cases, &of_rigs);
        let rigs = (settings.budget / driven) as usize;
        if rigs < FEWEST_RIGS {
            return Err(InvestigationError::Budget {
                budget: settings.budget,
                least: FEWEST_RIGS as f64 * driven,
            });
        }
        Ok(Self {
            candidates: tried,
            of_rigs,
            rigs,
            parameters: parameters(&cases.cases[0].scenario).collect(),
            caveats: cases.caveats.iter().map(ToString::to_string).collect(),
            cases: cases.cases,
            measured: runs,
            settings,
            origin,
        })
    }

    /// The investigation with these caveats before its own.
    #[must_use]
    pub fn with_caveats(self, mut caveats: Vec<String>) -> Self {
        caveats.extend(self.caveats);
        Self { caveats, ..self }
    }

    /// The conditions that are compared.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// What the comparison rests on less than it should, as far as the runs show it.
    pub fn caveats(&self) -> &[String] {
        &self.caveats
    }

    /// What a diagnosis takes where nothing of it is in the folder yet, estimated from the scenario as it is on this machine.
    ///
    /// # Errors
    /// `Nominal` where the scenario cannot be simulated; `Bank`.
    pub fn estimate(&self, on_progress: OnProgress) -> Result<Estimate, InvestigationError> {
        let begun = Instant::now();
        self.nominal(on_progress)?;
        let threads = rayon::current_num_threads().min(self.cases.len());
        let seconds = begun.elapsed().as_secs_f64() * threads as f64;
        Ok(Estimate {
            rigs: self.rigs,
            driven_per_rig: driven(&self.cases, &self.of_rigs),
            seconds_per_rig: PER_MOTION * rigs::motions(&self.of_rigs) as f64 * seconds,
        })
    }

    /// Simulates what is not in the folder yet, learns from it, and judges the measured runs.
    ///
    /// # Errors
    /// `Rigs` and `Bank` where simulations stop or cannot be kept; `Gap` where the sides have nothing in common;
    /// `Training`.
    pub fn run(
        &self,
        on_progress: OnProgress,
    ) -> Result<(Diagnosis, Variants), InvestigationError> {
        let set = self.rig_set(on_progress)?;
        let model = self.model(&set, on_progress)?;
        let values = set.measured(&self.measured);
        let judgement = model.judge(&values, &self.settings.rates);
        let chosen = Chosen::of(&judgement);
        let healthy = model.fit(&values, &[]);
        let answered = model.fit(&values, &chosen.effects);
        let signatures = model.signatures(&answered.parameters);
        let columns = &set.population.columns;
        let factor = self.settings.discrepancy;
        let discrepancy =
            (factor > 0.0).then(|| Discrepancy::of(columns, factor, &self.is_loaded()));
        let fitted = Fitted {
            screen: screen(&self.candidates, &judgement.opinion.evidence, &signatures),
            yardstick: Yardstick {
                model: &model,
                columns,
                discrepancy: discrepancy.as_ref(),
            },
            variants: Variants {
                recalibrated: Arm::of_offsets(self.offsets(&healthy)),
                with_effect: self.with_effects(&chosen, &answered),
            },
            values: &values,
            judgement,
            healthy,
            answered,
            signatures,
        };
        let simulated = self.simulate(&fitted.variants, on_progress)?;
        let comparison = self.comparison(&simulated)?;
        let validation = validate(
            fitted.yardstick,
            &self.measured,
            &simulated,
            &fitted.variants,
            &self.cases,
            self.settings.seed,
        );
        let verdict = self.verdict(&fitted, validation.as_ref(), on_progress)?;
        let map = comparison.map(
            &Margins::default(),
            &self.spread(&fitted),
            self.settings.seed,
        );
        let diagnosis = self.diagnosis(&fitted, &simulated, map, validation, verdict);
        Ok((diagnosis, fitted.variants))
    }

    /// The verdict, confirmed by the simulated variants, with the next run where it is open.
    fn verdict(
        &self,
        fitted: &Fitted,
        validation: Option<&Validation>,
        on_progress: OnProgress,
    ) -> Result<Verdict, InvestigationError> {
        let Yardstick { model, columns, .. } = fitted.yardstick;
        let grounds = Grounds {
            candidates: &self.candidates,
            screen: &fitted.screen,
            judgement: &fitted.judgement,
            self_test: &model.self_test,
        };
        let residuals = model.residuals(fitted.values, &fitted.healthy.parameters);
        let verdict = Verdict {
            parameters: self.recalibrated(&fitted.answered),
            recalibration: self.recalibrated(&fitted.healthy),
            located: self.located(columns, residuals),
            ..grounds.verdict()
        };
        let search = Search {
            yardstick: fitted.yardstick,
            bank: &|cases| self.bank(cases),
            progress: &|now| on_progress(validating(now)),
        };
        let verdict = confirmed(verdict, validation);
        Ok(self.with_next_run(verdict, fitted, &search)?)
    }

    /// The verdict with all that supports it.
    fn diagnosis(
        &self,
        fitted: &Fitted,
        simulated: &SimulatedRuns,
        map: GapMap,
        validation: Option<Validation>,
        verdict: Verdict,
    ) -> Diagnosis {
        let Yardstick { model, columns, .. } = fitted.yardstick;
        let limits = fitted.screen.iter();
        let limits = limits.map(|it| (it.name.clone(), it.detectable));
        let cosines = fitted.signatures.cosines.row_iter();
        Diagnosis {
            gap: validation.as_ref().map(|it| it.gaps),
            closed: validation.as_ref().and_then(|it| it.closed),
            closed_with: validation.map_or_else(Vec::new, |it| it.effects),
            global: map.global,
            map: map.entries,
            limits: limits.collect(),
            isolability: cosines.map(|row| row.iter().copied().collect()).collect(),
            self_test: model.self_test.clone(),
            in_units: in_units(
                columns,
                &self.measured,
                simulated,
                &fitted.variants,
                &self.cases,
            ),
            end_results: self.end_results(&fitted.variants, simulated),
            compared: self.compared(columns),
            caveats: self.all_caveats(simulated, &map.caveats),
            screen: fitted.screen.clone(),
            verdict,
        }
    }

    fn rig_set(&self, on_progress: OnProgress) -> Result<RigSet, InvestigationError> {
        let nominal = self.nominal(on_progress)?;
        let population = Population {
            cases: self.cases.clone(),
            candidates: self.of_rigs.clone(),
            parameters: self.parameters.clone(),
            columns: Population::columns(&nominal),
        };
        Ok(RigSet::open(population, self.origin)?)
    }

    /// One run of the scenario as it is, in every condition.
    fn nominal(&self, on_progress: OnProgress) -> Result<Vec<Run>, InvestigationError> {
        let requests = (0..self.cases.len()).map(|case| Request {
            arm: Arm::as_shipped(),
            case,
            stream: 0,
        });
        let begun = rigs::Progress {
            done: 0,
            total: self.rigs as u64,
        };
        let outcomes = self
            .bank(self.cases.clone())?
            .readings(&requests.collect::<Vec<_>>(), &|_| {
                on_progress(drawing(begun, self.rigs))
            })?;
        let runs: Result<Vec<Run>, Failure> = outcomes.into_iter().collect();
        runs.map_err(InvestigationError::Nominal)
    }

    /// The model of these rigs, from their folder where it has been learned before.
    fn model(&self, set: &RigSet, on_progress: OnProgress) -> Result<Model, InvestigationError> {
        let names: Vec<String> = self.candidates.iter().map(Candidate::name).collect();
        let discrepancy = self.settings.discrepancy;
        let ablation = self.settings.ablation;
        let without = ablation.map_or(String::new(), |part| format!(" without {part}"));
        let key = set.key();
        let key = format!("{key} contact {discrepancy}{without} {}", names.join(","));
        let path = model_file::path(set.folder(), self.rigs, &key);
        if let Some(model) = model_file::read(&path, &key) {
            return Ok(model);
        }
        let table = set.draw(self.rigs, &|now| on_progress(drawing(now, self.rigs)))?;
        let kept = (0..self.of_rigs.len())
            .filter(|place| self.of_rigs[*place].is_none_of(&self.settings.without));
        let mut table = table.restricted(&kept.collect::<Vec<_>>());
        discrepancy::add(
            &mut table,
            discrepancy,
            &self.is_loaded(),
            self.settings.seed,
        );
        let training = TrainingSettings {
            seed: self.settings.seed,
            ablation,
        };
        let model = Model::train(&table, &self.candidates, training)?;
        model_file::write(&path, &key, &model).map_err(|source| RigError::File {
            path: set.folder().to_owned(),
            source,
        })?;
        Ok(model)
    }

    /// Whether the wheel is on the ground, of every condition.
    fn is_loaded(&self) -> Vec<bool> {
        self.cases.iter().map(|case| !case.is_lifted()).collect()
    }

    fn bank(&self, cases: Vec<Case>) -> Result<Bank, BankError> {
        let Origin {
            folder,
            version,
            seed,
        } = self.origin;
        Bank::open(folder, cases, seed, version)
    }

    fn offsets(&self, fit: &Fit) -> Offsets {
        Offsets::of_deviations(&self.parameters, &fit.parameters)
    }

    fn with_effects(&self, chosen: &Chosen, fit: &Fit) -> Option<Arm> {
        let effects = chosen.effects.iter();
        let effects = effects.map(|part| self.candidates[part.candidate].application(part.size));
        let effects = effects.collect::<Result<Vec<_>, _>>().ok()?;
        let arm = Arm::of_offsets(self.offsets(fit));
        (!effects.is_empty()).then(|| effects.into_iter().fold(arm, Arm::with_effect))
    }

    fn simulate(
        &self,
        variants: &Variants,
        on_progress: OnProgress,
    ) -> Result<SimulatedRuns, BankError> {
        let bank = self.bank(self.cases.clone())?;
        let progress = |now: bank::Progress| on_progress(validating(now));
        let mut simulated = SimulatedRuns::default();
        simulated.simulate(&bank, &[&Arm::as_shipped()], REPLICATES, &progress)?;
        let others = [Some(&variants.recalibrated), variants.with_effect.as_ref()];
        let others: Vec<&Arm> = others.into_iter().flatten().collect();
        simulated.simulate(&bank, &others, REALISATIONS, &progress)?;
        Ok(simulated)
    }

    fn comparison(&self, simulated: &SimulatedRuns) -> Result<Comparison, InvestigationError> {
        let shipped = Arm::as_shipped();
        let cases = 0..self.cases.len();
        let made: Vec<Run> = cases
            .flat_map(|case| simulated.of(&shipped, case).cloned())
            .collect();
        let measured: Vec<Run> = self.measured.iter().flatten().cloned().collect();
        Comparison::new(&measured, &made).map_err(|error| InvestigationError::Gap {
            error,
            failures: simulated.failures().collect(),
        })
    }

    /// Standard deviations of cells, in their units, by what recalibration leaves open of the parameters.
    fn spread(&self, fitted: &Fitted) -> ParameterSpread {
        let Yardstick { model, columns, .. } = fitted.yardstick;
        let mut spread = ParameterSpread::new();
        for OfColumn { column, value } in model.parameter_spread(&fitted.healthy) {
            let Column {
                condition, cell, ..
            } = &columns[column];
            let own = spread.entry(self.cases[*condition].condition.clone());
            own.or_default().insert(cell.clone(), value);
        }
        spread
    }

    fn recalibrated(&self, fit: &Fit) -> Vec<Recalibrated> {
        let parameters = self.parameters.iter().enumerate();
        let recalibrated = parameters.map(|(place, parameter)| Recalibrated {
            name: parameter.name.to_owned(),
            offset: fit.parameters[place],
            deviation: libm::sqrt(fit.covariance[(place, place)]),
        });
        recalibrated.collect()
    }

    /// The strongest of what parameters leave.
    fn located(&self, columns: &[Column], residuals: Vec<OfColumn>) -> Vec<Located> {
        let strong = residuals.into_iter().filter(|of| of.value.abs() > STRONG);
        let located = strong.map(|OfColumn { column, value }| {
            let Column {
                condition, cell, ..
            } = &columns[column];
            Located {
                condition: self.cases[*condition].condition.clone(),
                cell: cell.clone(),
                deviations: value,
            }
        });
        let mut located: Vec<Located> = located.collect();
        located.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
        located.truncate(LOCATED);
        located
    }

    fn with_next_run(
        &self,
        verdict: Verdict,
        fitted: &Fitted,
        search: &Search,
    ) -> Result<Verdict, BankError> {
        if self.settings.without_next_run {
            return Ok(verdict);
        }
        let Some(pair) = verdict.open_between() else {
            return Ok(verdict);
        };
        let rival = |name: &str| {
            let effect = self.candidates.iter().position(|it| it.name() == name)?;
            let sizes = &fitted.judgement.opinion.evidence.sizes;
            let chosen = Chosen {
                effects: vec![Part {
                    candidate: effect,
                    size: sizes[effect].middle,
                }],
            };
            let model = fitted.yardstick.model;
            let fit = model.fit(fitted.values, &chosen.effects);
            let arm = self.with_effects(&chosen, &fit)?;
            let name = name.to_owned();
            Some(Rival { name, arm })
        };
        let [Some(first), Some(second)] = pair.map(|suspect| rival(&suspect.name)) else {
            return Ok(verdict);
        };
        let next_run = search.between([&first, &second], &self.cases)?;
        Ok(Verdict {
            next_run,
            ..verdict
        })
    }

    /// Of the scenario as it is and of the variants.
    fn end_results(&self, variants: &Variants, simulated: &SimulatedRuns) -> Vec<EndResults> {
        let shipped = Arm::as_shipped();
        let steps = [
            (Step::AsShipped, Some(&shipped)),
            (Step::Recalibrated, Some(&variants.recalibrated)),
            (Step::WithEffect, variants.with_effect.as_ref()),
        ];
        let steps = steps.into_iter().filter_map(|(step, arm)| {
            let arm = arm?;
            Some(EndResults::of(step, arm, &self.measured, simulated))
        });
        steps.collect()
    }

    fn compared(&self, columns: &[Column]) -> Compared {
        let cells = |condition: usize| {
            let own = columns.iter().filter(|it| it.condition == condition);
            let mut runs = self.measured[condition].iter();
            let first = runs.next();
            let both = own
                .filter(|column| first.is_some_and(|run| run.readings.get(&column.cell).is_some()));
            both.count()
        };
        let conditions = self.cases.iter().enumerate();
        Compared {
            conditions: conditions
                .map(|(place, case)| ComparedCondition {
                    condition: case.condition.to_string(),
                    runs: self.measured[place].len(),
                    cells: cells(place),
                })
                .collect(),
            parameters: self
                .parameters
                .iter()
                .map(|it| it.name.to_owned())
                .collect(),
            candidates: self.candidates.iter().map(Candidate::name).collect(),
            rigs: self.rigs,
            driven: self.rigs as f64 * driven(&self.cases, &self.of_rigs),
        }
    }

    fn all_caveats(&self, simulated: &SimulatedRuns, of_map: &[gap::Caveat]) -> Vec<String> {
        let failures = simulated
            .failures()
            .map(|it| format!("not simulated: {it}"));
        let of_map = of_map.iter().map(ToString::to_string);
        let mut all: Vec<String> = Vec::new();
        for caveat in self.caveats.iter().cloned().chain(of_map).chain(failures) {
            if !all.contains(&caveat) {
                all.push(caveat);
            }
        }
        all
    }
}

/// Driving [s] of one rig.
fn driven(cases: &[Case], of_rigs: &[Candidate]) -> f64 {
    let once: f64 = cases.iter().map(|case| case.scenario.driven()).sum();
    rigs::motions(of_rigs) as f64 * once
}

fn drawing(now: rigs::Progress, rigs: usize) -> Progress {
    Progress {
        stage: Stage::Rigs,
        done: now.done,
        total: rigs as u64,
    }
}

fn validating(now: bank::Progress) -> Progress {
    Progress {
        stage: Stage::Validation,
        done: now.motions,
        total: now.motions_total,
    }
}

/// An effect that the simulation refutes is not named.
fn confirmed(mut verdict: Verdict, validation: Option<&Validation>) -> Verdict {
    let refuted = validation.filter(|_| !verdict.named.is_empty());
    let Some(reason) = refuted.and_then(refutation) else {
        return verdict;
    };
    verdict.reasons.push(reason);
    verdict.named.clear();
    verdict.verdict = Answer::Undecided;
    verdict
}

/// Why effects are not the cause: they close nothing, or less than half of what a cause would close with 95 % confidence.
fn refutation(validation: &Validation) -> Option<String> {
    let Gaps {
        recalibrated,
        with_effect,
        floor,
        floor_with_discrepancy,
        ..
    } = validation.gaps;
    // Of one cluster the interval is the share itself.
    let closed = validation.closed_above_discrepancy;
    let most = closed.map_or(1.0, |closed| closed.ci95[1]);
    let shown = if with_effect >= recalibrated {
        "does not close the gap".to_owned()
    } else if most < LEAST_CLOSED {
        let least = floor_with_discrepancy.unwrap_or(floor);
        let most = format!("{:.0} %", 100.0 * most);
        format!(
            "closes at most {most} of the gap above {least:.2}, which the true cause would leave"
        )
    } else {
        return None;
    };
    Some(format!(
        "simulated with {} the gap is {with_effect:.2}, without it {recalibrated:.2}: the effect {shown}, and is not named",
        validation.effects.join(" and ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn validation(with_effect: f64, closed: Option<Closed>) -> Validation {
        Validation {
            effects: vec!["slip_sinkage".to_owned()],
            gaps: Gaps {
                as_shipped: 2.0,
                recalibrated: 1.0,
                with_effect,
                floor: 0.2,
                floor_with_discrepancy: Some(0.4),
            },
            closed: None,
            closed_above_discrepancy: closed,
        }
    }

    fn share(most: f64, clusters: usize) -> Option<Closed> {
        Some(Closed {
            value: 0.3,
            ci95: [0.0, most],
            clusters,
        })
    }

    #[test]
    fn an_effect_is_refuted_by_a_gap_that_it_does_not_close_or_surely_less_than_half() {
        let wider = refutation(&validation(1.1, share(0.9, 4))).unwrap();
        assert!(wider.contains("does not close the gap"), "{wider}");
        let little = refutation(&validation(0.9, share(0.4, 4))).unwrap();
        assert!(
            little.contains("at most 40 % of the gap above 0.40"),
            "{little}"
        );
        // One condition has no interval: the share itself counts.
        assert!(refutation(&validation(0.9, share(0.4, 1))).is_some());
        // Half may be closed; a gap below the floor shows nothing.
        for closed in [share(0.6, 4), None] {
            assert_eq!(refutation(&validation(0.9, closed)), None);
        }
    }
}
