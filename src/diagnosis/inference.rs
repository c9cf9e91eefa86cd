//! What rigs of a layout teach: from the statistics of a campaign to probabilities of causes.
//!
//! ```text
//! rigs ─▶ scale ─▶ emulator ─▶ evidence ─┐
//!              └─▶ trees ────▶ votes ────┴─▶ pool ─▶ probabilities
//! ```
//!
//! Two estimates of different kinds are pooled: the likelihood of each cause under the `emulator`, and the votes of
//! `trees`. The weights of the `pool`, of the test for causes that are none of the candidates, and of the test for two
//! effects are logistic regressions on rigs that had no part in either estimate: for the evidence of each fold of rigs an
//! emulator is trained on the other folds, and the votes are those of trees that did not see the rig. The same rigs, judged
//! by weights of other rigs, measure what may be expected of this layout, the [self-test](SelfTest).

mod ablation;
mod covariance;
mod emulator;
mod evidence;
mod logistic;
mod place;
mod pool;
mod scale;
mod self_test;
mod shrinkage;
mod trees;

use crate::statistics::{quantile_upper, sorted};
pub use ablation::Ablation;
pub use evidence::{Evidence, Fit, Pair, Signatures, Size};
pub use pool::{BaseRates, Judgement};
pub use self_test::{EffectPower, SelfTest};

use super::candidate::Candidate;
use super::rigs::{Column, Part, Row, Table};
use crate::quantity::Seed;
use emulator::{Emulator, Labels, Training};
use evidence::Curves;
use nalgebra::DMatrix;
use place::Place;
use pool::{Calibrating, Opinion, Pool, Trainer};
use rayon::prelude::*;
use scale::Scale;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use trees::{Sample, Trees};

/// Folds of rigs.
const FOLDS: u64 = 8;
/// Share of intervals of sizes that are to hold the true one.
const INTERVALS: f64 = 0.95;

/// A trained model of a layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    scale: Scale,
    /// Condition of each used statistic.
    conditions: Vec<usize>,
    emulator: Emulator,
    trees: Trees,
    pool: Pool,
    /// How many times wider intervals of sizes are than those of the emulator.
    widening: f64,
    /// What may be expected of it.
    pub self_test: SelfTest,
}

/// Rigs from which nothing can be learned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrainingError {
    /// There are too few.
    #[error("{rigs} rigs are too few for the training: allow at least {least}")]
    TooFew {
        /// Rigs.
        rigs: usize,
        /// The least that serve.
        least: usize,
    },
    /// Their statistics have no variance.
    #[error("the statistics of these rigs do not vary, so that no model can be trained on them")]
    Degenerate,
}

/// How a model is trained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainingSettings {
    /// Where the draws of the trees come from.
    pub seed: Seed,
    /// A part that is left out.
    pub ablation: Option<Ablation>,
}

/// Rigs below which nothing is learned.
pub const FEWEST_RIGS: usize = 40;

/// A number of a statistic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OfColumn {
    /// Number of its column.
    pub column: usize,
    /// The number.
    pub value: f64,
}

impl Model {
    /// Learns from the rigs of a table with these candidates.
    ///
    /// # Errors
    /// `TooFew`; `Degenerate`.
    pub fn train(
        table: &Table,
        candidates: &[Candidate],
        training: TrainingSettings,
    ) -> Result<Self, TrainingError> {
        let rigs = count_rigs(table.rows.iter().map(|row| row.rig));
        if rigs < FEWEST_RIGS {
            return Err(TrainingError::TooFew {
                rigs,
                least: FEWEST_RIGS,
            });
        }
        let effects = candidates.len();
        let growths: Vec<f64> = candidates.iter().map(Candidate::growth).collect();
        let names: Vec<String> = candidates.iter().map(Candidate::name).collect();
        let scale = Scale::of(table);
        let standardised = scale.rows(table);
        let columns: Vec<&Column> = scale.used.iter().map(|it| &table.columns[*it]).collect();
        let places = places(&columns);
        let world = World {
            rows: &table.rows,
            standardised: &standardised,
            places: &places,
            growths: &growths,
            ablation: training.ablation,
        };
        let emulator = world.emulator(|_| true).ok_or(TrainingError::Degenerate)?;
        let folds = (0..FOLDS).into_par_iter().map(|fold| world.held_out(fold));
        let folds: Option<Vec<Vec<HeldOut>>> = folds.collect();
        let (trees, votes) = world.trees(training.seed);
        let mut held_out: Vec<HeldOut> = folds.ok_or(TrainingError::Degenerate)?.concat();
        held_out.sort_by_key(|it| it.row);
        let calibrating = held_out.into_iter().map(|it| Calibrating {
            opinion: Opinion {
                evidence: it.evidence,
                votes: votes[it.row].clone(),
                scores: emulator.len(),
            },
            row: &table.rows[it.row],
        });
        let calibrating: Vec<Calibrating> = calibrating.collect();
        let rows: Vec<&Calibrating> = calibrating.iter().collect();
        let trainer = Trainer {
            effects,
            has_trained_weights: training.ablation != Some(Ablation::TrainedWeights),
        };
        let pool = trainer.fit(&rows);
        let judgements = trainer.cross_fitted(&rows);
        let self_test = SelfTest::of(&rows, &judgements, rigs, &names);
        Ok(Self {
            scale,
            conditions: places.iter().map(|place| place.condition).collect(),
            emulator,
            widening: widening(&calibrating),
            trees,
            pool: pool.with_threshold(self_test.threshold),
            self_test,
        })
    }

