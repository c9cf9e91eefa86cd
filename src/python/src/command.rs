//! The program's commands inside of the interpreter.

use crate::faults;
use crate::watch::Watch;
use lugwheel::cli;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

/// Runs a command of the program: its documents and its warnings.
///
/// `listener` is called with stage and share \[0 to 1\]. With `partial`, a command that failed after it gave a
/// result returns that.
#[pyfunction]
#[pyo3(signature = (arguments, listener=None, partial=false))]
pub fn call(
    py: Python<'_>,
    arguments: Vec<OsString>,
    listener: Option<Py<PyAny>>,
    partial: bool,
) -> PyResult<(Vec<String>, Vec<String>)> {
    let watch = Arc::new(Watch::default());
    let console = Arc::clone(&watch);
    let work = move || cli::call(arguments, console);
    let done = watch.over(py, listener.as_ref(), work)?;
    let results = watch.results();
    match done {
        Err(failure) if results.is_empty() || !partial => Err(faults::of_command(py, &failure)),
        _ => Ok((results, watch.warnings())),
    }
}

/// The program itself, started by the file `program` with these arguments behind its name; its exit code.
#[pyfunction]
pub fn main(py: Python<'_>, program: PathBuf, arguments: Vec<OsString>) -> u8 {
    py.detach(|| cli::main(arguments, Some(program)))
}
