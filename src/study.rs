//! Monte Carlo studies: scenarios, swept keys and repeats as one file; its runs in one table.
//!
//! ```toml
//! version = 1
//! title = "Speed"                                           # of the report, if any
//! question = "What does speed do to vibration and loads?"   # that it answers, if any
//! scenarios = ["../my_rig.toml", "single_wheel_st"]  # files relative to this one; ready scenarios by name
//! seed = 1
//! repeats = 4                  # runs per condition
//! random_numbers = "common"    # or "independent"
//!
//! [set]                        # in every run
//! duration = 20.0
//!
//! [[sweep]]
//! key = "rig.single_wheel.forward_speed"
//! grid = { from = 0.003, to = 0.05, count = 5, spacing = "logarithmic" }
//!
//! [[sweep]]                    # crossed with the sweep above; its own keys change together
//! keys = ["rig.single_wheel.slip", "rig.single_wheel.load"]
//! rows = [[0.1, 100.0], [0.3, 60.0]]
//!
//! [[sweep]]                    # drawn together from the study's seed, and crossed like the others
//! count = 20
//! sampling = "latin_hypercube" # every twentieth of each distribution once; or "random"
//! [sweep.distributions]
//! wheel.mass = { normal = { mean = 4.0, sd = 0.2 } }
//! rig.single_wheel.moving_mass = { uniform = { from = 10.0, to = 15.0 } }
//! ```
//!
//! Distributions are `uniform` and `log_uniform` (`from`, `to`), `normal` (`mean`, `sd`), `log_normal`
//! (`median`, `factor`: 68 % lie within that factor), `triangular` (`from`, `mode`, `to`) and `one_of`
//! (a list). Which values are drawn depends on seed, key and number of the draw only, so every shard
//! of a study draws the same values.
//!
//! A *condition* is a scenario with one entry of every sweep. Runs are numbered from 0, scenario by scenario,
//! the last sweep changing fastest, with the repeats of a condition together. All randomness of a run comes
//! from the study's seed and the run's *stream*:
//!
//! - `common`: repeat `k` of every condition draws from stream `k`. Conditions then have the same ground and
//!   noise (common random numbers), so that their differences scatter less than their values.
//! - `independent`: run `n` draws from stream `n`. No two runs share random numbers.
//!
//! Either way a run is bit-identical alone, in the study, and on any thread.
//!
//! With a table `[recognition]` the class of every window is recognised and scored, see [`score`]:
//!
//! ```toml
//! [recognition]
//! methods = ["paper", "improved"]             # both if left out
//! reference = "../single_wheel_ref.toml"      # features over its runs, at each run's condition
//! settings = { bandwidth = 100.0 }            # see `features::Settings`
//! baseline = { key = "rig.single_wheel.forward_speed" }  # a trained classifier, new to a speed
//! [recognition.published]                     # counts to compare with, by true class
//! ALCT = [58, 0, 0, 2]                        # answers ALCT, SLCT, LEIS, UWTIC
//! SLCT = [0, 118, 0, 2]
//! LEIS = [0, 0, 116, 4]
//! ```
//!
//! Without `reference` the features are relative to the computed reference, passed through the sensors of the
//! run. The windows are those of the scenario, unless `settings` has a `window`.
//!
//! With a table `[thresholds]` every window is compared with the limits of Eq. (55) to (58), see
//! [`thresholds`]:
//!
//! ```toml
//! [thresholds]
//! bandwidths = [20.0, 100.0]   # Hz, of the acceleration
//! ```
//!
//! With a table `[identification]` terrain parameters are found from the steady loads, see
//! [`identification`]:
//!
//! ```toml
//! [identification]
//! over = ["rig.single_wheel.slip"]    # a fit joins runs that differ in these; the slip if left out
//! from = { "rig.single_wheel.forward_speed" = 0.01 }  # its parameters predict the other speeds
//! cylinder = "rim"                    # or "lug_tips": what stands for the lugged wheel
//! exit_angle = 0.0                    # c_3, stated, not fitted
//! [identification.published]          # errors [%] of pull, load and torque (Table 7)
//! ALCT = [15.2, 11.68, 15.52]
//! SLCT = [11.85, 6.67, 8.46]
//! LEIS = [8.11, 7.64, 7.75]
//! ```
//!
//! With a table `[diagnosis]` the runs are diagnosed as campaigns of a rig, each compared with a scenario,
//! see [`diagnosis`]:
//!
//! ```toml
//! [diagnosis]
//! scenario = "../single_wheel_st.toml"  # the scenario compared with; by default their own without effects
//! over = ["rig.single_wheel.slip"]      # a campaign joins runs that differ in these; default: the slip
//! budget = 20000.0                      # s of driving that may be simulated for each
//! without = ["slope"]                   # effects to exclude
//! ```
//!
//! The magnitude of an effect is swept like any other key, by its name:
//!
//! ```toml
//! [[sweep]]
//! key = "effect.gain_error.drawbar_pull"
//! values = [0.0, 0.02, 0.05]
//! ```
//!
//! With a table `[dataset]` the runs become one data set for machine learning, see
//! [`learning`](crate::learning). Whatever their number, memory contains one per thread:
//!
//! ```toml
//! [dataset]
//! keep = "traces"      # the channels too, some 30 kB a second of run; or "features" of windows only
//! ```
//!
//! Results go to one folder ([`Study::execute`]):
//!
//! ```text
//! runs.csv       one row a run: condition, label, class, steady values; see `study::runs`
//! runs.h5        the same table as HDF5, a dataset a column; see `dataset::hdf5::write_table`
//! windows.csv    one row a window: truth, features, answers; see `study::windows`
//! recognition.csv    answers and shares by method, scenario and swept key
//! thresholds.csv one row a window: what (55) to (58) bound; see `study::thresholds`
//! steady.csv     one row a steady interval: loads, slip, sinkage; see `study::identification`
//! identification.csv    parameters, force errors, what they predict
//! diagnosis.csv  the diagnosis of every campaign; see `study::diagnosis`
//! dataset.h5, dataset.windows.csv, dataset.splits.csv, dataset.datasheet.md, dataset.croissant.json
//!                the runs or the features of their windows for machine learning; see `learning`
//! timing.csv     seconds of computing per run: the one file that differs between executions
//! failed.txt     runs that failed and why; absent where none did
//! study.toml     the study as it was read; scenarios/, reference.toml and held_against.toml (the
//!                scenario of [diagnosis]) as they were
//! origin.txt     program version, commit it was built from if known at build time
//!                (`LUGWHEEL_COMMIT`), seed, fingerprint of all that decides the results
//! shards/        blocks of consecutive runs, each with its checksum, from which an interrupted
//!                study goes on
//! bank/          cache of simulated statistics shared by the diagnoses; diagnoses/ their results: from
//!                both an interrupted study continues
//! slurm/         logs of the jobs of a cluster, see `study::slurm`
//! ```
//!
//! The program adds the page and its figures, and the tables of the page as text: `recognition.txt`, `thresholds.txt`,
//! `identification.txt`, `diagnosis.txt`.

