//! Random rigs of one layout, simulated once and kept.
//!
//! A layout is a scenario in the conditions of a campaign, with the channels and rates that were measured. Its
//! rigs differ from the scenario as real ones may: `design` draws their parameters and effects, `drawing` simulates
//! each motion once and measures it with as many sets of sensors as there are rows, `store` keeps the statistics. What a
//! diagnosis learns, and what it is tested on, are these rows. Nothing in them depends on the measured values: a second
//! campaign of the same layout finds its rigs in the folder.

mod design;
mod drawing;
mod law;
mod store;
mod table;

pub use design::{Part, motions};
pub use table::{Column, Row, Table};

use super::candidate::Candidate;
use super::condition::{Case, statistician};
use super::parameter::Parameter;
use super::sealed;
use crate::gap::Run;
use crate::quantity::{RangeError, Seed};
use crate::whole_file;
use design::Rig;
use drawing::{Drawing, NoRig};
use rayon::prelude::*;
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use store::{Drawn, Store};

/// What changes when rigs of the same layout are drawn or read otherwise.
const METHOD: &str = "rigs 3";

/// Share of rigs that may fail before nothing is learned from the others.
const MAY_FAIL: f64 = 0.5;

/// Of what rigs are drawn.
#[derive(Debug, Clone)]
pub struct Population {
    /// The conditions.
    pub cases: Vec<Case>,
    /// Effects that rigs may have.
    pub candidates: Vec<Candidate>,
    /// Parameters that differ from rig to rig.
    pub parameters: Vec<&'static Parameter>,
    /// Statistics that are kept.
    pub columns: Vec<Column>,
}

/// Rigs of one layout.
#[derive(Debug)]
pub struct RigSet {
    /// Of what they are drawn.
    pub population: Population,
    seed: Seed,
    store: Store,
    key: String,
}

/// How far a drawing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Rigs there.
    pub done: u64,
    /// Rigs asked for.
    pub total: u64,
}

/// Why there are no rigs.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// The file system refused.
    #[error("cannot keep simulated rigs in {}: {}; {}", path.display(), whole_file::reason(source), way_out(source))]
    File {
        /// The folder.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The caller stopped.
    #[error(
        "stopped with {done} of {total} rigs simulated; the same command goes on with the others"
    )]
    Stopped {
        /// Rigs there.
        done: u64,
        /// Rigs asked for.
        total: u64,
    },
    /// Too many rigs could not be simulated.
    #[error(
        "{failed} of {total} random rigs of this scenario cannot be simulated, for example: {reason}"
    )]
    Failed {
        /// How many.
        failed: usize,
        /// Of how many.
        total: usize,
        /// Why the first could not.
        reason: String,
    },
    /// Statistics cannot be taken.
    #[error(transparent)]
    Range(#[from] RangeError),
}

fn way_out(refusal: &io::Error) -> String {
    let reason = whole_file::reason(refusal);
    whole_file::way_out(&reason, "name another folder (--bank)")
}

/// Where rigs are kept, and by which program and seed they are drawn.
#[derive(Debug, Clone, Copy)]
pub struct Origin<'a> {
    /// Folder; several layouts may share it.
    pub folder: &'a Path,
    /// Version of the program, whose next one may simulate otherwise.
    pub version: &'a str,
    /// Seed of all rigs.
    pub seed: Seed,
}

impl RigSet {
    /// Rigs of a population.
    ///
    /// # Errors
    /// `File` where the folder cannot be made.
    pub fn open(population: Population, origin: Origin) -> Result<Self, RigError> {
        let key = population.hash(origin);
        let store = Store::open(origin.folder, key.clone());
        let store = store.map_err(|source| RigError::File {
            path: origin.folder.to_owned(),
            source,
        })?;
        Ok(Self {
            seed: origin.seed,
            population,
            store,
            key,
        })
    }

    /// Hash of all that determines the rigs.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Folder of what belongs to these rigs.
    pub fn folder(&self) -> &Path {
        self.store.folder()
    }

