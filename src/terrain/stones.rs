//! Shapes of free stones: convex polygons in the plane of travel.
//!
//! In a pile or a layer a stone is as deep along the axle as the wheel is wide. The plane has no
//! other depth that a wheel of that width could rest on: with it, the weight of a layer of stones
//! under the wheel is that of the real layer. The limit: across a 150 mm wheel lie some four stones
//! of 35 mm that move on their own, while here they move as one, so single impacts are stronger and
//! rarer. A lone stone in soil is as deep as its diameter: the soil bears no more of it.

use super::{SizeRange, Stones};
use crate::quantity::RangeError;
use rand::{Rng, RngExt};
use std::f64::consts::{PI, TAU};

/// Elongation [-] (longest over shortest axis) of the most angular stone.
const LARGEST_ELONGATION: f64 = 1.8;
/// Share [-] of the spacing of corners by which the most angular stone shifts them.
const LARGEST_SHIFT: f64 = 0.35;

/// A convex stone about its centroid.
#[derive(Debug, Clone, PartialEq)]
pub struct StoneShape {
    /// Corners [m] counter-clockwise, the centroid at the origin.
    pub corners: Vec<[f64; 2]>,
}

/// A stone where it lies.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedStone {
    /// Its shape.
    pub shape: StoneShape,
    /// Its centroid [m]: along the track, above the track's datum.
    pub position: [f64; 2],
    /// Cosine and sine [-] of its rotation, counter-clockwise.
    pub rotation: [f64; 2],
}

impl Stones {
    /// # Errors
    /// `RangeError` for sizes that are not positive or in the wrong order, angularity outside
    /// [0, 1], density that is not positive, friction outside [0, 2].
    pub fn checked(self) -> Result<Self, RangeError> {
        let SizeRange { min, max } = self.size;
        RangeError::positive("smallest stone size", "m", min)?;
        RangeError::check("largest stone size", "m", max, [min, 1.0])?;
        RangeError::check("stone angularity", "-", self.angularity, [0.0, 1.0])?;
        RangeError::positive("stone density", "kg/m³", self.density)?;
        RangeError::check("stone friction", "-", self.friction, [0.0, 2.0])?;
        Ok(self)
    }

    /// Draws a stone, turned at random.
    ///
    /// Its diameter (of the circle with the same area) is log-uniform between the sizes. Its
    /// corners lie on an ellipse, hence it is convex: 8 or 9 evenly spaced ones on a circle at
    /// angularity 0; 5 or 6 unevenly spaced ones on an ellipse 1.8 times as long as wide at 1.
    pub fn draw(&self, rng: &mut impl Rng) -> StoneShape {
        let SizeRange { min, max } = self.size;
        let diameter = min * libm::pow(max / min, rng.random::<f64>());
        let roundness = 1.0 - self.angularity;
        let fewest = 5 + libm::round(3.0 * roundness) as usize;
        let count = fewest + usize::from(rng.random::<bool>());
        let elongation = 1.0 + (LARGEST_ELONGATION - 1.0) * self.angularity * rng.random::<f64>();
        let turn = TAU * rng.random::<f64>();
        let spacing = TAU / count as f64;
        let corner = |k: usize, rng: &mut _| {
            let shift = LARGEST_SHIFT * self.angularity * (2.0 * uniform(rng) - 1.0);
            let angle = spacing * (k as f64 + shift);
            rotate([elongation * libm::cos(angle), libm::sin(angle)], turn)
        };
        let corners = (0..count).map(|k| corner(k, rng)).collect();
        StoneShape::with_diameter(corners, diameter)
    }

    /// Mean area [m²] of round stones of these sizes: of `(π/4) d²` over a log-uniform `d`.
    pub fn mean_area(&self) -> f64 {
        let SizeRange { min, max } = self.size;
        let ratio = max / min;
        let mean_square = if ratio > 1.0 + 1e-9 {
            (max * max - min * min) / (2.0 * libm::log(ratio))
        } else {
            min * min
        };
        PI / 4.0 * mean_square
    }
}

/// A number uniform in [0, 1).
fn uniform(rng: &mut impl Rng) -> f64 {
    rng.random()
}

