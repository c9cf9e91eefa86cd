//! A CSV file as a campaign describes it: which columns, which rows, in which units.

use super::Misplaced;
use super::description::{ColumnTable, Given, SourceTable};
use super::gap::Gaps;
use super::sheet::{Header, Row, Sheet};
use super::unit;
use crate::trace::{CHANNELS, unit_of};
use std::fs::File;
use std::path::Path;

/// Characters that may stand between the cells of a row.
const DELIMITERS: [char; 5] = [',', ';', '\t', '|', ' '];

/// A part of a campaign, and its dotted key: `run.3` or `table`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) table: &'a SourceTable,
    pub(super) key: &'a str,
    pub(super) gaps: &'a Gaps,
}

/// The rows of a file that a campaign asks for.
pub(super) struct Rows<'a> {
    source: Source<'a>,
    sheet: Sheet<File>,
    /// Columns, and what they must hold.
    conditions: Vec<(usize, &'a str, &'a Given)>,
}

/// What a column measures, and how its numbers become it: `(cell - subtract) · factor`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Measure {
    pub(super) name: String,
    /// Unit of what comes out.
    pub(super) unit: String,
    subtract: f64,
    factor: f64,
    column: usize,
}

impl<'a> Source<'a> {
    /// A fault in the value of `key` here.
    pub(super) fn fault(&self, key: &str, message: impl Into<String>) -> Misplaced {
        Misplaced {
            key: format!("{}.{key}", self.key),
            message: message.into(),
        }
    }

    /// Opens the file, which is named from the campaign's `folder`.
    pub(super) fn open(self, folder: &Path) -> Result<Rows<'a>, Misplaced> {
        let delimiter = self.table.delimiter.unwrap_or(',');
        if !DELIMITERS.contains(&delimiter) {
            let message = format!("delimiter must be one of {DELIMITERS:?}, got {delimiter:?}");
            return Err(self.fault("delimiter", message));
        }
        let sheet = Sheet::open(&folder.join(&self.table.file), delimiter as u8)
            .map_err(|message| self.fault("file", message))?
            .noting(self.gaps);
        let condition = |(name, wanted): (&'a String, &'a Given)| {
            let at = |message| self.fault(&format!("rows.{name}"), message);
            if let Given::Column(_) = wanted {
                return Err(at("rows are picked by a number or a text".to_owned()));
            }
            let column = sheet.header().column(name).map_err(at)?;
            Ok((column, name.as_str(), wanted))
        };
        let conditions = self.table.rows.iter().map(condition);
        let conditions = conditions.collect::<Result<_, _>>()?;
        Ok(Rows {
            source: self,
            sheet,
            conditions,
        })
    }

    /// What the column given under `columns.name` measures.
    pub(super) fn measure(&self, name: &str, header: &Header) -> Result<Measure, Misplaced> {
        let at = |message| self.fault(&format!("columns.{name}"), message);
        let column = self.column(name).map_err(at)?;
        let target = match name {
            "time_s" => Some("s"),
            _ => unit_of(name),
        };
        let place = header.column(&column.column).map_err(at)?;
        let unit = match (target, &column.unit) {
            (Some(target), _) => target.to_owned(),
            (None, Some(unit)) => unit.clone(),
            (None, None) => return Err(at(unknown_channel(name, &column.column))),
        };
        Ok(Measure {
            name: name.to_owned(),
            factor: factor(&column, name, target).map_err(at)?,
            subtract: finite("subtract", column.subtract.unwrap_or(0.0)).map_err(at)?,
            unit,
            column: place,
        })
    }

    /// The column given under `columns.name`, as a table.
    pub(super) fn column(&self, name: &str) -> Result<ColumnTable, String> {
        match &self.table.columns[name] {
            Given::Text(column) => Ok(ColumnTable {
                column: column.clone(),
                ..ColumnTable::default()
            }),
            Given::Column(column) => Ok(column.clone()),
            Given::Number(number) => Err(format!(
                "a column is named by its text in the header, got {number}"
            )),
        }
    }

    /// Names of the channels that are given.
    pub(super) fn channels(&self) -> Result<Vec<&'a str>, Misplaced> {
        let names = self.table.columns.keys().map(String::as_str);
        let names: Vec<&str> = names.filter(|name| *name != "time_s").collect();
        if names.is_empty() {
            return Err(self.fault(
                "columns",
                "no channel here; name one, for example drawbar_pull",
            ));
        }
        Ok(names)
    }
}

