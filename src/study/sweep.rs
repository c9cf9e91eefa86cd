//! Keys of a scenario and the values they take in turn.

mod distribution;
mod drawn;

use super::Wrong;
use crate::quantity::{RangeError, Seed};
use drawn::{Draws, Sampling};
use serde::Deserialize;

/// A `[[sweep]]` before its checks: one `key` with `values` or a `grid`, `keys` with `rows`, or
/// `count` draws from `distributions`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SweepTable {
    key: Option<String>,
    values: Option<Vec<toml::Value>>,
    grid: Option<Grid>,
    keys: Option<Vec<String>>,
    rows: Option<Vec<Vec<toml::Value>>>,
    count: Option<u32>,
    sampling: Option<Sampling>,
    distributions: Option<toml::Table>,
}

/// Values row by row, as TOML.
type Rows = Vec<Vec<String>>;

/// Equally spaced numbers, both ends included.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Grid {
    from: f64,
    to: f64,
    count: u32,
    spacing: Spacing,
}

/// What is equal between neighbours of a grid.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Spacing {
    /// Their difference.
    Linear,
    /// Their ratio.
    Logarithmic,
}

/// Keys that change together, and their values row by row, as TOML.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    pub(super) keys: Vec<String>,
    pub(super) rows: Rows,
    form: Form,
}

/// A sweep in the reports: an axis of the conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Its keys.
    pub name: String,
    /// Its entries.
    pub values: Vec<String>,
}

impl From<&Sweep> for Axis {
    fn from(sweep: &Sweep) -> Self {
        let rows = sweep.rows.iter();
        Self {
            name: sweep.keys.join(", "),
            values: rows.map(|row| row.join(", ")).collect(),
        }
    }
}

/// How a sweep is written in the file, for messages that point at it.
#[derive(Debug, Clone, Copy)]
enum Form {
    Values,
    Grid,
    Rows,
    Drawn,
}

impl Sweep {
    /// Number of entries.
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The `key=value` of an entry.
    pub(super) fn assignments(&self, entry: usize) -> Vec<String> {
        let pairs = self.keys.iter().zip(&self.rows[entry]);
        pairs.map(|(key, value)| format!("{key}={value}")).collect()
    }

    /// Position of an entry below its `[[sweep]]`.
    pub(super) fn place(&self, entry: usize) -> String {
        match self.form {
            Form::Values => format!("values.{entry}"),
            Form::Grid => "grid".to_owned(),
            Form::Rows => format!("rows.{entry}"),
            Form::Drawn => "distributions".to_owned(),
        }
    }

    /// Position of the keys below their `[[sweep]]`.
    pub(super) fn key_place(&self) -> &'static str {
        match self.form {
            Form::Values | Form::Grid => "key",
            Form::Rows => "keys",
            Form::Drawn => "distributions",
        }
    }
}

/// The sweeps of a study; what is drawn comes from its `seed`.
pub(super) fn read_all(tables: Vec<SweepTable>, seed: Seed) -> Result<Vec<Sweep>, Wrong> {
    let numbered = tables.into_iter().enumerate();
    numbered
        .map(|(index, table)| {
            table
                .into_sweep(seed)
                .map_err(|(key, message)| (format!("sweep.{index}.{key}"), message))
        })
        .collect()
}

impl SweepTable {
    fn into_sweep(self, seed: Seed) -> Result<Sweep, Wrong> {
        let one = |value: toml::Value| vec![value.to_string()];
        let Self {
            key,
            values,
            grid,
            keys,
            rows,
            count,
            sampling,
            distributions,
        } = self;
        let listed = (key, values, grid, keys, rows);
        let drawn = (count, sampling, distributions);
        let (keys, rows, form) = match (listed, drawn) {
            ((Some(key), Some(values), None, None, None), (None, None, None)) => (
                vec![key],
                values.into_iter().map(one).collect(),
                Form::Values,
            ),
            ((Some(key), None, Some(grid), None, None), (None, None, None)) => {
                (vec![key], grid.rows()?, Form::Grid)
            }
            ((None, None, None, Some(keys), Some(rows)), (None, None, None)) => {
                check_rows(&keys, &rows)?;
                let text = |row: Vec<toml::Value>| row.iter().map(toml::Value::to_string).collect();
                (keys, rows.into_iter().map(text).collect(), Form::Rows)
            }
            ((None, None, None, None, None), (Some(count), Some(sampling), Some(of))) => {
                let draws = Draws {
                    count,
                    sampling,
                    distributions: of,
                };
                let (keys, rows) = draws.rows(seed)?;
                (keys, rows, Form::Drawn)
            }
            _ => {
                let message = "a sweep has `key` and `values`, `key` and `grid`, `keys` and `rows`, \
                               or `count`, `sampling` and `distributions`";
                return Err((String::new(), message.to_owned()));
            }
        };
        let sweep = Sweep { keys, rows, form };
        if sweep.len() == 0 {
            let message = "a sweep needs a value; omit it where nothing is swept";
            let key = match sweep.form {
                Form::Rows => "rows",
                Form::Values | Form::Grid | Form::Drawn => "values",
            };
            return Err((key.to_owned(), message.to_owned()));
        }
        Ok(sweep)
    }
}

