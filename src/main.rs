//! The program: runs one command and reports by its exit code how that went.

use lugwheel::cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::read_arguments();
    match cli::run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => cli::failure::report(&error, cli.is_json()),
    }
}
