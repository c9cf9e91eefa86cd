//! The wheel's body, and the body above it that a leg's spring carries.
//!
//! The ground is no collider. It acts through the wrench of a step, so that contact stiffness is a property of the ground and not
//! of a solver. The body stands for all that moves vertically with the wheel (wheel, carriage slide and counterweight).

use super::free_body::FreeBody;
pub(super) use super::free_body::WheelBody;
use super::motion::{WheelMotion, Wrench};
use super::mount::Actions;
use crate::quantity::SampleRate;

/// A body above the axle that moves vertically only: what a leg's spring carries.
#[derive(Debug, Clone, Copy)]
struct SprungBody {
    mass: f64,
    height: f64,
    speed: f64,
    force: f64,
}

/// The wheel, and the sprung body of a leg, and their clock.
pub(super) struct World {
    body: FreeBody,
    leg: Option<SprungBody>,
    dt: f64,
}

impl World {
    /// A wheel stepped at `rate`.
    pub fn new(body: &WheelBody, rate: SampleRate) -> Self {
        Self {
            body: FreeBody::new(body),
            leg: None,
            dt: rate.period(),
        }
    }

    /// Puts the axle at `height` [m].
    pub fn place(&mut self, height: f64) {
        self.body.place(height);
    }

    /// Adds a body of `mass` [kg] above the axle, which starts at `height` [m] and moves
    /// vertically only.
    pub fn add_leg(&mut self, mass: f64, height: f64) {
        self.leg = Some(SprungBody {
            mass,
            height,
            speed: 0.0,
            force: 0.0,
        });
    }

    /// Whether there is a leg.
    pub fn has_leg(&self) -> bool {
        self.leg.is_some()
    }

    /// How far [m] the leg's body stands above its place over `wheel`, and how fast it rises [m/s].
    pub fn leg_stretch(&self, wheel: &WheelMotion) -> Option<[f64; 2]> {
        let leg = self.leg?;
        Some([leg.height - wheel.y, leg.speed - wheel.vy])
    }

    /// Loads the leg's body with `force` [N] upward, less a `damping` [1/s] of its mass.
    pub fn push_leg(&mut self, force: f64, damping: f64) {
        if let Some(leg) = &mut self.leg {
            leg.force = force - damping * leg.mass * leg.speed;
        }
    }

    /// Advances by one step, in which `wrench` acts on the wheel, and carriage and motor.
    pub fn step(&mut self, wrench: Wrench, actions: &Actions) {
        self.body.step(wrench, actions, self.dt);
        if let Some(leg) = &mut self.leg {
            leg.speed += leg.force / leg.mass * self.dt;
            leg.height += leg.speed * self.dt;
        }
    }

    /// The wheel now.
    pub fn motion(&self) -> WheelMotion {
        self.body.motion()
    }

    /// The wheel's body.
    #[cfg(test)]
    pub fn free_body(&mut self) -> &mut FreeBody {
        &mut self.body
    }
}
