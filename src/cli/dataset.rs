//! `dataset`: many runs of one scenario, with their labels and ground truth.

mod parts;

use super::interrupt::{self, Interrupted};
use super::output::{self, Output};
use super::progress::Progress;
use super::scenario_args::ScenarioArgs;
use super::series::{Jobs, Outcome, Series, spreads};
use super::steady::{QUANTITIES, Spread};
use crate::dataset::Provenance;
use crate::dataset::hdf5::{RunFileWriter, write_table};
use crate::dataset::records::Records;
use crate::features::{Settings, Window};
use crate::learning::windows::Windower;
use crate::learning::{ChannelFact, DataSet, Facts, FileFact, Kept, run_fields, run_id, windows};
use crate::scenario::Scenario;
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::Trace;
use clap::Args;
use parts::{Before, Part, Parts, RunFacts};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// Simulate a labelled data set
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Dataset {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Number of runs, each with other random ground and noise
    #[arg(long, default_value_t = 10, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=999_999))]
    runs: u64,
    /// Run file to write [default: output/<scenario>/runs.h5]
    #[arg(long, value_name = "FILE.h5")]
    out: Option<PathBuf>,
    /// Store the samples at the sensor rate [128 kHz] too, about 0.9 MB per second
    #[arg(long, conflicts_with = "features")]
    raw: bool,
    /// Store class and features of every window instead of the samples, about 0.5 kB per window
    #[arg(long)]
    features: bool,
    /// Continue from the runs of an interrupted data set of the same name
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    jobs: Jobs,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel dataset single_wheel_ht --runs 50
  lugwheel dataset single_wheel_st --runs 20 --set rig.single_wheel.slip=0.3 --out slip_03.h5
  lugwheel dataset single_wheel_gt --runs 1000 --features

Also written: runs.windows.csv (class and features of every window), runs.splits.csv (splits for training and
testing that share no ground), runs.datasheet.md and runs.croissant.json.
The file has all runs, or it is not written: a run that fails is named with its reason. Completed runs are
stored in runs.h5.parts; after Ctrl-C or a kill the same command with --resume continues from them.
A data set over several grounds or conditions is a study with a table [dataset].";

/// What the runs came to.
#[derive(Debug, Serialize)]
struct Summary {
    scenario: String,
    file: String,
    beside: Vec<String>,
    seed: u64,
    runs: usize,
    terrain: Option<TerrainLabel>,
    classes: BTreeMap<&'static str, usize>,
    /// Effects as `name.channel=magnitude`, with the channel that was taken where none was named.
    effects: Vec<String>,
    duration_s: f64,
    physics_rate_hz: f64,
    jobs: usize,
    computing_s: f64,
    real_time_factor: f64,
    steady: BTreeMap<&'static str, Spread>,
}

impl Dataset {
    /// Simulates the runs and prints a summary.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let mut scenario = self.scenario.load()?;
        if self.raw {
            scenario = scenario.with("sensors.raw=true")?;
        }
        let out = self.claim(output)?;
        let parts = Parts::open(&out, &self.origin(&scenario), self.before(output))?;
        let series = Series {
            scenario: &scenario,
            seed: self.scenario.seed(),
            runs: (0..self.runs).filter(|run| !parts.has(*run)).collect(),
            jobs: self.jobs,
        };
        let progress = Progress::new(output, &self.scenario.stem(), series.simulated());
        let mut seen = Seen::new(&scenario, self.scenario.stem())?;
        self.simulate(&series, &progress, &mut seen, &parts)
            .map_err(|error| self.what_is_left(error, &parts))?;
        let outcomes = self
            .put_together(&out, &scenario, &parts, &mut seen)
            .map_err(|error| self.what_is_left(error, &parts))?;
        let beside = self.describe(seen, &out)?;
        parts.remove()?;
        let computing_s = progress.elapsed();
        drop(progress);
        let steady = spreads(&outcomes).map(|(quantity, spread)| (quantity.key, spread));
        output.print(&Summary {
            scenario: self.scenario.asked(),
            file: out.display().to_string(),
            beside,
            seed: self.scenario.seed().0,
            runs: outcomes.len(),
            terrain: outcomes[0].terrain,
            classes: classes(&outcomes),
            effects: scenario.effects.iter().map(ToString::to_string).collect(),
            duration_s: scenario.duration,
            physics_rate_hz: scenario.physics_rate().hertz(),
            jobs: self.jobs.count(),
            computing_s,
            real_time_factor: series.simulated() / computing_s,
            steady: steady.collect(),
        })
    }
}