mod analysis;
mod cells;
pub mod conditions;
pub mod diagnosis;
mod execution;
mod folder;
mod group;
pub mod identification;
mod kept;
mod progress;
mod recognition;
mod references;
pub mod results;
pub mod runs;
pub mod score;
pub mod scores;
mod shard;
pub mod slurm;
mod sweep;
mod table;
pub mod thresholds;
mod traces;
pub mod windows;

pub use execution::{Failure, Options, Outcome};
pub use progress::{Diagnosing, Progress};
pub use scores::Scores;

use crate::dataset::hdf5::RunFileError;
use crate::diagnosis::InvestigationError;
use crate::document::{Document, Fault, Misfit, check_version};
use crate::quantity::{RangeError, Seed, hexadecimal};
use crate::recognition::baseline::BaselineError;
use crate::scenario::experiment::ExperimentError;
use crate::scenario::ready::{self, ReadyDocument};
use crate::scenario::{Scenario, ScenarioError};
use crate::trace::Trace;
use crate::whole_file;
use diagnosis::DiagnosisTable;
use identification::IdentificationTable;
use kept::Dataset;
use recognition::RecognitionTable;
use scores::{Analyses, Plans};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use slurm::SlurmError;
use std::collections::HashSet;
use std::io;
use std::ops::{ControlFlow, Range};
use std::path::{Path, PathBuf};
pub use sweep::Axis;
use sweep::{Sweep, SweepTable};
use thresholds::ThresholdsTable;

