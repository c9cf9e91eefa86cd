//! A rigid wheel that rolls over hard ground of any shape without slipping (Eq. 11-41).
//!
//! The paper writes one set of equations for ground that all lugs touch (ALCT, Eq. 11-25) and one
//! for ground that some miss (SLCT, Eq. 26-41). Both describe the same motion: the wheel turns about the point
//! that carries it, until another point of its outline requires a higher axle; that point carries
//! it from then on. Here this is done with the outline itself, which needs no printed counter, and
//! the counters follow. Corrected: (11), (18), (24), (30)-(32), (39), (40) with one datum; (12)
//! with the rim's rolling; (14), (15), (20), (29), (31), (36)-(39) as geometry has them.
//!
//! Loose stones move and are not for this model. Nor does it slip: where a rig fixes forward speed
//! and wheel speed, let the wheel down at the rig's own positions with [`footing`].

use super::outline::{Footing, Support, footing};
use crate::wheel::Wheel;
use libm::{floor, sin};

/// Longest turn [rad] about one point without looking for another: 0.3 mm of ground, and on the rim
/// a way short by less than a millionth.
const STEP: f64 = 2.0e-3;

/// Halvings of a step in the search for the wheel angle at which another point takes over.
const HALVINGS: u32 = 20;

/// Where the wheel stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Wheel angle \[rad\].
    pub wheel_angle: f64,
    /// Position of the axle along the track `S_x` \[m\].
    pub position: f64,
    /// Height `h` of the rim's lowest point above the ground's datum \[m\] (Eq. 11, 40); the axle
    /// stands `r` higher.
    pub rim_height: f64,
    /// What carries the wheel.
    pub support: Support,
    /// Position along the track of the point that carries it, `X_n` or `X_w` \[m\] (Eq. 14, 35, 37).
    /// Where one point takes over from another, the vertical velocity jumps by the wheel speed
    /// times the way between them.
    pub contact: f64,
    /// Counter `n` [-] of lugs that carried the wheel or were passed over, the first being 1
    /// (Eq. 20, 39); it falls in reverse.
    pub lugs_counted: i64,
}

/// A wheel on its way.
#[derive(Debug, Clone)]
pub struct Rolling<G> {
    wheel: Wheel,
    ground: G,
    position: f64,
    wheel_angle: f64,
    footing: Footing,
    first_lug: i64,
}

impl<G: FnMut(f64) -> f64> Rolling<G> {
    /// `wheel` let down at `position` \[m\], turned to `wheel_angle` \[rad\], on ground whose height \[m\]
    /// along the track is `ground`.
    pub fn new(wheel: &Wheel, mut ground: G, position: f64, wheel_angle: f64) -> Self {
        let footing = footing(wheel, &mut ground, position, wheel_angle);
        Self {
            wheel: *wheel,
            ground,
            position,
            wheel_angle,
            footing,
            first_lug: lug_number(wheel, &footing, wheel_angle),
        }
    }

    /// Rolls on, or back, to `wheel_angle` \[rad\].
    pub fn turn_to(&mut self, wheel_angle: f64) -> Pose {
        let turn = wheel_angle - self.wheel_angle;
        let steps = (turn.abs() / STEP).ceil();
        for _ in 0..steps as u64 {
            self.step(turn / steps);
        }
        self.pose()
    }

    /// Where the wheel stands now.
    pub fn pose(&self) -> Pose {
        let number = lug_number(&self.wheel, &self.footing, self.wheel_angle);
        Pose {
            wheel_angle: self.wheel_angle,
            position: self.position,
            rim_height: self.footing.axle_height - self.wheel.radius,
            support: self.footing.support,
            contact: self.position + self.footing.radius * sin(self.footing.angle),
            lugs_counted: number - self.first_lug + 1,
        }
    }

