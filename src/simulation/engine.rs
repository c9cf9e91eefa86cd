//! How the engine is set: its parameters, who collides with whom, the wheel among the stones.
//!
//! The engine's defaults suit games with metre-sized bodies at 60 Hz; here bodies are centimetres
//! and steps microseconds, so [`parameters`] sets all that matters on purpose.

use crate::quantity::SampleRate;
use crate::wheel::Wheel;
use rapier2d::prelude::*;
use std::f64::consts::FRAC_1_SQRT_2;

/// Length [m] that the engine takes for one: a small stone.
///
/// The broad phase pairs bodies closer than 0.08 of it. With its default of 1 m every stone pairs
/// with all within 80 mm: the same motion, but a step takes half as long again.
pub const LENGTH_UNIT: f64 = 0.01;

/// Lowest rate [Hz] at which contacts are solved. With one solution a step at 8 kHz, a pile under
/// a standing wheel may still creep by a millimetre for seconds; at 32 kHz it comes to rest.
const SOLVER_RATE: u32 = 32_000;

/// Natural frequency [Hz] of a contact between free bodies: its stiffness is that of a spring
/// between their masses, `(2π f)² m` (some 2·10⁷ N/m for two stones of 35 mm). It lies above the
/// bands that features are taken from, so that contacts do not filter them.
const CONTACT_FREQUENCY: f64 = 2000.0;

/// Damping ratio [-] of a contact: critical, the fastest return without overshoot.
const CONTACT_DAMPING: f64 = 1.0;

/// Distance [m] within which contacts are expected: beyond what bodies move in a step of 8 kHz
/// at 0.08 m/s, far below any gap that one could see.
const PREDICTION: f64 = 1e-5;

/// Relative motion [m] of two bodies below which their contact points are kept and ride along
/// with them. The error is of second order: over 10 µm a normal on a rim of 140 mm turns by
/// 7·10⁻⁵ and the gap changes by 0.4 nm, while contacts work at micrometres of penetration.
/// Friction is not affected, as it acts on velocities alone in the unbiased pass.
const RECYCLING: f64 = 1e-5;

/// The engine's parameters at a physics `rate`, for stones.
pub fn parameters(rate: SampleRate) -> IntegrationParameters {
    let softness = |frequency| SpringCoefficients::new(frequency, CONTACT_DAMPING);
    IntegrationParameters {
        dt: rate.period(),
        length_unit: LENGTH_UNIT,
        contact_softness: softness(CONTACT_FREQUENCY),
        // The engine scales stiffness with the masses that move: against a fixed body they are
        // twice those of a pair of equal stones. So the stiffness of a contact stays when one of
        // two equal stones freezes or thaws, and neither moves.
        static_contact_softness: softness(CONTACT_FREQUENCY * FRAC_1_SQRT_2),
        num_solver_iterations: SOLVER_RATE.div_ceil(rate.whole()) as usize,
        // Contacts this soft at these steps converge within a few steps through the warm start.
        num_internal_pgs_iterations: 1,
        warmstart_coefficient: 1.0,
        warmstart_joints: true,
        // The pass that takes the velocity of position correction out again. Without it friction
        // works against that velocity, and a wheel that stands on stones never comes to rest
        // (0.2 to 6 m/s² in a 200 Hz band).
        num_internal_stabilization_iterations: 1,
        friction_in_bias_pass: false,
        normalized_prediction_distance: PREDICTION / LENGTH_UNIT,
        contact_recycling: true,
        normalized_contact_recycle_distance: RECYCLING / LENGTH_UNIT,
        // Speeds are far too low for tunnelling, and a cap would act as a force.
        max_ccd_substeps: 0,
        normalized_allowed_linear_error: PREDICTION / LENGTH_UNIT,
        normalized_max_corrective_velocity: f64::MAX,
        normalized_max_linear_velocity: f64::MAX,
        ..IntegrationParameters::default()
    }
}

/// Who collides with whom: stones with all, the wheel with stones only. Fixed ground acts on the
/// wheel through the force layer.
pub mod groups {
    use rapier2d::prelude::{Group, InteractionGroups, InteractionTestMode};

    const FLOOR: Group = Group::GROUP_1;
    const STONE: Group = Group::GROUP_2;
    const WHEEL: Group = Group::GROUP_3;

    const fn of(member: Group, meets: Group) -> InteractionGroups {
        InteractionGroups::new(member, meets, InteractionTestMode::And)
    }

    /// Fixed ground under stones.
    pub const GROUND: InteractionGroups = of(FLOOR, STONE);
    /// Stones.
    pub const STONES: InteractionGroups = of(STONE, FLOOR.union(STONE).union(WHEEL));
    /// Rim and lugs.
    pub const RIM_AND_LUGS: InteractionGroups = of(WHEEL, STONE);
}

/// Rim and lugs as stones meet them.
///
/// Each is a collider of its own, so the force on each lug can be read. Lugs away from the stones
/// cost next to nothing: the broad phase passes over them.
#[derive(Debug, Clone)]
pub struct WheelColliders {
    /// The rim.
    pub rim: ColliderHandle,
    /// The lugs.
    pub lugs: Vec<ColliderHandle>,
}

