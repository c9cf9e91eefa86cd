//! Pours stones section by section in a world of their own.
//!
//! A section is poured between walls onto a floor, against the stones of the section before,
//! which may still move; those before that are fixed. So a section is final once the next one
//! has been poured, and what lies in it depends on seed, run and index alone.

use super::{BedRecipe, Laying, insert_floor};
use crate::quantity::SampleRate;
use crate::simulation::engine::{self, groups};
use crate::terrain::stones::{PlacedStone, StoneShape};
use rand::{Rng, RngExt};
use rapier2d::prelude::*;

/// Length [m] of a section.
pub(super) const SECTION: f64 = 0.5;
/// Length [m] by which new stones also fall on the section before, whose end slumps when its
/// wall goes: a pile of 0.12 m at a slope of 40°.
const OVERLAP: f64 = 0.15;
/// Area [-] of the stones poured over that of the pile: the rest is raked off.
const EXCESS: f64 = 1.2;
/// Rate [Hz] at which the pouring world looks for contacts: a stone that falls 0.5 m moves
/// 1.6 mm in between, a twelfth of the smallest usual stone.
const RATE: f64 = 2000.0;
/// Number [-] of times it solves contacts in between: 8 kHz.
const SUBSTEPS: usize = 4;
/// Distance [m] at which the pouring world expects contacts: what a falling stone moves in a step.
const PREDICTION: f64 = 1e-3;
/// Damping [1/s] of falling stones: it shortens their rocking, and rest knows nothing of it.
const DAMPING: f64 = 4.0;
/// Speed [m/s] of the knock that the bed gets at last: a rolling wheel's.
const TAP: f64 = 0.02;
/// Rate [Hz] of the pouring world from then on.
const TAPPED_RATE: f64 = 8000.0;
/// Time [s] between two looks whether the stones rest.
const LOOK: f64 = 0.05;
/// Distance [m] that no point of a resting stone moves between two looks.
const REST: f64 = 1e-6;
/// Longest time [s] given to the stones to come to rest.
const PATIENCE: f64 = 4.0;

/// Pours one section after the other; forward is the direction of growing position.
pub(super) struct Pouring {
    /// Where the next section begins [m].
    edge: f64,
    /// The next section.
    index: u64,
    /// Stones that the next section may still move.
    loose: Vec<PlacedStone>,
    /// Stones near the loose ones that nothing moves any more.
    fixed: Vec<PlacedStone>,
}

impl Pouring {
    /// Begins against a wall at `edge` [m].
    pub(super) fn new(edge: f64) -> Self {
        Self {
            edge,
            index: 0,
            loose: Vec::new(),
            fixed: Vec::new(),
        }
    }

    /// Position [m] up to which the bed is final.
    pub(super) fn finished(&self) -> f64 {
        self.edge - if self.index > 0 { SECTION } else { 0.0 }
    }

    /// Pours the next section; returns the stones that are final now.
    pub(super) fn pour(
        &mut self,
        recipe: &BedRecipe,
        floor: &dyn Fn(f64) -> f64,
    ) -> Vec<PlacedStone> {
        let stage = format!("stones of bed {}, section {}", recipe.number, self.index);
        let mut rng = recipe.seed.rng(&stage, recipe.run);
        let range = [self.edge, self.edge + SECTION];
        let stones: Vec<PlacedStone> = match recipe.laying {
            Laying::Pile { depth } => {
                let range = [range[0] - self.overlap(), range[1]];
                let area = EXCESS * depth * (range[1] - range[0]);
                let shapes = draw_area(recipe, area, &mut rng);
                let mut scratch = self.scratch(recipe, floor);
                scratch.drop(in_rows(shapes, range, usize::MAX, &mut rng));
                scratch.settle();
                scratch.rake();
                scratch.settle();
                scratch.tap(&mut rng);
                scratch.settle();
                scratch.stones().collect()
            }
            Laying::Scattered { per_metre } => {
                let shapes = draw_number(recipe, per_metre * SECTION, &mut rng);
                let mut scratch = self.scratch(recipe, floor);
                scratch.drop(in_rows(shapes, range, 1, &mut rng));
                scratch.settle();
                scratch.tap(&mut rng);
                scratch.settle();
                scratch.stones().collect()
            }
            Laying::Embedded {
                per_metre,
                embedding,
            } => {
                let shapes = draw_number(recipe, per_metre * SECTION, &mut rng);
                let mut stones = std::mem::take(&mut self.loose);
                stones.extend(in_one_row(shapes, range, &mut rng, |shape, x| {
                    floor(x) + (0.5 - embedding) * shape.diameter()
                }));
                stones
            }
        };
        self.advance(stones)
    }