    fn step(&mut self, turn: f64) {
        let support = self.footing.support;
        let whole = self.turned(turn);
        if whole.footing.support == support {
            self.accept(turn, whole);
            return;
        }
        // Turn about the old point until the new one takes over, then about that.
        let (mut kept, mut lost) = (0.0, turn);
        let mut taken_over = whole;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (kept + lost);
            let there = self.turned(middle);
            if there.footing.support == support {
                kept = middle;
            } else {
                (lost, taken_over) = (middle, there);
            }
        }
        self.accept(lost, taken_over);
        let rest = self.turned(turn - lost);
        self.accept(turn - lost, rest);
    }

    fn accept(&mut self, turn: f64, turned: Turned) {
        (self.position, self.footing) = (turned.position, turned.footing);
        self.wheel_angle += turn;
    }

    /// Position [m] after a turn [rad] about the point that carries the wheel, and what carries it
    /// there (Eq. 12, 31).
    fn turned(&mut self, turn: f64) -> Turned {
        let Footing { radius, angle, .. } = self.footing;
        let position = self.position + radius * (sin(angle) - sin(angle - turn));
        let wheel_angle = self.wheel_angle + turn;
        let footing = footing(&self.wheel, &mut self.ground, position, wheel_angle);
        Turned { position, footing }
    }
}

/// Axle position [m] after a turn, and what carries the wheel there.
#[derive(Clone, Copy)]
struct Turned {
    position: f64,
    footing: Footing,
}

/// Number of the lug that carries the wheel, or of the last one before the point of the rim that
/// does (Eq. 36, 39), counted on over full turns.
fn lug_number(wheel: &Wheel, footing: &Footing, wheel_angle: f64) -> i64 {
    let Some(alpha) = wheel.lug_angle() else {
        return 0;
    };
    let place = (footing.angle + wheel_angle) / alpha;
    match footing.support {
        Support::Lug(_) => floor(place + 0.5) as i64,
        Support::Rim => floor(place) as i64,
    }
}

/// The path of `wheel`, let down at `position` \[m\], over ground whose height \[m\] along the track is
/// `ground`, as it turns through `wheel_angles` \[rad\].
///
/// ```
/// use lugwheel::vibration::rolling::{displacement, path};
/// use lugwheel::wheel::Wheel;
///
/// let step = |x: f64| if x > 0.05 { 0.004 } else { 0.0 };
/// let wheel_angles: Vec<f64> = (0..200).map(|i| 0.005 * f64::from(i)).collect();
/// let path = path(&Wheel::rover(), step, 0.0, &wheel_angles);
/// let rise = path[199].rim_height - path[0].rim_height;
/// assert!((0.002..0.006).contains(&rise));
/// assert!(displacement(&path).iter().all(|y| *y >= 0.0));
/// ```
pub fn path(
    wheel: &Wheel,
    ground: impl FnMut(f64) -> f64,
    position: f64,
    wheel_angles: &[f64],
) -> Vec<Pose> {
    let Some(first) = wheel_angles.first() else {
        return Vec::new();
    };
    let mut rolling = Rolling::new(wheel, ground, position, *first);
    wheel_angles
        .iter()
        .map(|wheel_angle| rolling.turn_to(*wheel_angle))
        .collect()
}

/// Output displacement `y = h - min h` \[m\] along a path (Eq. 22, 41).
pub fn displacement(path: &[Pose]) -> Vec<f64> {
    let lowest = path
        .iter()
        .map(|pose| pose.rim_height)
        .fold(f64::INFINITY, f64::min);
    path.iter().map(|pose| pose.rim_height - lowest).collect()
}

/// What a path does while one lug carries the wheel, or the rim without a lug between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stay {
    /// What carries the wheel.
    pub support: Support,
    /// Wheel angles \[rad\] at its first pose and at the first pose of the next stay; at the last pose
    /// of the path where there is none.
    pub wheel_angles: [f64; 2],
    /// Lowest and highest height of the rim \[m\].
    pub rim_heights: [f64; 2],
}

