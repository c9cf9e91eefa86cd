//! Columns of figures that show what was measured beside each arm of a diagnosis.

use super::figure::{Layout, PALETTE};

/// Room left of each panel for its tick labels [px].
const TICKS: f64 = 62.0;
/// Room right of each panel [px].
const RIGHT: f64 = 16.0;
/// Ink of what was measured.
pub const MEASURED: &str = "#8a93a3";

/// An arm: the scenario as it came, recalibrated, with the effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmColumn {
    /// As it came.
    AsShipped,
    /// Parameters recalibrated.
    Recalibrated,
    /// The effect or effects of the answer too.
    WithEffect,
}

impl ArmColumn {
    /// All, in their order.
    pub const ALL: [Self; 3] = [Self::AsShipped, Self::Recalibrated, Self::WithEffect];

    /// What stands above the column.
    pub fn title(self, effect: &str) -> String {
        match self {
            Self::AsShipped => "nominal".to_owned(),
            Self::Recalibrated => "recalibrated".to_owned(),
            Self::WithEffect => format!("with {effect}"),
        }
    }

    /// Its colour.
    pub fn colour(self) -> &'static str {
        match self {
            Self::AsShipped => PALETTE[1],
            Self::Recalibrated => PALETTE[0],
            Self::WithEffect => PALETTE[2],
        }
    }
}

/// Columns side by side, or in a narrow layout one below the other.
pub fn blocks<T>(columns: &[T], layout: Layout) -> impl Iterator<Item = &[T]> {
    let together = if layout.is_compact() {
        1
    } else {
        columns.len()
    };
    columns.chunks(together.max(1))
}

/// Left edge and width [px] of the panels of `count` columns.
pub fn columns(count: usize, layout: Layout) -> Vec<[f64; 2]> {
    let pitch = layout.width / count.max(1) as f64;
    (0..count)
        .map(|place| [place as f64 * pitch + TICKS, pitch - TICKS - RIGHT])
        .collect()
}
