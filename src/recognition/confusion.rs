//! Answers counted against truth, with intervals.

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

/// A share of a count and its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Share {
    /// The share [-].
    pub value: f64,
    /// Wilson's 95 % interval [-].
    pub ci95: [f64; 2],
    /// Trials.
    pub n: u64,
}

/// Two-sided 95 % quantile of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

impl Share {
    /// `hits` of `n`; no share of nothing.
    ///
    /// # Reference
    /// Wilson (1927), J. Am. Stat. Assoc. 22:209-212.
    pub fn of(hits: u64, n: u64) -> Option<Self> {
        if n == 0 {
            return None;
        }
        let (trials, value) = (n as f64, hits as f64 / n as f64);
        let scale = 1.0 / (1.0 + Z * Z / trials);
        let centre = scale * (value + Z * Z / (2.0 * trials));
        let half = scale
            * Z
            * libm::sqrt(value * (1.0 - value) / trials + Z * Z / (4.0 * trials * trials));
        Some(Self {
            value,
            ci95: [(centre - half).max(0.0), (centre + half).min(1.0)],
            n,
        })
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
    fn wilson_s_interval_of_292_of_300_is_the_textbook_s() {
        let share = Share::of(292, 300).unwrap();
        assert!((share.ci95[0] - 0.948_2).abs() < 2e-4, "{share:?}");
        assert!((share.ci95[1] - 0.986_4).abs() < 2e-4, "{share:?}");
        assert_eq!(Share::of(0, 5).unwrap().ci95[0], 0.0);
        assert_eq!(Share::of(0, 0), None);
    }

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
