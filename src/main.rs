//! The program: runs one command and tells by its exit code how that went.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::read_arguments();
    match cli::run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => cli::failure::report(&error, cli.is_json()),
    }
}
