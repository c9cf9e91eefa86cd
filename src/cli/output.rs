//! Output of a command: text and files.

use super::console::Attached;
use crate::whole_file;
use anyhow::Context;
use clap::Args;
use serde::Serialize;
use std::fmt::Display;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Output options of every command.
#[derive(Debug, Clone, Args)]
pub struct Output {
    /// Print the result as one JSON document
    #[arg(long, global = true)]
    pub json: bool,
    /// Show no progress
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Replace existing results; never an input or a write-protected file
    #[arg(long, global = true)]
    pub force: bool,
    #[arg(skip)]
    pub console: Attached,
}

impl Output {
    /// Prints the result of a command to stdout, or hands it to the calling program.
    ///
    /// # Errors
    /// Where stdout refuses; not where its reader has left, as `head` does.
    pub fn print(&self, result: &(impl Serialize + Display)) -> anyhow::Result<()> {
        let text = if self.json {
            serde_json::to_string_pretty(result)?
        } else {
            result.to_string()
        };
        let printed = match self.console.caller() {
            Some(console) => console.result(text.trim_end()),
            None => print_line(text.trim_end()),
        };
        match printed {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            other => other.context("cannot write to stdout"),
        }
    }
}

fn print_line(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "{text}")?;
    stdout.flush()
}

/// The file asked for, or `name` in the folder of results named `of`.
pub fn file_or_default(asked: Option<&Path>, of: &str, name: &str) -> PathBuf {
    let default = || Path::new("output").join(of).join(name);
    asked.map_or_else(default, Path::to_owned)
}

/// Way out of a refused place, in most commands.
pub const ELSEWHERE: &str = "name another place with --out";

/// That the system refuses to do something with a file or folder: its reason, and the way out, for which
/// `elsewhere` names the option for another place.
pub fn refused(action: &str, path: &Path, error: &io::Error, elsewhere: &str) -> anyhow::Error {
    let reason = whole_file::reason(error);
    let way_out = whole_file::way_out(&reason, elsewhere);
    anyhow::anyhow!("cannot {action} {}: {reason}; {way_out}", path.display())
}

/// Makes a folder and those above it, if need be.
pub fn make_folder(folder: &Path) -> anyhow::Result<()> {
    make_folder_or(folder, ELSEWHERE)
}

/// The same where another place is named otherwise.
pub fn make_folder_or(folder: &Path, elsewhere: &str) -> anyhow::Result<()> {
    fs::create_dir_all(folder)
        .map_err(|error| refused("make the folder", folder, &error, elsewhere))
}

/// Removes a file, if it is there.
pub fn remove_file(path: &Path) -> anyhow::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(refused("remove", path, &error, ELSEWHERE))
        }
        _ => Ok(()),
    }
}

/// Writes a whole file or nothing.
pub fn write_file(path: &Path, content: impl AsRef<[u8]>) -> anyhow::Result<()> {
    write_file_or(path, content, ELSEWHERE)
}

/// The same where another place is named otherwise.
pub fn write_file_or(
    path: &Path,
    content: impl AsRef<[u8]>,
    elsewhere: &str,
) -> anyhow::Result<()> {
    whole_file::write(path, content.as_ref())
        .map_err(|error| refused("write", path, &error, elsewhere))
}
