//! Which rigs are drawn.
//!
//! Every rig moves twice on the same ground with the same noise: without effects, and with one effect that changes the
//! motion. What the effect does shows in the difference of the two, which has little of the scatter between rigs. The first
//! motion is measured by sensors without effects, with one and with two, the second without and with one. Effects take
//! turns, so that all are drawn equally often; sizes are uniform from a little below the low to a little above the high
//! level, parameters normal within [`FARTHEST`]. A part of all effects follows a randomised [`Law`].

use super::law::Law;
use crate::diagnosis::candidate::Candidate;
use crate::quantity::Seed;
use rand::seq::SliceRandom;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Rows of the first motion with one effect of the sensors, and with two.
const SINGLES: usize = 8;
const PAIRS: usize = 1;
/// Rows of the second motion with an effect of the sensors besides.
const BESIDE: usize = 1;
/// Farthest parameter [prior standard deviations].
const FARTHEST: f64 = 2.5;
/// Share [-] of rows whose effects follow a randomised law.
const RANDOMISED: f64 = 0.25;
/// How far sizes go beyond the low and the high level.
const BEYOND: f64 = 0.1;

/// An effect of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Which candidate.
    pub candidate: usize,
    /// Its size [-], 0 at the low and 1 at the high level.
    pub size: f64,
}

/// One measurement of a rig.
#[derive(Debug, Clone, PartialEq)]
pub struct RowDesign {
    /// Its effects, that of the motion first.
    pub effects: Vec<Part>,
    /// Their law where it is a randomised one.
    pub law: Option<Law>,
}

/// A rig to be simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// Its number.
    pub number: u64,
    /// Parameters [prior standard deviations].
    pub parameters: Vec<f64>,
    /// Measurements, motion by motion.
    pub rows: Vec<RowDesign>,
}

impl RowDesign {
    /// Without effects.
    pub const PLAIN: Self = Self {
        effects: Vec::new(),
        law: None,
    };

    /// Whether the wheel moves alike in both.
    pub fn shares_motion(&self, other: &Self, candidates: &[Candidate]) -> bool {
        let moved = |row: &Self| {
            let first = row.effects.first().copied();
            let moved = first.filter(|part| candidates[part.candidate].changes_motion());
            moved.map(|part| (part, row.law.clone()))
        };
        moved(self) == moved(other)
    }
}

/// Motions of a rig in each condition.
pub fn motions(candidates: &[Candidate]) -> usize {
    1 + usize::from(candidates.iter().any(Candidate::changes_motion))
}

/// Numbers from 0 on in turn, each round in another order.
struct Turns {
    order: Vec<usize>,
    next: usize,
}

impl Turns {
    fn new(places: Vec<usize>) -> Self {
        Self {
            next: places.len(),
            order: places,
        }
    }

    fn next(&mut self, rng: &mut ChaCha8Rng) -> Option<usize> {
        if self.next >= self.order.len() {
            self.order.shuffle(rng);
            self.next = 0;
        }
        let place = self.order.get(self.next).copied();
        self.next += 1;
        place
    }
}

/// The first `count` rigs of a seed; more rigs begin with the same.
pub fn rigs(candidates: &[Candidate], parameters: usize, count: usize, seed: Seed) -> Vec<Rig> {
    let of_kind = |changes: bool| -> Vec<usize> {
        let places = 0..candidates.len();
        places
            .filter(|place| candidates[*place].changes_motion() == changes)
            .collect()
    };
    let (mut of_sensors, mut of_motion) = (Turns::new(of_kind(false)), Turns::new(of_kind(true)));
    let mut rng = seed.rng("diagnosis.design", 0);
    let rigs = (0..count).map(|number| {
        let parameters = (0..parameters).map(|_| normal(&mut rng)).collect();
        let mut rows = still(&mut of_sensors, &mut rng);
        if let Some(moved) = of_motion.next(&mut rng) {
            rows.extend(moving(moved, &mut of_sensors, &mut rng));
        }
        Rig {
            number: number as u64,
            parameters,
            rows,
        }
    });
    rigs.collect()
}

