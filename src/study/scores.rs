//! The analyses of a study, the one list of them: their tables of rows, their results, and the results as files.

use super::diagnosis::score::DiagnosisScore;
use super::folder::Folder;
use super::identification::score::IdentificationScore;
use super::identification::{self, SteadyRows};
use super::kept;
use super::progress::Diagnosing;
use super::runs::Runs;
use super::score::RecognitionScore;
use super::table::Table;
use super::thresholds::{self, ThresholdScore};
use super::windows::{self, Windows};
use super::{Study, StudyError};
use serde::Serialize;
use std::ops::ControlFlow;

/// The result of every analysis; none where the study has no such analysis, or shards are missing.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Scores {
    /// Accuracy of the recognition.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recognition: Option<RecognitionScore>,
    /// Validity of the limits of Eq. (55) to (58).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thresholds: Option<ThresholdScore>,
    /// Terrain parameters and predictions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub identification: Option<IdentificationScore>,
    /// Diagnoses of campaigns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diagnosis: Option<DiagnosisScore>,
}

/// A result as files.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Stem of the files.
    pub stem: &'static str,
    /// The rows from which it was computed.
    pub rows: &'static str,
    /// File of these rows.
    pub table: &'static str,
    /// The result as text.
    pub text: String,
    /// The result as CSV; none where the rows are all.
    pub csv: Option<String>,
}

impl Study {
    /// The tables of the runs, and of the analyses that the study has.
    pub(super) fn tables(&self) -> Vec<Box<dyn Table + '_>> {
        let runs = Some(Runs { study: self });
        let tables = [
            boxed(runs),
            boxed(Windows::of(self)),
            boxed(thresholds::Windows::of(self)),
            boxed(SteadyRows::of(self)),
            boxed(kept::Windows::of(self)),
        ];
        tables.into_iter().flatten().collect()
    }
}

fn boxed<'s>(table: Option<impl Table + 's>) -> Option<Box<dyn Table + 's>> {
    table.map(|table| Box::new(table) as Box<dyn Table>)
}

impl Scores {
    /// The results over the complete tables of a study, of which `rows_of` gives the text by name.
    pub(super) fn of<'t>(
        study: &Study,
        folder: &Folder,
        rows_of: &dyn Fn(&str) -> Option<&'t str>,
        on_progress: &(dyn Fn(Option<Diagnosing>) -> ControlFlow<()> + Sync),
    ) -> Result<Self, StudyError> {
        let steady = rows_of(identification::NAME);
        Ok(Self {
            recognition: study.score(rows_of(windows::NAME))?,
            thresholds: study.hold_to_thresholds(rows_of(thresholds::NAME)),
            identification: study.identify(steady, &|| on_progress(None))?,
            diagnosis: study.diagnose(folder, &|now| on_progress(Some(now)))?,
        })
    }

    /// Every result as files.
    pub fn reports(&self) -> Vec<Report> {
        let recognition = self.recognition.as_ref().map(|score| Report {
            stem: "recognition",
            rows: "windows",
            table: "windows.csv",
            text: score.to_string(),
            csv: Some(score.to_csv()),
        });
        let thresholds = self.thresholds.as_ref().map(|score| Report {
            stem: "thresholds",
            rows: "thresholds",
            table: "thresholds.csv",
            text: score.to_string(),
            csv: None,
        });
        let identification = self.identification.as_ref().map(|score| Report {
            stem: "identification",
            rows: "rows",
            table: "steady.csv",
            text: score.to_string(),
            csv: Some(score.to_csv()),
        });
        let diagnosis = self.diagnosis.as_ref().map(|score| Report {
            stem: "diagnosis",
            rows: "campaigns",
            table: "diagnosis.csv",
            text: score.to_string(),
            csv: Some(score.to_csv()),
        });
        let all = [recognition, thresholds, identification, diagnosis];
        all.into_iter().flatten().collect()
    }

    pub(super) fn write(&self, folder: &Folder) -> Result<(), StudyError> {
        for Report {
            stem, text, csv, ..
        } in self.reports()
        {
            folder.write(&format!("{stem}.txt"), text.as_bytes())?;
            if let Some(csv) = csv {
                folder.write(&format!("{stem}.csv"), csv.as_bytes())?;
            }
        }
        Ok(())
    }
}
