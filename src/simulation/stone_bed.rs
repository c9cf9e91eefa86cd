//! A bed of free stones, poured ahead of the wheel and taken up behind it.
//!
//! Only stones within [`REACH`] of the axle are free. Those beyond are frozen where they rest:
//! fixed bodies cost the engine next to nothing. A stone thaws in the pose and against the
//! neighbours it came to rest with.

mod pouring;

use crate::quantity::Seed;
use crate::simulation::engine::groups;
use crate::terrain::Stones;
use crate::terrain::stones::{PlacedStone, extent_at};
use pouring::{Pouring, SECTION};
use rapier2d::prelude::*;
use std::collections::{BTreeMap, VecDeque};

/// Distance [m] along the track from the axle within which stones are free.
pub const REACH: f64 = 0.15;
/// Width [m] of the strip of frozen stones beyond the free ones: they hold the free ones up.
const STRIP: f64 = 0.1;
/// Distance [m] that the axle moves between two looks at which stones are within reach.
const STRIDE: f64 = 1e-3;
/// Distance [m] between the points of an uneven floor.
const FLOOR_STEP: f64 = 0.002;
/// Distance [m] between the points of the surface as poured.
const SURFACE_STEP: f64 = 0.001;
/// Bend [m] of the floor over two steps below which it counts as straight.
const STRAIGHT: f64 = 1e-12;

/// How stones lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Laying {
    /// A raked pile of `depth` [m] on the floor; its surface is near height 0.
    Pile {
        /// Depth [m].
        depth: f64,
    },
    /// Single stones on a hard floor.
    Scattered {
        /// Stones per metre of track [1/m].
        per_metre: f64,
    },
    /// Single stones in the surface of soil, which has to bear them: the floor is no collider.
    Embedded {
        /// Stones per metre of track [1/m]; those that find no room are left out.
        per_metre: f64,
        /// Share [-] of a stone's diameter that lies below the surface.
        embedding: f64,
    },
}

/// All that decides which stone lies where.
#[derive(Debug, Clone)]
pub struct BedRecipe {
    /// The stones.
    pub stones: Stones,
    /// How they lie.
    pub laying: Laying,
    /// Width [m] of the wheel: the depth along the axle of stones in a pile or a layer, see
    /// [`BedRecipe::depth`].
    pub width: f64,
    /// Where the stones' randomness comes from.
    pub seed: Seed,
    /// The run.
    pub run: u64,
    /// Number of the bed among those of the track.
    pub number: usize,
}

impl BedRecipe {
    /// Depth [m] of a stone along the axle.
    ///
    /// Stones of a pile or a layer lie in rows across the wheel's track (see
    /// [`crate::terrain::stones`]). A stone in soil lies alone: it is as deep as its diameter, and
    /// soil bears it on that width only. Its hole and its rut are as wide as the wheel all the same,
    /// so that the soil beside a lone stone bears too little.
    pub fn depth(&self, stone: &PlacedStone) -> f64 {
        match self.laying {
            Laying::Embedded { .. } => stone.shape.diameter().min(self.width),
            Laying::Pile { .. } | Laying::Scattered { .. } => self.width,
        }
    }

    /// Puts a stone into a world.
    pub fn insert(
        &self,
        world: &mut PhysicsWorld,
        stone: &PlacedStone,
        kind: RigidBodyType,
    ) -> RigidBodyHandle {
        let [x, y] = stone.position;
        let [cos, sin] = stone.rotation;
        let rotation = Rotation::from_cos_sin_unchecked(cos, sin);
        let pose = Pose::from_parts(Vector::new(x, y), rotation);
        let corners = stone.shape.corners.iter();
        let corners = corners.map(|&[x, y]| Vector::new(x, y)).collect();
        let collider = ColliderBuilder::convex_polyline(corners)
            .expect("a stone has five corners or more")
            .density(self.stones.density * self.depth(stone))
            .friction(self.stones.friction)
            .friction_combine_rule(CoefficientCombineRule::Min)
            .collision_groups(groups::STONES);
        let body = RigidBodyBuilder::new(kind)
            .pose(pose)
            .linear_damping(self.stones.drag)
            .angular_damping(self.stones.drag)
            .can_sleep(false);
        world.insert(body, collider).0
    }
}

