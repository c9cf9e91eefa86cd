//! One table of text: names of its columns, and rows of cells.
//!
//! Which rows are data is inferred from their content, unless the campaign states it:
//!
//! - Lines that begin with `#` and empty ones are skipped, the first `skip_lines` too.
//! - The first row names the columns (`header_rows = 1`). Rows directly below it without a number
//!   in any cell are units or short names; they are left out, with a note. `header_rows` states how
//!   many rows stand above the data.
//! - Where the first row consists of numbers, the names are those of a comment before it with as many cells,
//!   with a note, or those that the campaign gives under `names`.

mod naming;

use super::gap::Gaps;
use super::lead::{Aligned, Lead};
use super::line_ends::LineEnds;
use super::notes::Notes;
use super::number::{Content, Decimal};
use super::text::{self, Text};
use csv::{ByteRecord, Reader, ReaderBuilder};
use naming::{Naming, naming};
use std::collections::VecDeque;
use std::io::Read;
use std::path::Path;
use std::rc::Rc;

/// How alike [0 to 1] two names are that one may have meant for the other.
const ALIKE: f64 = 0.8;

/// Number of rows examined before the first is taken as data.
const AHEAD: usize = 32;

/// Most cells that a message lists.
const LISTED: usize = 12;

/// Most characters of a cell that a message repeats.
const SHOWN: usize = 40;

/// How a table is written, as far as a campaign states it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Layout<'a> {
    pub(super) delimiter: Option<char>,
    pub(super) decimal: Option<char>,
    pub(super) encoding: Option<&'a str>,
    pub(super) skip_lines: u64,
    pub(super) header_rows: Option<usize>,
    /// Names of the columns of a table without them.
    pub(super) names: &'a [String],
}

/// A table, its header read.
pub(super) struct Sheet {
    header: Rc<Header>,
    reader: Reader<Box<dyn Read>>,
    /// Rows read ahead.
    ahead: VecDeque<Row>,
    row: Row,
    /// Lines before the reader's first.
    passed: u64,
    /// Why the row after those read ahead cannot be read.
    broken: Option<String>,
    /// Whether no row of data was gone to yet.
    is_at_start: bool,
}

/// The names of the columns of a file.
#[derive(Debug)]
pub(super) struct Header {
    file: String,
    delimiter: char,
    decimal: Decimal,
    naming: Naming,
    gaps: Gaps,
    notes: Notes,
}

/// A row of a file.
#[derive(Debug, Default)]
pub(super) struct Row {
    cells: ByteRecord,
    line: u64,
}

impl Sheet {
    /// Opens the table at `path`; cells without a number are recorded in `gaps`, assumptions in `notes`.
    ///
    /// # Errors
    /// Why the file cannot be read.
    pub(super) fn open(
        path: &Path,
        layout: &Layout<'_>,
        gaps: &Gaps,
        notes: &Notes,
    ) -> Result<Self, String> {
        let name = path.display().to_string();
        let text = text::open(path, layout.encoding)?;
        Self::new(text, &name, layout, gaps, notes)
    }

    fn new(
        text: Text,
        file: &str,
        layout: &Layout<'_>,
        gaps: &Gaps,
        notes: &Notes,
    ) -> Result<Self, String> {
        let delimiter = layout.delimiter.unwrap_or(',');
        let decimal = Decimal::of(layout.decimal, delimiter)?;
        let lines = LineEnds::new(text.reader);
        let source: Box<dyn Read> = match delimiter {
            ' ' => Box::new(Aligned::new(lines)),
            _ => Box::new(lines),
        };
        let lead = Lead::read(source, layout.skip_lines);
        let Lead {
            comments,
            lines,
            rest,
        } = lead.map_err(|error| text::unreadable(file, &error))?;
        let reader = table_reader(delimiter, rest);
        let header = Header {
            file: file.to_owned(),
            delimiter,
            decimal,
            naming: Naming::default(),
            gaps: gaps.clone(),
            notes: notes.clone(),
        };
        let mut sheet = Self {
            header: Rc::new(header),
            reader,
            ahead: VecDeque::new(),
            row: Row::default(),
            passed: lines,
            broken: None,
            is_at_start: true,
        };
        sheet.look_ahead();
        let naming = naming(&mut sheet.ahead, &comments, layout);
        let naming = naming.map_err(|message| match sheet.broken.take() {
            Some(broken) => broken,
            None => format!("{file} {message}"),
        })?;
        for note in text.notes.iter().chain(&naming.notes) {
            sheet.header.notes.add(file, note);
        }
        if let Some(header) = Rc::get_mut(&mut sheet.header) {
            header.naming = naming;
        }
        Ok(sheet)
    }

