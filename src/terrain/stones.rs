//! Shapes of free stones: rigid clumps of spheres.
//!
//! A stone is four overlapping spheres at the corners of a tetrahedron that is drawn out along one axis and flattened along
//! another. Spheres make contacts cheap; the hollows between them interlock as the faces and corners of crushed stone do.
//! [`Stones::angularity`] moves the spheres out from the centroid: at 0 all four coincide and the stone is a sphere, at 0.5
//! heaps of them stand at the angle of repose of crushed stone (see the tests of the stone bed).
//! What is missing: plane faces, sharp edges, breakage, dust.

use super::{SizeRange, Stones};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};
use std::f64::consts::{PI, TAU};

/// Spheres of a stone.
pub const BALLS: usize = 4;

/// Radius [-] of a stone's spheres, before they are scaled to its diameter, and its largest departure from it as a share.
pub(crate) const BALL: f64 = 0.265;
const BALL_SCATTER: f64 = 0.12;
/// Largest departure [-] of a sphere's distance from the centroid, as a share.
const OFFSET_SCATTER: f64 = 0.15;
/// Distance [-] of the spheres from the centroid in units of their radius: `FARTHEST (1 - (1 - a)⁴)` at angularity `a`. At 0.5 it
/// is 1.13, and spheres at the far ends of a stone are just apart.
const FARTHEST: f64 = 1.2075;
/// By how much [-] a stone of angularity 1 is longer along its first axis and shorter along its third.
const ELONGATION: f64 = 0.6;
const FLATNESS: f64 = 0.5;
/// Columns [-] along each side by which volume and inertia of a stone are integrated: their error is 0.5 %.
const COLUMNS: usize = 20;

/// A sphere of a stone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Its centre from the stone's centroid \[m\].
    pub centre: Vector3<f64>,
    /// Its radius \[m\].
    pub radius: f64,
}

/// A stone about its centroid.
#[derive(Debug, Clone, PartialEq)]
pub struct StoneShape {
    /// Its spheres.
    pub balls: [Ball; BALLS],
    /// Diameter \[m\] of the sphere with the same volume.
    pub diameter: f64,
    /// Inverse of the inertia tensor per mass [1/m²].
    pub inverse_inertia: Matrix3<f64>,
}

/// A stone where it lies: along the track, above the track's datum, and across the track along the axle.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedStone {
    /// Its shape.
    pub shape: StoneShape,
    /// Its centroid \[m\].
    pub position: Vector3<f64>,
    /// Its rotation.
    pub rotation: UnitQuaternion<f64>,
}

/// Position \[m\] and rotation of a stone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    position: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
}

impl Place {
    /// Bound \[m\] on the distance between a point of a stone here and the same point of it at `other`, where it reaches
    /// `outer_radius` \[m\] from its centroid.
    pub fn distance(&self, other: &Self, outer_radius: f64) -> f64 {
        let turned = (self.rotation.coords - other.rotation.coords).norm();
        (self.position - other.position).norm() + 2.0 * outer_radius * turned
    }
}

impl Stones {
    /// Draws a stone, not turned. Its diameter (of the sphere with the same volume) is log-uniform between the sizes.
    pub fn draw(&self, rng: &mut impl Rng) -> StoneShape {
        let SizeRange { min, max } = self.size;
        let diameter = min * libm::pow(max / min, rng.random::<f64>());
        let blunt = 1.0 - self.angularity;
        let offset = BALL * FARTHEST * (1.0 - blunt * blunt * blunt * blunt);
        let axes = Vector3::new(
            1.0 + ELONGATION * self.angularity,
            1.0,
            1.0 - FLATNESS * self.angularity,
        );
        let mut scattered = |share: f64| 1.0 + share * (2.0 * rng.random::<f64>() - 1.0);
        let balls = CORNERS.map(|corner| Ball {
            centre: Vector3::from(corner).component_mul(&axes)
                * (offset * scattered(OFFSET_SCATTER)),
            radius: BALL * scattered(BALL_SCATTER),
        });
        StoneShape::with_diameter(balls, diameter)
    }
}

