//! Soil that lugs carry along the track.
//!
//! The layer between rim and shear surface slides over the ground by `(ω r_h - v) dt` a step
//! ([`crate::soil::carried_soil`]). Every column hands its part of it to the next one backward: all of the
//! layer where the rim bears, else what stands above the shear surface. So the ground ahead of the
//! contact is lowered, and raised again behind it where lugs leave it. A braked wheel pushes soil
//! ahead. Slopes slide at the angle of repose, along the track and, from what stands above undisturbed
//! ground, to both sides of it ([`Columns::spread`]). Nothing else is lost or gained.
//!
//! The layer's speed is that of its mean radius everywhere. A layer that also moved with the rim's
//! curvature would be pushed ahead by `h (1/cos θ - 1)` where it enters and come back by as much:
//! a tenth of a millimetre, and nothing over the whole contact.

use super::columns::{COLUMN, Columns};
use super::{Contact, WheelGeometry, WheelMotion};
use crate::soil::Soil;
use crate::soil::carried_soil::mean_radius;
use crate::soil::lug_action::{carried_layer, shear_radius};
use crate::wheel::Wheel;
use libm::sqrt;
use std::ops::Range;

/// Way [m] of the layer after which soil spreads to the sides again.
const SPREAD: f64 = 1.0e-4;

/// The layer that moves with the lugs.
pub(super) struct Transport {
    /// Its thickness [m].
    thickness: f64,
    /// Radius [m] of its middle and of its underside.
    middle: f64,
    underside: f64,
    /// Way [m] that the layer has slid since soil last spread to the sides.
    way: f64,
}

impl Transport {
    pub fn new(wheel: &Wheel, soil: &Soil) -> Self {
        Self {
            thickness: carried_layer(wheel, soil),
            middle: mean_radius(wheel, soil),
            underside: shear_radius(wheel, soil),
            way: 0.0,
        }
    }

    /// Carries soil over the time since the field was last worked out; the rim bears on `under`.
    pub fn carry(
        &mut self,
        wheel: &WheelGeometry,
        motion: &WheelMotion,
        contact: &Contact,
        under: Range<i64>,
        columns: &mut Columns,
    ) {
        if self.thickness == 0.0 {
            return;
        }
        let slid = (self.middle * contact.wheel_speed - contact.forward_speed) * contact.elapsed;
        let slid = -contact.direction * slid.clamp(-0.5 * COLUMN, 0.5 * COLUMN);
        let layer = Layer {
            wheel_x: motion.x,
            wheel_y: motion.y,
            rim: wheel.radius * wheel.radius,
            underside: self.underside * self.underside,
            under,
        };
        self.slide(&layer, columns, self.thickness * slid);
        self.way += slid.abs();
        if self.way >= SPREAD {
            let near = 1.5 * wheel.tip_radius;
            columns.spread([motion.x - near, motion.x + near], wheel.width);
            self.way = 0.0;
        }
    }

    /// Hands soil from column to column, from the last one that reaches into the layer to the first.
    fn slide(&self, layer: &Layer, columns: &mut Columns, area: f64) {
        let all = layer.extent(columns);
        let middle = (layer.wheel_x / COLUMN).round() as i64;
        let start = (all.start..middle)
            .rev()
            .find(|index| layer.fill(columns, *index) == 0.0)
            .unwrap_or(all.start);
        if start + 1 >= all.end {
            return;
        }
        let (mut last, mut reached) = (layer.fill(columns, start), start);
        // What a column gets and gives is netted first: soil that only passes over it leaves it as dense as it was.
        let mut gets = 0.0;
        for index in start + 1..all.end {
            let here = layer.fill(columns, index);
            let giver = if area > 0.0 { last } else { here };
            let open = columns.can_pass(index - 1) && columns.can_pass(index);
            let passes = if open { area * giver } else { 0.0 };
            columns.carry(index - 1, (gets - passes) / COLUMN);
            (gets, last, reached) = (passes, here, index);
            if here == 0.0 && index > middle {
                break;
            }
        }
        columns.carry(reached, gets / COLUMN);
    }
}

/// Where the layer is.
struct Layer {
    wheel_x: f64,
    wheel_y: f64,
    /// Squares of the radii [m²] of the rim and of the underside.
    rim: f64,
    underside: f64,
    /// Columns that the rim may bear on.
    under: Range<i64>,
}

impl Layer {
    /// Columns below it.
    fn extent(&self, columns: &Columns) -> Range<i64> {
        let half = 0.95 * sqrt(self.underside);
        columns.indices(self.wheel_x - half, self.wheel_x + half)
    }

    /// Part [-] of it that soil of a column takes up.
    fn fill(&self, columns: &Columns, index: i64) -> f64 {
        if self.under.contains(&index) && columns.is_loaded(index) {
            return 1.0;
        }
        let along = index as f64 * COLUMN - self.wheel_x;
        let underside = sqrt(self.underside - along * along);
        let above = columns.surface_at(index).height - self.wheel_y + underside;
        if above <= 0.0 {
            return 0.0;
        }
        let rim = sqrt((self.rim - along * along).max(0.0));
        (above / (underside - rim)).min(1.0)
    }
}
