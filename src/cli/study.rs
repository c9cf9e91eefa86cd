//! `study`: sweeps and seeds, resumable, one row of a table a run.

use super::cluster::{Cluster, Work};
use super::documents::{self, Source};
use super::interrupt::{self, Interrupted};
use super::output::{self, Output};
use super::progress::Progress;
use super::provenance::{self, quoted};
use crate::learning::DataSet;
use crate::report::study_page::{Drawing, ResultText};
use crate::report::{self, StudyReport};
use crate::study::conditions::Unsteady;
use crate::study::scores::{Report, Scores};
use crate::study::{self, Diagnosing, Options, Outcome, Run, Study, StudyError};
use crate::trace::Trace;
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;
use std::num::{NonZeroU32, NonZeroUsize};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Run a Monte Carlo study
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct StudyCommand {
    /// Study file, or the name of one of `lugwheel scenarios`
    #[arg(value_name = "STUDY.toml")]
    study: PathBuf,
    /// Folder of the results [default: output/<study>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Parallel runs; all cores if not given, with --slurm one per task. The results do not depend on it
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroU32>,
    /// Resume: reuse the complete shards in the folder
    #[arg(long)]
    resume: bool,
    /// Run only part I of N; several processes may work on one folder
    #[arg(long, value_name = "I/N", value_parser = share)]
    shard: Option<(u32, u32)>,
    /// When to merge the shards into tables
    #[arg(long, value_name = "WHEN", default_value = "whole")]
    collect: Collect,
    #[command(flatten)]
    cluster: Cluster,
}

/// When to merge the shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Collect {
    /// After the last part
    Whole,
    /// Never; another process does
    Never,
    /// Now, without simulation
    Only,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel study quick
  lugwheel study table3 --out output/table3 --resume
  lugwheel study table5 --shard 2/4
  lugwheel study table5 --slurm --slurm-option=--time=30

With --slurm, program, study and folder must be on a file system that all nodes share. Ctrl-C does not stop
the jobs; the same command with --resume follows them again and submits missing shards.

Written to the folder: report.html (answer, tables, figures, command), runs.csv (one row per run), runs.h5 (the
same with types and units), failed.txt (reasons of failed runs) and the study's text; for a table
  [recognition]     windows.csv (one row per window), recognition.txt and .csv (scores), figures of the features
  [thresholds]      thresholds.csv, thresholds.txt, a figure of every limit
  [identification]  steady.csv (loads), identification.txt and .csv (parameters, force errors), a figure
  [diagnosis]       diagnosis.txt and .csv (answer of every campaign), diagnosis.svg
  [dataset]         dataset.h5 with its windows, splits, datasheet and Croissant metadata
`lugwheel plot FOLDER` draws the results over each swept key for a paper.
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

/// The study was finished, but some of its campaigns cannot be diagnosed.
#[derive(Debug, thiserror::Error)]
#[error("study: {campaigns} campaigns, {without} without an answer - see {file}")]
pub struct UnansweredCampaigns {
    campaigns: usize,
    without: usize,
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
    /// Quantities of the table that are not all steady values.
    not_steady: Vec<Unsteady>,
    #[serde(skip_serializing_if = "Option::is_none")]
    report: Option<String>,
    #[serde(skip)]
    texts: Vec<ResultText>,
    #[serde(flatten)]
    scores: Scores,
    #[serde(skip_serializing_if = "Option::is_none")]
    dataset: Option<usize>,
}