/// Corners of a tetrahedron at distance 1 from its centre.
const CORNERS: [[f64; 3]; BALLS] = {
    const A: f64 = 0.577_350_269_189_625_8;
    [[A, A, A], [A, -A, -A], [-A, A, -A], [-A, -A, A]]
};

/// A rotation, every one equally likely (Shoemake 1992).
pub fn random_rotation(rng: &mut impl Rng) -> UnitQuaternion<f64> {
    let share: f64 = rng.random();
    let [a, b] = [(1.0 - share).sqrt(), share.sqrt()];
    let (sin_a, cos_a) = libm::sincos(TAU * rng.random::<f64>());
    let (sin_b, cos_b) = libm::sincos(TAU * rng.random::<f64>());
    UnitQuaternion::from_quaternion(Quaternion::new(b * cos_b, a * sin_a, a * cos_a, b * sin_b))
}

/// Moments of a solid: its volume, and the integrals of position and of its products.
#[derive(Default)]
struct Moments {
    volume: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

impl Moments {
    /// Of the union of `balls`, by columns along the third axis.
    fn of(balls: &[Ball; BALLS]) -> Self {
        let reach = balls
            .iter()
            .map(|ball| ball.centre.norm() + ball.radius)
            .fold(0.0, f64::max);
        let side = 2.0 * reach / COLUMNS as f64;
        let middle = |k: usize| (k as f64 + 0.5) * side - reach;
        let mut sum = Self::default();
        for x in (0..COLUMNS).map(middle) {
            for y in (0..COLUMNS).map(middle) {
                sum.add_column([x, y], side * side, intervals(balls, [x, y]));
            }
        }
        sum
    }

