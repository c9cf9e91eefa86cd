//! Pours stones section by section.
//!
//! A section is poured between walls onto a floor, against the stones of the section before, which may still move; those before
//! that are fixed. So a section is final once the next one has been poured, and what lies in it depends on seed, run and index
//! alone.
//!
//! Stones fall with soft contacts, which cost a tenth, and with little friction, which packs them as tamping does; then they come
//! to rest with their own.

use super::assembly::{Assembly, Medium, WheelLoads};
use super::contact_law::ContactLaw;
use super::surface::{Floor, Surface};
use super::{BedRecipe, Laying, SECTION};
use crate::quantity::GRAVITY;
use crate::terrain::stones::{PlacedStone, StoneShape, random_rotation};
use nalgebra::Vector3;
use rand::{Rng, RngExt};

/// Length [m] by which new stones also fall on the section before, whose end slumps when its wall goes, over the depth.
const OVERLAP: f64 = 1.25;
/// Volume [-] of the stones poured over that of the pile, hollows included.
const FILL: f64 = 0.72;
/// Height [-] above the level, over the largest size, from which stones are raked off.
const RAKED: f64 = 0.25;
/// Effective modulus [Pa] of contacts while stones fall.
const SOFT: f64 = 1.0e7;
/// Friction [-] of stones while they fall: it stands for tamping.
const TAMPED: f64 = 0.2;
/// Load [N] on a contact of falling stones, by which their steps are chosen.
const FALLING_LOAD: f64 = 250.0;
/// Load [N] of a wheel by which poured stones count as at rest: a twentieth of a wheel's, some stones' weight.
const RESTING_LOAD: f64 = 5.0;
/// Speed [m/s] below which falling stones have arrived, and of how many one may still be faster.
const SLOW: f64 = 0.05;
const STRAGGLERS: usize = 40;
/// Distance [m] within which contacts of falling stones are listed.
const FALLING_SKIN: f64 = 0.006;
/// By how much [-] contacts harden at once, for how long [s] stones then move, and against which drag [1/s]: they overlap by more
/// than harder contacts bear.
const HARDER: f64 = 4.0;
const HARDENING: f64 = 0.01;
const HARDENING_DRAG: f64 = 400.0;
/// Drag [1/s] on falling stones, and on those that come to rest.
const FALLING_DRAG: f64 = 2.0;
const RESTING_DRAG: f64 = 30.0;
/// Time [s] between two looks whether the stones rest.
const LOOK: f64 = 0.05;
/// Distance [m] that no point of a resting stone moves between two looks.
const REST: f64 = 5.0e-6;
/// Longest time [s] given to the stones to come to rest.
const PATIENCE: f64 = 3.0;

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

    /// Stones of the last section, which the next one may still move.
    #[cfg(test)]
    pub(super) fn loose(&self) -> &[PlacedStone] {
        &self.loose
    }

    /// Pours the next section; returns the stones that are final now.
    pub(super) fn pour(&mut self, recipe: &BedRecipe, floor: &Floor) -> Vec<PlacedStone> {
        let stage = format!("stones of bed {}, section {}", recipe.number, self.index);
        let mut rng = recipe.seed.rng(&stage, recipe.run);
        let range = [self.edge, self.edge + SECTION];
        let stones: Vec<PlacedStone> = match recipe.laying {
            Laying::Pile { depth } => {
                let range = [range[0] - self.overlap(depth), range[1]];
                let volume = FILL * depth * recipe.width() * (range[1] - range[0]);
                let shapes = draw_volume(recipe, volume, &mut rng);
                let mut scratch = self.scratch(recipe, floor);
                scratch.drop(in_layers(shapes, range, recipe.width(), &mut rng));
                scratch.settle(TAMPED);
                scratch.rake();
                scratch.settle(TAMPED);
                scratch.rake();
                scratch.settle(recipe.stones.friction);
                scratch.rest();
                // A stone of the section before may have rolled back a little.
                scratch.clear([self.finished() - SECTION, self.edge + SECTION]);
                scratch.stones()
            }
            Laying::Scattered { per_metre } => {
                let shapes = draw_number(recipe, per_metre * SECTION, &mut rng);
                let mut scratch = self.scratch(recipe, floor);
                let placed = in_layers(shapes, range, recipe.width(), &mut rng);
                scratch.drop(placed);
                scratch.settle(recipe.stones.friction);
                scratch.rest();
                scratch.stones()
            }
            Laying::Embedded {
                per_metre,
                embedding,
            } => {
                let shapes = draw_number(recipe, per_metre * SECTION, &mut rng);
                let mut stones = std::mem::take(&mut self.loose);
                stones.extend(in_one_row(shapes, range, &mut rng, |shape, x| {
                    floor(x) + (0.5 - embedding) * shape.diameter
                }));
                stones
            }
        };
        self.advance(stones)
    }

    /// Length [m] by which the next section's stones also fall on the one before, `depth` [m] deep.
    fn overlap(&self, depth: f64) -> f64 {
        if self.index == 0 {
            0.0
        } else {
            OVERLAP * depth
        }
    }

    /// An assembly with floor, walls, and the stones poured so far.
    fn scratch<'a>(&self, recipe: &'a BedRecipe, floor: &Floor) -> Scratch<'a> {
        let [back, end] = [self.finished(), self.edge + SECTION];
        let mut surfaces: Vec<Surface> = recipe.floor(floor).into_iter().collect();
        if self.index <= 1 {
            surfaces.push(Surface::Wall {
                position: back,
                inward: 1.0,
            });
        }
        surfaces.push(Surface::Wall {
            position: end,
            inward: -1.0,
        });
        let medium = Medium {
            skin: FALLING_SKIN,
            load: RESTING_LOAD,
            ..recipe.medium([0.0, -GRAVITY], FALLING_LOAD)
        };
        let mut assembly = Assembly::new(medium, surfaces);
        for stone in &self.fixed {
            assembly.insert(stone.clone(), false);
        }
        for stone in &self.loose {
            assembly.insert(stone.clone(), true);
        }
        Scratch { assembly, recipe }
    }

    /// Parts the stones in final and loose ones and moves on by one section.
    fn advance(&mut self, stones: Vec<PlacedStone>) -> Vec<PlacedStone> {
        let (done, loose): (Vec<_>, Vec<_>) = stones
            .into_iter()
            .partition(|stone| stone.position.x < self.edge);
        self.loose = loose;
        self.fixed.extend(done.iter().cloned());
        let behind = self.edge - SECTION;
        self.fixed.retain(|stone| stone.position.x > behind);
        self.edge += SECTION;
        self.index += 1;
        done
    }
}

