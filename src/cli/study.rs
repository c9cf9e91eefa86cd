//! `study`: sweeps and seeds, resumable, one row of a table a run.

use super::interrupt::{self, Interrupted};
use super::output::{self, Output};
use super::progress::Progress;
use anyhow::Context;
use clap::Args;
use lugwheel::report::{self, FeaturePoint, Group, IdentifiedGround};
use lugwheel::study::identification::score::{GroupScore, IdentificationScore};
use lugwheel::study::score::{Against, MethodScore, RecognitionScore};
use lugwheel::study::thresholds::ThresholdScore;
use lugwheel::study::{self, Options, Study, StudyError};
use serde::Serialize;
use std::fmt;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Run a Monte Carlo study
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct StudyCommand {
    /// Study file
    #[arg(value_name = "STUDY.toml")]
    study: PathBuf,
    /// Folder of the results [default: output/<study>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Runs at a time; all cores if not given. The results do not depend on it
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Go on with what the folder holds
    #[arg(long)]
    resume: bool,
    /// Do only share I of N; several processes may work on one folder
    #[arg(long, value_name = "I/N", value_parser = share)]
    shard: Option<(u32, u32)>,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel study scenarios/studies/quick.toml
  lugwheel study scenarios/studies/table3.toml --out output/table3 --resume
  lugwheel study scenarios/studies/table5.toml --shard 2/4

The folder holds runs.csv (one row a run), failed.txt (why runs failed) and the study's text; a
study with [recognition] also windows.csv (one row a window) and recognition.txt (its scores) with
figures of features and answers, one
with [thresholds] thresholds.csv, thresholds.txt and a figure of every limit,
one with [identification] steady.csv (loads), identification.txt and .csv (parameters, force errors)
and a figure of the parameters,
one with [dataset] dataset.h5 with its windows, splits, datasheet and Croissant metadata.
runs.h5 is runs.csv, typed, a dataset a column with its unit.
Exit code 4: finished, with failed runs.";

/// The study was finished, but some of its runs failed.
#[derive(Debug, thiserror::Error)]
#[error("study: {runs} runs, {} failed ({list}) - see {file}", failed.len())]
pub struct FailedRuns {
    runs: u64,
    failed: Vec<u64>,
    list: String,
    file: String,
}

/// What the study came to.
#[derive(Debug, Serialize)]
struct Summary {
    study: String,
    folder: String,
    runs: u64,
    failed: Vec<u64>,
    missing_shards: usize,
    computing_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    recognition: Option<RecognitionScore>,
    #[serde(skip_serializing_if = "Option::is_none")]
    thresholds: Option<ThresholdScore>,
    #[serde(skip_serializing_if = "Option::is_none")]
    identification: Option<IdentificationScore>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dataset: Option<usize>,
}

impl StudyCommand {
    /// Runs the study and says what it came to.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let study = Study::load(&self.study)?;
        let stem = self
            .study
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let out = self
            .out
            .clone()
            .unwrap_or_else(|| PathBuf::from("output").join(&stem));
        output::make_folder(&out)?;
        let options = Options {
            out: out.clone(),
            jobs: self.jobs,
            resume: self.resume,
            shard: self.shard,
        };
        let durations = study.runs().map(|run| study.scenario(&run).duration);
        let simulated: f64 = durations.sum();
        let progress = Progress::new(output, &stem, simulated);
        let each = simulated / study.run_count() as f64;
        let heard = AtomicU64::new(0);
        let outcome = study.execute(&options, &|now: study::Progress| {
            let before = heard.fetch_max(now.done, Ordering::Relaxed);
            progress.advance(now.done.saturating_sub(before) as f64 * each);
            if interrupt::is_requested() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        let outcome = match outcome {
            Err(stopped @ StudyError::Stopped { .. }) => {
                return Err(Interrupted(stopped.to_string()).into());
            }
            other => other.with_context(|| format!("study {}", self.study.display()))?,
        };
        let computing_s = progress.elapsed();
        drop(progress);
        if let Some(score) = &outcome.thresholds {
            draw_limits(score, &out)?;
        }
        if let Some(score) = &outcome.recognition {
            draw_recognition(score, &out)?;
        }
        if let Some(score) = &outcome.identification {
            draw_parameters(score, &out)?;
        }
        output.print(&Summary {
            study: self.study.display().to_string(),
            folder: out.display().to_string(),
            runs: outcome.runs,
            failed: outcome.failed.clone(),
            missing_shards: outcome.missing_shards,
            computing_s,
            recognition: outcome.recognition,
            thresholds: outcome.thresholds,
            identification: outcome.identification,
            dataset: outcome.dataset,
        })?;
        if outcome.failed.is_empty() || outcome.missing_shards > 0 {
            return Ok(());
        }
        Err(FailedRuns {
            runs: outcome.runs,
            list: shortened(&outcome.failed),
            file: out.join("failed.txt").display().to_string(),
            failed: outcome.failed,
        }
        .into())
    }
}

/// Draws a figure of every limit: `thresholds_<limit>.svg`, `..._olig.svg` of wheels of few lugs.
fn draw_limits(score: &ThresholdScore, out: &Path) -> anyhow::Result<()> {
    for statement in &score.statements {
        let kind = if statement.multi_lugged { "" } else { "_olig" };
        let file = format!("thresholds_{}{kind}.svg", statement.name);
        let figure = report::threshold_figure(statement, &score.axes);
        output::write_file(&out.join(file), &figure)?;
    }
    Ok(())
}

/// Draws the features by ground, their planes, and what each method answered.
fn draw_recognition(score: &RecognitionScore, out: &Path) -> anyhow::Result<()> {
    let write = |name: &str, svg: &str| output::write_file(&out.join(name), svg);
    let points = score.points.iter().map(|&(terrain, p)| FeaturePoint {
        group: Group::Terrain(terrain),
        p,
    });
    let points: Vec<FeaturePoint> = points.collect();
    if !points.is_empty() {
        write("feature_values.svg", &report::feature_values(&points))?;
    }
    if let (Some(lugs), false) = (score.lugs, points.is_empty()) {
        write("feature_planes.svg", &report::feature_planes(&points, lugs))?;
    }
    let by_ground = score.scores.iter();
    for MethodScore { method, all, .. } in by_ground.filter(|s| s.against == Against::Label) {
        let title = format!("{method}: classes answered, and what the ground stands for");
        let figure = report::confusion_figure(&all.confusion, &title);
        write(&format!("confusion_{method}.svg"), &figure)?;
    }
    Ok(())
}

/// Draws the parameters of one group of every scenario: the first, or that at `from`.
fn draw_parameters(score: &IdentificationScore, out: &Path) -> anyhow::Result<()> {
    let drawn = score.references().filter_map(ground);
    let figure = report::parameter_figure(&drawn.collect::<Vec<_>>());
    output::write_file(&out.join("parameters.svg"), &figure)
}

fn ground(group: &GroupScore) -> Option<IdentifiedGround> {
    let (_, parameters) = group.parameters()?;
    Some(IdentifiedGround {
        name: group.label.to_string(),
        label: group.label,
        parameters: parameters.iter().map(|told| told.identified).collect(),
        own: parameters.iter().map(|told| told.own).collect(),
    })
}

/// The first few numbers.
fn shortened(numbers: &[u64]) -> String {
    const SHOWN: usize = 10;
    let shown: Vec<String> = numbers.iter().take(SHOWN).map(u64::to_string).collect();
    let more = if numbers.len() > SHOWN { ", …" } else { "" };
    format!("runs {}{more}", shown.join(", "))
}

fn share(text: &str) -> Result<(u32, u32), String> {
    let parts = text
        .split_once('/')
        .and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    parts
        .filter(|(i, n)| (1..=*n).contains(i))
        .ok_or_else(|| "give I/N with I from 1 to N, for example 2/4".to_owned())
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: {} runs, {} failed, in {:.1} s",
            self.study,
            self.runs,
            self.failed.len(),
            self.computing_s
        )?;
        match self.missing_shards {
            0 => writeln!(f, "\ntable: {}/runs.csv", self.folder)?,
            missing => writeln!(
                f,
                "\n{missing} shards are still to do by other shares; the last one writes the table"
            )?,
        }
        if let Some(runs) = self.dataset {
            writeln!(f, "data set: {runs} runs, {}/dataset.h5", self.folder)?;
        }
        if let Some(score) = &self.recognition {
            writeln!(f, "windows: {}/windows.csv\n\n{score}", self.folder)?;
        }
        if let Some(score) = &self.thresholds {
            write!(f, "thresholds: {}/thresholds.csv\n\n{score}", self.folder)?;
        }
        if let Some(score) = &self.identification {
            write!(f, "rows: {}/steady.csv\n\n{score}", self.folder)?;
        }
        Ok(())
    }
}
