//! Position of a table's column names and of its first data row.

use super::super::lead::Comment;
use super::super::number::{is_missing, is_number};
use super::{Layout, Row, listed};
use csv::ReaderBuilder;
use std::collections::VecDeque;

/// Most rows of units or short names below the names.
const MOST_UNITS: usize = 3;

/// The names of a table's columns.
#[derive(Debug, Default)]
pub(super) struct Naming {
    pub(super) names: Vec<String>,
    /// Rows between the names and the data.
    pub(super) units: Vec<Vec<String>>,
    /// Rows without a number below the names, of which one may be the header after a preamble.
    later: Vec<(u64, Vec<String>)>,
    /// What was taken for granted.
    pub(super) notes: Vec<String>,
}

impl Naming {
    /// Line of a later row that has a cell of this name.
    pub(super) fn line_of(&self, name: &str) -> Option<u64> {
        let has = |row: &&(u64, Vec<String>)| row.1.iter().any(|cell| bare(cell) == bare(name));
        self.later.iter().find(has).map(|(line, _)| *line)
    }
}

/// A name without blanks and signs of a comment before it.
pub(super) fn bare(name: &str) -> &str {
    name.trim_start_matches(['#', '%', ' ', '\t']).trim()
}

/// The names of the table whose first rows are `ahead`, from which those that are no data are
/// taken.
///
/// # Errors
/// Where there are none, in words that follow the file's name.
pub(super) fn naming(
    ahead: &mut VecDeque<Row>,
    comments: &[Comment],
    layout: &Layout<'_>,
) -> Result<Naming, String> {
    let Some(first) = ahead.front() else {
        return Err("is empty; it needs a header row and data".to_owned());
    };
    let mut naming = if !layout.names.is_empty() {
        given(ahead, layout)?
    } else if layout.header_rows.is_none() && is_all_numbers(first) || layout.header_rows == Some(0)
    {
        from_comments(&first.texts(), comments, layout)?
    } else {
        from_rows(ahead, layout)
    };
    let later = ahead
        .iter()
        .filter(|row| !row.texts().iter().any(|cell| is_number(cell)));
    naming
        .later
        .extend(later.map(|row| (row.line, row.texts())));
    Ok(naming)
}

/// The names that the campaign gives.
fn given(ahead: &mut VecDeque<Row>, layout: &Layout<'_>) -> Result<Naming, String> {
    let names = layout.names.to_vec();
    let replaced = layout.header_rows.unwrap_or(0).min(ahead.len());
    let units = ahead.drain(..replaced).map(|row| row.texts()).collect();
    if let Some(row) = ahead.front() {
        let cells = row.texts();
        let is_data = cells.iter().any(|cell| is_number(cell) || is_time(cell));
        if layout.header_rows.is_none() && !is_data {
            return Err(format!(
                "has a row of names already in line {}: {}; leave names out, or replace that row \
                 with header_rows = 1",
                row.line,
                listed(&cells)
            ));
        }
        let blank_end =
            cells.len() == names.len() + 1 && cells.last().is_some_and(String::is_empty);
        if cells.len() != names.len() && !blank_end {
            return Err(format!(
                "has {} cells in line {}, and names gives {}; name every column{}",
                cells.len(),
                row.line,
                names.len(),
                if cells.len() == 1 {
                    ", and state the delimiter"
                } else {
                    ""
                },
            ));
        }
    }
    Ok(Naming {
        names,
        units,
        ..Naming::default()
    })
}

/// Names in a comment above the first row, whose cells are `first`.
fn from_comments(
    first: &[String],
    comments: &[Comment],
    layout: &Layout<'_>,
) -> Result<Naming, String> {
    let split = comments
        .iter()
        .map(|comment| (comment.line, cells_of(&comment.text, layout)));
    let fits = |(_, cells): &(u64, Vec<String>)| {
        cells.len() == first.len() && !cells.iter().any(|cell| is_number(cell))
    };
    let split: Vec<_> = split.collect();
    let fitting = split.iter().rev().skip_while(|comment| !fits(comment));
    let mut block: Vec<_> = fitting
        .take_while(|comment| fits(comment))
        .cloned()
        .collect();
    let Some((line, names)) = block.pop() else {
        let count = first.len();
        return Err(format!(
            "has no header: its first row holds numbers ({}); name its {count} column{} with \
             names = [...], in the order of the file, or state header_rows = 1 if those are names",
            listed(first),
            if count == 1 { "" } else { "s" },
        ));
    };
    let units = block.into_iter().rev().map(|(_, cells)| cells).collect();
    let note = format!("names of columns taken from the comment in line {line}");
    Ok(Naming {
        names,
        units,
        notes: vec![note],
        ..Naming::default()
    })
}

fn cells_of(line: &str, layout: &Layout<'_>) -> Vec<String> {
    let delimiter = layout.delimiter.unwrap_or(',');
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter as u8)
        .from_reader(line.as_bytes());
    let first = reader.byte_records().next().and_then(Result::ok);
    let row = Row {
        cells: first.unwrap_or_default(),
        line: 0,
    };
    row.texts()
}

/// Names in the first row, and those rows below it that are no data.
fn from_rows(ahead: &mut VecDeque<Row>, layout: &Layout<'_>) -> Naming {
    let names = ahead.pop_front().map(|row| row.texts()).unwrap_or_default();
    let is_stated = layout.header_rows.is_some();
    let below = match layout.header_rows {
        Some(rows) => rows.saturating_sub(1).min(ahead.len()),
        None => ahead
            .iter()
            .take(MOST_UNITS)
            .take_while(|row| is_units(row))
            .count(),
    };
    let rows: Vec<Row> = ahead.drain(..below).collect();
    let mut notes = Vec::new();
    if !is_stated && let [first, .., last] | [first @ last] = &rows[..] {
        let lines = match (first.line, last.line) {
            (first, last) if first == last => format!("line {first} holds"),
            (first, last) => format!("lines {first} to {last} hold"),
        };
        notes.push(format!(
            "{lines} no number: taken as units and short names, not as data"
        ));
    }
    let units = rows.iter().map(Row::texts).collect();
    let later = rows.iter().map(|row| (row.line, row.texts()));
    Naming {
        names,
        units,
        later: later.collect(),
        notes,
    }
}

/// Whether every cell that is not empty is a number, and one is.
fn is_all_numbers(row: &Row) -> bool {
    let cells = row.texts();
    let fits = |cell: &String| is_missing(cell) || is_number(cell) || is_time(cell);
    cells.iter().all(fits) && cells.iter().any(|cell| is_number(cell))
}

/// Whether a row has texts and no number; 1 is the unit of a ratio.
fn is_units(row: &Row) -> bool {
    let cells = row.texts();
    let text = |cell: &&String| !is_missing(cell) && !is_number(cell) && !is_time(cell);
    let number = |cell: &&String| (is_number(cell) || is_time(cell)) && *cell != "1";
    cells.iter().any(|cell| text(&cell)) && !cells.iter().any(|cell| number(&cell))
}

/// Whether a cell begins like a date or a time of day.
fn is_time(cell: &str) -> bool {
    let digit = cell.starts_with(|c: char| c.is_ascii_digit() || c == '-');
    digit
        && (cell.contains(':') || cell.matches('-').count() == 2 || cell.matches('.').count() == 2)
}
