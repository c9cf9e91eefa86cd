//! Accuracy of the recognition in a study: confusion matrices, shares with intervals, and their dependence on
//! scenarios and swept keys.
//!
//! Every method is scored against the class of the ground's label, as in the paper, against the true class by
//! the contacts of lugs and ground, and on the windows in which both agree. A trained [`baseline`] is scored
//! as two more methods:
//!
//! - `baseline_new`: every window is classified after training on the other values of its key,
//!   `recognition.baseline.key`. Values that differ in sign are equal, since a wheel in reverse has the same
//!   speed.
//! - `baseline_known`: every window is classified after training on the other repeats, at the same values.
//!   The difference is the cost of a new value.
//!
//! Both are trained on the labels of the grounds.
//!
//! `recognition.csv` has one row for a true class in a part of the windows:
//!
//! | columns | content |
//! |---|---|
//! | `method`, `against` | what was scored; `published` are the counts of the study file; `label`, `truth` or `agreed` |
//! | `by`, `value` | the part: a scenario, the value of a swept key, or all |
//! | `true_class` | one class, or `all` |
//! | `n`, `correct`, `share`, `low`, `high` | windows, and Wilson's 95 % interval of the share |
//! | `ALCT` ... `UWTIC` | answers |

pub(super) mod csv;
pub mod features;

use super::analysis::{Analysis, Finished, Observed, Report};
use super::cells::Number;
use super::recognition::{Recognition, RecognitionTable, magnitude};
use super::table::{Columns, NoRows, Stop};
use super::windows::{self, WindowRow};
use super::{Reading, Study, StudyError};
use crate::document::Misfit;
use crate::recognition::baseline::{self, BaselineError, Sample};
use crate::recognition::confusion::{CLASSES, Confusion};
use crate::statistics::Share;
use crate::terrain::class::{TerrainLabel, Wtic};
use features::FeaturesOfScenario;
use serde::Serialize;
use std::collections::BTreeMap;

/// How well the windows of a study were recognised.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecognitionScore {
    /// Windows of all runs that did not fail.
    pub windows: u64,
    /// Published counts, where the study file has them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published: Option<Counted>,
    /// The features of every window that has them, and its ground.
    #[serde(skip)]
    pub points: Vec<(TerrainLabel, [f64; 4])>,
    /// Lugs of the wheel, where it is one throughout: the paper's limits go by them.
    #[serde(skip)]
    pub lugs: Option<u32>,
    /// The features, scenario by scenario.
    pub features: Vec<FeaturesOfScenario>,
    /// Every method against every kind of class.
    pub scores: Vec<MethodScore>,
}

/// A method against one kind of class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodScore {
    /// `paper`, `improved`, `baseline_new` or `baseline_known`.
    pub method: String,
    /// What its answers were compared with.
    pub against: Against,
    /// All windows.
    #[serde(flatten)]
    pub all: Counted,
    /// Parts of the windows.
    pub map: Vec<Part>,
}

/// What counts as the true class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Against {
    /// The class of the ground's label.
    Label,
    /// The class that lugs and ground had in the window.
    Truth,
    /// The same class by both; windows on which they differ are left out.
    Agreed,
}

/// The windows of one scenario, or at one value of a swept key.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// `scenario` or the key.
    pub by: String,
    /// Which scenario, or the value as TOML.
    pub value: String,
    /// Its windows.
    #[serde(flatten)]
    pub counted: Counted,
}

/// Answers counted, and what follows from the counts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Counted {
    /// The counts.
    pub confusion: Confusion,
    /// Share of right answers; none without windows.
    pub accuracy: Option<Share>,
    /// Share of right answers, by true class; classes that did not occur have none.
    pub recalls: BTreeMap<Wtic, Share>,
    /// Windows answered by another class than theirs, UWTIC aside.
    pub confused: u64,
}

impl From<Confusion> for Counted {
    fn from(confusion: Confusion) -> Self {
        let recall = |class: Wtic| Some((class, confusion.recall(class)?));
        Self {
            confusion,
            accuracy: confusion.accuracy(),
            recalls: CLASSES.into_iter().filter_map(recall).collect(),
            confused: confusion.confused(),
        }
    }
}

