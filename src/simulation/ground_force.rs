//! The force layer: fixed ground acts on the wheel through here, whatever it is made of.

use super::contact::{Reach, WheelGeometry};
use super::hard_contact::HardGround;
use super::soil_track::SoilTrack;
use super::world::WheelMotion;
use crate::terrain::class::TerrainLabel;
use crate::terrain::{Stretch, Terrain, TerrainSpec};
use crate::wheel::Wheel;

/// What fills one stretch of the track.
enum Filling {
    Hard(Box<HardGround>),
    Soil(Box<SoilTrack>),
    /// Nothing fixed within the wheel's reach: stones alone carry it.
    Stones,
}

struct Layer {
    label: TerrainLabel,
    range: [f64; 2],
    filling: Filling,
}

/// The fixed ground along the track.
pub(super) struct GroundForce {
    layers: Vec<Layer>,
}

impl GroundForce {
    pub fn new(terrain: &Terrain, wheel: &Wheel) -> Self {
        let layers = terrain
            .stretches()
            .iter()
            .map(|stretch| Layer::new(terrain, stretch, wheel))
            .collect();
        Self { layers }
    }

    /// Load on the wheel over one step of `dt` [s].
    pub fn push(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, dt: f64) -> Reach {
        let mut sum = Reach::default();
        let [low, high] = [motion.x - wheel.tip_radius, motion.x + wheel.tip_radius];
        for layer in self
            .layers
            .iter_mut()
            .filter(|layer| layer.range[0] < high && layer.range[1] > low)
        {
            let reach = match &mut layer.filling {
                Filling::Hard(ground) => ground.push(wheel, motion, dt),
                Filling::Soil(track) => track.push(wheel, motion, dt),
                Filling::Stones => continue,
            };
            sum.wrench += reach.wrench;
            sum.touching |= reach.touching;
            sum.entered |= reach.entered;
        }
        sum
    }

    /// Undisturbed height [m] at `x` [m], and whether the ground there is soil.
    pub fn undisturbed(&mut self, x: f64) -> (f64, bool) {
        let layer = self.layer(x);
        match &mut layer.filling {
            Filling::Hard(ground) => {
                let (profile, offset) = ground.profile();
                profile.extend(x, x);
                (profile.at(x).height + offset, false)
            }
            Filling::Soil(track) => (track.undisturbed(x), true),
            Filling::Stones => (0.0, false),
        }
    }

    /// Height [m] of the axle at which the wheel, at rest at 0, just touches.
    pub fn resting_height(&mut self, wheel: &WheelGeometry) -> f64 {
        let motion = WheelMotion {
            cos: 1.0,
            ..WheelMotion::default()
        };
        let edges: Vec<[f64; 2]> = wheel.lowest_edges(&motion).map(|edge| edge.arm).collect();
        let at_edges = edges
            .into_iter()
            .map(|[x, down]| self.undisturbed(x).0 - down)
            .fold(f64::NEG_INFINITY, f64::max);
        let steps = 400;
        (-steps..=steps)
            .map(|step| f64::from(step) / f64::from(steps) * 0.9 * wheel.radius)
            .map(|x| self.undisturbed(x).0 + libm::sqrt(wheel.radius * wheel.radius - x * x))
            .fold(at_edges, f64::max)
    }

    /// The surface as it is now between two places: position and height [m].
    pub fn surface(&mut self, low: f64, high: f64) -> Vec<[f64; 2]> {
        let mut surface = Vec::new();
        for layer in &mut self.layers {
            let [low, high] = [low.max(layer.range[0]), high.min(layer.range[1])];
            match &mut layer.filling {
                _ if low >= high => {}
                Filling::Hard(ground) => {
                    let (profile, offset) = ground.profile();
                    profile.extend(low, high);
                    surface.extend(
                        profile
                            .nodes(low, high)
                            .map(|[x, height]| [x, height + offset]),
                    );
                }
                Filling::Soil(track) => {
                    surface.extend(track.surface(low, high));
                }
                Filling::Stones => {}
            }
        }
        surface
    }

    /// Label of the ground at `x` [m].
    pub fn label(&mut self, x: f64) -> TerrainLabel {
        self.layer(x).label
    }

    fn layer(&mut self, x: f64) -> &mut Layer {
        let index = self
            .layers
            .iter()
            .position(|layer| x < layer.range[1])
            .unwrap_or(self.layers.len() - 1);
        &mut self.layers[index]
    }
}

impl Layer {
    fn new(terrain: &Terrain, stretch: &Stretch, wheel: &Wheel) -> Self {
        let range = stretch.range;
        let profile = terrain.profile(stretch);
        let hard = |contact, offset| {
            Filling::Hard(Box::new(HardGround::new(
                profile.clone(),
                contact,
                wheel.friction,
                range,
                offset,
            )))
        };
        let filling = match &stretch.ground {
            TerrainSpec::Reference { contact }
            | TerrainSpec::Hard { contact, .. }
            | TerrainSpec::GravelOnHard { contact, .. } => hard(*contact, 0.0),
            TerrainSpec::Gravel { .. } => Filling::Stones,
            TerrainSpec::Sand { soil, .. } | TerrainSpec::GravelInSand { soil, .. } => {
                Filling::Soil(Box::new(SoilTrack::new(profile, *soil, wheel, range)))
            }
            TerrainSpec::Sequence(_) => unreachable!("a terrain's stretches hold no sequences"),
        };
        Self {
            label: stretch.label,
            range,
            filling,
        }
    }
}
