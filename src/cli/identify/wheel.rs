//! The wheel of a run.

use crate::trace::RunAttributes;
use crate::trace::wheel::Lugs;
use serde::Serialize;
use std::fmt;

/// The wheel of a run.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct WheelOfRun {
    /// Rim radius [m].
    pub radius_m: f64,
    /// Width [m].
    pub width_m: f64,
    /// Number of lugs; none where unknown.
    pub lug_count: Option<u32>,
    /// Lug height [m]; none where unknown.
    pub lug_height_m: f64,
    /// Lug thickness [m]; none where unknown.
    pub lug_thickness_m: Option<f64>,
}

impl WheelOfRun {
    /// The wheel of a run with these attributes.
    pub fn of(run: &RunAttributes) -> Self {
        Self {
            radius_m: run.wheel_radius,
            width_m: run.wheel_width,
            // The lug height of a smooth wheel may be missing.
            lug_height_m: if run.lugs().are_none() {
                0.0
            } else {
                run.lug_height
            },
            lug_count: run.lug_count,
            lug_thickness_m: run.lug_thickness,
        }
    }

    /// Its lugs.
    pub fn lugs(&self) -> Lugs {
        Lugs {
            count: self.lug_count,
            height: self.lug_height_m,
        }
    }

    /// Whether it is the same wheel; unknown dimensions are equal to each other.
    pub fn is(&self, other: &Self) -> bool {
        let lengths = |wheel: &Self| {
            let Self {
                radius_m,
                width_m,
                lug_height_m,
                ..
            } = wheel;
            [radius_m, width_m, lug_height_m].map(|length| length.to_bits())
        };
        let thicknesses = self.lug_thickness_m.zip(other.lug_thickness_m);
        self.lug_count == other.lug_count
            && thicknesses.is_none_or(|(own, other)| own == other)
            && lengths(self) == lengths(other)
    }
}

impl fmt::Display for WheelOfRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // To a hundredth of a millimetre.
        let shown = |length: f64| (length * 1.0e5).round() / 1.0e2;
        let [radius, width] = [self.radius_m, self.width_m].map(shown);
        write!(
            f,
            "rim radius {radius} mm, width {width} mm, {}",
            self.lugs()
        )
    }
}
