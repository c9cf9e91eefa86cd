//! Statistics in units of their scatter.
//!
//! ```text
//! z = a asinh((x − m) / (a s))
//! ```
//!
//! with the median `m` and the half width `s` of the central 68 % over rigs without effects, but no less than the
//! statistic's resolution. Within the scatter `z` is linear; a single statistic that an effect moves a thousandfold does
//! not outweigh all others. A statistic that could not be taken is at the median.

use crate::diagnosis::rigs::{Column, Table};
use crate::statistics::{quantile_nearest_place, sorted};
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// `a`: from some such multiples of the scatter on, changes count by their logarithm.
const LINEAR: f64 = 4.0;
/// Share of rigs [-] that must have a statistic for it to be used.
const HAVE: f64 = 0.5;

/// Centre and scatter of every used column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scale {
    /// Places of the used columns in the table.
    pub used: Vec<usize>,
    centres: Vec<f64>,
    scatters: Vec<f64>,
}

impl Scale {
    /// From the rows without effects.
    pub fn of(table: &Table) -> Self {
        let plain = table.rows.iter().filter(|row| row.effects.is_empty());
        let plain: Vec<&[f32]> = plain.map(|row| &row.values[..]).collect();
        let mut scale = Self {
            used: Vec::new(),
            centres: Vec::new(),
            scatters: Vec::new(),
        };
        for (place, column) in table.columns.iter().enumerate() {
            let have = table
                .rows
                .iter()
                .filter(|row| row.values[place].is_finite());
            let values = plain.iter().map(|row| f64::from(row[place]));
            let values = sorted(values.filter(|value| value.is_finite()));
            let at = |share| quantile_nearest_place(&values, share);
            let (Some(low), Some(centre), Some(high)) = (at(0.16), at(0.5), at(0.84)) else {
                continue;
            };
            if (have.count() as f64) < HAVE * table.rows.len() as f64 {
                continue;
            }
            let scatter = 0.5 * (high - low);
            scale.used.push(place);
            scale.centres.push(centre);
            scale.scatters.push(scatter.max(resolution(column)));
        }
        scale
    }

    /// One row.
    pub fn row(&self, values: &[f32]) -> Vec<f64> {
        let used = self.used.iter().enumerate();
        used.map(|(used, column)| self.value(used, f64::from(values[*column])))
            .collect()
    }

    /// A value of a used column.
    pub fn value(&self, used: usize, value: f64) -> f64 {
        let departure = (value - self.centres[used]) / self.scatters[used];
        if departure.is_finite() {
            LINEAR * libm::asinh(departure / LINEAR)
        } else {
            0.0
        }
    }

    /// All rows, one a row.
    pub fn rows(&self, table: &Table) -> DMatrix<f64> {
        let rows = table.rows.iter().flat_map(|row| self.row(&row.values));
        DMatrix::from_row_iterator(table.rows.len(), self.used.len(), rows)
    }

    /// Change of a used column, in its unit, that belongs to a small change of `z` about the centre.
    pub fn in_unit(&self, used: usize, z: f64) -> f64 {
        self.scatters[used] * LINEAR * libm::sinh(z / LINEAR)
    }
}

/// Difference below which nothing is concluded, however little replicates scatter.
fn resolution(column: &Column) -> f64 {
    let measure = column.cell.statistic.measure();
    let resolution = measure.resolution(column.size);
    // A channel that is 0 without any effect resolves nothing.
    resolution.max(f64::MIN_POSITIVE.sqrt())
}