fn check_rows(keys: &[String], rows: &[Vec<toml::Value>]) -> Result<(), Wrong> {
    if keys.is_empty() {
        return Err(("keys".to_owned(), "a sweep needs a key".to_owned()));
    }
    let ragged = rows.iter().position(|row| row.len() != keys.len());
    ragged.map_or(Ok(()), |index| {
        let message = format!(
            "a row needs one value for each of the {} keys, and this one has {}",
            keys.len(),
            rows[index].len()
        );
        Err((format!("rows.{index}"), message))
    })
}

impl Grid {
    fn rows(&self) -> Result<Rows, Wrong> {
        self.check()
            .map_err(|(key, error)| (format!("grid.{key}"), error.to_string()))?;
        let row = |index| vec![toml::Value::Float(self.number(index)).to_string()];
        Ok((0..self.count).map(row).collect())
    }

    fn check(&self) -> Result<(), (&'static str, RangeError)> {
        let at = |key| move |error| (key, error);
        let count = f64::from(self.count);
        RangeError::check("grid count", "-", count, [2.0, 1.0e5]).map_err(at("count"))?;
        for (key, end) in [("from", self.from), ("to", self.to)] {
            RangeError::check("end of a grid", "key's", end, [-1.0e300, 1.0e300])
                .map_err(at(key))?;
            if matches!(self.spacing, Spacing::Logarithmic) {
                RangeError::positive("end of a logarithmic grid", "key's", end).map_err(at(key))?;
            }
        }
        Ok(())
    }

    /// Number `index` of the grid.
    fn number(&self, index: u32) -> f64 {
        let share = f64::from(index) / f64::from(self.count - 1);
        let number = match self.spacing {
            Spacing::Linear => self.from * (1.0 - share) + self.to * share,
            Spacing::Logarithmic => self.from * libm::pow(self.to / self.from, share),
        };
        in_twelve_digits(number)
    }
}

/// A number in 12 digits: more would only show how it was computed.
fn in_twelve_digits(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(text: &str) -> Sweep {
        let table: SweepTable = toml::from_str(text).unwrap();
        table.into_sweep(Seed(1)).unwrap()
    }

    #[test]
    fn a_linear_grid_has_round_values_and_ends_at_its_end() {
        let grid = "grid = { from = 0.0, to = 0.6, count = 7, spacing = \"linear\" }";
        let values = sweep(&format!("key = \"slip\"\n{grid}")).rows.concat();
        assert_eq!(values, ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6"]);
    }

    #[test]
    fn neighbours_of_a_logarithmic_grid_have_one_ratio() {
        let grid = "grid = { from = 30.0, to = 300.0, count = 5, spacing = \"logarithmic\" }";
        let rows = sweep(&format!("key = \"load\"\n{grid}")).rows;
        let values: Vec<f64> = rows.concat().iter().map(|v| v.parse().unwrap()).collect();
        assert_eq!((values[0], values[4]), (30.0, 300.0));
        for pair in values.windows(2) {
            // 1e-11: the numbers have 12 digits.
            assert!((pair[1] / pair[0] / 10.0_f64.powf(0.25) - 1.0).abs() < 1e-11);
        }
    }

    #[test]
    fn the_keys_of_a_row_are_set_together() {
        let text = "keys = [\"a.b\", \"c\"]\nrows = [[1, 2.5], [3, \"x\"]]";
        assert_eq!(sweep(text).assignments(1), ["a.b=3", "c=\"x\""]);
    }
}
