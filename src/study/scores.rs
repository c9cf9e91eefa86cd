//! The analyses of a study, the one list of them, and their results.

use super::analysis::{Analysis, Finished, table};
use super::diagnosis::{self, score::DiagnosisScore};
use super::folder::Folder;
use super::identification::{self, score::IdentificationScore};
use super::kept::Dataset;
use super::recognition::Recognition;
use super::runs::Runs;
use super::score::RecognitionScore;
use super::table::Table;
use super::thresholds::{ThresholdScore, Thresholds};
use super::{Reading, Study, StudyError, StudyTable};
use crate::document::Misfit;
use crate::learning::DataSet;
use serde::Serialize;

pub use super::analysis::Report;

/// Makes the analyses and their results of a list: of each the definition of its result, its name in the study's
/// file, and the types of both.
macro_rules! analyses {
    ($($(#[$about:meta])* $name:ident: $analysis:ty => $score:ty,)*) => {
        /// The analyses that a study has.
        #[derive(Debug, Clone, Default)]
        pub(super) struct Analyses {
            $(pub(super) $name: Option<$analysis>,)*
        }

        /// The result of every analysis; none where the study has no such analysis, or shards are missing.
        #[derive(Debug, Clone, PartialEq, Default, Serialize)]
        pub struct Scores {
            $(
                $(#[$about])*
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $name: Option<$score>,
            )*
        }

        /// The tables of the analyses in a study's file, before their checks.
        pub(super) struct Plans {
            $($name: Option<<$analysis as Analysis>::Plan>,)*
        }

        impl Plans {
            pub(super) fn take(table: &mut StudyTable) -> Self {
                Self {
                    $($name: table.$name.take(),)*
                }
            }

            /// Checks every table against a study that is sound without them.
            pub(super) fn read(self, file: &Reading) -> Result<Analyses, Misfit> {
                Ok(Analyses {
                    $($name: self.$name
                        .map(|plan| <$analysis>::read(plan, file))
                        .transpose()?,)*
                })
            }
        }

        impl Analyses {
            /// Name and text of the scenarios that no run is of.
            pub(super) fn scenarios(&self) -> impl Iterator<Item = (&str, &str)> {
                let scenarios = [$(self.$name.as_ref().and_then(Analysis::scenario)),*];
                scenarios.into_iter().flatten()
            }

            /// Whether the channels of the runs are needed once the runs are done.
            pub(super) fn need_traces(&self) -> bool {
                false $(|| self.$name.as_ref().is_some_and(Analysis::needs_traces))*
            }

            /// The tables of their rows.
            fn tables<'s>(&'s self, study: &'s Study) -> impl Iterator<Item = Box<dyn Table + 's>> {
                let tables = [$(self.$name.as_ref().and_then(|it| table(study, it))),*];
                tables.into_iter().flatten()
            }
        }

        impl Scores {
            /// The results over the rows of all runs, of which `rows_of` gives the table by name.
            pub(super) fn of<'t>(
                done: &Finished,
                rows_of: &dyn Fn(&str) -> Option<&'t str>,
            ) -> Result<Self, StudyError> {
                Ok(Self {
                    $($name: score(done, done.study.analyses.$name.as_ref(), rows_of)?,)*
                })
            }

            /// Every result as tables.
            pub fn reports(&self) -> Vec<Report> {
                let reports = [$(self.$name.as_ref().and_then(<$analysis>::report)),*];
                reports.into_iter().flatten().collect()
            }
        }
    };
}

analyses! {
    /// The data set.
    #[serde(skip)]
    dataset: Dataset => DataSet,
    /// Accuracy of the recognition.
    recognition: Recognition => RecognitionScore,
    /// Validity of the limits of Eq. (55) to (58).
    thresholds: Thresholds => ThresholdScore,
    /// Terrain parameters and predictions.
    identification: identification::Plan => IdentificationScore,
    /// Diagnoses of campaigns.
    diagnosis: diagnosis::Plan => DiagnosisScore,
}

/// The result of an analysis, where the study has it.
fn score<'t, A: Analysis>(
    done: &Finished,
    analysis: Option<&A>,
    rows_of: &dyn Fn(&str) -> Option<&'t str>,
) -> Result<Option<A::Score>, StudyError> {
    let Some(analysis) = analysis else {
        return Ok(None);
    };
    let text = A::ROWS.and_then(rows_of).unwrap_or_default();
    let rows = analysis.columns(done.study).read(text);
    let rows = rows.expect("the shards have the columns and rows of their tables");
    analysis.score(done, rows).map(Some)
}

impl Study {
    /// The tables of the runs, and of the analyses that the study has.
    pub(super) fn tables(&self) -> Vec<Box<dyn Table + '_>> {
        let runs: Box<dyn Table> = Box::new(Runs { study: self });
        std::iter::once(runs)
            .chain(self.analyses.tables(self))
            .collect()
    }
}

impl Scores {
    pub(super) fn write(&self, folder: &Folder) -> Result<(), StudyError> {
        for Report { stem, csv, .. } in self.reports() {
            if let Some(csv) = csv {
                folder.write(&format!("{stem}.csv"), csv.as_bytes())?;
            }
        }
        Ok(())
    }
}