/// Height [m] of what stones lie on, above the datum, at a position [m] along the track.
pub type Floor = Box<dyn Fn(f64) -> f64 + Send + Sync>;

/// A stone of the bed.
#[derive(Debug)]
struct BedStone {
    stone: PlacedStone,
    state: State,
}

/// What the world knows of a stone.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    /// Nothing yet.
    Waiting,
    /// A fixed body.
    Frozen(RigidBodyHandle),
    /// A dynamic body.
    Free(RigidBodyHandle),
}

impl BedStone {
    /// Position [m] along the track.
    fn position(&self, world: &PhysicsWorld) -> f64 {
        match self.state {
            State::Waiting => self.stone.position[0],
            State::Frozen(body) | State::Free(body) => world.bodies[body].translation().x,
        }
    }

    /// Brings the body to the state that fits its `distance` [m] from the axle.
    fn follow(&mut self, world: &mut PhysicsWorld, recipe: &BedRecipe, distance: f64, reach: f64) {
        if self.state == State::Waiting && distance < reach + STRIP {
            let body = recipe.insert(world, &self.stone, RigidBodyType::Fixed);
            self.state = State::Frozen(body);
        }
        match self.state {
            State::Frozen(body) if distance < reach => {
                world.bodies[body].set_body_type(RigidBodyType::Dynamic, true);
                self.state = State::Free(body);
            }
            State::Free(body) if distance >= reach => {
                world.bodies[body].set_body_type(RigidBodyType::Fixed, false);
                self.state = State::Frozen(body);
            }
            State::Waiting | State::Frozen(_) | State::Free(_) => {}
        }
    }
}

/// The bed of one run.
pub struct StoneBed {
    recipe: BedRecipe,
    floor: Floor,
    pouring: Pouring,
    /// 1 forward, -1 in reverse [-].
    heading: f64,
    reach: f64,
    /// Where the bed ends, counted along the heading [m].
    end: f64,
    stones: Vec<BedStone>,
    /// Colliders of the floor and the position [m], forward of the heading, where each ends.
    floors: VecDeque<(f64, ColliderHandle)>,
    /// Highest stone as poured [m] at every [`SURFACE_STEP`], for as far as it has been poured.
    surface: BTreeMap<i64, f64>,
    /// Position [m] of the axle when last looked at.
    looked_at: Option<f64>,
}

impl StoneBed {
    /// The bed of a wheel that starts at `start` [m] and moves forward, or in reverse where
    /// `heading` is below 0. It begins one section (0.5 m) behind the start.
    pub fn new(recipe: BedRecipe, start: f64, heading: f64, floor: Floor) -> Self {
        let heading = if heading < 0.0 { -1.0 } else { 1.0 };
        Self {
            recipe,
            floor,
            pouring: Pouring::new(heading * start - SECTION),
            heading,
            reach: REACH,
            end: f64::INFINITY,
            stones: Vec::new(),
            floors: VecDeque::new(),
            surface: BTreeMap::new(),
            looked_at: None,
        }
    }

    /// The bed between two places [m] of a longer track, where a pile lies in a trench.
    pub fn between(
        world: &mut PhysicsWorld,
        recipe: BedRecipe,
        range: [f64; 2],
        heading: f64,
        floor: Floor,
    ) -> Self {
        if let Laying::Pile { depth } = recipe.laying {
            for (end, outward) in [(range[0], -1.0), (range[1], 1.0)] {
                if end.is_finite() {
                    insert_wall(world, end, outward, depth, recipe.stones.friction);
                }
            }
        }
        let heading = if heading < 0.0 { -1.0 } else { 1.0 };
        let [first, last] = if heading < 0.0 {
            [-range[1], -range[0]]
        } else {
            range
        };
        let start = if first.is_finite() {
            first + SECTION
        } else {
            0.0
        };
        Self {
            end: last,
            ..Self::new(recipe, heading * start, heading, floor)
        }
    }