impl Dataset {
    /// What decides the bytes of the runs.
    fn origin(&self, scenario: &Scenario) -> String {
        let Provenance { created_by, .. } = Provenance::measured();
        let kept = if self.features { "windows" } else { "traces" };
        let seed = self.scenario.seed().0;
        let text = scenario.text();
        format!("{created_by}\nseed {seed}\nkeeps {kept}\n\n{text}")
    }

    fn before(&self, output: &Output) -> Before {
        if self.resume {
            Before::Resume
        } else if output.force {
            Before::Discard
        } else {
            Before::Keep
        }
    }

    /// Simulates the runs that are missing and adds each to the parts.
    fn simulate(
        &self,
        series: &Series,
        progress: &Progress,
        seen: &mut Seen,
        parts: &Parts,
    ) -> anyhow::Result<()> {
        series.each(progress, |run, trace, outcome| {
            let windows = seen.windows_of(run, trace);
            let facts = RunFacts { outcome, windows };
            parts.add(run, &facts, (!self.features).then_some(trace))
        })
    }

    /// The error, with what it leaves behind and how to go on.
    fn what_is_left(&self, error: anyhow::Error, parts: &Parts) -> anyhow::Error {
        let (whole, runs) = (parts.count(), self.runs);
        if whole == 0 && parts.remove().is_ok() {
            return error;
        }
        let left =
            format!("{whole} of {runs} runs are whole; the same command with --resume goes on");
        if error.is::<Interrupted>() {
            return Interrupted(left).into();
        }
        // The reason comes first.
        let context = format!("{error}; {left}");
        error.context(context)
    }

    /// Gathers the parts in the file; the outcomes of the runs.
    fn put_together(
        &self,
        out: &Path,
        scenario: &Scenario,
        parts: &Parts,
        seen: &mut Seen,
    ) -> anyhow::Result<Vec<Outcome>> {
        let provenance = Provenance::simulated(scenario.text(), self.scenario.seed());
        let mut file = if self.features {
            None
        } else {
            Some(RunFileWriter::create(out, &provenance)?)
        };
        let mut outcomes = Vec::new();
        for run in 0..self.runs {
            interrupt::check()?;
            let Part { facts, trace } = parts.read(run, file.is_some())?;
            outcomes.push(facts.outcome);
            seen.windows.rows.extend(facts.windows);
            if let (Some(file), Some(trace)) = (&mut file, trace) {
                if seen.channels.is_empty() {
                    seen.channels = ChannelFact::of(&trace);
                }
                file.add(&run_id(run), &trace)?;
            }
        }
        file.map_or(Ok(()), RunFileWriter::finish)?;
        Ok(outcomes)
    }

    /// The run file, claimed with the texts beside it.
    fn claim(&self, output: &Output) -> anyhow::Result<PathBuf> {
        let out = output::file_or_default(self.out.as_deref(), &self.scenario.stem(), "runs.h5");
        let source = self.scenario.source()?;
        let input = source.file();
        let claim = output.claim(input.as_slice());
        claim.file(&out)?;
        for ending in DataSet::ENDINGS {
            claim.file(&out.with_extension(ending))?;
        }
        Ok(out)
    }

    /// Writes the texts beside the runs, and what is kept where only features are; names the texts.
    fn describe(&self, seen: Seen, out: &Path) -> anyhow::Result<Vec<String>> {
        let kept = if self.features {
            Kept::Features
        } else {
            Kept::Traces
        };
        let provenance = Provenance {
            seed: Some(self.scenario.seed()),
            ..Provenance::measured()
        };
        let facts = Facts {
            command: self.command(),
            created_by: provenance.created_by.clone(),
            seed: self.scenario.seed(),
            kept,
            channels: seen.channels,
            failed: 0,
        };
        let set = DataSet::new(facts, seen.windows);
        if kept == Kept::Features {
            write_table(out, set.windows(), &provenance)?;
        }
        let mut written = Vec::new();
        for (ending, text) in set.texts(&FileFact::of(out)?) {
            let path = out.with_extension(ending);
            output::write_file(&path, &text)?;
            written.push(path.display().to_string());
        }
        Ok(written)
    }

