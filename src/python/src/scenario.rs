//! Scenarios: read, edited, simulated.

use crate::faults;
use crate::run::Run;
use crate::watch::Watch;
use lugwheel::cli::console::Console;
use lugwheel::quantity::Seed;
use lugwheel::scenario;
use lugwheel::scenario::ready;
use pyo3::prelude::*;
use std::ops::ControlFlow;

/// Names and texts of the scenarios that are part of the program.
#[pyfunction]
pub fn ready_scenarios() -> Vec<(&'static str, &'static str)> {
    let documents = ready::scenarios().iter();
    documents
        .map(|document| (document.name, document.text))
        .collect()
}

/// A scenario that has been checked.
#[pyclass(frozen, module = "lugwheel._native")]
pub struct Scenario(scenario::Scenario);

#[pymethods]
impl Scenario {
    /// Reads a scenario's text; `file` is its name in messages, `assignments` are `key=value`.
    #[new]
    fn new(py: Python<'_>, text: &str, file: &str, assignments: Vec<String>) -> PyResult<Self> {
        scenario::Scenario::from_toml(text, file)
            .and_then(|scenario| scenario.with_all(&assignments))
            .map(Self)
            .map_err(|error| faults::of_scenario(py, &error))
    }

    /// This scenario with keys set.
    fn with_all(&self, py: Python<'_>, assignments: Vec<String>) -> PyResult<Self> {
        let edited = self.0.with_all(&assignments);
        edited
            .map(Self)
            .map_err(|error| faults::of_scenario(py, &error))
    }

    /// Its text, as read and edited.
    #[getter]
    fn text(&self) -> &str {
        self.0.text()
    }

    /// All of its values, defaults included, as a JSON document.
    #[getter]
    fn values(&self, py: Python<'_>) -> PyResult<String> {
        serde_json::to_string(&self.0).map_err(|error| faults::of_computation(py, &error))
    }

    /// Simulates one run; `listener` is called with stage and share \[0 to 1\].
    #[pyo3(signature = (seed, run, listener=None))]
    fn run(
        &self,
        py: Python<'_>,
        seed: u64,
        run: u64,
        listener: Option<Py<PyAny>>,
    ) -> PyResult<Run> {
        let watch = Watch::default();
        let work = || {
            self.0.run(Seed(seed), run, &mut |time| {
                watch.progress("simulation", (time / self.0.driven()).min(1.0));
                if watch.is_stopped() {
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            })
        };
        let simulated = watch.over(py, listener.as_ref(), work)?;
        let trace = simulated.map_err(|error| faults::of_computation(py, &error))?;
        Ok(Run(trace.as_kept()))
    }
}