impl StudyCommand {
    /// Runs the study and prints its results.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let source = documents::study(&self.study)?;
        let study = documents::read_study(&source)?;
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
        output.claim(source.file().as_slice()).own_folder(&out)?;
        let progress = Progress::new(output, &stem, study.simulated());
        let outcome = self.outcome(&source, &study, &out, &progress)?;
        let computing_s = progress.elapsed();
        drop(progress);
        let Some(outcome) = outcome else {
            return Ok(());
        };
        let report = match outcome.missing_shards {
            0 => Some(self.write_report(&study, &stem, &outcome, &out)?),
            _ => None,
        };
        for Drawing { file, svg } in report::study_page::drawings(&outcome.scores) {
            output::write_file(&out.join(file), &svg)?;
        }
        let texts = report::study_page::texts(&outcome.scores);
        for ResultText { stem, text } in &texts {
            output::write_file(&out.join(format!("{stem}.txt")), text)?;
        }
        let unanswered = unanswered(&outcome, &out);
        output.print(&Summary {
            study: self.study.display().to_string(),
            folder: out.display().to_string(),
            runs: outcome.runs,
            failed: outcome.failed.clone(),
            missing_shards: outcome.missing_shards,
            computing_s,
            not_steady: Unsteady::of_all(&outcome.conditions),
            report,
            texts,
            dataset: outcome.scores.dataset.as_ref().map(DataSet::runs),
            scores: outcome.scores,
        })?;
        if outcome.failed.is_empty() || outcome.missing_shards > 0 {
            return unanswered.map_or(Ok(()), |error| Err(error.into()));
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

impl StudyCommand {
    /// What the study comes to, where its shards are put together.
    fn outcome(
        &self,
        source: &Source,
        study: &Study,
        out: &Path,
        progress: &Progress,
    ) -> anyhow::Result<Option<Outcome>> {
        if self.cluster.is_wanted() {
            let work = Work {
                study: source,
                out,
                threads: self.jobs,
                resume: self.resume,
            };
            self.cluster.run(study, &work, progress)?;
        }
        let options = Options {
            out: out.to_owned(),
            jobs: self.jobs.map(NonZeroUsize::try_from).transpose()?,
            resume: self.resume,
            shard: self.shard,
        };
        let reported = AtomicU64::new(0);
        let total = study.run_count() as f64;
        let on_progress = |now: study::Progress| {
            reported.fetch_max(now.done, Ordering::Relaxed);
            match now.diagnosing {
                Some(now) => show(progress, now),
                None => progress.set_share(reported.load(Ordering::Relaxed) as f64 / total),
            }
            if interrupt::is_requested() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let outcome = match self.collect {
            _ if self.cluster.is_wanted() => study.collect(&options, &on_progress).map(Some),
            Collect::Only => study.collect(&options, &on_progress).map(Some),
            Collect::Never => study.execute_share(&options, &on_progress).map(|()| None),
            Collect::Whole => study.execute(&options, &on_progress).map(Some),
        };
        match outcome {
            Err(stopped @ (StudyError::Stopped { .. } | StudyError::StoppedDiagnosing { .. })) => {
                Err(Interrupted(stopped.to_string()).into())
            }
            other => Ok(other?),
        }
    }

    /// Writes the page of the study; its path.
    fn write_report(
        &self,
        study: &Study,
        name: &str,
        outcome: &Outcome,
        out: &Path,
    ) -> anyhow::Result<String> {
        let path = out.join("report.html");
        let (file, folder) = (quoted(&self.study), quoted(out));
        let stills = stills(study);
        if interrupt::is_requested() {
            let left = "the results are whole, and --resume writes their report";
            return Err(Interrupted(left.to_owned()).into());
        }
        let contents = StudyReport {
            study,
            name,
            outcome,
            stills: &stills,
            facts: &provenance::facts(),
            commands: &[
                format!("lugwheel study {file} --out {folder}"),
                format!(
                    "lugwheel study {file} --out {folder} --resume   # goes on where it was interrupted"
                ),
            ],
        };
        output::write_file(&path, report::page(&report::study_page(&contents)))?;
        Ok(path.display().to_string())
    }
}

/// Shows which campaign is diagnosed, and the progress of its simulations.
fn show(progress: &Progress, now: Diagnosing) {
    let Diagnosing {
        campaign,
        campaigns,
        done,
        total,
    } = now;
    let which = format!("diagnosing {} of {campaigns}", campaign + 1);
    progress.reach_next(&which, done, total);
}

/// The error of a study with campaigns that cannot be diagnosed.
fn unanswered(outcome: &Outcome, out: &Path) -> Option<UnansweredCampaigns> {
    let score = outcome.scores.diagnosis.as_ref()?;
    let without = score.without_answer().count();
    (without > 0).then(|| UnansweredCampaigns {
        campaigns: score.campaigns.len(),
        without,
        file: out.join("diagnosis.txt").display().to_string(),
    })
}

/// Longest run that is made again to be looked at [s].
const LOOK: f64 = 12.0;

/// The beginning of the first run of every scenario; a run that fails is not shown.
fn stills(study: &Study) -> Vec<(String, Trace)> {
    let first: Vec<(&str, Run)> = study.first_runs().collect();
    let still = |(name, run): &(&str, Run)| {
        let scenario = study.scenario(run);
        let duration = format!("duration={}", scenario.duration.min(LOOK));
        // Some windows do not fit in so short a run.
        let shortened = scenario.with(&duration).unwrap_or(scenario);
        let go_on = &mut |_| {
            if interrupt::is_requested() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let trace = shortened.run(study.seed, run.stream, go_on).ok()?;
        Some(((*name).to_owned(), trace))
    };
    first.par_iter().filter_map(still).collect()
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

/// In how many of `runs` a quantity is no steady value.
fn not_steady(unsteady: &Unsteady, runs: u64) -> String {
    let Unsteady {
        quantity,
        drifting,
        too_short,
        ..
    } = unsteady;
    let mut parts = Vec::new();
    if let Some(range) = unsteady.range() {
        parts.push(format!("not steady in {drifting} of {runs} runs ({range})"));
    }
    if *too_short > 0 {
        parts.push(format!(
            "too short to show that it is steady in {too_short} of {runs} runs"
        ));
    }
    format!("{quantity}: {}", parts.join(", "))
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
        for unsteady in &self.not_steady {
            writeln!(f, "  {}", not_steady(unsteady, self.runs))?;
        }
        if let Some(runs) = self.dataset {
            writeln!(f, "data set: {runs} runs, {}/dataset.h5", self.folder)?;
        }
        for Report {
            stem, rows, table, ..
        } in self.scores.reports()
        {
            writeln!(f, "{rows}: {}/{table}\n", self.folder)?;
            let mut texts = self.texts.iter();
            if let Some(ResultText { text, .. }) = texts.find(|it| it.stem == stem) {
                writeln!(f, "{text}")?;
            }
        }
        if let Some(report) = &self.report {
            writeln!(f, "report: {report}")?;
        }
        Ok(())
    }
}
