//! Height of hard ground and of undisturbed soil along the track.
//!
//! Heights are kept at equal spacing and made when the wheel first comes near, in any order:
//! node `i` depends on the seed, the run and `i` alone. Between nodes the height is a cubic with
//! continuous slope (Catmull-Rom), so that a lug edge feels no corners that are not in the ground.
//! Roughness is a sum of cosines with random phases whose powers follow the stated spectrum; the
//! alternative, filtered noise on a ring, repeats itself and must know the length of the run.

use super::{Joints, Roughness};
use crate::quantity::Seed;
use libm::{cos, log, pow, sqrt};
use rand::RngExt;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Cosines that stand for a roughness spectrum.
const MODES: usize = 192;

/// Nodes made at once.
const BLOCK: i64 = 256;

/// What makes the heights.
#[derive(Debug, Clone)]
struct Generator {
    waves: Vec<Wave>,
    joints: Option<Joints>,
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

/// Height [m] and slope [-] at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Height above the datum [m].
    pub height: f64,
    /// Slope along the track [-].
    pub slope: f64,
}

impl Profile {
    /// A profile with nodes every `spacing` [m]; without roughness and joints it is flat.
    pub fn new(
        roughness: Option<&Roughness>,
        joints: Option<&Joints>,
        spacing: f64,
        seed: Seed,
        run: u64,
    ) -> Self {
        let waves = roughness.map_or_else(Vec::new, |roughness| waves(roughness, seed, run));
        let generator = Generator {
            waves,
            joints: joints.copied(),
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

    /// Makes sure that `[low, high]` [m] can be asked for.
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

    /// Height and slope at `x` [m], which [`Profile::extend`] must have reached.
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

    /// Highest node in `[low, high]` [m].
    pub fn highest(&self, low: f64, high: f64) -> f64 {
        self.nodes(low, high)
            .map(|[_, height]| height)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Largest difference [m] between neighbouring nodes in `[low, high]` [m].
    pub fn steepest_step(&self, low: f64, high: f64) -> f64 {
        let nodes: Vec<[f64; 2]> = self.nodes(low, high).collect();
        let steps = nodes.windows(2).map(|pair| (pair[1][1] - pair[0][1]).abs());
        steps.fold(0.0, f64::max)
    }

    /// Nodes in `[low, high]` [m] that have been made: position and height [m].
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

    /// Distance between nodes [m].
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
        rough
            + self
                .joints
                .as_ref()
                .map_or(0.0, |joints| self.brick(joints, x))
    }

    /// Height of the brick at `x` over the datum, or of the joint beside it.
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
        let to_joint = (x - edge(brick)).min(edge(brick + 1) - x);
        let top = joints.step * self.normal("brick", brick);
        top - joints.depth * groove(to_joint, joints)
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

/// Depth of a joint's groove from 0 to 1 at a distance [m] from its middle, with edges bevelled at
/// 45° or less.
///
/// A lug under load `W` leaves a flank of slope `m` only at a pull of `W (m + μ) / (1 - m μ)`, which
/// grows without bound towards `m μ = 1`. Bricks have broken and rounded edges; at 45° and the
/// friction of metal on stone, 0.6, the lug needs `4 W`. A steeper flank holds it like a wedge.
fn groove(to_joint: f64, joints: &Joints) -> f64 {
    let bevel = (0.25 * joints.width).max(joints.depth).max(1.0e-3);
    ((0.5 * joints.width + bevel - to_joint) / bevel).clamp(0.0, 1.0)
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
        let mut profile = Profile::new(Some(&SLATE), None, 2.5e-4, Seed(3), run);
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
        let mut backward = Profile::new(Some(&SLATE), None, 2.5e-4, Seed(3), 0);
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

    #[test]
    fn joints_lie_deep_between_bricks() {
        let joints = Joints {
            spacing: 0.2,
            width: 0.005,
            depth: 0.002,
            step: 0.0,
        };
        let mut profile = Profile::new(None, Some(&joints), 2.5e-4, Seed(5), 0);
        profile.extend(-10.0, 10.0);
        let low = profile
            .nodes(-10.0, 10.0)
            .filter(|[_, h]| *h < -0.001)
            .count() as f64;
        // Grooves are 5 mm wide and bevelled, one every 200 mm.
        let share = low * 2.5e-4 / 20.0;
        assert!((0.02..0.04).contains(&share), "{share}");
    }
}
