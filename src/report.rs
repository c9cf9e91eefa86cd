//! Outcomes as figures and pages. Everything here returns text; nothing reads or writes a file.
//!
//! - [`trace_figure`]: what one run recorded, as one drawing.
//! - [`run_page()`]: the same as a page, with [`RunView`]: the wheel moves over its ground, and channels can be
//!   zoomed and read off.
//! - [`mcap_file()`]: the same for viewers of robots.
//! - [`side_by_side()`]: the same channels of several runs, on one scale.
//! - [`wheel_picture()`]: the wheel on its ground, to scale.
//! - [`feature_values()`], [`feature_planes()`]: windows by their vibration features.
//! - [`traverse_figure()`]: a run and the class of each of its windows.
//! - [`confusion_figure()`]: answers counted against truth.
//! - [`sweep_figure()`]: steady means and right answers at every value of a swept key.
//! - [`threshold_figure()`]: how a study's windows lie to a limit of Eq. (55) to (58).
//! - [`force_curves()`]: measured forces and those that identified parameters give back.
//! - [`gap_map()`]: channels by domains, where measured and simulated runs differ.
//! - [`matrix_figure()`], [`power_figure()`], [`detection_figure()`], [`reliability_figure()`]: what blind trials of the
//!   diagnosis came to.
//! - [`gap_waterfall()`]: how that gap closes, [`probability_bars()`]: what explains it,
//!   [`isolability_map()`]: which effects show alike.
//! - [`campaign_bars()`]: how probable each explanation is to a diagnosis of each of several campaigns.
//! - [`arm_traces()`], [`arm_curves()`]: measured runs beside what a diagnosis makes of them.
//! - [`parameter_figure()`]: identified parameters by ground (Fig. 23 and 24).
//! - [`page()`]: a question, its answer, tables and figures as one HTML document; [`page`](mod@page)
//!   has the parts.
//! - [`diagnosis_page()`]: what a diagnosis found, as such a document.
//! - [`study_page()`]: what a study asked, what came of it and what was run, as such a document.
//! - [`image`]: any of the drawings as PNG or PDF.

mod arm_column;
mod arm_curves;
mod arm_traces;
mod campaign_bars;
mod channel_groups;
mod channel_row;
mod class_strip;
mod confusion_figure;
pub mod detection_figure;
mod diagnosis_page;
mod envelope;
mod feature_planes;
mod feature_points;
mod feature_values;
pub mod figure;
mod force_curves;
mod gap_map;
mod gap_waterfall;
pub mod image;
mod isolability_map;
mod matrix_figure;
mod mcap_file;
mod packed;
pub mod page;
mod parameter_figure;
mod power_figure;
mod probability_bars;
mod reliability_figure;
mod run_page;
mod run_view;
mod run_words;
mod scene;
mod share_series;
mod side_by_side;
pub mod study_page;
mod sweep_figure;
mod threshold_figure;
mod trace_figure;
mod traverse_figure;
pub mod wheel_picture;

pub use arm_curves::arm_curves;
pub use arm_traces::arm_traces;
pub use campaign_bars::{CampaignBar, campaign_bars};
pub use confusion_figure::confusion_figure;
pub use detection_figure::detection_figure;
pub use diagnosis_page::{DiagnosisReport, diagnosis_page};
pub use feature_planes::feature_planes;
pub use feature_points::{FeaturePoint, Group};
pub use feature_values::feature_values;
pub use force_curves::force_curves;
pub use gap_map::gap_map;
pub use gap_waterfall::gap_waterfall;
pub use isolability_map::isolability_map;
pub use matrix_figure::{Entries, matrix_figure};
pub use mcap_file::mcap_file;
pub use page::{Page, page};
pub use parameter_figure::{IdentifiedGround, parameter_figure};
pub use power_figure::power_figure;
pub use probability_bars::probability_bars;
pub use reliability_figure::reliability_figure;
pub use run_page::run_page;
pub use run_view::RunView;
pub use side_by_side::side_by_side;
pub use study_page::{StudyReport, study_page};
pub use sweep_figure::{MethodParts, SweptKey, sweep_figure};
pub use threshold_figure::threshold_figure;
pub use trace_figure::{laid_out_trace_figure, trace_figure};
pub use traverse_figure::traverse_figure;
pub use wheel_picture::wheel_picture;

/// Why there is nothing to report.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The run holds no finite sample, mean or ground.
    #[error(
        "run {0} holds nothing to draw: no channel or mean with a finite value, and no ground profile"
    )]
    Empty(String),
    /// The MCAP format has no place for it.
    #[error("cannot write MCAP: {0}")]
    Mcap(String),
}
