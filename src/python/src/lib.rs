//! What the Python package does in Rust: scenarios and their runs as arrays, run files, and the program's commands.
//!
//! Every computation releases the interpreter's lock and runs on a thread of its own, while the calling thread
//! listens for signals: Ctrl-C stops it as in a terminal.

mod command;
mod faults;
mod run;
mod run_file;
mod scenario;
mod watch;

/// The native part of the package `lugwheel`.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::command::{call, main};
    #[pymodule_export]
    use super::run::Run;
    #[pymodule_export]
    use super::run_file::{RunFile, write_runs};
    #[pymodule_export]
    use super::scenario::{Scenario, ready_scenarios};

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