    /// The bed with stones free within `reach` [m] in place of [`REACH`].
    #[cfg(test)]
    pub fn with_reach(self, reach: f64) -> Self {
        Self { reach, ..self }
    }

    /// Height [m] of the highest stone, as poured, whose centroid lies in a range [m] of the
    /// track; `None` where there is none or the bed has not come so far.
    pub fn top(&self, [from, to]: [f64; 2]) -> Option<f64> {
        let within = |stone: &&PlacedStone| (from..=to).contains(&stone.position[0]);
        self.stones
            .iter()
            .map(|lying| &lying.stone)
            .filter(within)
            .map(PlacedStone::top)
            .max_by(f64::total_cmp)
    }

    /// The bodies of the free stones.
    #[cfg(test)]
    pub fn free(&self) -> impl Iterator<Item = RigidBodyHandle> {
        self.in_world()
            .filter(|(_, _, free)| *free)
            .map(|(body, _, _)| body)
    }

    /// Depth [m] of one of its stones along the axle.
    pub fn depth(&self, stone: &PlacedStone) -> f64 {
        self.recipe.depth(stone)
    }

    /// Every stone in the world: its body, its shape, and whether it is free.
    pub fn in_world(&self) -> impl Iterator<Item = (RigidBodyHandle, &PlacedStone, bool)> {
        self.stones.iter().filter_map(|lying| match lying.state {
            State::Free(body) => Some((body, &lying.stone, true)),
            State::Frozen(body) => Some((body, &lying.stone, false)),
            State::Waiting => None,
        })
    }

    /// Brings the bed to the `axle` [m]: pours ahead, thaws and freezes stones, takes up what
    /// lies behind. Cheap while the axle moves by less than 1 mm: call it after every step.
    pub fn follow(&mut self, world: &mut PhysicsWorld, axle: f64) {
        if self.looked_at.is_some_and(|x| (x - axle).abs() < STRIDE) {
            return;
        }
        self.looked_at = Some(axle);
        let ahead = self.heading * axle + self.reach + STRIP + SECTION / 4.0;
        while self.pouring.finished() < ahead.min(self.end) {
            self.pour(world);
        }
        for lying in &mut self.stones {
            let distance = (lying.position(world) - axle).abs();
            lying.follow(world, &self.recipe, distance, self.reach);
        }
        self.take_up(world, self.heading * axle - self.reach - 2.0 * STRIP);
    }

    /// Pours the next section and puts the floor under what is final now.
    fn pour(&mut self, world: &mut PhysicsWorld) {
        let from = self.pouring.finished();
        let (heading, floor) = (self.heading, &self.floor);
        let poured = self.pouring.pour(&self.recipe, &|u| floor(heading * u));
        let end = self.end;
        let inside = |stone: &PlacedStone| stone.position[0] + stone.shape.outer_radius() <= end;
        let poured = poured.into_iter().filter(inside);
        let turned = poured.map(|stone| {
            if heading < 0.0 {
                stone.mirrored()
            } else {
                stone
            }
        });
        let turned: Vec<PlacedStone> = turned.collect();
        let (friction, embedded) = (
            self.recipe.stones.friction,
            matches!(self.recipe.laying, Laying::Embedded { .. }),
        );
        let to = self.pouring.finished();
        if to > from && !embedded {
            let mut range = [heading * from, heading * to];
            range.sort_by(f64::total_cmp);
            let collider = insert_floor(world, range, friction, floor);
            self.floors.push_back((to, collider));
        }
        for stone in turned {
            self.survey(&stone);
            let state = State::Waiting;
            self.stones.push(BedStone { stone, state });
        }
    }

