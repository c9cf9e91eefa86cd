//! The rows of `windows.csv` as they are scored.

use crate::features::band_powers::{BANDS, BandPowers};
use crate::recognition::Method;
use crate::recognition::confusion::CLASSES;
use crate::study::table::{Stored, StoredRow};
use crate::study::windows::{class_column, power_column};
use crate::terrain::class::{LABELS, TerrainLabel, Wtic};

/// A window.
pub(super) struct Row {
    pub(super) repeat: String,
    pub(super) condition_number: usize,
    /// Scenario and values of the swept keys.
    pub(super) condition: Vec<String>,
    pub(super) label: Option<TerrainLabel>,
    /// Feature vector.
    pub(super) p: Option<[f64; 4]>,
    pub(super) label_class: Option<Wtic>,
    pub(super) truth: Option<Wtic>,
    /// One of every method.
    pub(super) answers: Vec<Wtic>,
    pub(super) powers: Option<BandPowers>,
}

/// The rows of the table of the windows.
pub(super) fn rows(text: &str, keys: &[&str], methods: &[Method]) -> Vec<Row> {
    let keys = || std::iter::once("scenario").chain(keys.iter().copied());
    let answers: Vec<String> = methods.iter().map(|it| class_column(it.as_str())).collect();
    let powers: [String; BANDS] = std::array::from_fn(|band| power_column(band + 1));
    let row = |row: StoredRow| Row {
        repeat: row.text("repeat").to_owned(),
        condition_number: row.count("condition") as usize,
        label: LABELS
            .into_iter()
            .find(|it| it.as_str() == row.text("label")),
        p: row.numbers(["p1", "p2", "p3", "p4"]),
        condition: keys().map(|key| row.text(key).to_owned()).collect(),
        label_class: class(row.text("label_class")),
        truth: class(row.text("truth")),
        answers: answers
            .iter()
            .map(|column| class(row.text(column)).unwrap_or(Wtic::Uwtic))
            .collect(),
        powers: row.numbers(powers.each_ref().map(String::as_str)),
    };
    Stored::read(text).rows().map(row).collect()
}

fn class(text: &str) -> Option<Wtic> {
    CLASSES.into_iter().find(|class| class.as_str() == text)
}