    fn look_ahead(&mut self) {
        while self.ahead.len() < AHEAD && self.broken.is_none() {
            let mut row = Row::default();
            match self.read(&mut row) {
                Ok(true) => self.ahead.push_back(row),
                Ok(false) => break,
                Err(message) => self.broken = Some(message),
            }
        }
    }

    pub(super) fn header(&self) -> &Rc<Header> {
        &self.header
    }

    /// Goes to the next row; `false` after the last.
    ///
    /// # Errors
    /// A row with another number of cells than the header, or one that cannot be read, in words.
    pub(super) fn advance(&mut self) -> Result<bool, String> {
        match (self.ahead.pop_front(), self.broken.take()) {
            (Some(row), broken) => (self.row, self.broken) = (row, broken),
            (None, Some(broken)) => return Err(broken),
            (None, None) => {
                let mut row = std::mem::take(&mut self.row);
                let more = self.read(&mut row)?;
                self.row = row;
                if !more {
                    return Ok(false);
                }
            }
        }
        let is_first = std::mem::take(&mut self.is_at_start);
        self.header.check(&self.row, is_first)?;
        Ok(true)
    }

    /// The row gone to.
    pub(super) fn row(&self) -> &Row {
        &self.row
    }

    fn read(&mut self, row: &mut Row) -> Result<bool, String> {
        let file = &self.header.file;
        let more = self.reader.read_byte_record(&mut row.cells);
        let more = more.map_err(|error| match error.into_kind() {
            csv::ErrorKind::Io(error) => {
                let last = self.passed + self.reader.position().line();
                format!("{} (at line {last})", text::unreadable(file, &error))
            }
            other => format!("cannot read {file}: {other:?}"),
        })?;
        // The reader is past the row, which may have included comments, and line breaks within quotes.
        let within = row.cells.as_slice().iter().filter(|&&byte| byte == b'\n');
        let lines = self.reader.position().line() - 1;
        row.line = (self.passed + lines).saturating_sub(within.count() as u64);
        Ok(more)
    }
}

/// Rows of `source`, of any length.
fn table_reader(delimiter: char, source: Box<dyn Read>) -> Reader<Box<dyn Read>> {
    ReaderBuilder::new()
        .comment(Some(b'#'))
        .delimiter(delimiter as u8)
        .has_headers(false)
        .flexible(true)
        .from_reader(source)
}

impl Header {
    /// Name of the file.
    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// Where what is done to this file is noted.
    pub(super) fn notes(&self) -> &Notes {
        &self.notes
    }

    /// Place of a column.
    ///
    /// # Errors
    /// Where there is none of this name, or two, with the names there are.
    pub(super) fn column(&self, name: &str) -> Result<usize, String> {
        let (file, names) = (&self.file, &self.naming.names);
        let places = |name: &str, of: fn(&str) -> &str| -> Vec<usize> {
            let places = 0..names.len();
            places
                .filter(|&place| of(&names[place]) == of(name))
                .collect()
        };
        let mut found = places(name.trim(), str::trim);
        if found.is_empty() {
            found = places(name, naming::bare);
        }
        match found[..] {
            [place] => Ok(place),
            [] => Err(format!(
                "{file} has no column {name:?}; {}",
                self.hint(name)
            )),
            _ => Err(format!(
                "{file} has {} columns {name:?}; rename all but one in its header, or name them all with \
                 header_rows = {} and names = [...]",
                match found.len() {
                    2 => "two".to_owned(),
                    count => count.to_string(),
                },
                1 + self.naming.units.len(),
            )),
        }
    }

