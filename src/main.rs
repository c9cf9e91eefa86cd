//! The program: runs one command and tells by its exit code how that went.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::run(&cli::read_arguments()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => cli::failure::report(&error),
    }
}
