//! Rows as structs: their cells by derive, in the order of the fields.
//!
//! A struct in a row, an array and a list ([`list`]) give the cells of their parts, one after the other. How long the
//! lists are depends on the study. What is not there is an empty cell.

use crate::dataset::records::cell;
use csv::StringRecord;
use serde::de::{DeserializeOwned, Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::marker::PhantomData;

/// A number in a cell, which reads back as itself; the cell is empty where there is none or it is not finite.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Number(Option<f64>);

impl Number {
    /// The number, if there is one.
    pub(super) fn get(self) -> Option<f64> {
        self.0
    }

    /// `N` numbers; none of them where one is missing.
    pub(super) fn of_all<const N: usize>(values: Option<[f64; N]>) -> [Self; N] {
        std::array::from_fn(|place| values.map(|values| values[place]).into())
    }

    /// `N` numbers, if none of them is missing.
    pub(super) fn all<const N: usize>(numbers: [Self; N]) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for (value, number) in values.iter_mut().zip(numbers) {
            *value = number.0?;
        }
        Some(values)
    }
}

impl From<Option<f64>> for Number {
    fn from(value: Option<f64>) -> Self {
        Self(value.filter(|value| value.is_finite()))
    }
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Some(value).into()
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&cell(self.0))
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Option::deserialize(deserializer)?.into())
    }
}

/// Reads a list in a row. It has as many entries in every row of a table, and a count before them when it is read.
///
/// # Errors
/// A cell that is missing or is not that of an entry.
pub(super) fn list<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    cells: D,
) -> Result<Vec<T>, D::Error> {
    cells.deserialize_seq(Entries(PhantomData))
}

/// Reads a count and so many entries.
struct Entries<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a count and so many entries")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut cells: A) -> Result<Vec<T>, A::Error> {
        let count: usize = cells.next_element()?.unwrap_or_default();
        let entry = |_| {
            let entry = cells.next_element()?;
            entry.ok_or_else(|| A::Error::custom("a cell is missing"))
        };
        (0..count).map(entry).collect()
    }
}

/// The lines of rows as CSV.
pub(super) fn lines<R: Serialize>(rows: impl IntoIterator<Item = R>) -> String {
    let mut builder = csv::WriterBuilder::new();
    let mut writer = builder.has_headers(false).from_writer(Vec::new());
    for row in rows {
        let written = writer.serialize(row);
        written.expect("a row is of numbers and texts, and memory takes any length");
    }
    let bytes = writer.into_inner().expect("memory needs no flushing");
    String::from_utf8(bytes).expect("cells are texts")
}

/// The row of these cells.
///
/// # Errors
/// A cell that is missing or is not what the row has at its place.
pub(super) fn row<R: DeserializeOwned>(cells: StringRecord) -> csv::Result<R> {
    cells.deserialize(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::class::Wtic;

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct Row {
        run: u64,
        #[serde(deserialize_with = "list")]
        values: Vec<String>,
        class: Option<Wtic>,
        powers: [Number; 2],
        #[serde(deserialize_with = "list")]
        answers: Vec<Answer>,
        is_whole: bool,
    }

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct Answer {
        confidence: Number,
        reason: String,
    }

    fn example() -> Row {
        let answer = Answer {
            confidence: (0.1 + 0.2).into(),
            reason: "it said \"no\", twice".to_owned(),
        };
        Row {
            run: 12,
            values: ["0.30", "triangular"].map(str::to_owned).into(),
            class: Some(Wtic::Leis),
            powers: [1.0e-300.into(), f64::NAN.into()],
            answers: vec![answer.clone(), answer],
            is_whole: true,
        }
    }

    #[test]
    fn a_row_comes_back_from_its_cells_lists_missing_numbers_and_all() {
        let reason = "it said \"no\", twice";
        let number = "0.30000000000000004";
        let answer = format!("{number},\"{}\"", reason.replace('"', "\"\""));
        let line = format!("12,0.30,triangular,LEIS,1e-300,,{answer},{answer},true\n");
        assert_eq!(lines([example()]), line);
        let first = ["12", "2", "0.30", "triangular", "LEIS", "1e-300", ""];
        let answers = ["2", number, reason, number, reason, "true"];
        let cells = StringRecord::from([&first[..], &answers].concat());
        assert_eq!(row::<Row>(cells).unwrap(), example());
    }

    #[test]
    fn a_cell_that_is_missing_or_of_another_type_is_an_error() {
        let read = |cells: &[&str]| row::<Row>(StringRecord::from(cells.to_vec()));
        let cells = ["12", "0", "LEIS", "", "", "0", "true"];
        assert!(read(&cells).is_ok());
        assert!(read(&cells[..6]).is_err());
        assert!(read(&["12", "0", "LEIS", "", "", "1", "true"]).is_err());
        assert!(read(&["twelve", "0", "LEIS", "", "", "0", "true"]).is_err());
        assert!(read(&["12", "0", "MAYBE", "", "", "0", "true"]).is_err());
    }
}
