//! The file that starts the program: parts of its work run in processes of their own.

use std::io;
use std::path::PathBuf;
use std::sync::OnceLock;

static FILE: OnceLock<PathBuf> = OnceLock::new();

/// States the file, where it is not that of this process, as under an interpreter.
pub fn set(file: PathBuf) {
    // The first statement holds: a process is one program.
    let _ = FILE.set(file);
}

/// The file.
///
/// # Errors
/// Where the system does not know the file of this process.
pub fn file() -> io::Result<PathBuf> {
    FILE.get().cloned().map_or_else(std::env::current_exe, Ok)
}