/// The version of study files that this program reads.
const VERSION: i64 = 1;

/// Most runs of a study: all conditions are checked before the first run, some 0.1 ms each.
const MOST_RUNS: u64 = 100_000;

/// Where the runs of a study get their random numbers from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RandomNumbers {
    /// The same for the same repeat of every condition.
    Common,
    /// Different for every run.
    Independent,
}

/// A study: which runs, and where their randomness comes from.
#[derive(Debug, Clone)]
pub struct Study {
    /// Where all randomness comes from.
    pub seed: Seed,
    /// Title of its report; empty if not stated.
    pub title: String,
    /// The question it answers; empty if not stated.
    pub question: String,
    repeats: u32,
    random_numbers: RandomNumbers,
    scenarios: Vec<Named>,
    settings: Vec<String>,
    sweeps: Vec<Sweep>,
    analyses: Analyses,
    /// Name of the study's file, without folders.
    file: String,
    text: String,
}

/// A scenario of a study, by the name of its file without the ending.
#[derive(Debug, Clone)]
struct Named {
    name: String,
    scenario: Scenario,
}

/// One run of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// Number in the study, from 0.
    pub number: u64,
    /// Number of its condition, from 0.
    pub condition: u64,
    /// Which repeat of its condition, from 0.
    pub repeat: u32,
    /// The stream of random numbers it draws from.
    pub stream: u64,
}

/// A study file before its checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyTable {
    #[serde(rename = "version")]
    _version: i64,
    #[serde(default)]
    title: String,
    #[serde(default)]
    question: String,
    scenarios: Vec<PathBuf>,
    seed: u64,
    repeats: u32,
    random_numbers: RandomNumbers,
    #[serde(default)]
    set: toml::Table,
    #[serde(default)]
    sweep: Vec<SweepTable>,
    recognition: Option<RecognitionTable>,
    thresholds: Option<ThresholdsTable>,
    identification: Option<IdentificationTable>,
    diagnosis: Option<DiagnosisTable>,
    dataset: Option<Dataset>,
}

