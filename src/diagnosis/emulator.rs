//! Statistics as a function of parameters and of an effect's magnitude, condition by condition.
//!
//! ```text
//! mean(θ, e, m) = base + J θ + Q θ² + d_e(m)
//! ```
//!
//! `θ` in standard deviations of the parameters' priors, `θ²` each one's own square; changes of
//! several parameters and effects add. All
//! numbers are whitened by the replicates' covariance, shrunk as [`Whitening`] has it. What spread
//! they have in a run that had no part in it, and how many of them count, is tried on
//! replicates left out ([`Scatter`]). The scatter of the changes from
//! stream to stream is the emulator's own error; changes are [freed of noise](denoise) by it. Where several are
//! off together it errs: [pins](super::pins) set it right there.

use super::denoising::denoise;
use super::library::Beside;
use super::pins::{Defect, Point};
use super::product::{middle, product};
use super::responses::{Candidate, DiagnosisError, Library, Responses};
use super::scatter::Scatter;
use super::shape::{Knot, Shape};
use crate::gap::{Cell, Condition, FEWEST_REPLICATES, Reading, Readings, Whitening};
use std::collections::BTreeSet;

/// Offset [prior standard deviations] beyond which a parameter's change bends no more: it was
/// simulated up to one.
pub(super) const BENT: f64 = 2.5;

/// Turns in which replicates are left out to try the whitening, some in each.
const TURNS: usize = 10;

/// A library as a function.
#[derive(Debug)]
pub struct Emulator {
    pub(super) parameters: Vec<String>,
    pub(super) candidates: Vec<Candidate>,
    pub(super) conditions: Vec<Emulated>,
    /// Where it was set right.
    pub(super) pins: Vec<Point>,
    /// Candidates whose changes were told anew where recalibration ended.
    pub(super) told_anew: Vec<usize>,
    /// Where the best explanation so far ends, about which linear looks are taken.
    pub(super) middle: Option<Point>,
}

/// Whitened statistics of one condition.
#[derive(Debug)]
pub(super) struct Emulated {
    pub condition: Condition,
    pub covariates: [f64; 3],
    /// The cell about which each whitened number is.
    pub cells: Vec<Cell>,
    /// The part of the measurements, a domain of a channel, that each number belongs to, counted from 0.
    pub parts: Vec<usize>,
    transform: Transform,
    /// Whitened replicates less their mean.
    pub replicates: Vec<Vec<f64>>,
    /// How runs lie that had no part in the whitening.
    pub scatter: Scatter,
    /// Change per parameter, and its variance.
    pub jacobian: Vec<Vec<f64>>,
    pub jacobian_error: Vec<Vec<f64>>,
    /// Change per square of each parameter.
    pub bend: Vec<Vec<f64>>,
    /// Change by candidate.
    pub shapes: Vec<Shape>,
    /// What it lacked at each pin.
    pub pinned: Vec<Defect>,
}

impl Emulator {
    /// # Errors
    /// `NoCondition` for an empty library; `Shape`, `NotFinite` and `Replicates` for rows that do
    /// not fit together, are not finite or too few.
    pub fn new(library: &Library) -> Result<Self, DiagnosisError> {
        let conditions = library.conditions.iter().map(|responses| {
            responses.check(library)?;
            Emulated::new(responses, library)
        });
        let conditions = conditions.collect::<Result<Vec<_>, _>>()?;
        if conditions.is_empty() {
            return Err(DiagnosisError::NoCondition);
        }
        Ok(Self {
            parameters: library.parameters.clone(),
            candidates: library.candidates.clone(),
            conditions,
            pins: Vec::new(),
            told_anew: Vec::new(),
            middle: None,
        })
    }

    /// Names of the candidates.
    pub fn candidates(&self) -> impl Iterator<Item = &str> {
        self.candidates.iter().map(|candidate| &*candidate.name)
    }
}

impl Emulated {
    fn new(responses: &Responses, library: &Library) -> Result<Self, DiagnosisError> {
        let of_replicates = |error| DiagnosisError::Replicates {
            condition: responses.condition.to_string(),
            error,
        };
        let rows: Vec<&[f64]> = responses.base.iter().map(Vec::as_slice).collect();
        let transform = Transform::of(responses, &rows).map_err(of_replicates)?;
        let parts = parts(transform.cells());
        let change = |rows: &[Vec<f64>]| transform.change(rows, &parts);
        let knots = |number: usize| {
            responses.effects[number]
                .iter()
                .filter(|level| !level.changes.is_empty())
                .map(|level| {
                    let at = library.candidates[number].strength(level.magnitude);
                    let streams = match library.candidates[number].of_sensors {
                        true => level.changes.len() as f64,
                        false => 0.0,
                    };
                    Knot::new(at, change(&level.changes), streams)
                })
                .collect()
        };
        let shapes = library.candidates.iter().enumerate();
        let shapes = shapes
            .map(|(number, _)| Shape::new(transform.cells().len(), knots(number)))
            .collect();
        let (jacobian, jacobian_error) = responses
            .parameters
            .iter()
            .map(|it| change(&it.slope))
            .unzip();
        let bend = responses
            .parameters
            .iter()
            .map(|it| match it.bend.is_empty() {
                true => vec![0.0; transform.cells().len()],
                false => change(&it.bend).0,
            });
        let left_out = left_out(responses, &rows).map_err(of_replicates)?;
        Ok(Self {
            condition: responses.condition.clone(),
            covariates: responses.covariates,
            cells: transform.cells().to_vec(),
            replicates: rows.iter().map(|row| transform.apply(row)).collect(),
            scatter: Scatter::of(
                left_out,
                transform.cells(),
                transform.least(&responses.sizes),
            ),
            bend: bend.collect(),
            jacobian,
            jacobian_error,
            shapes,
            parts,
            pinned: Vec::new(),
            transform,
        })
    }

