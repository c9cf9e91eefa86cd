//! What simulating costs, by a timed trial.

use super::condition::{Case, statistician};
use crate::quantity::{RangeError, Seed};
use crate::scenario::experiment::ExperimentError;
use serde::Serialize;
use std::fmt;
use std::ops::ControlFlow;
use std::time::Instant;

/// What one run took on this machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Core-seconds [-] that a second of motion takes.
    pub motion: f64,
    /// Core-seconds [-] that measuring and reading a second of it takes.
    pub measurement: f64,
}

/// Why a trial came to nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrialError {
    /// The run of the scenario as shipped failed.
    #[error("the scenario as shipped does not run: {0}")]
    Run(#[from] ExperimentError),
    /// Statistics cannot be taken.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// There is no case.
    #[error("there is no condition to try")]
    NoCase,
}

impl Trial {
    /// Times a run of the case of middle length, alone on this thread.
    ///
    /// # Errors
    /// `Run` where it fails or `progress` stops it; `NoCase` where there is none.
    pub fn of(
        cases: &[Case],
        seed: Seed,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, TrialError> {
        let mut cases: Vec<&Case> = cases.iter().collect();
        cases.sort_by(|a, b| a.scenario.driven().total_cmp(&b.scenario.driven()));
        let case = *cases.get(cases.len() / 2).ok_or(TrialError::NoCase)?;
        let start = Instant::now();
        let recording = case.scenario.record(seed, 0, progress)?;
        let moved = start.elapsed().as_secs_f64();
        let experiment = case.scenario.experiment();
        let sensors = experiment.map_err(ExperimentError::from)?.sensors;
        let trace = recording.measure(&sensors)?;
        case.read_simulated(&mut statistician()?, &trace);
        let measured = start.elapsed().as_secs_f64() - moved;
        Ok(Self {
            motion: moved / case.scenario.driven(),
            measurement: measured / case.scenario.duration,
        })
    }
}

/// What simulating takes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Cost {
    /// Motions to be simulated.
    pub motions: u64,
    /// Times that one is measured and read.
    pub measurements: u64,
    /// Time of one core [s].
    pub core_seconds: f64,
}

impl Cost {
    pub(super) fn add(&mut self, trial: &Trial, case: &Case, [motions, measurements]: [u64; 2]) {
        self.motions += motions;
        self.measurements += measurements;
        self.core_seconds += motions as f64 * trial.motion * case.scenario.driven()
            + measurements as f64 * trial.measurement * case.scenario.duration;
    }

    /// Time [s] that it takes on so many threads.
    pub fn seconds(&self, threads: usize) -> f64 {
        self.core_seconds / threads.max(1) as f64
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            motions,
            measurements,
            core_seconds,
        } = self;
        write!(
            f,
            "{measurements} runs of {motions} motions, {core_seconds:.0} core-seconds"
        )
    }
}
