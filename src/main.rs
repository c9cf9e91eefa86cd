//! The program: runs one command and reports by its exit code how that went.

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = std::env::args_os().skip(1).collect();
    ExitCode::from(lugwheel::cli::main(arguments, None))
}