    /// What a campaign with these statistics comes to.
    pub fn judge(&self, values: &[f32], rates: &BaseRates) -> Judgement {
        let row = self.scale.row(values);
        let opinion = Opinion {
            evidence: self
                .curves()
                .evidence(&self.emulator.scores(&row))
                .widened(self.widening),
            votes: self.trees.votes(&row),
            scores: self.emulator.len(),
        };
        self.pool.judge(opinion, rates)
    }

    /// Parameters where these effects are there with these sizes.
    pub fn fit(&self, values: &[f32], effects: &[Part]) -> Fit {
        let row = self.scale.row(values);
        self.curves().fit(&self.emulator.scores(&row), effects)
    }

    /// What effects show near these parameters.
    pub fn signatures(&self, parameters: &[f64]) -> Signatures {
        Signatures::of(&self.curves(), parameters)
    }

    fn curves(&self) -> Curves<'_> {
        Curves::of(&self.emulator)
    }

    /// Statistics of a condition in units of their scatter about the emulator, in the order of the used columns; one that
    /// is not finite is at the median.
    pub fn standardised(&self, condition: usize, values: &[f64]) -> Vec<f64> {
        let deviations = self.emulator.deviations();
        let used = self.scale.used.iter().enumerate();
        let own = used.filter(|(place, _)| self.conditions[*place] == condition);
        let rows =
            own.map(|(place, column)| self.scale.value(place, values[*column]) / deviations[place]);
        rows.collect()
    }

    /// What parameters leave of a campaign without effects: used columns with their residuals \[scatters\].
    pub fn residuals(&self, values: &[f32], parameters: &[f64]) -> Vec<OfColumn> {
        let row = self.scale.row(values);
        let predicted = self.emulator.statistics(parameters);
        let deviations = self.emulator.deviations();
        let used = self.scale.used.iter().enumerate();
        let residual = |place: usize| (row[place] - predicted[place]) / deviations[place];
        used.map(|(place, column)| OfColumn {
            column: *column,
            value: residual(place),
        })
        .collect()
    }

    /// Standard deviations that uncertain parameters give the used columns, in their units.
    pub fn parameter_spread(&self, fit: &Fit) -> Vec<OfColumn> {
        let slopes = self.emulator.statistic_slopes(&fit.parameters);
        let used = self.scale.used.iter().enumerate();
        let spread = |place: usize| {
            let slope = slopes.column(place);
            let variance = slope.dot(&(&fit.covariance * slope));
            self.scale.in_unit(place, libm::sqrt(variance.max(0.0)))
        };
        used.map(|(place, column)| OfColumn {
            column: *column,
            value: spread(place),
        })
        .collect()
    }
}

/// Factor with which intervals of sizes hold the true one in 95 % of the rigs in which the effect has the most evidence: the
/// emulator's own intervals know nothing of its error and of effects that follow another law.
fn widening(rigs: &[Calibrating]) -> f64 {
    let distances = rigs.iter().filter_map(|rig| match rig.row.effects[..] {
        [part] => rig.opinion.evidence.distance(part),
        _ => None,
    });
    quantile_upper(&sorted(distances), INTERVALS).map_or(1.0, |factor| factor.max(1.0))
}

