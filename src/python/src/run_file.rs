//! Run files: read and written.

use crate::faults;
use crate::run::Run;
use lugwheel::dataset::Provenance;
use lugwheel::dataset::hdf5::{self, RunFileWriter};
use lugwheel::quantity::Seed;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A run file that is open.
#[pyclass(frozen, module = "lugwheel._native")]
pub struct RunFile(hdf5::RunFile);

#[pymethods]
impl RunFile {
    /// Opens it.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let opened = hdf5::RunFile::open(path);
        opened
            .map(Self)
            .map_err(|error| faults::of_run_file(py, &error))
    }

    /// Its runs.
    #[getter]
    fn runs(&self) -> Vec<String> {
        self.0.runs().to_vec()
    }

    /// Reads one of its runs.
    fn read(&self, py: Python<'_>, id: &str) -> PyResult<Run> {
        let read = py.detach(|| self.0.read(id));
        read.map(Run)
            .map_err(|error| faults::of_run_file(py, &error))
    }

    /// The text of the scenario that was simulated.
    #[getter]
    fn scenario(&self) -> Option<String> {
        self.0.provenance().scenario.clone()
    }

    /// The seed of a simulation.
    #[getter]
    fn seed(&self) -> Option<u64> {
        self.0.provenance().seed.map(|Seed(seed)| seed)
    }
}

/// Writes runs, each with its name, to a new file; `scenario` and `seed` where all are
/// simulated from it.
#[pyfunction]
#[pyo3(signature = (path, runs, scenario=None, seed=None))]
pub fn write_runs(
    py: Python<'_>,
    path: PathBuf,
    runs: Vec<(String, PyRef<'_, Run>)>,
    scenario: Option<&str>,
    seed: Option<u64>,
) -> PyResult<()> {
    let provenance = match (scenario, seed) {
        (Some(scenario), Some(seed)) => Provenance::simulated(scenario, Seed(seed)),
        _ => Provenance::measured(),
    };
    let fault = |error| faults::of_run_file(py, &error);
    let mut file = RunFileWriter::create(path, &provenance).map_err(fault)?;
    for (id, run) in &runs {
        file.add(id, &run.0).map_err(fault)?;
    }
    file.finish().map_err(fault)
}