impl WheelColliders {
    /// Gives `body` the outline of `wheel`; lug 0 points straight down.
    pub fn attach(world: &mut PhysicsWorld, body: RigidBodyHandle, wheel: &Wheel) -> Self {
        let mut insert = |shape: ColliderBuilder| {
            let part = shape
                .density(0.0)
                .friction(wheel.friction)
                .friction_combine_rule(CoefficientCombineRule::Min)
                .collision_groups(groups::RIM_AND_LUGS);
            world.insert_collider(part, Some(body))
        };
        let rim = ColliderBuilder::ball(wheel.radius);
        let rim = insert(rim.translation(Vector::new(0.0, -wheel.flaws.eccentricity)));
        let lugs = (0..wheel.lug_count())
            .map(|lug| insert(lug_shape(wheel, lug)))
            .collect();
        Self { rim, lugs }
    }
}

/// Least height [m] of a lug's collider: one that is worn down keeps its place among the others.
const LEAST_LUG: f64 = 1.0e-4;

/// A lug of a wheel that has not turned: a bar from the rim to its edge. On an oval rim it stands as
/// far out as the rim there.
fn lug_shape(wheel: &Wheel, lug: u32) -> ColliderBuilder {
    let (sin, cos) = libm::sincos(wheel.lug_position(lug, 0.0));
    let height = wheel.height_of_lug(lug).max(LEAST_LUG);
    let bulge = wheel.flaws.ovality * (2.0 * cos * cos - 1.0);
    let thickness = wheel.lugs.map_or(0.0, |lugs| lugs.thickness);
    let middle = wheel.radius + height / 2.0 + bulge;
    let pose = Pose::from_parts(
        Vector::new(middle * sin, -middle * cos - wheel.flaws.eccentricity),
        Rotation::from_cos_sin_unchecked(sin, -cos),
    );
    ColliderBuilder::cuboid(height / 2.0, thickness / 2.0).position(pose)
}

/// Mean load of the contacts on a collider of the wheel over the last step: force along the track
/// and upward [N], moment about the axle [N·m], counter-clockwise.
///
/// Contacts keep the sum of their impulses over the solutions of a step; joints keep the last
/// one's only, so loads on stones are read here and not from the carriage.
pub fn contact_load(world: &PhysicsWorld, collider: ColliderHandle) -> [f64; 3] {
    let Some(body) = world.colliders.get(collider).and_then(Collider::parent) else {
        return [0.0; 3];
    };
    let rotation = *world.bodies[body].rotation();
    let (mut impulse, mut moment) = (Vector::ZERO, 0.0);
    for pair in world.narrow_phase.contact_pairs_with(collider) {
        let is_second = pair.collider2 == collider;
        let sign = if is_second { 1.0 } else { -1.0 };
        for manifold in pair.manifolds() {
            let normal = manifold.data.normal;
            let tangent = Vector::new(-normal.y, normal.x);
            // Points that are not among the solver's keep the impulse of their last contact.
            for contact in &manifold.data.solver_contacts {
                let [index] = contact.contact_id;
                let point = &manifold.points[(index & !NEW_CONTACT_BIT) as usize].data;
                let push = (normal * point.impulse + tangent * point.tangent_impulse.x) * sign;
                // Anchors turn with the body, from its centre of mass: the axle.
                let anchor = if is_second {
                    contact.anchor2
                } else {
                    contact.anchor1
                };
                let arm = rotation * anchor;
                impulse += push;
                moment += arm.x * push.y - arm.y * push.x;
            }
        }
    }
    let dt = world.integration_parameters.dt;
    [impulse.x / dt, impulse.y / dt, moment / dt]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sliding speed [m/s] after a second of a block of 0.1 kg that is pushed by `push` times its
    /// weight over a floor of friction 0.6.
    fn pushed(push: f64, rate: f64) -> f64 {
        let mut world = PhysicsWorld {
            integration_parameters: parameters(SampleRate::new(rate).unwrap()),
            ..PhysicsWorld::default()
        };
        let rule = CoefficientCombineRule::Min;
        let floor = ColliderBuilder::cuboid(10.0, 0.1)
            .translation(Vector::new(0.0, -0.1))
            .friction(0.6)
            .friction_combine_rule(rule)
            .collision_groups(groups::GROUND);
        world.insert_collider(floor, None);
        let block = ColliderBuilder::cuboid(0.02, 0.01)
            .mass(0.1)
            .friction(0.6)
            .friction_combine_rule(rule)
            .collision_groups(groups::STONES);
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, 0.01))
            .can_sleep(false);
        let (body, _) = world.insert(body, block);
        world.bodies[body].add_force(Vector::new(push * 0.1 * 9.81, 0.0), true);
        for _ in 0..rate as usize {
            world.step();
        }
        world.bodies[body].linvel().x
    }

    #[test]
    fn friction_holds_a_stone_up_to_its_coefficient_and_no_further() {
        for rate in [8.0e3, 32.0e3] {
            assert!(pushed(0.57, rate).abs() < 1.0e-6, "{}", pushed(0.57, rate));
            // The rest of the push accelerates it.
            let sliding = pushed(0.8, rate);
            assert!(
                (sliding / (0.2 * 9.81) - 1.0).abs() < 0.02,
                "{rate}: {sliding}"
            );
        }
    }
}