impl Analysis for Recognition {
    const ROWS: Option<&'static str> = Some("windows");
    type Plan = RecognitionTable;
    type Row = WindowRow;
    type Score = RecognitionScore;

    fn read(plan: RecognitionTable, file: &Reading) -> Result<Self, Misfit> {
        plan.read(file)
    }

    fn scenario(&self) -> Option<(&'static str, &str)> {
        Some(("reference", self.reference_text()?))
    }

    fn features(&self) -> &Recognition {
        self
    }

    fn columns(&self, study: &Study) -> Columns {
        windows::columns(study, self)
    }

    fn rows(&self, run: &Observed, stop: &mut Stop) -> Result<Vec<WindowRow>, NoRows> {
        windows::rows(self, run, stop)
    }

    /// How well the windows were recognised.
    ///
    /// # Errors
    /// `Baseline` where the windows train no classifier.
    fn score(&self, done: &Finished, rows: Vec<WindowRow>) -> Result<RecognitionScore, StudyError> {
        let keys: Vec<&str> = done.study.keys().collect();
        let mut answers: Vec<(String, Vec<Wtic>)> = Vec::new();
        for (number, method) in self.methods.iter().enumerate() {
            let of_method = rows.iter().map(|row| row.answers[number].class);
            answers.push((method.as_str().to_owned(), of_method.collect()));
        }
        answers.extend(baselines(self, &rows, &keys)?);
        let scores = answers.iter().flat_map(|(method, answers)| {
            [Against::Label, Against::Truth, Against::Agreed].map(|against| MethodScore {
                method: method.clone(),
                against,
                all: counted(&rows, answers, against, &|_| true),
                map: map(&rows, answers, against, &keys),
            })
        });
        let point = |row: &WindowRow| Some((row.label?, Number::all(row.p)?));
        Ok(RecognitionScore {
            windows: rows.len() as u64,
            published: self.published.map(Counted::from),
            points: rows.iter().filter_map(point).collect(),
            lugs: done.study.one_lug_count(),
            features: features::by_scenario(done.study, &rows, &keys),
            scores: scores.collect(),
        })
    }

    fn report(score: &RecognitionScore) -> Option<Report> {
        Some(Report {
            stem: "recognition",
            rows: "windows",
            table: "windows.csv",
            csv: Some(score.to_csv()),
        })
    }
}

impl Study {
    /// Lugs of the wheel of all conditions, where they agree.
    fn one_lug_count(&self) -> Option<u32> {
        let lugs = |condition| self.scenario_of(condition).wheel.lug_count();
        let first = lugs(0);
        let agree = (1..self.condition_count()).all(|condition| lugs(condition) == first);
        agree.then_some(first)
    }
}

impl WindowRow {
    fn class(&self, against: Against) -> Option<Wtic> {
        match against {
            Against::Label => self.label_class,
            Against::Truth => self.truth,
            Against::Agreed => self.truth.filter(|_| self.truth == self.label_class),
        }
    }
}

/// Counts the answers to those rows that have a true class and are `within` a part.
fn counted(
    rows: &[WindowRow],
    answers: &[Wtic],
    against: Against,
    within: &dyn Fn(&WindowRow) -> bool,
) -> Counted {
    let mut confusion = Confusion::default();
    for (row, answer) in rows.iter().zip(answers).filter(|(row, _)| within(row)) {
        if let Some(class) = row.class(against) {
            confusion.add(class, *answer);
        }
    }
    confusion.into()
}

/// The parts in the order in which they occur, scenarios first.
fn map(rows: &[WindowRow], answers: &[Wtic], against: Against, keys: &[&str]) -> Vec<Part> {
    let mut parts = Vec::new();
    for (place, by) in std::iter::once("scenario")
        .chain(keys.iter().copied())
        .enumerate()
    {
        let mut values: Vec<&str> = Vec::new();
        for row in rows {
            let value = row.part(place);
            if !values.contains(&value) {
                values.push(value);
            }
        }
        parts.extend(values.iter().map(|value| Part {
            by: by.to_owned(),
            value: (*value).to_owned(),
            counted: counted(rows, answers, against, &|row| row.part(place) == *value),
        }));
    }
    parts
}

