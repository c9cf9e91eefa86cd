//! Cost of one 128 kHz step on every ground, beside the bare engine with the same wheel.
//!
//! One iteration is a thousand steps: divide by a thousand.

use criterion::{Criterion, criterion_group, criterion_main};
use lugwheel::quantity::{SampleRate, Seed};
use lugwheel::scenario::Scenario;
use lugwheel::sensors::{Observed, SensorChain, Sensors};
use lugwheel::simulation::Simulation;
use lugwheel::terrain::Terrain;
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

/// A wheel under way with its sensors, at `rate` [Hz] or the ground's default.
struct Underway {
    simulation: Simulation,
    chain: SensorChain,
}

impl Underway {
    fn new(name: &str, rate: Option<f64>) -> Self {
        let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let mut scenario = Scenario::load(&path).expect("a ready scenario");
        scenario.sensors = Sensors::realistic();
        let rate = rate.map_or(scenario.physics_rate(), |rate| {
            SampleRate::new(rate).expect("a bench's own rate")
        });
        let terrain = Terrain::generate(&scenario.terrain, Seed(1), 0);
        let simulation = Simulation::new(&terrain, &scenario.wheel, &scenario.rig, rate)
            .expect("a ready scenario");
        let observed = Observed {
            physics_rate: rate,
            wheel_radius: scenario.wheel.radius,
            seed: Seed(1),
            run: 0,
        };
        let chain = SensorChain::new(&scenario.sensors, &observed).expect("a ready scenario");
        Self { simulation, chain }
    }

    fn advance(&mut self, steps: usize) {
        for state in self.simulation.by_ref().take(steps) {
            self.chain.push(&state.expect("the ground carries it"));
        }
    }
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
    for ground in ["ref", "ht", "st", "gt", "hgt", "sgt"] {
        let mut underway = Underway::new(&format!("single_wheel_{ground}"), Some(128.0e3));
        group.bench_function(format!("{} with sensors", ground.to_uppercase()), |b| {
            b.iter(|| underway.advance(STEPS))
        });
    }
    group.finish();
}

/// A tenth of a second at the default rates: ten times real time is 10 ms.
fn default_rates(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("0.1 s at the default rate");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3));
    for ground in ["ref", "ht", "st", "gt", "hgt", "sgt"] {
        let name = format!("single_wheel_{ground}");
        let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let rate = Scenario::load(&path)
            .expect("a ready scenario")
            .physics_rate();
        let mut underway = Underway::new(&name, None);
        let steps = (0.1 * rate.hertz()) as usize;
        group.bench_function(ground.to_uppercase(), |b| {
            b.iter(|| underway.advance(steps))
        });
    }
    group.finish();
}

criterion_group!(benches, steps, default_rates);
criterion_main!(benches);
