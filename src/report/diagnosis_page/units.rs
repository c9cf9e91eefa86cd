//! The gap in plain units.

use super::words;
use crate::diagnosis::{Diagnosis, InUnits};
use crate::gap::{self, Entry, Measure};
use crate::report::page::{Cell, Column, Section, Table};
use crate::statistics::student_quantile;

/// Rows shown; a page is no place for more.
const SHOWN: usize = 300;

/// Degrees of freedom from which on Student's distribution is the normal one to four digits; its
/// quantile is not found at infinity.
const MOST_FREEDOM: f64 = 1.0e5;

/// Steady means and standard deviations, measured and by each arm; none where there are none.
pub fn section(diagnosis: &Diagnosis) -> Option<Section> {
    if diagnosis.in_units.is_empty() {
        return None;
    }
    let has_effect = diagnosis
        .in_units
        .iter()
        .any(|row| row.with_effect.is_some());
    let mut columns = Column::named([
        "condition",
        "channel",
        "what",
        "unit",
        "measured",
        "nominal",
        "recalibrated",
    ]);
    if has_effect {
        columns.push(Column::new("with effect", ""));
    }
    columns.push(Column::new("measured minus nominal", ""));
    let rows = diagnosis.in_units.iter().take(SHOWN).map(|row| {
        let shown = Shown::of(row);
        let mut cells = vec![
            Cell::text(row.condition.to_string()),
            Cell::text(words::channel(&row.cell.channel)),
            Cell::text(words::statistic(row.cell.statistic)),
            Cell::text(&shown.unit),
            Cell::Number(shown.of_value(row.measured)),
            Cell::Number(shown.of_value(row.as_shipped)),
            shown.cell(row.recalibrated),
        ];
        if has_effect {
            cells.push(shown.cell(row.with_effect));
        }
        cells.push(difference(diagnosis, row, &shown));
        cells
    });
    let section = Section::new("Gap in physical units")
        .prose(
            "Means over the runs of a condition; parameters and magnitudes are fitted to all conditions. The 95 % \
             interval of the difference is computed from the scatter of replicates and repeats; for standard \
             deviations the difference is the ratio. A click on a header sorts.",
        )
        .table(Table {
            caption: "Steady means and standard deviations of every channel".to_owned(),
            columns,
            rows: rows.collect(),
        });
    let all = diagnosis.in_units.len();
    Some(if all > SHOWN {
        section.prose(format!(
            "These are the first {SHOWN} of {all} rows; diagnosis.json has all."
        ))
    } else {
        section
    })
}

/// The unit in which a number of that unit is shown, and the factor to it.
pub fn shown(unit: &str) -> (&str, f64) {
    match unit {
        "m" => ("mm", 1.0e3),
        "m/s" => ("mm/s", 1.0e3),
        unit => (words::unit(unit), 1.0),
    }
}

/// The amplitude of a level [dB].
pub fn of_level(level: f64) -> f64 {
    libm::pow(10.0, level / 20.0)
}

/// How a number of a cell is shown.
struct Shown {
    unit: String,
    factor: f64,
    /// Whether it is shown in decibels of the unit.
    is_level: bool,
}

impl Shown {
    fn of(row: &InUnits) -> Self {
        let measure = row.cell.statistic.measure();
        let is_level = matches!(measure, Measure::Level | Measure::Share);
        let own = if is_level {
            crate::trace::unit_of(&row.cell.channel).unwrap_or("")
        } else {
            &row.unit
        };
        let (unit, factor) = shown(own);
        Self {
            unit: unit.to_owned(),
            factor,
            is_level,
        }
    }

    /// A value in the unit shown.
    fn of_value(&self, value: f64) -> f64 {
        if self.is_level {
            self.factor * of_level(value)
        } else {
            self.factor * value
        }
    }

    fn cell(&self, value: Option<f64>) -> Cell {
        value.map_or(Cell::Missing, |value| Cell::Number(self.of_value(value)))
    }
}

/// Difference with its interval: a ratio of standard deviations.
fn difference(diagnosis: &Diagnosis, row: &InUnits, shown: &Shown) -> Cell {
    let mut entries = diagnosis.map.iter();
    let own = entries.find(|entry| entry.cell == row.cell && entry.condition == row.condition);
    let Some(entry) = own else {
        return Cell::Missing;
    };
    let half = half_width(entry);
    let values = [
        entry.difference,
        entry.difference - half,
        entry.difference + half,
    ];
    if shown.is_level {
        let [value, low, high] = values.map(of_level);
        Cell::Written(format!("×{value:.3} [{low:.3}, {high:.3}]"), value)
    } else {
        let [value, low, high] = values.map(|x| shown.factor * x);
        Cell::Estimate(value, [low, high])
    }
}

/// Half of the 95 % interval of a difference, in its unit; infinite where its error is not known.
pub fn half_width(entry: &Entry) -> f64 {
    let freedom = entry.freedom.min(MOST_FREEDOM);
    let half = student_quantile(1.0 - 0.5 * gap::LEVEL, freedom) * entry.error;
    if half.is_finite() {
        half
    } else {
        f64::INFINITY
    }
}
