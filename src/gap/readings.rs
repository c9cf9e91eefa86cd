//! What was read from one run.

use super::cell::{Cell, Statistic};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A value and the size by which it is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The value, in the cell's unit.
    pub value: f64,
    /// What a change of the value is compared with, in the same unit: 1 dB, 1, or how large the
    /// channel is in this run.
    pub size: f64,
}

/// Readings of one run, cell by cell; all are finite.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Readings {
    cells: BTreeMap<Cell, Reading>,
}

impl Readings {
    /// The reading of a cell.
    pub fn get(&self, cell: &Cell) -> Option<Reading> {
        self.cells.get(cell).copied()
    }

    /// Cells in their order.
    pub fn iter(&self) -> impl Iterator<Item = (&Cell, Reading)> {
        self.cells.iter().map(|(cell, reading)| (cell, *reading))
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether nothing could be read.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Copies readings of some cells from others.
    pub(super) fn copy(&mut self, others: &Self, which: impl Fn(&Cell) -> bool) {
        let copied = others.iter().filter(|(cell, _)| which(cell));
        self.cells
            .extend(copied.map(|(cell, reading)| (cell.clone(), reading)));
    }

    /// Records a level or a number; a value that is not finite leaves its cell empty.
    pub(super) fn note(&mut self, channel: &Arc<str>, statistic: Statistic, value: f64) {
        self.note_of_size(channel, statistic, value, 1.0);
    }

    /// Notes a value that is judged by `size`, in the same unit.
    pub(super) fn note_of_size(
        &mut self,
        channel: &Arc<str>,
        statistic: Statistic,
        value: f64,
        size: f64,
    ) {
        if value.is_finite() && size.is_finite() && size >= 0.0 {
            let cell = Cell::new(Arc::clone(channel), statistic);
            self.cells.insert(cell, Reading { value, size });
        }
    }
}

impl FromIterator<(Cell, Reading)> for Readings {
    /// Gathers readings, those that are not finite left out.
    fn from_iter<I: IntoIterator<Item = (Cell, Reading)>>(readings: I) -> Self {
        let finite = |(_, reading): &(Cell, Reading)| {
            reading.value.is_finite() && reading.size.is_finite() && reading.size >= 0.0
        };
        Self {
            cells: readings.into_iter().filter(finite).collect(),
        }
    }
}