    /// What the rows below the names state of a column, for example its unit.
    pub(super) fn stated(&self, column: usize) -> impl Iterator<Item = &str> {
        let rows = self.naming.units.iter();
        rows.filter_map(move |row| row.get(column).map(String::as_str))
    }

    /// What may have been meant by the name of a column that is not there.
    fn hint(&self, name: &str) -> String {
        let names = &self.naming.names;
        if let [only] = &names[..]
            && let Some(delimiter) = [';', '\t', '|', ',']
                .into_iter()
                .find(|&c| only.contains(c))
        {
            return format!(
                "it has one, {}: write delimiter = {delimiter:?}",
                shown(only)
            );
        }
        if let [only] = &names[..]
            && only.contains(name)
            && only.contains(' ')
        {
            return format!("it has one, {}: write delimiter = \" \"", shown(only));
        }
        if let Some(line) = self.naming.line_of(name) {
            let skipped = line - 1;
            return format!("line {line} has it: write skip_lines = {skipped}");
        }
        if names.iter().any(|name| name.contains('\u{fffd}')) {
            return "its names are not in UTF-8: state what they are in, for example encoding = \
                    \"windows-1252\""
                .to_owned();
        }
        let has_label = |cell: &String| {
            let labelled = cell.split_once([':', '=']);
            labelled.is_some_and(|(_, number)| super::number::is_number(number.trim()))
        };
        if names.iter().all(has_label) {
            return format!(
                "its cells hold names and numbers ({}): write the names once, in a header",
                shown(&names[0])
            );
        }
        if names.iter().any(|name| super::number::is_number(name)) {
            return "its first row holds numbers: if it is no header, name the columns with \
                    names = [...]"
                .to_owned();
        }
        let likeness =
            |known: &str| strsim::jaro_winkler(&known.to_lowercase(), &name.to_lowercase());
        let best = names.iter().map(String::as_str);
        match best.max_by(|a, b| likeness(a).total_cmp(&likeness(b))) {
            Some(best) if likeness(best) >= ALIKE => format!("did you mean {best:?}?"),
            _ => format!("it has {}", listed(names)),
        }
    }

    /// The trimmed text of a cell.
    pub(super) fn text(&self, row: &Row, column: usize) -> String {
        let text = row.cells.get(column).map(trimmed).unwrap_or_default();
        if text.contains('\u{fffd}') {
            let note = format!(
                "line {}: {} is not in UTF-8: state what it is in, for example encoding = \
                 \"windows-1252\"",
                row.line,
                shown(&text)
            );
            self.notes.add(&self.file, &note);
        }
        text
    }

    /// The number in a cell; NaN where nothing was measured, which is recorded.
    ///
    /// # Errors
    /// For any other content: file, line, column and cell, with the remedy.
    pub(super) fn number(&self, row: &Row, column: usize) -> Result<f64, String> {
        let cell = row.cells.get(column).unwrap_or_default();
        let text = std::str::from_utf8(cell).unwrap_or("\u{fffd}");
        let content = self.decimal.read(text);
        let way_out = match content {
            Content::Number(number) => return Ok(number),
            Content::Missing => {
                let column = self.name(column);
                self.gaps.note(&self.file, column, row.line, text.trim());
                return Ok(f64::NAN);
            }
            Content::OtherMark => self.way_out_of_marks(),
            Content::Other => self.way_out_of_text(text.trim(), column).to_owned(),
        };
        let (place, name) = (self.place(row), self.name(column));
        Err(format!(
            "{place}: column {name:?} holds {}, which is no number; {way_out}",
            shown(&trimmed(cell))
        ))
    }

