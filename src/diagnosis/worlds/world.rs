//! A world: what its parameters and effects change, and runs of it.

use crate::diagnosis::*;
use crate::effects::{Prior, Seat};
use crate::gap::{Cell, Condition, Statistic};
use crate::quantity::Seed;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

#[derive(Clone, Copy)]
pub(super) struct Size {
    pub conditions: usize,
    pub cells: usize,
    pub parameters: usize,
    pub effects: usize,
}

pub(super) const SMALL: Size = Size {
    conditions: 8,
    cells: 36,
    parameters: 3,
    effects: 10,
};
const REPLICATES: usize = 24;
pub(super) const STREAMS: usize = 4;
pub(super) const LEVELS: [f64; 3] = [0.5, 1.0, 2.0];

pub(super) struct World {
    pub size: Size,
    /// Loads of common noise, by condition, factor and cell.
    pub factors: Vec<Vec<Vec<f64>>>,
    /// By condition and parameter.
    pub jacobian: Vec<Vec<Vec<f64>>>,
    /// By condition and effect.
    pub signatures: Vec<Vec<Vec<f64>>>,
    /// By condition, what the first two parameters change only together; none in most worlds.
    pub together: Vec<Vec<f64>>,
    /// By condition, what the cube of the first parameter changes; none in most worlds.
    pub cubic: Vec<Vec<f64>>,
    /// What the first parameter takes off an effect's magnitude before it shows, per prior standard deviation.
    pub hides: f64,
}

pub(super) fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// Some cells, changed by about `size`.
pub(super) fn pattern(cells: usize, size: f64, rng: &mut impl Rng) -> Vec<f64> {
    let cell = |_| match rng.random::<f64>() < 0.4 {
        true => size * normal(rng),
        false => 0.0,
    };
    (0..cells).map(cell).collect()
}

/// A pattern whose strength changes with the condition.
fn over_conditions(size: Size, strength: f64, rng: &mut impl Rng) -> Vec<Vec<f64>> {
    let [common, changing] = [0, 1].map(|_| pattern(size.cells, strength, rng));
    (0..size.conditions)
        .map(|number| {
            let place = number as f64 / size.conditions as f64;
            let cells = common.iter().zip(&changing);
            cells.map(|(a, b)| a + (place - 0.5) * b).collect()
        })
        .collect()
}

/// From one list a name to one list a condition.
fn turned(lists: Vec<Vec<Vec<f64>>>, conditions: usize) -> Vec<Vec<Vec<f64>>> {
    let of = |number: usize| lists.iter().map(|list| list[number].clone()).collect();
    (0..conditions).map(of).collect()
}

/// Change of a magnitude that saturates a little.
pub(super) fn grown(magnitude: f64) -> f64 {
    magnitude / (1.0 + 0.1 * magnitude.abs())
}

impl World {
    pub fn new(size: Size, seed: u64) -> Self {
        let mut rng = Seed(seed).rng("world", 0);
        let parameters: Vec<_> = (0..size.parameters)
            .map(|_| over_conditions(size, 0.8, &mut rng))
            .collect();
        let mut effects: Vec<_> = (0..size.effects)
            .map(|_| over_conditions(size, 0.6, &mut rng))
            .collect();
        effects[1] = effects[0].clone();
        effects[2] = parameters[0].clone();
        let factors = (0..size.conditions).map(|_| {
            let factor = |_| (0..size.cells).map(|_| 0.4 * normal(&mut rng)).collect();
            (0..2).map(factor).collect()
        });
        Self {
            factors: factors.collect(),
            jacobian: turned(parameters, size.conditions),
            signatures: turned(effects, size.conditions),
            together: Vec::new(),
            cubic: Vec::new(),
            hides: 0.0,
            size,
        }
    }

    /// One in which two parameters do more than each by itself.
    pub fn entangled(size: Size, seed: u64) -> Self {
        let mut rng = Seed(seed).rng("together", 0);
        Self {
            together: over_conditions(size, 0.8, &mut rng),
            ..Self::new(size, seed)
        }
    }

    /// One whose first parameter, far off, has other slopes than in the middle.
    pub fn cubic(size: Size, seed: u64) -> Self {
        let mut rng = Seed(seed).rng("cubic", 0);
        Self {
            cubic: over_conditions(size, 0.4, &mut rng),
            ..Self::new(size, seed)
        }
    }

    pub fn run(&self, condition: usize, truth: &Truth, rng: &mut impl Rng) -> Vec<f64> {
        let mut row: Vec<f64> = (0..self.size.cells).map(|_| normal(rng)).collect();
        for factor in &self.factors[condition] {
            product::add(&mut row, normal(rng), factor);
        }
        product::add(&mut row, 1.0, &self.change(condition, truth));
        for (cell, off) in &truth.off {
            row[*cell] += off;
        }
        row
    }