    /// The rows of the first `count` rigs, on the threads of the pool in which this is called; those in the folder are not
    /// simulated again. Rigs that cannot be simulated are left out.
    ///
    /// # Errors
    /// `Stopped` when `progress` breaks, what is done stays; `File`; `Failed` where too many cannot be simulated.
    pub fn draw(
        &self,
        count: usize,
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Table, RigError> {
        let counter = Counter {
            total: count as u64,
            done: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
            progress,
        };
        let rigs = design::rigs(
            &self.population.candidates,
            self.population.parameters.len(),
            count,
            self.seed,
        );
        let each = rigs.par_iter().with_max_len(1);
        let drawn = each.map(|rig| {
            let drawn = match self.store.read(rig.number) {
                Some(drawn) => drawn,
                None => {
                    let simulated = self.simulate(rig, &|| counter.report());
                    simulated.ok_or_else(|| counter.error())??
                }
            };
            counter.add()?;
            Ok(drawn)
        });
        let drawn: Vec<Drawn> = drawn.collect::<Result<_, RigError>>()?;
        self.table(drawn)
    }

    /// The rows of the rigs that could be simulated.
    fn table(&self, drawn: Vec<Drawn>) -> Result<Table, RigError> {
        let total = drawn.len();
        let (rows, failures): (Vec<Drawn>, Vec<Drawn>) = drawn.into_iter().partition(Result::is_ok);
        if failures.len() as f64 > MAY_FAIL * total as f64 {
            let mut reasons = failures.iter().filter_map(|failed| failed.as_ref().err());
            return Err(RigError::Failed {
                failed: failures.len(),
                total,
                reason: reasons.next().cloned().unwrap_or_default(),
            });
        }
        Ok(Table {
            columns: self.population.columns.clone(),
            rows: rows.into_iter().flatten().flatten().collect(),
        })
    }

    /// None where it was stopped.
    fn simulate(
        &self,
        rig: &Rig,
        report: &(dyn Fn() -> ControlFlow<()> + Sync),
    ) -> Option<Result<Drawn, RigError>> {
        let statistician = match statistician() {
            Ok(statistician) => statistician,
            Err(error) => return Some(Err(error.into())),
        };
        let mut drawing = Drawing {
            set: self,
            statistician,
            progress: &mut |_| report(),
        };
        let drawn = match drawing.rows(rig) {
            Ok(rows) => Ok(rows),
            Err(NoRig::Failed(reason)) => Err(reason),
            Err(NoRig::Stopped) => return None,
        };
        let kept = self.store.write(rig.number, &drawn);
        Some(kept.map(|()| drawn).map_err(|source| RigError::File {
            path: self.store.folder().to_owned(),
            source,
        }))
    }

    /// The row of a measured campaign: means of what its runs read, condition by condition.
    pub fn measured(&self, runs: &[Vec<Run>]) -> Vec<f32> {
        let mean = |column: &Column| {
            let own = runs.get(column.condition).into_iter().flatten();
            let values = own.filter_map(|run| Some(run.readings.get(&column.cell)?.value));
            let values: Vec<f64> = values.collect();
            (values.iter().sum::<f64>() / values.len() as f64) as f32
        };
        self.population.columns.iter().map(mean).collect()
    }
}

/// Progress of threads that draw rigs.
struct Counter<'p> {
    total: u64,
    done: AtomicU64,
    stopped: AtomicBool,
    progress: &'p (dyn Fn(Progress) -> ControlFlow<()> + Sync),
}

impl Counter<'_> {
    /// Reports the progress; `Break` to stop.
    fn report(&self) -> ControlFlow<()> {
        let now = Progress {
            done: self.done.load(Ordering::Relaxed),
            total: self.total,
        };
        if self.stopped.load(Ordering::Relaxed) || (self.progress)(now).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    /// Counts one more rig; `Stopped` where a stop is requested and rigs remain.
    fn add(&self) -> Result<(), RigError> {
        self.done.fetch_add(1, Ordering::Relaxed);
        let is_complete = || self.done.load(Ordering::Relaxed) >= self.total;
        match self.report() {
            ControlFlow::Break(()) if !is_complete() => Err(self.error()),
            _ => Ok(()),
        }
    }

    fn error(&self) -> RigError {
        RigError::Stopped {
            done: self.done.load(Ordering::Relaxed),
            total: self.total,
        }
    }
}

impl Population {
    /// Statistics of runs of the scenario as it is, case by case: those that rigs are read by.
    pub fn columns(nominal: &[Run]) -> Vec<Column> {
        let runs = nominal.iter().enumerate();
        let columns = runs.flat_map(|(condition, run)| {
            run.readings.iter().map(move |(cell, reading)| Column {
                condition,
                cell: cell.clone(),
                size: reading.size,
            })
        });
        columns.collect()
    }

    /// Hash of all that determines the rigs.
    fn hash(&self, origin: Origin) -> String {
        let mut text = format!("{METHOD}\n{}\nseed {}\n", origin.version, origin.seed.0);
        for case in &self.cases {
            text += &format!("{}{}", case.reading(), case.scenario.to_toml());
        }
        for candidate in &self.candidates {
            text += &format!("{} {:?}\n", candidate.name(), candidate.seat.levels);
        }
        for parameter in &self.parameters {
            text += &format!("{} {:?}\n", parameter.name, parameter.sd);
        }
        for column in &self.columns {
            text += &format!("{} {}\n", column.condition, column.cell);
        }
        sealed::hash(text.as_bytes())
    }
}
