//! Equilibrium of the wheel on ground of any shape: the contact point of its outline, and the height of the
//! axle.
//!
//! Every lug edge and every point of the rim requires a height of the axle: the ground's height beneath it
//! plus its own depth below the axle (Eq. 19, 27, 29). The axle takes the largest of them, and the point with
//! it carries the wheel (Eq. 32). Edges within a quarter turn of straight down are included, as in the paper.

use crate::wheel::Wheel;
use libm::{asin, cos, floor, sin, sqrt};
use std::f64::consts::FRAC_PI_2;

/// What carries the wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// The lug of this number.
    Lug(u32),
    /// The rim.
    Rim,
}

/// The point of the outline that carries the wheel, and the height that it requires.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footing {
    /// What it belongs to.
    pub support: Support,
    /// Distance from the axle \[m\].
    pub radius: f64,
    /// Angle from straight down \[rad\], positive ahead.
    pub angle: f64,
    /// Height of the axle above the ground's datum \[m\].
    pub axle_height: f64,
}

/// Number of places on each half of the rim at which the ground is evaluated, before the highest is refined:
/// 0.35 mm apart on a rim of 140 mm, a sixth of the shortest roughness in use.
const RIM_PLACES: i32 = 400;

/// How a wheel at `position` \[m\], turned to `wheel_angle` \[rad\], stands on ground whose height \[m\]
/// along the track is `ground`.
pub fn footing(
    wheel: &Wheel,
    mut ground: impl FnMut(f64) -> f64,
    position: f64,
    wheel_angle: f64,
) -> Footing {
    let on_lugs = lugs_below(wheel, wheel_angle).map(|(lug, angle)| {
        let radius = wheel.tip_radius();
        Footing {
            support: Support::Lug(lug),
            radius,
            angle,
            axle_height: ground(position + radius * sin(angle)) + radius * cos(angle),
        }
    });
    let best_lug = on_lugs.max_by(|a, b| a.axle_height.total_cmp(&b.axle_height));
    let rim = rim_footing(wheel.radius, |ahead| ground(position + ahead));
    match best_lug {
        Some(lug) if lug.axle_height >= rim.axle_height => lug,
        _ => rim,
    }
}

/// Number and angle [rad] of every lug within a quarter turn of straight down, from the rear.
fn lugs_below(wheel: &Wheel, wheel_angle: f64) -> impl Iterator<Item = (u32, f64)> {
    let count = i64::from(wheel.lug_count());
    let alpha = wheel.lug_angle().unwrap_or(FRAC_PI_2);
    let first = floor((wheel_angle - FRAC_PI_2) / alpha) as i64 + 1;
    let last = floor((wheel_angle + FRAC_PI_2) / alpha) as i64;
    let numbers = if count > 0 { first..last + 1 } else { 0..0 };
    numbers.map(move |number| {
        let lug = number.rem_euclid(count) as u32;
        (lug, number as f64 * alpha - wheel_angle)
    })
}

/// The highest wish of the rim (Eq. 29), `ground` at a distance ahead of the axle [m].
fn rim_footing(radius: f64, mut ground: impl FnMut(f64) -> f64) -> Footing {
    let spacing = radius / f64::from(RIM_PLACES);
    let mut wish = |ahead: f64| ground(ahead) + sqrt((radius * radius - ahead * ahead).max(0.0));
    let wishes: Vec<f64> = (-RIM_PLACES..=RIM_PLACES)
        .map(|place| wish(f64::from(place) * spacing))
        .collect();
    let mut highest = 0;
    for (place, height) in wishes.iter().enumerate() {
        if *height > wishes[highest] {
            highest = place;
        }
    }
    let mut ahead = (highest as f64 - f64::from(RIM_PLACES)) * spacing;
    let mut axle_height = wishes[highest];
    if let (Some(before), Some(after)) = (
        highest.checked_sub(1).and_then(|place| wishes.get(place)),
        wishes.get(highest + 1),
    ) {
        let bend = before - 2.0 * axle_height + after;
        let refined = ahead + 0.5 * spacing * (before - after) / bend;
        let height = if bend < 0.0 {
            wish(refined)
        } else {
            axle_height
        };
        if height > axle_height {
            (ahead, axle_height) = (refined, height);
        }
    }
    Footing {
        support: Support::Rim,
        radius,
        angle: asin(ahead / radius),
        axle_height,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vibration::flat_ground;
    use crate::wheel::Lugs;

    #[test]
    fn on_flat_ground_the_axle_stands_as_eq_5_says() {
        let lugs = Some(Lugs {
            count: 6,
            height: 0.005,
            thickness: 0.003,
            edge_radius: None,
        });
        let olig = Wheel {
            lugs,
            ..Wheel::single_wheel()
        };
        let smooth = Wheel { lugs: None, ..olig };
        for wheel in [Wheel::rover(), olig, smooth] {
            for step in -50..50 {
                let wheel_angle = 0.037 * f64::from(step);
                let stands = footing(&wheel, |_| 0.0, 1.0, wheel_angle).axle_height;
                let expected = wheel.radius + flat_ground::rim_height(&wheel, wheel_angle);
                assert!((stands - expected).abs() < 1e-15, "{stands} {expected}");
            }
        }
    }

    #[test]
    fn a_stone_between_two_lugs_carries_the_rim_and_one_under_a_lug_the_lug() {
        let wheel = Wheel::single_wheel();
        let alpha = wheel.lug_angle().unwrap();
        let stone = |top: f64| move |x: f64| (0.03 - 4.0 * (x - top).abs()).max(0.0);
        let between = footing(&wheel, stone(0.0), 0.0, 0.5 * alpha);
        assert_eq!(between.support, Support::Rim);
        assert!((between.axle_height - 0.17).abs() < 1e-6);
        let under = footing(&wheel, stone(0.155 * alpha.sin()), 0.0, 0.0);
        assert_eq!(under.support, Support::Lug(1));
        assert!((under.angle - alpha).abs() < 1e-12);
    }

    /// Eq. (29) with x_w ahead of the axle: the rim point lies at S_x + x_w (corrected).
    #[test]
    fn the_rim_finds_a_bump_ahead_of_the_axle() {
        let wheel = Wheel {
            lugs: None,
            ..Wheel::single_wheel()
        };
        // A round bump of radius 20 mm whose centre lies 60 mm ahead, level with the ground.
        let bump = |x: f64| (0.02_f64.powi(2) - (x - 0.06).powi(2)).max(0.0).sqrt();
        let found = footing(&wheel, bump, 0.0, 0.0);
        // Two circles touch where their centres are as far apart as their radii sum to.
        let expected = (0.16_f64.powi(2) - 0.06_f64.powi(2)).sqrt();
        assert!((found.axle_height - expected).abs() < 1e-8, "{found:?}");
        assert!((found.angle - (0.06_f64 / 0.16).asin()).abs() < 1e-4);
    }
}