    /// Takes a stone into the surface as poured.
    fn survey(&mut self, stone: &PlacedStone) {
        let corners = stone.corners();
        let along = corners.iter().map(|corner| corner[0]);
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        });
        let first = libm::ceil(low / SURFACE_STEP) as i64;
        let last = libm::floor(high / SURFACE_STEP) as i64;
        for node in first..=last {
            if let Some([_, top]) = extent_at(&corners, node as f64 * SURFACE_STEP) {
                let surface = self.surface.entry(node).or_insert(top);
                *surface = surface.max(top);
            }
        }
    }

    /// Height [m] of the highest stone, as poured, at `x` [m]; `None` where there was none.
    pub fn surface(&self, x: f64) -> Option<f64> {
        let node = libm::round(x / SURFACE_STEP) as i64;
        self.surface.get(&node).copied()
    }

    /// Removes stones and floor that lie behind `end` [m], counted along the heading.
    fn take_up(&mut self, world: &mut PhysicsWorld, end: f64) {
        let heading = self.heading;
        self.stones.retain(|lying| {
            let kept = heading * lying.position(world) >= end;
            if let (false, State::Frozen(body) | State::Free(body)) = (kept, lying.state) {
                world.remove_body(body);
            }
            kept
        });
        while self.floors.front().is_some_and(|(to, _)| *to < end) {
            let floor = self.floors.pop_front();
            floor.and_then(|(_, collider)| world.remove_collider(collider));
        }
    }
}

/// Puts the end of a trench of `depth` [m] at a place [m], solid on its outward side.
fn insert_wall(world: &mut PhysicsWorld, end: f64, outward: f64, depth: f64, friction: f64) {
    const HALF: f64 = 0.05;
    let middle = Vector::new(end + outward * HALF, -0.5 * depth);
    let wall = ColliderBuilder::cuboid(HALF, 0.5 * depth)
        .translation(middle)
        .friction(friction)
        .friction_combine_rule(CoefficientCombineRule::Min)
        .collision_groups(groups::GROUND);
    world.insert_collider(wall, None);
}

/// Puts floor under stones in a range [m] of the track.
fn insert_floor(
    world: &mut PhysicsWorld,
    range: [f64; 2],
    friction: f64,
    floor: &dyn Fn(f64) -> f64,
) -> ColliderHandle {
    let line = ColliderBuilder::polyline(floor_points(range, floor), None)
        .friction(friction)
        .friction_combine_rule(CoefficientCombineRule::Min)
        .collision_groups(groups::GROUND);
    world.insert_collider(line, None)
}

