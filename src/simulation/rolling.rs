//! A wheel that rolls freely on flat hard ground, and a leg that is shaken, against mechanics.

use super::contact::WheelGeometry;
use super::hard_contact::HardGround;
use super::motion::{WheelMotion, Wrench};
use super::mount::Actions;
use super::rig::{Drive, Rig, RoverLeg};
use super::world::{WheelBody, World};
use crate::quantity::GRAVITY;
use crate::quantity::{SampleRate, Seed};
use crate::terrain::profile::Profile;
use crate::terrain::{HardContact, Relief};
use crate::wheel::{Lugs, Wheel};

const RATE: f64 = 64_000.0;
const DT: f64 = 1.0 / RATE;

/// Stiff, and so lossy that nothing bounces.
const DEAD: HardContact = HardContact {
    reference_load: 94.0,
    reference_indentation: 2.0e-6,
    exponent: 1.11,
    dissipation: 400.0,
    dust: 0.0,
};

/// Rolls `wheel` at `speed` [m/s] for `seconds`, and shows every state to `see`.
fn roll(
    wheel: &Wheel,
    contact: HardContact,
    speed: f64,
    seconds: f64,
    mut see: impl FnMut(&WheelMotion),
) {
    let weight = wheel.mass * GRAVITY;
    let geometry = WheelGeometry::new(wheel, weight);
    let profile = Profile::new(&Relief::default(), 1.0e-3, Seed(0), 0);
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let mut ground = HardGround::new(profile, contact, wheel, everywhere);
    let indentation = contact.reference_indentation
        * (weight / contact.reference_load).powf(1.0 / contact.exponent);
    let start = wheel.tip_radius() - indentation;
    let body = WheelBody {
        mass: wheel.mass,
        carriage_mass: 0.0,
        inertia: wheel.inertia,
        clamped: false,
    };
    let mut world = World::new(&body, SampleRate::new(RATE).unwrap());
    world.place(start);
    let turning = speed / wheel.tip_radius();
    world.free_body().launch(speed, 0.0, turning);
    for _ in 0..(seconds / DT) as usize {
        let motion = world.motion();
        see(&motion);
        let mut wrench = ground.push(&geometry, &motion, DT).wrench;
        wrench.fy -= weight;
        world.step(wrench, &Actions::NONE);
    }
}

fn kinetic_energy(wheel: &Wheel, motion: &WheelMotion) -> f64 {
    0.5 * wheel.mass * (motion.vx * motion.vx + motion.vy * motion.vy)
        + 0.5 * wheel.inertia * motion.omega * motion.omega
}

#[test]
fn a_free_rolling_smooth_wheel_keeps_its_energy_on_rigid_ground() {
    let wheel = Wheel {
        lugs: None,
        ..Wheel::single_wheel()
    };
    let mut energies = Vec::new();
    roll(&wheel, DEAD, 0.5, 4.0, |motion| {
        energies.push(kinetic_energy(&wheel, motion))
    });
    let (first, last) = (energies[0], energies[energies.len() - 1]);
    // Two metres on; the start itself costs a few parts in ten thousand.
    assert!((last / first - 1.0).abs() < 1.0e-3, "kept {}", last / first);
}

