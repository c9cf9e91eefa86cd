//! Height of hard ground and of undisturbed soil along the track.
//!
//! Heights are kept at equal spacing and made when the wheel first comes near, in any order:
//! node `i` depends on the seed, the run and `i` alone. Between nodes the height is a cubic with
//! continuous slope (Catmull-Rom), so that a lug edge feels no corners that are not in the ground.
//! Roughness is a sum of cosines with random phases whose powers follow the stated spectrum; the
//! alternative, filtered noise on a ring, repeats itself and must know the length of the run.

use super::{Joints, Ledge, Relief, Roughness};
use crate::quantity::Seed;
use libm::{cos, log, pow, sqrt};
use rand::RngExt;
use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

/// Cosines that stand for a roughness spectrum.
const MODES: usize = 192;

/// Nodes made at once.
const BLOCK: i64 = 256;

/// Heights along the track that a user brings, such as a scan.
pub trait Heights: fmt::Debug + Send + Sync {
    /// Height \[m\] above the datum at `x` \[m\] from the start of the track, below 0 behind it.
    ///
    /// It is read every 0.25 mm, in any order; between these places the ground is a cubic with continuous slope.
    fn height(&self, x: f64) -> f64;
}

/// What makes the heights.
#[derive(Debug, Clone)]
struct Generator {
    own: Option<Arc<dyn Heights>>,
    waves: Vec<Wave>,
    joints: Option<Joints>,
    ledge: Option<Ledge>,
    seed: Seed,
    run: u64,
}

#[derive(Debug, Clone, Copy)]
struct Wave {
    amplitude: f64,
    number: f64,
    phase: f64,
}

/// Height along the track, made as it is asked for.
#[derive(Debug, Clone)]
pub struct Profile {
    generator: Generator,
    spacing: f64,
    first: i64,
    heights: VecDeque<f64>,
    /// From where to where [m] it can be asked for.
    made: [f64; 2],
}

/// Height \[m\] and slope [-] at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Height above the datum \[m\].
    pub height: f64,
    /// Slope along the track [-].
    pub slope: f64,
}

impl Profile {
    /// A profile with nodes every `spacing` \[m\]; without any relief it is flat.
    pub fn new(relief: &Relief, spacing: f64, seed: Seed, run: u64) -> Self {
        let roughness = relief.roughness.as_ref();
        let waves = roughness.map_or_else(Vec::new, |roughness| waves(roughness, seed, run));
        let generator = Generator {
            own: None,
            waves,
            joints: relief.joints,
            ledge: relief.ledge,
            seed,
            run,
        };
        Self {
            generator,
            spacing,
            first: 0,
            heights: VecDeque::new(),
            made: [f64::INFINITY, f64::NEG_INFINITY],
        }
    }

    /// The profile with these heights added; before any is made.
    pub fn with_heights(mut self, heights: Arc<dyn Heights>) -> Self {
        self.generator.own = Some(heights);
        self
    }

    /// Makes sure that `[low, high]` \[m\] can be asked for.
    pub fn extend(&mut self, low: f64, high: f64) {
        let [from, to] = self.made;
        if low >= from && high <= to {
            return;
        }
        let wanted = [
            (low / self.spacing).floor() as i64 - 2,
            (high / self.spacing).ceil() as i64 + 3,
        ];
        if self.heights.is_empty() {
            self.first = wanted[0];
        }
        while self.first > wanted[0] {
            for _ in 0..BLOCK {
                self.first -= 1;
                let height = self.generator.height(self.first as f64 * self.spacing);
                self.heights.push_front(height);
            }
        }
        while self.first + (self.heights.len() as i64) <= wanted[1] {
            for _ in 0..BLOCK {
                let next = self.first + self.heights.len() as i64;
                self.heights
                    .push_back(self.generator.height(next as f64 * self.spacing));
            }
        }
        let last = self.first + self.heights.len() as i64;
        self.made = [self.first + 3, last - 4].map(|node| node as f64 * self.spacing);
    }