fn still(of_sensors: &mut Turns, rng: &mut ChaCha8Rng) -> Vec<RowDesign> {
    let mut rows = vec![RowDesign::PLAIN];
    let counts = std::iter::repeat_n(1, SINGLES).chain(std::iter::repeat_n(2, PAIRS));
    for count in counts {
        let mut effects: Vec<Part> = Vec::new();
        for _ in 0..count {
            // No pair of one effect with itself.
            let drawn = of_sensors.next(rng).map(|candidate| part(candidate, rng));
            let is_new = |part: &Part| effects.iter().all(|it| it.candidate != part.candidate);
            effects.extend(drawn.filter(is_new));
        }
        if effects.len() == count {
            let law = randomised(rng);
            rows.push(RowDesign { effects, law });
        }
    }
    rows
}

fn moving(moved: usize, of_sensors: &mut Turns, rng: &mut ChaCha8Rng) -> Vec<RowDesign> {
    let (own, law) = (part(moved, rng), randomised(rng));
    let mut rows = vec![RowDesign {
        effects: vec![own],
        law: law.clone(),
    }];
    for _ in 0..BESIDE {
        if let Some(candidate) = of_sensors.next(rng) {
            rows.push(RowDesign {
                effects: vec![own, part(candidate, rng)],
                law: law.clone(),
            });
        }
    }
    rows
}

fn part(candidate: usize, rng: &mut impl Rng) -> Part {
    let size = rng.random_range(-BEYOND..1.0 + BEYOND);
    Part { candidate, size }
}

fn randomised(rng: &mut ChaCha8Rng) -> Option<Law> {
    (rng.random::<f64>() < RANDOMISED).then(|| Law::draw(rng))
}

fn normal(rng: &mut impl Rng) -> f64 {
    loop {
        let drawn: f64 = StandardNormal.sample(rng);
        if drawn.abs() <= FARTHEST {
            return drawn;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::catalogue;
    use std::collections::BTreeMap;

    fn all() -> Vec<Candidate> {
        let seats = catalogue().flat_map(|effect| {
            let seats = effect.seats.iter();
            seats.map(move |seat| Candidate { effect, seat })
        });
        seats.collect()
    }

    #[test]
    fn more_rigs_begin_with_the_same() {
        let few = rigs(&all(), 5, 20, Seed(3));
        assert_eq!(rigs(&all(), 5, 60, Seed(3))[..20], few);
        assert_ne!(rigs(&all(), 5, 20, Seed(4)), few);
    }

    #[test]
    fn effects_are_drawn_equally_often() {
        let candidates = all();
        for changes in [false, true] {
            let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
            for rig in rigs(&candidates, 5, 500, Seed(3)) {
                for row in rig.rows.iter().filter(|row| row.effects.len() == 1) {
                    let candidate = row.effects[0].candidate;
                    if candidates[candidate].changes_motion() == changes {
                        *counts.entry(candidate).or_default() += 1;
                    }
                }
            }
            let [least, most] = [counts.values().min(), counts.values().max()];
            assert!(*most.unwrap() <= 2 * *least.unwrap(), "{counts:?}");
        }
    }

    #[test]
    fn every_rig_moves_without_effects_and_with_one_that_changes_the_motion() {
        let candidates = all();
        for rig in rigs(&candidates, 1, 9, Seed(1)) {
            let by_motion: Vec<&[RowDesign]> = rig
                .rows
                .chunk_by(|a, b| a.shares_motion(b, &candidates))
                .collect();
            assert_eq!(by_motion.len(), motions(&candidates));
            assert!(by_motion[0][0].effects.is_empty());
            assert_eq!(by_motion[1].len(), 1 + BESIDE);
        }
        let none = rigs(&[], 1, 9, Seed(1));
        assert!(none.iter().all(|rig| rig.rows.len() == 1));
        assert_eq!(motions(&[]), 1);
    }
}
