//! Where stones are near each other, a surface or the wheel, and how far they have slipped there.
//!
//! Everything within a skin is listed, and the lists are renewed once something has moved by a share of it. Slips go by the numbers
//! of stones, not by places in lists, from one list to the next.

use super::assembly::{Stone, WheelNow};
use super::surface::Surface;
use crate::simulation::contact::Part;
use crate::simulation::motion::WheelMotion;
use crate::terrain::stones::{BALLS, Place};
use nalgebra::Vector3;
use std::collections::HashMap;

/// Movement [-], over the skin, of one side at which lists are renewed: two sides' together stay below the skin.
const MOVED: f64 = 0.35;
/// Movement [-], over the skin, of the fastest stone between two checks of the movement.
const BETWEEN: f64 = 0.1;
/// Maximum number of steps between two checks.
const LONGEST: u32 = 16;

/// Two spheres of two stones.
#[derive(Debug, Clone)]
pub struct OnStone {
    pub stones: [usize; 2],
    pub balls: [usize; 2],
    /// Which image of the second it is, and how far [m] that lies across the track.
    pub image: i32,
    pub shift: f64,
    /// Effective radius [m] and mass [kg].
    pub radius: f64,
    pub mass: f64,
    pub slip: Vector3<f64>,
}

/// A sphere of a stone, and a surface.
#[derive(Debug, Clone)]
pub struct OnSurface {
    pub stone: usize,
    pub ball: usize,
    pub surface: usize,
    pub slip: Vector3<f64>,
}

/// A sphere of a stone, and a part of the wheel.
#[derive(Debug, Clone)]
pub struct OnWheel {
    pub stone: usize,
    pub ball: usize,
    pub part: Part,
    pub slip: Vector3<f64>,
}

/// What a sphere touches, whatever its place in a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Other {
    /// A sphere, and which of its images across the track.
    Ball(u64, i32),
    Surface(usize),
    Part(Part),
}

/// A contact, whatever its place in a list.
type Key = (u64, Other);

/// The lists.
pub struct Near {
    /// Distance [m] within which contacts are listed.
    skin: f64,
    /// Pairs of which one moves come first.
    on_stones: Vec<OnStone>,
    /// How many those are.
    moving: usize,
    pub on_surfaces: Vec<OnSurface>,
    pub on_wheel: Vec<OnWheel>,
    slips: HashMap<Key, Vector3<f64>>,
    /// Where the stones were when the lists were made.
    places: Vec<Place>,
    wheel: Option<WheelMotion>,
    /// Steps until the next check.
    steps: u32,
}

fn ball_id(stone: &Stone, ball: usize) -> u64 {
    stone.id * BALLS as u64 + ball as u64
}

impl Near {
    /// Lists of what is within a `skin` [m].
    pub fn within(skin: f64) -> Self {
        Self {
            skin,
            on_stones: Vec::new(),
            moving: 0,
            on_surfaces: Vec::new(),
            on_wheel: Vec::new(),
            slips: HashMap::new(),
            places: Vec::new(),
            wheel: None,
            steps: 0,
        }
    }

    /// Has the lists made anew at the next step.
    pub fn forget_places(&mut self) {
        self.places.clear();
    }

    /// Forgets lists and slips.
    pub fn clear(&mut self) {
        *self = Self::within(self.skin);
    }

    /// Puts slips aside and forgets the lists; `stones` are those that the lists are of.
    pub fn put_aside(&mut self, stones: &[Stone]) {
        let slipped = |slip: &Vector3<f64>| *slip != Vector3::zeros();
        for pair in self.on_stones.drain(..).filter(|pair| slipped(&pair.slip)) {
            let [one, other] = [0, 1].map(|k| ball_id(&stones[pair.stones[k]], pair.balls[k]));
            self.slips
                .insert((one, Other::Ball(other, pair.image)), pair.slip);
        }
        for pair in self
            .on_surfaces
            .drain(..)
            .filter(|pair| slipped(&pair.slip))
        {
            let ball = ball_id(&stones[pair.stone], pair.ball);
            self.slips
                .insert((ball, Other::Surface(pair.surface)), pair.slip);
        }
        for pair in self.on_wheel.drain(..).filter(|pair| slipped(&pair.slip)) {
            let ball = ball_id(&stones[pair.stone], pair.ball);
            self.slips.insert((ball, Other::Part(pair.part)), pair.slip);
        }
        self.forget_places();
    }

