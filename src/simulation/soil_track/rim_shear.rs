//! Shear displacement between rim and soil, carried by the rim.
//!
//! Wong and Reece follow a point of the wheel from its entry: `dj = (r_s - (v/ω) cos θ) ω dt`.
//! So the displacement is kept at places on the rim that turn with it, not in the columns of the
//! ground: a column under a slipping wheel stays in contact longer and would count about
//! `1/(1 - s)` more. Starts, stops, changes of slip and spinning in place are remembered.

use super::Contact;
use libm::{acos, cos};
use std::f64::consts::TAU;

/// Places on the rim.
const PLACES: usize = 512;

/// Shear displacement [m] at every place, positive where the rim slipped backward.
pub(super) struct RimShear {
    places: Vec<f64>,
}

impl RimShear {
    pub fn new() -> Self {
        Self {
            places: vec![0.0; PLACES],
        }
    }

    /// Shears what is in the soil further and forgets what is out of it.
    pub fn advance(&mut self, contact: &Contact, wheel_angle: f64, radius: f64, shear_radius: f64) {
        let angles = contact.depth.angles;
        // The surface on which the soil shears reaches out beyond the rim and enters earlier.
        let entry = acos((radius / shear_radius * cos(angles.entry)).clamp(-1.0, 1.0));
        let step = TAU / PLACES as f64;
        for index in 0..PLACES {
            let angle = contact.direction * angle_of(index, wheel_angle);
            if angle > angles.exit - step && angle < entry {
                let sliding =
                    shear_radius * contact.wheel_speed - contact.forward_speed * cos(angle);
                self.places[index] += sliding * contact.elapsed;
            } else {
                self.places[index] = 0.0;
            }
        }
    }

    /// Shear displacement [m] at `angle` [rad] from straight down, positive ahead of a wheel that
    /// travels in `direction`.
    pub fn at(&self, angle: f64, wheel_angle: f64, direction: f64) -> f64 {
        let place = place(direction * angle, wheel_angle);
        let index = place.floor();
        let between = place - index;
        let index = index as usize % PLACES;
        let [here, next] = [self.places[index], self.places[(index + 1) % PLACES]];
        here + between * (next - here)
    }
}

/// Place on the rim, in [0, PLACES), at `angle` [rad] from straight down, positive forward.
fn place(angle: f64, wheel_angle: f64) -> f64 {
    let turns = (angle + wheel_angle) / TAU;
    (turns - turns.floor()) * PLACES as f64
}

/// Angle [rad] of a place from straight down, positive forward, in (-π, π].
fn angle_of(index: usize, wheel_angle: f64) -> f64 {
    let turns = index as f64 / PLACES as f64 - wheel_angle / TAU;
    (turns - (turns - 0.5).ceil()) * TAU
}