    /// Length [m] by which the next section's stones also fall on the one before.
    fn overlap(&self) -> f64 {
        if self.index == 0 { 0.0 } else { OVERLAP }
    }

    /// A world with floor, walls, and the stones poured so far.
    fn scratch<'a>(&self, recipe: &'a BedRecipe, floor: &dyn Fn(f64) -> f64) -> Scratch<'a> {
        let [back, end] = [self.finished(), self.edge + SECTION];
        let mut scratch = Scratch::new(recipe);
        insert_floor(
            &mut scratch.world,
            [back - SECTION, end + SECTION],
            recipe.stones.friction,
            floor,
        );
        if self.index == 0 {
            scratch.wall(back);
        }
        scratch.wall(end);
        for stone in &self.fixed {
            recipe.insert(&mut scratch.world, stone, RigidBodyType::Fixed);
        }
        for stone in &self.loose {
            scratch.insert(stone);
        }
        scratch
    }

    /// Parts the stones in final and loose ones and moves on by one section.
    fn advance(&mut self, stones: Vec<PlacedStone>) -> Vec<PlacedStone> {
        let (done, loose): (Vec<_>, Vec<_>) = stones
            .into_iter()
            .partition(|stone| stone.position[0] < self.edge);
        self.loose = loose;
        self.fixed.extend(done.iter().cloned());
        let behind = self.edge - OVERLAP;
        self.fixed.retain(|stone| stone.position[0] > behind);
        self.edge += SECTION;
        self.index += 1;
        done
    }
}

/// Stones whose area adds up to `area` [m²].
fn draw_area(recipe: &BedRecipe, mut area: f64, rng: &mut impl Rng) -> Vec<StoneShape> {
    let mut shapes = Vec::new();
    while area > 0.0 {
        let shape = recipe.stones.draw(rng);
        area -= shape.area();
        shapes.push(shape);
    }
    shapes
}

/// A whole number of stones, `expected` [-] on average.
fn draw_number(recipe: &BedRecipe, expected: f64, rng: &mut impl Rng) -> Vec<StoneShape> {
    let count = libm::floor(expected + rng.random::<f64>()) as usize;
    (0..count).map(|_| recipe.stones.draw(rng)).collect()
}

/// Side [m] of a square in which each of these stones can turn.
fn square(shapes: &[StoneShape]) -> f64 {
    let radii = shapes.iter().map(StoneShape::outer_radius);
    2.05 * radii.fold(0.0, f64::max)
}

/// A stone at a position, not turned.
fn upright(shape: StoneShape, position: [f64; 2]) -> PlacedStone {
    PlacedStone {
        shape,
        position,
        rotation: [1.0, 0.0],
    }
}

/// Stones in rows of at most `longest`, one above the other, without overlap; the lowest row's
/// squares stand on height 0.
fn in_rows(
    shapes: Vec<StoneShape>,
    [from, to]: [f64; 2],
    longest: usize,
    rng: &mut impl Rng,
) -> Vec<PlacedStone> {
    let side = square(&shapes);
    let columns = (libm::floor((to - from) / side) as usize).clamp(1, longest);
    let cell = (to - from) / columns as f64;
    let place = |(k, shape)| {
        let spare = (cell - side).max(0.0) * rng.random::<f64>();
        let x = from + (k % columns) as f64 * cell + side / 2.0 + spare;
        let y = ((k / columns) as f64 + 0.5) * side;
        upright(shape, [x, y])
    };
    shapes.into_iter().enumerate().map(place).collect()
}

/// Stones side by side, each in a cell of its own; those that find no room are left out.
fn in_one_row(
    mut shapes: Vec<StoneShape>,
    [from, to]: [f64; 2],
    rng: &mut impl Rng,
    height: impl Fn(&StoneShape, f64) -> f64,
) -> Vec<PlacedStone> {
    let side = square(&shapes);
    shapes.truncate(libm::floor((to - from) / side.max(f64::MIN_POSITIVE)) as usize);
    let cell = (to - from) / shapes.len().max(1) as f64;
    let place = |(k, shape): (usize, StoneShape)| {
        let x = from + k as f64 * cell + side / 2.0 + (cell - side) * rng.random::<f64>();
        let y = height(&shape, x);
        upright(shape, [x, y])
    };
    shapes.into_iter().enumerate().map(place).collect()
}

