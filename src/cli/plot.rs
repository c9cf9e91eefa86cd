//! `plot`: the figure of a run or of a study, or its page.

mod format;
mod study;

use super::output::{self, Output};
use super::provenance::{self, quoted};
use crate::dataset::hdf5::RunFile;
use crate::report::figure::Layout;
use crate::report::page::Provenance;
use crate::report::{laid_out_trace_figure, mcap_file, page, run_page};
use crate::trace::Trace;
use anyhow::{Context, ensure};
use clap::Args;
use format::Format;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Draw a run or the results of a study over its swept keys
///
/// A run is drawn with the wheel on its ground, every channel over time and the spectrum: as a figure (SVG, PNG or
/// PDF), as an HTML page in which the wheel moves and the channels can be zoomed and read, or as MCAP for robotics
/// viewers. A study is drawn as one figure for each swept key, with the steady means and, where classes were
/// recognised, the share of correct answers; as HTML it is its report.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Plot {
    /// Run file, simulated or measured, or the folder of a finished study
    #[arg(value_name = "FILE.h5|FOLDER")]
    file: PathBuf,
    /// Id of the run; the first if not given
    #[arg(long, value_name = "ID")]
    run: Option<String>,
    /// Swept key of a study over which its results are drawn; each of them if not given
    #[arg(long, value_name = "KEY")]
    over: Option<String>,
    /// File to write, .svg, .png, .pdf, .html or .mcap [default: beside what is drawn]
    ///
    /// By default a run is drawn into a file of its id beside the run file, and a study into `over_KEY` in its folder.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// What to write [default: as --out ends, else svg]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Width on paper with its unit (88mm, 3.5in): 7 pt font; compact layout below about 130 mm
    #[arg(long, value_name = "LENGTH", value_parser = format::width)]
    width: Option<f64>,
    /// Omit title, condition and remarks, for a figure with a caption
    #[arg(long)]
    no_title: bool,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel plot output/single_wheel_st/run.h5
  lugwheel plot runs.h5 --run run_000003 --out third.html
  lugwheel plot runs.h5 --out figure.pdf --width 88mm --no-title
  lugwheel plot output/sweep_slip --over rig.single_wheel.slip --out slip.pdf --width 88mm";

/// What was drawn.
#[derive(Debug, Serialize)]
struct Drawn {
    file: String,
    run: String,
    figure: String,
}

impl Plot {
    /// Draws the run, or the study.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let format = Format::of(self.format, self.out.as_deref())?;
        let is_figure = !matches!(format, Format::Html | Format::Mcap);
        ensure!(
            is_figure || (self.width.is_none() && !self.no_title),
            "--width and --no-title are for figures; a page takes the width of its window"
        );
        if self.file.is_dir() {
            return self.draw_study(format, output);
        }
        ensure!(
            self.over.is_none(),
            "--over is for the folder of a study, and {} is a file",
            self.file.display()
        );
        let file = RunFile::open(&self.file)?;
        let run = match &self.run {
            Some(run) => run,
            None => file
                .runs()
                .first()
                .with_context(|| format!("{} has no runs to draw", self.file.display()))?,
        };
        let target = match &self.out {
            Some(out) => out.clone(),
            None => beside(&self.file, run, format),
        };
        output.claim(&[&self.file]).file(&target)?;
        output::write_file(&target, self.draw(&file.read(run)?, run, format)?)?;
        output.print(&Drawn {
            file: self.file.display().to_string(),
            run: run.clone(),
            figure: target.display().to_string(),
        })
    }

    fn draw(&self, trace: &Trace, run: &str, format: Format) -> anyhow::Result<Vec<u8>> {
        match format {
            Format::Html => Ok(page(&run_page(trace, run, self.provenance(run))?).into_bytes()),
            Format::Mcap => Ok(mcap_file(trace, run)?),
            _ => format.image(laid_out_trace_figure(trace, run, self.layout())?),
        }
    }

    fn layout(&self) -> Layout {
        let is_titled = !self.no_title;
        match self.width {
            Some(width) => Layout::on_paper(width, is_titled),
            None => Layout {
                is_titled,
                ..Layout::SCREEN
            },
        }
    }

    fn provenance(&self, run: &str) -> Provenance {
        let file = quoted(&self.file);
        let ours = [("file", self.file.display().to_string())];
        let ours = ours.map(|(name, value)| (name.to_owned(), value));
        Provenance {
            facts: provenance::facts().into_iter().chain(ours).collect(),
            commands: vec![format!(
                "lugwheel plot {file} --run {} --format html",
                quoted(Path::new(run))
            )],
            ..Provenance::default()
        }
    }
}

/// `runs.h5` and `run_000003` to `runs_run_000003.svg`.
fn beside(file: &Path, run: &str, format: Format) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}_{run}.{}", format.ending()))
}

impl fmt::Display for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.figure)
    }
}
