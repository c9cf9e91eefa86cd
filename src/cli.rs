//! The commands: the only part of the program that talks.
//!
//! A command's result goes to stdout, as text or with `--json` as one document; progress and
//! warnings go to stderr. [`failure`] has the exit codes.

mod challenge;
mod cluster;
mod dataset;
mod demo;
mod diagnose;
mod effects;
pub mod failure;
mod identify;
mod import;
mod inspect;
mod interrupt;
mod output;
mod plot;
mod progress;
mod provenance;
mod recognize;
mod scenario_args;
mod series;
mod simulate;
mod steady;
mod study;
mod target;

use clap::{Parser, Subcommand};
use output::Output;

/// Simulates a lugged rover wheel on hard, gravel and granular ground, and measures it as a test
/// rig would.
#[derive(Debug, Parser)]
#[command(version, after_long_help = EXAMPLES)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    output: Output,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel demo                                       all of it on small scenarios, in a report
  lugwheel simulate single_wheel_st                   one run on sand
  lugwheel dataset single_wheel_ht --runs 50          a labelled data set
  lugwheel study scenarios/studies/quick.toml         sweeps and seeds, a row a run
  lugwheel import campaign.toml --out measured.h5     measured CSV files in a run file
  lugwheel inspect output/single_wheel_ht/runs.h5     what is in it, checked
  lugwheel plot output/single_wheel_st/run.h5         a figure of a run
  lugwheel recognize output/single_wheel_ht/runs.h5   how the lugs met the ground
  lugwheel identify measured.h5                       terrain parameters and how sure they are
  lugwheel effects                                    what a simulation can be given beyond the ideal
  lugwheel diagnose --measured rig.h5 --scenario single_wheel_st   why they differ
  lugwheel challenge make --out output/trial          campaigns whose truth is sealed

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input file,
4 study or trial finished with failed runs or undiagnosed campaigns, 130 interrupted.";

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Demo),
    Simulate(simulate::Simulate),
    Dataset(dataset::Dataset),
    Study(study::StudyCommand),
    Import(import::Import),
    Inspect(inspect::Inspect),
    Plot(plot::Plot),
    Recognize(recognize::Recognize),
    Identify(identify::Identify),
    Effects(effects::Effects),
    Diagnose(diagnose::Diagnose),
    Challenge(challenge::Challenge),
}

/// What the program was called with; wrong usage and `--help` end it here.
pub fn read_arguments() -> Cli {
    Cli::try_parse().unwrap_or_else(|error| {
        if error.use_stderr() && std::env::args().any(|argument| argument == "--json") {
            failure::print_usage(&error);
        }
        error.exit()
    })
}

impl Cli {
    /// Whether the result, or the error, is asked for as JSON.
    pub fn is_json(&self) -> bool {
        self.output.json
    }
}

/// Runs the command.
///
/// # Errors
/// Those of the command; [`failure::report`] tells what each means to the caller.
pub fn run(cli: &Cli) -> anyhow::Result<()> {
    interrupt::listen()?;
    let output = &cli.output;
    match &cli.command {
        Command::Demo(command) => command.run(output),
        Command::Simulate(command) => command.run(output),
        Command::Dataset(command) => command.run(output),
        Command::Study(command) => command.run(output),
        Command::Import(command) => command.run(output),
        Command::Inspect(command) => command.run(output),
        Command::Plot(command) => command.run(output),
        Command::Recognize(command) => command.run(output),
        Command::Identify(command) => command.run(output),
        Command::Effects(command) => command.run(output),
        Command::Diagnose(command) => command.run(output),
        Command::Challenge(command) => command.run(output),
    }
}

/// A number above 0.
fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "give a number".to_owned())?;
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err("it has to be above 0".to_owned())
}
