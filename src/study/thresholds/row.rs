//! The rows of `thresholds.csv`.

use crate::study::Study;
use crate::study::cells::{Number, list};
use crate::study::table::{Columns, Place};
use crate::terrain::class::Wtic;
use serde::{Deserialize, Serialize};

/// A window and the quantities bounded in it.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(in crate::study) struct WindowRow {
    pub place: Place,
    pub times: [Number; 2],
    pub lug_passes: Number,
    pub lugs: u32,
    /// Whether the rim clears flat ground between the lugs.
    pub multi_lugged: bool,
    pub truth: Option<Wtic>,
    pub touched_share: Number,
    pub bound_kappa_a: Number,
    /// `κ_A` and `κ_ms` at every bandwidth.
    #[serde(deserialize_with = "list")]
    pub acceleration: Vec<[Number; 2]>,
    pub displacement: DisplacementRow,
}

/// The displacement of the wheel in a window; without numbers on movable or yielding ground.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(in crate::study) struct DisplacementRow {
    /// Share of the lugs that carried the wheel [-].
    pub rolled_touched_share: Number,
    /// Steepest line between contacts of neighbouring stays [rad].
    pub steepest: Number,
    /// Bound of the largest `C_M` with that line; none of wheels of few lugs [-].
    pub bound_on_slope: Number,
    /// Median and largest `C_M` of a lug's stay [-].
    pub c_m: [Number; 2],
    /// Largest turn about one lug over the lug angle, `C_f` [-].
    pub c_f_largest: Number,
    /// `κ_A` and `κ_ms` of the displacement [-].
    pub kappa: [Number; 2],
    /// The same of the displacement above the lines between takeovers: means over the turn of `C_f²` and `C_f⁴` [-].
    pub relative: [Number; 2],
}

impl WindowRow {
    /// The columns of a study with these bandwidths [Hz].
    pub fn columns(study: &Study, bandwidths: &[f64]) -> Columns {
        let acceleration = bandwidths
            .iter()
            .map(|bandwidth| ["a", "ms"].map(|of| format!("kappa_{of}_{bandwidth}_hz")));
        Columns::of_place(study)
            .with(["start_s", "end_s", "lug_passes", "lugs", "multi_lugged"])
            .with(["truth", "touched_share", "bound_kappa_a"])
            .list(acceleration)
            .with(["rolled_touched_share", "steepest_rad", "bound_on_slope"])
            .with(["c_m_median", "c_m_largest", "c_f_largest"])
            .with(["displacement_kappa_a", "displacement_kappa_ms"])
            .with(["relative_kappa_a", "relative_kappa_ms"])
    }

    /// Whether all lugs touched in truth and none entered.
    pub fn is_alct(&self) -> bool {
        self.truth == Some(Wtic::Alct)
    }
}
