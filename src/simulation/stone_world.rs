//! The wheel among stones, in rapier's whole pipeline.
//!
//! Along the track the carriage is a body of its own, joined to the wheel by its vertical guide: kinematic
//! where it is rigid, else with its mass and the force of its drive. A rigid motor is a motor of the joint, one that
//! yields is a torque on the wheel.

use super::engine::{WheelColliders, contact_load, parameters};
use super::motion::{WheelMotion, Wrench};
use super::mount::{Action, Actions};
use super::world::WheelBody;
use crate::quantity::SampleRate;
use crate::wheel::Wheel;
use rapier2d::prelude::*;

/// Stiffness of the velocity servo of a rigid motor [1/s]: its speed error decays within a step.
const SERVO_STIFFNESS: f64 = 1.0e9;

/// Rigid bodies: the wheel, its carriage and the stones.
pub(super) struct StoneWorld {
    physics: PhysicsWorld,
    wheel: RigidBodyHandle,
    carriage: RigidBodyHandle,
    guide: ImpulseJointHandle,
    colliders: WheelColliders,
    dt: f64,
    angle: f64,
}

/// An engine for stones under `gravity` [m/s²], at a physics `rate`.
pub(super) fn engine(gravity: [f64; 2], rate: SampleRate) -> PhysicsWorld {
    PhysicsWorld {
        gravity: Vector::new(gravity[0], gravity[1]),
        integration_parameters: parameters(rate),
        ..PhysicsWorld::new()
    }
}

impl StoneWorld {
    /// Puts `wheel` into an engine that has the stones; what moves with it is `body`.
    pub fn new(mut physics: PhysicsWorld, wheel: &Wheel, body: &WheelBody) -> Self {
        let locked = if body.clamped {
            LockedAxes::TRANSLATION_LOCKED_Y
        } else {
            LockedAxes::empty()
        };
        let mass = MassProperties::new(Vector::ZERO, body.mass, body.inertia);
        let axle = physics.insert_body(
            RigidBodyBuilder::dynamic()
                .gravity_scale(0.0)
                .can_sleep(false)
                .locked_axes(locked)
                .additional_mass_properties(mass),
        );
        let carriage = physics.insert_body(carriage(body));
        let joint = GenericJointBuilder::new(JointAxesMask::LIN_X)
            .motor_model(JointAxis::AngX, MotorModel::AccelerationBased)
            .build();
        let guide = physics.insert_impulse_joint(carriage, axle, joint);
        let colliders = WheelColliders::attach(&mut physics, axle, wheel);
        Self {
            dt: physics.integration_parameters.dt,
            physics,
            wheel: axle,
            carriage,
            guide,
            colliders,
            angle: 0.0,
        }
    }

    /// The engine with the stones.
    pub fn physics(&mut self) -> &mut PhysicsWorld {
        &mut self.physics
    }

    /// Puts the axle at `height` [m].
    pub fn place(&mut self, height: f64) {
        self.physics.bodies[self.wheel].set_translation(Vector::new(0.0, height), false);
    }

    /// Load of the stones on the wheel over the last step, and the lugs they press on with more than
    /// `touch_force` [N], one bit each.
    pub fn load(&self, touch_force: f64) -> (Wrench, u64) {
        let load = |collider| {
            let [fx, fy, moment] = contact_load(&self.physics, collider);
            Wrench {
                fx,
                fy,
                torque: -moment,
            }
        };
        let (mut sum, mut touching) = (load(self.colliders.rim), 0);
        for (lug, collider) in self.colliders.lugs.iter().enumerate() {
            let on_lug = load(*collider);
            if on_lug.force() > touch_force {
                touching |= 1 << lug;
            }
            sum += on_lug;
        }
        (sum, touching)
    }

    /// Advances by one step, in which `wrench` acts on the wheel, and carriage and motor.
    pub fn step(&mut self, wrench: Wrench, actions: &Actions) {
        self.move_carriage(actions.along);
        let torque = match actions.about {
            Action::Force(torque) => torque,
            Action::Speed(speed) => {
                self.turn_at(speed);
                0.0
            }
        };
        let wheel = &mut self.physics.bodies[self.wheel];
        wheel.reset_forces(false);
        wheel.reset_torques(false);
        wheel.add_force(Vector::new(wrench.fx, wrench.fy), false);
        wheel.add_torque(-wrench.torque - torque, false);
        self.physics.step();
        self.angle -= self.physics.bodies[self.wheel].angvel() * self.dt;
    }

    fn move_carriage(&mut self, action: Action) {
        let carriage = &mut self.physics.bodies[self.carriage];
        match action {
            Action::Force(force) => {
                carriage.reset_forces(false);
                carriage.add_force(Vector::new(force, 0.0), false);
            }
            Action::Speed(speed) if carriage.linvel().x != speed => {
                carriage.set_linvel(Vector::new(speed, 0.0), false);
            }
            Action::Speed(_) => {}
        }
    }

    /// Has the joint's motor turn the wheel at `speed` [rad/s].
    fn turn_at(&mut self, speed: f64) {
        let motor = |joint: &ImpulseJoint| joint.data.motors[JointAxis::AngX as usize];
        let joints = &mut self.physics.impulse_joints;
        let turning = joints
            .get(self.guide)
            .is_some_and(|joint| motor(joint).target_vel == -speed && motor(joint).damping > 0.0);
        if !turning && let Some(joint) = joints.get_mut(self.guide, false) {
            joint
                .data
                .set_motor_velocity(JointAxis::AngX, -speed, SERVO_STIFFNESS);
        }
    }

    /// The wheel now.
    pub fn motion(&self) -> WheelMotion {
        let body = &self.physics.bodies[self.wheel];
        let (position, velocity, rotation) = (body.translation(), body.linvel(), body.rotation());
        WheelMotion {
            x: position.x,
            y: position.y,
            angle: self.angle,
            cos: rotation.cos(),
            sin: -rotation.sin(),
            vx: velocity.x,
            vy: velocity.y,
            omega: -body.angvel(),
        }
    }
}

/// The carriage of a wheel with this body: kinematic where it has no mass of its own.
fn carriage(body: &WheelBody) -> RigidBodyBuilder {
    if body.carriage_mass == 0.0 {
        return RigidBodyBuilder::kinematic_velocity_based().can_sleep(false);
    }
    let mass = MassProperties::new(Vector::ZERO, body.carriage_mass, 0.0);
    RigidBodyBuilder::dynamic()
        .gravity_scale(0.0)
        .can_sleep(false)
        .locked_axes(LockedAxes::TRANSLATION_LOCKED_Y | LockedAxes::ROTATION_LOCKED)
        .additional_mass_properties(mass)
}
