//! One CSV file: a header that names the columns, and rows of cells.

use super::gap::Gaps;
use csv::{ByteRecord, ErrorKind, Position, Reader, ReaderBuilder};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What stands in a cell where nothing was measured.
const MISSING: [&str; 6] = ["", "nan", "na", "n/a", "null", "-"];

/// How alike [0 to 1] two names are that one may have meant for the other.
const ALIKE: f64 = 0.8;

/// A CSV file, its header read.
///
/// Lines that begin with `#` are left out, as are empty ones.
pub(super) struct Sheet<R> {
    header: Header,
    reader: Reader<R>,
}

/// The names of the columns of a file.
#[derive(Debug, Clone)]
pub(super) struct Header {
    file: String,
    names: Vec<String>,
    gaps: Gaps,
}

/// A row of a file.
#[derive(Debug)]
pub(super) struct Row {
    cells: ByteRecord,
    line: u64,
}

impl Sheet<File> {
    /// # Errors
    /// What keeps the file from being read, in words.
    pub(super) fn open(path: &Path, delimiter: u8) -> Result<Self, String> {
        let name = path.display().to_string();
        let file = File::open(path).and_then(|file| match file.metadata()?.is_dir() {
            true => Err(std::io::ErrorKind::IsADirectory.into()),
            false => Ok(file),
        });
        let file = file.map_err(|error| format!("cannot read {name}: {error}"))?;
        Self::new(file, &name, delimiter)
    }
}

impl<R: Read> Sheet<R> {
    /// # Errors
    /// Where there is no header, in words.
    pub(super) fn new(source: R, file: &str, delimiter: u8) -> Result<Self, String> {
        let mut reader = ReaderBuilder::new()
            .comment(Some(b'#'))
            .delimiter(delimiter)
            .from_reader(source);
        let names = reader
            .byte_headers()
            .map_err(|error| in_plain_words(file, &error))?;
        let names: Vec<String> = names.iter().map(trimmed).collect();
        if names.is_empty() {
            return Err(format!("{file} is empty; it needs a header row and data"));
        }
        let file = file.to_owned();
        let gaps = Gaps::default();
        let header = Header { file, names, gaps };
        Ok(Self { header, reader })
    }

    /// The same, with cells without a number noted among `gaps`.
    pub(super) fn noting(mut self, gaps: &Gaps) -> Self {
        self.header.gaps = gaps.clone();
        self
    }

    pub(super) fn header(&self) -> &Header {
        &self.header
    }

    /// The next row, `None` after the last.
    ///
    /// # Errors
    /// A row with another number of cells than the header, or one that cannot be read, in words.
    pub(super) fn next_row(&mut self) -> Result<Option<Row>, String> {
        let mut cells = ByteRecord::new();
        let more = self.reader.read_byte_record(&mut cells);
        let more = more.map_err(|error| in_plain_words(&self.header.file, &error))?;
        let line = cells.position().map_or(0, Position::line);
        Ok(more.then_some(Row { cells, line }))
    }
}

impl Header {
    /// Name of the file.
    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// Place of a column.
    ///
    /// # Errors
    /// Where there is none of this name, or two, with the names there are.
    pub(super) fn column(&self, name: &str) -> Result<usize, String> {
        let Self { file, names, .. } = self;
        let mut places = (0..names.len()).filter(|&place| names[place] == name.trim());
        match (places.next(), places.next()) {
            (Some(place), None) => Ok(place),
            (Some(_), Some(_)) => Err(format!(
                "{file} has two columns {name:?}; rename one in its header"
            )),
            (None, _) => Err(format!(
                "{file} has no column {name:?}; {}",
                self.hint(name)
            )),
        }
    }

