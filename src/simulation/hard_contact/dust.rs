//! Dust between the wheel and hard ground.
//!
//! Under a lug's edge or the rim the dust is pressed as a soft layer over a hard base: it gives
//! way until little is left, and that little carries what its confinement allows. The thicker the
//! dust, the larger the part of the load that it carries and the stone does not, and that part
//! slips as dust slips on a plate. A lug crushes the dust once, so its landing is softened and
//! does not bounce.
//!
//! # Reference
//! Moduli: lunar soil, Carrier, Olhoeft, Mendell (1991), *Lunar Sourcebook*, ch. 9. Friction: sand
//! on a smooth plate, 18.4°.

use crate::soil::hard_base::HardBase;
use crate::soil::pressure_sinkage::PressureSinkage;
use crate::wheel::Wheel;
use libm::sqrt;

/// Friction coefficient [-] of dust on a wheel's smooth metal: tan 18.4°.
pub(super) const FRICTION: f64 = 0.33;

/// Cohesive modulus [N/m²] and frictional modulus [N/m³] of dust of exponent 1.
const MODULI: [f64; 2] = [1.4e3, 8.2e5];

/// Stiffness [Pa/m] on unloading of dust far above its base: ten times its modulus.
const UNLOADING: f64 = 8.2e6;

/// Dust under one part of the wheel.
pub(super) struct DustFilm {
    thickness: f64,
    law: PressureSinkage,
    /// Area [m²] pressed: a flat part, and one that grows with the root of the depth [m^1.5].
    area: [f64; 2],
}

impl DustFilm {
    /// Dust of `thickness` [m] under the edge of a lug; none where there is no dust or no lug.
    pub fn under_lug(thickness: f64, wheel: &Wheel) -> Option<Self> {
        let edge = wheel.lugs?.thickness;
        Self::new(thickness, wheel, [edge * wheel.width, 0.0])
    }

    /// Dust of `thickness` [m] under the rim, which meets it over `√(2rd)` ahead of its summit;
    /// the mean of its pressure there is two thirds of the greatest.
    pub fn under_rim(thickness: f64, wheel: &Wheel) -> Option<Self> {
        let area = 2.0 / 3.0 * wheel.width * sqrt(2.0 * wheel.radius);
        Self::new(thickness, wheel, [0.0, area])
    }

    fn new(thickness: f64, wheel: &Wheel, area: [f64; 2]) -> Option<Self> {
        let [cohesive, frictional] = MODULI;
        let law = PressureSinkage {
            modulus: cohesive / wheel.width + frictional,
            exponent: 1.0,
            unloading_stiffness: UNLOADING,
            precompression: 0.0,
            rebound: 0.0,
            base: HardBase {
                nearness: 1.0 / thickness,
                sudden: 0.0,
            },
        };
        (thickness > 0.0).then_some(Self {
            thickness,
            law,
            area,
        })
    }

    /// Force [N] of the dust on a part of the wheel that lies `indentation` [m] below the stone's
    /// surface, or above it where that is below 0, and has crushed the dust to `crushed` [m].
    pub fn push(&self, indentation: f64, crushed: &mut f64) -> f64 {
        let depth = indentation + self.thickness;
        if depth <= 0.0 {
            *crushed = 0.0;
            return 0.0;
        }
        *crushed = crushed.max(depth);
        let area = self.area[0] + self.area[1] * sqrt(depth);
        area * self.law.reloading_pressure(depth, *crushed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dust_is_crushed_once_and_does_not_push_back() {
        let film = DustFilm::under_lug(0.001, &Wheel::single_wheel()).unwrap();
        let mut crushed = 0.0;
        let landing = film.push(-3.0e-5, &mut crushed);
        assert!(landing > 5.0, "{landing} N");
        assert_eq!(film.push(-1.0e-4, &mut crushed), 0.0);
        let again = film.push(-3.0e-5, &mut crushed);
        assert!((again / landing - 1.0).abs() < 1e-12);
        film.push(-0.002, &mut crushed);
        assert_eq!(crushed, 0.0);
    }

    #[test]
    fn the_thicker_the_dust_the_more_of_the_load_it_can_carry() {
        let carried = |thickness| {
            let film = DustFilm::under_lug(thickness, &Wheel::single_wheel()).unwrap();
            film.push(0.0, &mut 0.0)
        };
        assert!((carried(4.0e-4) / carried(2.0e-4) - 2.0).abs() < 1e-9);
        assert!(carried(5.0e-5) < 25.0 && carried(5.0e-4) > 100.0);
    }

    #[test]
    fn a_clean_stone_and_a_smooth_wheel_have_no_film_under_lugs() {
        let smooth = Wheel {
            lugs: None,
            ..Wheel::single_wheel()
        };
        assert!(DustFilm::under_lug(0.0, &Wheel::single_wheel()).is_none());
        assert!(DustFilm::under_lug(0.001, &smooth).is_none());
        assert!(DustFilm::under_rim(0.001, &smooth).is_some());
    }
}