    /// Adds the change that parameters make to `sums`.
    pub fn add_parameters(&self, offsets: &[f64], sums: &mut [f64]) {
        for (slope, offset) in self.jacobian.iter().zip(offsets) {
            super::product::add(sums, *offset, slope);
        }
        self.add_bends(offsets, sums);
    }

    /// Adds the change that effects of these strengths make to `sums`.
    pub fn add_effects(&self, effects: &[(usize, f64)], sums: &mut [f64]) {
        for &(effect, strength) in effects {
            self.shapes[effect].add(strength, 1.0, sums);
        }
    }

    /// Adds the variance that the change by effects itself has in the mean of so many runs.
    pub fn add_scatter(&self, effects: &[(usize, f64)], runs: usize, sums: &mut [f64]) {
        for &(effect, strength) in effects {
            self.shapes[effect].add_scatter(strength, runs, sums);
        }
    }

    /// Adds that part of the parameters' change which is not straight.
    pub fn add_bends(&self, offsets: &[f64], sums: &mut [f64]) {
        for (bend, offset) in self.bend.iter().zip(offsets) {
            let bent = offset.clamp(-BENT, BENT);
            super::product::add(sums, bent * bent, bend);
        }
    }

    /// What it lacks at a point that was simulated, a pair of runs a stream; [freed of noise](denoise).
    ///
    /// What the runs without it are off their mean is taken from those with it in part (a control
    /// variate): near the scenario as shipped both see the same ground alike, far from it a lug meets
    /// it at another moment.
    pub fn lacking(&self, point: &Point, runs: &[Beside]) -> Defect {
        let [with, without]: [Vec<Vec<f64>>; 2] = [
            runs.iter().map(|run| self.departure(&run.with)).collect(),
            runs.iter()
                .map(|run| self.departure(&run.without))
                .collect(),
        ];
        let share = shared(&with, &without);
        let corrected = with.into_iter().zip(&without).map(|(mut with, without)| {
            super::product::add(&mut with, -share, without);
            with
        });
        let (mut change, error) = mean(&corrected.collect::<Vec<_>>());
        let mut told = vec![0.0; self.cells.len()];
        self.add_parameters(&point.offsets, &mut told);
        self.add_effects(&point.effects, &mut told);
        super::product::add(&mut change, -1.0, &told);
        denoise(&mut change, &error, &self.parts);
        Defect {
            change,
            error,
            ..Defect::none(self.cells.len())
        }
    }

    /// The change by an effect of the sensors of this strength, from runs with it and without, a pair a stream, wherever
    /// their parameters are; [freed] of noise.
    pub fn knot(&self, at: f64, runs: &[Beside]) -> Knot {
        let changes = runs.iter().map(|run| {
            let mut change = self.departure(&run.with);
            super::product::add(&mut change, -1.0, &self.departure(&run.without));
            change
        });
        let changes: Vec<Vec<f64>> = changes.collect();
        Knot::new(at, freed(&changes, &self.parts), changes.len() as f64)
    }

    /// A run's departure from the replicates' mean, whitened.
    pub fn departure(&self, row: &[f64]) -> Vec<f64> {
        self.transform.apply(row)
    }
}

/// The domain of a channel that each cell belongs to, by its place among all there are.
fn parts(cells: &[Cell]) -> Vec<usize> {
    let of = |cell: &Cell| (cell.channel.clone(), cell.statistic.domain());
    let all: BTreeSet<_> = cells.iter().map(of).collect();
    let place = |cell: &Cell| all.range(..of(cell)).count();
    cells.iter().map(place).collect()
}

/// Whitening about the replicates' mean.
#[derive(Debug)]
struct Transform {
    whitening: Whitening,
    cells: Vec<Cell>,
    mean: Vec<f64>,
    /// The mean, whitened.
    centre: Vec<f64>,
    sizes: Vec<f64>,
}

