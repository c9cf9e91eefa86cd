//! `dataset`: many runs of one scenario, with their labels and ground truth.

use super::output::{self, Output};
use super::progress::Progress;
use super::scenario_args::ScenarioArgs;
use super::series::{Jobs, Outcome, Series, spreads};
use super::steady::{QUANTITIES, Spread};
use clap::Args;
use lugwheel::terrain::class::{TerrainLabel, Wtic};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

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
    #[command(flatten)]
    jobs: Jobs,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel dataset single_wheel_ht --runs 50
  lugwheel dataset single_wheel_st --runs 20 --set rig.single_wheel.slip=0.3 --out slip_03.h5

The file holds all runs, or it is not written: a run that fails is named with its reason.";

/// What the runs came to.
#[derive(Debug, Serialize)]
struct Summary {
    scenario: String,
    file: String,
    seed: u64,
    runs: usize,
    terrain: Option<TerrainLabel>,
    classes: BTreeMap<&'static str, usize>,
    duration_s: f64,
    physics_rate_hz: f64,
    jobs: usize,
    computing_s: f64,
    real_time_factor: f64,
    steady: BTreeMap<&'static str, Spread>,
}

impl Dataset {
    /// Simulates the runs and says what they came to.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let scenario = self.scenario.load()?;
        let out = output::file_or_default(self.out.as_deref(), &self.scenario.stem(), "runs.h5")?;
        let series = Series {
            scenario: &scenario,
            seed: self.scenario.seed(),
            runs: 0..self.runs,
            jobs: self.jobs,
        };
        let progress = Progress::new(output, &self.scenario.stem(), series.simulated());
        let outcomes = series.write(&out, &progress)?;
        let computing_s = progress.elapsed();
        drop(progress);
        let steady = spreads(&outcomes).map(|(quantity, spread)| (quantity.key, spread));
        output.print(&Summary {
            scenario: self.scenario.asked(),
            file: out.display().to_string(),
            seed: self.scenario.seed().0,
            runs: outcomes.len(),
            terrain: outcomes[0].terrain,
            classes: classes(&outcomes),
            duration_s: scenario.duration,
            physics_rate_hz: scenario.physics_rate().hertz(),
            jobs: self.jobs.count(),
            computing_s,
            real_time_factor: series.simulated() / computing_s,
            steady: steady.collect(),
        })
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
                writeln!(f, "{name:<28}{unit:>6}{mean:>12}{min:>12}{max:>12}")?;
            }
        }
        writeln!(f, "\nwritten to {}", self.file)
    }
}
