//! The simplified displacements: the reference vibration, magnified and stretched (Eq. 45-48).

use super::flat_ground;
use super::rolling::Stay;
use crate::wheel::Wheel;
use libm::{cos, floor};

/// How a vibration differs from the reference vibration.
///
/// The paper puts `C_M` slightly above 1 and `C_f = 1` where all lugs touch (ALCT), both above 1
/// where some miss (SLCT), and `C_M` below 1 with `C_f = 1` where they enter the soil (LEIS).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaling {
    /// Amplitude over the reference's, `C_M` [-].
    pub amplitude: f64,
    /// Turn between contacts over the lug angle, `C_f` [-]: the frequency falls by it.
    pub stretch: f64,
}

impl Scaling {
    /// The reference itself.
    pub const REFERENCE: Self = Self {
        amplitude: 1.0,
        stretch: 1.0,
    };

    /// Scaling of one stay on a support; `None` on a smooth wheel.
    ///
    /// The mean of `stretch` over the stays of a path is `1/κ_f` (Eq. 51, corrected).
    pub fn of(stay: &Stay, wheel: &Wheel) -> Option<Self> {
        let alpha = wheel.lug_angle()?;
        let [low, high] = stay.rim_heights;
        let [from, to] = stay.wheel_angles;
        Some(Self {
            amplitude: (high - low) / flat_ground::displacement(wheel, 0.0),
            stretch: (to - from).abs() / alpha,
        })
    }

    /// Displacement \[m\] at `wheel_angle` \[rad\], 0 being where a contact stands straight down (Eq.
    /// 45, 46, 48; (46) and (47) corrected: the phase goes from contact to contact, and the least
    /// value is 0).
    ///
    /// ```text
    /// φ = C_f α INT(wheel_angle/(C_f α) + 1/2) - wheel_angle
    /// y = C_M [max(0, (r + l) cos φ - r) - max(0, (r + l) cos(C_f α/2) - r)]
    /// ```
    ///
    /// `None` on a smooth wheel.
    pub fn displacement(&self, wheel: &Wheel, wheel_angle: f64) -> Option<f64> {
        let pitch = self.stretch * wheel.lug_angle()?;
        let phi = pitch * floor(wheel_angle / pitch + 0.5) - wheel_angle;
        let height = |phi: f64| (wheel.tip_radius() * cos(phi) - wheel.radius).max(0.0);
        Some(self.amplitude * (height(phi) - height(0.5 * pitch)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vibration::rolling;

    #[test]
    fn the_reference_scaling_is_eq_10() {
        let wheel = Wheel::rover();
        for step in 0..100 {
            let wheel_angle = 0.01 * f64::from(step);
            let y = Scaling::REFERENCE
                .displacement(&wheel, wheel_angle)
                .unwrap();
            assert!((y - flat_ground::displacement(&wheel, wheel_angle)).abs() < 1e-15);
        }
    }

    /// The printed (47) drifts by (C_f - 1) α a lug, and (46) falls below 0.
    #[test]
    fn a_stretched_displacement_repeats_itself_every_c_f_lug_angles_and_is_never_negative() {
        let wheel = Wheel::rover();
        let slct = Scaling {
            amplitude: 3.0,
            stretch: 2.5,
        };
        let pitch = 2.5 * wheel.lug_angle().unwrap();
        for step in 0..1000 {
            let wheel_angle = 0.005 * f64::from(step);
            let y = slct.displacement(&wheel, wheel_angle).unwrap();
            let later = slct
                .displacement(&wheel, wheel_angle + 7.0 * pitch)
                .unwrap();
            assert!(y >= 0.0 && (y - later).abs() < 1e-12);
        }
        assert!(slct.displacement(&wheel, 0.5 * pitch).unwrap() < 1e-15);
    }

    #[test]
    fn on_flat_ground_every_stay_has_the_scaling_of_the_reference() {
        let wheel = Wheel::rover();
        let wheel_angles: Vec<f64> = (0..10_000).map(|i| 1.0e-4 * f64::from(i)).collect();
        let stays = rolling::stays(&rolling::path(&wheel, |_| 0.0, 0.0, &wheel_angles));
        let whole = &stays[1..stays.len() - 1];
        assert!(whole.len() >= 2);
        for stay in whole {
            let found = Scaling::of(stay, &wheel).unwrap();
            // A pose at either end of 2600.
            assert!((found.stretch - 1.0).abs() < 1e-3, "{found:?}");
            assert!((found.amplitude - 1.0).abs() < 2e-3, "{found:?}");
        }
    }
}
