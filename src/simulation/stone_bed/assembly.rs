//! Stones that touch each other, fixed surfaces and the wheel, and move.
//!
//! Explicit steps of Newton's and Euler's equations:
//!
//! ```text
//! v' = v + F/m Δt,   x' = x + v' Δt,   L' = L + M Δt,   ω' = R J⁻¹ Rᵀ L',   q' = q + ½ ω' q Δt
//! ```
//!
//! Most stones under a wheel bear the same load for many steps. A stone that has not moved faster than [`STILL`] for [`WINDOW`] steps
//! at the lowest rate rests: it stands still, and what it and other resting stones do to each other is not computed, until the load of
//! its moving neighbours and of the wheel on it has changed by [`DISTURBED`] of the wheel's load. The contacts would have given by some
//! tenths of a micrometre.
//!
//! Across the track the assembly repeats itself: it is a strip of a bed without sides. The wheel is as wide as all of them.

use super::contact_law::{ContactLaw, Touch};
use super::near::{Near, OnStone, OnSurface, OnWheel};
use super::surface::Surface;
use crate::simulation::contact::{Part, WheelGeometry};
use crate::simulation::motion::{WheelMotion, Wrench};
use crate::terrain::Stones;
use crate::terrain::stones::{BALL, BALLS, PlacedStone};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Stiffness [-] that holds a wedged stone over that of one of its contacts: some eight contacts, that also hold it sideways (1.8)
/// and against turning (1.75).
const WEDGED: f64 = 25.0;
/// Margin [-] of the rate of steps over that at which the stiffest oscillation becomes unstable.
const MARGIN: f64 = 1.1;

/// Speed [m/s] below which stones come to rest.
const STILL: f64 = 2.0e-4;
/// Steps, at the lowest [rate](Assembly::rate), for which they have to stay below it: some periods of a stone on its contacts.
const WINDOW: f64 = 32.0;
/// Change of load [-], over the wheel's load, that moves a resting stone.
const DISTURBED: f64 = 0.004;

/// What all stones of an assembly have in common.
#[derive(Debug, Clone, Copy)]
pub struct Medium {
    /// Law of contacts between stones, and with floors.
    pub law: ContactLaw,
    /// Gravity along the track and away from it [m/s²].
    pub gravity: [f64; 2],
    /// Density of the stones [kg/m³].
    pub density: f64,
    /// Drag [1/s] on motion and spin.
    pub drag: f64,
    /// Width [m] after which the assembly repeats itself.
    pub width: f64,
    /// Distance [m] within which contacts are listed: what stones move in many steps.
    pub skin: f64,
    /// Whether stones move in the plane of travel only.
    pub planar: bool,
    /// Load [N] of the wheel; 0 where stones never rest.
    pub load: f64,
    /// Lowest rate [Hz] of steps.
    pub rate: f64,
}

/// A force and its moment about a stone's centroid.
#[derive(Debug, Clone, Copy, Default)]
pub struct Load {
    /// Force [N].
    pub force: Vector3<f64>,
    /// Moment [N·m].
    pub moment: Vector3<f64>,
}

/// A sphere of a stone where it is now.
#[derive(Debug, Clone, Copy, Default)]
pub struct BallNow {
    /// From the stone's centroid [m].
    pub arm: Vector3<f64>,
    /// In the track's frame [m].
    pub centre: Vector3<f64>,
    /// Radius [m].
    pub radius: f64,
}

/// A stone and its motion.
#[derive(Debug, Clone)]
pub struct Stone {
    /// Its own number.
    pub id: u64,
    /// Where it lies.
    pub placed: PlacedStone,
    /// Its spheres.
    pub balls: [BallNow; BALLS],
    /// Velocity of the centroid [m/s].
    pub velocity: Vector3<f64>,
    /// Angular velocity [rad/s].
    pub spin: Vector3<f64>,
    /// Distance [m] from the centroid to the farthest point.
    pub outer_radius: f64,
    /// Mass [kg].
    pub mass: f64,
    /// What presses on it from elsewhere.
    pub outside: Load,
    /// Whether the wheel is near enough to move it.
    pub free: bool,
    /// Whether it rests.
    pub resting: bool,
    /// Its highest speed [m/s] in this window.
    peak: f64,
    /// Of a resting stone: the load of its moving neighbours when it came to rest.
    borne: Load,
    /// Of a resting stone: by how much the load has changed since.
    change: Load,
    rotation: Matrix3<f64>,
    inverse_inertia: Matrix3<f64>,
    angular_momentum: Vector3<f64>,
    load: Load,
}