/// A world in which stones fall and come to rest.
struct Scratch<'a> {
    world: PhysicsWorld,
    recipe: &'a BedRecipe,
    bodies: Vec<(RigidBodyHandle, StoneShape)>,
}

impl<'a> Scratch<'a> {
    fn new(recipe: &'a BedRecipe) -> Self {
        let rate = SampleRate::new(RATE).expect("a whole number of hertz");
        let integration_parameters = IntegrationParameters {
            num_solver_iterations: SUBSTEPS,
            normalized_prediction_distance: PREDICTION / engine::LENGTH_UNIT,
            ..engine::parameters(rate)
        };
        let world = PhysicsWorld {
            integration_parameters,
            ..PhysicsWorld::default()
        };
        Self {
            world,
            recipe,
            bodies: Vec::new(),
        }
    }

    /// Stands a smooth wall across the track at `position` [m].
    fn wall(&mut self, position: f64) {
        let [foot, head] = [-2.0, 10.0].map(|y| Vector::new(position, y));
        let wall = ColliderBuilder::segment(foot, head)
            .friction(0.0)
            .friction_combine_rule(CoefficientCombineRule::Min)
            .collision_groups(groups::GROUND);
        self.world.insert_collider(wall, None);
    }

    fn insert(&mut self, stone: &PlacedStone) {
        let kind = RigidBodyType::Dynamic;
        let handle = self.recipe.insert(&mut self.world, stone, kind);
        let body = &mut self.world.bodies[handle];
        body.set_linear_damping(DAMPING);
        body.set_angular_damping(DAMPING);
        self.bodies.push((handle, stone.shape.clone()));
    }

    /// Lets stones fall from just above those already there and the floor.
    fn drop(&mut self, stones: Vec<PlacedStone>) {
        let floor = self.world.colliders.iter();
        let floor = floor.filter(|(_, collider)| collider.shape().as_polyline().is_some());
        let floor = floor.map(|(_, collider)| collider.compute_aabb().maxs.y);
        let top = self
            .stones()
            .map(|stone| stone.top())
            .fold(floor.fold(f64::NEG_INFINITY, f64::max), f64::max);
        for mut stone in stones {
            stone.position[1] += top;
            self.insert(&stone);
        }
    }

    /// Waits until the stones rest, or [`PATIENCE`] is over.
    fn settle(&mut self) {
        let mut before: Vec<PlacedStone> = self.stones().collect();
        for _ in 0..libm::round(PATIENCE / LOOK) as usize {
            let steps = libm::round(LOOK / self.world.integration_parameters.dt) as usize;
            for _ in 0..steps {
                self.world.step();
            }
            let now: Vec<PlacedStone> = self.stones().collect();
            let moved = before.iter().zip(&now).map(|(a, b)| a.distance(b));
            if moved.fold(0.0, f64::max) < REST {
                break;
            }
            before = now;
        }
    }

    /// Gives every stone a knock, so that those that stand on a corner fall over here and not
    /// under the wheel, and goes on without damping as precisely as a run does.
    fn tap(&mut self, rng: &mut impl Rng) {
        let rate = SampleRate::new(TAPPED_RATE).expect("a whole number of hertz");
        self.world.integration_parameters = engine::parameters(rate);
        for (handle, shape) in &self.bodies {
            let mut knock = || TAP * (2.0 * rng.random::<f64>() - 1.0);
            let [along, up, around] = [knock(), knock(), knock() / shape.outer_radius()];
            let body = &mut self.world.bodies[*handle];
            body.set_linear_damping(0.0);
            body.set_angular_damping(0.0);
            body.set_linvel(Vector::new(along, up), true);
            body.set_angvel(around, true);
        }
    }

    /// Takes away stones that rise above the datum by more than a third of the largest size.
    fn rake(&mut self) {
        let limit = self.recipe.stones.size.max / 3.0;
        let high: Vec<bool> = self.stones().map(|stone| stone.top() > limit).collect();
        let bodies = std::mem::take(&mut self.bodies);
        for ((handle, shape), high) in bodies.into_iter().zip(high) {
            if high {
                self.world.remove_body(handle);
            } else {
                self.bodies.push((handle, shape));
            }
        }
    }

    fn stones(&self) -> impl Iterator<Item = PlacedStone> {
        self.bodies.iter().map(|(handle, shape)| {
            let pose = self.world.bodies[*handle].position();
            PlacedStone {
                shape: shape.clone(),
                position: [pose.translation.x, pose.translation.y],
                rotation: [pose.rotation.re, pose.rotation.im],
            }
        })
    }
}
