//! What the ground is called (label) and how the wheel meets it (class).

use serde::{Deserialize, Serialize};
use std::fmt;

/// Terrain of a run, as the paper names it (Fig. 10).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum TerrainLabel {
    /// Flat hard ground, the reference.
    #[serde(rename = "REF")]
    Reference,
    /// Hard terrain: slate or stone bricks.
    #[serde(rename = "HT")]
    Hard,
    /// Gravel terrain: a pile of free stones.
    #[serde(rename = "GT")]
    Gravel,
    /// Sandy terrain.
    #[serde(rename = "ST")]
    Sand,
    /// Hard terrain with gravel: stones scattered on slate.
    #[serde(rename = "HGT")]
    HardWithGravel,
    /// Sandy terrain with gravel.
    #[serde(rename = "SGT")]
    SandWithGravel,
}

/// All labels, in the order of their numbers.
pub const LABELS: [TerrainLabel; 6] = [
    TerrainLabel::Reference,
    TerrainLabel::Hard,
    TerrainLabel::Gravel,
    TerrainLabel::Sand,
    TerrainLabel::HardWithGravel,
    TerrainLabel::SandWithGravel,
];

impl TerrainLabel {
    /// The label in run files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Reference => "REF",
            Self::Hard => "HT",
            Self::Gravel => "GT",
            Self::Sand => "ST",
            Self::HardWithGravel => "HGT",
            Self::SandWithGravel => "SGT",
        }
    }

    /// The class that this ground stands for (Section 3.2): hard ground for ALCT, stones on it or
    /// in a pile for SLCT, soil for LEIS. What a wheel really met in a window may differ.
    pub fn class(self) -> Wtic {
        match self {
            Self::Reference | Self::Hard => Wtic::Alct,
            Self::Gravel | Self::HardWithGravel => Wtic::Slct,
            Self::Sand | Self::SandWithGravel => Wtic::Leis,
        }
    }
}

impl fmt::Display for TerrainLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Wheel-terrain interaction class (Table 1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Wtic {
    /// All lugs contact the terrain surface.
    Alct,
    /// Some lugs contact the terrain surface.
    Slct,
    /// Lugs enter into the soil.
    Leis,
    /// Unknown.
    Uwtic,
}

impl Wtic {
    /// The class in run files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Alct => "ALCT",
            Self::Slct => "SLCT",
            Self::Leis => "LEIS",
            Self::Uwtic => "UWTIC",
        }
    }
}

impl fmt::Display for Wtic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