/// The answers of the baseline to windows at new and at known values.
fn baselines(
    recognition: &Recognition,
    rows: &[WindowRow],
    keys: &[&str],
) -> Result<Vec<(String, Vec<Wtic>)>, BaselineError> {
    let Some(key) = &recognition.baseline else {
        return Ok(Vec::new());
    };
    let place = keys.iter().position(|swept| swept == key);
    let place = 1 + place.expect("the study was read with this key swept");
    let value = |row: &WindowRow| magnitude(row.part(place));
    let repeat = |row: &WindowRow| row.place.repeat.to_string();
    Ok(vec![
        ("baseline_new".to_owned(), left_out(rows, &value)?),
        ("baseline_known".to_owned(), left_out(rows, &repeat)?),
    ])
}

/// The baseline's class of every window, trained on the windows of other groups. A window without usable
/// vibration is neither used in training nor classified.
fn left_out(
    rows: &[WindowRow],
    group: &dyn Fn(&WindowRow) -> String,
) -> Result<Vec<Wtic>, BaselineError> {
    let sample = |row: &WindowRow| {
        let (powers, class) = (Number::all(row.powers)?, row.label_class?);
        Some(Sample { powers, class })
    };
    let usable: Vec<(usize, Sample)> = rows
        .iter()
        .enumerate()
        .filter_map(|(number, row)| Some((number, sample(row)?)))
        .collect();
    let groups: Vec<String> = usable
        .iter()
        .map(|(number, _)| group(&rows[*number]))
        .collect();
    let samples: Vec<Sample> = usable.iter().map(|(_, sample)| sample.clone()).collect();
    let mut answers = vec![Wtic::Uwtic; rows.len()];
    for ((number, _), class) in usable.iter().zip(baseline::left_out(&samples, &groups)?) {
        answers[*number] = class;
    }
    Ok(answers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::band_powers::BANDS;
    use crate::study::table::Place;

    /// A window at a speed, as loud as that in every band; silence cannot be used.
    fn row(speed: &str, class: Wtic, loud: f64) -> WindowRow {
        WindowRow {
            place: Place {
                scenario: "hard".to_owned(),
                values: vec![speed.to_owned()],
                ..Place::default()
            },
            label_class: Some(class),
            truth: (speed != "0.02").then_some(Wtic::Slct),
            powers: Number::of_all((loud != 0.0).then_some([loud; BANDS])),
            ..WindowRow::default()
        }
    }

    #[test]
    fn the_map_counts_every_window_once_by_scenario_and_once_by_each_key() {
        let rows = ["0.01", "0.02", "0.01", "0.02", "0.02"].map(|v| row(v, Wtic::Alct, 1.0));
        let answers = [Wtic::Alct, Wtic::Alct, Wtic::Leis, Wtic::Uwtic, Wtic::Alct];
        let parts = map(&rows, &answers, Against::Label, &["speed"]);
        let shown: Vec<(&str, &str, Option<Share>)> = parts
            .iter()
            .map(|part| (part.by.as_str(), part.value.as_str(), part.counted.accuracy))
            .collect();
        let expected = [
            ("scenario", "hard", Share::of(3, 5)),
            ("speed", "0.01", Share::of(1, 2)),
            ("speed", "0.02", Share::of(2, 3)),
        ];
        assert_eq!(shown, expected);
        let against_truth = counted(&rows, &answers, Against::Truth, &|_| true);
        assert_eq!(against_truth.confusion.total(), 2, "three have no truth");
    }

    #[test]
    fn a_window_whose_vibration_cannot_be_used_is_unknown_to_the_baseline() {
        let mut rows = Vec::new();
        for speed in ["0.01", "-0.01", "0.02"] {
            rows.push(row(speed, Wtic::Alct, 2.0));
            rows.push(row(speed, Wtic::Leis, -2.0));
        }
        rows.push(row("0.02", Wtic::Alct, 0.0));
        let by_speed = |row: &WindowRow| magnitude(row.part(1));
        let answers = left_out(&rows, &by_speed).unwrap();
        assert_eq!(answers[..2], [Wtic::Alct, Wtic::Leis]);
        assert_eq!(answers[6], Wtic::Uwtic);
        // In reverse it is the same speed, so that two values that differ in sign are not two.
        let error = left_out(&rows[..4], &by_speed).unwrap_err();
        assert!(matches!(error, BaselineError::OneGroup));
    }
}
