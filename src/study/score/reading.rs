//! The rows of `windows.csv` as they are scored.

use crate::features::band_powers::{BANDS, BandPowers};
use crate::recognition::Method;
use crate::recognition::confusion::CLASSES;
use crate::study::windows::{class_column, power_column};
use crate::terrain::class::{LABELS, TerrainLabel, Wtic};
use csv::StringRecord;

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

/// Reads a table that this program wrote: its columns are there.
pub(super) fn rows(text: &str, keys: &[&str], methods: &[Method]) -> Vec<Row> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().cloned().unwrap_or_default();
    let place = |column: &str| {
        let found = header.iter().position(|name| name == column);
        found.expect("the table of the windows has this column")
    };
    let [repeat, condition_number] = ["repeat", "condition"].map(place);
    let label = place("label");
    let p = ["p1", "p2", "p3", "p4"].map(place);
    let condition: Vec<usize> = std::iter::once("scenario")
        .chain(keys.iter().copied())
        .map(place)
        .collect();
    let [label_class, truth] = ["label_class", "truth"].map(place);
    let answers = methods
        .iter()
        .map(|method| place(&class_column(method.as_str())));
    let answers: Vec<usize> = answers.collect();
    let powers: [usize; BANDS] = std::array::from_fn(|band| place(&power_column(band + 1)));
    let row = |record: StringRecord| Row {
        repeat: record[repeat].to_owned(),
        condition_number: record[condition_number]
            .parse()
            .expect("conditions are numbered"),
        label: LABELS.into_iter().find(|l| l.as_str() == &record[label]),
        p: numbers(&record, p),
        condition: condition.iter().map(|&at| record[at].to_owned()).collect(),
        label_class: class(&record[label_class]),
        truth: class(&record[truth]),
        answers: answers
            .iter()
            .map(|&at| class(&record[at]).unwrap_or(Wtic::Uwtic))
            .collect(),
        powers: numbers(&record, powers),
    };
    reader.records().flatten().map(row).collect()
}

fn class(text: &str) -> Option<Wtic> {
    CLASSES.into_iter().find(|class| class.as_str() == text)
}

fn numbers<const N: usize>(record: &StringRecord, places: [usize; N]) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    for (number, at) in numbers.iter_mut().zip(places) {
        *number = record[at].parse().ok()?;
    }
    Some(numbers)
}
