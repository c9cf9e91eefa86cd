//! The runs of a study on threads, shard by shard, into a folder.

use super::folder::{Before, Folder};
use super::shard::{self, Shard};
use super::table::{header, row};
use super::{Run, Study, StudyError};
use crate::quantity::RangeError;
use crate::scenario::experiment::ExperimentError;
use crate::trace::Trace;
use rayon::prelude::*;
use std::any::Any;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
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
    /// Whether to keep the whole shards in the folder and do the others.
    pub resume: bool,
    /// Share `I` of `N`, `I` from 1: every `N`th shard. Processes with different shares may work on
    /// one folder at a time; the one that finds all shards there collects them.
    pub shard: Option<(u32, u32)>,
}

/// How far a study is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Runs done, those of kept shards included.
    pub done: u64,
    /// Runs to do.
    pub total: u64,
    /// Runs that failed since this execution began.
    pub failed: u64,
}

/// What an execution left in its folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outcome {
    /// Runs in whole shards.
    pub runs: u64,
    /// Numbers of those among them that failed.
    pub failed: Vec<u64>,
    /// Shards that other shares have still to do; the table is there when there are none.
    pub missing_shards: usize,
}

impl Study {
    /// Runs the study and collects its table.
    ///
    /// `progress` hears of every run and of many moments within, from several threads; a `Break`
    /// stops all at once. What a run, the order or the number of threads did before never shows in
    /// the results: an execution that was stopped and resumed leaves the same bytes.
    ///
    /// A run that fails is in the table with its reason, and the others go on.
    ///
    /// # Errors
    /// `NotEmpty` where the folder holds something and `resume` is not set; `OtherStudy` where that
    /// is not this study; `Stopped` when `progress` said so; `File` where the file system refuses,
    /// `Range` for a share that is none, `Threads` where threads cannot be had.
    pub fn execute(
        &self,
        options: &Options,
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Outcome, StudyError> {
        let shards = shard::all(self);
        let share = options.share(&shards)?;
        let folder = Folder::open(self, &options.out, options.before())?;
        let (kept, missing): (Vec<&Shard>, Vec<&Shard>) = share
            .iter()
            .partition(|&&shard| folder.rows(shard).is_some());
        if !kept.is_empty() && !options.resume {
            let folder = options.out.clone();
            return Err(StudyError::NotEmpty { folder });
        }
        let work = Work {
            study: self,
            folder: &folder,
            progress,
            total: runs(&share),
            done: AtomicU64::new(runs(&kept)),
            failed: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
        };
        let finished = options.threads()?.install(|| {
            let each = missing.par_iter().with_max_len(1);
            each.try_for_each(|shard| work.finish(shard))
        });
        match finished {
            Err(Halt::Failed(error)) => Err(error),
            Err(Halt::Stopped) => Err(StudyError::Stopped {
                whole: share.iter().filter(|s| folder.rows(s).is_some()).count(),
                shards: share.len(),
            }),
            Ok(()) => self.collect(&folder, &shards),
        }
    }

    /// Puts the shards together, where all are whole.
    fn collect(&self, folder: &Folder, shards: &[Shard]) -> Result<Outcome, StudyError> {
        let mut table = Table::new(self);
        let mut missing_shards = 0;
        for shard in shards {
            match folder.rows(shard) {
                Some(rows) => table.add(shard, &rows, folder.times(shard)),
                None => missing_shards += 1,
            }
        }
        if missing_shards == 0 {
            folder.write("runs.csv", table.rows.as_bytes())?;
            folder.write("timing.csv", table.times.as_bytes())?;
            if !table.failed.is_empty() {
                folder.write("failed.txt", table.failures.as_bytes())?;
            }
        }
        Ok(Outcome {
            runs: table.runs,
            failed: table.failed,
            missing_shards,
        })
    }
}

impl Options {
    fn before(&self) -> Before {
        if self.resume || self.shard.is_some() {
            Before::ThisStudy
        } else {
            Before::Nobody
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

fn runs(shards: &[&Shard]) -> u64 {
    let lengths = shards.iter().map(|shard| shard.runs.end - shard.runs.start);
    lengths.sum()
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
    progress: &'s (dyn Fn(Progress) -> ControlFlow<()> + Sync),
    total: u64,
    done: AtomicU64,
    failed: AtomicU64,
    stopped: AtomicBool,
}

impl Work<'_> {
    /// Runs the runs of a shard and writes it.
    fn finish(&self, shard: &Shard) -> Result<(), Halt> {
        let mut rows = line(&header(self.study));
        let mut times = String::new();
        for run in self.study.runs_in(shard.runs.clone()) {
            if self.report().is_break() {
                return Err(Halt::Stopped);
            }
            let start = Instant::now();
            let outcome = self.outcome(&run)?;
            let seconds = start.elapsed().as_secs_f64();
            times.push_str(&format!("{},{seconds:.3}\n", run.number));
            rows.push_str(&line(&row(self.study, &run, &outcome)));
            self.done.fetch_add(1, Ordering::Relaxed);
            let failed = u64::from(outcome.is_err());
            self.failed.fetch_add(failed, Ordering::Relaxed);
        }
        let written = self.folder.write_shard(shard, &rows, &times);
        written.map_err(Halt::Failed)?;
        // This shard is whole: a wish to stop concerns the next.
        let _ = self.report();
        Ok(())
    }

    /// The trace of a run or why it left none; a run that panics fails like any other.
    fn outcome(&self, run: &Run) -> Result<Result<Trace, String>, Halt> {
        let attempt = || self.study.run(run, &mut |_| self.report());
        match catch_unwind(AssertUnwindSafe(attempt)) {
            Ok(Ok(trace)) => Ok(Ok(trace)),
            Ok(Err(ExperimentError::Stopped)) => Err(Halt::Stopped),
            Ok(Err(error)) => Ok(Err(error.to_string())),
            Err(panic) => Ok(Err(format!("it panicked: {}", said(&*panic)))),
        }
    }

    /// Tells how far the study is; `Break` when it is to stop.
    fn report(&self) -> ControlFlow<()> {
        let progress = Progress {
            done: self.done.load(Ordering::Relaxed),
            total: self.total,
            failed: self.failed.load(Ordering::Relaxed),
        };
        if self.stopped.load(Ordering::Relaxed) || (self.progress)(progress).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// The message of a panic.
fn said(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("without a word")
}

/// A line of CSV.
fn line(cells: &[String]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = writer.write_record(cells);
    written.expect("memory takes a record of any length");
    let bytes = writer.into_inner().expect("memory needs no flushing");
    String::from_utf8(bytes).expect("cells are texts")
}

/// The shards put together.
struct Table<'s> {
    study: &'s Study,
    rows: String,
    times: String,
    failures: String,
    failed: Vec<u64>,
    runs: u64,
}

impl<'s> Table<'s> {
    fn new(study: &'s Study) -> Self {
        Self {
            study,
            rows: line(&header(study)),
            times: "run,wall_s\n".to_owned(),
            failures: String::new(),
            failed: Vec::new(),
            runs: 0,
        }
    }

    /// Adds the rows of the next shard, which begin with the names of the columns.
    fn add(&mut self, shard: &Shard, rows: &str, times: Option<String>) {
        self.runs += shard.runs.end - shard.runs.start;
        self.times.push_str(&times.unwrap_or_default());
        let rest = rows.split_once('\n').map_or("", |(_, rest)| rest);
        self.rows.push_str(rest);
        // The checksum vouches for the shard: its records are those of its runs, in order.
        let mut reader = csv::Reader::from_reader(rows.as_bytes());
        let runs = self.study.runs_in(shard.runs.clone());
        for (run, record) in runs.zip(reader.records().flatten()) {
            self.note_failure(&run, record.iter().next_back().unwrap_or_default());
        }
    }

    fn note_failure(&mut self, run: &Run, reason: &str) {
        if reason.is_empty() {
            return;
        }
        let values = self.study.keys().zip(self.study.values(run));
        let condition: String = values
            .map(|(key, value)| format!(", {key} = {value}"))
            .collect();
        let scenario = self.study.scenario_name(run);
        let number = run.number;
        self.failed.push(number);
        self.failures
            .push_str(&format!("run {number} ({scenario}{condition}): {reason}\n"));
    }
}