/// Where columns belong.
fn places(columns: &[&Column]) -> Vec<Place> {
    let (mut cells, mut channels) = (BTreeMap::new(), BTreeMap::new());
    let places = columns.iter().map(|column| {
        let (cell, next) = (&column.cell, cells.len());
        let number = *cells.entry(cell).or_insert(next);
        let next = channels.len();
        Place {
            condition: column.condition,
            cell: number,
            channel: *channels.entry(&cell.channel).or_insert(next),
        }
    });
    places.collect()
}

fn count_rigs(rigs: impl Iterator<Item = u64>) -> usize {
    let mut rigs: Vec<u64> = rigs.collect();
    rigs.sort_unstable();
    rigs.dedup();
    rigs.len()
}

/// Evidence of a row that had no part in the emulator.
#[derive(Clone)]
struct HeldOut {
    row: usize,
    evidence: Evidence,
}

/// What is learned from.
struct World<'a> {
    rows: &'a [Row],
    standardised: &'a DMatrix<f64>,
    places: &'a [Place],
    /// `R` of each candidate.
    growths: &'a [f64],
    ablation: Option<Ablation>,
}

impl World<'_> {
    /// The emulator of some rigs.
    fn emulator(&self, is_used: impl Fn(u64) -> bool) -> Option<Emulator> {
        let rows = 0..self.rows.len();
        let used: Vec<usize> = rows.filter(|row| is_used(self.rows[*row].rig)).collect();
        let rows = used.iter().map(|row| &self.rows[*row]);
        Emulator::train(&Training {
            standardised: self.standardised.select_rows(&used),
            labels: rows.clone().map(Labels::from).collect(),
            places: self.places,
            growths: self.growths,
            ablation: self.ablation,
            rigs: rows.map(|row| row.rig).collect(),
        })
    }

    /// Evidence of the rows of a fold, by an emulator of all others.
    fn held_out(&self, fold: u64) -> Option<Vec<HeldOut>> {
        let emulator = self.emulator(|rig| rig % FOLDS != fold)?;
        let curves = Curves::of(&emulator);
        let rows = 0..self.rows.len();
        let own = rows.filter(|row| self.rows[*row].rig % FOLDS == fold);
        let held_out = own.map(|row| {
            let values: Vec<f64> = self.standardised.row(row).iter().copied().collect();
            let evidence = curves.evidence(&emulator.scores(&values));
            HeldOut { row, evidence }
        });
        Some(held_out.collect())
    }

    /// Trees on rows with one effect or none, and their votes on all rows.
    fn trees(&self, seed: Seed) -> (Trees, Vec<Vec<f64>>) {
        let rows = 0..self.rows.len();
        let (single, paired): (Vec<usize>, Vec<usize>) =
            rows.partition(|row| self.rows[*row].effects.len() < 2);
        let class = |row: &usize| match self.rows[*row].effects.first() {
            Some(part) => part.candidate + 1,
            None => 0,
        };
        let classes: Vec<usize> = single.iter().map(class).collect();
        let mut counts = vec![0.0; self.growths.len() + 1];
        classes.iter().for_each(|class| counts[*class] += 1.0);
        let mut weights: Vec<f64> = counts
            .iter()
            .map(|count| 1.0 / f64::max(*count, 1.0))
            .collect();
        // As many campaigns without effects as with six kinds of them.
        weights[0] *= 6.0;
        let rigs: Vec<u64> = single.iter().map(|row| self.rows[*row].rig).collect();
        let columns = (0..self.standardised.ncols()).map(|column| {
            let values = single
                .iter()
                .map(|row| self.standardised[(*row, column)] as f32);
            values.collect()
        });
        let sample = Sample {
            columns: columns.collect(),
            classes,
            weights,
            rigs: &rigs,
        };
        let (trees, unseen) = Trees::grow(&sample, seed);
        let mut votes = vec![Vec::new(); self.rows.len()];
        for (row, unseen) in single.into_iter().zip(unseen) {
            votes[row] = unseen;
        }
        // Pairs had no part in the trees.
        for row in paired {
            let values: Vec<f64> = self.standardised.row(row).iter().copied().collect();
            votes[row] = trees.votes(&values);
        }
        (trees, votes)
    }
}
