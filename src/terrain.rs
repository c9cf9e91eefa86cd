//! Ground along the track: what a scenario asks for, and its realisation for one run.

pub mod class;
pub mod stones;

use crate::soil::Soil;
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
