//! The gap map: every cell of every condition, measured against simulated.
//!
//! ```text
//! z = (mean of measured − mean of replicates) / √( s̃² (1/k + 1/n) + e²/k + u² )
//! ```
//!
//! `s̃²` is the [moderated](super::moderation) variance of `n` replicates, `u` the spread that
//! uncertain parameters add, and `e²` what the variance of `k` repeated measurements exceeds the
//! replicates' by, 0 where there is one: a single measured run is taken to scatter as a replicate
//! does. The p-value is Student's with Welch and Satterthwaite's degrees of freedom, `q` that of
//! the [tree](super::tree).

use super::cell::{Cell, Domain, Measure};
use super::comparison::{Caveat, Comparison, Table};
use super::condition::Condition;
use super::global::{self, Global};
use super::moderation::{MANY, Priors};
use super::tree;
use crate::quantity::Seed;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

/// False discovery rate, and level of the tests of equivalence [-].
pub const LEVEL: f64 = 0.05;
/// Spread over size [-] below which replicates are equal up to rounding.
pub(super) const LEAST_SPREAD: f64 = 1.0e-6;

/// Differences up to which two sides count as equivalent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Of values in the channel's unit, as a share of their size [-].
    pub relative: f64,
    /// Of levels [dB].
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

/// Standard deviations of cells, in their units, that uncertain parameters add to the replicates'
/// own; what is not there has none.
pub type ParameterSpread = BTreeMap<Condition, BTreeMap<Cell, f64>>;

/// What is said of a cell.
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
    /// What the statistic looks at.
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
    /// The same corrected for all cells asked [-].
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
    /// What to keep in mind.
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
        let priors = self.priors();
        let mut entries: Vec<Entry> = self
            .tables
            .iter()
            .flat_map(|table| {
                let priors = &priors;
                (0..table.cells.len()).map(move |place| {
                    let cell = &table.cells[place];
                    let added = spread.get(&table.condition).and_then(|of| of.get(cell));
                    let added = added.copied().unwrap_or(0.0);
                    table.entry(place, margins, priors, added)
                })
            })
            .collect();
        colour(&mut entries);
        GapMap {
            global: global::test(&self.tables, seed),
            entries,
            caveats: self.caveats.clone(),
        }
    }

    /// What variances of cells of a kind have in common, over all conditions.
    fn priors(&self) -> Priors {
        let cells = self.tables.iter().flat_map(|table| {
            let places = table.cells.iter().enumerate();
            places.map(|(place, cell)| {
                let [_, variance] = moments(&column(&table.simulated, place));
                let scale = table.scale(place);
                let freedom = (table.simulated.len() - 1) as f64;
                (cell, variance / (scale * scale), freedom)
            })
        });
        Priors::of(cells)
    }
}

/// The values of a cell, run by run.
fn column(runs: &[Vec<f64>], place: usize) -> Vec<f64> {
    runs.iter().map(|run| run[place]).collect()
}

/// Mean and variance; the variance of one value is 0.
pub(super) fn moments(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    [mean, square / (count - 1.0).max(1.0)]
}

impl Table {
    /// What a cell's spread is compared with, in its unit; above 0.
    pub(super) fn scale(&self, place: usize) -> f64 {
        let runs = self.simulated.iter().chain(&self.measured);
        let largest = runs.map(|run| run[place].abs()).fold(0.0, f64::max);
        [self.sizes[place], largest, 1.0]
            .into_iter()
            .find(|scale| *scale > 0.0)
            .unwrap_or(1.0)
    }

    fn entry(&self, place: usize, margins: &Margins, priors: &Priors, added: f64) -> Entry {
        let cell = &self.cells[place];
        let [measured, of_measured] = moments(&column(&self.measured, place));
        let [simulated, of_simulated] = moments(&column(&self.simulated, place));
        let [k, n] = [self.measured.len() as f64, self.simulated.len() as f64];
        let square = self.scale(place) * self.scale(place);
        let (moderated, freedom) = priors.moderate(cell, of_simulated / square, n - 1.0);
        let replicates = square * moderated.max(LEAST_SPREAD * LEAST_SPREAD);
        let beyond = (of_measured - replicates).max(0.0) / k;
        let parts = [
            (replicates * (1.0 / k + 1.0 / n), freedom),
            (beyond, (k - 1.0).max(1.0)),
            (added * added, MANY),
        ];
        let variance: f64 = parts.iter().map(|(part, _)| part).sum();
        let welch = parts
            .iter()
            .map(|(part, d)| (part / variance) * (part / variance) / d);
        let freedom = 1.0 / welch.sum::<f64>();
        let error = libm::sqrt(variance);
        let difference = measured - simulated;
        let z = difference / error;
        let margin = match cell.statistic.measure() {
            Measure::Own => margins.relative * self.sizes[place],
            Measure::Level => margins.level,
            Measure::Number => margins.number,
        };
        let within = tail((margin - difference.abs()) / error, freedom) < LEVEL;
        Entry {
            channel: cell.channel.to_string(),
            domain: cell.domain(),
            cell: cell.clone(),
            condition: self.condition.clone(),
            unit: cell.unit(),
            measured,
            simulated,
            difference,
            error,
            z,
            freedom,
            p: (2.0 * tail(z.abs(), freedom)).min(1.0),
            q: 1.0,
            margin,
            colour: if within {
                Colour::Equivalent
            } else {
                Colour::Undecided
            },
        }
    }
}

/// Probability that Student's t exceeds `t`.
fn tail(t: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |student| student.sf(t))
}

fn colour(entries: &mut [Entry]) {
    let leaves: Vec<(String, Domain, f64)> = entries
        .iter()
        .map(|entry| (entry.channel.clone(), entry.domain, entry.p))
        .collect();
    let q = tree::q_values(&leaves, LEVEL);
    for (entry, q) in entries.iter_mut().zip(q) {
        entry.q = q;
        if q < LEVEL && entry.colour != Colour::Equivalent {
            entry.colour = Colour::Gap;
        }
    }
}
