//! A wheel that rolls freely on flat hard ground, against mechanics.

use super::GRAVITY;
use super::contact::WheelGeometry;
use super::hard_contact::HardGround;
use super::world::{Guide, WheelBody, WheelMotion, World};
use crate::quantity::{SampleRate, Seed};
use crate::terrain::HardContact;
use crate::terrain::profile::Profile;
use crate::wheel::{Lugs, Wheel};

const RATE: f64 = 64_000.0;
const DT: f64 = 1.0 / RATE;

/// Stiff, and so lossy that nothing bounces.
const DEAD: HardContact = HardContact {
    reference_load: 94.0,
    reference_indentation: 2.0e-6,
    exponent: 1.11,
    dissipation: 400.0,
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
    let profile = Profile::new(None, None, 1.0e-3, Seed(0), 0);
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let mut ground = HardGround::new(profile, contact, wheel.friction, everywhere);
    let indentation = contact.reference_indentation
        * (weight / contact.reference_load).powf(1.0 / contact.exponent);
    let start = wheel.tip_radius() - indentation;
    let body = WheelBody {
        mass: wheel.mass,
        inertia: wheel.inertia,
    };
    let mut world = World::new(
        body,
        Guide::Free,
        [0.0, 0.0],
        SampleRate::new(RATE).unwrap(),
    );
    world.place(start);
    world.launch(speed, 0.0, speed / wheel.tip_radius());
    for _ in 0..(seconds / DT) as usize {
        let motion = world.wheel_motion();
        see(&motion);
        let mut wrench = ground.push(&geometry, &motion, DT).wrench;
        wrench.fy -= weight;
        world.push_wheel(wrench);
        world.step();
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