/// A rimless wheel that lands on its next spoke without bounce or slip keeps the angular momentum
/// about the new foot: `ω⁺/ω⁻ = (I + m R² cos α)/(I + m R²)` (McGeer 1990, rimless wheel).
#[test]
fn a_free_rolling_lugged_wheel_loses_per_lug_what_rimless_wheel_theory_says() {
    let lugs = Some(Lugs {
        count: 20,
        height: 0.015,
        thickness: 0.003,
        edge_radius: None,
    });
    let wheel = Wheel {
        lugs,
        friction: 2.0,
        mass: 10.0,
        ..Wheel::single_wheel()
    };
    let (radius, alpha) = (wheel.tip_radius(), wheel.lug_angle().unwrap());
    let about_foot = wheel.inertia + wheel.mass * radius * radius;
    let theory = (wheel.inertia + wheel.mass * radius * radius * alpha.cos()) / about_foot;
    // Speed as each lug points straight down.
    let mut speeds = Vec::new();
    let mut passed = 0.5;
    roll(&wheel, DEAD, 1.1, 0.5, |motion| {
        if motion.angle / alpha >= passed + 0.5 {
            passed += 1.0;
            speeds.push(motion.omega);
        }
    });
    // From one upright to the next: down half a lug angle, impact, up half a lug angle.
    let fall = 2.0 * wheel.mass * GRAVITY * radius * (1.0 - (0.5 * alpha).cos()) / about_foot;
    let ratios: Vec<f64> = speeds
        .windows(2)
        .map(|pair| ((pair[1] * pair[1] + fall) / (pair[0] * pair[0] + fall)).sqrt())
        .collect();
    assert!(ratios.len() >= 5, "{speeds:?}");
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    // A contact lasts 1 ms of the 50 ms between lugs, in which the wheel turns on.
    assert!(
        (mean - theory).abs() < 0.1 * (1.0 - theory),
        "{mean} against {theory}: {ratios:?}"
    );
}

/// `|H|` of Eq. (2): body over axle for a base sine of `frequency` [Hz].
fn transmissibility(leg: &RoverLeg, mass: f64, frequency: f64) -> f64 {
    let natural = (leg.stiffness / mass).sqrt();
    let damping_ratio = leg.damping / (2.0 * (leg.stiffness * mass).sqrt());
    let ratio = std::f64::consts::TAU * frequency / natural;
    let damped = (2.0 * damping_ratio * ratio).powi(2);
    ((1.0 + damped) / ((1.0 - ratio * ratio).powi(2) + damped)).sqrt()
}

#[test]
fn the_body_of_a_rover_leg_follows_eq_2_within_2_percent_for_a_base_sine() {
    let drive = Drive {
        forward_speed: 0.0,
        slip: None,
        wheel_speed: Some(0.0),
        start_up: 0.0,
        stop_at: None,
        motor: None,
        carriage: None,
        flaws: Default::default(),
    };
    let leg = RoverLeg {
        drive,
        load: 284.4,
        stiffness: 1.0e6,
        damping: 1.6e3,
        slope_deg: 0.0,
        flaws: Default::default(),
    };
    let spring_and_damper = Rig::RoverLeg(leg).leg(&Wheel::rover()).unwrap();
    let (mass, rate, amplitude) = (25.0, 16_000.0, 1.0e-3);
    for frequency in [4.0, 16.0, 28.0, 32.0, 40.0, 80.0] {
        let omega = std::f64::consts::TAU * frequency;
        // An axle so heavy that the leg does not move it.
        let axle = WheelBody {
            mass: 1.0e9,
            carriage_mass: 0.0,
            inertia: 1.0,
            clamped: false,
        };
        let mut world = World::new(&axle, SampleRate::new(rate).unwrap());
        world.add_leg(mass, 0.0);
        world.free_body().launch(0.0, amplitude * omega, 0.0);
        let (mut in_phase, mut quadrature) = (0.0, 0.0);
        // Two seconds for the start to die away, then whole periods.
        let steps = (3.0 * rate) as usize;
        for step in 0..steps {
            let time = step as f64 / rate;
            let axle = world.motion();
            let [stretch, closing] = world.leg_stretch(&axle).unwrap();
            let spring = spring_and_damper.spring_force(stretch, closing);
            world.push_leg(-spring, 0.0);
            let fy = -1.0e9 * omega * omega * amplitude * (omega * time).sin();
            let shaking = Wrench {
                fy,
                ..Wrench::default()
            };
            if time >= 2.0 {
                let body = axle.y + stretch;
                in_phase += body * (omega * time).sin();
                quadrature += body * (omega * time).cos();
            }
            world.step(shaking, &Actions::NONE);
        }
        let found = 2.0 / rate * (in_phase * in_phase + quadrature * quadrature).sqrt() / amplitude;
        let expected = transmissibility(&leg, mass, frequency);
        assert!(
            (found / expected - 1.0).abs() < 0.02,
            "{frequency} Hz: {found} against {expected}"
        );
    }
}
