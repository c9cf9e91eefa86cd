//! The gap map: every cell of every condition, measured against simulated.
//!
//! ```text
//! z = (mean of measured − mean of replicates) / √( s̃² (1/k + 1/n) + e²/k + u² )
//! ```
//!
//! `s̃²` is the variance of `n` replicates, moderated over cells of a kind; `u` the spread that
//! uncertain parameters add; `e²` what the variance of `k` repeated measurements exceeds the
//! replicates' by, its share moderated too, and 0 where there is one: a single measured run is
//! taken to scatter as a replicate does. The p-value is Student's with Welch and Satterthwaite's
//! degrees of freedom, read in the tail that replicates show among themselves; `q` is that of the
//! tree channel → domain → cell.

use super::cell::{Cell, Domain, Measure};
use super::comparison::{Caveat, Comparison, Table};
use super::condition::Condition;
use super::evidence::Evidence;
use super::global::{self, Global};
use super::tree::{self, Leaf};
use crate::quantity::Seed;
use serde::Serialize;
use std::collections::BTreeMap;

/// False discovery rate, and level of the tests of equivalence [-].
pub const LEVEL: f64 = 0.05;

/// Differences up to which two sides count as equivalent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Of values in the channel's unit, as a share of their size [-].
    pub relative: f64,
    /// Of levels \[dB\].
    pub level: f64,
    /// Of numbers without unit [-].
    pub number: f64,
}

impl Default for Margins {
    /// 5 % of means, 1 dB, and 0.1.
    fn default() -> Self {
        Self {
            relative: 0.05,
            level: 1.0,
            number: 0.1,
        }
    }
}

impl Margins {
    /// That of a cell whose values are of this size, in its unit.
    pub fn of(&self, cell: &Cell, size: f64) -> f64 {
        match cell.statistic.measure() {
            Measure::Own => self.relative * size,
            Measure::Level | Measure::Share => self.level,
            // Two windows that answer the same are equal; no share between is that near.
            Measure::Odds | Measure::Number => self.number,
        }
    }
}

/// Standard deviations of cells, in their units, that uncertain parameters add to the replicates'
/// own; what is not there has none.
pub type ParameterSpread = BTreeMap<Condition, BTreeMap<Cell, f64>>;

/// Classification of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Colour {
    /// The sides differ (q below [`LEVEL`]), and not shown to do so by less than the margin.
    Gap,
    /// The difference is shown to be smaller than the margin, by two one-sided tests (Schuirmann
    /// 1987, J. Pharmacokinet. Biopharm. 15:657-680), whether or not it is nil.
    Equivalent,
    /// Neither.
    Undecided,
}

/// One cell at one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// Channel, or pair of them.
    pub channel: String,
    /// The domain of the statistic.
    pub domain: Domain,
    /// The whole name.
    pub cell: Cell,
    /// At which condition.
    pub condition: Condition,
    /// Unit of the values.
    pub unit: String,
    /// Mean of the measured runs.
    pub measured: f64,
    /// Mean of the replicates.
    pub simulated: f64,
    /// Measured less simulated.
    pub difference: f64,
    /// Standard error of the difference.
    pub error: f64,
    /// Difference over its error [-].
    pub z: f64,
    /// Degrees of freedom of z [-].
    pub freedom: f64,
    /// Probability of a larger |z| where nothing is wrong [-].
    pub p: f64,
    /// The same corrected for all cells tested [-].
    pub q: f64,
    /// Difference up to which the sides count as equivalent.
    pub margin: f64,
    /// What follows.
    pub colour: Colour,
}

/// Where measured runs and replicates differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GapMap {
    /// Whether they differ at all.
    pub global: Global,
    /// Every cell of every condition.
    pub entries: Vec<Entry>,
    /// Caveats on its use.
    pub caveats: Vec<Caveat>,
}

impl GapMap {
    /// Entries by their strength, strongest |z| first.
    pub fn strongest(&self) -> Vec<&Entry> {
        let mut entries: Vec<&Entry> = self.entries.iter().collect();
        entries.sort_by(|a, b| b.z.abs().total_cmp(&a.z.abs()));
        entries
    }

    /// How many entries have this colour.
    pub fn count(&self, colour: Colour) -> usize {
        self.entries
            .iter()
            .filter(|entry| entry.colour == colour)
            .count()
    }
}

impl Comparison {
    /// Tests every cell; `seed` drives the permutations of the global tests.
    pub fn map(&self, margins: &Margins, spread: &ParameterSpread, seed: Seed) -> GapMap {
        let evidence = Evidence::of(&self.tables);
        let mut entries = Vec::new();
        for table in &self.tables {
            let added = spread.get(&table.condition);
            for (place, cell) in table.cells.iter().enumerate() {
                let added = added.and_then(|of| of.get(cell)).copied().unwrap_or(0.0);
                entries.push(entry(
                    &evidence,
                    margins,
                    &Tested {
                        table,
                        place,
                        added,
                    },
                ));
            }
        }
        colour(&mut entries);
        GapMap {
            global: global::test(&self.tables, seed),
            entries,
            caveats: self.caveats.clone(),
        }
    }
}

/// A cell of a condition.
struct Tested<'t> {
    table: &'t Table,
    place: usize,
    /// Standard deviation, in the cell's unit, by the uncertainty of the parameters.
    added: f64,
}

fn entry(evidence: &Evidence, margins: &Margins, tested: &Tested) -> Entry {
    let Tested {
        table,
        place,
        added,
    } = *tested;
    let cell = &table.cells[place];
    let difference = evidence.difference(table, place, added);
    let tail = evidence.tail(cell);
    let (value, error, freedom) = (difference.value(), difference.error, difference.freedom);
    let z = value / error;
    let margin = margins.of(cell, table.sizes[place]);
    let within = tail.beyond((margin - value.abs()) / error, freedom) < LEVEL;
    Entry {
        channel: cell.channel.to_string(),
        domain: cell.domain(),
        cell: cell.clone(),
        condition: table.condition.clone(),
        unit: cell.unit(),
        measured: difference.means[0],
        simulated: difference.means[1],
        difference: value,
        error,
        z,
        freedom,
        p: (2.0 * tail.beyond(z.abs(), freedom)).min(1.0),
        q: 1.0,
        margin,
        colour: if within {
            Colour::Equivalent
        } else {
            Colour::Undecided
        },
    }
}

fn colour(entries: &mut [Entry]) {
    let leaf = |entry: &Entry| Leaf {
        channel: entry.channel.clone(),
        domain: entry.domain,
        p: entry.p,
    };
    let leaves: Vec<_> = entries.iter().map(leaf).collect();
    let q = tree::q_values(&leaves, LEVEL);
    for (entry, q) in entries.iter_mut().zip(q) {
        entry.q = q;
        if q < LEVEL && entry.colour != Colour::Equivalent {
            entry.colour = Colour::Gap;
        }
    }
}
