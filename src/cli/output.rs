//! Where a command's words and files go.

use anyhow::Context;
use clap::Args;
use lugwheel::whole_file;
use serde::Serialize;
use std::fmt::Display;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// How a command talks.
#[derive(Debug, Clone, Copy, Args)]
pub struct Output {
    /// Print the result as one JSON document
    #[arg(long, global = true)]
    pub json: bool,
    /// Show no progress
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

impl Output {
    /// Prints the result of a command to stdout.
    ///
    /// # Errors
    /// Where stdout refuses; not where its reader has left, as `head` does.
    pub fn print(&self, result: &(impl Serialize + Display)) -> anyhow::Result<()> {
        let text = if self.json {
            serde_json::to_string_pretty(result)?
        } else {
            result.to_string()
        };
        let mut stdout = io::stdout().lock();
        let printed = writeln!(stdout, "{}", text.trim_end()).and_then(|()| stdout.flush());
        match printed {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            other => other.context("cannot write to stdout"),
        }
    }
}

/// The file asked for, or `name` in the folder of results named `of`, which is made if need be.
pub fn file_or_default(asked: Option<&Path>, of: &str, name: &str) -> anyhow::Result<PathBuf> {
    if let Some(path) = asked {
        return Ok(path.to_owned());
    }
    let folder = Path::new("output").join(of);
    make_folder(&folder)?;
    Ok(folder.join(name))
}

/// Makes a folder and those above it, if need be.
pub fn make_folder(folder: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(folder).with_context(|| {
        let folder = folder.display();
        format!("cannot make the folder {folder}; name another place with --out")
    })
}

/// Removes a file, if it is there.
pub fn remove_file(path: &Path) -> anyhow::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", path.display()))
        }
        _ => Ok(()),
    }
}

/// Writes a whole file or nothing.
pub fn write_file(path: &Path, content: &str) -> anyhow::Result<()> {
    whole_file::write(path, content.as_bytes()).map_err(|error| {
        anyhow::anyhow!(
            "cannot write {}: {error}; name another place with --out",
            path.display()
        )
    })
}
