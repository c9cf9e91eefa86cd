//! Runs and stretches that are not used.

use serde::Serialize;

/// A run that was not used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Its name.
    pub run: String,
    /// Why.
    pub reason: String,
}

/// A stretch that was not used, of a run with others that were.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StretchLeftOut {
    /// The run.
    pub run: String,
    /// Its middle half [s], which would have been the row.
    pub interval_s: [f64; 2],
    /// Why.
    pub reason: String,
}

/// What was not used in any fit.
#[derive(Debug, Clone, Default)]
pub struct Unused {
    /// Runs.
    pub runs: Vec<LeftOut>,
    /// Stretches of runs.
    pub stretches: Vec<StretchLeftOut>,
}