    pub fn change(&self, condition: usize, truth: &Truth) -> Vec<f64> {
        let mut row = vec![0.0; self.size.cells];
        for (column, offset) in self.jacobian[condition].iter().zip(&truth.offsets) {
            product::add(&mut row, *offset, column);
        }
        if let (Some(together), [a, b, ..]) = (self.together.get(condition), &*truth.offsets) {
            product::add(&mut row, a * b, together);
        }
        if let (Some(cubic), [a, ..]) = (self.cubic.get(condition), &*truth.offsets) {
            product::add(&mut row, a * a * a, cubic);
        }
        let hidden = self.hides * truth.offsets.first().unwrap_or(&0.0);
        for (effect, magnitude) in &truth.effects {
            product::add(
                &mut row,
                grown((magnitude - hidden).max(0.0)),
                &self.signatures[condition][*effect],
            );
        }
        row
    }

    /// Changes as streams of common random numbers show them.
    pub fn streams(&self, condition: usize, truth: &Truth, rng: &mut impl Rng) -> Vec<Vec<f64>> {
        let change = self.change(condition, truth);
        let stream = |_| change.iter().map(|x| x + 0.05 * normal(rng)).collect();
        (0..STREAMS).map(stream).collect()
    }

    pub fn library(&self, seed: u64) -> Library {
        let mut rng = Seed(seed).rng("library", 0);
        let conditions = (0..self.size.conditions).map(|number| Responses {
            condition: Condition::from(&*format!("condition {number}")),
            covariates: [0.1 * number as f64, 100.0, 0.01],
            cells: (0..self.size.cells).map(cell).collect(),
            sizes: vec![10.0; self.size.cells],
            base: (0..REPLICATES)
                .map(|_| self.run(number, &Truth::default(), &mut rng))
                .collect(),
            parameters: (0..self.size.parameters)
                .map(|p| Moved {
                    slope: self.streams(number, &Truth::parameter(p, 1.0), &mut rng),
                    bend: Vec::new(),
                })
                .collect(),
            effects: (0..self.size.effects)
                .map(|effect| {
                    let level = |magnitude| Level {
                        magnitude,
                        changes: self.streams(number, &Truth::effect(effect, magnitude), &mut rng),
                    };
                    LEVELS.map(level).into()
                })
                .collect(),
        });
        let conditions = conditions.collect();
        let seat = Seat {
            channel: "",
            unit: "mm",
            neutral: 0.0,
            range: [0.0, 6.0],
            levels: LEVELS,
            prior: Prior::HalfNormal { scale: 1.2 },
        };
        Library {
            parameters: (0..self.size.parameters).map(|p| format!("p{p}")).collect(),
            candidates: (0..self.size.effects)
                .map(|e| Candidate {
                    name: format!("e{e}"),
                    seat,
                    of_sensors: false,
                })
                .collect(),
            conditions,
        }
    }

    /// Runs in which each number of an effect's change is off by a share of it that is its own: a law that
    /// is not quite the library's.
    pub fn in_another_form(
        &self,
        effect: usize,
        magnitude: f64,
        share: f64,
        seed: u64,
    ) -> Vec<Measured> {
        let mut rng = Seed(seed).rng("form", 0);
        let truth = Truth::effect(effect, magnitude);
        let shares: Vec<f64> = (0..self.size.cells)
            .map(|_| share * normal(&mut rng))
            .collect();
        let mut measured = self.measured(&truth, 2, seed);
        for (condition, measured) in measured.iter_mut().enumerate() {
            let change = product::scaled(&self.change(condition, &truth), &shares);
            let runs = measured.runs.iter_mut();
            runs.for_each(|run| product::add(run, 1.0, &change));
        }
        measured
    }

    pub fn measured(&self, truth: &Truth, repeats: usize, seed: u64) -> Vec<Measured> {
        let mut rng = Seed(seed).rng("measured", 0);
        (0..self.size.conditions)
            .map(|number| Measured {
                runs: (0..repeats)
                    .map(|_| self.run(number, truth, &mut rng))
                    .collect(),
                days: (0..repeats).map(|day| format!("day {day}")).collect(),
            })
            .collect()
    }
}

pub(super) fn cell(place: usize) -> Cell {
    let channel = ["drawbar_pull", "normal_force", "acceleration_y"][place % 3];
    Cell::new(channel, Statistic::Band(place as i16))
}

/// What is the case.
#[derive(Debug, Clone, Default)]
pub(super) struct Truth {
    pub offsets: Vec<f64>,
    pub effects: Vec<(usize, f64)>,
    /// Cells off in every condition, and how far.
    pub off: Vec<(usize, f64)>,
}

impl Truth {
    pub fn parameter(place: usize, offset: f64) -> Self {
        let mut offsets = vec![0.0; place + 1];
        offsets[place] = offset;
        Self {
            offsets,
            ..Self::default()
        }
    }

    pub fn effect(effect: usize, magnitude: f64) -> Self {
        Self {
            effects: vec![(effect, magnitude)],
            ..Self::default()
        }
    }
}