/// Stones whose volumes add up to `volume` [m³].
fn draw_volume(recipe: &BedRecipe, mut volume: f64, rng: &mut impl Rng) -> Vec<StoneShape> {
    let mut shapes = Vec::new();
    while volume > 0.0 {
        let shape = recipe.stones.draw(rng);
        volume -= shape.volume();
        shapes.push(shape);
    }
    shapes
}

/// A whole number of stones, `expected` [-] on average.
fn draw_number(recipe: &BedRecipe, expected: f64, rng: &mut impl Rng) -> Vec<StoneShape> {
    let count = libm::floor(expected + rng.random::<f64>()) as usize;
    (0..count).map(|_| recipe.stones.draw(rng)).collect()
}

/// Side [m] of a cube in which each of these stones can turn.
fn cube(shapes: &[StoneShape]) -> f64 {
    let radii = shapes.iter().map(StoneShape::outer_radius);
    2.05 * radii.fold(0.0, f64::max)
}

/// Stones turned at random, in layers of a grid, one above the other, without overlap; the lowest layer stands on height 0.
fn in_layers(
    shapes: Vec<StoneShape>,
    [from, to]: [f64; 2],
    width: f64,
    rng: &mut impl Rng,
) -> Vec<PlacedStone> {
    let side = cube(&shapes);
    let fitting = |length: f64| (libm::floor(length / side) as usize).max(1);
    let (columns, rows) = (fitting(to - from), fitting(width));
    let (cell, lane) = ((to - from) / columns as f64, width / rows as f64);
    let mut somewhere = |room: f64| (room - side).max(0.0) * (rng.random::<f64>() - 0.5);
    let places: Vec<Vector3<f64>> = (0..shapes.len())
        .map(|k| {
            let (column, row, layer) = (k % columns, k / columns % rows, k / (columns * rows));
            Vector3::new(
                from + (column as f64 + 0.5) * cell + somewhere(cell),
                (layer as f64 + 0.5) * side,
                (row as f64 + 0.5) * lane - 0.5 * width + somewhere(lane),
            )
        })
        .collect();
    shapes
        .into_iter()
        .zip(places)
        .map(|(shape, position)| PlacedStone {
            shape,
            position,
            rotation: random_rotation(rng),
        })
        .collect()
}

/// Stones one behind the other, each in a cell of its own and turned at random; those that find no room are left out.
fn in_one_row(
    mut shapes: Vec<StoneShape>,
    [from, to]: [f64; 2],
    rng: &mut impl Rng,
    height: impl Fn(&StoneShape, f64) -> f64,
) -> Vec<PlacedStone> {
    let side = cube(&shapes);
    shapes.truncate(libm::floor((to - from) / side.max(f64::MIN_POSITIVE)) as usize);
    let cell = (to - from) / shapes.len().max(1) as f64;
    let place = |(k, shape): (usize, StoneShape)| {
        let x = from + k as f64 * cell + side / 2.0 + (cell - side) * rng.random::<f64>();
        PlacedStone {
            position: Vector3::new(x, height(&shape, x), 0.0),
            rotation: random_rotation(rng),
            shape,
        }
    };
    shapes.into_iter().enumerate().map(place).collect()
}

