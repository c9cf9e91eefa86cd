//! The work of carriage and motor against what becomes of it.

use super::rig::carriage::Carriage;
use super::rig::motor::Motor;
use super::rig::{Drive, Rig, SingleWheel};
use super::{Simulation, SimulationError};
use crate::quantity::{SampleRate, Seed, SlipRatio};
use crate::terrain::{HardContact, Terrain, TerrainSpec};
use crate::wheel::Wheel;

const RATE: f64 = 32_000.0;

const CONTACT: HardContact = HardContact {
    reference_load: 94.0,
    reference_indentation: 1.0e-5,
    exponent: 1.11,
    dissipation: 100.0,
    dust: 0.0,
};

fn rig(slip: f64) -> Rig {
    let drive = Drive {
        forward_speed: 0.02,
        slip: Some(SlipRatio::new(slip).unwrap()),
        wheel_speed: None,
        start_up: 0.5,
        stop_at: None,
        motor: Some(Motor {
            rotor_inertia: 0.12,
            stiffness: 1.6e4,
            damping_ratio: 0.05,
            torque_limit: 54.0,
            bandwidth: 30.0,
        }),
        carriage: Some(Carriage {
            mass: 30.0,
            stiffness: 5.0e5,
            damping_ratio: 0.05,
            force_limit: 1000.0,
        }),
        flaws: Default::default(),
    };
    Rig::SingleWheel(SingleWheel {
        drive,
        load: 100.0,
        moving_mass: 12.0,
        lifted: None,
        slope_deg: 0.0,
        flaws: Default::default(),
    })
}

/// Works [J] since the let-down.
#[derive(Default)]
struct Works {
    motor: f64,
    carriage: f64,
    gear_loss: f64,
    belt_loss: f64,
    /// Of the torque on the ground, and of the ground's pull on the wheel.
    torque: f64,
    pull: f64,
}

#[test]
fn work_of_motor_and_carriage_is_work_on_the_ground_and_losses_and_what_is_stored()
-> Result<(), SimulationError> {
    let wheel = Wheel::single_wheel();
    let reference = TerrainSpec::Reference { contact: CONTACT };
    let terrain = Terrain::generate(&reference, Seed(1), 0);
    for slip in [-0.2, 0.0, 0.3] {
        let rate = SampleRate::new(RATE).unwrap();
        let mut simulation = Simulation::new(&terrain, &wheel, &rig(slip), rate)?;
        let dt = rate.period();
        let mut works = Works::default();
        let before = simulation
            .mount
            .account(&super::Commanded::REST, &simulation.world.motion());
        for _ in 0..(6.0 * RATE) as usize {
            let then = simulation.world.motion();
            let state = simulation.next().expect("it never ends")?;
            let commanded = simulation.command.at(state.time);
            let account = simulation.mount.account(&commanded, &then);
            let (v, omega) = (
                0.5 * (then.vx + state.forward_speed),
                0.5 * (then.omega + state.wheel_speed),
            );
            works.motor += account.motor * dt;
            works.carriage += account.carriage * dt;
            works.gear_loss += account.gear_loss * dt;
            works.belt_loss += account.belt_loss * dt;
            works.torque += state.ground.driving_torque * omega * dt;
            works.pull += state.ground.drawbar_pull * v * dt;
        }
        let motion = simulation.world.motion();
        let after = simulation
            .mount
            .account(&simulation.command.at(6.0), &motion);
        let spinning = 0.5 * wheel.inertia * motion.omega * motion.omega;
        let rolling = 0.5 * simulation.mass * motion.vx * motion.vx;
        let used = works.torque + works.gear_loss + after.gear - before.gear + spinning;
        assert!(
            (works.motor - used).abs() < 0.01 * works.motor.abs().max(0.01),
            "slip {slip}: motor {} used {used}",
            works.motor
        );
        let used = works.belt_loss + after.belt - before.belt + rolling - works.pull;
        assert!(
            (works.carriage - used).abs() < 0.01 * works.carriage.abs().max(0.01),
            "slip {slip}: carriage {} used {used}",
            works.carriage
        );
    }
    Ok(())
}
