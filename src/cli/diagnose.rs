//! `diagnose`: where measured runs and a scenario differ, and which effect causes it.

pub(super) mod summary;

use super::documents;
use super::interrupt::{self, Interrupted};
use super::output::{self, Output};
use super::progress::Progress;
use super::provenance::quoted;
use super::series::Jobs;
use super::target::Claim;
use crate::dataset::hdf5::RunFile;
use crate::dataset::inspection;
use crate::diagnosis::arm::Arm;
use crate::diagnosis::condition::LONGEST;
use crate::diagnosis::inference::{Ablation, BaseRates, FEWEST_RIGS};
use crate::diagnosis::rigs::Origin;
use crate::diagnosis::{
    self, ArmTraces, BUDGET, Diagnosis, Investigation, InvestigationError, OnProgress, Settings,
    Stage, Variants,
};
use crate::gap::GapMap;
use crate::quantity::Seed;
use crate::report::{self, DiagnosisReport};
use crate::scenario::Scenario;
use crate::trace::Trace;
use anyhow::Context;
use clap::Args;
use serde::Serialize;
use std::fmt;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use summary::{Input, Inputs, Summary};

/// Identify where measured runs and a scenario differ, which missing effect causes it, and how far
/// adding it closes the gap
///
/// Random rigs with the measured conditions and channels are simulated, with parameters drawn from the priors and
/// effects of the catalogue (`lugwheel effects`). A model trained on these rigs classifies the measured runs, and is
/// tested on rigs that were not used for the training. Answers: none, parameter, effect, effects, unknown (and where),
/// undecided (and which run would decide).
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Diagnose {
    /// Run file of the measurements; repeats and several conditions increase the certainty
    #[arg(long, value_name = "FILE.h5")]
    pub(super) measured: PathBuf,
    /// Scenario file of the rig, or the name of one of `lugwheel scenarios`; load, speed and slip are taken
    /// from the measured runs
    #[arg(long, value_name = "SCENARIO")]
    pub(super) scenario: PathBuf,
    /// Set a key of the scenario, in SI units, for example wheel.lugs.count=0
    #[arg(long, value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// Exclude this effect, with or without its channel; may be given several times
    #[arg(long, value_name = "EFFECT")]
    pub(super) without: Vec<String>,
    /// Only this measured run; may be given several times
    #[arg(long, value_name = "ID")]
    pub(super) run: Vec<String>,
    /// Folder of the results
    #[arg(long, value_name = "DIR", default_value = "output/diagnosis")]
    pub(super) out: PathBuf,
    /// Folder of the simulation cache, shared by diagnoses
    #[arg(long, value_name = "DIR", default_value = "output/bank")]
    pub(super) bank: PathBuf,
    /// Simulated duration of the random rigs [s]; a longer one gives a larger training set
    #[arg(long, value_name = "SECONDS", default_value_t = BUDGET, allow_negative_numbers = true, value_parser = super::positive)]
    pub(super) budget: f64,
    /// Computing time of the random rigs on this machine, for example 10min; sets --budget by an estimate
    #[arg(long, value_name = "DURATION", value_parser = duration, conflicts_with = "budget")]
    pub(super) time: Option<f64>,
    /// Print an estimate of the computing time, and do nothing else
    #[arg(long)]
    pub(super) dry_run: bool,
    /// Assumed discrepancy between any rig and any simulator, in margins of equivalence (5 % of a mean, 1 dB); 0 for
    /// simulated runs
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_negative_numbers = true, value_parser = factor)]
    pub(super) discrepancy: f64,
    /// Leave a part of the model out, to measure what it is worth by the self-test: trained_weights, correlations or
    /// emulator_error
    #[arg(long = "ablate", value_name = "PART")]
    pub(super) ablation: Option<Ablation>,
    /// Do not search for the run that separates the most probable effects, which takes up to half of the time of a
    /// further diagnosis on gravel
    #[arg(long)]
    pub(super) without_next_run: bool,
    /// Longest part of a measured run that is compared [s]
    #[arg(long, value_name = "SECONDS", default_value_t = LONGEST, allow_negative_numbers = true, value_parser = super::positive)]
    pub(super) longest: f64,
    /// Seed of the simulations; the same seed gives the same answer
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(super) seed: u64,
    #[command(flatten)]
    pub(super) jobs: Jobs,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel diagnose --measured rig.h5 --scenario single_wheel_st
  lugwheel diagnose --measured rig.h5 --scenario my_rig.toml --without slope --out output/rig
  lugwheel diagnose --measured rig.h5 --scenario single_wheel_st --budget 50000 --json

