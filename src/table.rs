//! Tables of results: one value, written as text, and by [`report::page`](mod@crate::report::page) as HTML.

use crate::statistics::Share;

/// A table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// What the numbers are.
    pub caption: String,
    /// One header for every column.
    pub columns: Vec<Column>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<Cell>>,
}

/// The header of a column.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Unit; empty where the cells have none or each its own.
    pub unit: String,
}

impl Column {
    /// A column of this name and unit.
    pub fn new(name: impl Into<String>, unit: &str) -> Self {
        Self {
            name: name.into(),
            unit: unit.to_owned(),
        }
    }

    /// Columns without units.
    pub fn named<N: Into<String>>(names: impl IntoIterator<Item = N>) -> Vec<Self> {
        let columns = names.into_iter().map(|name| Self::new(name, ""));
        columns.collect()
    }

    /// Name, and unit in brackets.
    fn header(&self) -> String {
        match self.unit.as_str() {
            "" => self.name.clone(),
            unit => format!("{} [{unit}]", self.name),
        }
    }
}

/// A column without unit.
impl<N: Into<String>> From<N> for Column {
    fn from(name: N) -> Self {
        Self::new(name, "")
    }
}

impl Table {
    /// A table without a caption.
    pub fn of<C: Into<Column>>(
        columns: impl IntoIterator<Item = C>,
        rows: impl IntoIterator<Item = Vec<Cell>>,
    ) -> Self {
        Self {
            caption: String::new(),
            columns: columns.into_iter().map(Into::into).collect(),
            rows: rows.into_iter().collect(),
        }
    }

    /// The same with a caption.
    pub fn captioned(self, caption: impl Into<String>) -> Self {
        let caption = caption.into();
        Self { caption, ..self }
    }

    /// The columns and rows as lines of text behind `indent` blanks: columns of numbers to the right, others to the
    /// left, two blanks between them, in ASCII but for the texts.
    pub fn to_text(&self, indent: usize) -> String {
        let header = self.columns.iter().map(Column::header).collect();
        let rows = self.rows.iter().map(|row| {
            let cells = row.iter().map(Cell::in_ascii);
            cells.collect()
        });
        let lines: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|column| {
                let cells = lines.iter().filter_map(|line| line.get(column));
                cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
            })
            .collect();
        let is_number: Vec<bool> = (0..self.columns.len())
            .map(|column| self.holds_numbers(column))
            .collect();
        let mut text = String::new();
        for line in &lines {
            let cells = line.iter().zip(&widths).zip(&is_number);
            let cells = cells.map(|((cell, &width), is_number)| {
                if *is_number {
                    format!("{cell:>width$}")
                } else {
                    format!("{cell:<width$}")
                }
            });
            let cells = cells.collect::<Vec<_>>().join("  ");
            text.push_str(&format!("{:indent$}{}\n", "", cells.trim_end()));
        }
        text
    }

    /// Whether a column holds numbers, and no text among them.
    pub(crate) fn holds_numbers(&self, column: usize) -> bool {
        let cells = || self.rows.iter().filter_map(|row| row.get(column));
        let is_text = |cell: &Cell| matches!(cell, Cell::Text(_) | Cell::Code(_));
        cells().any(|cell| cell.key().is_some()) && !cells().any(is_text)
    }
}

/// Content of a table's cell. Measured and computed numbers are written with four digits.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// What is typed: a command, a key.
    Code(String),
    /// How many there are.
    Count(u64),
    /// A number; none where it is not finite and not infinite.
    Number(f64),
    /// A number and the interval (low, high) that holds it with 95 %; infinite where unbounded.
    Estimate(f64, [f64; 2]),
    /// A number written in a way of its own, and the number.
    Written(String, f64),
    /// There is none.
    Missing,
}

impl Cell {
    /// A cell of text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// A TOML value, sorted by its size where it is a number, of which at most seven characters are shown.
    pub fn toml(value: &str) -> Self {
        match value.parse::<f64>() {
            Ok(number) if value.len() > 7 => Self::Number(number),
            Ok(number) => Self::Written(value.replace('-', "−"), number),
            Err(_) => Self::text(value),
        }
    }