/// Stones that fall and come to rest.
struct Scratch<'a> {
    assembly: Assembly,
    recipe: &'a BedRecipe,
}

impl Scratch<'_> {
    /// Lets stones fall from just above those already there and the floor.
    fn drop(&mut self, stones: Vec<PlacedStone>) {
        let ends = stones.iter().map(|stone| stone.position.x);
        let range = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x - 0.1), high.max(x + 0.1)]
        });
        let floors = self.assembly.surfaces_mut().iter_mut();
        let floors: Vec<f64> = floors.filter_map(|floor| floor.highest(range)).collect();
        let tops = self.assembly.stones().iter();
        let tops = tops.map(|stone| stone.placed.top()).chain(floors);
        let top = tops.fold(f64::NEG_INFINITY, f64::max);
        for mut stone in stones {
            stone.position.y += top;
            self.assembly.insert(stone, true);
        }
    }

    /// Lets stones fall with soft contacts of some `friction` [-] until nearly all are slow, or [`PATIENCE`] is
    /// over.
    fn settle(&mut self, friction: f64) {
        let law = ContactLaw::new(SOFT, self.recipe.stones.restitution, friction);
        self.set(law, FALLING_DRAG);
        for _ in 0..libm::round(PATIENCE / LOOK) as usize {
            self.run(LOOK);
            let stones = self.assembly.stones().iter();
            let fast = stones.filter(|stone| stone.fastest() > SLOW).count();
            if fast <= self.assembly.stones().len() / STRAGGLERS {
                break;
            }
        }
    }

    /// Hardens the contacts to those of rock and waits until the stones rest, also without what holds their slips: a bed that
    /// thaws has forgotten them.
    fn rest(&mut self) {
        let stones = &self.recipe.stones;
        let law = |modulus| ContactLaw::new(modulus, stones.restitution, stones.friction);
        let mut modulus = SOFT;
        while modulus < stones.contact_modulus {
            self.set(law(modulus), HARDENING_DRAG);
            self.run(HARDENING);
            modulus *= HARDER;
        }
        self.set(law(stones.contact_modulus), RESTING_DRAG);
        self.wait();
        self.assembly.forget_slips();
        self.wait();
    }

    /// Waits until the stones rest, or [`PATIENCE`] is over.
    fn wait(&mut self) {
        let mut before = self.stones();
        for _ in 0..libm::round(PATIENCE / LOOK) as usize {
            self.run(LOOK);
            let now = self.stones();
            let moved = before.iter().zip(&now).map(|(a, b)| a.distance(b));
            if moved.fold(0.0, f64::max) < REST {
                break;
            }
            before = now;
        }
    }

    /// Contacts and drag [1/s] of the stones from now on.
    fn set(&mut self, law: ContactLaw, drag: f64) {
        let medium = Medium {
            law,
            drag,
            rate: Assembly::rate(&self.recipe.stones, &law, FALLING_LOAD),
            ..*self.assembly.medium()
        };
        self.assembly.set_medium(medium);
    }

    /// Steps the stones for `seconds`.
    fn run(&mut self, seconds: f64) {
        let rate = self.assembly.medium().rate;
        for _ in 0..libm::ceil(seconds * rate) as usize {
            self.assembly
                .step(1.0 / rate, None, &mut WheelLoads::default());
        }
    }

    /// Takes away stones that stick out of the level by too much.
    fn rake(&mut self) {
        let limit = RAKED * self.recipe.stones.size.max;
        self.keep(|stone| stone.top() < limit);
    }

    /// Takes away stones that have left the bed between two places [m]: one pressed into another by more than a ball is shot out
    /// when contacts harden.
    fn clear(&mut self, [from, to]: [f64; 2]) {
        let limit = self.recipe.stones.size.max;
        self.keep(|stone| stone.top() < limit && (from..=to).contains(&stone.position.x));
    }

    /// Keeps the fixed stones, and those of the others that stay.
    fn keep(&mut self, stays: impl Fn(&PlacedStone) -> bool) {
        self.assembly
            .retain(|stone| !stone.free || stays(&stone.placed));
    }

    /// The stones that are not fixed.
    fn stones(&self) -> Vec<PlacedStone> {
        let stones = self.assembly.stones().iter().filter(|stone| stone.free);
        stones.map(|stone| stone.placed.clone()).collect()
    }
}
