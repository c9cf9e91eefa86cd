//! `inspect`: what is in a run file, checked.

use super::output::Output;
use clap::Args;
use lugwheel::dataset::hdf5::RunFile;
use lugwheel::dataset::inspection;
use std::path::PathBuf;

/// Say what is in a run file, and what is odd about it
///
/// Channels with units, rates, gaps and means, and findings: clipped or constant channels, units
/// and signs that look wrong, labels that the channels contradict. Nothing is changed.
#[derive(Debug, Args)]
pub struct Inspect {
    /// Run file, simulated or measured
    #[arg(value_name = "FILE.h5")]
    file: PathBuf,
}

impl Inspect {
    /// Inspects the file.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let file = RunFile::open(&self.file)?;
        output.print(&inspection::inspect(&file))
    }
}
