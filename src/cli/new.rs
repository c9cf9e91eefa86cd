//! `new`: a scenario or study to edit.

use super::documents;
use super::output::{self, Output};
use super::provenance::quoted;
use super::target::Claim;
use crate::scenario::ready::ReadyDocument;
use clap::Args;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Write a commented scenario file to start from
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct New {
    /// Name of the file, with or without .toml
    #[arg(value_name = "NAME")]
    name: PathBuf,
    /// Ready scenario to copy; studies/NAME for a study
    #[arg(long, value_name = "NAME", default_value = "single_wheel_st")]
    from: String,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel new my_rig
  lugwheel new rigs/rover --from rover_gt
  lugwheel new my_study --from studies/sweep_slip

`lugwheel keys` lists every key that a scenario can have.";

/// What was written.
#[derive(Debug, Serialize)]
struct Written {
    file: String,
    from: &'static str,
    #[serde(skip)]
    next: String,
}

impl New {
    /// Writes the file.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let document = documents::ready(&self.from)?;
        let file = documents::with_ending(&self.name);
        let claim = output.claim(&[]);
        let claim = Claim {
            elsewhere: "give another name",
            ..claim
        };
        claim.file(&file)?;
        output::write_file_or(&file, introduced(document), claim.elsewhere)?;
        let command = if documents::is_study(document) {
            "study"
        } else {
            "simulate"
        };
        output.print(&Written {
            file: file.display().to_string(),
            from: document.name,
            next: format!("lugwheel {command} {}", quoted(&file)),
        })
    }
}

/// The text of a document, with its origin as the second line.
fn introduced(document: &ReadyDocument) -> String {
    let (first, rest) = document
        .text
        .split_once('\n')
        .unwrap_or((document.text, ""));
    let version = env!("CARGO_PKG_VERSION");
    let origin = format!(
        "# Copied from {} of lugwheel {version}; `lugwheel keys` lists every key.",
        document.name
    );
    format!("{first}\n{origin}\n{rest}")
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "written to {}; edit it, then: {}", self.file, self.next)
    }
}
