//! The runs of a study on threads, shard by shard, into a folder.

use super::analysis::{Analysis, Finished};
use super::conditions::{self, Condition};
use super::folder::{Before, Folder};
use super::kept::Dataset;
use super::progress::Progress;
use super::runs::{self, RunRow};
use super::scores::Scores;
use super::shard::{self, Shard};
use super::table::{NoRows, Table};
use super::traces::{self, Traces};
use super::{Run, Study, StudyError};
use crate::dataset::hdf5::write_table;
use crate::dataset::records::Records;
use crate::quantity::RangeError;
use crate::scenario::caught::caught;
use crate::trace::Trace;
use rayon::prelude::*;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// How a study is executed; none of it changes the results.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder of the results.
    pub out: PathBuf,
    /// Threads; one a core if absent.
    pub jobs: Option<NonZeroUsize>,
    /// Whether to reuse the complete shards in the folder and run only the others.
    pub resume: bool,
    /// Share `I` of `N`, `I` from 1: every `N`th shard. Processes with different shares may work on
    /// one folder at a time.
    pub shard: Option<(u32, u32)>,
}

/// What an execution left in its folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Runs in whole shards.
    pub runs: u64,
    /// Numbers of those among them that failed.
    pub failed: Vec<u64>,
    /// What they were and why they failed.
    pub failures: Vec<Failure>,
    /// Every condition, where no shard is missing.
    pub conditions: Vec<Condition>,
    /// Seconds of computing, all runs together.
    pub computing_s: f64,
    /// Shards that other shares have still to do; the tables are there when there are none.
    pub missing_shards: usize,
    /// Results of the analyses; none where shards are missing.
    pub scores: Scores,
}

/// A run that failed.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// Its number.
    pub run: u64,
    /// Scenario and values of the swept keys.
    pub condition: String,
    /// Why.
    pub reason: String,
}

