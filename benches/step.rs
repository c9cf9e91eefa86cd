//! Cost of one 128 kHz step on every ground, beside the bare engine with the same wheel.
//!
//! One iteration is a thousand steps: divide by a thousand.

use criterion::{Criterion, criterion_group, criterion_main};
use lugwheel::quantity::{SampleRate, Seed};
use lugwheel::simulation::Simulation;
use lugwheel::simulation::rig::{Drive, Rig, SingleWheel};
use lugwheel::terrain::{HardContact, Terrain, TerrainSpec};
use lugwheel::wheel::Wheel;
use rapier2d::prelude::*;
use std::time::Duration;

const STEPS: usize = 1000;

/// The engine alone: a ball with 28 boxes for lugs on a half-space, driven by a joint.
fn bare_engine() -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.integration_parameters.dt = 1.0 / 128.0e3;
    world.insert(
        RigidBodyBuilder::fixed(),
        ColliderBuilder::new(SharedShape::halfspace(Vector::Y)),
    );
    let carriage = world.insert_body(
        RigidBodyBuilder::kinematic_velocity_based()
            .translation(Vector::new(0.0, 0.155))
            .linvel(Vector::new(0.02, 0.0)),
    );
    let wheel = world.insert_body(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, 0.155))
            .can_sleep(false),
    );
    world.insert_collider(ColliderBuilder::ball(0.14).density(150.0), Some(wheel));
    for lug in 0..28 {
        let angle = f64::from(lug) * std::f64::consts::TAU / 28.0;
        let place = Vector::new(angle.sin(), -angle.cos()) * 0.1475;
        world.insert_collider(
            ColliderBuilder::cuboid(0.0015, 0.0075)
                .translation(place)
                .rotation(angle),
            Some(wheel),
        );
    }
    let joint = GenericJointBuilder::new(JointAxesMask::LIN_X)
        .motor_velocity(JointAxis::AngX, -0.02 / 0.14, 1.0e9)
        .build();
    world.insert_impulse_joint(carriage, wheel, joint);
    world
}

/// The engine alone with a body, a joint and a force, and nothing to touch.
fn body_and_joint() -> (PhysicsWorld, RigidBodyHandle) {
    let mut world = PhysicsWorld::new();
    world.integration_parameters.dt = 1.0 / 128.0e3;
    world.integration_parameters.num_solver_iterations = 1;
    let carriage = world
        .insert_body(RigidBodyBuilder::kinematic_velocity_based().linvel(Vector::new(0.02, 0.0)));
    let wheel = world.insert_body(
        RigidBodyBuilder::dynamic()
            .gravity_scale(0.0)
            .can_sleep(false)
            .additional_mass_properties(MassProperties::new(Vector::ZERO, 14.0, 0.05)),
    );
    let joint = GenericJointBuilder::new(JointAxesMask::LIN_X)
        .motor_velocity(JointAxis::AngX, -0.02 / 0.14, 1.0e9)
        .build();
    world.insert_impulse_joint(carriage, wheel, joint);
    (world, wheel)
}

fn scenario_terrain(text: &str) -> TerrainSpec {
    toml::from_str(text).expect("a bench's own ground")
}

fn rig() -> Rig {
    let drive = Drive {
        forward_speed: 0.02,
        slip: None,
        wheel_speed: Some(0.16),
        start_up: 0.1,
        stop_at: None,
    };
    Rig::SingleWheel(SingleWheel {
        drive,
        load: 100.0,
        moving_mass: 12.0,
        lifted: None,
        slope_deg: 0.0,
    })
}

fn simulation(terrain: &TerrainSpec) -> Simulation {
    let terrain = Terrain::generate(terrain, Seed(1), 0);
    Simulation::new(
        &terrain,
        &Wheel::single_wheel(),
        &rig(),
        SampleRate::REFERENCE,
    )
    .expect("a bench's own rig")
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("1000 steps at 128 kHz");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    let mut engine = bare_engine();
    group.bench_function("bare engine, lugged wheel on a half-space", |b| {
        b.iter(|| (0..STEPS).for_each(|_| engine.step()))
    });
    let (mut world, wheel) = body_and_joint();
    group.bench_function("bare engine, body and joint", |b| {
        b.iter(|| {
            for _ in 0..STEPS {
                let body = &mut world.bodies[wheel];
                body.reset_forces(false);
                body.add_force(Vector::new(0.0, 0.0), false);
                world.step();
            }
        })
    });
    let contact = HardContact {
        reference_load: 94.0,
        reference_indentation: 1.0e-5,
        exponent: 1.11,
        dissipation: 100.0,
    };
    let mut reference = simulation(&TerrainSpec::Reference { contact });
    group.bench_function("REF", |b| {
        b.iter(|| {
            reference
                .by_ref()
                .take(STEPS)
                .for_each(|s| drop(s.expect("runs on")))
        })
    });
    let sand = scenario_terrain(SAND);
    let mut sand = simulation(&sand);
    group.bench_function("ST", |b| {
        b.iter(|| {
            sand.by_ref()
                .take(STEPS)
                .for_each(|s| drop(s.expect("runs on")))
        })
    });
    group.finish();
}

const SAND: &str = r#"
[sand.soil]
convention = "wong_reece"
cohesive_modulus = 15.6e3
frictional_modulus = 2407.4e3
sinkage_exponent = 1.1
sinkage_exponent_slip = 0.0
cohesion = 250.0
friction_angle_deg = 31.9
shear_modulus = 0.0114
stress_angle = 0.4
stress_angle_slip = 0.2
exit_angle = 0.0
unloading_stiffness = 2.0e7
damping = 3.0e4
bulk_density = 1600.0
repose_angle_deg = 32.0
"#;

criterion_group!(benches, steps);
criterion_main!(benches);
