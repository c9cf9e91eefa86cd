//! A stone in contact with soil.

use super::stone_bed::Stone;
use crate::terrain::stones::{Ball, extent, extent_at};

/// Outline of a stone in the plane of travel.
pub(super) struct StoneOutline {
    /// Spheres of the stone [m].
    balls: Vec<Ball>,
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
    /// The outline of a `stone` at this depth [m].
    pub fn new(stone: &Stone, depth: f64) -> Self {
        let (centre, velocity) = (stone.placed.position, stone.velocity);
        let ball = |centre, radius| Ball { centre, radius };
        Self {
            balls: stone
                .balls
                .iter()
                .map(|now| ball(now.centre, now.radius))
                .collect(),
            centre: [centre.x, centre.y],
            velocity: [velocity.x, velocity.y],
            spin: stone.spin.z,
            depth,
        }
    }

    /// Extent along the track [m].
    pub fn extent(&self) -> [f64; 2] {
        extent(&self.balls)
    }

    /// Height [m] of the underside at `x` [m].
    pub fn underside(&self, x: f64) -> f64 {
        extent_at(&self.balls, x).map_or(f64::INFINITY, |[low, _]| low)
    }
}
