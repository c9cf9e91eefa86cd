//! Runs of one scenario, many at a time, into one file.

use super::interrupt::{self, Interrupted};
use super::progress::Progress;
use super::steady::{QUANTITIES, Quantity, Reading, Spread};
use crate::dataset::Provenance;
use crate::dataset::hdf5::RunFileWriter;
use crate::learning::run_id;
use crate::quantity::Seed;
use crate::scenario::Scenario;
use crate::scenario::experiment::ExperimentError;
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::{AtLimit, Trace};
use anyhow::Context;
use clap::Args;
use rayon::{ScopeFifo, ThreadPoolBuilder};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};

/// How many runs are simulated at a time.
#[derive(Debug, Clone, Copy, Args)]
pub struct Jobs {
    /// Runs at a time; all cores if not given. The bytes written do not depend on it
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

impl Jobs {
    /// One run after another.
    pub const ONE: Self = Self {
        jobs: NonZeroUsize::new(1),
    };

    /// All cores.
    pub const ALL: Self = Self { jobs: None };

    /// How many.
    pub fn count(self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        self.jobs.map_or_else(cores, NonZeroUsize::get)
    }
}

/// Runs of one scenario with one seed.
#[derive(Debug, Clone)]
pub struct Series<'a> {
    /// What is simulated.
    pub scenario: &'a Scenario,
    /// The seed of all runs.
    pub seed: Seed,
    /// Their numbers.
    pub runs: Vec<u64>,
    /// How many at a time.
    pub jobs: Jobs,
}

/// What one run came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The ground, if it was one.
    pub terrain: Option<TerrainLabel>,
    /// The true class, if it was one.
    pub class: Option<Wtic>,
    /// Steady values in the order of [`QUANTITIES`].
    pub steady: [Option<Reading>; QUANTITIES.len()],
    /// How much of the run the drives were at their limits.
    #[serde(default)]
    pub at_limit: AtLimit,
}

impl Outcome {
    fn of(trace: &Trace) -> Self {
        Self {
            terrain: trace.attributes.terrain,
            class: trace.attributes.class,
            steady: QUANTITIES.map(|quantity| quantity.of(trace)),
            at_limit: trace
                .truth
                .as_ref()
                .map_or(AtLimit::default(), |truth| truth.at_limit),
        }
    }
}

/// Every quantity that some of the runs have, over these runs.
pub fn spreads(outcomes: &[Outcome]) -> impl Iterator<Item = (&'static Quantity, Spread)> {
    QUANTITIES.iter().enumerate().filter_map(|(i, quantity)| {
        let readings = outcomes.iter().map(|outcome| outcome.steady[i]);
        Some((quantity, Spread::of(quantity, readings)?))
    })
}

type Simulated = Result<Trace, ExperimentError>;

impl Series<'_> {
    /// Simulated time [s] of all runs together.
    pub fn simulated(&self) -> f64 {
        self.runs.len() as f64 * self.scenario.driven()
    }

    /// Simulates the runs and writes them to `out` in their order: all of them, or no file.
    ///
    /// # Errors
    /// `RunFileError` where the file cannot be written, before any run if it is known by then; the
    /// first run that fails; `Interrupted`.
    pub fn write(&self, out: &Path, progress: &Progress) -> anyhow::Result<Vec<Outcome>> {
        let own = std::slice::from_ref(self);
        let outcomes = write_all(own, &[out.to_owned()], self.jobs, progress)?;
        Ok(outcomes.concat())
    }

    /// Simulates the runs and hands each to `take` in its turn.
    ///
    /// # Errors
    /// The first run that fails; `Interrupted`; those of `take`.
    pub fn each(
        &self,
        progress: &Progress,
        mut take: impl FnMut(u64, &Trace, Outcome) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let own = std::slice::from_ref(self);
        simulate_all(own, self.jobs, progress, |_, run, trace| {
            take(run, &trace, Outcome::of(&trace))
        })?;
        Ok(interrupt::check()?)
    }

    fn file(&self, out: &Path) -> anyhow::Result<RunFileWriter> {
        let provenance = Provenance::simulated(self.scenario.text(), self.seed);
        Ok(RunFileWriter::create(out, &provenance)?)
    }

    fn checked(&self, run: u64, simulated: Simulated) -> anyhow::Result<Trace> {
        if let Err(ExperimentError::Stopped) = simulated {
            return Err(Interrupted("nothing was written".to_owned()).into());
        }
        let Seed(seed) = self.seed;
        simulated.with_context(|| format!("run {run} of seed {seed} failed; no file was written"))
    }
}

