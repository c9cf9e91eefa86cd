//! `simulate`: one run.

use super::output::{self, Output};
use super::progress::Progress;
use super::scenario_args::ScenarioArgs;
use super::series::{Jobs, Series};
use super::steady::{QUANTITIES, Reading};
use crate::learning::run_id;
use crate::table::four_digits;
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::AtLimit;
use clap::Args;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// Simulate one run
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Simulate {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Index of the run in the random sequence of this seed
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u64).range(0..=999_999))]
    run: u64,
    /// Run file to write [default: output/<scenario>/run.h5]
    #[arg(long, value_name = "FILE.h5")]
    out: Option<PathBuf>,
    /// Store the samples at the sensor rate [128 kHz] too, about 0.9 MB per second
    #[arg(long)]
    raw: bool,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel simulate single_wheel_st
  lugwheel simulate scenarios/single_wheel_st.toml --seed 7 --out sand.h5
  lugwheel simulate single_wheel_st --set rig.single_wheel.slip=0.3 --set duration=5

Run 3 here is run 3 of `lugwheel dataset` with the same scenario and seed.";

/// What one run came to.
#[derive(Debug, Serialize)]
struct Summary {
    scenario: String,
    file: String,
    seed: u64,
    run: String,
    terrain: Option<TerrainLabel>,
    class: Option<Wtic>,
    /// Effects as `name.channel=magnitude`, with the channel that was taken where none was named.
    effects: Vec<String>,
    duration_s: f64,
    physics_rate_hz: f64,
    computing_s: f64,
    real_time_factor: f64,
    steady: BTreeMap<&'static str, Value>,
    /// Shares of the run in which a drive of the rig gave all it has.
    at_limit: AtLimit,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Value {
    #[serde(flatten)]
    reading: Reading,
    unit: &'static str,
}

impl Simulate {
    /// Simulates the run and says what it came to.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let mut scenario = self.scenario.load()?;
        if self.raw {
            scenario = scenario.with("sensors.raw=true")?;
        }
        let out = output::file_or_default(self.out.as_deref(), &self.scenario.stem(), "run.h5");
        let source = self.scenario.source()?;
        output.claim(source.file().as_slice()).file(&out)?;
        let series = Series {
            scenario: &scenario,
            seed: self.scenario.seed(),
            runs: vec![self.run],
            jobs: Jobs::ONE,
        };
        let progress = Progress::new(output, &self.scenario.stem(), series.simulated());
        let outcomes = series.write(&out, &progress)?;
        let computing_s = progress.elapsed();
        drop(progress);
        let outcome = &outcomes[0];
        let steady = QUANTITIES.iter().zip(outcome.steady);
        output.print(&Summary {
            scenario: self.scenario.asked(),
            file: out.display().to_string(),
            seed: self.scenario.seed().0,
            run: run_id(self.run),
            terrain: outcome.terrain,
            class: outcome.class,
            effects: scenario.effects.iter().map(ToString::to_string).collect(),
            duration_s: scenario.duration,
            physics_rate_hz: scenario.physics_rate().hertz(),
            computing_s,
            real_time_factor: series.simulated() / computing_s,
            steady: steady
                .filter_map(|(quantity, reading)| {
                    let value = Value {
                        reading: reading?,
                        unit: quantity.unit,
                    };
                    Some((quantity.key, value))
                })
                .collect(),
            at_limit: outcome.at_limit,
        })
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let terrain = self.terrain.map_or("several grounds", TerrainLabel::as_str);
        writeln!(
            f,
            "{}, {}: {} s on {terrain}, seed {}",
            self.scenario, self.run, self.duration_s, self.seed
        )?;
        writeln!(
            f,
            "simulated in {:.1} s at {} kHz, {:.2} x real time",
            self.computing_s,
            self.physics_rate_hz / 1.0e3,
            self.real_time_factor
        )?;
        if !self.effects.is_empty() {
            writeln!(f, "with {}", self.effects.join(", "))?;
        }
        let class = self.class.map_or("mixed", Wtic::as_str);
        writeln!(f, "\n{:<28}{class:>12}", "true class")?;
        for quantity in &QUANTITIES {
            if let Some(Value { reading, .. }) = self.steady.get(quantity.key) {
                let (name, unit) = (quantity.name, quantity.shown_unit);
                let value = quantity.shown(reading.value);
                let line = format!("{name:<28}{value:>12} {unit:<6}");
                let meaning = quantity.meaning(reading.value);
                let remarks = [meaning, &quantity.remark(reading.steadiness)].join("  ");
                writeln!(
                    f,
                    "{}",
                    format!("{line}{}", remarks.trim_start()).trim_end()
                )?;
            }
        }
        for (drive, share) in [
            ("carriage was at its force limit", self.at_limit.carriage),
            ("motor was at its torque limit", self.at_limit.motor),
        ] {
            if share > 0.0 {
                let percent = four_digits(100.0 * share);
                writeln!(
                    f,
                    "the {drive} for {percent} % of the run: the wheel did not move as commanded"
                )?;
            }
        }
        writeln!(f, "\nwritten to {}", self.file)
    }
}