    /// Height and slope at `x` \[m\], which [`Profile::extend`] must have reached.
    pub fn at(&self, x: f64) -> Surface {
        let place = x / self.spacing - self.first as f64;
        let i = place as usize;
        let u = place - i as f64;
        let [a, b, c, d] = [
            self.heights[i - 1],
            self.heights[i],
            self.heights[i + 1],
            self.heights[i + 2],
        ];
        let (m0, m1) = (0.5 * (c - a), 0.5 * (d - b));
        let (cubic, square) = (2.0 * (b - c) + m0 + m1, 3.0 * (c - b) - 2.0 * m0 - m1);
        Surface {
            height: ((cubic * u + square) * u + m0) * u + b,
            slope: ((3.0 * cubic * u + 2.0 * square) * u + m0) / self.spacing,
        }
    }

    /// Highest node in `[low, high]` \[m\].
    pub fn highest(&self, low: f64, high: f64) -> f64 {
        self.nodes(low, high)
            .map(|[_, height]| height)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Largest difference \[m\] between neighbouring nodes in `[low, high]` \[m\].
    pub fn steepest_step(&self, low: f64, high: f64) -> f64 {
        let nodes: Vec<[f64; 2]> = self.nodes(low, high).collect();
        let steps = nodes.windows(2).map(|pair| (pair[1][1] - pair[0][1]).abs());
        steps.fold(0.0, f64::max)
    }

    /// Nodes in `[low, high]` \[m\] that have been made: position and height \[m\].
    pub fn nodes(&self, low: f64, high: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
        let from = ((low / self.spacing).ceil() as i64 - self.first).max(0) as usize;
        let to = ((high / self.spacing).floor() as i64 - self.first + 1).max(0) as usize;
        let to = to.min(self.heights.len());
        (from.min(to)..to).map(|i| {
            [
                (self.first + i as i64) as f64 * self.spacing,
                self.heights[i],
            ]
        })
    }

    /// Distance between nodes \[m\].
    pub fn spacing(&self) -> f64 {
        self.spacing
    }
}

impl Generator {
    fn height(&self, x: f64) -> f64 {
        let rough: f64 = self
            .waves
            .iter()
            .map(|w| w.amplitude * cos(w.number * x + w.phase))
            .sum();
        let joints = self.joints.as_ref();
        let ledge = self.ledge.as_ref();
        let own = self.own.as_ref();
        rough
            + own.map_or(0.0, |own| own.height(x))
            + joints.map_or(0.0, |joints| self.brick(joints, x))
            + ledge.map_or(0.0, |ledge| risen(ledge, x))
    }

    /// Height of the brick at `x` over the datum, or of the joint beside it, whose bottom leads from one brick's level to
    /// the next one's.
    fn brick(&self, joints: &Joints, x: f64) -> f64 {
        let cell = (x / joints.spacing).floor() as i64;
        let edge = |k: i64| {
            let jitter: f64 = self.brick_rng("joint", k).random_range(-0.2..0.2);
            (k as f64 + jitter) * joints.spacing
        };
        let mut brick = cell;
        if x < edge(cell) {
            brick -= 1;
        } else if x >= edge(cell + 1) {
            brick += 1;
        }
        let (behind, ahead) = (x - edge(brick), edge(brick + 1) - x);
        let (to_joint, neighbour) = if behind < ahead {
            (behind, brick - 1)
        } else {
            (ahead, brick + 1)
        };
        let top = |brick| joints.step * self.normal("brick", brick);
        let towards = (0.5 - to_joint / joints.width).max(0.0);
        let mut level = top(brick);
        if towards > 0.0 {
            level += towards * (top(neighbour) - level);
        }
        level - groove(to_joint, joints)
    }

