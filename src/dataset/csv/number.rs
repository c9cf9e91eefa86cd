//! Numbers in cells, with a decimal point or comma.

use std::cell::Cell;

/// Contents of a cell that mean "not measured".
const MISSING: [&str; 18] = [
    "", "nan", "na", "n/a", "null", "-", "none", "<na>", "nat", "#n/a", "#na", "#div/0!",
    "#value!", "1.#qnan", "-1.#qnan", "1.#ind", "-1.#ind", "1.#inf",
];

/// The decimal mark of a file.
///
/// A campaign states it. Where it does not, it is a point between cells parted by commas;
/// otherwise the first number with a fraction decides for the whole file: a comma that parts
/// thousands in one cell and a point in another cannot both be decimal.
#[derive(Debug, Clone)]
pub(super) struct Decimal(Cell<Mark>);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    Undecided,
    Point,
    Comma,
}

/// Content of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Content {
    /// A finite number.
    Number(f64),
    /// Nothing that was measured, infinity among it.
    Missing,
    /// Neither.
    Other,
    /// A number if the file's decimal mark were another.
    OtherMark,
}

impl Decimal {
    /// The mark stated in a campaign, or otherwise implied by `delimiter`.
    ///
    /// # Errors
    /// A mark that is neither a point nor a comma, in words.
    pub(super) fn of(stated: Option<char>, delimiter: char) -> Result<Self, String> {
        let mark = match (stated, delimiter) {
            (Some('.'), _) | (None, ',') => Mark::Point,
            (Some(','), _) => Mark::Comma,
            (None, _) => Mark::Undecided,
            (Some(other), _) => {
                return Err(format!("decimal must be \".\" or \",\", got {other:?}"));
            }
        };
        Ok(Self(Cell::new(mark)))
    }

    /// Parses `cell`.
    pub(super) fn read(&self, cell: &str) -> Content {
        let cell = cell.trim();
        let parsed = match self.0.get() {
            Mark::Comma if cell.contains('.') => None,
            Mark::Comma if cell.contains(',') => with_comma(cell),
            _ => cell.parse().ok(),
        };
        match parsed {
            // A channel is stored in single precision.
            Some(number) if f64::abs(number) <= f64::from(f32::MAX) => {
                if self.0.get() == Mark::Undecided && cell.contains('.') {
                    self.0.set(Mark::Point);
                }
                Content::Number(number)
            }
            Some(_) => Content::Missing,
            None if is_missing(cell) => Content::Missing,
            None => self.unparsed(cell),
        }
    }

    fn unparsed(&self, cell: &str) -> Content {
        let signed = cell.replace('\u{2212}', "-");
        if signed != cell {
            return self.read(&signed);
        }
        match self.0.get() {
            Mark::Undecided if with_comma(cell).is_some() => {
                self.0.set(Mark::Comma);
                self.read(cell)
            }
            Mark::Point if with_comma(cell).is_some() => Content::OtherMark,
            Mark::Comma if cell.parse::<f64>().is_ok() => Content::OtherMark,
            _ => Content::Other,
        }
    }

    /// Whether numbers are read with a comma.
    pub(super) fn is_comma(&self) -> bool {
        self.0.get() == Mark::Comma
    }
}

/// A number with one decimal comma and no point.
fn with_comma(cell: &str) -> Option<f64> {
    let fits = cell.matches(',').count() == 1 && !cell.contains('.');
    let number: Option<f64> = fits.then(|| cell.replace(',', ".").parse().ok()).flatten();
    number.filter(|number| number.is_finite())
}

/// Whether a cell states that nothing was measured.
pub(super) fn is_missing(cell: &str) -> bool {
    let is = |spelling: &&str| cell.eq_ignore_ascii_case(spelling);
    MISSING.iter().any(is)
}

/// Whether a cell is a number in either notation.
pub(super) fn is_number(cell: &str) -> bool {
    let finite = |number: f64| number.is_finite();
    cell.parse().is_ok_and(finite) || with_comma(cell).is_some()
}

