//! `inspect`: what is in a run file, checked.

use super::output::Output;
use crate::dataset::hdf5::RunFile;
use crate::dataset::inspection::{Inspection, Severity, inspect};
use clap::Args;
use std::path::{Path, PathBuf};

/// List the contents of a run file and check them for errors of units, signs and offsets
///
/// Channels with units, rates, gaps and means, and findings: clipped or constant channels, units
/// and signs that look wrong, loads that no wheel can have, labels that the channels contradict.
/// Nothing is changed. Exits with 3 where a finding is an error, a run that cannot be read among them.
#[derive(Debug, Args)]
pub struct Inspect {
    /// Run file, simulated or measured
    #[arg(value_name = "FILE.h5")]
    file: PathBuf,
    /// Exit with 3 on warnings too
    #[arg(long)]
    strict: bool,
}

/// A file that should not be used as it is, by its printed inspection.
#[derive(Debug, thiserror::Error)]
#[error("{}: {findings}; see above", file.display())]
pub struct Doubtful {
    file: PathBuf,
    findings: String,
}

impl Inspect {
    /// Inspects the file.
    ///
    /// # Errors
    /// [`Doubtful`] after printing, where a finding is an error, or with `--strict` a warning; those of opening
    /// the file.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let file = RunFile::open(&self.file)?;
        let inspection = inspect(&file);
        output.print(&inspection)?;
        let least = if self.strict {
            Severity::Warning
        } else {
            Severity::Error
        };
        if inspection.count(least) > 0 {
            return Err(doubtful(&self.file, &inspection).into());
        }
        Ok(())
    }
}

fn doubtful(file: &Path, inspection: &Inspection) -> Doubtful {
    let errors = inspection.count(Severity::Error);
    let warnings = inspection.count(Severity::Warning) - errors;
    let counted = |count: usize, what: &str| {
        let plural = if count == 1 { "" } else { "s" };
        (count > 0).then(|| format!("{count} {what}{plural}"))
    };
    let findings = [counted(errors, "error"), counted(warnings, "warning")];
    Doubtful {
        file: file.to_owned(),
        findings: findings
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(", "),
    }
}
