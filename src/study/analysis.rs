//! What an analysis of a study is.
//!
//! An analysis is a table of the study's file ([`Analysis::read`]). Every run adds rows to its table of results
//! ([`Analysis::rows`]), and the rows of all runs come to its result ([`Analysis::score`]):
//!
//! ```text
//! [thresholds]  ->  Thresholds  ->  rows of every run  ->  thresholds.csv  ->  ThresholdScore  ->  the page
//!  study file       the plan        structs               shards, as CSV       from the structs     and its text
//! ```
//!
//! A row is a struct: [`cells`](super::cells) derives its line of CSV, in the shards and in the published table,
//! and reads it back, so that a result is computed from fields, never from names of columns. Where columns depend on
//! the study (swept keys, methods, bandwidths), a row has a list. Results are serialised to JSON by derive.
//!
//! The analyses are listed once, in [`scores`](super::scores). A new one is a file with an `impl Analysis`, a line
//! in that list, and a field of the study's file; the page shows it by `report::study_page::Shown`. Without one of
//! these it does not compile.

use super::folder::Folder;
use super::progress::Diagnosing;
use super::recognition::{BY_DEFAULT, Recognition};
use super::references::References;
use super::shard::Shard;
use super::table::{Columns, NoRows, Place, Stop, Table};
use super::{Reading, Run, Study, StudyError, cells};
use crate::document::Misfit;
use crate::features::reference::Reference;
use crate::trace::Trace;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::ControlFlow;

/// An analysis of the runs of a study, as its file plans it.
pub(super) trait Analysis: Sized + Sync {
    /// Name of the table of its rows, without the ending; none where runs add no rows.
    const ROWS: Option<&'static str>;

    /// Its table of the study's file, before the checks.
    type Plan: DeserializeOwned;

    /// What a run adds to the table of its rows.
    type Row: Serialize + DeserializeOwned;

    /// What it comes to.
    type Score;

    /// Checks its table of the file against a study that is sound without it.
    ///
    /// # Errors
    /// The key at fault, and why.
    fn read(plan: Self::Plan, file: &Reading) -> Result<Self, Misfit>;

    /// Name and text of a scenario that no run is of.
    fn scenario(&self) -> Option<(&'static str, &str)> {
        None
    }

    /// Whether it needs the channels of all runs once they are done.
    fn needs_traces(&self) -> bool {
        false
    }

    /// How the features of its rows are taken.
    fn features(&self) -> &Recognition {
        &BY_DEFAULT
    }

    /// The columns of its rows.
    fn columns(&self, _study: &Study) -> Columns {
        Columns::default()
    }

    /// The rows of a run; of one that failed there are none.
    ///
    /// # Errors
    /// `NoRows` stops the study or gives the reason why the run failed, though it has a trace.
    fn rows(&self, _run: &Observed, _stop: &mut Stop) -> Result<Vec<Self::Row>, NoRows> {
        Ok(Vec::new())
    }

    /// The result over the rows of all runs.
    ///
    /// # Errors
    /// `Stopped` and `StoppedDiagnosing` on request, and what else the analysis may meet.
    fn score(&self, done: &Finished, rows: Vec<Self::Row>) -> Result<Self::Score, StudyError>;

    /// The result as tables; none where [`score`](Self::score) has written them.
    fn report(score: &Self::Score) -> Option<Report>;
}

/// A run of a study and what it recorded.
pub(super) struct Observed<'o> {
    pub(super) study: &'o Study,
    pub(super) run: &'o Run,
    pub(super) trace: &'o Trace,
    references: &'o References<'o>,
}

impl Observed<'_> {
    pub(super) fn place(&self) -> Place {
        Place::of(self.study, self.run)
    }

    /// What the features of the run are taken over.
    pub(super) fn reference(&self, stop: &mut Stop) -> Result<Reference, NoRows> {
        self.references.of(self.run, stop)
    }
}

/// A study of which all runs are done.
pub(super) struct Finished<'f> {
    pub(super) study: &'f Study,
    pub(super) folder: &'f Folder,
    pub(super) shards: &'f [Shard],
    /// Runs that failed.
    pub(super) failed: u64,
    /// Callback with the progress of diagnoses; a `Break` stops the study.
    pub(super) on_progress: &'f (dyn Fn(Option<Diagnosing>) -> ControlFlow<()> + Sync),
}

impl Finished<'_> {
    /// `Stopped` where the caller stops the study.
    pub(super) fn go_on(&self) -> Result<(), StudyError> {
        match (self.on_progress)(None) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(StudyError::Stopped {
                whole: self.shards.len(),
                shards: self.shards.len(),
            }),
        }
    }
}

/// The tables of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Stem of the files.
    pub stem: &'static str,
    /// The rows from which it was computed.
    pub rows: &'static str,
    /// File of these rows.
    pub table: &'static str,
    /// The result as CSV; none where the rows are all.
    pub csv: Option<String>,
}

/// The table of the rows of an analysis.
struct Rows<'s, A> {
    study: &'s Study,
    analysis: &'s A,
    name: &'static str,
    references: References<'s>,
}

/// The table of the rows of an analysis, where it has rows.
pub(super) fn table<'s, A: Analysis>(
    study: &'s Study,
    analysis: &'s A,
) -> Option<Box<dyn Table + 's>> {
    Some(Box::new(Rows {
        study,
        analysis,
        name: A::ROWS?,
        references: References::new(study, analysis.features()),
    }))
}

impl<A: Analysis> Table for Rows<'_, A> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn columns(&self) -> Columns {
        self.analysis.columns(self.study)
    }

    fn rows(&self, run: &Run, trace: &Trace, stop: &mut Stop) -> Result<String, NoRows> {
        let observed = Observed {
            study: self.study,
            run,
            trace,
            references: &self.references,
        };
        let rows = self.analysis.rows(&observed, stop)?;
        Ok(cells::lines(rows))
    }

    fn rows_of_failed(&self, _: &Run, _: &str) -> String {
        String::new()
    }
}