impl Transform {
    fn of(responses: &Responses, rows: &[&[f64]]) -> Result<Self, crate::gap::GapError> {
        let (cells, sizes) = (responses.cells.clone(), responses.sizes.clone());
        let readings: Vec<Readings> = rows
            .iter()
            .map(|row| readings(&cells, &sizes, row))
            .collect();
        let whitening = Whitening::of(&readings.iter().collect::<Vec<_>>())?;
        let mut transform = Self {
            centre: vec![0.0; cells.len()],
            whitening,
            cells,
            mean: middle(rows),
            sizes,
        };
        transform.centre = transform.apply(&transform.mean);
        Ok(transform)
    }

    fn cells(&self) -> &[Cell] {
        self.whitening.cells()
    }

    /// A row less the mean, of unit variance per number.
    fn apply(&self, row: &[f64]) -> Vec<f64> {
        let readings = readings(&self.cells, &self.sizes, row);
        let root = libm::sqrt(self.cells.len() as f64);
        let white = self.whitening.whitened(&readings).unwrap_or_default();
        let centred = white.iter().zip(&self.centre);
        centred
            .map(|(white, centre)| root * white - centre)
            .collect()
    }

    fn moved(&self, change: &[f64]) -> Vec<f64> {
        let mut row = self.mean.clone();
        super::product::add(&mut row, 1.0, change);
        self.apply(&row)
    }

    /// Mean change over the streams, [freed] of noise, and the variance of that mean.
    fn change(&self, rows: &[Vec<f64>], parts: &[usize]) -> (Vec<f64>, Vec<f64>) {
        let white: Vec<Vec<f64>> = rows.iter().map(|row| self.moved(row)).collect();
        freed(&white, parts)
    }

    /// Variance of each number where every cell is uncertain by its resolution.
    fn least(&self, sizes: &[f64]) -> Vec<f64> {
        let mut least = vec![0.0; self.cells.len()];
        for (place, size) in sizes.iter().enumerate() {
            let mut change = vec![0.0; self.cells.len()];
            change[place] = self.cells[place].statistic.measure().resolution(*size);
            let white = self.moved(&change);
            let (most, _) = white
                .iter()
                .enumerate()
                .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
                .unwrap_or((0, &0.0));
            least[most] += product(&white, &white);
        }
        least
    }
}

/// Mean over the streams, freed of noise [part by part](denoise), and its variance.
fn freed(rows: &[Vec<f64>], parts: &[usize]) -> (Vec<f64>, Vec<f64>) {
    let (mut means, errors) = mean(rows);
    denoise(&mut means, &errors, parts);
    (means, errors)
}

/// Mean over the streams and its variance.
fn mean(rows: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let (means, mut errors) = super::product::mean(rows);
    // One cell's scatter is known from few streams: half of it is what all cells show.
    let common = errors.iter().sum::<f64>() / (errors.len() as f64).max(1.0);
    for error in &mut errors {
        *error = 0.5 * (*error + common);
    }
    (means, errors)
}

/// Share [-] of the scatter of `without` that `with` has too, over all streams and numbers.
fn shared(with: &[Vec<f64>], without: &[Vec<f64>]) -> f64 {
    let centred = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let middle = middle(rows);
        let rows = rows.iter().cloned();
        rows.map(|mut row| {
            super::product::add(&mut row, -1.0, &middle);
            row
        })
        .collect()
    };
    let [with, without] = [with, without].map(centred);
    let sum = |a: &[Vec<f64>], b: &[Vec<f64>]| -> f64 {
        a.iter().zip(b).map(|(a, b)| product(a, b)).sum()
    };
    let scatter = sum(&without, &without).max(f64::MIN_POSITIVE);
    (sum(&with, &without) / scatter).clamp(0.0, 1.0)
}

fn readings(cells: &[Cell], sizes: &[f64], row: &[f64]) -> Readings {
    let readings = row.iter().zip(sizes);
    let readings = readings.map(|(&value, &size)| Reading { value, size });
    cells.iter().cloned().zip(readings).collect()
}

/// Replicates, whitened by others; none where there are too few.
fn left_out(responses: &Responses, rows: &[&[f64]]) -> Result<Vec<Vec<f64>>, crate::gap::GapError> {
    let turns = rows.len().min(TURNS);
    let mut runs = Vec::new();
    for turn in 0..turns {
        let in_turn = |out: bool| {
            let rows = rows.iter().enumerate();
            rows.filter(move |(number, _)| (number % turns == turn) == out)
                .map(|(_, row)| *row)
        };
        let others: Vec<&[f64]> = in_turn(false).collect();
        if others.len() < FEWEST_REPLICATES {
            return Ok(Vec::new());
        }
        let transform = Transform::of(responses, &others)?;
        let of_mean = 1.0 / libm::sqrt(1.0 + 1.0 / others.len() as f64);
        runs.extend(in_turn(true).map(|row| {
            let mut run = transform.apply(row);
            run.iter_mut().for_each(|z| *z *= of_mean);
            run
        }));
    }
    Ok(runs)
}