/// Stones, surfaces, and where they are near each other.
pub struct Assembly {
    medium: Medium,
    stones: Vec<Stone>,
    surfaces: Vec<Surface>,
    near: Near,
    next_id: u64,
    /// Places of the stones that move.
    moving: Vec<usize>,
    /// Places of the resting stones that bear one that moves, or the wheel.
    bearing: Vec<usize>,
    /// Time [s] left of this window.
    window: f64,
    /// Whether others move or rest than at the last step.
    changed: bool,
}

/// The wheel among the stones during a step.
pub struct WheelNow<'a> {
    /// Its geometry.
    pub geometry: &'a WheelGeometry,
    /// Motion of its rim's centre.
    pub motion: WheelMotion,
    /// Law of its contacts with stones.
    pub law: ContactLaw,
}

impl Stone {
    fn new(id: u64, placed: PlacedStone, medium: &Medium, free: bool) -> Self {
        let mass = medium.density * placed.shape.volume();
        let mut stone = Self {
            id,
            balls: placed.shape.balls.map(|ball| BallNow {
                radius: ball.radius,
                ..BallNow::default()
            }),
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
            outer_radius: placed.shape.outer_radius(),
            mass,
            outside: Load::default(),
            free,
            resting: false,
            peak: 0.0,
            borne: Load::default(),
            change: Load::default(),
            rotation: Matrix3::identity(),
            inverse_inertia: placed.shape.inverse_inertia / mass,
            angular_momentum: Vector3::zeros(),
            load: Load::default(),
            placed,
        };
        stone.turn();
        stone
    }

    /// Position [m] along the track.
    pub fn x(&self) -> f64 {
        self.placed.position.x
    }

    /// Brings the spheres to where the stone is now.
    fn turn(&mut self) {
        self.rotation = self.placed.rotation.to_rotation_matrix().into_inner();
        for (now, ball) in self.balls.iter_mut().zip(&self.placed.shape.balls) {
            now.arm = turned(&self.rotation, &ball.centre);
            now.centre = self.placed.position + now.arm;
        }
    }

    /// Whether it moves now.
    pub fn moves(&self) -> bool {
        self.free && !self.resting
    }

    /// Comes to rest.
    fn rest(&mut self) {
        self.stop();
        self.resting = true;
        self.change = Load::default();
    }

    /// Starts to move again.
    fn wake(&mut self) {
        self.resting = false;
        self.peak = f64::INFINITY;
    }

    fn stop(&mut self) {
        self.velocity = Vector3::zeros();
        self.spin = Vector3::zeros();
        self.angular_momentum = Vector3::zeros();
    }

    /// Bound [m/s] on the speed of its points.
    pub fn fastest(&self) -> f64 {
        self.velocity.norm() + self.spin.norm() * self.outer_radius
    }

    #[inline]
    fn velocity_at(&self, arm: &Vector3<f64>) -> Vector3<f64> {
        self.velocity + self.spin.cross(arm)
    }

    #[inline]
    fn press(&mut self, force: &Vector3<f64>, arm: &Vector3<f64>) {
        self.load.force += force;
        self.load.moment += arm.cross(force);
    }

    fn integrate(&mut self, medium: &Medium, dt: f64) {
        let slowed = 1.0 / (1.0 + medium.drag * dt);
        self.velocity = (self.velocity + self.load.force * (dt / self.mass)) * slowed;
        self.angular_momentum = (self.angular_momentum + self.load.moment * dt) * slowed;
        if medium.planar {
            self.velocity.z = 0.0;
            self.angular_momentum.x = 0.0;
            self.angular_momentum.y = 0.0;
        }
        self.placed.position += self.velocity * dt;
        let local = turned_back(&self.rotation, &self.angular_momentum);
        self.spin = turned(&self.rotation, &turned(&self.inverse_inertia, &local));
        if medium.planar {
            self.spin.x = 0.0;
            self.spin.y = 0.0;
        }
        let spin = Quaternion::from_imag(self.spin * (0.5 * dt));
        let rotation = self.placed.rotation.quaternion();
        self.placed.rotation = UnitQuaternion::new_normalize(rotation + spin * rotation);
        self.turn();
        self.peak = self.peak.max(self.fastest());
    }
}

