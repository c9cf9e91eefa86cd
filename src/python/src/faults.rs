//! Errors as the package's exceptions, with the words of the program.

use lugwheel::cli::failure::Failure;
use lugwheel::dataset::hdf5::RunFileError;
use lugwheel::scenario::ScenarioError;
use pyo3::prelude::*;
use std::fmt::Display;

/// The exception of a failed command.
pub fn of_command(py: Python<'_>, failure: &Failure) -> PyErr {
    let Failure {
        kind,
        message,
        file,
        line,
        ..
    } = failure;
    raised(py, kind, message, (file.as_deref(), *line))
}

/// The exception of a scenario that is none.
pub fn of_scenario(py: Python<'_>, error: &ScenarioError) -> PyErr {
    let place = match error {
        ScenarioError::Invalid(fault) => (Some(fault.file.as_str()), Some(fault.line)),
        _ => (None, None),
    };
    raised(py, "invalid_input", &error.to_string(), place)
}

/// The exception of a run file that cannot be read or written.
pub fn of_run_file(py: Python<'_>, error: &RunFileError) -> PyErr {
    let file = error.path().display().to_string();
    raised(py, "invalid_input", &error.to_string(), (Some(&file), None))
}

/// The exception of a computation that failed.
pub fn of_computation(py: Python<'_>, error: &impl Display) -> PyErr {
    raised(py, "failed", &error.to_string(), (None, None))
}

type Place<'a> = (Option<&'a str>, Option<usize>);

fn raised(py: Python<'_>, kind: &str, message: &str, (file, line): Place<'_>) -> PyErr {
    let made = py
        .import("lugwheel.errors")
        .and_then(|errors| errors.getattr("of_kind"))
        .and_then(|of_kind| of_kind.call1((kind, message, file, line)));
    match made {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}
