//! Soil under stones: a stone that lies in sand is borne by the columns it covers.
//!
//! A stone presses like a plate, without the stress map of a rolling wheel: each column below its
//! outline answers with the soil's pressure at its own depth, unloads steeply, and damps. Along
//! the track the soil holds it elastically up to its shear strength, within the shear
//! deformation modulus. Soil is dug out for a stone as it is put in: what lies below it is
//! undisturbed there, and carries nothing yet.

use super::soil_track::SoilTrack;
use super::stone_bed::StoneBed;
use crate::terrain::stones::{PlacedStone, extent_at};
use rapier2d::prelude::*;
use std::collections::HashMap;

/// Stones on one stretch of soil.
#[derive(Default)]
pub(super) struct StoneBearing {
    /// How far the soil under each stone is sheared [m].
    stretch: HashMap<RigidBodyHandle, f64>,
}

/// A stone as the soil meets it.
pub(super) struct StoneOutline {
    /// Corners in the track's frame [m], counter-clockwise.
    pub corners: Vec<[f64; 2]>,
    /// Centroid [m].
    pub centre: [f64; 2],
    /// Velocity of the centroid [m/s].
    pub velocity: [f64; 2],
    /// Spin [rad/s], counter-clockwise.
    pub spin: f64,
    /// Depth [m] along the axle.
    pub depth: f64,
}

impl StoneOutline {
    fn new(stone: &PlacedStone, depth: f64, body: &RigidBody) -> Self {
        let (centre, rotation, velocity) = (body.translation(), body.rotation(), body.linvel());
        let [cos, sin] = [rotation.cos(), rotation.sin()];
        let corner =
            |[x, y]: [f64; 2]| [centre.x + cos * x - sin * y, centre.y + sin * x + cos * y];
        Self {
            corners: stone.shape.corners.iter().map(|&at| corner(at)).collect(),
            centre: [centre.x, centre.y],
            velocity: [velocity.x, velocity.y],
            spin: body.angvel(),
            depth,
        }
    }

    /// Extent along the track [m].
    pub fn extent(&self) -> [f64; 2] {
        let along = self.corners.iter().map(|corner| corner[0]);
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    }

    /// Height [m] of the underside at `x` [m].
    pub fn underside(&self, x: f64) -> f64 {
        extent_at(&self.corners, x).map_or(f64::INFINITY, |[low, _]| low)
    }
}

impl StoneBearing {
    /// Pushes every free stone of `bed` that lies in the soil for the next step of `dt` [s].
    pub fn push(
        &mut self,
        world: &mut PhysicsWorld,
        bed: &StoneBed,
        track: &mut SoilTrack,
        dt: f64,
    ) {
        let stones: Vec<(RigidBodyHandle, StoneOutline, bool)> = bed
            .in_world()
            .map(|(body, stone, free)| {
                let outline = StoneOutline::new(stone, bed.depth(stone), &world.bodies[body]);
                (body, outline, free)
            })
            .collect();
        self.stretch
            .retain(|body, _| stones.iter().any(|(other, _, _)| other == body));
        track.uncover();
        for (body, outline, free) in &stones {
            track.cover(outline);
            let stretch = self.stretch.entry(*body).or_insert_with(|| {
                track.dig_out(outline);
                0.0
            });
            if !free {
                continue;
            }
            let [fx, fy, moment] = track.bear(outline, stretch, dt);
            let body = &mut world.bodies[*body];
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_force(Vector::new(fx, fy), false);
            body.add_torque(moment, false);
        }
    }
}