/// `matrix * vector`, without the call that nalgebra makes of it.
#[inline]
fn turned(matrix: &Matrix3<f64>, vector: &Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = [vector.x, vector.y, vector.z];
    let row = |i: usize| matrix[(i, 0)] * x + matrix[(i, 1)] * y + matrix[(i, 2)] * z;
    Vector3::new(row(0), row(1), row(2))
}

/// The transposed `matrix * vector`.
#[inline]
fn turned_back(matrix: &Matrix3<f64>, vector: &Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = [vector.x, vector.y, vector.z];
    let column = |j: usize| matrix[(0, j)] * x + matrix[(1, j)] * y + matrix[(2, j)] * z;
    Vector3::new(column(0), column(1), column(2))
}

impl Load {
    /// Whether it is more than `force` [N] at a `distance` [m].
    fn exceeds(&self, force: f64, distance: f64) -> bool {
        let lever = force * distance;
        self.force.norm_squared() > force * force || self.moment.norm_squared() > lever * lever
    }
}

impl std::ops::Sub for Load {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            force: self.force - other.force,
            moment: self.moment - other.moment,
        }
    }
}

impl Assembly {
    /// No stones yet, among `surfaces`.
    pub fn new(medium: Medium, surfaces: Vec<Surface>) -> Self {
        Self {
            medium,
            stones: Vec::new(),
            surfaces,
            near: Near::within(medium.skin),
            next_id: 0,
            moving: Vec::new(),
            bearing: Vec::new(),
            window: WINDOW / medium.rate,
            changed: true,
        }
    }

    /// Rate [Hz] at which contacts of `stones` under `load` [N] can be integrated.
    ///
    /// Explicit steps of an oscillator of angular frequency ω and damping ratio ζ are stable up to `ω Δt = 2 (√(1 + ζ²) - ζ)`;
    /// that of a contact is Tsuji's β. It is the smallest stone's.
    pub fn rate(stones: &Stones, law: &ContactLaw, load: f64) -> f64 {
        let smallest = stones.size.min;
        let mass = stones.density * std::f64::consts::PI / 6.0 * smallest * smallest * smallest;
        let stiffness = law.stiffness(0.5 * BALL * smallest, load);
        let ratio = law.damping_ratio();
        let limit = 2.0 * ((1.0 + ratio * ratio).sqrt() - ratio);
        MARGIN * (WEDGED * stiffness / mass).sqrt() / limit
    }

    /// The stones.
    pub fn stones(&self) -> &[Stone] {
        &self.stones
    }

    /// The stones, to be pushed or freed.
    pub fn stones_mut(&mut self) -> &mut [Stone] {
        &mut self.stones
    }

    /// The surfaces.
    pub fn surfaces_mut(&mut self) -> &mut [Surface] {
        &mut self.surfaces
    }

    /// Another medium from now on: no stone rests in it yet.
    pub fn set_medium(&mut self, medium: Medium) {
        self.medium = medium;
        self.stones.iter_mut().for_each(Stone::wake);
        self.changed = true;
    }

    /// Forgets how far contacts have slipped.
    pub fn forget_slips(&mut self) {
        self.near.clear();
        self.stones.iter_mut().for_each(Stone::wake);
    }

    /// What all stones have in common.
    pub fn medium(&self) -> &Medium {
        &self.medium
    }

    /// Adds a stone at rest.
    pub fn insert(&mut self, placed: PlacedStone, free: bool) {
        let stone = Stone::new(self.next_id, placed, &self.medium, free);
        self.next_id += 1;
        self.stones.push(stone);
        self.near.forget_places();
    }

    /// Keeps the stones that `kept` names.
    pub fn retain(&mut self, kept: impl FnMut(&Stone) -> bool) {
        // Pairs go by places in the list: what they know of slips is put aside first.
        self.near.put_aside(&self.stones);
        self.stones.retain(kept);
    }

