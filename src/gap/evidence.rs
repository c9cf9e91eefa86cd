//! How sure a difference is: spreads moderated over cells of a kind, tails fitted.

use super::cell::{Cell, Measure};
use super::comparison::Table;
use super::moderation::{Kind, MANY, Priors, kind};
use super::tail::Tail;
use crate::statistics::mean_and_variance;
use std::collections::BTreeMap;

/// Spread over size [-] below which replicates are equal up to rounding.
pub(super) const LEAST_SPREAD: f64 = 1.0e-6;

/// Pooled information of all cells of a comparison on spreads.
pub(super) struct Evidence {
    /// Of replicates' variances over sizes squared.
    replicates: Priors,
    /// Of measured variances over the replicates' moderated ones.
    repeats: Priors,
    tails: BTreeMap<Kind, Tail>,
    /// Of cells whose kind is too small for a tail of its own.
    tail: Tail,
}

/// A difference of one cell and how sure it is.
pub(super) struct Difference {
    /// Means of the measured runs and of the replicates.
    pub means: [f64; 2],
    /// Standard error of their difference.
    pub error: f64,
    /// Welch and Satterthwaite's degrees of freedom.
    pub freedom: f64,
}

impl Difference {
    pub fn value(&self) -> f64 {
        self.means[0] - self.means[1]
    }
}

impl Evidence {
    pub fn of(tables: &[Table]) -> Self {
        let replicates = Priors::of(cells(tables).map(|(table, place)| {
            let variance =
                mean_and_variance(&column(&table.simulated, place))[1] / table.square(place);
            let freedom = (table.simulated.len() - 1) as f64;
            (&table.cells[place], variance, freedom)
        }));
        let repeated = cells(tables).filter(|(table, _)| table.measured.len() > 1);
        let repeats = Priors::of(repeated.map(|(table, place)| {
            let (replicates, _) =
                spread(table, place, &column(&table.simulated, place), &replicates);
            let ratio = mean_and_variance(&column(&table.measured, place))[1] / replicates;
            let freedom = (table.measured.len() - 1) as f64;
            (&table.cells[place], ratio, freedom)
        }));
        let scores = scores(tables, &replicates);
        let all: Vec<f64> = scores.values().flatten().copied().collect();
        let tail = |(kind, scores): (_, Vec<f64>)| Some((kind, Tail::of(&scores)?));
        Self {
            replicates,
            repeats,
            tail: Tail::of(&all).unwrap_or(Tail::NORMAL),
            tails: scores.into_iter().filter_map(tail).collect(),
        }
    }

    /// The tail of cells like this one.
    pub fn tail(&self, cell: &Cell) -> Tail {
        self.tails.get(&kind(cell)).copied().unwrap_or(self.tail)
    }

    /// The difference of a cell; `added` is the deviation that uncertain parameters add.
    pub fn difference(&self, table: &Table, place: usize, added: f64) -> Difference {
        let [measured, of_measured] = mean_and_variance(&column(&table.measured, place));
        let values = column(&table.simulated, place);
        let [simulated, _] = mean_and_variance(&values);
        let [k, n] = [table.measured.len() as f64, table.simulated.len() as f64];
        let (replicates, freedom) = spread(table, place, &values, &self.replicates);
        let (ratio, of_ratio) = if k > 1.0 {
            self.repeats
                .moderate(&table.cells[place], of_measured / replicates, k - 1.0)
        } else {
            (1.0, MANY)
        };
        let beyond = replicates * (ratio - 1.0).max(0.0);
        // The log odds of a class seen in no replicate are finite; a statistic that varies has its own
        // spread.
        let resolution = match table.cells[place].statistic.measure() {
            counted @ Measure::Odds => counted.resolution(table.sizes[place]),
            _ => 0.0,
        };
        let parts = [
            (resolution * resolution, MANY),
            (replicates * (1.0 / k + 1.0 / n), freedom),
            (beyond / k, of_ratio),
            (added * added, MANY),
        ];
        let variance: f64 = parts.iter().map(|(part, _)| part).sum();
        let welch = parts
            .iter()
            .map(|(part, d)| (part / variance) * (part / variance) / d);
        Difference {
            means: [measured, simulated],
            error: libm::sqrt(variance),
            freedom: 1.0 / welch.sum::<f64>(),
        }
    }
}

/// Moderated variance of a cell with these values of replicates, in its unit squared, and its
/// degrees of freedom.
fn spread(table: &Table, place: usize, values: &[f64], priors: &Priors) -> (f64, f64) {
    let square = table.square(place);
    let variance = mean_and_variance(values)[1] / square;
    let (moderated, freedom) =
        priors.moderate(&table.cells[place], variance, (values.len() - 1) as f64);
    (square * moderated.max(LEAST_SPREAD * LEAST_SPREAD), freedom)
}

/// Leave-one-out z-scores of the replicates within their conditions, by kinds of cells.
fn scores(tables: &[Table], priors: &Priors) -> BTreeMap<Kind, Vec<f64>> {
    let mut scores = BTreeMap::<_, Vec<f64>>::new();
    for (table, place) in cells(tables) {
        let values = column(&table.simulated, place);
        let [_, variance] = mean_and_variance(&values);
        // Identical replicates carry no information on the tail.
        if variance <= LEAST_SPREAD * LEAST_SPREAD * table.square(place) {
            continue;
        }
        let of_kind = scores.entry(kind(&table.cells[place])).or_default();
        for number in 0..values.len() {
            let mut others = values.clone();
            let left_out = others.swap_remove(number);
            let [mean, _] = mean_and_variance(&others);
            let (variance, _) = spread(table, place, &others, priors);
            let error = libm::sqrt(variance * (1.0 + 1.0 / others.len() as f64));
            of_kind.push((left_out - mean) / error);
        }
    }
    scores
}

fn cells(tables: &[Table]) -> impl Iterator<Item = (&Table, usize)> {
    let places = |table: &'_ Table| 0..table.cells.len();
    tables
        .iter()
        .flat_map(move |table| places(table).map(move |place| (table, place)))
}

/// The values of a cell, run by run.
fn column(runs: &[Vec<f64>], place: usize) -> Vec<f64> {
    runs.iter().map(|run| run[place]).collect()
}

impl Table {
    /// What a cell's spread is compared with, in its unit; above 0.
    pub(super) fn scale(&self, place: usize) -> f64 {
        let runs = self.simulated.iter().chain(&self.measured);
        let largest = runs.map(|run| run[place].abs()).fold(0.0, f64::max);
        let scales = [self.sizes[place], largest];
        scales.into_iter().find(|scale| *scale > 0.0).unwrap_or(1.0)
    }

    fn square(&self, place: usize) -> f64 {
        self.scale(place) * self.scale(place)
    }
}
