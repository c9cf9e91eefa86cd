//! The door to rapier: the wheel's body, what guides and drives it, one step at a time.
//!
//! Fixed ground is no collider here. It acts through [`World::push_wheel`], so that contact
//! stiffness is a property of the ground and not of the solver; only loose stones collide.
//!
//! The body stands for all that moves vertically with the wheel (wheel, carriage slide and
//! counterweight); its weight is a force of the rig's, so the engine's gravity acts on stones only.

use super::engine::{WheelColliders, contact_load, joint_parameters, parameters};
use crate::quantity::SampleRate;
use crate::wheel::Wheel;
use rapier2d::prelude::*;

/// Pose and motion of the wheel; `y` up, angles and angular speed positive when driving forward.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelMotion {
    /// Axle along the track [m].
    pub x: f64,
    /// Axle above the track's datum [m].
    pub y: f64,
    /// Angle turned [rad].
    pub angle: f64,
    /// Cosine of the angle.
    pub cos: f64,
    /// Sine of the angle.
    pub sin: f64,
    /// Speed along the track [m/s].
    pub vx: f64,
    /// Speed away from the track [m/s].
    pub vy: f64,
    /// Angular speed [rad/s].
    pub omega: f64,
}

/// A force on the wheel through its axle and a moment about it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Along the track [N].
    pub fx: f64,
    /// Away from the track [N].
    pub fy: f64,
    /// About the axle [N·m], positive where it turns the wheel as driving forward does.
    pub torque: f64,
}

impl WheelMotion {
    /// The motion of the wheel's point that stands `[x, y]` [m] from the axle.
    pub fn at(&self, [x, y]: [f64; 2]) -> Self {
        Self {
            x: self.x + x,
            y: self.y + y,
            vx: self.vx + self.omega * y,
            vy: self.vy - self.omega * x,
            ..*self
        }
    }
}

impl Wrench {
    /// The same force where it acts at `[x, y]` [m] from the axle instead of at the axle.
    pub fn acting_at(self, [x, y]: [f64; 2]) -> Self {
        Self {
            torque: self.torque + (y * self.fx - x * self.fy),
            ..self
        }
    }

    /// Magnitude of the force [N].
    pub fn force(&self) -> f64 {
        libm::sqrt(self.fx * self.fx + self.fy * self.fy)
    }
}

impl std::ops::AddAssign for Wrench {
    fn add_assign(&mut self, other: Self) {
        self.fx += other.fx;
        self.fy += other.fy;
        self.torque += other.torque;
    }
}

/// How the wheel is guided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Guide {
    /// A carriage imposes the forward speed and a motor the wheel speed; the wheel rises freely.
    Carriage,
    /// As `Carriage`, clamped in height.
    ClampedCarriage,
    /// Nothing: the wheel rolls as it likes.
    #[cfg(test)]
    Free,
}

impl Guide {
    /// Whether a carriage and a motor impose the motion.
    fn drives(self) -> bool {
        matches!(self, Self::Carriage | Self::ClampedCarriage)
    }
}

/// The wheel's body as the engine sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelBody {
    /// Mass [kg] that moves vertically with the axle.
    pub mass: f64,
    /// Moment of inertia about the axle [kg·m²].
    pub inertia: f64,
}

/// Rigid bodies and their clock.
pub struct World {
    pub(super) physics: PhysicsWorld,
    pub(super) wheel: RigidBodyHandle,
    drive: Option<(RigidBodyHandle, ImpulseJointHandle)>,
    leg: Option<(RigidBodyHandle, f64)>,
    colliders: Option<WheelColliders>,
    dt: f64,
    angle: f64,
}

impl World {
    /// A world with one wheel, stepped at `rate`.
    pub fn new(body: WheelBody, guide: Guide, gravity: [f64; 2], rate: SampleRate) -> Self {
        let dt = rate.period();
        let mut physics = PhysicsWorld {
            gravity: Vector::new(gravity[0], gravity[1]),
            integration_parameters: joint_parameters(rate),
            ..PhysicsWorld::new()
        };
        let locked = match guide {
            Guide::ClampedCarriage => LockedAxes::TRANSLATION_LOCKED_Y,
            _ => LockedAxes::empty(),
        };
        let wheel = physics.insert_body(
            RigidBodyBuilder::dynamic()
                .gravity_scale(0.0)
                .can_sleep(false)
                .locked_axes(locked)
                .additional_mass_properties(MassProperties::new(
                    Vector::ZERO,
                    body.mass,
                    body.inertia,
                )),
        );
        let drive = guide.drives().then(|| {
            let carriage =
                physics.insert_body(RigidBodyBuilder::kinematic_velocity_based().can_sleep(false));
            let joint = GenericJointBuilder::new(JointAxesMask::LIN_X)
                .motor_model(JointAxis::AngX, MotorModel::AccelerationBased)
                .motor_velocity(JointAxis::AngX, 0.0, SERVO_STIFFNESS)
                .build();
            (
                carriage,
                physics.insert_impulse_joint(carriage, wheel, joint),
            )
        });
        Self {
            physics,
            wheel,
            drive,
            leg: None,
            colliders: None,
            dt,
            angle: 0.0,
        }
    }

    /// Puts the axle at `height` [m].
    pub fn place(&mut self, height: f64) {
        self.physics.bodies[self.wheel].set_translation(Vector::new(0.0, height), false);
    }

