//! Soil under stones: a stone that lies in sand is borne by the columns it covers.
//!
//! A stone presses like a plate, without the stress map of a rolling wheel: each column below its
//! outline answers with the soil's pressure at its own depth, unloads steeply, and damps. Along
//! the track the soil holds it elastically up to its shear strength, within the shear
//! deformation modulus. Soil is dug out for a stone as it is put in: what lies below it is
//! undisturbed there, and carries nothing yet.

use super::soil_track::SoilTrack;
use super::stone_bed::{Load, StoneBed};
use super::stone_outline::StoneOutline;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Stones on one stretch of soil.
#[derive(Default)]
pub(super) struct StoneBearing {
    /// How far the soil under each stone, by its number, is sheared [m].
    stretch: HashMap<u64, f64>,
}

impl StoneBearing {
    /// Pushes every free stone of `bed` that lies in the soil for the next step of `dt` [s].
    pub fn push(&mut self, bed: &mut StoneBed, track: &mut SoilTrack, dt: f64) {
        let outlines: Vec<StoneOutline> = bed
            .near()
            .iter()
            .map(|stone| StoneOutline::new(stone, bed.depth(&stone.placed)))
            .collect();
        self.stretch
            .retain(|id, _| bed.near().iter().any(|stone| stone.id == *id));
        track.uncover();
        for (stone, outline) in bed.near_mut().iter_mut().zip(&outlines) {
            track.cover(outline);
            let stretch = self.stretch.entry(stone.id).or_insert_with(|| {
                track.dig_out(outline);
                0.0
            });
            if !stone.free {
                continue;
            }
            let [fx, fy, moment] = track.bear(outline, stretch, dt);
            stone.outside = Load {
                force: Vector3::new(fx, fy, 0.0),
                moment: Vector3::new(0.0, 0.0, moment),
            };
        }
    }
}
