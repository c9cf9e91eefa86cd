//! `diagnose`: where measured runs and a scenario differ, and which effect causes it.

pub(super) mod summary;

use super::interrupt::{self, Interrupted};
use super::output::{self, Output};
use super::progress::Progress;
use super::provenance::quoted;
use super::scenario_args;
use super::series::Jobs;
use super::target::Claim;
use anyhow::Context;
use clap::Args;
use lugwheel::dataset::hdf5::RunFile;
use lugwheel::diagnosis::arm::Arm;
use lugwheel::diagnosis::bank::BankError;
use lugwheel::diagnosis::condition::LONGEST;
use lugwheel::diagnosis::{
    Ablation, ArmTraces, Arms, BUDGET, Calibration, Diagnosis, Investigation, InvestigationError,
    Settings, bank,
};
use lugwheel::gap::GapMap;
use lugwheel::quantity::Seed;
use lugwheel::report::{self, ToldDiagnosis};
use lugwheel::scenario::Scenario;
use lugwheel::trace::Trace;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use summary::{Input, Inputs, Summary};

/// Tell where measured runs and a scenario differ, which missing effect causes it, and how far
/// adding it closes the gap
///
/// Every measured condition is repeated by the simulator as the scenario has it, with its
/// parameters off, and with each effect of `lugwheel effects` that can be there. What recalibrated
/// parameters leave is weighed on conditions that the fit has not seen. Answers: none, parameter,
/// effect, effects, unknown (and where), undecided (and which run would decide).
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Diagnose {
    /// Run file of the measurements; repeats and several conditions make the answer sure
    #[arg(long, value_name = "FILE.h5")]
    pub(super) measured: PathBuf,
    /// Scenario file of the rig, or the name of one in scenarios/; load, speed and slip are taken
    /// from the measured runs
    #[arg(long, value_name = "SCENARIO")]
    pub(super) scenario: PathBuf,
    /// Set a key of the scenario, in SI units, for example wheel.lugs.count=0
    #[arg(long, value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// An effect held to be impossible, with or without its channel; may be given several times
    #[arg(long, value_name = "EFFECT")]
    pub(super) without: Vec<String>,
    /// Only this measured run; may be given several times
    #[arg(long, value_name = "ID")]
    pub(super) run: Vec<String>,
    /// Folder of the results
    #[arg(long, value_name = "DIR", default_value = "output/diagnosis")]
    pub(super) out: PathBuf,
    /// Folder in which simulated statistics are kept for this diagnosis and the next
    #[arg(long, value_name = "DIR", default_value = "output/bank")]
    pub(super) bank: PathBuf,
    /// Driving that may be simulated [s]: more replicates, surer answers
    #[arg(long, value_name = "SECONDS", default_value_t = BUDGET, value_parser = super::positive)]
    pub(super) budget: f64,
    /// Longest part of a measured run that is compared [s]
    #[arg(long, value_name = "SECONDS", default_value_t = LONGEST, value_parser = super::positive)]
    pub(super) longest: f64,
    /// Seed of the simulations; the same seed gives the same answer
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(super) seed: u64,
    /// A part of the method to do without, to see what it is worth: recalibration, held-out or
    /// forest
    #[arg(long, value_name = "PART", hide_short_help = true)]
    pub(super) ablate: Option<Ablation>,
    #[command(flatten)]
    pub(super) jobs: Jobs,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel diagnose --measured rig.h5 --scenario single_wheel_st
  lugwheel diagnose --measured rig.h5 --scenario my_rig.toml --without slope --out output/rig
  lugwheel diagnose --measured rig.h5 --scenario single_wheel_st --budget 50000 --json

The folder holds diagnosis.html (the answer, what it rests on, figures), diagnosis.json (all numbers),
gap_map.svg, the scenario recalibrated (recalibrated.toml) and, where effects are named, with them
(with_effect.toml). Simulated statistics are kept in --bank: a stopped diagnosis goes on with the same
command, and one of other runs at the same conditions takes a minute.";

/// What a diagnosis writes into its folder.
pub(super) const RESULTS: [&str; 5] = [
    "diagnosis.json",
    "gap_map.svg",
    "diagnosis.html",
    "recalibrated.toml",
    "with_effect.toml",
];

impl Diagnose {
    /// Diagnoses the runs and says what came of it.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        self.claim(output)?;
        output.print(&self.investigate(output)?)
    }

    /// Claims the folder of results with every file that may be written into it, and that of the bank.
    fn claim(&self, output: &Output) -> anyhow::Result<()> {
        let scenario = scenario_args::found(&self.scenario)?;
        let inputs: [&Path; 2] = [&self.measured, &scenario];
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
    pub(super) fn investigate(&self, output: &Output) -> anyhow::Result<Summary> {
        let scenario = scenario_args::read(&self.scenario)?;
        let scenario = scenario.with_all(&self.set)?;
        let measured = self.read()?;
        let settings = Settings {
            longest: self.longest,
            budget: self.budget,
            without: self.without.clone(),
            seed: Seed(self.seed),
            calibration: Calibration::default(),
            ablation: self.ablate,
        };
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
        let investigation =
            Investigation::new(&measured, &scenario, &settings, (&self.bank, version))?;
        let (diagnosis, arms) = self.diagnose(output, &investigation)?;
        let widest = diagnosis.widest(investigation.cases());
        let traces = widest.and_then(|case| ArmTraces::of(case, &measured, &arms, settings.seed));
        let page = report::diagnosis_page(&ToldDiagnosis {
            diagnosis: &diagnosis,
            measured: &stem(&self.measured),
            name: &stem(&self.scenario),
            scenario: &scenario,
            cases: investigation.cases(),
            traces: traces.as_ref(),
            settings: &settings,
            facts: &inputs.facts(),
            commands: &[self.command()],
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
        self.write_or_remove(recalibrated, edited(&arms.recalibrated))?;
        let is_named = !summary.diagnosis.verdict.named.is_empty();
        let with_effect = arms.with_effect.as_ref().filter(|_| is_named);
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
    pub(super) fn command(&self) -> String {
        let path = |option: &str, path: &Path| format!(" {option} {}", quoted(path));
        let several = |option: &str, values: &[String]| -> String {
            let words = values.iter();
            words.map(|value| path(option, Path::new(value))).collect()
        };
        format!(
            "lugwheel diagnose{}{}{}{}{}{}{}{} --budget {} --longest {} --seed {}",
            path("--measured", &self.measured),
            path("--scenario", &self.scenario),
            several("--set", &self.set),
            several("--without", &self.without),
            several("--run", &self.run),
            path("--out", &self.out),
            path("--bank", &self.bank),
            self.ablate
                .map_or_else(String::new, |part| format!(" --ablate {part}")),
            self.budget,
            self.longest,
            self.seed
        )
    }

    fn read(&self) -> anyhow::Result<Vec<Trace>> {
        let file = RunFile::open(&self.measured)?;
        let chosen = super::recognize::chosen(&file, &self.run)?;
        let traces = chosen.iter().map(|id| Ok(file.read(id)?.as_measured()));
        traces.collect()
    }

    fn diagnose(
        &self,
        output: &Output,
        investigation: &Investigation,
    ) -> anyhow::Result<(Diagnosis, Arms)> {
        let progress = Progress::of_runs(output, "simulating", 0);
        // Before the time is spent: another ground or other lugs may be a wrong scenario.
        for caveat in investigation.caveats() {
            progress.warn(caveat);
        }
        let hear = |now: bank::Progress| {
            progress.reach(now.motions, now.motions_total);
            match interrupt::is_requested() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.jobs.count())
            .build()?;
        match pool.install(|| investigation.run(&hear)) {
            Err(InvestigationError::Bank(stopped @ BankError::Stopped { .. })) => {
                Err(Interrupted(stopped.to_string()).into())
            }
            Err(InvestigationError::Bank(refused @ BankError::File { .. })) => Err(refused.into()),
            other => other.with_context(|| {
                format!("nothing can be concluded from {}", self.measured.display())
            }),
        }
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
    report::gap_map(&map, "Measured against the scenario as shipped")
}