    /// Sets the carriage's speed [m/s] and the motor's [rad/s] for the next step.
    pub fn command(&mut self, forward_speed: f64, wheel_speed: f64) {
        let Some((carriage, drive)) = self.drive else {
            return;
        };
        let carriage = &mut self.physics.bodies[carriage];
        if carriage.linvel().x != forward_speed {
            carriage.set_linvel(Vector::new(forward_speed, 0.0), false);
        }
        let Some(joint) = self.physics.impulse_joints.get(drive) else {
            return;
        };
        if joint.data.motors[JointAxis::AngX as usize].target_vel != -wheel_speed
            && let Some(joint) = self.physics.impulse_joints.get_mut(drive, false)
        {
            joint
                .data
                .set_motor_velocity(JointAxis::AngX, -wheel_speed, SERVO_STIFFNESS);
        }
    }

    /// Sets the wheel in motion at once, as a run that starts rolling does.
    #[cfg(test)]
    pub fn launch(&mut self, forward_speed: f64, vertical_speed: f64, wheel_speed: f64) {
        let wheel = &mut self.physics.bodies[self.wheel];
        wheel.set_linvel(Vector::new(forward_speed, vertical_speed), false);
        wheel.set_angvel(-wheel_speed, false);
    }

    /// Loads the wheel for the next step with `wrench` in place of the last one.
    pub fn push_wheel(&mut self, wrench: Wrench) {
        let wheel = &mut self.physics.bodies[self.wheel];
        wheel.reset_forces(false);
        wheel.reset_torques(false);
        wheel.add_force(Vector::new(wrench.fx, wrench.fy), false);
        wheel.add_torque(-wrench.torque, false);
    }

    /// Gives the wheel an outline that stones meet, and the engine the parameters for stones.
    pub fn meet_stones(&mut self, wheel: &Wheel, rate: SampleRate) {
        self.physics.integration_parameters = parameters(rate);
        self.colliders = Some(WheelColliders::attach(&mut self.physics, self.wheel, wheel));
    }

    /// Load of stones on the wheel over the last step, and the lugs they press on with more than
    /// `touch_force` [N], one bit each; `None` in a world without stones.
    pub fn stone_load(&self, touch_force: f64) -> Option<(Wrench, u64)> {
        let colliders = self.colliders.as_ref()?;
        let load = |collider| {
            let [fx, fy, moment] = contact_load(&self.physics, collider);
            Wrench {
                fx,
                fy,
                torque: -moment,
            }
        };
        let (mut sum, mut touching) = (load(colliders.rim), 0);
        for (lug, collider) in colliders.lugs.iter().enumerate() {
            let on_lug = load(*collider);
            if on_lug.force() > touch_force {
                touching |= 1 << lug;
            }
            sum += on_lug;
        }
        Some((sum, touching))
    }

    /// Adds a body of `mass` [kg] above the axle, which starts at `height` [m] and moves
    /// vertically only.
    pub fn add_leg(&mut self, mass: f64, height: f64) {
        let body = self.physics.insert_body(
            RigidBodyBuilder::dynamic()
                .translation(Vector::new(0.0, height))
                .gravity_scale(0.0)
                .can_sleep(false)
                .locked_axes(LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::ROTATION_LOCKED)
                .additional_mass_properties(MassProperties::new(Vector::ZERO, mass, 0.0)),
        );
        self.leg = Some((body, mass));
    }

    /// Whether there is a leg.
    pub fn has_leg(&self) -> bool {
        self.leg.is_some()
    }

    /// How far [m] the leg's body stands above its place over `wheel`, and how fast it rises [m/s].
    pub fn leg_stretch(&self, wheel: &WheelMotion) -> Option<[f64; 2]> {
        let (leg, _) = self.leg?;
        let leg = &self.physics.bodies[leg];
        Some([leg.translation().y - wheel.y, leg.linvel().y - wheel.vy])
    }

    /// Loads the leg's body with `force` [N] upward, less a damping hand [1/s].
    pub fn push_leg(&mut self, force: f64, hand: f64) {
        let Some((leg, mass)) = self.leg else { return };
        let leg = &mut self.physics.bodies[leg];
        leg.reset_forces(false);
        leg.add_force(
            Vector::new(0.0, force - hand * mass * leg.linvel().y),
            false,
        );
    }

    /// Advances by one step.
    pub fn step(&mut self) {
        self.physics.step();
        self.angle -= self.physics.bodies[self.wheel].angvel() * self.dt;
    }

    /// The wheel now.
    pub fn wheel_motion(&self) -> WheelMotion {
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

    /// Load of carriage and motor on the wheel over the last step, where each step is solved once:
    /// in a world without stones.
    pub fn drive_wrench(&self) -> Wrench {
        let Some(joint) = self
            .drive
            .and_then(|(_, joint)| self.physics.impulse_joints.get(joint))
        else {
            return Wrench::default();
        };
        let motor = joint.data.motors[JointAxis::AngX as usize].impulse;
        Wrench {
            fx: -joint.impulses.x / self.dt,
            fy: 0.0,
            torque: motor / self.dt,
        }
    }
}

/// Stiffness of the velocity servo [1/s]: the motor's speed error decays within a step.
const SERVO_STIFFNESS: f64 = 1.0e9;
