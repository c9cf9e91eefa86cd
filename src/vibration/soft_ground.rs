//! Lugs that enter the soil (LEIS, Eq. 42-44).
//!
//! The wheel's height follows from the path of one lug's edge, the foremost in the soil: every lug
//! repeats it one lug angle later. The printed (42), (43) give the depth of the rim below the
//! surface, which Fig. 7 shows; here stands its negative, the height, as in every other equation.
//!
//! What path an edge takes is the soil's matter, and the paper leaves it open. [`YieldingSoil`] is
//! one choice. It puts the wheel highest where a lug points straight down, as Fig. 7b does. Simulated
//! sand carries a lug most while it still comes down, and has the wheel highest a fifth of a lug angle
//! earlier (at 100 N and a slip of 0.2).

use super::flat_ground::lug_at_the_bottom;
use crate::wheel::Wheel;
use libm::{cos, floor};
use std::f64::consts::FRAC_PI_2;

/// Height `h` \[m\] of the rim's lowest point above the soil's surface, after a turn of `turned`
/// \[rad\] since a lug entered the soil at `entry_angle` `β` \[rad\] ahead of straight down (Eq. 43,
/// negative of the depth printed).
///
/// `tip_depth` is the depth \[m\] of the foremost edge below the surface by the turn \[rad\] since it
/// entered, asked for in [0, α); with the paper's `y_l`, counted from where the axle was at entry,
/// it is `-(r + l) cos β - y_l`.
///
/// ```text
/// h = (r + l) cos(β - u) - r - depth(u),  u = turned - α INT(turned/α)
/// ```
///
/// `None` on a smooth wheel.
pub fn rim_height(
    wheel: &Wheel,
    entry_angle: f64,
    turned: f64,
    tip_depth: impl Fn(f64) -> f64,
) -> Option<f64> {
    let alpha = wheel.lug_angle()?;
    let since = turned - alpha * floor(turned / alpha);
    Some(wheel.tip_radius() * cos(entry_angle - since) - wheel.radius - tip_depth(since))
}

/// Soil that yields evenly: the lug at the bottom stands `tip_sinkage` deep when straight down, and
/// sinks the deeper the more it stands alone, so that of the reference vibration the share
/// `amplitude` is left.
///
/// With an amplitude of 1 the depth of the lowest edge is constant; with 0 the axle keeps its height,
/// and the edges carve circles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YieldingSoil {
    /// Depth \[m\] of the edge of a lug that points straight down; more than `1 - C_M` of the reference
    /// amplitude, or lugs would leave the soil before the next one enters.
    pub tip_sinkage: f64,
    /// Amplitude over the reference vibration's, `C_M` of Eq. (48) [-], in [0, 1].
    pub amplitude: f64,
}