    /// Whether the number of a cell is this one.
    pub(super) fn is_number(&self, row: &Row, column: usize, number: f64) -> bool {
        let cell = row.cells.get(column).unwrap_or_default();
        let text = std::str::from_utf8(cell).unwrap_or_default();
        self.decimal.read(text) == Content::Number(number)
    }

    /// The text of a cell and its parsed content.
    pub(super) fn cell<'r>(&self, row: &'r Row, column: usize) -> (&'r str, Content) {
        let cell = row.cells.get(column).unwrap_or_default();
        let text = std::str::from_utf8(cell).unwrap_or("\u{fffd}").trim();
        (text, self.decimal.read(text))
    }

    fn way_out_of_text(&self, text: &str, column: usize) -> &'static str {
        if text == self.name(column) {
            "the header stands here again: the log was started anew; part the file here"
        } else if text.contains(':') {
            "a time stamp belongs to time_s; name another column"
        } else if super::number::has_thousands(text) {
            "write numbers without marks between their thousands"
        } else if super::number::has_unit(text) {
            "write the number alone, and its unit in the campaign: unit = \"...\""
        } else {
            "leave a cell empty where nothing was measured, and begin a line that is no data with #"
        }
    }

    fn way_out_of_marks(&self) -> String {
        match (self.decimal.is_comma(), self.delimiter) {
            (true, _) => "other numbers of this file have a decimal comma: write one kind, \
                          or state decimal = \".\""
                .to_owned(),
            (false, ',') => "state decimal = \",\" for the decimal comma".to_owned(),
            (false, _) => "other numbers of this file have a decimal point: write one kind, \
                           or state decimal = \",\""
                .to_owned(),
        }
    }

    /// Notes what was taken for granted about the numbers that were read.
    pub(super) fn note_decimal(&self, stated: bool) {
        if self.decimal.is_comma() && !stated {
            self.notes
                .add(&self.file, "numbers read with a decimal comma");
        }
    }

    fn name(&self, column: usize) -> &str {
        self.naming.names.get(column).map_or("", String::as_str)
    }

    /// File and line of a row.
    pub(super) fn place(&self, row: &Row) -> String {
        format!("{}:{}", self.file, row.line)
    }

    /// Refuses a row of another length than the header, one empty cell at its end apart, and a
    /// cell that runs over its line.
    fn check(&self, row: &Row, is_first: bool) -> Result<(), String> {
        let (expected, len) = (self.naming.names.len(), row.cells.len());
        if row.cells.as_slice().contains(&b'\n') {
            return Err(format!(
                "{}: a quote opens here and does not close in its line; remove it, or write it \
                 twice within a quoted cell",
                self.place(row)
            ));
        }
        let blank = |place: usize| trimmed(&row.cells[place]).is_empty();
        if len == expected
            || (len == expected + 1 && blank(expected))
            || (len + 1 == expected && self.name(len).is_empty())
        {
            return Ok(());
        }
        let way_out = match len {
            _ if self.delimiter == ',' && len == 2 * expected && expected > 1 => {
                "if commas are decimal here, write the table with ; between cells".to_owned()
            }
            _ if is_first => format!(
                "leave cells empty rather than out, or if all rows have {len} name those with \
                 header_rows = {} and names = [...]",
                1 + self.naming.units.len()
            ),
            _ => "leave cells empty rather than out".to_owned(),
        };
        Err(format!(
            "{}: {len} cells in this row, {expected} in the header; {way_out}",
            self.place(row)
        ))
    }
}

impl Row {
    /// Its line in the file, from 1.
    pub(super) fn line(&self) -> u64 {
        self.line
    }

    /// The trimmed texts of its cells.
    fn texts(&self) -> Vec<String> {
        self.cells.iter().map(trimmed).collect()
    }
}

/// A cell's trimmed text on one line.
fn trimmed(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    let text = text.trim();
    if text.contains(char::is_control) {
        text.split(char::is_control).collect::<Vec<_>>().join(" ")
    } else {
        text.to_owned()
    }
}

