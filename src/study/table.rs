//! A table to which every run of a study adds rows.
//!
//! A cell is empty where a value does not exist. Numbers have as many digits as bring the same
//! number back.

use super::{Run, Study};
use crate::scenario::experiment::ExperimentError;
use crate::trace::Trace;
use std::ops::ControlFlow;

/// Rows of cells.
pub(super) type Rows = Vec<Vec<String>>;

/// Hears the simulated time [s] of what is simulated for a table, and may stop it.
pub(super) type Stop<'p> = dyn FnMut(f64) -> ControlFlow<()> + 'p;

/// A table to which every run adds rows. The rows of a run depend on nothing but the study and the
/// run.
pub(super) trait Table: Sync {
    /// Name of its file without the ending.
    fn name(&self) -> &'static str;

    /// Names of the columns.
    fn header(&self) -> Vec<String>;

    /// The rows of a run.
    ///
    /// # Errors
    /// `NoRows` stops the study or says why the run failed, though it left a trace.
    fn rows(&self, run: &Run, trace: &Trace, stop: &mut Stop) -> Result<Rows, NoRows>;

    /// The rows of a run that failed, for this table or another.
    fn rows_of_failed(&self, run: &Run, reason: &str) -> Rows;
}

/// Why a run has no rows.
#[derive(Debug, thiserror::Error)]
pub(super) enum NoRows {
    /// The caller stopped the study.
    #[error("stopped")]
    Stopped,
    /// The run failed, for this reason.
    #[error("{0}")]
    Failed(String),
}

impl From<ExperimentError> for NoRows {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Stopped => Self::Stopped,
            other => Self::Failed(other.to_string()),
        }
    }
}

/// A line of CSV.
pub(super) fn line(cells: &[String]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = writer.write_record(cells);
    written.expect("memory takes a record of any length");
    let bytes = writer.into_inner().expect("memory needs no flushing");
    String::from_utf8(bytes).expect("cells are texts")
}

/// The scenario of a run and the values of its swept keys.
pub(super) fn condition_cells(study: &Study, run: &Run) -> Vec<String> {
    let scenario = study.scenario_name(run).to_owned();
    let values = study.values(run).map(bare);
    std::iter::once(scenario).chain(values).collect()
}

/// A number that reads back as itself.
pub(super) fn cell(value: Option<f64>) -> String {
    let finite = value.filter(|value| value.is_finite());
    finite.map_or_else(String::new, |value| format!("{value:?}"))
}

/// A TOML value without the quotes of a text.
pub(super) fn bare(value: &str) -> String {
    value.trim_matches('"').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_in_a_cell_reads_back_as_itself() {
        for value in [0.1 + 0.2, 1.0e-300, 123_456_789.123_456_79, -0.0] {
            assert_eq!(
                cell(Some(value)).parse::<f64>().unwrap().to_bits(),
                value.to_bits()
            );
        }
        assert_eq!(cell(Some(f64::NAN)), "");
    }
}
