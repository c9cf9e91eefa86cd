//! A table to which every run of a study adds rows.

use super::{Run, Study};
pub(super) use crate::dataset::records::{cell, line};
use crate::scenario::experiment::ExperimentError;
use crate::trace::Trace;
use csv::StringRecord;
use std::collections::HashMap;
use std::ops::ControlFlow;

/// Rows of cells.
pub(super) type Rows = Vec<Vec<String>>;

/// Callback with the simulated time [s] of runs for a table; may stop them.
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
    /// `NoRows` stops the study or gives the reason why the run failed, though it has a trace.
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

/// The scenario of a run and the values of its swept keys.
pub(super) fn condition_cells(study: &Study, run: &Run) -> Vec<String> {
    let scenario = study.scenario_name(run).to_owned();
    let values = study.values(run).map(bare);
    std::iter::once(scenario).chain(values).collect()
}

/// A TOML value without the quotes of a text.
pub(super) fn bare(value: &str) -> String {
    value.trim_matches('"').to_owned()
}

/// A table that this program wrote, read from its text.
pub(super) struct Stored {
    header: StringRecord,
    places: HashMap<String, usize>,
    records: Vec<StringRecord>,
}

/// A row of a [`Stored`] table. A column that the table lacks is a fault of the program.
#[derive(Clone, Copy)]
pub(super) struct StoredRow<'t> {
    table: &'t Stored,
    record: &'t StringRecord,
}

impl Stored {
    pub(super) fn read(text: &str) -> Self {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().cloned().unwrap_or_default();
        let places = header.iter().map(str::to_owned).zip(0..);
        Self {
            places: places.collect(),
            header,
            records: reader.records().flatten().collect(),
        }
    }

    /// Names of the columns.
    pub(super) fn header(&self) -> impl Iterator<Item = &str> {
        self.header.iter()
    }

    /// Whether there is a column of this name.
    pub(super) fn has(&self, column: &str) -> bool {
        self.places.contains_key(column)
    }

    pub(super) fn rows(&self) -> impl ExactSizeIterator<Item = StoredRow<'_>> {
        let row = |record| StoredRow {
            table: self,
            record,
        };
        self.records.iter().map(row)
    }
}

impl<'t> StoredRow<'t> {
    pub(super) fn text(&self, column: &str) -> &'t str {
        let place = self.table.places.get(column);
        let place = *place.unwrap_or_else(|| panic!("the table has no column {column}"));
        &self.record[place]
    }

    /// A number; none where the cell is empty.
    pub(super) fn number(&self, column: &str) -> Option<f64> {
        self.text(column).parse().ok()
    }

    /// Numbers of several columns; none where one of the cells is empty.
    pub(super) fn numbers<const N: usize>(&self, columns: [&str; N]) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for (number, column) in numbers.iter_mut().zip(columns) {
            *number = self.number(column)?;
        }
        Some(numbers)
    }

    /// A whole number, which every row has.
    pub(super) fn count(&self, column: &str) -> u64 {
        let count = self.text(column).parse();
        count.unwrap_or_else(|_| panic!("column {column} has a whole number in every row"))
    }
}
