//! Statistics of rigs as rows of numbers.

use super::design::Part;
use crate::gap::Cell;
use serde::{Deserialize, Serialize};

/// A statistic in a condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Place of the condition among the cases.
    pub condition: usize,
    /// Which statistic.
    pub cell: Cell,
    /// What a change of it is compared with, in its unit, in the scenario as it is.
    pub size: f64,
}

/// One measurement of a rig in all conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The rig's number; rows of one rig share its motions.
    pub rig: u64,
    /// Its parameters [prior standard deviations].
    pub parameters: Vec<f64>,
    /// Its effects.
    pub effects: Vec<Part>,
    /// Whether they follow a randomised law.
    pub randomised: bool,
    /// Column by column, in the columns' units; not a number where a statistic could not be taken.
    #[serde(skip)]
    pub values: Vec<f32>,
}

/// Rows of many rigs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// What the values are.
    pub columns: Vec<Column>,
    /// By rig.
    pub rows: Vec<Row>,
}

impl Table {
    /// The rows whose effects are among the kept ones, numbered by their places there.
    pub fn restricted(self, kept: &[usize]) -> Self {
        let renumbered = |part: &Part| {
            let candidate = kept.iter().position(|kept| *kept == part.candidate)?;
            Some(Part { candidate, ..*part })
        };
        let rows = self.rows.into_iter().filter_map(|row| {
            let effects = row.effects.iter().map(renumbered);
            let effects = effects.collect::<Option<Vec<Part>>>()?;
            Some(Row { effects, ..row })
        });
        Self {
            rows: rows.collect(),
            columns: self.columns,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_with_other_effects_are_left_out_and_numbers_are_those_of_the_kept() {
        let row = |effects: &[usize]| Row {
            rig: 0,
            parameters: Vec::new(),
            effects: effects
                .iter()
                .map(|candidate| Part {
                    candidate: *candidate,
                    size: 0.5,
                })
                .collect(),
            randomised: false,
            values: Vec::new(),
        };
        let table = Table {
            columns: Vec::new(),
            rows: vec![row(&[]), row(&[4]), row(&[2, 4]), row(&[2]), row(&[3, 4])],
        };
        let restricted = table.restricted(&[2, 4]);
        assert_eq!(
            restricted.rows,
            vec![row(&[]), row(&[1]), row(&[0, 1]), row(&[0])]
        );
    }
}