impl Study {
    /// Reads a study file and its scenarios, and checks every condition.
    ///
    /// # Errors
    /// `StudyError::Unreadable` where there is no such text file; `StudyError::Invalid` points at
    /// the line of the first fault: text that is not TOML, unknown or missing keys, scenarios that
    /// cannot be read, and conditions that are no scenario.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, StudyError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| StudyError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut study = read(&text, ScenarioFolder::Disk(folder))
            .map_err(|misfit| Fault::new(&path.display().to_string(), &text, misfit))?;
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        study.file = file.into_owned();
        Ok(study)
    }

    /// A study that is part of the program, with scenarios that are too.
    ///
    /// # Errors
    /// As [`Study::load`]; never for one of [`ready::studies`].
    pub fn ready(document: &ReadyDocument) -> Result<Self, StudyError> {
        let file = format!("{}.toml", document.name);
        let mut study = read(document.text, ScenarioFolder::Program)
            .map_err(|misfit| Fault::new(&file, document.text, misfit))?;
        study.file = file;
        Ok(study)
    }

    /// Every run, in order of its number.
    pub fn runs(&self) -> impl Iterator<Item = Run> + use<> {
        self.runs_in(0..self.run_count())
    }

    /// The runs with these numbers.
    fn runs_in(&self, numbers: Range<u64>) -> impl Iterator<Item = Run> + use<> {
        let Self {
            repeats,
            random_numbers,
            ..
        } = *self;
        numbers.map(move |number| Run {
            number,
            condition: number / u64::from(repeats),
            repeat: (number % u64::from(repeats)) as u32,
            stream: match random_numbers {
                RandomNumbers::Common => number % u64::from(repeats),
                RandomNumbers::Independent => number,
            },
        })
    }

    /// Number of runs: scenarios x entries of each sweep x repeats.
    pub fn run_count(&self) -> u64 {
        self.condition_count() * u64::from(self.repeats)
    }

    /// Time \[s\] simulated in all runs.
    pub fn simulated(&self) -> f64 {
        let conditions = 0..self.condition_count();
        let durations = conditions.map(|condition| self.scenario_of(condition).duration);
        durations.sum::<f64>() * f64::from(self.repeats)
    }

    fn condition_count(&self) -> u64 {
        self.scenarios.len() as u64 * self.combinations()
    }

    /// Combinations of the sweeps' entries.
    fn combinations(&self) -> u64 {
        self.sweeps.iter().map(|sweep| sweep.len() as u64).product()
    }

    /// The experiment of a run.
    pub fn scenario(&self, run: &Run) -> Scenario {
        self.scenario_of(run.condition)
    }

    fn scenario_of(&self, condition: u64) -> Scenario {
        let (named, entries) = self.condition(condition);
        let edited = named.scenario.with_all(&self.assignments(&entries));
        edited.expect("every condition was checked when the study was read")
    }

    /// Runs one run, as [`Scenario::run`] does.
    ///
    /// # Errors
    /// Those of [`Scenario::run`].
    pub fn run(
        &self,
        run: &Run,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Trace, ExperimentError> {
        let mut trace = self.scenario(run).run(self.seed, run.stream, progress)?;
        trace.attributes.repeat = run.repeat;
        Ok(trace)
    }

    /// The file's text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Name and text of every scenario, those of the reference runs and of the diagnosis last.
    pub fn scenario_texts(&self) -> impl Iterator<Item = (&str, &str)> {
        let scenarios = self.scenarios.iter();
        let scenarios = scenarios.map(|named| (named.name.as_str(), named.scenario.text()));
        scenarios.chain(self.analyses.scenarios())
    }

    /// Runs of each condition.
    pub fn repeats(&self) -> u32 {
        self.repeats
    }

    /// The first run of every scenario.
    pub fn first_runs(&self) -> impl Iterator<Item = (&str, Run)> {
        let each = self.combinations() * u64::from(self.repeats);
        let scenarios = self.scenarios.iter().zip(0..);
        scenarios.filter_map(move |(named, number): (_, u64)| {
            let run = self.runs_in(number * each..number * each + 1).next()?;
            Some((named.name.as_str(), run))
        })
    }

    /// The sweeps, in the order of the file.
    pub fn axes(&self) -> Vec<Axis> {
        self.sweeps.iter().map(Axis::from).collect()
    }

    /// The swept keys, in the order of the file.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        let keys = self.sweeps.iter().flat_map(|sweep| &sweep.keys);
        keys.map(String::as_str)
    }

    /// The values of a swept key, as TOML.
    fn values_of(&self, key: &str) -> Option<impl Iterator<Item = &str>> {
        let place = |sweep: &Sweep| sweep.keys.iter().position(|swept| swept == key);
        let found = self
            .sweeps
            .iter()
            .find_map(|sweep| Some((sweep, place(sweep)?)));
        let (sweep, column) = found?;
        Some(sweep.rows.iter().map(move |row| row[column].as_str()))
    }

    /// The values of the swept keys in a run, as TOML, in the order of [`Study::keys`].
    fn values(&self, run: &Run) -> impl Iterator<Item = &str> {
        let (_, entries) = self.condition(run.condition);
        let rows = self.sweeps.iter().zip(entries);
        rows.flat_map(|(sweep, entry)| &sweep.rows[entry])
            .map(String::as_str)
    }

    /// The scenario of a run, and the values of its swept keys as TOML.
    fn condition_of(&self, run: &Run) -> String {
        let values = self.keys().zip(self.values(run));
        let values = values.map(|(key, value)| format!(", {key} = {value}"));
        self.scenario_name(run).to_owned() + &values.collect::<String>()
    }

    /// Name of the scenario of a run: its file without the ending.
    fn scenario_name(&self, run: &Run) -> &str {
        &self.condition(run.condition).0.name
    }

    /// The scenario of a condition, and its entry of each sweep; the last sweep changes fastest.
    fn condition(&self, number: u64) -> (&Named, Vec<usize>) {
        let combinations = self.combinations();
        let mut rest = number % combinations;
        let mut entries: Vec<usize> = self
            .sweeps
            .iter()
            .rev()
            .map(|sweep| {
                let entry = rest % sweep.len() as u64;
                rest /= sweep.len() as u64;
                entry as usize
            })
            .collect();
        entries.reverse();
        (&self.scenarios[(number / combinations) as usize], entries)
    }

    /// Every `key=value` of the condition with these `entries` of the sweeps.
    fn assignments(&self, entries: &[usize]) -> Vec<String> {
        let swept = self.sweeps.iter().zip(entries);
        let swept = swept.flat_map(|(sweep, entry)| sweep.assignments(*entry));
        self.settings.iter().cloned().chain(swept).collect()
    }

    /// A hash of all that decides the results: program version, seed, study and scenarios.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        let seed = self.seed.0.to_string();
        let scenarios = self.scenarios.iter();
        let parts = [VERSION_OF_PROGRAM, &seed, &self.text]
            .into_iter()
            .chain(scenarios.flat_map(|named| [named.name.as_str(), named.scenario.text()]))
            .chain(self.analyses.scenarios().map(|(_, text)| text));
        for part in parts {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        hexadecimal(&hash.finalize())
    }

    /// Checks every condition.
    fn check(&self, document: &Document) -> Result<(), Misfit> {
        for number in 0..self.condition_count() {
            let (named, entries) = self.condition(number);
            let assignments = self.assignments(&entries);
            let Err(error) = named.scenario.with_all(&assignments) else {
                continue;
            };
            return Err(Misfit {
                place: document.place(&self.culprit(named, &entries)),
                message: in_one_line(&error),
            });
        }
        Ok(())
    }

    /// Key of the study file to blame for an unsound condition: the first whose value is no good
    /// alone, or else the last, which does not go with the others.
    fn culprit(&self, named: &Named, entries: &[usize]) -> String {
        let settings = self.settings.iter().map(|assignment| {
            let key = assignment.split('=').next().unwrap_or_default();
            (format!("set.{key}"), vec![assignment.clone()])
        });
        let swept = self.sweeps.iter().zip(entries).enumerate();
        let swept = swept.map(|(index, (sweep, entry))| {
            let place = format!("sweep.{index}.{}", sweep.place(*entry));
            (place, sweep.assignments(*entry))
        });
        let mut last = String::new();
        for (place, assignments) in settings.chain(swept) {
            if named.scenario.with_all(&assignments).is_err() {
                return place;
            }
            last = place;
        }
        last
    }
}

