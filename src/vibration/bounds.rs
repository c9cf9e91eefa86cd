//! How large a vibration can be while every lug touches (Eq. 55-58).
//!
//! The largest displacement, the paper argues, is that of a lug which carries the wheel from where
//! the lug behind it points straight down to where the lug ahead does (Fig. 13): `φ` from `-α` to
//! `α`, twice the reference's.
//!
//! That holds for flat ground with bumps under single lugs. Where the ground itself slopes, a lug may
//! carry the wheel farther: on slate of 1.6 mm roughness every lug of the rover's wheel still touches,
//! and displacements of 4.9 times the reference's occur.
//!
//! For the acceleration, to which (55) and (56) are applied, the bound is never reached on fixed
//! ground: the velocity jumps of a rigid wheel that rolls without slipping sum to the same over the
//! same way, and their squares grow only where lugs miss, to 1.8 times the reference's on ground of
//! 6.4 mm roughness, where a quarter of the contacts is gone.

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
    use crate::quantity::Seed;
    use crate::terrain::Roughness;
    use crate::terrain::profile::Profile;
    use crate::vibration::flat_ground;
    use crate::vibration::rolling::{self, Pose};
    use crate::vibration::simplified::Scaling;

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

    /// The rover's wheel over three turns of ground of this roughness [m rms].
    fn rolled(rms: f64) -> Vec<Pose> {
        let roughness = Roughness {
            rms,
            hurst: 0.8,
            longest: 0.2,
            shortest: 0.002,
        };
        let mut profile = Profile::new(Some(&roughness), None, 2.5e-4, Seed(1), 0);
        let ground = |x: f64| {
            profile.extend(x, x);
            profile.at(x).height
        };
        let wheel_angles: Vec<f64> = (0..6000).map(|i| 3.0 * TAU * f64::from(i) / 6e3).collect();
        rolling::path(&Wheel::rover(), ground, 0.0, &wheel_angles)
    }

    /// Largest `C_M` of a path, its mean `C_f`, and its velocity jumps' sum and sum of squares over
    /// the reference's.
    fn statistics(path: &[Pose]) -> [f64; 4] {
        let wheel = Wheel::rover();
        let stays = rolling::stays(path);
        let whole = &stays[1..stays.len() - 1];
        let scalings: Vec<Scaling> = whole
            .iter()
            .filter_map(|stay| Scaling::of(stay, &wheel))
            .collect();
        let largest = scalings.iter().map(|s| s.amplitude).fold(0.0, f64::max);
        let stretch = scalings.iter().map(|s| s.stretch).sum::<f64>() / scalings.len() as f64;
        // The rim's contact moves on without jumps.
        let jumps: Vec<f64> = path
            .windows(2)
            .map(|pair| pair[1].contact - pair[0].contact)
            .filter(|way| *way > 1.0e-3)
            .collect();
        let reference = 2.0 * flat_ground::takeover_speed(&wheel);
        let turned = path[path.len() - 1].wheel_angle / wheel.lug_angle().unwrap();
        let sum = jumps.iter().sum::<f64>() / (turned * reference);
        let squares =
            jumps.iter().map(|jump| jump * jump).sum::<f64>() / (turned * reference * reference);
        [largest, stretch, sum, squares]
    }

    #[test]
    fn the_bound_holds_on_fine_slate_and_a_sloping_ground_that_all_lugs_touch_exceeds_it() {
        let [fine, stretch, ..] = statistics(&rolled(0.8e-3));
        assert!(fine < amplitude_bound(24) && (stretch - 1.0).abs() < 0.01);
        let [coarse, stretch, ..] = statistics(&rolled(1.6e-3));
        assert!((coarse - 4.9).abs() < 0.05 && (stretch - 1.0).abs() < 0.01);
    }

    /// A record starts and ends within a lug angle: 1 of 72 is the tolerance.
    #[test]
    fn on_fixed_ground_velocity_jumps_stay_far_below_both_bounds() {
        for (rms, contacts, expected) in
            [(0.4e-3, 1.0, 1.0), (1.6e-3, 1.0, 1.0), (6.4e-3, 0.76, 1.76)]
        {
            let [_, stretch, sum, squares] = statistics(&rolled(rms));
            assert!((1.0 / stretch - contacts).abs() < 0.01, "{stretch}");
            assert!((0.96..1.015).contains(&sum), "{sum}");
            assert!((squares - expected).abs() < 0.02, "{squares}");
            assert!(squares < 0.2 * mean_square_bound(24));
        }
    }
}
