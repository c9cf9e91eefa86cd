//! Ground along the track: what a scenario asks for, and its realisation for one run.

pub mod class;
pub mod profile;

use crate::quantity::Seed;
use crate::soil::Soil;
use class::TerrainLabel;
use profile::Profile;
use serde::{Deserialize, Serialize};

/// Hunt-Crossley contact of lug edge or rim with stone: `F = F_0 (δ/δ_0)ⁿ (1 + d δ̇)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HardContact {
    /// Load `F_0` [N] at the reference indentation.
    pub reference_load: f64,
    /// Indentation `δ_0` [m] at that load.
    pub reference_indentation: f64,
    /// Exponent `n` [-].
    pub exponent: f64,
    /// Dissipation `d` [s/m].
    pub dissipation: f64,
}

/// Self-affine roughness: spectral density `∝ q^-(1+2H)` between two wavelengths, flat above the longest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Roughness {
    /// Root-mean-square height [m].
    pub rms: f64,
    /// Hurst exponent `H` [-].
    pub hurst: f64,
    /// Longest wavelength [m].
    pub longest: f64,
    /// Shortest wavelength [m].
    pub shortest: f64,
}

/// Joints between slates or bricks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joints {
    /// Mean length of a brick [m].
    pub spacing: f64,
    /// Width of a joint [m].
    pub width: f64,
    /// Depth of a joint [m].
    pub depth: f64,
    /// Standard deviation of the height of neighbouring bricks [m].
    pub step: f64,
}

/// Free stones: convex polygons.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stones {
    /// Smallest and largest size [m] (mean diameter, log-uniform between them).
    pub size: SizeRange,
    /// Angularity [-]: 0 rounded, 1 sharp and irregular.
    pub angularity: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Friction coefficient [-] stone on stone.
    pub friction: f64,
}

/// Smallest and largest size [m].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SizeRange {
    /// Smallest [m].
    pub min: f64,
    /// Largest [m].
    pub max: f64,
}

/// The ground a scenario asks for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum TerrainSpec {
    /// REF: flat and hard.
    Reference {
        /// Contact with the wheel.
        contact: HardContact,
    },
    /// HT: slate or stone bricks.
    Hard {
        /// Contact with the wheel.
        contact: HardContact,
        /// Roughness of the bricks.
        roughness: Roughness,
        /// Joints between them.
        #[serde(skip_serializing_if = "Option::is_none")]
        joints: Option<Joints>,
    },
    /// GT: a settled pile of free stones.
    Gravel {
        /// Contact of the wheel with the floor beneath, should it dig that deep.
        contact: HardContact,
        /// The stones.
        stones: Stones,
        /// Depth of the pile [m].
        depth: f64,
    },
    /// HGT: free stones scattered on slate.
    GravelOnHard {
        /// Contact with the wheel.
        contact: HardContact,
        /// Roughness of the slate.
        roughness: Roughness,
        /// The stones.
        stones: Stones,
        /// Stones per metre of track [1/m].
        stones_per_metre: f64,
    },
    /// ST: sand.
    Sand {
        /// The soil.
        soil: Soil,
        /// Roughness of its surface.
        #[serde(skip_serializing_if = "Option::is_none")]
        roughness: Option<Roughness>,
    },
    /// SGT: stones in and on sand.
    GravelInSand {
        /// The soil.
        soil: Soil,
        /// Roughness of its surface.
        #[serde(skip_serializing_if = "Option::is_none")]
        roughness: Option<Roughness>,
        /// The stones.
        stones: Stones,
        /// Stones per metre of track [1/m].
        stones_per_metre: f64,
    },
    /// One after another along the track; the last one never ends.
    Sequence(Vec<Section>),
}

/// A stretch of a sequence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Length [m].
    pub length: f64,
    /// What the ground is there; no sequence.
    pub ground: TerrainSpec,
}

impl TerrainSpec {
    /// The label of this ground; of the first stretch of a sequence.
    pub fn label(&self) -> TerrainLabel {
        match self {
            Self::Reference { .. } => TerrainLabel::Reference,
            Self::Hard { .. } => TerrainLabel::Hard,
            Self::Gravel { .. } => TerrainLabel::Gravel,
            Self::GravelOnHard { .. } => TerrainLabel::HardWithGravel,
            Self::Sand { .. } => TerrainLabel::Sand,
            Self::GravelInSand { .. } => TerrainLabel::SandWithGravel,
            Self::Sequence(sections) => sections.first().map_or(TerrainLabel::Reference, |s| s.ground.label()),
        }
    }

    /// Roughness and joints of the fixed surface.
    fn surface(&self) -> (Option<&Roughness>, Option<&Joints>) {
        match self {
            Self::Hard { roughness, joints, .. } => (Some(roughness), joints.as_ref()),
            Self::GravelOnHard { roughness, .. } => (Some(roughness), None),
            Self::Sand { roughness, .. } | Self::GravelInSand { roughness, .. } => (roughness.as_ref(), None),
            Self::Reference { .. } | Self::Gravel { .. } | Self::Sequence(_) => (None, None),
        }
    }
}

/// One ground between two places of the track.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// From and to [m].
    pub range: [f64; 2],
    /// What the ground is; no sequence.
    pub ground: TerrainSpec,
    /// Its label.
    pub label: TerrainLabel,
}

/// The ground of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Terrain {
    stretches: Vec<Stretch>,
    seed: Seed,
    run: u64,
}

/// Distance between nodes of hard ground [m]: an eighth of the shortest roughness in use.
const NODE: f64 = 2.5e-4;

impl Terrain {
    /// The ground of `run`. The run starts at 0; the first stretch reaches back without end and
    /// the last one forward.
    pub fn generate(spec: &TerrainSpec, seed: Seed, run: u64) -> Self {
        let whole = [Section { length: f64::INFINITY, ground: spec.clone() }];
        let sections = match spec {
            TerrainSpec::Sequence(sections) => sections.as_slice(),
            _ => whole.as_slice(),
        };
        let mut end = 0.0;
        let mut stretches: Vec<Stretch> = sections
            .iter()
            .map(|section| {
                let start = end;
                end += section.length;
                let ground = section.ground.clone();
                Stretch { range: [start, end], label: ground.label(), ground }
            })
            .collect();
        if let Some(first) = stretches.first_mut() {
            first.range[0] = f64::NEG_INFINITY;
        }
        if let Some(last) = stretches.last_mut() {
            last.range[1] = f64::INFINITY;
        }
        Self { stretches, seed, run }
    }

    /// The stretches in their order along the track.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// Height of the fixed surface of `stretch`.
    pub fn profile(&self, stretch: &Stretch) -> Profile {
        let (roughness, joints) = stretch.ground.surface();
        Profile::new(roughness, joints, NODE, self.seed, self.run)
    }

    /// Where the run's draws come from.
    pub fn seed(&self) -> (Seed, u64) {
        (self.seed, self.run)
    }
}
