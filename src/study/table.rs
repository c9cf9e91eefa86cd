//! Tables to which every run of a study adds rows.

use super::cells::{self, lines, list};
use super::{Run, Study};
use crate::dataset::records::line;
use crate::scenario::experiment::ExperimentError;
use crate::trace::Trace;
use csv::StringRecord;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Callback with the simulated time [s] of runs for a table; may stop them.
pub(super) type Stop<'p> = dyn FnMut(f64) -> ControlFlow<()> + 'p;

/// A table to which every run adds rows, as lines of CSV. The rows of a run depend on nothing but the study and
/// the run.
pub(super) trait Table: Sync {
    /// Name of its file without the ending.
    fn name(&self) -> &'static str;

    /// Its columns.
    fn columns(&self) -> Columns;

    /// The rows of a run.
    ///
    /// # Errors
    /// `NoRows` stops the study or gives the reason why the run failed, though it has a trace.
    fn rows(&self, run: &Run, trace: &Trace, stop: &mut Stop) -> Result<String, NoRows>;

    /// The rows of a run that failed, for this table or another.
    fn rows_of_failed(&self, run: &Run, reason: &str) -> String;
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

impl NoRows {
    /// The run failed because of an error.
    pub(super) fn failed(error: impl ToString) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<ExperimentError> for NoRows {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Stopped => Self::Stopped,
            other => Self::failed(other),
        }
    }
}

/// The columns of a table: those of a row's fields, one after the other.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Columns {
    names: Vec<String>,
    /// Place and length of every list in a row.
    lists: Vec<[usize; 2]>,
}

impl Columns {
    /// The columns of a [`Place`].
    pub(super) fn of_place(study: &Study) -> Self {
        Self::default()
            .with(["run", "condition", "repeat", "scenario"])
            .list(study.keys().map(|key| [key]))
    }

    /// Adds columns.
    pub(super) fn with<N: Into<String>>(mut self, names: impl IntoIterator<Item = N>) -> Self {
        self.names.extend(names.into_iter().map(Into::into));
        self
    }

    /// Adds the columns of every entry of a list.
    pub(super) fn list<N: Into<String>, const W: usize>(
        mut self,
        entries: impl IntoIterator<Item = [N; W]>,
    ) -> Self {
        let before = self.names.len();
        self = self.with(entries.into_iter().flatten());
        self.lists.push([before, (self.names.len() - before) / W]);
        self
    }

    /// Their line in a table.
    pub(super) fn line(&self) -> String {
        line(&self.names)
    }

    /// The rows of a table, which may have further columns and in another order.
    ///
    /// # Errors
    /// A column that the table lacks, or a row that has something else in it.
    pub(super) fn read<R: DeserializeOwned>(&self, text: &str) -> Result<Vec<R>, NoTable> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().cloned().unwrap_or_default();
        let place = |name: &String| {
            let place = header.iter().position(|found| found == name);
            place.ok_or_else(|| NoTable::Column(name.clone()))
        };
        let places = self.names.iter().map(place);
        let places: Vec<usize> = places.collect::<Result<_, _>>()?;
        let counts = self.lists.iter();
        let counts = counts.map(|[place, count]| (*place, count.to_string()));
        let counts: Vec<(usize, String)> = counts.collect();
        let read = |(number, record): (usize, StringRecord)| {
            let mut cells: Vec<&str> = places.iter().map(|place| &record[*place]).collect();
            for (place, count) in counts.iter().rev() {
                cells.insert(*place, count);
            }
            let row = cells::row(cells.into());
            row.map_err(|error| NoTable::Row(number + 1, error.to_string()))
        };
        reader.records().flatten().enumerate().map(read).collect()
    }
}

/// Why a text is no table of the columns it should have.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoTable {
    /// It lacks this column.
    #[error("it has no column {0}")]
    Column(String),
    /// A row, by its number from 1, cannot be read for this reason.
    #[error("its row {0} cannot be read: {1}")]
    Row(usize, String),
}

/// Where a row comes from.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Place {
    pub(super) run: u64,
    pub(super) condition: u64,
    pub(super) repeat: u32,
    pub(super) scenario: String,
    /// Values of the swept keys.
    #[serde(deserialize_with = "list")]
    pub(super) values: Vec<String>,
}

impl Place {
    pub(super) fn of(study: &Study, run: &Run) -> Self {
        Self {
            run: run.number,
            condition: run.condition,
            repeat: run.repeat,
            scenario: study.scenario_name(run).to_owned(),
            values: study.values(run).map(bare).collect(),
        }
    }
}

/// A TOML value without the quotes of a text.
pub(super) fn bare(value: &str) -> String {
    value.trim_matches('"').to_owned()
}

/// A table as CSV.
pub(super) fn to_csv<R: Serialize>(columns: &Columns, rows: impl IntoIterator<Item = R>) -> String {
    columns.line() + &lines(rows)
}
