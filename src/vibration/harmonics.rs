//! Harmonics of the reference displacement (Eq. 49) and of its acceleration (Eq. 50-52, corrected).
//!
//! The displacement is even about a lug that points straight down: by the wheel angle,
//!
//! ```text
//! y_rt = C_0 + Σ C_i cos(i n_l wheel_angle)
//! ```
//!
//! The paper's amplitudes are the magnitudes of `C_i`, its phases 0 or π.

use super::flat_ground::support_angle;
use crate::wheel::Wheel;
use libm::{cos, sin};
use std::f64::consts::TAU;

/// Coefficient `C_i` \[m\] of the `order`-th lug harmonic, `i >= 1`; 0 on a smooth wheel.
///
/// ```text
/// C_i = (2/α) ∫ [(r + l) cos φ - r] cos(i n_l φ) dφ  over the angles that a lug supports
/// ```
///
/// For a multi-lugged wheel this is `(-1)^(i+1) 4 (r + l) sin(α/2) / (α ((i n_l)² - 1))`.
pub fn displacement_harmonic(wheel: &Wheel, order: u32) -> f64 {
    let Some(alpha) = wheel.lug_angle() else {
        return 0.0;
    };
    let (m, phi) = (f64::from(order * wheel.lug_count()), support_angle(wheel));
    // ∫ cos(k φ) dφ over half the interval.
    let half = |k: f64| if k == 0.0 { phi } else { sin(k * phi) / k };
    let lug = wheel.tip_radius() * (half(m - 1.0) + half(m + 1.0));
    // On a multi-lugged wheel the constant leaves nothing over a whole lug angle.
    let rim = if wheel.is_multi_lugged() {
        0.0
    } else {
        2.0 * wheel.radius * half(m)
    };
    2.0 / alpha * (lug - rim)
}

/// Mean `C_0` \[m\] of the reference displacement (Eq. 10); 0 on a smooth wheel.
pub fn mean_displacement(wheel: &Wheel) -> f64 {
    let Some(alpha) = wheel.lug_angle() else {
        return 0.0;
    };
    let phi = support_angle(wheel);
    let over_support = 2.0 * (wheel.tip_radius() * sin(phi) - wheel.radius * phi) / alpha;
    let lowest = wheel.tip_radius() * cos(0.5 * alpha) - wheel.radius;
    over_support - lowest.max(0.0)
}

/// Amplitude [m/s²] of the `order`-th harmonic of the reference acceleration at `wheel_speed` `ω`
/// [rad/s] (Eq. 50-52): `(2π i f_a)² |C_i|` with `f_a = n_l ω / 2π`, not the printed `ω² C_i`.
///
/// The harmonics do not fade with their order: on a multi-lugged wheel they tend to
/// `4 ω² (r + l) sin(α/2) / α`, those of a train of velocity jumps.
pub fn acceleration_harmonic(wheel: &Wheel, order: u32, wheel_speed: f64) -> f64 {
    let lug_frequency = f64::from(wheel.lug_count()) * wheel_speed / TAU;
    let rate = TAU * f64::from(order) * lug_frequency;
    rate * rate * displacement_harmonic(wheel, order).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vibration::olig;
    use crate::vibration::{flat_ground, reference};

    #[test]
    fn the_series_sums_to_eq_10() {
        for wheel in [Wheel::rover(), Wheel::single_wheel(), olig()] {
            let highest = flat_ground::displacement(&wheel, 0.0);
            for step in -20..20 {
                let wheel_angle = 0.013 * f64::from(step);
                let sum = mean_displacement(&wheel)
                    + (1..=400)
                        .map(|i| {
                            let m = f64::from(i * wheel.lug_count());
                            displacement_harmonic(&wheel, i) * (m * wheel_angle).cos()
                        })
                        .sum::<f64>();
                let y = flat_ground::displacement(&wheel, wheel_angle);
                // Coefficients fall as 1/i²: what 400 leave is about 1/400 of the first.
                assert!((sum - y).abs() < 3e-3 * highest, "{sum} {y}");
            }
        }
    }

    #[test]
    fn harmonics_of_a_multi_lugged_wheel_have_their_closed_form() {
        let wheel = Wheel::rover();
        let alpha = wheel.lug_angle().unwrap();
        for i in 1..20 {
            let m = f64::from(24 * i);
            let sign = if i % 2 == 1 { 1.0 } else { -1.0 };
            let expected = sign * 4.0 * 0.165 * (0.5 * alpha).sin() / (alpha * (m * m - 1.0));
            let found = displacement_harmonic(&wheel, i);
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }

    /// An impulse J every T has harmonics of 2 J/T: the corrected (52) in the errata's sense.
    #[test]
    fn acceleration_harmonics_tend_to_those_of_the_train_of_velocity_jumps() {
        let (wheel, speed, rate) = (Wheel::rover(), 0.1, 2000.0);
        let angles: Vec<f64> = (0..12_000).map(|i| speed * f64::from(i) / rate).collect();
        let changes = reference::lug_changes(&wheel, &angles, rate);
        let period = changes[1].time - changes[0].time;
        let train = 2.0 * changes[0].velocity_jump / period;
        for order in [1, 2, 10] {
            let found = acceleration_harmonic(&wheel, order, speed);
            // The smooth acceleration between jumps adds 1/((i n_l)² - 1) of it.
            assert!((found / train - 1.0).abs() < 2.0e-3, "{found} {train}");
        }
    }
}
