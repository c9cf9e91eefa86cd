//! Soil that lugs carry along: they dig the ground under the wheel and leave it behind the wheel.
//!
//! Soil between lugs moves with the wheel, as a layer between the rim and the surface along which it
//! shears ([`crate::soil::lug_action`]). In the ground's frame the layer, of thickness `h`, slides
//! backward at the slip speed `ω r_h - v` of its mean radius `r_h`, so that an area
//!
//! ```text
//! q = h (ω r_h - v)
//! ```
//!
//! of soil [m²/s, of a section along the track] passes backward under the wheel. Spaces between lugs
//! enter empty and fill with what they cut. Soil is conserved: in steady rolling the ground under the
//! wheel lies lower by
//!
//! ```text
//! d = q/v = h κ,      κ = ω r_h/v - 1 ≈ s/(1 - s)
//! ```
//!
//! than the soil that comes upon it, and behind the wheel, where the layer leaves the ground, it is
//! as high again as without digging. Pressure and shear follow the sinkage into that lowered
//! ground; the sinkage of the wheel is `d` greater. At an angle `θ` of the contact the layer is
//! `h/cos θ` thick, measured downward. Where its underside lies less than `d + h/cos θ` below the undisturbed
//! surface, at `e`, it is not full, and the ground is lowered by `e κ/(κ + 1/cos θ)`.
//!
//! # What decides the thickness
//! With spaces that are full to the edges of the lugs, `h = l`, the balance of mass alone gives
//! Reece's slip-sinkage of a track, `z = l s/(1 - s)`. Between lugs that stand apart soil stays
//! where it is: the layer that moves is the one that the shear radius is the mean of, `h = λ l`. On
//! measured sinkages of a lugged wheel (Ding et al. 2011, `tests/ding2011.rs`), which neither was
//! chosen on, `λ l` is within 7 % at slips of 0.2 to 0.4 and 19 % short at 0.6, `l` 30 % too much at 0.2
//! to 0.4 and 21 % at 0.6. Soil left standing between lugs that slide over it by more than their spacing must
//! break, so the layer thickens at high slip; six points do not determine by how much.
//!
//! # Reference
//! Slip-sinkage of lugs by the soil they remove: Reece (1965), *Principles of Soil-Vehicle
//! Mechanics*, Proc. Inst. Mech. Eng. (Automobile Division) 180(1):45-66. The balance of mass is derived here.

use crate::soil::Soil;
use crate::soil::lug_action::{carried_layer, shear_radius};
use crate::soil::real::Real;
use crate::soil::rolling::Rolling;
use crate::wheel::Wheel;

/// The layer of soil that moves with the lugs of a wheel in steady rolling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarriedSoil<T = f64> {
    /// Thickness `h` [m] of the full layer.
    thickness: T,
    /// Advance of the axle over that of the layer on the wheel, `1/(1 + κ)` [-].
    advance: T,
}

/// Radius `r_h` [m] of the middle of the layer.
pub(crate) fn mean_radius<T: Real>(wheel: &Wheel, soil: &Soil<T>) -> T {
    shear_radius(wheel, soil) - carried_layer(wheel, soil) * 0.5
}

impl<T: Real> CarriedSoil<T> {
    /// The layer on `wheel` in `soil`.
    pub fn new(wheel: &Wheel, soil: &Soil<T>, rolling: Rolling<T>) -> Self {
        Self {
            thickness: carried_layer(wheel, soil),
            advance: rolling.travel / mean_radius(wheel, soil),
        }
    }

    /// Depth \[m\] by which the ground is lowered where the underside of the layer, at an angle of cosine `cos`, lies
    /// `reach` \[m\] below ground that nothing was taken from; below 0 where soil is pushed ahead.
    pub fn dug(&self, reach: T, cos: T) -> T {
        let (reach, slid) = (reach.larger(T::constant(0.0)), -self.advance + 1.0);
        let lost = slid * cos + self.advance;
        if self.thickness * lost < reach * self.advance * cos {
            self.thickness * slid / self.advance
        } else {
            reach * slid * cos / lost
        }
    }

    /// The same under the lowest point of a rim that has sunk by `sinkage` \[m\].
    pub fn dug_below(&self, sinkage: T) -> T {
        self.dug(sinkage + self.thickness, T::constant(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::table_6;
    use crate::wheel::Lugs;

    fn wheel() -> Wheel {
        let lugs = Some(Lugs {
            count: 30,
            height: 0.010,
            thickness: 0.002,
            edge_radius: None,
        });
        Wheel {
            lugs,
            ..Wheel::rover()
        }
    }

    fn carried(slip: f64) -> CarriedSoil {
        let wheel = wheel();
        CarriedSoil::new(&wheel, &table_6::sand(), Rolling::new(wheel.radius, slip))
    }

    #[test]
    fn a_full_layer_digs_its_thickness_times_its_slip_over_the_advance() {
        let thickness = carried_layer(&wheel(), &table_6::sand());
        // r_h ω/v - 1 at slip 0.6 by hand.
        let slid = (0.155 + 0.5 * thickness) / (0.4 * 0.155) - 1.0;
        let dug = carried(0.6).dug_below(0.020);
        assert!((dug / (thickness * slid) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_dug_and_what_is_carried_balance_where_the_layer_is_not_full() {
        let layer = carried(0.5);
        let (reach, cos) = (0.001, 0.9);
        let dug = layer.dug(reach, cos);
        // Of the layer, h/cos θ thick, what is left above the underside moves backward at κ times the advance.
        let slid = 1.0 / layer.advance - 1.0;
        assert!((dug - (reach - dug) * cos * slid).abs() < 1e-15);
        assert_eq!(layer.dug(-0.001, cos), 0.0);
    }

    #[test]
    fn the_depth_dug_has_no_jump_where_the_layer_fills() {
        for slip in [-0.2, 0.1, 0.6] {
            let layer = carried(slip);
            let cos = 0.9;
            let full = layer.thickness * (1.0 / layer.advance - 1.0 + 1.0 / cos);
            let [below, above] = [1.0 - 1e-9, 1.0 + 1e-9].map(|part| layer.dug(full * part, cos));
            let difference = above - below;
            assert!(difference.abs() < 1e-10);
        }
    }

    #[test]
    fn a_wheel_without_lugs_digs_nothing_and_one_that_spins_in_place_all_it_reaches() {
        let smooth = Wheel {
            lugs: None,
            ..wheel()
        };
        let soil = table_6::sand();
        let rolling = Rolling::new(smooth.radius, 0.4);
        assert_eq!(
            CarriedSoil::new(&smooth, &soil, rolling).dug_below(0.02),
            0.0
        );
        let spinning = carried(1.0);
        assert!((spinning.dug_below(0.02) - 0.02 - spinning.thickness).abs() < 1e-15);
    }
}
