//! A world with the library that a diagnosis has of it.

use super::world::{LEVELS, SMALL, STREAMS, Size, Truth, World, normal};
use crate::diagnosis::library::Beside;
use crate::diagnosis::pins::{Ends, ROUNDS, unpinned};
use crate::diagnosis::ranking::Ranking;
use crate::diagnosis::*;
use crate::quantity::Seed;
use rand::{Rng, RngExt};

/// A world with all that can be prepared before a measurement.
pub(super) struct Bench {
    pub world: World,
    pub library: Library,
    pub emulator: Emulator,
    pub calibration: Calibration,
    pub forest: Forest,
    pub repeats: usize,
}

impl Bench {
    pub fn new(size: Size, repeats: usize, seed: u64) -> Self {
        let world = World::new(size, seed);
        let library = world.library(seed);
        Self::of(world, library, repeats, seed)
    }

    /// A small world in which two parameters do more than each by itself.
    pub fn entangled(seed: u64) -> Self {
        let world = World::entangled(SMALL, seed);
        let library = world.library(seed);
        Self::of(world, library, 2, seed)
    }

    pub fn of(world: World, library: Library, repeats: usize, seed: u64) -> Self {
        // These worlds obey the model: nothing of it is to be doubted.
        let calibration = Calibration {
            temperature: 1.0,
            gain_error: 0.0,
            ..Calibration::default()
        };
        let emulator = Emulator::new(&library).unwrap();
        let quiet = world.measured(&Truth::default(), repeats, seed + 1000);
        let observation = Observation::new(&emulator, &library, &quiet, &calibration).unwrap();
        let problem = Problem {
            emulator: &emulator,
            observation: &observation,
            calibration: &calibration,
        };
        let forest = Forest::train(problem, Seed(seed));
        Self {
            world,
            library,
            emulator,
            calibration,
            forest,
            repeats,
        }
    }

    pub fn observe(&self, measured: &[Measured]) -> Observation {
        Observation::new(&self.emulator, &self.library, measured, &self.calibration).unwrap()
    }

    pub fn problem<'a>(&'a self, observation: &'a Observation) -> Problem<'a> {
        Problem {
            emulator: &self.emulator,
            observation,
            calibration: &self.calibration,
        }
    }

    pub fn verdict_on(&self, measured: &[Measured]) -> Verdict {
        let observation = self.observe(measured);
        let problem = self.problem(&observation);
        Verdict::of(problem, &Ranking::new(problem, &self.forest), Seed(1))
    }

    pub fn verdict(&self, truth: &Truth, seed: u64) -> Verdict {
        self.verdict_on(&self.world.measured(truth, self.repeats, seed))
    }

    /// The verdict after what fits end at was simulated, as an investigation does it.
    pub fn pinned(&self, truth: &Truth, seed: u64) -> Verdict {
        let measured = self.world.measured(truth, self.repeats, seed);
        let observation = self.observe(&measured);
        let mut emulator = Emulator::new(&self.library).unwrap();
        let mut rng = Seed(seed).rng("pins", 0);
        for round in 0..ROUNDS {
            let problem = Problem {
                emulator: &emulator,
                ..self.problem(&observation)
            };
            let Ends {
                best,
                unpinned,
                stale,
                ..
            } = unpinned(problem, round);
            emulator.middle = best;
            if unpinned.is_empty() && stale.is_empty() {
                break;
            }
            for point in unpinned {
                let there = Truth {
                    offsets: point.offsets.clone(),
                    effects: point.effects.clone(),
                    off: Vec::new(),
                };
                let runs = self.beside([&there, &Truth::default()], &mut rng);
                emulator.pin(point, &runs);
            }
            for (effect, offsets) in stale {
                let levels = self.levels(effect, &offsets, &mut rng);
                emulator.tell_anew(effect, &levels);
            }
        }
        let problem = Problem {
            emulator: &emulator,
            ..self.problem(&observation)
        };
        Verdict::of(problem, &Ranking::new(problem, &self.forest), Seed(1))
    }

    /// Runs with the first truth and with the second, alike by chance: by condition, a pair a stream.
    pub fn beside(&self, truths: [&Truth; 2], rng: &mut impl Rng) -> Vec<Vec<Beside>> {
        let mut stream = |condition| {
            let chance = self.world.run(condition, &Truth::default(), rng);
            let [with, without] = truths.map(|truth| {
                let mut row = chance.clone();
                product::add(&mut row, 1.0, &self.world.change(condition, truth));
                row
            });
            Beside { with, without }
        };
        let conditions = 0..self.world.size.conditions;
        conditions
            .map(|condition| (0..STREAMS).map(|_| stream(condition)).collect())
            .collect()
    }

    /// Runs with an effect at its levels and without it, where parameters are these.
    pub fn levels(
        &self,
        effect: usize,
        offsets: &[f64],
        rng: &mut impl Rng,
    ) -> [(f64, Vec<Vec<Beside>>); 3] {
        let at = |effects| Truth {
            offsets: offsets.to_vec(),
            effects,
            off: Vec::new(),
        };
        LEVELS.map(|level| {
            let there = at(vec![(effect, level)]);
            (level, self.beside([&there, &at(Vec::new())], rng))
        })
    }

    pub fn screened(&self) -> Vec<Screened> {
        let quiet = self.world.measured(&Truth::default(), self.repeats, 7);
        let observation = self.observe(&quiet);
        screen(self.problem(&observation))
    }
}

/// A truth as the priors have it.
pub(super) fn drawn(bench: &Bench, rng: &mut impl Rng) -> (String, Truth) {
    let priors = bench.calibration.priors;
    let mut place = rng.random::<f64>();
    let kind = priors.iter().position(|prior| {
        place -= prior;
        place < 0.0
    });
    let scale = [0.0, 0.3, 1.0, 3.0][[0, 0, 0, 1, 1, 2, 2, 2, 3, 2][rng.random_range(0..10)]];
    let offsets = |scale: f64, rng: &mut _| -> Vec<f64> {
        (0..bench.world.size.parameters)
            .map(|_| scale * normal(rng))
            .collect()
    };
    let effects = bench.world.size.effects;
    let magnitude = |rng: &mut _| 1.2 * normal(rng).abs();
    match kind {
        Some(0) => ("none".to_owned(), Truth::default()),
        Some(1) => {
            let offsets = offsets([0.3, 1.0, 1.0, 3.0][rng.random_range(0..4)], rng);
            (
                "parameter".to_owned(),
                Truth {
                    offsets,
                    ..Truth::default()
                },
            )
        }
        Some(2) => {
            let effect = rng.random_range(0..effects);
            let offsets = offsets(scale, rng);
            let truth = Truth::effect(effect, magnitude(rng));
            (format!("e{effect}"), Truth { offsets, ..truth })
        }
        Some(3) => {
            let first = rng.random_range(0..effects - 1);
            let second = rng.random_range(first + 1..effects);
            let truth = Truth {
                offsets: offsets(scale, rng),
                effects: vec![(first, magnitude(rng)), (second, magnitude(rng))],
                ..Truth::default()
            };
            (format!("e{first}+e{second}"), truth)
        }
        _ => {
            let off = (0..5).map(|_| {
                (
                    rng.random_range(0..bench.world.size.cells),
                    3.0 * normal(rng),
                )
            });
            let off = off.collect();
            (
                "unknown".to_owned(),
                Truth {
                    off,
                    ..Truth::default()
                },
            )
        }
    }
}

pub(super) fn without(mut library: Library, effect: usize) -> Library {
    library.candidates.remove(effect);
    for condition in &mut library.conditions {
        condition.effects.remove(effect);
    }
    library
}
