//! The force layer: fixed ground acts on the wheel through here, whatever it is made of.

use super::contact::{Reach, WheelGeometry};
use super::hard_contact::{HardGround, RAMP_LENGTH};
use super::motion::WheelMotion;
use super::soil_track::SoilTrack;
use super::stone_bearing::StoneBearing;
use super::stone_bed::{BedRecipe, Floor, Laying, OnBed, StoneBed};
use crate::terrain::class::TerrainLabel;
use crate::terrain::profile::Profile;
use crate::terrain::{Stones, Terrain, TerrainSpec};
use crate::wheel::Wheel;
use std::sync::{Arc, Mutex};

/// Share of a stone's diameter that lies below the surface of sand [-].
const EMBEDDING: f64 = 0.5;

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
    stones: Option<(StoneBed, StoneBearing)>,
}

/// The fixed ground along the track.
pub(super) struct GroundForce {
    layers: Vec<Layer>,
}

impl GroundForce {
    /// The ground of `terrain` under a wheel that rolls on its stones by `on_bed`.
    pub fn new(terrain: &Terrain, wheel: &Wheel, on_bed: OnBed) -> Self {
        let layers =
            (0..terrain.stretches().len()).map(|number| Layer::new(terrain, number, wheel, on_bed));
        Self {
            layers: layers.collect(),
        }
    }

    /// Load on the wheel over one step of `dt` [s].
    pub fn push(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, dt: f64) -> Reach {
        let mut sum = Reach::default();
        let reach = wheel.tip_radius + RAMP_LENGTH;
        let [low, high] = [motion.x - reach, motion.x + reach];
        for layer in self
            .layers
            .iter_mut()
            .filter(|layer| layer.range[0] < high && layer.range[1] > low)
        {
            sum += match &mut layer.filling {
                Filling::Hard(ground) => ground.push(wheel, motion, dt),
                Filling::Soil(track) => track.push(wheel, motion, dt),
                Filling::Stones => Reach::default(),
            };
            if let Some((bed, _)) = &mut layer.stones {
                sum += bed.push(wheel, motion, dt);
            }
        }
        sum
    }

    /// Whether there are stones anywhere.
    pub fn has_stones(&self) -> bool {
        self.layers.iter().any(|layer| layer.stones.is_some())
    }

    /// Brings the stones along with a wheel at `x` [m]: those ahead in, those behind out, those in
    /// soil borne by it over the next step of `dt` [s].
    pub fn follow(&mut self, x: f64, dt: f64) {
        for layer in &mut self.layers {
            let Some((bed, bearing)) = &mut layer.stones else {
                continue;
            };
            bed.follow(x);
            if let Filling::Soil(track) = &mut layer.filling {
                bearing.push(bed, track, dt);
            }
        }
    }

    /// Highest stone [m] near the start.
    fn highest_stone(&self, span: [f64; 2]) -> Option<f64> {
        let beds = self.layers.iter().filter_map(|layer| layer.stones.as_ref());
        beds.filter_map(|(bed, _)| bed.top(span))
            .max_by(f64::total_cmp)
    }

    /// Undisturbed height [m] at `x` [m], and whether the ground there is soil.
    pub fn undisturbed(&mut self, x: f64) -> (f64, bool) {
        let layer = self.layer(x);
        match &mut layer.filling {
            Filling::Hard(ground) => (ground.undisturbed(x), false),
            Filling::Soil(track) => (track.undisturbed(x), true),
            Filling::Stones => (0.0, false),
        }
    }

    /// Height [m] of the ground at `x` [m] before the wheel came, stones included.
    pub fn before(&mut self, x: f64) -> f64 {
        let stones = self.layers.iter().filter_map(|layer| layer.stones.as_ref());
        let stones = stones.filter_map(|(bed, _)| bed.surface(x));
        let top = stones.fold(f64::NEG_INFINITY, f64::max);
        let layer = self.layer(x);
        match (&layer.filling, top.is_finite()) {
            (Filling::Stones, true) => top,
            _ => self.undisturbed(x).0.max(top),
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
        let at_stones = self.highest_stone([-0.7 * wheel.radius, 0.7 * wheel.radius]);
        let at_edges = at_stones.map_or(at_edges, |top| at_edges.max(top + wheel.tip_radius));
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
                    ground.profile().extend(low, high);
                    surface.extend(ground.profile().nodes(low, high));
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
    /// The layer on stretch number `number` of a terrain.
    fn new(terrain: &Terrain, number: usize, wheel: &Wheel, on_bed: OnBed) -> Self {
        let stretch = &terrain.stretches()[number];
        let (label, range) = (stretch.label, stretch.range);
        let profile = terrain.profile(stretch);
        let filling = match &stretch.ground {
            TerrainSpec::Reference { contact }
            | TerrainSpec::Hard { contact, .. }
            | TerrainSpec::GravelOnHard { contact, .. } => {
                let ground = HardGround::new(profile.clone(), *contact, wheel, range);
                Filling::Hard(Box::new(ground))
            }
            TerrainSpec::Gravel { .. } => Filling::Stones,
            TerrainSpec::Sand { soil, .. } | TerrainSpec::GravelInSand { soil, .. } => {
                let track = SoilTrack::new(profile.clone(), *soil, wheel, range);
                Filling::Soil(Box::new(track.under_law(terrain.soil_law().cloned())))
            }
            TerrainSpec::Sequence(_) => unreachable!("a terrain's stretches hold no sequences"),
        };
        let stones = laying(&stretch.ground).map(|(stones, laying)| {
            let (seed, run) = terrain.seed();
            let recipe = BedRecipe {
                stones,
                laying,
                wheel_width: wheel.width,
                seed,
                run,
                number,
            };
            let floor = floor(laying, profile);
            let bed = StoneBed::between(recipe, range, on_bed, floor);
            (bed, StoneBearing::default())
        });
        Self {
            label,
            range,
            filling,
            stones,
        }
    }
}

/// How the stones of a ground lie, if it has any.
fn laying(ground: &TerrainSpec) -> Option<(Stones, Laying)> {
    match *ground {
        TerrainSpec::Gravel { stones, depth } => Some((stones, Laying::Pile { depth })),
        TerrainSpec::GravelOnHard {
            stones,
            stones_per_metre,
            ..
        } => Some((
            stones,
            Laying::Scattered {
                per_metre: stones_per_metre,
            },
        )),
        TerrainSpec::GravelInSand {
            stones,
            stones_per_metre,
            ..
        } => {
            let embedding = EMBEDDING;
            Some((
                stones,
                Laying::Embedded {
                    per_metre: stones_per_metre,
                    embedding,
                },
            ))
        }
        _ => None,
    }
}

/// What stones lie on: the bottom of the trench, or the fixed surface.
fn floor(laying: Laying, profile: Profile) -> Floor {
    match laying {
        Laying::Pile { depth } => Arc::new(move |_| -depth),
        Laying::Scattered { .. } | Laying::Embedded { .. } => {
            let profile = Mutex::new(profile);
            Arc::new(move |x| {
                let mut profile = profile.lock().expect("no height panics");
                profile.extend(x, x);
                profile.at(x).height
            })
        }
    }
}