    fn add_column(&mut self, [x, y]: [f64; 2], area: f64, inside: Vec<[f64; 2]>) {
        for [low, high] in inside {
            let one = area * (high - low);
            let z = area * (high * high - low * low) / 2.0;
            let zz = area * (high * high * high - low * low * low) / 3.0;
            self.volume += one;
            self.first += Vector3::new(x * one, y * one, z);
            self.second += Matrix3::new(
                x * x * one,
                x * y * one,
                x * z,
                x * y * one,
                y * y * one,
                y * z,
                x * z,
                y * z,
                zz,
            );
        }
    }
}

/// Where the line along the third axis through `[x, y]` is inside one of `balls`: intervals apart from each other.
fn intervals(balls: &[Ball; BALLS], [x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut found: Vec<[f64; 2]> = balls
        .iter()
        .filter_map(|Ball { centre, radius }| {
            let (dx, dy) = (x - centre.x, y - centre.y);
            let half = radius * radius - dx * dx - dy * dy;
            (half > 0.0).then(|| [centre.z - half.sqrt(), centre.z + half.sqrt()])
        })
        .collect();
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut apart: Vec<[f64; 2]> = Vec::new();
    for [low, high] in found {
        match apart.last_mut() {
            Some(last) if low <= last[1] => last[1] = last[1].max(high),
            _ => apart.push([low, high]),
        }
    }
    apart
}

impl StoneShape {
    /// The stone of these spheres, moved to its centroid and scaled so that a sphere of `diameter` [m] has its volume.
    fn with_diameter(balls: [Ball; BALLS], diameter: f64) -> Self {
        let Moments {
            volume,
            first,
            second,
        } = Moments::of(&balls);
        let centroid = first / volume;
        let scale = diameter * libm::cbrt(PI / 6.0 / volume);
        let spread = (second / volume - centroid * centroid.transpose()) * (scale * scale);
        let inertia = Matrix3::identity() * spread.trace() - spread;
        Self {
            balls: balls.map(|ball| Ball {
                centre: (ball.centre - centroid) * scale,
                radius: ball.radius * scale,
            }),
            diameter,
            inverse_inertia: inertia.try_inverse().expect("a stone has an extent"),
        }
    }

    /// Volume \[m³\].
    pub fn volume(&self) -> f64 {
        PI / 6.0 * self.diameter * self.diameter * self.diameter
    }

    /// Distance \[m\] from the centroid to the farthest point.
    pub fn outer_radius(&self) -> f64 {
        let farthest = self.balls.iter();
        let farthest = farthest.map(|ball| ball.centre.norm() + ball.radius);
        farthest.fold(0.0, f64::max)
    }

    /// The stone seen in a mirror across the track.
    fn mirrored(&self) -> Self {
        let mirror = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
        Self {
            balls: self.balls.map(|ball| Ball {
                centre: mirror * ball.centre,
                ..ball
            }),
            inverse_inertia: mirror * self.inverse_inertia * mirror,
            ..*self
        }
    }
}

impl PlacedStone {
    /// Its spheres in the track's frame.
    pub fn balls(&self) -> [Ball; BALLS] {
        self.shape.balls.map(|ball| Ball {
            centre: self.position + self.rotation * ball.centre,
            ..ball
        })
    }

    /// Height \[m\] of its highest point above the track's datum.
    pub fn top(&self) -> f64 {
        let tops = self.balls().map(|ball| ball.centre.y + ball.radius);
        tops.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Where it lies.
    pub fn place(&self) -> Place {
        Place {
            position: self.position,
            rotation: self.rotation,
        }
    }

    /// Bound \[m\] on the distance between a point of this stone and the same point of `other`, the same stone elsewhere.
    pub fn distance(&self, other: &Self) -> f64 {
        self.place()
            .distance(&other.place(), self.shape.outer_radius())
    }

    /// The stone seen in a mirror that stands across the track at its origin.
    pub fn mirrored(&self) -> Self {
        let [x, y, z] = [self.position.x, self.position.y, self.position.z];
        let turn = self.rotation.quaternion();
        Self {
            shape: self.shape.mirrored(),
            position: Vector3::new(-x, y, z),
            rotation: UnitQuaternion::new_unchecked(Quaternion::new(
                turn.w, turn.i, -turn.j, -turn.k,
            )),
        }
    }
}

/// Places \[m\] along the track between which `balls` lie.
pub fn extent(balls: &[Ball]) -> [f64; 2] {
    balls
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], ball| {
            [
                low.min(ball.centre.x - ball.radius),
                high.max(ball.centre.x + ball.radius),
            ]
        })
}

/// Lowest and highest point \[m\] of `balls` at `x` \[m\] along the track; `None` beside them.
pub fn extent_at(balls: &[Ball], x: f64) -> Option<[f64; 2]> {
    let chord = |ball: &Ball| {
        let beside = x - ball.centre.x;
        let half = ball.radius * ball.radius - beside * beside;
        (half >= 0.0).then(|| [ball.centre.y - half.sqrt(), ball.centre.y + half.sqrt()])
    };
    balls
        .iter()
        .filter_map(chord)
        .reduce(|[low, high], [bottom, top]| [low.min(bottom), high.max(top)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;

    fn stones(angularity: f64) -> Stones {
        Stones {
            angularity,
            ..Stones::crushed(SizeRange {
                min: 0.02,
                max: 0.05,
            })
        }
    }

    fn draw_many(angularity: f64) -> Vec<StoneShape> {
        let mut rng = Seed(3).rng("stones", 0);
        let stones = stones(angularity);
        (0..1000).map(|_| stones.draw(&mut rng)).collect()
    }

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let values: Vec<f64> = values.collect();
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn a_stone_of_no_angularity_is_a_sphere() {
        for shape in draw_many(0.0).iter().take(50) {
            let largest = shape.balls.iter().map(|b| b.radius).fold(0.0, f64::max);
            assert!((largest / (0.5 * shape.diameter) - 1.0).abs() < 2e-3);
            // 2/5 m r² about every axis.
            let expected = 1.0 / (0.4 * largest * largest);
            let inverse = shape.inverse_inertia;
            assert!((inverse - Matrix3::identity() * expected).norm() < 0.02 * expected);
        }
    }

    #[test]
    fn volume_centroid_and_inertia_are_those_of_points_drawn_inside() {
        let shape = &draw_many(0.5)[7];
        let mut rng = Seed(9).rng("points", 0);
        let reach = shape.outer_radius();
        let (mut count, mut first, mut second) = (0, Vector3::zeros(), Matrix3::zeros());
        let total = 400_000;
        for _ in 0..total {
            let point = Vector3::from_fn(|_, _| reach * (2.0 * rng.random::<f64>() - 1.0));
            let inside = |ball: &Ball| (point - ball.centre).norm() < ball.radius;
            if shape.balls.iter().any(inside) {
                count += 1;
                first += point;
                second += point * point.transpose();
            }
        }
        let share = f64::from(count) / f64::from(total);
        let volume = share * 8.0 * reach * reach * reach;
        assert!((volume / shape.volume() - 1.0).abs() < 0.01, "{volume}");
        let centroid = first / f64::from(count);
        assert!(centroid.norm() < 0.005 * shape.diameter, "{centroid}");
        let spread = second / f64::from(count);
        let inertia = Matrix3::identity() * spread.trace() - spread;
        let identity = inertia * shape.inverse_inertia;
        assert!((identity - Matrix3::identity()).norm() < 0.03, "{identity}");
    }

    #[test]
    fn diameters_are_log_uniform_between_the_sizes() {
        let diameters: Vec<f64> = draw_many(0.5).iter().map(|shape| shape.diameter).collect();
        assert!(diameters.iter().all(|d| (0.02..=0.05).contains(d)));
        // Half lie below the geometric mean; 1000 draws scatter by 0.016.
        let middle = libm::sqrt(0.02 * 0.05);
        let below = diameters.iter().filter(|d| **d < middle).count() as f64 / 1000.0;
        assert!((below - 0.5).abs() < 0.05, "{below} lie below");
    }

    #[test]
    fn an_angular_stone_reaches_farther_than_its_sphere() {
        let slenderness = |shape: &StoneShape| shape.outer_radius() / (0.5 * shape.diameter);
        let at = |angularity| mean(draw_many(angularity).iter().map(slenderness));
        let [round, crushed, sharp] = [0.0, 0.5, 1.0].map(at);
        assert!(
            round < 1.01 && crushed > 1.25 && sharp > crushed,
            "{round} {crushed} {sharp}"
        );
    }

    #[test]
    fn rotations_favour_no_direction() {
        let mut rng = Seed(4).rng("rotations", 0);
        let turned: Vec<Vector3<f64>> = (0..20_000)
            .map(|_| random_rotation(&mut rng) * Vector3::new(0.0, 0.6, 0.8))
            .collect();
        let sum: Vector3<f64> = turned.iter().sum();
        // Each coordinate scatters by 1/√3.
        assert!((sum / 20_000.0).norm() < 0.02, "{sum}");
        let squares = turned
            .iter()
            .map(|v| v.component_mul(v))
            .sum::<Vector3<f64>>();
        assert!(
            (squares / 20_000.0)
                .iter()
                .all(|s| (s - 1.0 / 3.0).abs() < 0.01)
        );
    }

    #[test]
    fn a_mirrored_stone_keeps_its_top_and_mirrors_its_spheres() {
        let mut rng = Seed(5).rng("mirror", 0);
        let stone = PlacedStone {
            shape: draw_many(1.0).swap_remove(0),
            position: Vector3::new(0.3, -0.02, 0.01),
            rotation: random_rotation(&mut rng),
        };
        let mirrored = stone.mirrored();
        assert!((mirrored.top() - stone.top()).abs() < 1e-15);
        for (there, here) in mirrored.balls().iter().zip(stone.balls()) {
            assert!((there.centre.x + here.centre.x).abs() < 1e-15);
            assert!((there.centre.z - here.centre.z).abs() < 1e-15);
        }
        assert_eq!(mirrored.mirrored(), stone);
    }
}