    /// The command that makes the same again; folders, which do not matter, left out.
    fn command(&self) -> String {
        let size = match (self.raw, self.features) {
            (true, _) => " --raw",
            (_, true) => " --features",
            _ => "",
        };
        let edits = self.scenario.edits();
        let (scenario, seed) = (self.scenario.stem(), self.scenario.seed().0);
        format!(
            "lugwheel dataset {scenario} --runs {} --seed {seed}{edits}{size}",
            self.runs
        )
    }
}

/// What a data set has to remember of its runs.
struct Seen {
    windower: Windower,
    scenario: String,
    windows: Records,
    channels: Vec<ChannelFact>,
}

impl Seen {
    fn new(scenario: &Scenario, name: String) -> anyhow::Result<Self> {
        let settings = Settings {
            window: Window::Seconds(scenario.window()),
            ..Settings::default()
        };
        let reference = scenario.computed_reference(settings)?;
        let mut fields = run_fields(Vec::new());
        fields.extend(windows::fields());
        let rows = Vec::new();
        Ok(Self {
            windower: Windower::new(settings, reference)?,
            scenario: name,
            windows: Records { fields, rows },
            channels: Vec::new(),
        })
    }

    /// A row of cells for every window of a run.
    fn windows_of(&mut self, run: u64, trace: &Trace) -> Vec<Vec<String>> {
        let condition = "0".to_owned();
        let first = [
            run_id(run),
            condition,
            run.to_string(),
            self.scenario.clone(),
        ];
        let windows = self.windower.rows(trace).into_iter();
        windows
            .map(|cells| [first.to_vec(), cells].concat())
            .collect()
    }
}

/// How many runs are of each true class; `mixed` where a run has several.
pub fn classes(outcomes: &[Outcome]) -> BTreeMap<&'static str, usize> {
    let mut classes = BTreeMap::new();
    for outcome in outcomes {
        let class = outcome.class.map_or("mixed", Wtic::as_str);
        *classes.entry(class).or_default() += 1;
    }
    classes
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let terrain = self.terrain.map_or("several grounds", TerrainLabel::as_str);
        writeln!(
            f,
            "{}, {} runs: {} s each on {terrain}, seed {}",
            self.scenario, self.runs, self.duration_s, self.seed
        )?;
        writeln!(
            f,
            "simulated in {:.1} s at {} kHz, {} at a time, {:.2} x real time",
            self.computing_s,
            self.physics_rate_hz / 1.0e3,
            self.jobs,
            self.real_time_factor
        )?;
        if !self.effects.is_empty() {
            writeln!(f, "with {}", self.effects.join(", "))?;
        }
        let counts = self.classes.iter();
        let counts: Vec<String> = counts.map(|(class, n)| format!("{n} {class}")).collect();
        writeln!(f, "\n{:<34}{}", "true class of the runs", counts.join(", "))?;
        writeln!(
            f,
            "{:<28}{:>6}{:>12}{:>12}{:>12}",
            "", "", "mean", "least", "greatest"
        )?;
        for quantity in &QUANTITIES {
            if let Some(spread) = self.steady.get(quantity.key) {
                let [mean, min, max] =
                    [spread.mean, spread.min, spread.max].map(|value| quantity.shown(value));
                let (name, unit) = (quantity.name, quantity.shown_unit);
                let line = format!("{name:<28}{unit:>6}{mean:>12}{min:>12}{max:>12}");
                let meaning = quantity.meaning(spread.mean);
                let remarks = [meaning, &spread.remark(self.runs)].join("  ");
                writeln!(
                    f,
                    "{}",
                    format!("{line}  {}", remarks.trim_start()).trim_end()
                )?;
            }
        }
        writeln!(f, "\nwritten to {}", self.file)?;
        writeln!(f, "beside it: {}", self.beside.join(", "))
    }
}