/// The program whose results these are.
const VERSION_OF_PROGRAM: &str = concat!("lugwheel ", env!("CARGO_PKG_VERSION"));

/// A scenario's fault without the excerpt of its text, which an edit may have made.
fn in_one_line(error: &ScenarioError) -> String {
    match error {
        ScenarioError::Invalid(fault) => format!("{}: {}", fault.file, fault.message),
        other => other.to_string(),
    }
}

fn read(text: &str, folder: ScenarioFolder) -> Result<Study, Misfit> {
    let document = Document::parse(text)?;
    check_version(&document, "study", VERSION)?;
    let mut table: StudyTable = document.read()?;
    let plans = Plans::take(&mut table);
    let mut study = table.into_study(&document, text, folder)?;
    study.check(&document)?;
    study.analyses = plans.read(&Reading {
        study: &study,
        document: &document,
        folder,
    })?;
    Ok(study)
}

impl StudyTable {
    fn into_study(
        self,
        document: &Document,
        text: &str,
        folder: ScenarioFolder,
    ) -> Result<Study, Misfit> {
        let at = |wrong: Wrong| Misfit {
            place: document.place(&wrong.0),
            message: wrong.1,
        };
        let scenarios = load_scenarios(&self.scenarios, folder).map_err(at)?;
        let sweeps = sweep::read_all(self.sweep, Seed(self.seed)).map_err(at)?;
        let mut settings = Vec::new();
        flatten("", &self.set, &mut settings);
        check_once(&settings, &sweeps).map_err(at)?;
        let study = Study {
            seed: Seed(self.seed),
            title: self.title,
            question: self.question,
            repeats: self.repeats,
            random_numbers: self.random_numbers,
            scenarios,
            settings: settings
                .into_iter()
                .map(|(key, value)| format!("{key}={value}"))
                .collect(),
            sweeps,
            analyses: Analyses::default(),
            file: String::new(),
            text: text.to_owned(),
        };
        study
            .check_size()
            .map_err(|error| at(("repeats".to_owned(), error.to_string())))?;
        Ok(study)
    }
}

