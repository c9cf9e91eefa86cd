//! Flat hard ground, the paper's reference terrain (Eq. 5-10).
//!
//! The wheel stands on one lug after the other; where the lugs are so few or so low that the rim
//! comes down between them (an olig-lugged wheel), on lug and rim by turns. What carries the wheel
//! depends on its angle alone, whether it slips or not.

use crate::wheel::Wheel;
use libm::{cos, floor, sin, sqrt};

/// Angle `φ` \[rad\] of the lug nearest to straight down, in (-α/2, α/2] (Eq. 6).
///
/// `None` on a smooth wheel.
pub fn lug_at_the_bottom(wheel: &Wheel, wheel_angle: f64) -> Option<f64> {
    let alpha = wheel.lug_angle()?;
    Some(alpha * floor(wheel_angle / alpha + 0.5) - wheel_angle)
}

/// Height \[m\] of the rim's lowest point above the ground (Eq. 5; Eq. 8 where lugs are many).
///
/// ```text
/// h_rt = max(0, (r + l) cos φ - r)
/// ```
pub fn rim_height(wheel: &Wheel, wheel_angle: f64) -> f64 {
    lug_at_the_bottom(wheel, wheel_angle).map_or(0.0, |phi| height_on(wheel, phi))
}

/// Displacement \[m\] of the axle from its lowest place (Eq. 10; Eq. 7 and 9 are its two cases).
///
/// ```text
/// y_rt = h_rt - max(0, (r + l) cos(α/2) - r)
/// ```
pub fn displacement(wheel: &Wheel, wheel_angle: f64) -> f64 {
    let lowest = wheel
        .lug_angle()
        .map_or(0.0, |alpha| height_on(wheel, 0.5 * alpha));
    rim_height(wheel, wheel_angle) - lowest
}

/// Vertical acceleration [m/s²] of the axle between lug changes, upward.
///
/// `wheel_speed` `ω` [rad/s] and `wheel_acceleration` [rad/s²] are those of the rotation:
///
/// ```text
/// ÿ = -ω² (r + l) cos φ + ω̇ (r + l) sin φ,  0 on the rim
/// ```
///
/// At a lug change itself the velocity jumps, see [`super::reference::lug_changes`].
pub fn acceleration(
    wheel: &Wheel,
    wheel_angle: f64,
    wheel_speed: f64,
    wheel_acceleration: f64,
) -> f64 {
    match lug_at_the_bottom(wheel, wheel_angle) {
        Some(phi) if phi.abs() < support_angle(wheel) => {
            wheel.tip_radius()
                * (wheel_acceleration * sin(phi) - wheel_speed * wheel_speed * cos(phi))
        }
        _ => 0.0,
    }
}

/// Angle \[rad\] from straight down within which a lug carries the wheel: half the lug angle, or
/// where the rim comes down first, `arccos(r / (r + l))`. 0 on a smooth wheel.
pub fn support_angle(wheel: &Wheel) -> f64 {
    match wheel.lug_angle() {
        Some(alpha) if wheel.is_multi_lugged() => 0.5 * alpha,
        Some(_) => libm::acos(wheel.radius / wheel.tip_radius()),
        None => 0.0,
    }
}

/// Vertical speed [m/s] per wheel speed [rad/s], `(r + l) sin φ`, with which a lug takes the wheel
/// over; with its negative it gives it away.
pub fn takeover_speed(wheel: &Wheel) -> f64 {
    match wheel.lug_angle() {
        Some(alpha) if wheel.is_multi_lugged() => wheel.tip_radius() * sin(0.5 * alpha),
        Some(_) => sqrt(wheel.tip_radius() * wheel.tip_radius() - wheel.radius * wheel.radius),
        None => 0.0,
    }
}

fn height_on(wheel: &Wheel, phi: f64) -> f64 {
    (wheel.tip_radius() * cos(phi) - wheel.radius).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vibration::olig;
    use std::f64::consts::PI;

    #[test]
    fn the_lug_at_the_bottom_is_the_one_that_eq_6_names_also_in_reverse() {
        let wheel = Wheel::rover();
        let alpha = wheel.lug_angle().unwrap();
        // Eq. (6) with θ = α/2 at t_1: the lug ahead has just touched.
        assert!((lug_at_the_bottom(&wheel, -0.5 * alpha).unwrap() - 0.5 * alpha).abs() < 1e-15);
        for wheel_angle in [-7.3, -0.2, 0.0, 0.1, 100.0] {
            let phi = lug_at_the_bottom(&wheel, wheel_angle).unwrap();
            let nearest = (0..24)
                .map(|lug| wheel.lug_position(lug, wheel_angle))
                .min_by(|a, b| a.abs().total_cmp(&b.abs()))
                .unwrap();
            assert!((phi - nearest).abs() < 1e-12, "{phi} {nearest}");
        }
    }

    #[test]
    fn eq_10_is_zero_at_its_lowest_and_the_text_s_amplitude_at_its_highest() {
        for (wheel, amplitude) in [
            (Wheel::rover(), 0.165 * (1.0 - (PI / 24.0).cos())),
            (olig(), 0.005),
        ] {
            let alpha = wheel.lug_angle().unwrap();
            assert!(displacement(&wheel, 0.5 * alpha).abs() < 1e-16);
            assert!((displacement(&wheel, 3.0 * alpha) - amplitude).abs() < 1e-15);
        }
    }

    #[test]
    fn the_rim_of_an_olig_lugged_wheel_stays_on_the_ground_between_lugs() {
        let wheel = olig();
        let support = support_angle(&wheel);
        assert!(support < 0.5 * wheel.lug_angle().unwrap());
        for beyond in [1.0001, 1.3] {
            assert_eq!(rim_height(&wheel, beyond * support), 0.0);
            assert_eq!(acceleration(&wheel, beyond * support, 0.1, 0.0), 0.0);
        }
        assert!(rim_height(&wheel, 0.999 * support) > 0.0);
    }

    #[test]
    fn acceleration_is_the_second_derivative_of_eq_10() {
        for wheel in [Wheel::rover(), olig()] {
            let (speed, spin_up, h) = (0.3, 2.0, 1e-4);
            let at = |t: f64| displacement(&wheel, 0.02 + speed * t + 0.5 * spin_up * t * t);
            let numeric = (at(h) - 2.0 * at(0.0) + at(-h)) / (h * h);
            let exact = acceleration(&wheel, 0.02, speed, spin_up);
            assert!((numeric - exact).abs() < 1e-6, "{numeric} {exact}");
        }
    }
}
