//! What the features of each condition are taken over, found once.

use super::recognition::{Recognition, ReferenceRuns};
use super::table::{NoRows, Stop};
use super::{Run, Study};
use crate::features::reference::Reference;
use crate::scenario::Scenario;
use crate::scenario::experiment::ExperimentError;
use std::sync::{Mutex, PoisonError};

/// The references of a study.
pub(super) struct References<'s> {
    study: &'s Study,
    recognition: &'s Recognition,
    /// By number of the reference run, or of the condition where there are none.
    found: Vec<Mutex<Option<Found>>>,
}

/// A reference, or why there is none.
type Found = Result<Reference, String>;

impl<'s> References<'s> {
    pub(super) fn new(study: &'s Study, recognition: &'s Recognition) -> Self {
        let found = (0..study.condition_count()).map(|_| Mutex::default());
        Self {
            study,
            recognition,
            found: found.collect(),
        }
    }

    /// The reference of a run. It depends on the study and the run's condition only.
    ///
    /// # Errors
    /// `Stopped` on request of `stop`; `Failed` where the reference run fails or is no reference.
    pub(super) fn of(&self, run: &Run, stop: &mut Stop) -> Result<Reference, NoRows> {
        let number = match &self.recognition.reference {
            Some(runs) => runs.of_condition(run.condition),
            None => run.condition as usize,
        };
        // What a panic left behind is nothing: it is found anew.
        let place = self.found[number].lock();
        let mut place = place.unwrap_or_else(PoisonError::into_inner);
        if place.is_none() {
            *place = Some(match &self.recognition.reference {
                Some(runs) => self.measured(runs, number, stop)?,
                None => self.computed(&self.study.scenario(run)),
            });
        }
        let found = place.clone().expect("it was found above");
        found.map_err(|reason| NoRows::Failed(format!("its reference: {reason}")))
    }

    /// From a run on the reference ground. It draws from a stream beyond those of the study's runs,
    /// so that no window is divided by its own noise.
    fn measured(
        &self,
        runs: &ReferenceRuns,
        number: usize,
        stop: &mut Stop,
    ) -> Result<Found, NoRows> {
        let scenario = runs.scenario(self.study, number);
        let stream = self.study.run_count() + number as u64;
        let trace = match scenario.run(self.study.seed, stream, stop) {
            Ok(trace) => trace,
            Err(ExperimentError::Stopped) => return Err(NoRows::Stopped),
            Err(error) => return Ok(Err(error.to_string())),
        };
        // Its windows are those of the runs, not those of its own scenario.
        let of_runs = self.study.scenario_of(runs.first_condition(number));
        let reference = Reference::measured([&trace], self.recognition.settings(&of_runs));
        Ok(reference.map_err(|error| error.to_string()))
    }

    fn computed(&self, scenario: &Scenario) -> Found {
        let settings = self.recognition.settings(scenario);
        let computed = scenario.computed_reference(settings);
        computed.map_err(|error| error.to_string())
    }
}