/// The first of many cells.
fn listed(cells: &[String]) -> String {
    let first = cells.iter().take(LISTED).map(String::as_str);
    let first = first.collect::<Vec<_>>().join(", ");
    match cells.len().saturating_sub(LISTED) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

/// A cell in quotes, as far as a message may repeat it.
pub(super) fn shown(cell: &str) -> String {
    match cell.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{:?}...", &cell[..end]),
        None => format!("{cell:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sheet_of(text: &[u8], layout: &Layout<'_>, gaps: &Gaps) -> Result<Sheet, String> {
        let text = text::from(std::io::Cursor::new(text.to_vec()), "a.csv", None)?;
        Sheet::new(text, "a.csv", layout, gaps, &Notes::default())
    }

    fn sheet(text: &str) -> Sheet {
        sheet_of(text.as_bytes(), &Layout::default(), &Gaps::default()).unwrap()
    }

    fn numbers(text: &str, column: &str) -> Result<Vec<f64>, String> {
        let mut sheet = sheet(text);
        let header = sheet.header().clone();
        let column = header.column(column)?;
        let mut numbers = Vec::new();
        while sheet.advance()? {
            numbers.push(header.number(sheet.row(), column)?);
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
    fn gaps_are_reported_by_column_with_the_line_of_the_first() {
        let text = "t,F\n0,1\n1,inf\n2,NaN\n3,4\n,5\n";
        let gaps = Gaps::default();
        let mut sheet = sheet_of(text.as_bytes(), &Layout::default(), &gaps).unwrap();
        let header = sheet.header().clone();
        while sheet.advance().unwrap() {
            for column in 0..2 {
                header.number(sheet.row(), column).unwrap();
            }
        }
        let reported: Vec<String> = gaps.all().iter().map(ToString::to_string).collect();
        let force = "a.csv:3: column \"F\" holds \"inf\", which counts as not measured; it has 2 \
                     such cells";
        let time = "a.csv:6: column \"t\" holds nothing, which counts as not measured";
        assert_eq!(reported, [force, time]);
    }

    #[test]
    fn a_cell_that_is_no_number_is_reported_with_its_line_as_counted_by_an_editor() {
        let error = numbers("# licence\nt,F\n\n0,1\n1,high\n", "F").unwrap_err();
        let start = "a.csv:5: column \"F\" holds \"high\", which is no number; leave";
        assert!(error.starts_with(start), "{error}");
        let error = numbers("t,F\n0,\"1,5\"\n", "F").unwrap_err();
        assert!(
            error.ends_with("state decimal = \",\" for the decimal comma"),
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
        assert!(sheet_of(b"", &Layout::default(), &Gaps::default()).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        #[test]
        fn any_bytes_are_rows_or_a_reason(
            bytes in prop::collection::vec(prop_oneof![
                any::<u8>(),
                prop::sample::select(b"t,F;\"\n\r#0123.-eNa \t".to_vec()),
            ], 0..200),
            delimiter in prop::sample::select(vec![',', ';', '\t', '|', ' ']),
        ) {
            let layout = Layout { delimiter: Some(delimiter), ..Layout::default() };
            let Ok(mut sheet) = sheet_of(&bytes, &layout, &Gaps::default()) else {
                return Ok(());
            };
            let header = sheet.header().clone();
            let _ = header.column("t");
            while let Ok(true) = sheet.advance() {
                let row = sheet.row();
                for column in 0..header.naming.names.len() {
                    let number = header.number(row, column);
                    prop_assert!(number.is_ok() || number.unwrap_err().contains(&header.place(row)));
                }
            }
        }

        #[test]
        fn what_was_written_to_a_column_is_read_back(
            values in prop::collection::vec(
                prop::num::f64::NORMAL.prop_filter("stored", |value| value.abs() <= f64::from(f32::MAX)),
                1..50,
            ),
        ) {
            let rows = values.iter().map(|value| format!("0,{value:e}\n"));
            let text = format!("t,F\n{}", rows.collect::<String>());
            prop_assert_eq!(numbers(&text, "F").unwrap(), values);
        }
    }
}