/// `point` turned by `angle` [rad] counter-clockwise.
fn rotate([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [cos * x - sin * y, sin * x + cos * y]
}

impl StoneShape {
    /// The stone of these convex `corners`, scaled so that a circle of `diameter` [m] has its area.
    fn with_diameter(corners: Vec<[f64; 2]>, diameter: f64) -> Self {
        let (area, [x, y]) = area_and_centroid(&corners);
        let scale = diameter * libm::sqrt(PI / 4.0 / area);
        let about_centroid = |[u, v]: [f64; 2]| [scale * (u - x), scale * (v - y)];
        Self {
            corners: corners.into_iter().map(about_centroid).collect(),
        }
    }

    /// Area [m²].
    pub fn area(&self) -> f64 {
        area_and_centroid(&self.corners).0
    }

    /// Diameter [m] of the circle with the same area.
    pub fn diameter(&self) -> f64 {
        libm::sqrt(4.0 / PI * self.area())
    }

    /// Mass [kg] of a stone of `density` [kg/m³], `depth` [m] deep along the axle.
    pub fn mass(&self, density: f64, depth: f64) -> f64 {
        density * depth * self.area()
    }

    /// Distance [m] from the centroid to the farthest corner.
    pub fn outer_radius(&self) -> f64 {
        let distance = |&[x, y]: &[f64; 2]| libm::hypot(x, y);
        self.corners.iter().map(distance).fold(0.0, f64::max)
    }

    /// The stone seen in a mirror across the track.
    fn mirrored(&self) -> Self {
        let mirror = |&[x, y]: &[f64; 2]| [-x, y];
        Self {
            corners: self.corners.iter().rev().map(mirror).collect(),
        }
    }
}

impl PlacedStone {
    /// Height [m] of the highest corner above the track's datum.
    pub fn top(&self) -> f64 {
        let [cos, sin] = self.rotation;
        let height = |&[x, y]: &[f64; 2]| sin * x + cos * y;
        let highest = self.shape.corners.iter().map(height);
        self.position[1] + highest.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Corners in the track's frame [m], counter-clockwise.
    pub fn corners(&self) -> Vec<[f64; 2]> {
        let ([cos, sin], [x0, y0]) = (self.rotation, self.position);
        let place = |&[x, y]: &[f64; 2]| [x0 + cos * x - sin * y, y0 + sin * x + cos * y];
        self.shape.corners.iter().map(place).collect()
    }

    /// Bound [m] on the distance between a point of this stone and the same point of `other`, the
    /// same stone elsewhere.
    pub fn distance(&self, other: &Self) -> f64 {
        let difference = |a: [f64; 2], b: [f64; 2]| libm::hypot(a[0] - b[0], a[1] - b[1]);
        difference(self.position, other.position)
            + self.shape.outer_radius() * difference(self.rotation, other.rotation)
    }

    /// The stone seen in a mirror that stands across the track at its origin.
    pub fn mirrored(&self) -> Self {
        Self {
            shape: self.shape.mirrored(),
            position: [-self.position[0], self.position[1]],
            rotation: [self.rotation[0], -self.rotation[1]],
        }
    }
}

/// Lowest and highest point [m] of a polygon of `corners` [m] at `x` [m]; `None` beside it.
pub fn extent_at(corners: &[[f64; 2]], x: f64) -> Option<[f64; 2]> {
    let count = corners.len();
    let edges = (0..count).map(|i| (corners[i], corners[(i + 1) % count]));
    edges
        .filter(|([a, _], [b, _])| (a.min(*b)..=a.max(*b)).contains(&x) && a != b)
        .map(|([ax, ay], [bx, by])| ay + (by - ay) * (x - ax) / (bx - ax))
        .fold(None, |extent, y| {
            let [low, high] = extent.unwrap_or([y, y]);
            Some([f64::min(low, y), f64::max(high, y)])
        })
}

/// Area and centroid of the polygon of `corners`, by the shoelace formula.
fn area_and_centroid(corners: &[[f64; 2]]) -> (f64, [f64; 2]) {
    let next = corners.iter().cycle().skip(1);
    let (mut doubled, mut moment) = (0.0, [0.0; 2]);
    for ([x0, y0], [x1, y1]) in corners.iter().zip(next) {
        let cross = x0 * y1 - x1 * y0;
        doubled += cross;
        moment[0] += (x0 + x1) * cross;
        moment[1] += (y0 + y1) * cross;
    }
    let centroid = moment.map(|m| m / (3.0 * doubled));
    (doubled / 2.0, centroid)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;

    fn stones(angularity: f64) -> Stones {
        Stones {
            size: SizeRange {
                min: 0.02,
                max: 0.05,
            },
            angularity,
            density: 2600.0,
            friction: 0.6,
            drag: 0.0,
        }
    }

    fn draw_many(angularity: f64) -> Vec<StoneShape> {
        let mut rng = Seed(3).rng("stones", 0);
        let stones = stones(angularity);
        (0..2000).map(|_| stones.draw(&mut rng)).collect()
    }

    /// Cross products of neighbouring edges, all above 0 in a convex counter-clockwise polygon.
    fn turns(shape: &StoneShape) -> impl Iterator<Item = f64> {
        let corners = &shape.corners;
        let at = |k: usize| corners[k % corners.len()];
        (0..corners.len()).map(move |k| {
            let [[ax, ay], [bx, by], [cx, cy]] = [at(k), at(k + 1), at(k + 2)];
            (bx - ax) * (cy - by) - (by - ay) * (cx - bx)
        })
    }

    #[test]
    fn stones_are_convex_have_five_to_nine_corners_and_balance_on_their_origin() {
        for angularity in [0.0, 0.5, 1.0] {
            for shape in draw_many(angularity) {
                assert!((5..=9).contains(&shape.corners.len()));
                assert!(turns(&shape).all(|turn| turn > 0.0), "{shape:?}");
                let (_, [x, y]) = area_and_centroid(&shape.corners);
                assert!(x.abs() + y.abs() < 1e-15, "centroid at {x}, {y}");
            }
        }
    }

    #[test]
    fn diameters_are_log_uniform_between_the_sizes() {
        let diameters: Vec<f64> = draw_many(0.5).iter().map(StoneShape::diameter).collect();
        assert!(diameters.iter().all(|d| (0.02..=0.05).contains(d)));
        // Half lie below the geometric mean; 2000 draws scatter by 0.011.
        let middle = libm::sqrt(0.02 * 0.05);
        let below = diameters.iter().filter(|d| **d < middle).count() as f64 / 2000.0;
        assert!((below - 0.5).abs() < 0.04, "{below} lie below");
        let mean_area = diameters.iter().map(|d| PI / 4.0 * d * d).sum::<f64>() / 2000.0;
        // The standard error of the mean area is 1.2 %.
        assert!((mean_area / stones(0.5).mean_area() - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_rounded_stone_is_nearly_a_disc_and_an_angular_one_is_not() {
        let slenderness = |shape: &StoneShape| shape.outer_radius() / (shape.diameter() / 2.0);
        let mean = |a| draw_many(a).iter().map(slenderness).sum::<f64>() / 2000.0;
        // A regular octagon's is 1.054, a regular nonagon's 1.042.
        assert!((mean(0.0) - 1.048).abs() < 0.002, "{}", mean(0.0));
        assert!(mean(1.0) > 1.25, "{}", mean(1.0));
    }

    #[test]
    fn a_mirrored_stone_keeps_its_mass_its_top_and_its_sense_of_rotation() {
        let shape = draw_many(1.0).swap_remove(0);
        let rotation = [0.6, 0.8];
        let stone = PlacedStone {
            shape,
            position: [0.3, -0.02],
            rotation,
        };
        let mirrored = stone.mirrored();
        assert!((mirrored.shape.mass(2600.0, 0.15) - stone.shape.mass(2600.0, 0.15)).abs() < 1e-12);
        assert!((mirrored.top() - stone.top()).abs() < 1e-15);
        assert!(turns(&mirrored.shape).all(|turn| turn > 0.0));
        assert_eq!(mirrored.mirrored(), stone);
    }

    #[test]
    fn the_smallest_stone_above_the_largest_is_refused() {
        let size = SizeRange {
            min: 0.05,
            max: 0.02,
        };
        let message = Stones {
            size,
            ..stones(0.5)
        }
        .checked()
        .unwrap_err()
        .to_string();
        assert_eq!(
            message,
            "largest stone size [m] must be in [0.05, 1], got 0.02"
        );
    }
}