Written to the folder: diagnosis.html (answer, evidence, figures), diagnosis.json (all numbers), gap_map.svg,
the recalibrated scenario (recalibrated.toml) and, if effects are named, the scenario with them
(with_effect.toml). Simulated rigs are stored in --bank: the same command continues an interrupted diagnosis,
and a diagnosis of other runs at the same conditions takes seconds.";

/// What a diagnosis writes into its folder.
pub(super) const RESULTS: [&str; 5] = [
    "diagnosis.json",
    "gap_map.svg",
    "diagnosis.html",
    "recalibrated.toml",
    "with_effect.toml",
];

/// Shares [-] of the time of a diagnosis that its stages usually take, where it is a stage of another work.
const RIGS: [f64; 2] = [0.0, 0.8];
const VALIDATION: [f64; 2] = [0.8, 1.0];

impl Diagnose {
    /// Diagnoses the runs and prints the result.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        if self.dry_run {
            let progress = Self::progress(output);
            let (scenario, measured) = (self.scenario()?, self.read()?);
            let estimate = self.estimate(&progress, &scenario, &measured)?;
            drop(progress);
            return output.print(&estimate);
        }
        self.claim(output)?;
        let summary = self.investigate(&Self::progress(output))?;
        output.print(&summary)
    }

    /// What the diagnosis would take.
    fn estimate(
        &self,
        progress: &Progress,
        scenario: &Scenario,
        measured: &Measured,
    ) -> anyhow::Result<EstimateSummary> {
        let settings = self.settings(self.budget);
        let version = env!("CARGO_PKG_VERSION");
        // Nothing is left behind.
        let folder = tempfile::tempdir()?;
        let origin = Origin {
            folder: folder.path(),
            ..self.origin(version)
        };
        let investigation = measured.investigation(scenario, &settings, origin)?;
        let estimate = self.with_progress(progress, &investigation, |on_progress| {
            investigation.estimate(on_progress)
        })?;
        let cores = self.jobs.count();
        let rigs = match self.time {
            Some(time) => {
                ((time * cores as f64 / estimate.seconds_per_rig) as usize).max(FEWEST_RIGS)
            }
            None => estimate.rigs,
        };
        Ok(EstimateSummary {
            rigs,
            driving_s: rigs as f64 * estimate.driven_per_rig,
            seconds: rigs as f64 * estimate.seconds_per_rig / cores as f64,
            cores,
        })
    }

    fn scenario(&self) -> anyhow::Result<Scenario> {
        let scenario = documents::read_scenario(&self.scenario)?;
        Ok(scenario.with_all(&self.set)?)
    }

    fn settings(&self, budget: f64) -> Settings {
        Settings {
            longest: self.longest,
            budget,
            without: self.without.clone(),
            seed: Seed(self.seed),
            rates: BaseRates::default(),
            discrepancy: self.discrepancy,
            ablation: self.ablation,
            without_next_run: self.without_next_run,
        }
    }

    /// Claims the folder of results with every file that may be written into it, and that of the bank.
    fn claim(&self, output: &Output) -> anyhow::Result<()> {
        let scenario = documents::scenario(&self.scenario)?;
        let files = [Some(&*self.measured), scenario.file()];
        let inputs: Vec<&Path> = files.into_iter().flatten().collect();
        let claim = output.claim(&inputs);
        claim.folder(&self.out)?;
        claim.files_in(&self.out, RESULTS)?;
        let bank = Claim {
            elsewhere: "name another place with --bank",
            ..claim
        };
        bank.own_folder(&self.bank)
    }

    /// Diagnoses the runs and writes what came of it.
    pub(super) fn investigate(&self, progress: &Progress) -> anyhow::Result<Summary> {
        let (scenario, measured) = (self.scenario()?, self.read()?);
        let budget = match self.time {
            Some(_) => {
                let estimate = self.estimate(progress, &scenario, &measured)?;
                estimate.driving_s.ceil()
            }
            None => self.budget,
        };
        let settings = self.settings(budget);
        let version = env!("CARGO_PKG_VERSION");
        let inputs = Inputs {
            measured: Input::of(&self.measured)?,
            scenario: Input::of_text(&self.scenario, &scenario.to_toml()),
            runs: self.run.clone(),
            without: self.without.clone(),
            seed: self.seed,
            version,
        };
        output::make_folder(&self.out)?;
        let investigation = measured.investigation(&scenario, &settings, self.origin(version))?;
        let (diagnosis, variants) = self.diagnose(progress, &investigation)?;
        let widest = diagnosis.widest(investigation.cases());
        let traces =
            widest.and_then(|case| ArmTraces::of(case, &measured.traces, &variants, settings.seed));
        let page = report::diagnosis_page(&DiagnosisReport {
            diagnosis: &diagnosis,
            measured: &stem(&self.measured),
            name: &stem(&self.scenario),
            scenario: &scenario,
            cases: investigation.cases(),
            traces: traces.as_ref(),
            settings: &settings,
            facts: &inputs.facts(),
            commands: &[self.command(budget)],
        });
        let summary = Summary {
            inputs,
            stages: traces.as_ref().map_or_else(Vec::new, ArmTraces::stages),
            diagnosis,
            answer: page.answer.clone(),
            page: self.out.join("diagnosis.html").display().to_string(),
        };
        let [json, map, html, recalibrated, with_effect_toml] = RESULTS;
        self.write(json, &serde_json::to_string_pretty(&summary)?)?;
        self.write(map, &drawn_map(&summary.diagnosis))?;
        self.write(html, &report::page(&page))?;
        let lugs = investigation.cases()[0].attributes.lug_count;
        let edited = |arm: &Arm| arm.of(&scenario, lugs).ok();
        self.write_or_remove(recalibrated, edited(&variants.recalibrated))?;
        let is_named = !summary.diagnosis.verdict.named.is_empty();
        let with_effect = variants.with_effect.as_ref().filter(|_| is_named);
        self.write_or_remove(with_effect_toml, with_effect.and_then(edited))?;
        Ok(summary)
    }

    fn write(&self, name: &str, content: &str) -> anyhow::Result<()> {
        output::write_file(&self.out.join(name), content)
    }

    /// Writes a scenario that the diagnosis ends with; where there is none, one of an earlier
    /// diagnosis must not stay.
    fn write_or_remove(&self, name: &str, scenario: Option<Scenario>) -> anyhow::Result<()> {
        match scenario {
            Some(scenario) => self.write(name, &scenario.to_toml()),
            None => output::remove_file(&self.out.join(name)),
        }
    }

    /// The command that makes the same diagnosis again.
    pub(super) fn command(&self, budget: f64) -> String {
        let path = |option: &str, path: &Path| format!(" {option} {}", quoted(path));
        let several = |option: &str, values: &[String]| -> String {
            let words = values.iter();
            words.map(|value| path(option, Path::new(value))).collect()
        };
        let ablated = self.ablation.map(|part| format!(" --ablate {part}"));
        let next_run = if self.without_next_run {
            " --without-next-run"
        } else {
            ""
        };
        format!(
            "lugwheel diagnose{}{}{}{}{}{}{} --budget {} --discrepancy {}{}{next_run} --longest {} --seed {}",
            path("--measured", &self.measured),
            path("--scenario", &self.scenario),
            several("--set", &self.set),
            several("--without", &self.without),
            several("--run", &self.run),
            path("--out", &self.out),
            path("--bank", &self.bank),
            budget,
            self.discrepancy,
            ablated.unwrap_or_default(),
            self.longest,
            self.seed
        )
    }

    fn read(&self) -> anyhow::Result<Measured> {
        let file = RunFile::open(&self.measured)?;
        let (mut traces, mut errors) = (Vec::new(), Vec::new());
        for id in super::recognize::chosen(&file, &self.run)? {
            let trace = file.read(&id)?.as_measured();
            errors.extend(inspection::errors(&id, &trace));
            traces.push(trace);
        }
        Ok(Measured {
            traces,
            errors: inspection::in_words(&errors),
        })
    }

    fn origin<'a>(&'a self, version: &'a str) -> Origin<'a> {
        Origin {
            folder: &self.bank,
            version,
            seed: Seed(self.seed),
        }
    }

    fn progress(output: &Output) -> Progress {
        Progress::of_runs(output, "random rigs", 0)
    }

    fn diagnose(
        &self,
        progress: &Progress,
        investigation: &Investigation,
    ) -> anyhow::Result<(Diagnosis, Variants)> {
        self.with_progress(progress, investigation, |on_progress| {
            investigation.run(on_progress)
        })
    }

    /// What comes of an investigation, on the threads asked for, with its progress shown.
    fn with_progress<Found: Send>(
        &self,
        progress: &Progress,
        investigation: &Investigation,
        work: impl FnOnce(OnProgress) -> Result<Found, InvestigationError> + Send,
    ) -> anyhow::Result<Found> {
        // Before the time is spent: another ground or other lugs may be a wrong scenario.
        for caveat in investigation.caveats() {
            progress.warn(caveat);
        }
        let on_progress = |now: diagnosis::Progress| {
            let (stage, part) = match now.stage {
                Stage::Rigs => ("random rigs", RIGS),
                Stage::Validation => ("validation", VALIDATION),
            };
            progress.reach_part(stage, part, now.done, now.total);
            if interrupt::is_requested() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.jobs.count())
            .build()?;
        match pool.install(|| work(&on_progress)) {
            Err(stopped) if stopped.is_stopped() => Err(Interrupted(stopped.to_string()).into()),
            Err(refused) if refused.is_refused() => Err(refused.into()),
            other => other.with_context(|| {
                format!("nothing can be concluded from {}", self.measured.display())
            }),
        }
    }
}