/// The stays of a path, in their order. The first and the last are cut where the path is.
pub fn stays(path: &[Pose]) -> Vec<Stay> {
    let mut end = 0;
    path.chunk_by(|a, b| a.support == b.support)
        .map(|poses| {
            end += poses.len();
            let next = &path[end.min(path.len() - 1)];
            let heights = poses.iter().map(|pose| pose.rim_height);
            Stay {
                support: poses[0].support,
                wheel_angles: [poses[0].wheel_angle, next.wheel_angle],
                rim_heights: [
                    heights.clone().fold(f64::INFINITY, f64::min),
                    heights.fold(f64::NEG_INFINITY, f64::max),
                ],
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use crate::terrain::Roughness;
    use crate::terrain::profile::Profile;
    use crate::vibration::flat_ground;
    use crate::vibration::olig;
    use std::f64::consts::TAU;

    fn angles(turns: f64, count: usize) -> Vec<f64> {
        (0..=count)
            .map(|i| turns * TAU * i as f64 / count as f64)
            .collect()
    }

    /// Slate, 0.4 mm rms, as the hard ground of the scenarios.
    fn slate(run: u64) -> impl FnMut(f64) -> f64 {
        let roughness = Roughness {
            rms: 4.0e-4,
            hurst: 0.8,
            longest: 0.2,
            shortest: 0.002,
        };
        let mut profile = Profile::new(&roughness.into(), 2.5e-4, Seed(2), run);
        move |x| {
            profile.extend(x, x);
            profile.at(x).height
        }
    }

    #[test]
    fn on_flat_ground_the_path_is_eq_10_for_many_lugs_and_few() {
        for wheel in [Wheel::rover(), olig()] {
            let path = path(&wheel, |_| 0.0, 0.3, &angles(0.5, 500));
            for (pose, y) in path.iter().zip(displacement(&path)) {
                let expected = flat_ground::displacement(&wheel, pose.wheel_angle);
                // The path's own lowest pose lies up to half a step from the lug change.
                assert!((y - expected).abs() < 2.0e-4, "{y} {expected}");
                let rim = flat_ground::rim_height(&wheel, pose.wheel_angle);
                assert!((pose.rim_height - rim).abs() < 1e-12);
            }
        }
    }

    /// Eq. (14) on flat ground: `2 (r + l) sin(α/2)` a lug, and for few lugs the rim's own way
    /// between (Eq. 12 corrected): `2 (r + l) sin φ + r (α - 2 φ)`.
    #[test]
    fn a_turn_carries_the_wheel_as_far_as_its_supports_say() {
        for wheel in [Wheel::rover(), olig()] {
            let (alpha, phi) = (
                wheel.lug_angle().unwrap(),
                flat_ground::support_angle(&wheel),
            );
            let per_lug = 2.0 * wheel.tip_radius() * phi.sin() + wheel.radius * (alpha - 2.0 * phi);
            for direction in [1.0, -1.0] {
                let mut rolling = Rolling::new(&wheel, |_| 0.0, 0.0, 0.0);
                let gone = rolling.turn_to(direction * TAU).position;
                let expected = direction * per_lug * f64::from(wheel.lug_count());
                // The rim rolls in steps of 2e-3 rad.
                assert!((gone / expected - 1.0).abs() < 1e-6, "{gone} {expected}");
            }
        }
    }

    /// Eq. (20) corrected: n = 1 + INT((ω t + α/2 - θ)/α) on flat ground.
    #[test]
    fn the_counter_counts_one_lug_a_lug_angle_on_flat_ground() {
        let wheel = Wheel::rover();
        let alpha = wheel.lug_angle().unwrap();
        for pose in path(&wheel, |_| 0.0, 0.0, &angles(1.3, 997)) {
            let expected = 1 + (pose.wheel_angle / alpha + 0.5).floor() as i64;
            assert_eq!(pose.lugs_counted, expected);
        }
    }

    /// Eq. (20) and (39) corrected: n rises by i when the i-th lug ahead comes to ask for the axle's
    /// present height, h' = h (Eq. 18, 19, 26, 27).
    #[test]
    fn support_passes_where_the_next_lugs_height_reaches_the_present_one() {
        let wheel = Wheel::rover();
        let alpha = wheel.lug_angle().unwrap();
        let mut ground = slate(0);
        let mut rolling = Rolling::new(&wheel, slate(0), 0.0, 0.0);
        let mut before = rolling.pose();
        let mut changes = 0;
        for i in 1..8_000 {
            let pose = rolling.turn_to(5.0e-4 * f64::from(i));
            if let (Support::Lug(_), Support::Lug(lug)) = (before.support, pose.support)
                && pose.lugs_counted > before.lugs_counted
            {
                changes += 1;
                let phi = wheel.lug_position(lug, before.wheel_angle);
                let place = before.position + wheel.tip_radius() * phi.sin();
                let asked = ground(place) + wheel.tip_radius() * phi.cos() - wheel.radius;
                let ahead = f64::from((pose.lugs_counted - before.lugs_counted) as i32);
                // The next edge comes down by (r + l) α of its turn.
                let slack = 2.0 * wheel.tip_radius() * ahead * alpha * 5.0e-4;
                let gap = before.rim_height - asked;
                assert!((-1e-9..slack).contains(&gap), "{gap} of {slack}");
            }
            before = pose;
        }
        assert!(changes > 12, "{changes}");
    }

    /// Eq. (17), (33): the i-th lug ahead of the support lies at `X_n + (r + l) η_i`.
    #[test]
    fn lugs_ahead_lie_where_eq_33_says() {
        let wheel = Wheel::rover();
        let (alpha, tip) = (wheel.lug_angle().unwrap(), wheel.tip_radius());
        let mut rolling = Rolling::new(&wheel, slate(1), 0.0, 0.0);
        let pose = rolling.turn_to(2.34);
        let Support::Lug(lug) = pose.support else {
            panic!("slate reached the rim");
        };
        let phi = wheel.lug_position(lug, pose.wheel_angle);
        let standing = pose.position + tip * phi.sin();
        for i in 1..6 {
            let turned = f64::from(i) * alpha;
            let eta = phi.sin() * (turned.cos() - 1.0) + phi.cos() * turned.sin();
            let lies = pose.position + tip * (phi + turned).sin();
            assert!((standing + tip * eta - lies).abs() < 1e-15);
        }
    }

    #[test]
    fn every_lug_touches_slate_and_some_miss_a_ground_of_stones() {
        let wheel = Wheel::rover();
        let touched = |ground: &mut dyn FnMut(f64) -> f64| {
            let path = path(&wheel, ground, 0.0, &angles(1.0, 4000));
            let mut lugs: Vec<u32> = stays(&path)
                .iter()
                .filter_map(|stay| match stay.support {
                    Support::Lug(lug) => Some(lug),
                    Support::Rim => None,
                })
                .collect();
            lugs.sort_unstable();
            lugs.dedup();
            (lugs.len(), path[path.len() - 1].lugs_counted)
        };
        let mut smooth_slate = {
            let mut slate = slate(0);
            move |x: f64| 0.25 * slate(x)
        };
        assert_eq!(touched(&mut smooth_slate), (24, 25));
        // Round stones of 30 mm, every 150 mm, half in the ground: four lugs wide.
        let mut stones = |x: f64| {
            let from_middle = x - 0.15 * (x / 0.15).round();
            (0.03_f64.powi(2) - from_middle * from_middle)
                .max(0.0)
                .sqrt()
        };
        let (lugs, counted) = touched(&mut stones);
        assert!((4..20).contains(&lugs), "{lugs}");
        // The counter passes over those that missed.
        assert!((24..=26).contains(&counted), "{counted}");
    }

    /// What makes fixed ground so quiet: the velocity jumps of a rolling wheel sum to the wheel speed
    /// times the way it went, however rough the ground.
    #[test]
    fn the_vertical_velocity_jumps_by_the_way_from_one_point_to_the_next() {
        let wheel = Wheel::rover();
        let step = 1.0e-4;
        let mut rolling = Rolling::new(&wheel, slate(0), 0.0, 0.0);
        let mut poses = vec![rolling.pose()];
        let mut changes = 0;
        for i in 1..6_000 {
            poses.push(rolling.turn_to(step * f64::from(i)));
            let [.., a, b, c, d] = poses[..] else {
                continue;
            };
            // From b to c the support changes.
            if b.support != c.support {
                let slope = |from: &Pose, to: &Pose| (to.rim_height - from.rim_height) / step;
                let jump = slope(&c, &d) - slope(&a, &b);
                let way = c.contact - b.contact;
                // Between the slopes the support itself turned two steps.
                assert!((jump - way).abs() < 1.0e-3 * way, "{jump} {way}");
                changes += 1;
            }
        }
        assert!(changes >= 2);
    }

    #[test]
    fn rolling_back_on_slate_returns_to_the_start() {
        let wheel = Wheel::single_wheel();
        let mut rolling = Rolling::new(&wheel, slate(3), 0.0, 0.0);
        let start = rolling.pose();
        let there = rolling.turn_to(1.5);
        assert!(there.position > 0.2);
        let back = rolling.turn_to(0.0);
        // A wheel in a hollow between two lugs is let down with either; the rest is rounding.
        assert!((back.position - start.position).abs() < 1e-6, "{back:?}");
        assert!((back.rim_height - start.rim_height).abs() < 1e-6);
    }
}
