//! `plot`: the figure of a run.

use super::output::{self, Output};
use crate::dataset::hdf5::RunFile;
use crate::report::trace_figure;
use anyhow::{Context, ensure};
use clap::Args;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Draw a run: the wheel on its ground, every channel over time, the spectrum
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Plot {
    /// Run file, simulated or measured
    #[arg(value_name = "FILE.h5")]
    file: PathBuf,
    /// Id of the run; the first if not given
    #[arg(long, value_name = "ID")]
    run: Option<String>,
    /// Drawing to write [default: beside the run file, with the run's id]
    #[arg(long, value_name = "FILE.svg")]
    out: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel plot output/single_wheel_st/run.h5
  lugwheel plot runs.h5 --run run_000003 --out third.svg";

/// What was drawn.
#[derive(Debug, Serialize)]
struct Drawn {
    file: String,
    run: String,
    figure: String,
}

impl Plot {
    /// Draws the run.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        if let Some(out) = &self.out {
            check_suffix(out)?;
        }
        let file = RunFile::open(&self.file)?;
        let run = match &self.run {
            Some(run) => run,
            None => file
                .runs()
                .first()
                .with_context(|| format!("{} has no runs to draw", self.file.display()))?,
        };
        let figure = match &self.out {
            Some(out) => out.clone(),
            None => beside(&self.file, run),
        };
        output.claim(&[&self.file]).file(&figure)?;
        let svg = trace_figure(&file.read(run)?, run)?;
        output::write_file(&figure, &svg)?;
        output.print(&Drawn {
            file: self.file.display().to_string(),
            run: run.clone(),
            figure: figure.display().to_string(),
        })
    }
}

/// Refuses a name that promises another format than SVG.
fn check_suffix(out: &Path) -> anyhow::Result<()> {
    let suffix = out.extension().unwrap_or_default().to_string_lossy();
    ensure!(
        suffix.eq_ignore_ascii_case("svg"),
        "plot writes SVG; name {} instead of {}",
        out.with_extension("svg").display(),
        out.display()
    );
    Ok(())
}

/// `runs.h5` and `run_000003` to `runs_run_000003.svg`.
fn beside(file: &Path, run: &str) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}_{run}.svg"))
}

impl fmt::Display for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.figure)
    }
}
