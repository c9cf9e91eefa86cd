//! The commands of the program: the only part of the library that prints.
//!
//! A command's result goes to stdout, as text or with `--json` as one document; progress and
//! warnings go to stderr. [`failure`] has the exit codes. [`call`] runs a command inside of another program, which
//! receives all of this through a [`Console`].

mod challenge;
mod cluster;
pub mod console;
mod dataset;
mod demo;
mod diagnose;
mod documents;
mod effects;
pub mod failure;
mod identify;
mod import;
mod inspect;
mod interrupt;
mod keys;
mod new;
mod output;
mod plot;
mod program;
mod progress;
mod provenance;
mod recognize;
mod scenario_args;
mod scenarios;
mod series;
mod shell;
mod simulate;
mod steady;
mod study;
mod target;

use clap::{Parser, Subcommand};
use console::{Attached, Console};
use failure::Failure;
pub use interrupt::request as interrupt_calls;
use output::Output;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

/// Simulates a lugged rover wheel on hard, gravel and granular ground, and measures it as a test
/// rig would.
#[derive(Debug, Parser)]
#[command(version = VERSION.as_str(), after_long_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    output: Output,
}

/// The version, with the commit of a released build from a git checkout.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let version = env!("CARGO_PKG_VERSION");
    match option_env!("LUGWHEEL_COMMIT") {
        Some(commit) => format!("{version} (commit {commit})"),
        None => version.to_owned(),
    }
});

const EXAMPLES: &str = "\
Examples:
  lugwheel demo                                       the main commands on small scenarios, in a report
  lugwheel scenarios                                  what is ready to run
  lugwheel simulate single_wheel_st                   one run on sand
  lugwheel new my_rig                                 a scenario to edit
  lugwheel keys wheel.lugs                            its keys in a scenario
  lugwheel dataset single_wheel_ht --runs 50          a labelled data set
  lugwheel study quick                                sweeps and seeds, one row per run
  lugwheel import campaign.toml --out measured.h5     measured CSV files to a run file
  lugwheel inspect output/single_wheel_ht/runs.h5     its contents, checked
  lugwheel plot output/single_wheel_st/run.h5         a figure of a run
  lugwheel recognize output/single_wheel_ht/runs.h5   interaction class of every window
  lugwheel identify measured.h5                       terrain parameters with confidence intervals
  lugwheel effects                                    catalogue of effects
  lugwheel diagnose --measured rig.h5 --scenario single_wheel_st   why they differ
  lugwheel challenge make --out output/trial          campaigns with hidden causes

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input file,
4 study or trial finished with failed runs or undiagnosed campaigns, 130 interrupted.";

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Demo),
    Scenarios(scenarios::Scenarios),
    New(new::New),
    Keys(keys::Keys),
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
    Completions(shell::Completions),
    #[command(name = "man")]
    Manual(shell::Manual),
}

/// Runs the program in a terminal with the `arguments` behind its name: its exit code. `started_by` is the file
/// that starts it, where that is not the file of this process, as under an interpreter.
pub fn main(arguments: Vec<OsString>, started_by: Option<PathBuf>) -> u8 {
    if let Some(file) = started_by {
        program::set(file);
    }
    let is_json = arguments.iter().any(|argument| argument == "--json");
    let cli = match Cli::try_parse_from(words(arguments)) {
        Ok(cli) => cli,
        Err(error) => return failure::report_usage(&error, is_json),
    };
    match interrupt::listen().and_then(|()| cli.command.run(&cli.output)) {
        Ok(()) => 0,
        Err(error) => failure::report(&error, cli.output.json),
    }
}

/// The words of a command line, the program's name first.
fn words(arguments: Vec<OsString>) -> impl Iterator<Item = OsString> {
    std::iter::once(OsString::from("lugwheel")).chain(arguments)
}

/// Runs the command that `arguments` (those behind the program's name) ask for inside of another program:
/// `console` receives what a terminal would show. [`interrupt_calls`] stops it from another thread.
///
/// # Errors
/// Wrong usage and those of the command. A command may have given its result all the same: `failed_runs`, or
/// an inspection that found errors.
pub fn call(arguments: Vec<OsString>, console: Arc<dyn Console>) -> Result<(), Failure> {
    let mut cli =
        Cli::try_parse_from(words(arguments)).map_err(|error| Failure::of_usage(&error))?;
    cli.output.console = Attached::to(console);
    let _call = interrupt::Call::begin();
    let done = cli.command.run(&cli.output);
    done.map_err(|error| Failure::of(&error))
}

impl Command {
    fn run(&self, output: &Output) -> anyhow::Result<()> {
        match self {
            Self::Demo(command) => command.run(output),
            Self::Scenarios(command) => command.run(output),
            Self::New(command) => command.run(output),
            Self::Keys(command) => command.run(output),
            Self::Simulate(command) => command.run(output),
            Self::Dataset(command) => command.run(output),
            Self::Study(command) => command.run(output),
            Self::Import(command) => command.run(output),
            Self::Inspect(command) => command.run(output),
            Self::Plot(command) => command.run(output),
            Self::Recognize(command) => command.run(output),
            Self::Identify(command) => command.run(output),
            Self::Effects(command) => command.run(output),
            Self::Diagnose(command) => command.run(output),
            Self::Challenge(command) => command.run(output),
            Self::Completions(command) => command.run(output),
            Self::Manual(command) => command.run(output),
        }
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