/// Simulates several series and writes each to its file: all of them, or no file. No core waits for
/// the last run of a series.
///
/// # Errors
/// Those of [`Series::write`].
pub fn write_all(
    all: &[Series],
    files: &[PathBuf],
    jobs: Jobs,
    progress: &Progress,
) -> anyhow::Result<Vec<Vec<Outcome>>> {
    let files = all.iter().zip(files).map(|(series, out)| series.file(out));
    let mut files = files.collect::<anyhow::Result<Vec<RunFileWriter>>>()?;
    let mut outcomes = vec![Vec::new(); all.len()];
    simulate_all(all, jobs, progress, |place, run, trace| {
        outcomes[place].push(Outcome::of(&trace));
        Ok(files[place].add(&run_id(run), &trace)?)
    })?;
    interrupt::check()?;
    for file in files {
        file.finish()?;
    }
    Ok(outcomes)
}

/// Simulates the runs of several series and hands them to `take` in their order, each with the place
/// of its series.
///
/// At most twice as many runs as are simulated at a time are begun and not yet taken, so
/// memory does not grow with the number of runs.
fn simulate_all(
    all: &[Series],
    jobs: Jobs,
    progress: &Progress,
    mut take: impl FnMut(usize, u64, Trace) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let jobs = jobs.count();
    let pool = ThreadPoolBuilder::new().num_threads(jobs).build()?;
    let work = Work {
        progress,
        is_over: AtomicBool::new(false),
    };
    let places = all.iter().enumerate();
    let mut left =
        places.flat_map(|(place, series)| series.runs.iter().map(move |run| (place, *run)));
    pool.in_place_scope_fifo(|scope| {
        let mut begun = VecDeque::new();
        loop {
            let room = 2 * jobs - begun.len();
            begun.extend(left.by_ref().take(room).map(|(place, run)| {
                let result = work.begin(&all[place], run, scope);
                (place, run, result)
            }));
            let Some((place, run, result)) = begun.pop_front() else {
                return Ok(());
            };
            // A run that sends nothing has panicked, which goes on when the scope ends.
            let taken = result
                .recv()
                .context("a run broke off")
                .and_then(|simulated| all[place].checked(run, simulated))
                .and_then(|trace| take(place, run, trace));
            if taken.is_err() {
                work.is_over.store(true, Ordering::Relaxed);
                return taken;
            }
        }
    })
}

/// What the threads share.
struct Work<'a> {
    progress: &'a Progress,
    /// Whether no receiver waits for the runs any more.
    is_over: AtomicBool,
}

impl Work<'_> {
    fn begin<'scope>(
        &'scope self,
        series: &'scope Series,
        run: u64,
        scope: &ScopeFifo<'scope>,
    ) -> Receiver<Simulated> {
        let (sender, receiver) = sync_channel(1);
        scope.spawn_fifo(move |_| {
            // There is no receiver once another run has failed.
            let _ = sender.send(self.simulate(series, run));
        });
        receiver
    }

    fn simulate(&self, series: &Series, run: u64) -> Simulated {
        let mut before = 0.0;
        let simulated = series.scenario.run(series.seed, run, &mut |time| {
            self.progress.advance(time - before);
            before = time;
            if interrupt::is_requested() || self.is_over.load(Ordering::Relaxed) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        self.progress.advance(series.scenario.driven() - before);
        simulated
    }
}
