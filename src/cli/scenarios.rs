//! `scenarios`: the ready scenarios and studies.

use super::documents;
use super::output::Output;
use crate::scenario::ready::{self, ReadyDocument};
use clap::Args;
use serde::Serialize;
use std::fmt;

/// List the scenarios and studies that are part of the program
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Scenarios {
    /// Print the text of one; studies/NAME for a study with the name of a scenario
    #[arg(long, value_name = "NAME")]
    show: Option<String>,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel scenarios
  lugwheel scenarios --show single_wheel_st
  lugwheel new my_rig --from single_wheel_st";

impl Scenarios {
    /// Prints the list, or the text of one.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        match &self.show {
            Some(name) => output.print(&Shown::of(documents::ready(name)?)),
            None => output.print(&Listed {
                scenarios: ready::scenarios().iter().map(Entry::of).collect(),
                studies: ready::studies().iter().map(Entry::of).collect(),
            }),
        }
    }
}

/// All documents.
#[derive(Debug, Serialize)]
struct Listed {
    scenarios: Vec<Entry>,
    studies: Vec<Entry>,
}

/// A document of the list.
#[derive(Debug, Serialize)]
struct Entry {
    name: &'static str,
    summary: &'static str,
}

impl Entry {
    fn of(document: &'static ReadyDocument) -> Self {
        Self {
            name: document.name,
            summary: document.summary(),
        }
    }
}

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Scenarios (`lugwheel simulate NAME`):")?;
        write_entries(f, &self.scenarios)?;
        writeln!(f, "\nStudies (`lugwheel study NAME`):")?;
        write_entries(f, &self.studies)?;
        writeln!(
            f,
            "\n`lugwheel scenarios --show NAME` prints one, `lugwheel new NAME` writes a scenario to edit."
        )
    }
}

fn write_entries(f: &mut fmt::Formatter<'_>, entries: &[Entry]) -> fmt::Result {
    for Entry { name, summary } in entries {
        writeln!(f, "  {name:<24}{summary}")?;
    }
    Ok(())
}

/// The text of a document.
#[derive(Debug, Serialize)]
struct Shown {
    name: &'static str,
    text: &'static str,
}

impl Shown {
    fn of(document: &'static ReadyDocument) -> Self {
        let ReadyDocument { name, text } = document;
        Self { name, text }
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text)
    }
}