    /// A share in per cent with its interval.
    pub fn share(share: &Share) -> Self {
        let [value, low, high] = share.percent();
        Self::Written(format!("{value:.1} % [{low:.1}, {high:.1}]"), share.value)
    }

    /// As it stands in the table.
    pub(crate) fn written(&self) -> String {
        match self {
            Self::Text(text) | Self::Code(text) | Self::Written(text, _) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(value) => four_digits(*value),
            Self::Estimate(value, [low, high]) => format!(
                "{} [{}, {}]",
                four_digits(*value),
                four_digits(*low),
                four_digits(*high)
            ),
            Self::Missing => "–".to_owned(),
        }
    }

    /// The same with hyphens for minus signs and dashes in numbers.
    pub(crate) fn in_ascii(&self) -> String {
        match self {
            Self::Text(text) | Self::Code(text) => text.clone(),
            number => number.written().replace(['−', '–'], "-"),
        }
    }

    /// By what it is sorted among numbers.
    pub(crate) fn key(&self) -> Option<f64> {
        let key = match self {
            Self::Text(_) | Self::Code(_) | Self::Missing => return None,
            Self::Count(count) => *count as f64,
            Self::Number(value) | Self::Estimate(value, _) | Self::Written(_, value) => *value,
        };
        (!key.is_nan()).then_some(key)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::Missing, Into::into)
    }
}

impl From<&Share> for Cell {
    fn from(share: &Share) -> Self {
        Self::share(share)
    }
}

/// A number with four significant digits; `unbounded` where infinite, `–` where there is none.
pub fn four_digits(value: f64) -> String {
    if value.is_nan() {
        return "–".to_owned();
    }
    if value.is_infinite() {
        return "unbounded".to_owned();
    }
    let text = if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
        format!("{value:.3e}")
    } else {
        let digits = |value: f64| libm::floor(libm::log10(value)) as i32;
        let decimals = if value == 0.0 {
            0
        } else {
            3 - digits(value.abs())
        };
        format!("{value:.*}", decimals.max(0) as usize)
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_and_say_when_they_are_unbounded() {
        let written = [0.0, 15.62, -0.01234567, 12345.6, 1.5e6, 1e-7, 999.96].map(four_digits);
        let expected = [
            "0",
            "15.62",
            "−0.01235",
            "12346",
            "1.500e6",
            "1.000e−7",
            "1000.0",
        ];
        assert_eq!(written, expected);
        let cell = Cell::Estimate(1.1, [0.9, f64::INFINITY]).written();
        assert_eq!(cell, "1.100 [0.9000, unbounded]");
        assert_eq!(Cell::Number(f64::NAN).written(), "–");
        assert_eq!(Cell::Count(20).written(), "20");
    }

    #[test]
    fn a_share_is_written_in_per_cent_with_its_interval_and_sorted_by_itself() {
        let cell = Cell::share(&Share::of(288, 300).unwrap());
        assert_eq!(cell.written(), "96.0 % [93.1, 97.7]");
        assert_eq!(cell.key(), Some(0.96));
        assert_eq!(Cell::from(None::<&Share>).written(), "–");
    }

    #[test]
    fn a_text_has_numbers_to_the_right_texts_to_the_left_and_no_blanks_at_the_end() {
        let table = Table {
            caption: "not in the text".to_owned(),
            columns: vec![
                Column::new("ground", ""),
                Column::new("sinkage", "mm"),
                Column::new("note", ""),
            ],
            rows: vec![
                vec![
                    Cell::text("loose sand"),
                    Cell::Number(-12.3),
                    Cell::text(""),
                ],
                vec![
                    Cell::text("slate"),
                    Cell::Missing,
                    Cell::text("dry – so far"),
                ],
            ],
        };
        let expected = [
            "  ground      sinkage [mm]  note",
            "  loose sand        -12.30",
            "  slate                  -  dry – so far",
        ];
        assert_eq!(table.to_text(2).lines().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn what_has_no_number_has_no_key() {
        let without = [Cell::text("3"), Cell::Missing, Cell::Number(f64::NAN)];
        assert_eq!(without.map(|cell| cell.key()), [None, None, None]);
        assert_eq!(Cell::Estimate(2.0, [1.0, 3.0]).key(), Some(2.0));
    }
}