impl Study {
    fn check_size(&self) -> Result<(), RangeError> {
        RangeError::check("repeats", "-", f64::from(self.repeats), [1.0, 1.0e5])?;
        // In floating point, where nothing overflows.
        let entries = self.sweeps.iter().map(|sweep| sweep.len() as f64);
        let conditions = self.scenarios.len() as f64 * entries.product::<f64>();
        let runs = conditions * f64::from(self.repeats);
        if runs <= MOST_RUNS as f64 {
            return Ok(());
        }
        Err(RangeError {
            quantity: "number of runs",
            unit: "-",
            range: format!(
                "{MOST_RUNS} or less ({conditions} conditions x {} repeats); split the study",
                self.repeats
            ),
            value: runs,
        })
    }
}

/// A key of a study file, and what is wrong with it.
type Wrong = (String, String);

fn load_scenarios(paths: &[PathBuf], folder: ScenarioFolder) -> Result<Vec<Named>, Wrong> {
    if paths.is_empty() {
        let message = "a study needs a scenario; name one or more files".to_owned();
        return Err(("scenarios".to_owned(), message));
    }
    let mut names = HashSet::new();
    let load = |(index, path): (usize, &PathBuf)| {
        let wrong = |message: String| (format!("scenarios.{index}"), message);
        let scenario = folder.scenario(path).map_err(wrong)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        if !names.insert(name.to_string()) {
            return Err(wrong(format!(
                "a second scenario is named `{name}`; the table identifies them by file name, so rename one"
            )));
        }
        let name = name.into_owned();
        Ok(Named { name, scenario })
    };
    paths.iter().enumerate().map(load).collect()
}

/// Where the paths of a study lead.
#[derive(Debug, Clone, Copy)]
enum ScenarioFolder<'f> {
    /// To files, from the study's folder; to ready scenarios where there is no file.
    Disk(&'f Path),
    /// To ready scenarios only.
    Program,
}

impl ScenarioFolder<'_> {
    /// The scenario at a path of the study, or why there is none.
    fn scenario(self, path: &Path) -> Result<Scenario, String> {
        let file = match self {
            Self::Disk(folder) => folder.join(path),
            Self::Program => path.to_owned(),
        };
        let is_file = matches!(self, Self::Disk(_)) && file.exists();
        let loaded = match ready::scenario_at(path) {
            Some(document) if !is_file => Scenario::ready(document),
            _ => Scenario::load(&file),
        };
        loaded.map_err(|error| match &error {
            ScenarioError::Unreadable { source, .. } => {
                format!("{error}: {source}; paths are relative to the study file")
            }
            ScenarioError::Invalid(fault) => {
                format!("{}:{}: {}", fault.file, fault.line, fault.message)
            }
            other => other.to_string(),
        })
    }
}

/// The file of a study that is sound without its analyses.
struct Reading<'r> {
    study: &'r Study,
    document: &'r Document<'r>,
    folder: ScenarioFolder<'r>,
}

impl Reading<'_> {
    /// Makes an error of what is wrong with a key.
    fn at<E: ToString>(&self, key: &str) -> impl FnOnce(E) -> Misfit + use<E> {
        let place = self.document.place(key);
        move |error| Misfit {
            place,
            message: error.to_string(),
        }
    }
}

