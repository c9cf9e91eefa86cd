//! How large a vibration can be while every lug touches (Eq. 55-58).
//!
//! The largest displacement, the paper argues, is that of a lug which carries the wheel from where
//! the lug behind it points straight down to where the lug ahead does (Fig. 13): `φ` from `-α` to
//! `α`, twice the reference's.
//!
//! These bound displacements. Whether they bound features of the acceleration, as (55) and (56) use
//! them, is another matter: between fixed supports a rigid wheel's velocity jumps sum to the
//! same over the same way, however they are shared out.

use crate::wheel::Wheel;
use libm::cos;
use std::f64::consts::TAU;

/// Amplitude [m] of the reference displacement, `(r + l)(1 - cos(α/2))`, of a multi-lugged wheel; 0
/// on a smooth wheel.
pub fn reference_amplitude(wheel: &Wheel) -> f64 {
    let half = 0.5 * wheel.lug_angle().unwrap_or(0.0);
    wheel.tip_radius() * (1.0 - cos(half))
}

/// Largest amplitude [m] of the displacement while every lug touches, `(r + l)(1 - cos α)`, of a
/// multi-lugged wheel; 0 on a smooth wheel.
pub fn largest_amplitude(wheel: &Wheel) -> f64 {
    wheel.tip_radius() * (1.0 - cos(wheel.lug_angle().unwrap_or(0.0)))
}

/// Upper limit of the ratio of amplitudes `κ_A` and of `C_M` [-] for a wheel of `lugs` equally
/// spaced lugs, two or more (Eq. 55, 57).
///
/// ```text
/// ε_Au = (1 - cos α)/(1 - cos(α/2)) = 4 cos²(α/4)
/// ```
pub fn amplitude_bound(lugs: u32) -> f64 {
    let cosine = cos(0.25 * TAU / f64::from(lugs));
    4.0 * cosine * cosine
}

/// Upper limit of the ratio of mean squares `κ_ms` [-]: the square of [`amplitude_bound`] (Eq. 56,
/// 58).
pub fn mean_square_bound(lugs: u32) -> f64 {
    let bound = amplitude_bound(lugs);
    bound * bound
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vibration::flat_ground;

    #[test]
    fn the_bound_is_the_ratio_of_the_amplitudes_and_four_cosine_square_of_a_quarter() {
        for wheel in [Wheel::single_wheel(), Wheel::rover()] {
            let ratio = largest_amplitude(&wheel) / reference_amplitude(&wheel);
            let bound = amplitude_bound(wheel.lug_count());
            // Both differences from 1 lose four digits.
            assert!((ratio / bound - 1.0).abs() < 1e-12, "{ratio} {bound}");
            let amplitude = flat_ground::displacement(&wheel, 0.0);
            assert!((reference_amplitude(&wheel) - amplitude).abs() < 1e-15);
        }
    }

    #[test]
    fn the_papers_wheels_have_3_983_and_3_987_and_four_lugs_3_41() {
        for (lugs, bound) in [(24, 3.983), (28, 3.987), (4, 3.414)] {
            assert!((amplitude_bound(lugs) - bound).abs() < 5e-4);
        }
        assert!((mean_square_bound(24) - 15.86).abs() < 5e-3);
    }
}