impl Study {
    /// Runs the study, or a share of it, and collects its tables once all shards are present.
    ///
    /// `progress` is called for every run and at many moments within, from several threads; a `Break` stops
    /// the execution. Results do not depend on the order of runs, the number of threads or interruptions: an
    /// execution that was stopped and resumed produces the same bytes.
    ///
    /// A run that fails is listed in the table with its reason, and the others continue.
    ///
    /// # Errors
    /// `NotEmpty` where the folder is not empty and `resume` is not set; `OtherStudy` where it belongs to
    /// another study; `Stopped` and `StoppedDiagnosing` on a `Break`; `File` and `Diagnosis` for errors of
    /// the file system, `Range` for an invalid share, `Threads` where threads cannot be started, `Baseline`
    /// where no classifier can be trained on the windows.
    pub fn execute(
        &self,
        options: &Options,
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Outcome, StudyError> {
        let folder = self.finish_share(options, progress)?;
        let threads = options.threads()?;
        threads.install(|| self.put_together(&folder, progress))
    }

    /// Runs the study, or a share of it, without collecting its tables: see [`Study::collect`].
    ///
    /// # Errors
    /// Those of [`Study::execute`].
    pub fn execute_share(
        &self,
        options: &Options,
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<(), StudyError> {
        self.finish_share(options, progress).map(drop)
    }

    fn finish_share(
        &self,
        options: &Options,
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Folder, StudyError> {
        let shards = shard::all(self);
        let share = options.share(&shards)?;
        let folder = Folder::open(self, &options.out, options.before())?;
        let tables = self.tables();
        let (kept, missing): (Vec<&Shard>, Vec<&Shard>) = share
            .iter()
            .partition(|shard| self.is_whole(&folder, &tables, shard));
        if !kept.is_empty() && !options.resume {
            let folder = options.out.clone();
            return Err(StudyError::NotEmpty { folder });
        }
        let work = Work {
            study: self,
            folder: &folder,
            tables: &tables,
            progress,
            total: count(&share),
            done: AtomicU64::new(count(&kept)),
            failed: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
        };
        let finished = options.threads()?.install(|| {
            let each = missing.par_iter().with_max_len(1);
            each.try_for_each(|shard| work.finish(shard))
        });
        let is_whole = |shard: &&&Shard| self.is_whole(&folder, &tables, shard);
        match finished {
            Err(Halt::Failed(error)) => Err(error),
            Err(Halt::Stopped) => Err(StudyError::Stopped {
                whole: share.iter().filter(is_whole).count(),
                shards: share.len(),
            }),
            Ok(()) => Ok(folder),
        }
    }

    /// Collects the tables from the shards in the folder of `options`, without running any; `progress` is
    /// called for the steps after the runs.
    ///
    /// # Errors
    /// `Incomplete` where shards are missing or damaged; `OtherStudy` where the folder belongs to another
    /// study; `Stopped` and `StoppedDiagnosing` on a `Break`; `File` and `Diagnosis` for errors of the file
    /// system, `Threads` where threads cannot be started, `Baseline` where no classifier can be trained on
    /// the windows.
    pub fn collect(
        &self,
        options: &Options,
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Outcome, StudyError> {
        let folder = Folder::open(self, &options.out, Before::ThisStudy)?;
        let threads = options.threads()?;
        let outcome = threads.install(|| self.put_together(&folder, progress))?;
        match outcome.missing_shards {
            0 => Ok(outcome),
            missing => Err(StudyError::Incomplete {
                folder: options.out.clone(),
                missing,
            }),
        }
    }

    /// The shards that are not whole.
    pub(super) fn missing(&self, folder: &Folder) -> Vec<Shard> {
        let tables = self.tables();
        let mut shards = shard::all(self);
        shards.retain(|shard| !self.is_whole(folder, &tables, shard));
        shards
    }

    /// Runs of the shards that seem to be there; a shard's last table is written last.
    pub(super) fn runs_present(&self, folder: &Folder) -> u64 {
        let last = self.tables().pop().map_or("", |table| table.name());
        let present = folder.present(last);
        let shards = shard::all(self);
        let there = shards.iter().filter(|s| present.contains(&s.number));
        count(&there.collect::<Vec<_>>())
    }

    fn is_whole(&self, folder: &Folder, tables: &[Box<dyn Table + '_>], shard: &Shard) -> bool {
        let mut tables = tables.iter();
        tables.all(|table| rows(folder, &**table, shard).is_some())
            && traces::is_whole(self, folder, shard)
    }

    /// Collects the shards, and scores their tables where all are complete.
    fn put_together(
        &self,
        folder: &Folder,
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Outcome, StudyError> {
        let shards = shard::all(self);
        let (collected, missing_shards) = self.collected(folder, &shards);
        let rows = collected.rows();
        let failures = self.failures(&rows);
        let mut outcome = Outcome {
            runs: collected.runs,
            failed: failures.iter().map(|failure| failure.run).collect(),
            failures,
            conditions: Vec::new(),
            computing_s: collected.computing_s(),
            missing_shards,
            scores: Scores::default(),
        };
        if missing_shards > 0 {
            return Ok(outcome);
        }
        folder.remove_abandoned_parts();
        collected.write(folder)?;
        write_failures(folder, &outcome.failures)?;
        outcome.conditions = conditions::of_runs(&rows);
        let total = self.run_count();
        let done = Finished {
            study: self,
            folder,
            shards: &shards,
            failed: outcome.failures.len() as u64,
            on_progress: &|diagnosing| {
                progress(Progress {
                    done: total,
                    total,
                    failed: 0,
                    diagnosing,
                })
            },
        };
        outcome.scores = Scores::of(&done, &|table| collected.text_of(table))?;
        outcome.scores.write(folder)?;
        Ok(outcome)
    }

    /// The rows of all complete shards in the folder, and the number of the other shards.
    fn collected(&self, folder: &Folder, shards: &[Shard]) -> (Collected<'_>, usize) {
        let tables = self.tables();
        let mut collected = Collected::new(self, &tables);
        let mut missing_shards = 0;
        for shard in shards {
            let rows = tables.iter().map(|table| rows(folder, &**table, shard));
            match rows.collect::<Option<Vec<String>>>() {
                Some(rows) if traces::is_there(self, folder, shard) => {
                    collected.add(shard, &rows, folder.times(shard));
                }
                _ => missing_shards += 1,
            }
        }
        (collected, missing_shards)
    }

    /// The runs among these that failed.
    fn failures(&self, rows: &[RunRow]) -> Vec<Failure> {
        let failed = rows.iter().filter(|row| !row.failure.is_empty());
        let failure = |row: &RunRow| Failure {
            run: row.run,
            condition: self
                .runs_in(row.run..row.run + 1)
                .map(|run| self.condition_of(&run))
                .collect(),
            reason: row.failure.clone(),
        };
        failed.map(failure).collect()
    }
}

impl Options {
    fn before(&self) -> Before {
        if self.resume || self.shard.is_some() {
            Before::ThisStudy
        } else {
            Before::NoStudy
        }
    }

    /// The shards to do: neighbours go to different shares, as neighbours are alike in cost.
    fn share<'s>(&self, shards: &'s [Shard]) -> Result<Vec<&'s Shard>, RangeError> {
        let (share, of) = self.shard.unwrap_or((1, 1));
        RangeError::check("number of shares", "-", f64::from(of), [1.0, 1.0e6])?;
        RangeError::check("share", "-", f64::from(share), [1.0, f64::from(of)])?;
        let mine = shards.iter().skip(share as usize - 1);
        Ok(mine.step_by(of as usize).collect())
    }

    fn threads(&self) -> Result<rayon::ThreadPool, StudyError> {
        let jobs = self.jobs.map_or(0, NonZeroUsize::get);
        let builder = rayon::ThreadPoolBuilder::new().num_threads(jobs);
        builder
            .build()
            .map_err(|source| StudyError::Threads { jobs, source })
    }
}

fn count(shards: &[&Shard]) -> u64 {
    let lengths = shards.iter().map(|shard| shard.runs.end - shard.runs.start);
    lengths.sum()
}

/// The rows of a whole shard for a table, below the columns that the table has now.
fn rows(folder: &Folder, table: &dyn Table, shard: &Shard) -> Option<String> {
    let rows = folder.rows(shard, table.name())?;
    rows.starts_with(&table.columns().line()).then_some(rows)
}

/// Why a shard was not finished.
enum Halt {
    Stopped,
    Failed(StudyError),
}

/// What the threads share.
struct Work<'s> {
    study: &'s Study,
    folder: &'s Folder,
    tables: &'s [Box<dyn Table + 's>],
    progress: &'s (dyn Fn(Progress) -> ControlFlow<()> + Sync),
    total: u64,
    done: AtomicU64,
    failed: AtomicU64,
    stopped: AtomicBool,
}

impl Work<'_> {
    /// Runs the runs of a shard and writes it.
    fn finish(&self, shard: &Shard) -> Result<(), Halt> {
        let headers = self.tables.iter().map(|table| table.columns().line());
        let mut texts: Vec<String> = headers.collect();
        let mut times = String::new();
        let traces = Traces::begin(self.study, self.folder, shard);
        let mut traces = traces.map_err(Halt::Failed)?;
        for run in self.study.runs_in(shard.runs.clone()) {
            if self.report().is_break() {
                return Err(Halt::Stopped);
            }
            let start = Instant::now();
            let outcome = self.outcome(&run)?;
            let seconds = start.elapsed().as_secs_f64();
            times.push_str(&format!("{},{seconds:.3}\n", run.number));
            let failed = u64::from(outcome.is_err());
            let rows = match outcome {
                Ok((trace, rows)) => {
                    if let Some(traces) = &mut traces {
                        let added = traces.add(self.study, &run, trace);
                        added.map_err(Halt::Failed)?;
                    }
                    rows
                }
                Err(reason) => self.rows_of_failed(&run, &reason),
            };
            for (text, rows) in texts.iter_mut().zip(&rows) {
                text.push_str(rows);
            }
            self.done.fetch_add(1, Ordering::Relaxed);
            self.failed.fetch_add(failed, Ordering::Relaxed);
        }
        if let Some(traces) = traces {
            traces.finish(self.folder, shard).map_err(Halt::Failed)?;
        }
        self.write(shard, &texts, &times).map_err(Halt::Failed)?;
        // This shard is whole: a wish to stop concerns the next.
        let _ = self.report();
        Ok(())
    }

    fn write(&self, shard: &Shard, texts: &[String], times: &str) -> Result<(), StudyError> {
        self.folder.write_times(shard, times)?;
        for (table, text) in self.tables.iter().zip(texts) {
            self.folder.write_rows(shard, table.name(), text)?;
        }
        Ok(())
    }

    /// A run and its rows for every table, or why there are none; a run that panics fails like any
    /// other.
    fn outcome(&self, run: &Run) -> Result<Result<(Trace, Vec<String>), String>, Halt> {
        match caught(|| self.rows(run), NoRows::Failed) {
            Ok(traced) => Ok(Ok(traced)),
            Err(NoRows::Stopped) => Err(Halt::Stopped),
            Err(NoRows::Failed(reason)) => Ok(Err(reason)),
        }
    }

    fn rows(&self, run: &Run) -> Result<(Trace, Vec<String>), NoRows> {
        let trace = self.study.run(run, &mut |_| self.report())?;
        let tables = self.tables.iter();
        let rows = tables.map(|table| table.rows(run, &trace, &mut |_| self.report()));
        let rows = rows.collect::<Result<Vec<String>, NoRows>>()?;
        Ok((trace, rows))
    }

    fn rows_of_failed(&self, run: &Run, reason: &str) -> Vec<String> {
        let tables = self.tables.iter();
        tables
            .map(|table| table.rows_of_failed(run, reason))
            .collect()
    }

    /// Reports the progress; `Break` to stop.
    fn report(&self) -> ControlFlow<()> {
        let progress = Progress {
            done: self.done.load(Ordering::Relaxed),
            total: self.total,
            failed: self.failed.load(Ordering::Relaxed),
            diagnosing: None,
        };
        if self.stopped.load(Ordering::Relaxed) || (self.progress)(progress).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// The shards put together.
struct Collected<'s> {
    study: &'s Study,
    /// Name and text of every table, that of the runs first.
    texts: Vec<(&'static str, String)>,
    times: String,
    runs: u64,
}

impl<'s> Collected<'s> {
    fn new(study: &'s Study, tables: &[Box<dyn Table + '_>]) -> Self {
        let headers = tables.iter();
        let headers = headers.map(|table| (table.name(), table.columns().line()));
        Self {
            study,
            texts: headers.collect(),
            times: "run,wall_s\n".to_owned(),
            runs: 0,
        }
    }

    /// Adds the rows of the next shard for every table, which begin with the names of the columns.
    fn add(&mut self, shard: &Shard, rows: &[String], times: Option<String>) {
        self.runs += shard.runs.end - shard.runs.start;
        self.times.push_str(&times.unwrap_or_default());
        for ((_, text), rows) in self.texts.iter_mut().zip(rows) {
            let rest = rows.split_once('\n').map_or("", |(_, rest)| rest);
            text.push_str(rest);
        }
    }

    fn text_of(&self, table: &str) -> Option<&str> {
        let found = self.texts.iter().find(|(name, _)| *name == table);
        found.map(|(_, text)| text.as_str())
    }

    /// Every run.
    fn rows(&self) -> Vec<RunRow> {
        let columns = runs::columns(&self.study.keys().collect::<Vec<_>>());
        let rows = columns.read(&self.texts[0].1);
        rows.expect("the shards have the columns and rows of their tables")
    }

    fn write(&self, folder: &Folder) -> Result<(), StudyError> {
        // The windows of a data set are written with its other texts.
        let tables = self
            .texts
            .iter()
            .filter(|(name, _)| Some(*name) != Dataset::ROWS);
        for (name, text) in tables {
            folder.write(&format!("{name}.csv"), text.as_bytes())?;
        }
        let records = Records::of_csv(runs::fields(self.study), &self.texts[0].1);
        let provenance = traces::provenance(self.study);
        write_table(folder.path_of("runs.h5"), &records, &provenance)?;
        folder.write("timing.csv", self.times.as_bytes())
    }

    /// Seconds of computing, all runs together.
    fn computing_s(&self) -> f64 {
        let times = self.times.lines().skip(1);
        let times = times.filter_map(|line| line.split_once(',')?.1.parse::<f64>().ok());
        times.sum()
    }
}

/// Writes which runs failed and why, where any did.
fn write_failures(folder: &Folder, failures: &[Failure]) -> Result<(), StudyError> {
    if failures.is_empty() {
        return Ok(());
    }
    let lines = failures.iter().map(|failure| {
        let Failure {
            run,
            condition,
            reason,
        } = failure;
        format!("run {run} ({condition}): {reason}\n")
    });
    let text: String = lines.collect();
    folder.write("failed.txt", text.as_bytes())
}