/// Every value of a table under its dotted key, as TOML.
fn flatten(prefix: &str, table: &toml::Table, into: &mut Vec<(String, String)>) {
    for (key, value) in table {
        let path = match prefix {
            "" => key.clone(),
            prefix => format!("{prefix}.{key}"),
        };
        match value {
            toml::Value::Table(inner) => flatten(&path, inner, into),
            value => into.push((path, value.to_string())),
        }
    }
}

/// Refuses a key that is set or swept twice.
fn check_once(settings: &[(String, String)], sweeps: &[Sweep]) -> Result<(), Wrong> {
    let mut taken: HashSet<&str> = settings.iter().map(|(key, _)| key.as_str()).collect();
    for (index, sweep) in sweeps.iter().enumerate() {
        for key in &sweep.keys {
            if !taken.insert(key) {
                let message =
                    format!("`{key}` is set or swept twice, and one value would hide the other");
                return Err((format!("sweep.{index}.{}", sweep.key_place()), message));
            }
        }
    }
    Ok(())
}

/// What to do about a file that was refused, and what a failed write means for the study.
fn way_on(action: &str, refusal: &io::Error) -> String {
    let elsewhere = "name another folder (--out)";
    let way_out = || whole_file::way_out(&whole_file::reason(refusal), elsewhere);
    match action {
        "read" => String::new(),
        "write" => format!(
            "; {}; what is whole stays, and --resume goes on from it",
            way_out()
        ),
        _ => format!("; {}", way_out()),
    }
}

/// Why a study is none, or was not finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The file cannot be read.
    #[error("cannot read study {}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The text is no study.
    #[error(transparent)]
    Invalid(#[from] Fault),
    /// A value of the options has no meaning.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The output folder is not empty.
    #[error("{} is not empty; continue it (--resume) or name another folder (--out)", folder.display())]
    NotEmpty {
        /// The folder.
        folder: PathBuf,
    },
    /// The output folder contains the results of another study.
    #[error(
        "{} does not belong to this study as it is now: its file, a scenario, the seed or the program changed; name another folder (--out)", folder.display()
    )]
    OtherStudy {
        /// The folder.
        folder: PathBuf,
    },
    /// The file system refused.
    #[error("cannot {action} {}: {}{}", path.display(), whole_file::reason(source), way_on(action, source))]
    File {
        /// `read`, `write` or `make the folder`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// Shards are missing or damaged.
    #[error(
        "{missing} shards of runs in {} are missing or damaged; --resume does them", folder.display()
    )]
    Incomplete {
        /// The folder.
        folder: PathBuf,
        /// How many.
        missing: usize,
    },
    /// The cluster did not do it.
    #[error(transparent)]
    Slurm(#[from] SlurmError),
    /// The threads cannot be had.
    #[error("cannot start {jobs} threads; request fewer (--jobs)")]
    Threads {
        /// Number requested; 0 for one per core.
        jobs: usize,
        /// Why.
        source: rayon::ThreadPoolBuildError,
    },
    /// The data set cannot be stored.
    #[error("the data set cannot be stored: {0}")]
    Dataset(#[from] RunFileError),
    /// Simulations for a diagnosis cannot be stored.
    #[error("the runs cannot be diagnosed: {0}")]
    Diagnosis(#[from] InvestigationError),
    /// The windows of the runs train no classifier.
    #[error("the baseline of [recognition] cannot be trained on the windows of the runs")]
    Baseline(#[from] BaselineError),
    /// The caller stopped it.
    #[error(
        "stopped; {whole} of {shards} shards of runs are whole, and --resume goes on from them"
    )]
    Stopped {
        /// Shards on disk.
        whole: usize,
        /// Number of shards requested.
        shards: usize,
    },
    /// The caller stopped it when all runs were done.
    #[error(
        "stopped; all runs are done, {answered} of {campaigns} campaigns are diagnosed, and --resume goes on from them"
    )]
    StoppedDiagnosing {
        /// Campaigns with an answer.
        answered: usize,
        /// Campaigns.
        campaigns: usize,
    },
}