    /// Pairs of stones of which one moves.
    pub fn moving(&self) -> &[OnStone] {
        &self.on_stones[..self.moving]
    }

    /// The same, whose slips may change.
    pub fn moving_mut(&mut self) -> &mut [OnStone] {
        &mut self.on_stones[..self.moving]
    }

    /// Puts pairs first of which one moves.
    pub fn part(&mut self, stones: &[Stone]) {
        let moves = |pair: &OnStone| pair.stones.iter().any(|index| stones[*index].moves());
        self.on_stones.sort_by_key(|pair| !moves(pair));
        self.moving = self.on_stones.partition_point(moves);
    }

    /// Makes the lists anew where something has moved; returns whether it did. Call it at every step.
    pub fn follow(
        &mut self,
        stones: &[Stone],
        surfaces: &mut [Surface],
        width: f64,
        wheel: Option<&WheelNow<'_>>,
        dt: f64,
    ) -> bool {
        if self.places.len() == stones.len() && self.wheel.is_some() == wheel.is_some() {
            if self.steps > 0 {
                self.steps -= 1;
                return false;
            }
            self.steps = self.steps_to_look(stones, dt);
            if !self.has_moved(stones, wheel) {
                return false;
            }
        }
        self.put_aside(stones);
        self.list_stones(stones, width);
        self.list_surfaces(stones, surfaces);
        if let Some(wheel) = wheel {
            self.list_wheel(stones, wheel);
        }
        self.slips.clear();
        self.places = stones.iter().map(|stone| stone.placed.place()).collect();
        self.wheel = wheel.map(|wheel| wheel.motion);
        self.steps = 0;
        true
    }

    fn steps_to_look(&self, stones: &[Stone], dt: f64) -> u32 {
        let fastest = stones.iter().map(Stone::fastest).fold(0.0, f64::max);
        let steps = BETWEEN * self.skin / (fastest * dt).max(f64::MIN_POSITIVE);
        steps.min(f64::from(LONGEST)) as u32
    }

    fn has_moved(&self, stones: &[Stone], wheel: Option<&WheelNow<'_>>) -> bool {
        let moved_far = MOVED * self.skin;
        let moved = |(stone, place): (&Stone, &Place)| {
            stone.placed.place().distance(place, stone.outer_radius) > moved_far
        };
        let wheel_moved = |(wheel, then): (&WheelNow<'_>, &WheelMotion)| {
            let now = &wheel.motion;
            let way = (now.x - then.x).abs() + (now.y - then.y).abs();
            way + wheel.geometry.reach * (now.angle - then.angle).abs() > moved_far
        };
        wheel.zip(self.wheel.as_ref()).is_some_and(wheel_moved)
            || stones
                .iter()
                .zip(&self.places)
                .any(|pair| pair.0.free && moved(pair))
    }

    fn slip(&self, key: Key) -> Vector3<f64> {
        self.slips.get(&key).copied().unwrap_or_default()
    }

    fn list_stones(&mut self, stones: &[Stone], width: f64) {
        let mut order: Vec<usize> = (0..stones.len()).collect();
        order.sort_by(|a, b| stones[*a].x().total_cmp(&stones[*b].x()));
        let largest = stones
            .iter()
            .map(|stone| stone.outer_radius)
            .fold(0.0, f64::max);
        for (place, &i) in order.iter().enumerate() {
            let first = &stones[i];
            for &j in &order[place + 1..] {
                let second = &stones[j];
                if second.x() - first.x() > first.outer_radius + largest + self.skin {
                    break;
                }
                if first.free || second.free {
                    let pair = if i < j { [i, j] } else { [j, i] };
                    self.list_pair(stones, pair, width);
                }
            }
        }
    }

