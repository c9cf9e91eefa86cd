//! Answers counted against truth, with intervals.

use crate::statistics::Share;
use crate::terrain::class::Wtic;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// The classes, in the order of rows and columns.
pub const CLASSES: [Wtic; 4] = [Wtic::Alct, Wtic::Slct, Wtic::Leis, Wtic::Uwtic];

/// How often each true class (row) was answered by each class (column).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Confusion {
    /// Counts, rows and columns in the order of [`CLASSES`].
    pub counts: [[u64; 4]; 4],
}

impl Serialize for Confusion {
    /// `{ALCT: {ALCT: 1, ...}, ...}`, rows first.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let named = CLASSES.iter().zip(&self.counts);
        serializer.collect_map(named.map(|(truth, row)| {
            let row: BTreeMap<Wtic, u64> = CLASSES.into_iter().zip(*row).collect();
            (truth, row)
        }))
    }
}

impl Confusion {
    /// Counts one window.
    pub fn add(&mut self, truth: Wtic, answer: Wtic) {
        self.counts[place(truth)][place(answer)] += 1;
    }

    /// Windows counted.
    pub fn total(&self) -> u64 {
        self.counts.iter().flatten().sum()
    }

    /// Windows whose class was answered.
    pub fn correct(&self) -> u64 {
        (0..4).map(|i| self.counts[i][i]).sum()
    }

    /// Windows answered by another class than theirs, UWTIC aside.
    pub fn confused(&self) -> u64 {
        let pairs = (0..3).flat_map(|row| (0..3).map(move |column| (row, column)));
        pairs
            .filter(|(row, column)| row != column)
            .map(|(row, column)| self.counts[row][column])
            .sum()
    }

    /// Share of windows whose class was answered; none where none were counted.
    pub fn accuracy(&self) -> Option<Share> {
        Share::of(self.correct(), self.total())
    }

    /// Share of a true class that was answered; none where it did not occur.
    pub fn recall(&self, class: Wtic) -> Option<Share> {
        let row = self.counts[place(class)];
        Share::of(row[place(class)], row.iter().sum())
    }
}

fn place(class: Wtic) -> usize {
    CLASSES
        .iter()
        .position(|c| *c == class)
        .expect("CLASSES holds every class")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_is_wrong_but_confuses_no_two_classes() {
        let mut confusion = Confusion::default();
        confusion.add(Wtic::Alct, Wtic::Alct);
        confusion.add(Wtic::Alct, Wtic::Uwtic);
        confusion.add(Wtic::Slct, Wtic::Leis);
        assert_eq!(
            (confusion.total(), confusion.correct(), confusion.confused()),
            (3, 1, 1)
        );
        assert_eq!(confusion.recall(Wtic::Alct).unwrap().value, 0.5);
        assert_eq!(confusion.recall(Wtic::Leis), None);
    }
}
