//! Scores as CSV.

use super::{Against, Counted, MethodScore, Part, RecognitionScore};
use crate::recognition::confusion::{CLASSES, Confusion};
use crate::statistics::Share;
use crate::study::cells::Number;
use crate::study::table::{Columns, to_csv};
use serde::{Deserialize, Serialize};

/// A true class in a part of the windows, see the [module](super).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(in crate::study) struct ClassRow {
    pub(in crate::study) method: String,
    pub(in crate::study) against: String,
    pub(in crate::study) by: String,
    pub(in crate::study) value: String,
    true_class: String,
    n: u64,
    correct: u64,
    /// Value and interval.
    share: [Number; 3],
    answers: [u64; 4],
}

/// The columns of `recognition.csv`.
pub(in crate::study) fn columns() -> Columns {
    Columns::default()
        .with(["method", "against", "by", "value", "true_class"])
        .with(["n", "correct", "share", "low", "high"])
        .with(CLASSES.map(|class| class.as_str()))
}

impl RecognitionScore {
    /// One row for every true class in every part of the windows.
    pub fn to_csv(&self) -> String {
        let published = self.published.iter();
        let published =
            published.flat_map(|counted| class_rows(["published", "label", "all", ""], counted));
        let scores = self.scores.iter().flat_map(|score| {
            let MethodScore {
                method,
                against,
                all,
                map,
            } = score;
            let against = against.as_str();
            let parts = map.iter().flat_map(move |Part { by, value, counted }| {
                class_rows([method, against, by, value], counted)
            });
            class_rows([method, against, "all", ""], all).chain(parts)
        });
        to_csv(&columns(), published.chain(scores))
    }
}

impl Against {
    pub(in crate::study) fn as_str(self) -> &'static str {
        match self {
            Self::Label => "label",
            Self::Truth => "truth",
            Self::Agreed => "agreed",
        }
    }
}

/// Rows of the classes that occur, and of all together.
fn class_rows(first: [&str; 4], counted: &Counted) -> impl Iterator<Item = ClassRow> {
    let [method, against, by, value] = first.map(str::to_owned);
    let row = move |true_class: &str, share: Share, correct, answers| ClassRow {
        method: method.clone(),
        against: against.clone(),
        by: by.clone(),
        value: value.clone(),
        true_class: true_class.to_owned(),
        n: share.n,
        correct,
        share: share.with_ends().map(Number::from),
        answers,
    };
    let Counted {
        confusion,
        accuracy,
        recalls,
        ..
    } = counted;
    let counts = &confusion.counts;
    let of_class = |(place, class): (usize, _)| {
        let share = *recalls.get(class)?;
        Some(row(
            class.as_str(),
            share,
            counts[place][place],
            counts[place],
        ))
    };
    let mut rows: Vec<ClassRow> = CLASSES.iter().enumerate().filter_map(of_class).collect();
    let all = std::array::from_fn(|column| counts.iter().map(|row| row[column]).sum());
    rows.extend(accuracy.map(|share| row("all", share, confusion.correct(), all)));
    rows.into_iter()
}

/// The part of the windows that rows of its true classes count.
pub(in crate::study) fn part(rows: &[ClassRow]) -> Part {
    let mut confusion = Confusion::default();
    for (class, counts) in CLASSES.iter().zip(&mut confusion.counts) {
        let row = rows.iter().find(|row| row.true_class == class.as_str());
        *counts = row.map_or([0; 4], |row| row.answers);
    }
    Part {
        by: rows[0].by.clone(),
        value: rows[0].value.clone(),
        counted: Counted::from(confusion),
    }
}
