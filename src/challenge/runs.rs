//! Runs of the rigs of a trial.

use super::design::{Design, assignment};
use super::truth::{Edit, Hidden, Truth};
use crate::quantity::{RangeError, Seed};
use crate::scenario::experiment::ExperimentError;
use crate::scenario::recording::Recording;
use crate::scenario::{Scenario, ScenarioError};
use crate::trace::Trace;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Why there are no runs.
#[derive(Debug)]
pub(super) enum NoRuns {
    /// They cannot be simulated.
    Failed(String),
    /// The caller stopped.
    Stopped,
}

impl From<ScenarioError> for NoRuns {
    fn from(error: ScenarioError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<RangeError> for NoRuns {
    fn from(error: RangeError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<ExperimentError> for NoRuns {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Stopped => Self::Stopped,
            other => Self::Failed(other.to_string()),
        }
    }
}

/// Called with the progress of a run, its simulated time [s].
type OnTime<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Simulates runs on several threads and reports what is done.
pub(super) struct Runner<'a> {
    progress: &'a (dyn Fn(f64) -> ControlFlow<()> + Sync),
    stopped: AtomicBool,
}

impl<'a> Runner<'a> {
    /// `progress` is called with every step \[s\], and may stop.
    pub(super) fn new(progress: &'a (dyn Fn(f64) -> ControlFlow<()> + Sync)) -> Self {
        Self {
            progress,
            stopped: AtomicBool::new(false),
        }
    }

    /// Reports so much simulated time \[s\]; `Break` to stop.
    pub(super) fn report(&self, simulated: f64) -> ControlFlow<()> {
        if self.stopped.load(Ordering::Relaxed) || (self.progress)(simulated).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    /// A run as a rig would have measured it.
    pub(super) fn run(
        &self,
        scenario: &Scenario,
        seed: Seed,
        number: u64,
    ) -> Result<Trace, NoRuns> {
        let trace = self.reported(scenario, |on_time| scenario.run(seed, number, on_time))?;
        Ok(trace.as_measured())
    }

    /// The motion of a run, to be measured by several sets of sensors.
    pub(super) fn record(
        &self,
        scenario: &Scenario,
        seed: Seed,
        number: u64,
    ) -> Result<Recording, NoRuns> {
        self.reported(scenario, |on_time| scenario.record(seed, number, on_time))
    }

    fn reported<T>(
        &self,
        scenario: &Scenario,
        simulate: impl FnOnce(OnTime) -> Result<T, ExperimentError>,
    ) -> Result<T, NoRuns> {
        let mut before = 0.0;
        let simulated = simulate(&mut |time| {
            let step = time - before;
            before = time;
            self.report(step)
        })?;
        // A request to stop is honoured by the next run.
        let _ = self.report(scenario.driven() - before);
        Ok(simulated)
    }
}

/// A rig that differs from its scenario by these edits, at the physics rate of the campaigns.
pub(super) fn rig(design: &Design, edits: &[Edit]) -> Result<Scenario, ScenarioError> {
    let edits = edits.iter().map(|edit| assignment(&edit.key, edit.value));
    let rate = assignment("physics_rate", design.physics_rate.hertz());
    let edits: Vec<String> = edits.chain([rate]).collect();
    design.scenario.with_all(&edits)
}

/// The rig of a case with some of its effects.
pub(super) fn affected(
    truth: &Truth,
    design: &Design,
    effects: &[Hidden],
) -> Result<Scenario, NoRuns> {
    let mut scenario = rig(design, &truth.edits)?;
    for hidden in effects {
        let effect = hidden.application();
        let effect = effect.map_err(|error| NoRuns::Failed(error.to_string()))?;
        scenario = scenario.with_effect(&effect)?;
    }
    Ok(scenario)
}