    /// Frees or freezes a stone.
    pub fn set_free(&mut self, index: usize, free: bool) {
        let stone = &mut self.stones[index];
        if stone.free != free {
            stone.free = free;
            stone.stop();
            stone.wake();
            self.near.forget_places();
        }
    }

    /// Advances by `dt` [s]; adds the load on every part of the `wheel` to `loads`.
    pub fn step(&mut self, dt: f64, wheel: Option<&WheelNow<'_>>, loads: &mut WheelLoads) {
        let renewed = self.near.follow(
            &self.stones,
            &mut self.surfaces,
            self.medium.width,
            wheel,
            dt,
        );
        let changed = renewed || std::mem::take(&mut self.changed);
        if changed {
            self.near.part(&self.stones);
            self.list_stones();
        }
        self.load_from_outside();
        self.press_each_other(dt);
        self.press_on_surfaces(dt);
        if let Some(wheel) = wheel {
            self.press_on_wheel(wheel, dt, loads);
        }
        if changed {
            self.bear_as_before();
        }
        for &index in &self.moving {
            self.stones[index].integrate(&self.medium, dt);
        }
        if self.medium.load > 0.0 {
            self.wake_and_rest(dt);
        }
    }

    /// Lists the stones that move, and the resting ones that bear one that moves, or the wheel.
    fn list_stones(&mut self) {
        let pairs = self.near.moving().iter().flat_map(|pair| pair.stones);
        let on_wheel = self.near.on_wheel.iter().map(|pair| pair.stone);
        let mut touched = vec![false; self.stones.len()];
        pairs
            .chain(on_wheel)
            .for_each(|index| touched[index] = true);
        self.moving.clear();
        self.bearing.clear();
        for (index, stone) in self.stones.iter_mut().enumerate() {
            if stone.moves() {
                self.moving.push(index);
            } else if stone.resting && touched[index] {
                self.bearing.push(index);
            } else {
                stone.load = Load::default();
            }
        }
    }

    /// Starts every stone's load: weight and what presses from outside. Of resting stones only what neighbours add counts.
    fn load_from_outside(&mut self) {
        let [along, up] = self.medium.gravity;
        let gravity = Vector3::new(along, up, 0.0);
        for &index in &self.moving {
            let stone = &mut self.stones[index];
            stone.load = stone.outside;
            stone.load.force += gravity * stone.mass;
        }
        for &index in &self.bearing {
            self.stones[index].load = Load::default();
        }
    }

    /// Takes the load of those that move now for the one that resting stones bear, but for the change so far.
    fn bear_as_before(&mut self) {
        for stone in self.stones.iter_mut().filter(|stone| stone.resting) {
            stone.borne = stone.load - stone.change;
        }
    }

    fn wake_and_rest(&mut self, dt: f64) {
        for &index in &self.bearing {
            let stone = &mut self.stones[index];
            stone.change = stone.load - stone.borne;
            let bearable = DISTURBED * self.medium.load;
            if stone.change.exceeds(bearable, stone.outer_radius) {
                stone.wake();
                self.changed = true;
            }
        }
        self.window -= dt;
        if self.window > 0.0 {
            return;
        }
        self.window = WINDOW / self.medium.rate;
        for &index in &self.moving {
            let stone = &mut self.stones[index];
            if stone.peak < STILL {
                stone.rest();
                self.changed = true;
            }
            stone.peak = 0.0;
        }
    }

    fn press_each_other(&mut self, dt: f64) {
        for pair in self.near.moving_mut() {
            let OnStone {
                stones: [i, j],
                balls: [a, b],
                shift,
                ..
            } = *pair;
            let (first, second) = (&self.stones[i], &self.stones[j]);
            let (one, other) = (&first.balls[a], &second.balls[b]);
            let mut apart = one.centre - other.centre;
            apart.z -= shift;
            let (square, reach) = (apart.norm_squared(), one.radius + other.radius);
            if square >= reach * reach {
                pair.slip = Vector3::zeros();
                continue;
            }
            let distance = square.sqrt();
            let (normal, overlap) = (apart / distance, reach - distance);
            let arm = one.arm - normal * (one.radius - 0.5 * overlap);
            let other_arm = other.arm + normal * (other.radius - 0.5 * overlap);
            let touch = Touch {
                normal,
                overlap,
                radius: pair.radius,
                mass: pair.mass,
                velocity: first.velocity_at(&arm) - second.velocity_at(&other_arm),
            };
            let force = self.medium.law.force(&touch, &mut pair.slip, dt);
            self.stones[i].press(&force, &arm);
            self.stones[j].press(&-force, &other_arm);
        }
    }

