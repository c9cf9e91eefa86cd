//! Results of the analyses of a study: the one list of them.

use super::StudyError;
use super::diagnosis::score::DiagnosisScore;
use super::folder::Folder;
use super::identification::score::IdentificationScore;
use super::score::RecognitionScore;
use super::thresholds::ThresholdScore;
use serde::Serialize;

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

impl Scores {
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
