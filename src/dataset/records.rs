//! Tables of runs or of windows: columns with unit and meaning, cells as text.
//!
//! A cell is empty where a value does not exist. Numbers have as many digits as bring the same
//! number back.

/// What the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Whole numbers, none missing.
    Whole,
    /// Numbers; an empty cell is not a number.
    Number,
    /// Texts.
    Text,
}

/// A column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Name.
    pub name: String,
    /// Unit, as in run files: `m/s^2`, `1`; empty where there is none or it is unknown.
    pub unit: &'static str,
    /// What its cells are.
    pub kind: Kind,
    /// Its definition, in words.
    pub meaning: &'static str,
}

impl Field {
    /// A column of whole numbers.
    pub fn whole(name: impl Into<String>, meaning: &'static str) -> Self {
        Self::new(Kind::Whole, name, "1", meaning)
    }

    /// A column of numbers in `unit`.
    pub fn number(name: impl Into<String>, unit: &'static str, meaning: &'static str) -> Self {
        Self::new(Kind::Number, name, unit, meaning)
    }

    /// A column of texts.
    pub fn text(name: impl Into<String>, meaning: &'static str) -> Self {
        Self::new(Kind::Text, name, "", meaning)
    }

    fn new(kind: Kind, name: impl Into<String>, unit: &'static str, meaning: &'static str) -> Self {
        Self {
            name: name.into(),
            unit,
            kind,
            meaning,
        }
    }
}

/// A table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Records {
    /// Its columns.
    pub fields: Vec<Field>,
    /// Its rows, a cell for every column.
    pub rows: Vec<Vec<String>>,
}

impl Records {
    /// The rows of a CSV text below its names, which are those of `fields`. Rows that are no CSV, or
    /// of another length, are left out.
    pub fn of_csv(fields: Vec<Field>, text: &str) -> Self {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let records = reader.records().flatten();
        let rows = records.map(|record| record.iter().map(str::to_owned).collect());
        Self {
            rows: rows.collect(),
            fields,
        }
    }

    /// The table as CSV, the names of its columns first.
    pub fn to_csv(&self) -> String {
        let names: Vec<String> = self.fields.iter().map(|field| field.name.clone()).collect();
        let rows = self.rows.iter().map(|row| line(row));
        std::iter::once(line(&names)).chain(rows).collect()
    }

    /// The cells of the column of this name; none where there is no such column.
    pub fn column(&self, name: &str) -> impl Iterator<Item = &str> {
        let index = self.fields.iter().position(|field| field.name == name);
        self.rows
            .iter()
            .filter_map(move |row| row.get(index?).map(String::as_str))
    }
}

/// A line of CSV.
pub fn line(cells: &[String]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = writer.write_record(cells);
    written.expect("memory takes a record of any length");
    let bytes = writer.into_inner().expect("memory needs no flushing");
    String::from_utf8(bytes).expect("cells are texts")
}

/// A number that reads back as itself.
pub fn cell(value: Option<f64>) -> String {
    let finite = value.filter(|value| value.is_finite());
    finite.map_or_else(String::new, |value| format!("{value:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_in_a_cell_reads_back_as_itself() {
        for value in [0.1 + 0.2, 1.0e-300, 123_456_789.123_456_79, -0.0] {
            let back: f64 = cell(Some(value)).parse().unwrap();
            assert_eq!(back.to_bits(), value.to_bits());
        }
        assert_eq!(cell(Some(f64::NAN)), "");
    }

    #[test]
    fn a_table_comes_back_from_its_csv_commas_quotes_and_all() {
        let records = Records {
            fields: vec![Field::text("why, if at all", ""), Field::whole("n", "")],
            rows: vec![
                vec!["it said \"no\", twice".to_owned(), "1".to_owned()],
                vec![String::new(), "2".to_owned()],
            ],
        };
        let back = Records::of_csv(records.fields.clone(), &records.to_csv());
        assert_eq!(back, records);
        assert_eq!(records.column("n").collect::<Vec<_>>(), ["1", "2"]);
        assert_eq!(records.column("m").count(), 0);
    }
}