    /// What may have been meant by the name of a column that is not there.
    fn hint(&self, name: &str) -> String {
        if let [only] = &self.names[..]
            && let Some(delimiter) = [';', '\t', '|'].into_iter().find(|&c| only.contains(c))
        {
            return format!("it has one, {only:?}: write delimiter = {delimiter:?}");
        }
        let likeness =
            |known: &str| strsim::jaro_winkler(&known.to_lowercase(), &name.to_lowercase());
        let best = self.names.iter().map(String::as_str);
        match best.max_by(|a, b| likeness(a).total_cmp(&likeness(b))) {
            Some(best) if likeness(best) >= ALIKE => format!("did you mean {best:?}?"),
            _ => format!("it has {}", self.names.join(", ")),
        }
    }

    /// The text in a cell, without blanks around it.
    pub(super) fn text(&self, row: &Row, column: usize) -> String {
        row.cells.get(column).map(trimmed).unwrap_or_default()
    }

    /// The number in a cell; NaN where nothing was measured, which is noted.
    ///
    /// # Errors
    /// Where the cell holds anything else: file, line, column and cell, and the way out.
    pub(super) fn number(&self, row: &Row, column: usize) -> Result<f64, String> {
        let cell = row.cells.get(column).unwrap_or_default();
        let text = std::str::from_utf8(cell).unwrap_or_default();
        let number: Option<f64> = text.trim().parse().ok();
        if let Some(number) = number.filter(|number| number.is_finite()) {
            return Ok(number);
        }
        let text = self.text(row, column);
        if number.is_some() || MISSING.contains(&text.to_lowercase().as_str()) {
            let place = (self.file.as_str(), self.names[column].as_str());
            self.gaps.note(place, row.line, &text);
            return Ok(f64::NAN);
        }
        let way_out = match text.contains(',') {
            true => "write a point for the decimal comma",
            false => {
                "leave a cell empty where nothing was measured, and begin a line that is no data \
                 with #"
            }
        };
        let (place, name) = (self.place(row), &self.names[column]);
        Err(format!(
            "{place}: column {name:?} holds {text:?}, which is no number; {way_out}"
        ))
    }

    /// File and line of a row.
    pub(super) fn place(&self, row: &Row) -> String {
        format!("{}:{}", self.file, row.line)
    }
}

impl Row {
    /// Its line in the file, from 1.
    pub(super) fn line(&self) -> u64 {
        self.line
    }
}

fn trimmed(cell: &[u8]) -> String {
    // A byte order mark is no part of the first name.
    let text = String::from_utf8_lossy(cell);
    text.trim_start_matches('\u{feff}').trim().to_owned()
}