    fn press_on_surfaces(&mut self, dt: f64) {
        for pair in &mut self.near.on_surfaces {
            let OnSurface {
                stone,
                ball,
                surface,
                ..
            } = *pair;
            let stone = &mut self.stones[stone];
            if stone.resting {
                continue;
            }
            let BallNow {
                arm,
                centre,
                radius,
            } = stone.balls[ball];
            let surface = &self.surfaces[surface];
            let Some(nearest) = surface.nearest(&centre, radius) else {
                pair.slip = Vector3::zeros();
                continue;
            };
            let law = if surface.is_smooth() {
                self.medium.law.with_friction(0.0)
            } else {
                self.medium.law
            };
            let arm = arm - nearest.normal * nearest.distance;
            let touch = Touch {
                normal: nearest.normal,
                overlap: radius - nearest.distance,
                radius,
                mass: stone.mass,
                velocity: stone.velocity_at(&arm),
            };
            let force = law.force(&touch, &mut pair.slip, dt);
            stone.press(&force, &arm);
        }
    }

    fn press_on_wheel(&mut self, wheel: &WheelNow<'_>, dt: f64, loads: &mut WheelLoads) {
        let motion = &wheel.motion;
        for pair in &mut self.near.on_wheel {
            let OnWheel {
                stone, ball, part, ..
            } = *pair;
            let stone = &mut self.stones[stone];
            let BallNow {
                arm,
                centre,
                radius,
            } = stone.balls[ball];
            let gap = wheel
                .geometry
                .placed(part, motion)
                .gap([centre.x, centre.y]);
            if gap.distance >= radius {
                pair.slip = Vector3::zeros();
                continue;
            }
            let normal = Vector3::new(gap.normal[0], gap.normal[1], 0.0);
            let arm = arm - normal * gap.distance;
            let from_axle = [
                centre.x - normal.x * gap.distance - motion.x,
                centre.y - normal.y * gap.distance - motion.y,
            ];
            let there = motion.at(from_axle);
            let wheel_velocity = Vector3::new(there.vx, there.vy, 0.0);
            let touch = Touch {
                normal,
                overlap: radius - gap.distance,
                radius,
                mass: stone.mass,
                velocity: stone.velocity_at(&arm) - wheel_velocity,
            };
            let force = wheel.law.force(&touch, &mut pair.slip, dt);
            stone.press(&force, &arm);
            loads.add(part, from_axle, -force);
        }
    }
}

/// Loads of stones on the wheel, summed over steps.
#[derive(Debug, Clone, Default)]
pub struct WheelLoads {
    /// On the whole wheel, about its rim's centre.
    sum: Wrench,
    /// On each lug.
    lugs: Vec<Wrench>,
}

impl WheelLoads {
    /// Adds a `force` [N] on a part at `arm` [m] from the rim's centre.
    fn add(&mut self, part: Part, arm: [f64; 2], force: Vector3<f64>) {
        let load = Wrench {
            fx: force.x,
            fy: force.y,
            torque: 0.0,
        }
        .acting_at(arm);
        self.sum += load;
        if let Part::Lug(lug) = part {
            if self.lugs.len() <= lug {
                self.lugs.resize(lug + 1, Wrench::default());
            }
            self.lugs[lug] += load;
        }
    }

    /// Means over `steps` steps: the load, and the lugs that carry more than `touch_force` [N], one bit each.
    pub fn mean(&self, steps: usize, touch_force: f64) -> (Wrench, u64) {
        let share = 1.0 / steps as f64;
        let touching = self.lugs.iter().enumerate();
        let touching = touching.filter(|(_, load)| load.force() * share > touch_force);
        let wrench = Wrench {
            fx: self.sum.fx * share,
            fy: self.sum.fy * share,
            torque: self.sum.torque * share,
        };
        (wrench, touching.fold(0, |bits, (lug, _)| bits | 1 << lug))
    }
}