/// Whether a cell is a number with marks between its thousands, as spreadsheets show one.
pub(super) fn has_thousands(cell: &str) -> bool {
    let marks = ['.', ',', '\'', '\u{2019}', ' ', '\u{a0}', '\u{202f}'];
    let unsigned = cell.trim_start_matches(['+', '-', '\u{2212}']);
    let groups: Vec<&str> = unsigned.split(marks).collect();
    let digits = |group: &&str| !group.is_empty() && group.bytes().all(|b| b.is_ascii_digit());
    match groups[..] {
        [first, thousands, ..] => {
            first.len() <= 3 && thousands.len() == 3 && groups.iter().all(digits)
        }
        _ => false,
    }
}

/// Whether a cell is a number with a unit behind it.
pub(super) fn has_unit(cell: &str) -> bool {
    let of_number = |c: char| c.is_ascii_digit() || ['+', '-', '.', ','].contains(&c);
    let number = cell.trim_end_matches(|c| !of_number(c));
    !number.is_empty() && number != cell && is_number(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(stated: Option<char>, delimiter: char, cells: &[&str]) -> Vec<Content> {
        let decimal = Decimal::of(stated, delimiter).unwrap();
        cells.iter().map(|cell| decimal.read(cell)).collect()
    }

    #[test]
    fn a_decimal_comma_is_read_where_it_is_stated_or_where_cells_are_parted_otherwise() {
        let numbers = [
            Content::Number(1.5),
            Content::Number(-2e3),
            Content::Number(7.0),
        ];
        assert_eq!(read(Some(','), ',', &["1,5", "-2,0e3", "7"]), numbers);
        assert_eq!(read(None, ';', &["1,5", "-2,0e3", "7"]), numbers);
        assert_eq!(read(None, ';', &["1.5", "-2.0e3", "7"]), numbers);
        assert_eq!(read(None, '\t', &["+1,5", "\u{2212}2000", "7"]), numbers);
        assert!(Decimal::of(Some('x'), ';').is_err());
    }

    #[test]
    fn a_number_beyond_single_precision_was_not_measured() {
        let cells = ["1e38", "1e39", "-1e300"];
        let [missing, number] = [Content::Missing, Content::Number(1e38)];
        assert_eq!(read(None, ',', &cells), [number, missing, missing]);
        assert_eq!(read(None, ';', &["1,5e300"]), [missing]);
    }

    #[test]
    fn one_file_has_one_decimal_mark() {
        let [one, other] = [Content::Number(1.5), Content::OtherMark];
        assert_eq!(read(None, ';', &["1.5", "1,5"]), [one, other]);
        assert_eq!(read(None, ';', &["1,5", "1.5"]), [one, other]);
        assert_eq!(read(None, ',', &["1.5", "1,5"]), [one, other]);
        assert_eq!(read(Some(','), ';', &["1,5", "1.5"]), [one, other]);
        for thousands in ["1,234.5", "1,234,567", "1.234,5"] {
            assert_eq!(read(None, ';', &[thousands]), [Content::Other]);
        }
    }

    #[test]
    fn infinity_and_every_spelling_of_nothing_are_missing() {
        for cell in [
            "",
            " ",
            "NaN",
            "n/a",
            "NULL",
            "-",
            "inf",
            "-Infinity",
            "-nan",
            "None",
            "#N/A",
            "1.#QNAN",
        ] {
            assert_eq!(read(None, ',', &[cell]), [Content::Missing], "{cell:?}");
        }
    }

    #[test]
    fn thousands_separators_and_trailing_units_are_distinguished_from_other_texts() {
        for cell in [
            "1.100,5",
            "1'234.5",
            "-12\u{202f}345,0",
            "1,234,567",
            "1 234",
        ] {
            assert!(has_thousands(cell), "{cell}");
        }
        for cell in ["03.05.2024", "1.2.3", "high", "12 N", "1,23"] {
            assert!(!has_thousands(cell), "{cell}");
        }
        for cell in ["12 N", "0.5g", "-3,2 %", "1e3 mm"] {
            assert!(has_unit(cell), "{cell}");
        }
        for cell in ["high", "12", "N 12", "1.2.3 m", "x1"] {
            assert!(!has_unit(cell), "{cell}");
        }
    }
}