impl Rows<'_> {
    pub(super) fn header(&self) -> &Header {
        self.sheet.header()
    }

    /// The next row that the campaign asks for, `None` after the last.
    pub(super) fn next_row(&mut self) -> Result<Option<Row>, Misplaced> {
        let source = self.source;
        while let Some(row) = self
            .sheet
            .next_row()
            .map_err(|message| source.fault("file", message))?
        {
            if self.wants(&row) {
                return Ok(Some(row));
            }
        }
        Ok(None)
    }

    fn wants(&self, row: &Row) -> bool {
        let header = self.sheet.header();
        self.conditions.iter().all(|(column, _, wanted)| {
            let cell = header.text(row, *column);
            match wanted {
                Given::Text(text) => cell == *text,
                Given::Number(number) => cell.parse() == Ok(*number),
                Given::Column(_) => false,
            }
        })
    }

    /// The fault that no row was asked for.
    pub(super) fn nothing(&self) -> Misplaced {
        let file = self.header().file();
        let [first, ..] = &self.conditions[..] else {
            let message = format!("{file} has a header but no rows");
            return self.source.fault("file", message);
        };
        let wanted = self
            .conditions
            .iter()
            .map(|(_, name, wanted)| match wanted {
                Given::Number(number) => format!("{name} = {number}"),
                Given::Text(text) => format!("{name} = {text:?}"),
                Given::Column(column) => format!("{name} = {:?}", column.column),
            });
        let wanted: Vec<String> = wanted.collect();
        let message = format!("no row of {file} has {}", wanted.join(" and "));
        self.source.fault(&format!("rows.{}", first.1), message)
    }
}

impl Measure {
    /// The value in a row, in the measure's unit; NaN where nothing was measured.
    pub(super) fn value(&self, header: &Header, row: &Row) -> Result<f64, String> {
        let cell = header.number(row, self.column)?;
        Ok((cell - self.subtract) * self.factor)
    }

    /// Size of a spread `sd` in the column's unit, in the measure's.
    pub(super) fn spread(&self, sd: f64) -> f64 {
        sd * self.factor.abs()
    }

    /// What an attribute's column measures; `target` is the attribute's unit.
    pub(super) fn attribute(
        name: &str,
        target: &'static str,
        column: &ColumnTable,
        header: &Header,
    ) -> Result<Self, String> {
        only_for_means(column)?;
        Ok(Self {
            name: name.to_owned(),
            unit: target.to_owned(),
            factor: factor(column, name, Some(target))?,
            subtract: finite("subtract", column.subtract.unwrap_or(0.0))?,
            column: header.column(&column.column)?,
        })
    }
}

/// Refuses the spread of a quantity that has none.
pub(super) fn only_for_means(column: &ColumnTable) -> Result<(), String> {
    match (&column.sd, &column.n) {
        (None, None) => Ok(()),
        _ => Err("sd and n belong to the means of a [table]; leave them out".to_owned()),
    }
}

/// What a number in a column, less its offset, is multiplied by.
fn factor(column: &ColumnTable, name: &str, target: Option<&'static str>) -> Result<f64, String> {
    let scale = finite("scale", column.scale.unwrap_or(1.0))?;
    if scale == 0.0 {
        return Err("scale must not be 0".to_owned());
    }
    let Some(target) = target else {
        return Ok(scale);
    };
    let Some(unit) = &column.unit else {
        return match unit::stated_otherwise(&column.column, target) {
            Some(stated) if column.scale.is_none() => Err(format!(
                "the header {0:?} states {stated}, {name} is in {target}: write {{ column = {0:?}, \
                 unit = {stated:?} }}, or unit = {target:?} if it is",
                column.column
            )),
            _ => Ok(scale),
        };
    };
    let size = unit::factor(unit, target)
        .map_err(|known| format!("unit {unit:?} does not measure {name}; use one of {known}"))?;
    Ok(scale * size)
}

fn finite(what: &str, value: f64) -> Result<f64, String> {
    match value.is_finite() {
        true => Ok(value),
        false => Err(format!("{what} must be finite, got {value}")),
    }
}

fn unknown_channel(name: &str, column: &str) -> String {
    let known = CHANNELS.map(|(name, _)| name);
    let likeness = |known: &str| strsim::jaro_winkler(known, name);
    let best = known
        .into_iter()
        .max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    let meant = match best {
        Some(best) if likeness(best) >= 0.8 => format!("did you mean {best}?"),
        _ => format!("known are {}.", known.join(", ")),
    };
    format!(
        "{name} is no known channel; {meant} To carry it along, give its unit: \
         {{ column = {column:?}, unit = \"...\" }}"
    )
}