fn in_plain_words(file: &str, error: &csv::Error) -> String {
    match error.kind() {
        ErrorKind::UnequalLengths {
            pos,
            expected_len,
            len,
        } => {
            let line = pos.as_ref().map_or(0, Position::line);
            format!(
                "{file}:{line}: {len} cells in this row, {expected_len} in the header; leave \
                 cells empty rather than out"
            )
        }
        _ => format!("cannot read {file}: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sheet(text: &str) -> Sheet<&[u8]> {
        Sheet::new(text.as_bytes(), "a.csv", b',').unwrap()
    }

    fn numbers(text: &str, column: &str) -> Result<Vec<f64>, String> {
        let mut sheet = sheet(text);
        let header = sheet.header().clone();
        let column = header.column(column)?;
        let mut numbers = Vec::new();
        while let Some(row) = sheet.next_row()? {
            numbers.push(header.number(&row, column)?);
        }
        Ok(numbers)
    }

    #[test]
    fn comments_blanks_quotes_a_byte_order_mark_and_windows_lines_are_no_data() {
        let text = "\u{feff}# rig 3\r\n t ,\"F [N]\"\r\n0, 1.5\r\n\r\n# paused\r\n1,-2e3\r\n";
        assert_eq!(numbers(text, "F [N]").unwrap(), [1.5, -2000.0]);
        assert_eq!(numbers("\u{feff}t,F\n3,4\n", "t").unwrap(), [3.0]);
    }

    #[test]
    fn missing_cells_are_gaps_in_every_spelling() {
        let text = "t,F\n0,\n1,NaN\n2,n/a\n3,-\n4,NULL\n5, \n";
        let read = numbers(text, "F").unwrap();
        assert!(read.len() == 6 && read.iter().all(|x| x.is_nan()));
    }

    #[test]
    fn gaps_are_told_by_column_with_the_line_of_the_first() {
        let text = "t,F\n0,1\n1,inf\n2,NaN\n3,4\n,5\n";
        let gaps = Gaps::default();
        let mut sheet = sheet(text).noting(&gaps);
        let header = sheet.header().clone();
        while let Some(row) = sheet.next_row().unwrap() {
            for column in 0..2 {
                header.number(&row, column).unwrap();
            }
        }
        let told: Vec<String> = gaps.all().iter().map(ToString::to_string).collect();
        let force = "a.csv:3: column \"F\" holds \"inf\", which counts as not measured; it has 2 \
                     such cells";
        let time = "a.csv:6: column \"t\" holds nothing, which counts as not measured";
        assert_eq!(told, [force, time]);
    }

    #[test]
    fn a_cell_that_is_no_number_is_told_with_its_line_as_an_editor_counts_them() {
        let error = numbers("# licence\nt,F\n\n0,1\n1,high\n", "F").unwrap_err();
        let start = "a.csv:5: column \"F\" holds \"high\", which is no number; leave";
        assert!(error.starts_with(start), "{error}");
        let error = numbers("t,F\n0,\"1,5\"\n", "F").unwrap_err();
        assert!(
            error.ends_with("write a point for the decimal comma"),
            "{error}"
        );
        let error = numbers("t,F\n0,1\n1\n", "F").unwrap_err();
        let start = "a.csv:3: 1 cells in this row, 2 in the header";
        assert!(error.starts_with(start), "{error}");
    }

    #[test]
    fn a_column_that_is_not_there_is_answered_with_one_like_it_or_with_the_delimiter() {
        let error = sheet("t,Fz_N\n").header().column("fz_n").unwrap_err();
        assert_eq!(
            error,
            "a.csv has no column \"fz_n\"; did you mean \"Fz_N\"?"
        );
        let error = sheet("t,Fz_N\n").header().column("load").unwrap_err();
        assert!(error.ends_with("it has t, Fz_N"), "{error}");
        let error = sheet("t;Fz_N\n").header().column("Fz_N").unwrap_err();
        assert!(error.ends_with("write delimiter = ';'"), "{error}");
        let error = sheet("t,t\n").header().column("t").unwrap_err();
        assert!(error.contains("two columns"), "{error}");
        assert!(Sheet::new(&b""[..], "a.csv", b',').is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        #[test]
        fn any_bytes_are_rows_or_a_reason(
            bytes in prop::collection::vec(prop_oneof![
                any::<u8>(),
                prop::sample::select(b"t,F;\"\n\r#0123.-eNa \t".to_vec()),
            ], 0..200),
            delimiter in prop::sample::select(b",;\t|".to_vec()),
        ) {
            let Ok(mut sheet) = Sheet::new(&bytes[..], "a.csv", delimiter) else {
                return Ok(());
            };
            let header = sheet.header().clone();
            let _ = header.column("t");
            while let Ok(Some(row)) = sheet.next_row() {
                for column in 0..header.names.len() {
                    let number = header.number(&row, column);
                    prop_assert!(number.is_ok() || number.unwrap_err().contains(&header.place(&row)));
                }
            }
        }

        #[test]
        fn what_was_written_to_a_column_is_read_back(
            values in prop::collection::vec(prop::num::f64::NORMAL, 1..50),
        ) {
            let rows = values.iter().map(|value| format!("0,{value:e}\n"));
            let text = format!("t,F\n{}", rows.collect::<String>());
            prop_assert_eq!(numbers(&text, "F").unwrap(), values);
        }
    }
}