impl YieldingSoil {
    /// Angle `β` \[rad\] ahead of straight down at which a lug of `wheel` enters; `None` on a smooth
    /// wheel. At most a quarter turn.
    pub fn entry_angle(&self, wheel: &Wheel) -> Option<f64> {
        let alpha = wheel.lug_angle()?;
        // Beyond half a lug angle an edge rises faster than the axle with every turn back.
        let (mut inside, mut outside) = (0.5 * alpha, FRAC_PI_2);
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if self.depth_at(wheel, middle) > 0.0 {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        Some(outside)
    }

    /// Depth \[m\] of the foremost edge after a turn of `turned` \[rad\] since it entered.
    ///
    /// `None` on a smooth wheel.
    pub fn tip_depth(&self, wheel: &Wheel, turned: f64) -> Option<f64> {
        let entry_angle = self.entry_angle(wheel)?;
        Some(self.depth_at(wheel, entry_angle - turned))
    }

    /// Height [m] of the rim's lowest point above the soil, of a wheel with a lug at `phi` [rad]:
    /// `h = r + l - r - tip_sinkage` where one points straight down, less `C_M` of the reference
    /// displacement's fall.
    fn height(&self, wheel: &Wheel, phi: f64) -> f64 {
        let bottom = lug_at_the_bottom(wheel, -phi).unwrap_or(0.0);
        let fall = wheel.tip_radius() * (1.0 - cos(bottom));
        wheel.lug_height() - self.tip_sinkage - self.amplitude * fall
    }

    /// Depth [m] of the edge of a lug at `phi` [rad].
    fn depth_at(&self, wheel: &Wheel, phi: f64) -> f64 {
        wheel.tip_radius() * cos(phi) - wheel.radius - self.height(wheel, phi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vibration::flat_ground;

    const SOIL: YieldingSoil = YieldingSoil {
        tip_sinkage: 0.022,
        amplitude: 0.3,
    };

    /// Height by the turn since entry.
    fn heights(wheel: &Wheel, soil: YieldingSoil, turns: usize) -> Vec<[f64; 2]> {
        let entry = soil.entry_angle(wheel).unwrap();
        let alpha = wheel.lug_angle().unwrap();
        (0..turns * 200)
            .map(|i| i as f64 * alpha / 200.0)
            .map(|turned| {
                let depth = |since| soil.tip_depth(wheel, since).unwrap();
                [turned, rim_height(wheel, entry, turned, depth).unwrap()]
            })
            .collect()
    }

    #[test]
    fn a_lug_enters_where_its_edge_is_level_with_the_surface() {
        let wheel = Wheel::single_wheel();
        assert!(SOIL.tip_depth(&wheel, 0.0).unwrap().abs() < 1e-12);
        let entry = SOIL.entry_angle(&wheel).unwrap();
        // Paper's Section 5 case: 22 mm of edge, 7 mm of rim: some 30°.
        assert!((25.0..32.0).contains(&entry.to_degrees()), "{entry}");
        let straight_down = SOIL.tip_depth(&wheel, entry).unwrap();
        assert!((straight_down - 0.022).abs() < 1e-12);
    }

    #[test]
    fn eq_43_repeats_itself_every_lug_angle_and_joins_without_a_step() {
        let wheel = Wheel::single_wheel();
        let heights = heights(&wheel, SOIL, 3);
        for i in 0..400 {
            assert!((heights[i][1] - heights[i + 200][1]).abs() < 1e-12);
        }
        let largest = heights
            .windows(2)
            .map(|pair| (pair[1][1] - pair[0][1]).abs())
            .fold(0.0, f64::max);
        let alpha = wheel.lug_angle().unwrap();
        let steepest = wheel.tip_radius() * 0.3 * (0.5 * alpha).sin() * alpha / 200.0;
        assert!(largest <= 1.001 * steepest, "{largest} {steepest}");
    }

    /// Fig. 7b: the rim is highest (its depth least) with a lug straight down, lowest with two lugs
    /// either side of it.
    #[test]
    fn the_rim_is_highest_over_a_lug_and_lowest_between_two() {
        let wheel = Wheel::single_wheel();
        let (alpha, entry) = (
            wheel.lug_angle().unwrap(),
            SOIL.entry_angle(&wheel).unwrap(),
        );
        let heights = heights(&wheel, SOIL, 2);
        let of_the_bottom_lug = |turned: f64| {
            let phi = entry - turned;
            (phi - alpha * (phi / alpha).round()).abs()
        };
        let by_height = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
        let highest = heights.iter().max_by(by_height).unwrap()[0];
        let lowest = heights.iter().min_by(by_height).unwrap()[0];
        assert!(of_the_bottom_lug(highest) < alpha / 200.0);
        assert!((of_the_bottom_lug(lowest) - 0.5 * alpha).abs() < alpha / 200.0);
    }

    /// Eq. (48) follows from (43), (44) with this soil, whatever its yielding.
    #[test]
    fn the_displacement_is_the_reference_displacement_times_c_m() {
        let wheel = Wheel::single_wheel();
        for amplitude in [0.0, 0.3, 1.0] {
            let soil = YieldingSoil { amplitude, ..SOIL };
            let entry = soil.entry_angle(&wheel).unwrap();
            let heights = heights(&wheel, soil, 1);
            let lowest = soil.height(&wheel, 0.5 * wheel.lug_angle().unwrap());
            for [turned, height] in heights {
                let expected = amplitude * flat_ground::displacement(&wheel, turned - entry);
                assert!((height - lowest - expected).abs() < 1e-12);
            }
        }
    }
}