/// The measured runs.
struct Measured {
    traces: Vec<Trace>,
    /// What is wrong with them, as `inspect` finds it.
    errors: Vec<String>,
}

impl Measured {
    fn investigation<'a>(
        &self,
        scenario: &Scenario,
        settings: &'a Settings,
        origin: Origin<'a>,
    ) -> Result<Investigation<'a>, InvestigationError> {
        let errors = self.errors.iter().map(|error| {
            format!("{error}; correct the measured data first: this may be the whole difference")
        });
        let investigation = Investigation::new(&self.traces, scenario, settings, origin)?;
        Ok(investigation.with_caveats(errors.collect()))
    }
}

/// What a diagnosis would take.
#[derive(Debug, Serialize)]
struct EstimateSummary {
    rigs: usize,
    driving_s: f64,
    seconds: f64,
    cores: usize,
}

impl fmt::Display for EstimateSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} random rigs, {:.0} s of driving (--budget): about {:.1} min on {} cores if none is in the cache yet \
             (estimate from one simulation of the scenario)",
            self.rigs,
            self.driving_s,
            self.seconds / 60.0,
            self.cores
        )
    }
}

/// A duration in words [s].
fn duration(text: &str) -> Result<f64, String> {
    let known = text.parse::<jiff::SignedDuration>();
    let known = known.map_err(|_| "give a duration, for example 10min or 1h30min".to_owned())?;
    if known.is_positive() {
        Ok(known.as_secs_f64())
    } else {
        Err("it has to be above 0".to_owned())
    }
}

/// A factor that is not negative.
fn factor(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "give a number".to_owned())?;
    if value >= 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err("it has to be 0 or above".to_owned())
    }
}

/// A file's name without folder and ending.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or(path.as_os_str());
    stem.to_string_lossy().into_owned()
}

fn drawn_map(diagnosis: &Diagnosis) -> String {
    let map = GapMap {
        global: diagnosis.global.clone(),
        entries: diagnosis.map.clone(),
        caveats: Vec::new(),
    };
    report::gap_map(&map, "Measured against the nominal scenario")
}
