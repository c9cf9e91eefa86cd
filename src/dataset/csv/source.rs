//! A table as a campaign describes it: which columns, which rows, in which units.

use super::Misplaced;
use super::description::{ColumnTable, Given, SourceTable};
use super::gap::Gaps;
use super::notes::Notes;
use super::selection::Picked;
use super::sheet::{Header, Row, Sheet};
use super::unit;
use crate::trace::{CHANNELS, unit_of};
use std::path::Path;
use std::rc::Rc;

/// Supported delimiters.
const DELIMITERS: [char; 5] = [',', ';', '\t', '|', ' '];

/// A part of a campaign, and its dotted key: `run.3` or `table`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) table: &'a SourceTable,
    pub(super) key: &'a str,
    pub(super) gaps: &'a Gaps,
    pub(super) notes: &'a Notes,
    /// Radius of the wheel [m], where the campaign states one.
    pub(super) radius: Option<f64>,
}

/// The selected rows of a file.
pub(super) struct Rows<'a> {
    source: Source<'a>,
    sheet: Sheet,
    /// Columns with their conditions.
    conditions: Vec<(usize, &'a str, &'a Picked)>,
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
        let layout = self.table.layout();
        if let Some(delimiter) = layout.delimiter.filter(|c| !DELIMITERS.contains(c)) {
            let message = format!("delimiter must be one of {DELIMITERS:?}, got {delimiter:?}");
            return Err(self.fault("delimiter", message));
        }
        if self.table.file.as_os_str().is_empty() {
            return Err(self.fault("columns", "missing `file`; name the table of text"));
        }
        let path = folder.join(&self.table.file);
        let sheet = Sheet::open(&path, &layout, self.gaps, self.notes)
            .map_err(|message| self.fault("file", message))?;
        let condition = |(name, wanted): (&'a String, &'a Picked)| {
            let at = |message| self.fault(&format!("rows.{name}"), message);
            wanted.check().map_err(at)?;
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
        only_for_time(&column).map_err(at)?;
        let target = unit_of(name);
        let place = header.column(&column.column).map_err(at)?;
        let unit = match (target, &column.unit) {
            (Some(target), _) => target.to_owned(),
            (None, Some(unit)) => unit.clone(),
            (None, None) => {
                let stated = header.stated(place).next();
                return Err(at(unknown_channel(name, &column.column, stated)));
            }
        };
        let factor = match self.per_radius(name, &column).map_err(at)? {
            Some(factor) => factor,
            None => factor(&column, name, target, header).map_err(at)?,
        };
        Ok(Measure {
            name: name.to_owned(),
            factor,
            subtract: finite("subtract", column.subtract.unwrap_or(0.0)).map_err(at)?,
            unit,
            column: place,
        })
    }

    /// What a wheel speed in the unit of a speed, the rim's, is multiplied by; `None` in its own.
    fn per_radius(&self, name: &str, column: &ColumnTable) -> Result<Option<f64>, String> {
        let Some(unit) = column.unit.as_deref().filter(|_| name == "wheel_speed") else {
            return Ok(None);
        };
        let Ok(size) = unit::factor(unit, "m/s") else {
            return Ok(None);
        };
        match self.radius {
            Some(radius) if radius > 0.0 => {
                let note = format!("wheel_speed is the rim's speed over the radius of {radius} m");
                self.notes.of_run(note);
                Ok(Some(scale(column)? * size / radius))
            }
            _ => Err(format!(
                "a wheel speed in {unit} is that of the rim: give wheel = {{ radius_m = ... }}, \
                 by which it is divided"
            )),
        }
    }

    /// The column given under `columns.name`, as a table.
    pub(super) fn column(&self, name: &str) -> Result<ColumnTable, String> {
        column_of(&self.table.columns[name])
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
    pub(super) fn header(&self) -> &Rc<Header> {
        self.sheet.header()
    }

    /// The next selected row, `None` after the last.
    pub(super) fn next_row(&mut self) -> Result<Option<&Row>, Misplaced> {
        while self.advance()? {
            if self.wants(self.sheet.row())? {
                return Ok(Some(self.sheet.row()));
            }
        }
        Ok(None)
    }

    fn advance(&mut self) -> Result<bool, Misplaced> {
        let more = self.sheet.advance();
        more.map_err(|message| self.source.fault("file", message))
    }

    fn wants(&self, row: &Row) -> Result<bool, Misplaced> {
        let header = self.sheet.header();
        for (column, name, wanted) in &self.conditions {
            let holds = wanted.holds(header, row, *column);
            let at = |message| self.source.fault(&format!("rows.{name}"), message);
            if !holds.map_err(at)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The fault that no row was selected.
    pub(super) fn nothing(&self) -> Misplaced {
        let file = self.header().file();
        let [first, ..] = &self.conditions[..] else {
            let message = format!("{file} has a header but no rows");
            return self.source.fault("file", message);
        };
        let wanted = self.conditions.iter();
        let wanted = wanted.map(|(_, name, wanted)| format!("{name} {wanted}"));
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
        only_for_time(column)?;
        Ok(Self {
            name: name.to_owned(),
            unit: target.to_owned(),
            factor: factor(column, name, Some(target), header)?,
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

/// Refuses what belongs to times where something else is measured.
fn only_for_time(column: &ColumnTable) -> Result<(), String> {
    match (&column.add, &column.format, &column.wraps_at) {
        (None, None, None) => Ok(()),
        _ => Err("add, format and wraps_at belong to time_s; leave them out".to_owned()),
    }
}

/// A column by its name, or by a table.
pub(super) fn column_of(given: &Given) -> Result<ColumnTable, String> {
    match given {
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

/// What a number in a column, less its offset, is multiplied by.
pub(super) fn factor(
    column: &ColumnTable,
    name: &str,
    target: Option<&'static str>,
    header: &Header,
) -> Result<f64, String> {
    let scale = scale(column)?;
    let Some(target) = target else {
        return Ok(scale);
    };
    let Some(unit) = &column.unit else {
        return match stated(column, target, header) {
            Some((place, stated)) if column.scale.is_none() => Err(format!(
                "{place} states {stated}, {name} is in {target}: write {{ column = {0:?}, \
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

/// The unit of another size than `target` that the header or a row below it states, and where.
fn stated(column: &ColumnTable, target: &str, header: &Header) -> Option<(String, &'static str)> {
    let name = &column.column;
    if let Some(unit) = unit::stated_otherwise(name, target) {
        return Some((format!("the header {name:?}"), unit));
    }
    let place = header.column(name).ok()?;
    let below = header
        .stated(place)
        .find_map(|cell| unit::stated_below(cell, target));
    below.map(|unit| (format!("the row of units below {name:?}"), unit))
}

fn scale(column: &ColumnTable) -> Result<f64, String> {
    match finite("scale", column.scale.unwrap_or(1.0))? {
        0.0 => Err("scale must not be 0".to_owned()),
        scale => Ok(scale),
    }
}

pub(super) fn finite(what: &str, value: f64) -> Result<f64, String> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{what} must be finite, got {value}"))
    }
}

fn unknown_channel(name: &str, column: &str, stated: Option<&str>) -> String {
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
         {{ column = {column:?}, unit = {:?} }}",
        stated.filter(|unit| !unit.is_empty()).unwrap_or("...")
    )
}
