//! The wheel: a free body, moved by rapier's own integrator without its pipeline.
//!
//! The ground acts on it by forces and nothing collides in the engine, so the broad phase, the islands and the solver of the
//! pipeline would have nothing to do, but cost seventy times the integration itself. Symplectic Euler, as in the pipeline:
//!
//! ```text
//! v' = v + M⁻¹ (F + F_c) Δt,   q' = q + v' Δt
//! ```
//!
//! A coordinate whose speed is imposed has as `F_c` the force that the constraint needs for it.

use super::motion::{WheelMotion, Wrench};
use super::mount::{Action, Actions};
use rapier2d::math::{Pose, Vector};
use rapier2d::prelude::{RigidBodyForces, RigidBodyMassProps, RigidBodyVelocity};

/// The wheel's body in the integrators.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WheelBody {
    /// Mass [kg] that moves vertically with the axle.
    pub mass: f64,
    /// Mass [kg] that moves along the track with it besides.
    pub carriage_mass: f64,
    /// Moment of inertia about the axle [kg·m²].
    pub inertia: f64,
    /// Whether it is clamped in height.
    pub clamped: bool,
}

/// The wheel's body.
pub(super) struct FreeBody {
    properties: RigidBodyMassProps,
    velocity: RigidBodyVelocity<f64>,
    pose: Pose,
    angle: f64,
}

impl FreeBody {
    pub fn new(body: &WheelBody) -> Self {
        let vertical = if body.clamped { 0.0 } else { 1.0 / body.mass };
        let along = 1.0 / (body.mass + body.carriage_mass);
        let mut properties = RigidBodyMassProps::default();
        properties.effective_inv_mass = Vector::new(along, vertical);
        properties.effective_world_inv_inertia = 1.0 / body.inertia;
        Self {
            properties,
            velocity: RigidBodyVelocity::zero(),
            pose: Pose::IDENTITY,
            angle: 0.0,
        }
    }

    /// Puts the axle at `height` [m].
    pub fn place(&mut self, height: f64) {
        self.pose.translation = Vector::new(0.0, height);
    }

    /// Sets the wheel in motion at once, as a run that starts rolling does.
    #[cfg(test)]
    pub fn launch(&mut self, forward_speed: f64, vertical_speed: f64, wheel_speed: f64) {
        self.velocity.linvel = Vector::new(forward_speed, vertical_speed);
        self.velocity.angvel = -wheel_speed;
    }

    /// Advances by `dt` [s] under `wrench` and what carriage and motor do.
    pub fn step(&mut self, wrench: Wrench, actions: &Actions, dt: f64) {
        let RigidBodyMassProps {
            effective_inv_mass,
            effective_world_inv_inertia,
            ..
        } = &self.properties;
        let mut forces = RigidBodyForces {
            force: Vector::new(wrench.fx, wrench.fy),
            torque: -wrench.torque,
            ..RigidBodyForces::default()
        };
        forces.force.x += match actions.along {
            Action::Force(force) => force,
            Action::Speed(speed) => {
                (speed - self.velocity.linvel.x) / (effective_inv_mass.x * dt) - wrench.fx
            }
        };
        forces.torque += match actions.about {
            Action::Force(torque) => -torque,
            Action::Speed(speed) => {
                (-speed - self.velocity.angvel) / (effective_world_inv_inertia * dt) + wrench.torque
            }
        };
        self.velocity = forces.integrate(dt, &self.velocity, &self.properties);
        self.pose = self.velocity.integrate(dt, &self.pose, &Vector::ZERO);
        self.angle -= self.velocity.angvel * dt;
    }

    /// The wheel now.
    pub fn motion(&self) -> WheelMotion {
        let (position, velocity) = (self.pose.translation, self.velocity.linvel);
        WheelMotion {
            x: position.x,
            y: position.y,
            angle: self.angle,
            cos: self.pose.rotation.re,
            sin: -self.pose.rotation.im,
            vx: velocity.x,
            vy: velocity.y,
            omega: -self.velocity.angvel,
        }
    }
}