    /// Lists two stones with every image of the second that is near: on a narrow strip there may be two.
    fn list_pair(&mut self, stones: &[Stone], pair: [usize; 2], width: f64) {
        let [first, second] = pair.map(|index| &stones[index]);
        let apart = first.placed.position - second.placed.position;
        let reach = first.outer_radius + second.outer_radius + self.skin;
        let aside = reach * reach - apart.x * apart.x - apart.y * apart.y;
        if aside <= 0.0 {
            return;
        }
        let aside = aside.sqrt();
        let least = libm::ceil((apart.z - aside) / width) as i32;
        let most = libm::floor((apart.z + aside) / width) as i32;
        for image in least..=most {
            self.list_image(stones, pair, image, f64::from(image) * width);
        }
    }

    fn list_image(&mut self, stones: &[Stone], pair: [usize; 2], image: i32, shift: f64) {
        let [first, second] = pair.map(|index| &stones[index]);
        for (a, one) in first.balls.iter().enumerate() {
            for (b, other) in second.balls.iter().enumerate() {
                let mut apart = one.centre - other.centre;
                apart.z -= shift;
                let reach = one.radius + other.radius + self.skin;
                if apart.norm_squared() > reach * reach {
                    continue;
                }
                let other_id = Other::Ball(ball_id(second, b), image);
                self.on_stones.push(OnStone {
                    stones: pair,
                    balls: [a, b],
                    image,
                    shift,
                    radius: one.radius * other.radius / (one.radius + other.radius),
                    mass: first.mass * second.mass / (first.mass + second.mass),
                    slip: self.slip((ball_id(first, a), other_id)),
                });
            }
        }
    }

    fn list_surfaces(&mut self, stones: &[Stone], surfaces: &mut [Surface]) {
        for (index, stone) in stones.iter().enumerate().filter(|(_, stone)| stone.free) {
            for (surface, shape) in surfaces.iter_mut().enumerate() {
                let margin = stone.outer_radius + self.skin;
                shape.extend([stone.x() - margin, stone.x() + margin]);
                for (ball, now) in stone.balls.iter().enumerate() {
                    if shape.nearest(&now.centre, now.radius + self.skin).is_none() {
                        continue;
                    }
                    let key = (ball_id(stone, ball), Other::Surface(surface));
                    self.on_surfaces.push(OnSurface {
                        stone: index,
                        ball,
                        surface,
                        slip: self.slip(key),
                    });
                }
            }
        }
    }

    fn list_wheel(&mut self, stones: &[Stone], wheel: &WheelNow<'_>) {
        let (geometry, motion) = (wheel.geometry, &wheel.motion);
        for (index, stone) in stones.iter().enumerate().filter(|(_, stone)| stone.free) {
            let reach = geometry.reach + stone.outer_radius + self.skin;
            let [dx, dy] = [stone.x() - motion.x, stone.placed.position.y - motion.y];
            if dx * dx + dy * dy > reach * reach {
                continue;
            }
            for part in geometry.lowest_parts(motion) {
                let placed = geometry.placed(part, motion);
                for (ball, now) in stone.balls.iter().enumerate() {
                    let gap = placed.gap([now.centre.x, now.centre.y]);
                    if gap.distance > now.radius + self.skin {
                        continue;
                    }
                    let key = (ball_id(stone, ball), Other::Part(part));
                    self.on_wheel.push(OnWheel {
                        stone: index,
                        ball,
                        part,
                        slip: self.slip(key),
                    });
                }
            }
        }
    }
}
