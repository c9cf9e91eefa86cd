//! Soil that a sunken wheel pushes ahead of it.
//!
//! Two forms. In the first the passive pressure of a wall as high as the wheel's sinkage acts `B`
//! times, at once and without a heap, `R = B b (½ γ z² K_p + 2 c z √K_p)`. In the second a heap
//! grows: of the soil in the wheel's way, `z` a metre, the wheel pushes the share `χ` ahead, and
//! the heap loses to both sides what lies in it over a way of one wheel width,
//!
//! ```text
//! dA/dx = χ z - A/b,   h = √(2 A tan β),
//! R = b (½ γ ((z + h)² - z²) K_p + 2 c h √K_p)
//! ```
//!
//! with `A` \[m²\] its section along the track and `β` the angle of repose: history, as a heap takes
//! a few wheel widths to grow; `R` is what it adds to the passive pressure on the wheel's face.
//!
//! Either takes pull away and leaves the torque: its line is drawn through the axle.
//!
//! # Reference
//! Passive pressure: Rankine (1857). Bulldozing resistance before a wheel as passive pressure,
//! beside compaction resistance: Bekker (1969), *Introduction to Terrain-Vehicle Systems*; Hegedus
//! (1960), Land Locomotion Research Laboratory Report 61, for blades. A skidding smooth wheel
//! measured `B` from 1 to 2.6. The growth of the heap is a mass balance, its loss over one width a guess.

use crate::quantity::GRAVITY;
use crate::soil::Soil;
use libm::{exp, sqrt, tan};

/// The heap ahead of a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Heap {
    /// Section along the track [m²].
    section: f64,
}

impl Heap {
    /// Grows the heap of a wheel of `width` \[m\] at `sinkage` \[m\] over a `way` \[m\] forward.
    pub fn advance(&mut self, soil: &Soil, width: f64, sinkage: f64, way: f64) {
        let full = soil.departures.heap * sinkage.max(0.0) * width;
        self.section = full + (self.section - full) * exp(-way.max(0.0) / width);
    }

    /// Height \[m\] of the heap above the undisturbed soil.
    pub fn height(&self, soil: &Soil) -> f64 {
        sqrt(2.0 * self.section * tan(soil.repose_angle_deg.to_radians()))
    }
}

/// Force \[N\] against the travel of a wheel of `width` \[m\] at `sinkage` \[m\] behind a `heap`.
pub fn resistance(soil: &Soil, width: f64, sinkage: f64, heap: &Heap) -> f64 {
    let (z, h) = (sinkage.max(0.0), heap.height(soil));
    let passive = soil.passive_pressure_coefficient();
    let weight = 0.5 * soil.bulk_density * GRAVITY * passive;
    let cohesion = 2.0 * soil.cohesion * sqrt(passive);
    let of_heap = weight * h * (h + 2.0 * z) + cohesion * h;
    let of_face = weight * z * z + cohesion * z;
    width * (of_heap + soil.departures.front_pressure * of_face)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::departures::Departures;
    use crate::soil::table_6;

    fn soil(heap: f64, front_pressure: f64) -> Soil {
        Soil {
            friction_angle_deg: 30.0,
            cohesion: 0.0,
            bulk_density: 1600.0,
            departures: Departures {
                heap,
                front_pressure,
                ..Departures::NONE
            },
            ..table_6::sand()
        }
    }

    fn heap_after(soil: &Soil, way: f64) -> Heap {
        let mut heap = Heap::default();
        for _ in 0..1000 {
            heap.advance(soil, 0.15, 0.01, way / 1000.0);
        }
        heap
    }

    #[test]
    fn a_heap_grows_by_the_share_of_soil_in_the_way_until_as_much_leaves_sideways() {
        let soil = soil(0.3, 0.0);
        let short = heap_after(&soil, 0.0015).section;
        // Over a hundredth of a width hardly anything has left: half of that hundredth.
        assert!((short / (0.3 * 0.01 * 0.0015) - 1.0).abs() < 0.006);
        let long = heap_after(&soil, 3.0).section;
        assert!((long / (0.3 * 0.01 * 0.15) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_heap_adds_the_passive_pressure_of_its_height() {
        let soil = soil(0.3, 0.0);
        let heap = heap_after(&soil, 3.0);
        let h = heap.height(&soil);
        // Rankine: K_p = 3 at 30°.
        let wall = |height: f64| 0.15 * 0.5 * 1600.0 * GRAVITY * height * height * 3.0;
        let expected = wall(0.01 + h) - wall(0.01);
        assert!((resistance(&soil, 0.15, 0.01, &heap) / expected - 1.0).abs() < 1e-12);
        assert!(expected > 1.0 && expected < 20.0, "{expected} N");
    }

    #[test]
    fn pressure_on_the_face_alone_grows_with_the_square_of_sinkage() {
        let (soil, none) = (soil(0.0, 0.5), Heap::default());
        let ratio = resistance(&soil, 0.15, 0.02, &none) / resistance(&soil, 0.15, 0.01, &none);
        assert!((ratio - 4.0).abs() < 1e-12);
    }

    #[test]
    fn ideal_soil_is_not_pushed_ahead() {
        let soil = soil(0.0, 0.0);
        assert_eq!(resistance(&soil, 0.15, 0.02, &heap_after(&soil, 1.0)), 0.0);
    }
}