    fn brick_rng(&self, what: &str, index: i64) -> rand_chacha::ChaCha8Rng {
        self.seed.rng(&format!("terrain/{what}/{index}"), self.run)
    }

    fn normal(&self, what: &str, index: i64) -> f64 {
        // Box-Muller, by functions whose bits are the same on every machine.
        let mut rng = self.brick_rng(what, index);
        let (radius, turn): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
        sqrt(-2.0 * log(radius)) * cos(TAU * turn)
    }
}

/// Depth [m] of a joint's groove at a distance [m] from its middle: its bottom, then the round edge of the brick.
fn groove(to_joint: f64, joints: &Joints) -> f64 {
    let (radius, depth) = (joints.edge_radius(), joints.depth);
    let run = sqrt((2.0 * radius - depth) * depth);
    let on_edge = (to_joint - 0.5 * joints.width).max(0.0);
    below_top(run - on_edge, radius)
}

/// Depth [m] of a round edge below its top, this far [m] down its run.
fn below_top(down: f64, radius: f64) -> f64 {
    let down = down.clamp(0.0, radius);
    radius - sqrt(radius * radius - down * down)
}

/// Tangent and cosine of the angle at which a ledge's face leans, 75°.
const FACE: [f64; 2] = [3.732_050_807_568_877, 0.258_819_045_102_520_7];

/// Height [m] that a ledge adds at `x` [m].
fn risen(ledge: &Ledge, x: f64) -> f64 {
    let Ledge {
        position,
        height,
        edge_radius,
    } = *ledge;
    let [tangent, cosine] = FACE;
    // The edge is as round as its height allows.
    let round = (edge_radius * (1.0 - cosine)).min(height);
    let run = sqrt((2.0 * edge_radius - round) * round);
    let on_face = (x - position).max(0.0);
    let face = (height - round) / tangent;
    if on_face < face {
        tangent * on_face
    } else {
        height - below_top(face + run - on_face, edge_radius)
    }
}

/// Cosines with wave numbers spread evenly over the logarithm of the band.
fn waves(roughness: &Roughness, seed: Seed, run: u64) -> Vec<Wave> {
    let mut rng = seed.rng("terrain/roughness", run);
    let band = roughness.longest / roughness.shortest;
    let ratio = pow(band, 1.0 / MODES as f64);
    let mut waves: Vec<Wave> = (0..MODES)
        .map(|i| {
            let within: f64 = rng.random();
            let number = TAU / roughness.longest * pow(ratio, i as f64 + within);
            // Power of a band of relative width ln(ratio): C(q) q ∝ q^(-2H).
            let amplitude = pow(number, -roughness.hurst);
            Wave {
                amplitude,
                number,
                phase: TAU * rng.random::<f64>(),
            }
        })
        .collect();
    let power: f64 = waves
        .iter()
        .map(|wave| 0.5 * wave.amplitude * wave.amplitude)
        .sum();
    let scale = roughness.rms / sqrt(power);
    waves.iter_mut().for_each(|wave| wave.amplitude *= scale);
    waves
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLATE: Roughness = Roughness {
        rms: 4.0e-4,
        hurst: 0.8,
        longest: 0.2,
        shortest: 0.002,
    };

    fn rough(run: u64) -> Profile {
        let mut profile = Profile::new(&SLATE.into(), 2.5e-4, Seed(3), run);
        profile.extend(0.0, 2.0);
        profile
    }

    #[test]
    fn roughness_has_its_root_mean_square_over_many_grounds() {
        let squares: f64 = (0..40)
            .map(|run| {
                let profile = rough(run);
                let heights: Vec<f64> = profile.nodes(0.0, 2.0).map(|[_, h]| h).collect();
                heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64
            })
            .sum();
        let rms = sqrt(squares / 40.0);
        // Two metres hold ten of the longest waves: 40 grounds scatter by about 3 %.
        assert!((rms / SLATE.rms - 1.0).abs() < 0.1, "{rms}");
    }

    #[test]
    fn power_falls_with_wavelength_as_the_hurst_exponent_says() {
        let waves = waves(&SLATE, Seed(1), 0);
        let power = |low: f64, high: f64| -> f64 {
            let inside = |w: &&Wave| (low..high).contains(&(TAU / w.number));
            waves
                .iter()
                .filter(inside)
                .map(|w| 0.5 * w.amplitude * w.amplitude)
                .sum()
        };
        // One decade shorter: 10^(2H) less power.
        let ratio = power(0.1, 0.2) / power(0.01, 0.02);
        assert!((ratio / pow(10.0, 1.6) - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn ground_is_the_same_whichever_way_it_is_made() {
        let mut backward = Profile::new(&SLATE.into(), 2.5e-4, Seed(3), 0);
        backward.extend(1.9, 2.0);
        backward.extend(0.0, 2.0);
        for x in [0.0, 0.7331, 1.5] {
            assert_eq!(backward.at(x), rough(0).at(x));
        }
        assert_ne!(rough(1).at(0.5), rough(0).at(0.5));
    }

    #[test]
    fn slope_is_the_derivative_of_height_and_continuous() {
        let profile = rough(0);
        for x in [0.1, 0.10025, 0.3337] {
            let h = 1.0e-7;
            let numeric = (profile.at(x + h).height - profile.at(x - h).height) / (2.0 * h);
            assert!((numeric - profile.at(x).slope).abs() < 1e-3 * (1.0 + numeric.abs()));
        }
    }

    fn bricks(step: f64) -> Profile {
        let joints = Joints {
            step,
            ..Joints::LEVEL
        };
        let mut profile = Profile::new(&joints.into(), 2.5e-4, Seed(5), 0);
        profile.extend(-10.0, 10.0);
        profile
    }

    #[test]
    fn joints_lie_deep_between_bricks() {
        let profile = bricks(0.0);
        let deep = profile.nodes(-10.0, 10.0).filter(|[_, h]| *h < -0.001);
        // A bottom of 5 mm, and on either side what an arc of 6.83 mm that is 2 mm high leaves of itself below 1 mm:
        // 4.83 - 3.56 mm. One every 200 mm.
        let share = deep.count() as f64 * 2.5e-4 / 20.0;
        assert!((share - 0.00754 / 0.2).abs() < 0.003, "{share}");
    }

    #[test]
    fn the_edges_of_bricks_end_at_45_degrees_and_their_joints_lead_from_brick_to_brick() {
        let steepest = bricks(0.0).steepest_step(-10.0, 10.0) / 2.5e-4;
        assert!((0.9..=1.0).contains(&steepest), "{steepest}");
        // Neighbours differ by 1.4 mm of standard deviation, over 5 mm.
        let steepest = bricks(0.001).steepest_step(-10.0, 10.0) / 2.5e-4;
        assert!(steepest < 1.9, "{steepest}");
    }

    #[test]
    fn a_ledge_rises_by_its_face_to_its_height() {
        let ledge = Ledge {
            position: 0.1,
            height: 0.05,
            edge_radius: 0.005,
        };
        assert_eq!(risen(&ledge, 0.1), 0.0);
        assert_eq!(risen(&ledge, 0.2), 0.05);
        let rise = |x: f64| (risen(&ledge, x + 1e-7) - risen(&ledge, x - 1e-7)) / 2.0e-7;
        assert!((rise(0.105) - 75.0_f64.to_radians().tan()).abs() < 1e-6);
        // Where face and arc meet, both have the face's slope.
        let round = 0.005 * (1.0 - 75.0_f64.to_radians().cos());
        let meet = 0.1 + (0.05 - round) / 75.0_f64.to_radians().tan();
        assert!((rise(meet + 2e-7) - 75.0_f64.to_radians().tan()).abs() < 0.01);
    }
}
