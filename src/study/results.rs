//! Results of a finished study, read from its folder.

use super::conditions::{self, Condition};
use super::runs;
use super::score::csv::{self, ClassRow, part};
use super::score::{Against, Part};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

pub use super::table::NoTable;

/// The tables of a study that its figures show.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// The swept keys, in the order of the study.
    pub keys: Vec<String>,
    /// Every condition with the means of its runs.
    pub conditions: Vec<Condition>,
    /// Answers of every method of recognition; none where the study has no `[recognition]`.
    pub recognition: Vec<MethodResults>,
}

/// Answers of a method of recognition, compared with the class of the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodResults {
    /// Its name.
    pub method: String,
    /// Its windows by scenario and by the value of every swept key.
    pub map: Vec<Part>,
}

/// Why a folder has no results of a study.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// It contains no table of runs.
    #[error(
        "cannot read {}: it is a folder without the results of a study (no runs.csv); name a run file, or finish the study with `lugwheel study`", folder.display()
    )]
    NoStudy {
        /// The folder.
        folder: PathBuf,
    },
    /// A table cannot be read.
    #[error("cannot read {}", file.display())]
    Unreadable {
        /// The table.
        file: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A table is not of a study.
    #[error("{} is no table of a study: {reason}", file.display())]
    NoTable {
        /// The table.
        file: PathBuf,
        /// Why.
        reason: NoTable,
    },
}

impl Results {
    /// Reads `runs.csv` and, where it exists, `recognition.csv` in the folder of a study.
    ///
    /// # Errors
    /// `NoStudy` where there is no table of runs, `Unreadable` where the system refuses to read a table,
    /// `NoTable` where it is not one of a study.
    pub fn read(folder: &Path) -> Result<Self, ResultsError> {
        let [file, of_recognition] = tables(folder);
        let text = read(&file)?.ok_or_else(|| ResultsError::NoStudy {
            folder: folder.to_owned(),
        })?;
        let no_table = |file: PathBuf| |reason| ResultsError::NoTable { file, reason };
        let keys = runs::keys_of(&text).map_err(no_table(file.clone()))?;
        let rows = runs::columns(&keys).read(&text).map_err(no_table(file))?;
        let recognition = match read(&of_recognition)? {
            Some(text) => recognition(&text).map_err(no_table(of_recognition))?,
            None => Vec::new(),
        };
        Ok(Self {
            keys,
            conditions: conditions::of_runs(&rows),
            recognition,
        })
    }
}

/// The tables that are read in the folder of a study: of the runs, and of a recognition, which need not be there.
pub fn tables(folder: &Path) -> [PathBuf; 2] {
    ["runs.csv", "recognition.csv"].map(|name| folder.join(name))
}

/// The text of a file; none where there is no such file.
fn read(file: &Path) -> Result<Option<String>, ResultsError> {
    match std::fs::read_to_string(file) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(source) => Err(ResultsError::Unreadable {
            file: file.to_owned(),
            source,
        }),
    }
}

/// The parts of the windows of every method, from the text of `recognition.csv`.
fn recognition(text: &str) -> Result<Vec<MethodResults>, NoTable> {
    let mut rows: Vec<ClassRow> = csv::columns().read(text)?;
    // Published counts have no parts.
    rows.retain(|row| row.against == Against::Label.as_str() && row.by != "all");
    let methods = rows.chunk_by(|a, b| a.method == b.method);
    let methods = methods.map(|rows| {
        let parts = rows.chunk_by(|a, b| (&a.by, &a.value) == (&b.by, &b.value));
        MethodResults {
            method: rows[0].method.clone(),
            map: parts.map(part).collect(),
        }
    });
    Ok(methods.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::confusion::Confusion;
    use crate::study::score::{Counted, MethodScore, RecognitionScore};
    use crate::terrain::class::Wtic;

    fn counted(right: u64, wrong: u64) -> Counted {
        let mut confusion = Confusion::default();
        confusion.counts[0] = [right, 0, 0, wrong];
        confusion.counts[2] = [0, wrong, right, 0];
        Counted::from(confusion)
    }

    #[test]
    fn the_parts_of_each_method_are_read_as_they_were_written() {
        let part = |by: &str, value: &str, right| Part {
            by: by.to_owned(),
            value: value.to_owned(),
            counted: counted(right, 2),
        };
        let score = |method: &str, against| MethodScore {
            method: method.to_owned(),
            against,
            all: counted(9, 2),
            map: vec![part("scenario", "sand", 9), part("rig.slip", "0.3", 4)],
        };
        let written = RecognitionScore {
            windows: 11,
            published: Some(counted(5, 0)),
            points: Vec::new(),
            lugs: None,
            features: Vec::new(),
            scores: vec![
                score("paper", Against::Label),
                score("paper", Against::Truth),
                score("improved", Against::Label),
            ],
        };
        let read = recognition(&written.to_csv()).unwrap();
        let methods: Vec<&str> = read.iter().map(|it| it.method.as_str()).collect();
        assert_eq!(methods, ["paper", "improved"]);
        assert_eq!(read[1].map, written.scores[2].map);
        assert_eq!(read[0].map[1].counted.recalls[&Wtic::Leis].n, 6);
    }

    #[test]
    fn a_folder_or_table_of_something_else_is_named_with_what_it_lacks() {
        let folder = tempfile::tempdir().unwrap();
        let refusal = || Results::read(folder.path()).unwrap_err().to_string();
        assert!(refusal().contains("no runs.csv"), "{}", refusal());
        std::fs::write(
            folder.path().join("runs.csv"),
            "condition,scenario\n0,sand\n",
        )
        .unwrap();
        assert!(refusal().contains("no column label"), "{}", refusal());
    }
}