/// Points [m] of the floor in a range [m] of the track; none within straight stretches.
fn floor_points([from, to]: [f64; 2], floor: &dyn Fn(f64) -> f64) -> Vec<Vector> {
    let count = libm::ceil((to - from) / FLOOR_STEP) as usize;
    let step = (to - from) / count as f64;
    let at = |k: usize| from + step * k as f64;
    let heights: Vec<f64> = (0..=count).map(|k| floor(at(k))).collect();
    let bends = |k: usize| {
        k == 0
            || k == count
            || (heights[k - 1] - 2.0 * heights[k] + heights[k + 1]).abs() > STRAIGHT
    };
    (0..=count)
        .filter(|&k| bends(k))
        .map(|k| Vector::new(at(k), heights[k]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::SampleRate;
    use crate::simulation::engine::{WheelColliders, contact_load, parameters};
    use crate::terrain::SizeRange;
    use crate::wheel::Wheel;
    use rapier2d::parry::query::contact;
    use std::sync::LazyLock;

    const LOAD: f64 = 100.0;
    const MASS: f64 = 14.0;
    /// Depth [m] of the test piles: two stones.
    const DEPTH: f64 = 0.06;

    fn recipe(laying: Laying, run: u64) -> BedRecipe {
        let size = SizeRange {
            min: 0.02,
            max: 0.05,
        };
        BedRecipe {
            stones: Stones {
                size,
                angularity: 0.5,
                density: 2600.0,
                friction: 0.6,
                drag: 0.0,
            },
            laying,
            width: 0.15,
            seed: Seed(1),
            run,
            number: 0,
        }
    }

    fn pile(run: u64) -> BedRecipe {
        recipe(Laying::Pile { depth: DEPTH }, run)
    }

    fn bed(run: u64) -> StoneBed {
        StoneBed::new(pile(run), 0.0, 1.0, Box::new(|_| -DEPTH))
    }

    fn world() -> PhysicsWorld {
        PhysicsWorld {
            integration_parameters: parameters(SampleRate::new(8000.0).unwrap()),
            ..PhysicsWorld::default()
        }
    }

    fn pour(run: u64, sections: usize) -> Vec<Vec<PlacedStone>> {
        let (recipe, mut pouring) = (pile(run), Pouring::new(0.0));
        (0..sections)
            .map(|_| pouring.pour(&recipe, &|_| -DEPTH))
            .collect()
    }

    /// Three sections poured for several tests to look at.
    static POURED: LazyLock<Vec<Vec<PlacedStone>>> = LazyLock::new(|| pour(0, 3));

    #[test]
    fn drag_slows_a_stone_by_63_percent_in_its_time_constant() {
        let stones = Stones {
            drag: 50.0,
            ..pile(0).stones
        };
        let (recipe, mut world) = (BedRecipe { stones, ..pile(0) }, world());
        world.gravity = Vector::ZERO;
        let body = recipe.insert(&mut world, &POURED[1][0], RigidBodyType::Dynamic);
        world.bodies[body].set_linvel(Vector::new(0.1, 0.0), true);
        world.bodies[body].set_angvel(1.0, true);
        for _ in 0..160 {
            world.step();
        }
        // 20 ms, a step being 1/160 of that: implicit damping errs by half as much.
        let left = [
            world.bodies[body].linvel().x / 0.1,
            world.bodies[body].angvel(),
        ];
        assert!(
            left.iter()
                .all(|left| (left * 1f64.exp() - 1.0).abs() < 0.005),
            "{left:?}"
        );
    }

    /// Speed [m/s] of the fastest free stone.
    fn fastest(world: &PhysicsWorld, bed: &StoneBed) -> f64 {
        let speeds = bed.free().map(|body| world.bodies[body].linvel().length());
        speeds.fold(0.0, f64::max)
    }

    /// A wheel held by a carriage, loaded, on a bed.
    struct Rolling {
        world: PhysicsWorld,
        bed: StoneBed,
        wheel: WheelColliders,
        body: RigidBodyHandle,
        carriage: RigidBodyHandle,
        motor: ImpulseJointHandle,
    }

    /// What was seen of a wheel over a while.
    #[derive(Debug)]
    struct Seen {
        mean_force: f64,
        /// Root mean square of the vertical acceleration in a 200 Hz band [m/s²].
        level: f64,
        /// Change of height [m].
        rise: f64,
    }

    impl Rolling {
        fn new(run: u64, reach: f64) -> Self {
            let (mut world, mut bed) = (world(), bed(run).with_reach(reach));
            bed.follow(&mut world, 0.0);
            let spec = Wheel::single_wheel();
            let height = spec.tip_radius() + bed.top([-0.08, 0.08]).unwrap();
            let body = world.insert_body(
                RigidBodyBuilder::dynamic()
                    .translation(Vector::new(0.0, height))
                    .additional_mass_properties(MassProperties::new(
                        Vector::ZERO,
                        MASS,
                        spec.inertia,
                    ))
                    .gravity_scale(0.0)
                    .can_sleep(false),
            );
            let wheel = WheelColliders::attach(&mut world, body, &spec);
            world.bodies[body].add_force(Vector::new(0.0, -LOAD), true);
            let carriage =
                world.insert_body(RigidBodyBuilder::kinematic_velocity_based().can_sleep(false));
            let guide = GenericJointBuilder::new(JointAxesMask::LIN_X)
                .motor_velocity(JointAxis::AngX, 0.0, 2000.0)
                .build();
            let motor = world.impulse_joints.insert(carriage, body, guide, true);
            Self {
                world,
                bed,
                wheel,
                body,
                carriage,
                motor,
            }
        }

        fn drive(&mut self, forward_speed: f64) {
            let velocity = Vector::new(forward_speed, 0.0);
            self.world.bodies[self.carriage].set_linvel(velocity, true);
            let wheel_speed = -forward_speed / 0.14 / 0.9;
            let joint = self.world.impulse_joints.get_mut(self.motor, true);
            joint
                .unwrap()
                .data
                .set_motor_velocity(JointAxis::AngX, wheel_speed, 2000.0);
        }

        fn watch(&mut self, seconds: f64) -> Seen {
            const BLOCK: usize = 20;
            let height =
                |world: &PhysicsWorld, body: RigidBodyHandle| world.bodies[body].translation().y;
            let body = self.body;
            let start = height(&self.world, body);
            let (mut force, mut speeds) = (0.0, vec![self.world.bodies[body].linvel().y]);
            let steps = (seconds * 8000.0) as usize;
            for step in 1..=steps {
                self.world.step();
                let axle = self.world.bodies[body].translation().x;
                self.bed.follow(&mut self.world, axle);
                let parts = self.wheel.lugs.iter().chain([&self.wheel.rim]);
                force += parts.map(|&c| contact_load(&self.world, c)[1]).sum::<f64>();
                if step % BLOCK == 0 {
                    speeds.push(self.world.bodies[body].linvel().y);
                }
            }
            let blocks = speeds.windows(2);
            let accelerations = blocks.map(|v| (v[1] - v[0]) * 8000.0 / BLOCK as f64);
            let squares: Vec<f64> = accelerations.map(|a| a * a).collect();
            Seen {
                mean_force: force / steps as f64,
                level: (squares.iter().sum::<f64>() / squares.len() as f64).sqrt(),
                rise: height(&self.world, body) - start,
            }
        }
    }

    #[test]
    fn a_poured_section_is_final_and_the_same_whether_or_not_others_follow() {
        let [few, more, other] = [&pour(0, 2), &*POURED, &pour(1, 2)];
        assert!(few[0].is_empty(), "the first section waits for the second");
        assert!(few[1].len() > 20, "{} stones", few[1].len());
        assert_eq!(few[1], more[1]);
        assert_ne!(few[1], other[1]);
    }

    #[test]
    fn stones_of_a_settled_bed_overlap_by_less_than_five_micrometres() {
        // A column of stones weighs 10 N at most, and (2π 2000 Hz)² 0.1 kg = 1.6·10⁷ N/m bear it:
        // below 1 µm; wedged stones carry more.
        let stones = POURED.concat();
        let mut world = world();
        let recipe = pile(0);
        let handles: Vec<RigidBodyHandle> = stones
            .iter()
            .map(|stone| recipe.insert(&mut world, stone, RigidBodyType::Fixed))
            .collect();
        let colliders: Vec<&Collider> = handles
            .iter()
            .map(|body| &world.colliders[world.bodies[*body].colliders()[0]])
            .collect();
        let mut deepest: f64 = 0.0;
        for (k, a) in colliders.iter().enumerate() {
            for b in &colliders[..k] {
                let (pose_a, pose_b) = (a.position(), b.position());
                let touch = contact(pose_a, a.shape(), pose_b, b.shape(), 0.0);
                deepest = deepest.max(touch.unwrap().map_or(0.0, |c| -c.dist));
            }
        }
        assert!(deepest > 0.0 && deepest < 5e-6, "{deepest} m");
    }

    #[test]
    fn a_bed_is_level_within_a_stone() {
        let stones = POURED.concat();
        let highest = |x: f64| {
            let near = stones.iter().filter(|s| (s.position[0] - x).abs() < 0.02);
            near.map(PlacedStone::top).fold(-DEPTH, f64::max)
        };
        let tops: Vec<f64> = (0..90)
            .map(|k| highest(0.05 + 0.01 * f64::from(k)))
            .collect();
        let mean = tops.iter().sum::<f64>() / tops.len() as f64;
        assert!(mean.abs() < 0.015, "mean surface {mean} m");
        assert!(tops.iter().all(|top| *top < 0.05 / 3.0 + 1e-3));
    }

    /// Distances [m] that stones thawed under a passing axle, without a wheel, have moved since
    /// they were poured; and the speed [m/s] of the fastest.
    fn moves_by_thawing(run: u64) -> (Vec<f64>, f64) {
        let (mut world, mut bed) = (world(), bed(run));
        let mut peak: f64 = 0.0;
        for step in 0..8000 {
            bed.follow(&mut world, 0.2 * f64::from(step) / 8000.0);
            world.step();
            peak = peak.max(fastest(&world, &bed));
        }
        let moved = |lying: &BedStone| {
            let State::Free(body) = lying.state else {
                return None;
            };
            let [x, y] = lying.stone.position;
            Some((world.bodies[body].translation() - Vector::new(x, y)).length())
        };
        (bed.stones.iter().filter_map(moved).collect(), peak)
    }

    #[test]
    fn thawing_does_not_jolt_a_settled_bed() {
        let (moves, peak) = moves_by_thawing(0);
        // Contacts give by micrometres; a rolling wheel drives stones at 20 to 300 mm/s.
        assert!(moves.iter().all(|distance| *distance < 5e-6), "{moves:?}");
        assert!(peak < 5e-3, "{peak} m/s");
    }

    #[test]
    fn a_settled_bed_is_at_rest() {
        let (mut world, mut bed) = (world(), bed(0));
        bed.follow(&mut world, 0.0);
        let place = |world: &PhysicsWorld, b: RigidBodyHandle| world.bodies[b].translation();
        let before: Vec<(RigidBodyHandle, Vector)> =
            bed.free().map(|b| (b, place(&world, b))).collect();
        assert!(before.len() > 10, "{} free stones", before.len());
        for _ in 0..4000 {
            world.step();
        }
        let moved = before
            .iter()
            .map(|(b, p)| (place(&world, *b) - *p).length());
        let moved = moved.fold(0.0, f64::max);
        assert!(moved < 5e-6, "a stone moved by {moved} m");
        assert!(fastest(&world, &bed) < 1e-5, "{}", fastest(&world, &bed));
    }

    #[test]
    fn a_wheel_standing_on_settled_gravel_is_quiet_and_carries_its_load() {
        let mut rig = Rolling::new(0, REACH);
        rig.watch(2.0);
        let standing = rig.watch(0.5);
        rig.drive(0.02);
        rig.watch(0.5);
        let rolling = rig.watch(3.0);
        assert!((standing.mean_force / LOAD - 1.0).abs() < 0.005);
        assert!((rolling.mean_force / LOAD - 1.0).abs() < 0.005);
        assert!(standing.level < 0.05 * rolling.level);
        assert!(standing.rise.abs() < 1e-4);
    }

    #[test]
    fn a_long_way_leaves_no_more_bodies_than_a_short_one() {
        let stones = recipe(Laying::Scattered { per_metre: 12.0 }, 0);
        let mut bed = StoneBed::new(stones, 0.0, 1.0, Box::new(|x| 0.002 * libm::sin(30.0 * x)));
        let (mut world, mut most) = (world(), 0);
        for centimetre in 0..250 {
            bed.follow(&mut world, 0.01 * f64::from(centimetre));
            most = most.max(world.bodies.len());
        }
        // 12 stones per metre over 2 x 0.15 m of reach, strips of 0.1 m ahead and 0.2 m behind.
        assert!(most <= 12, "{most} bodies");
        assert!(bed.stones.len() <= 24 && bed.floors.len() <= 4);
    }

    #[test]
    fn in_reverse_the_bed_is_the_mirror_image() {
        let mut worlds = [world(), world()];
        let floor = |x: f64| -DEPTH + 0.01 * libm::sin(5.0 * x);
        let stones = recipe(Laying::Scattered { per_metre: 12.0 }, 0);
        let mut ahead = StoneBed::new(stones.clone(), 0.0, 1.0, Box::new(floor));
        let mut back = StoneBed::new(stones, 0.0, -1.0, Box::new(move |x| floor(-x)));
        ahead.follow(&mut worlds[0], 0.0);
        back.follow(&mut worlds[1], 0.0);
        let mirrored = |b: &StoneBed| b.stones.iter().map(|s| s.stone.mirrored()).collect();
        let (there, here): (Vec<PlacedStone>, Vec<PlacedStone>) = (
            mirrored(&back),
            ahead.stones.iter().map(|s| s.stone.clone()).collect(),
        );
        assert_eq!(there, here);
    }

    #[test]
    fn scattered_stones_rest_on_the_floor_and_are_as_many_as_asked() {
        let floor = |x: f64| 0.003 * libm::sin(40.0 * x);
        let (recipe, mut pouring) = (
            recipe(Laying::Scattered { per_metre: 8.0 }, 0),
            Pouring::new(0.0),
        );
        let sections: Vec<Vec<PlacedStone>> =
            (0..3).map(|_| pouring.pour(&recipe, &floor)).collect();
        let stones = sections.concat();
        // 8 per metre on 1 m; the last of a section may roll across the border.
        assert!((6..=9).contains(&stones.len()), "{}", stones.len());
        for stone in &stones {
            let [cos, sin] = stone.rotation;
            let gap = |&[x, y]: &[f64; 2]| {
                let [u, v] = [cos * x - sin * y, sin * x + cos * y];
                stone.position[1] + v - floor(stone.position[0] + u)
            };
            let gaps = stone.shape.corners.iter().map(gap);
            let lowest = gaps.fold(f64::INFINITY, f64::min);
            // An edge may lie on a crest, with both its corners above the floor.
            assert!(lowest > -2e-5 && lowest < 2e-3, "gap {lowest} m");
        }
    }

    #[test]
    fn embedded_stones_lie_in_the_surface_by_the_share_asked_and_apart() {
        let laying = Laying::Embedded {
            per_metre: 6.0,
            embedding: 0.4,
        };
        let (recipe, mut pouring) = (recipe(laying, 0), Pouring::new(0.0));
        let mut stones: Vec<PlacedStone> = Vec::new();
        for _ in 0..4 {
            stones.extend(pouring.pour(&recipe, &|_| 0.0));
        }
        assert_eq!(stones.len(), 9);
        for pair in stones.windows(2) {
            let apart = pair[1].position[0] - pair[0].position[0];
            assert!(apart > pair[0].shape.outer_radius() + pair[1].shape.outer_radius());
        }
        for stone in stones {
            let above = stone.position[1] / stone.shape.diameter();
            assert!((above - 0.1).abs() < 1e-12);
        }
    }

    #[test]
    #[ignore = "ten seconds of standing on four beds: a minute"]
    fn a_standing_wheel_creeps_less_than_a_tenth_of_a_millimetre_in_ten_seconds() {
        for run in 0..4 {
            let mut rig = Rolling::new(run, REACH);
            rig.watch(3.0);
            let standing = rig.watch(10.0);
            eprintln!("{run} {standing:?}");
            assert!(standing.rise.abs() < 1e-4, "run {run}: {} m", standing.rise);
        }
    }

    #[test]
    #[ignore = "rolls over eight beds with two reaches: a minute"]
    fn freezing_beyond_reach_changes_rolling_levels_by_less_than_a_factor_of_two() {
        let level = |run, reach| {
            let mut rig = Rolling::new(run, reach);
            rig.watch(1.0);
            rig.drive(0.02);
            rig.watch(0.5);
            libm::log10(rig.watch(6.0).level)
        };
        let lost = |run| level(run, 2.0 * REACH) - level(run, REACH);
        let lost = (0..8).map(lost).sum::<f64>() / 8.0;
        // Levels of single beds scatter by a factor of three; this mean over pairs by 1.2.
        assert!(lost.abs() < libm::log10(2.0), "{lost} decades");
    }
}
