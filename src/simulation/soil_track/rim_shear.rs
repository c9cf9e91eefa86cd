//! Shear displacement between rim and soil, carried by the rim.
//!
//! Wong and Reece follow a point of the wheel from its entry: `dj = (r_s - (v/ω) cos θ) ω dt`.
//! So the displacement is kept at places on the rim that turn with it, not in the columns of the
//! ground: a column under a slipping wheel stays in contact longer and would count about
//! `1/(1 - s)` more. Starts, stops, changes of slip and spinning in place are remembered.

use super::Contact;
use libm::{acos, cos, sincos};
use std::f64::consts::TAU;
use std::ops::Range;

/// Places on the rim.
const PLACES: usize = 512;

/// Angle between places [rad].
const STEP: f64 = TAU / PLACES as f64;

/// Shear displacement [m] at every place, positive where the rim slipped backward.
pub(super) struct RimShear {
    places: Vec<f64>,
    /// Places in the soil, counted on through turns.
    in_soil: Range<i64>,
}

impl RimShear {
    pub fn new() -> Self {
        Self {
            places: vec![0.0; PLACES],
            in_soil: 0..0,
        }
    }

    /// Counts displacement in the other direction of travel: a wheel that reverses goes on from the shear it has.
    pub fn turn_around(&mut self) {
        self.places.iter_mut().for_each(|shear| *shear = -*shear);
    }

    /// Shears what is in the soil further and forgets what is out of it.
    pub fn advance(&mut self, contact: &Contact, wheel_angle: f64, radius: f64, shear_radius: f64) {
        let angles = contact.depth.angles;
        // The surface on which the soil shears reaches out beyond the rim and enters earlier.
        let entry = acos((radius / shear_radius * cos(angles.entry)).clamp(-1.0, 1.0));
        let exit = angles.exit - STEP;
        let ahead = |angle: f64| (contact.direction * angle + wheel_angle) / STEP;
        let [one, other] = [ahead(exit), ahead(entry)];
        let in_soil = one.min(other).floor() as i64 + 1..one.max(other).ceil() as i64;
        for place in std::mem::replace(&mut self.in_soil, in_soil.clone()) {
            if !in_soil.contains(&place) {
                self.places[index(place)] = 0.0;
            }
        }
        // Cosine and sine from place to place by rotation: within 1e-14 over a quarter turn.
        let first = in_soil.start as f64 * STEP - wheel_angle;
        let (mut sine, mut cosine) = sincos(first);
        let (sine_step, cosine_step) = sincos(STEP);
        for place in in_soil {
            let sliding = shear_radius * contact.wheel_speed - contact.forward_speed * cosine;
            self.places[index(place)] += sliding * contact.elapsed;
            (sine, cosine) = (
                sine * cosine_step + cosine * sine_step,
                cosine * cosine_step - sine * sine_step,
            );
        }
    }

    /// Shear displacement [m] at `angle` [rad] from straight down, positive ahead of a wheel that
    /// travels in `direction`.
    pub fn at(&self, angle: f64, wheel_angle: f64, direction: f64) -> f64 {
        let place = (direction * angle + wheel_angle) / STEP;
        let before = whole_below(place);
        let between = place - before as f64;
        let [here, next] = [self.places[index(before)], self.places[index(before + 1)]];
        here + between * (next - here)
    }
}

/// Where a place stands among the places of one turn.
fn index(place: i64) -> usize {
    place.rem_euclid(PLACES as i64) as usize
}

/// `floor`, without the call that it is where the processor's own cannot be counted on.
fn whole_below(x: f64) -> i64 {
    let truncated = x as i64;
    truncated - i64::from((truncated as f64) > x)
}
