//! Runs on disk: labelled data sets from the simulator and campaigns from a test rig, in one format.
//!
//! A data set is a file of runs. Each run is a [`Trace`](crate::trace::Trace) under an id, and the file
//! records their origin ([`Provenance`]). A measured run may have any subset of the channels, each as a time
//! series or as a steady mean; only a simulated one has ground truth. [`csv`] imports logs of a rig,
//! [`inspection`] checks consistency, [`records`] are tables about runs.

pub mod csv;
#[cfg(feature = "hdf5")]
pub mod hdf5;
#[cfg(feature = "hdf5")]
pub mod inspection;
pub mod records;

use crate::quantity::Seed;

/// Where the runs of a file come from.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// The scenario as TOML text; `None` for measured runs.
    pub scenario: Option<String>,
    /// The seed of all runs; `None` for measured runs.
    pub seed: Option<Seed>,
    /// The program that wrote the file, with its version.
    pub created_by: String,
}

impl Provenance {
    /// Runs simulated by this program.
    pub fn simulated(scenario: impl Into<String>, seed: Seed) -> Self {
        Self {
            scenario: Some(scenario.into()),
            seed: Some(seed),
            ..Self::measured()
        }
    }

    /// Runs measured elsewhere and gathered by this program.
    pub fn measured() -> Self {
        Self {
            scenario: None,
            seed: None,
            created_by: concat!("lugwheel ", env!("CARGO_PKG_VERSION")).to_owned(),
        }
    }
}

/// Checks that a run or channel can have this name in a file.
///
/// # Errors
/// The reason, in words.
fn check_name(what: &str, name: &str) -> Result<(), String> {
    if name.is_empty() || name == "." || name == ".." || name.contains(['/', '\0']) {
        return Err(format!("{what} {name:?} must be a name without \"/\""));
    }
    Ok(())
}
