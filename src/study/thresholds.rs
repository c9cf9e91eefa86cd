//! The `[thresholds]` of a study file, and `thresholds.csv`: the quantities bounded by (55) to (58), one row
//! per window of every run that did not fail.
//!
//! | columns | content |
//! |---|---|
//! | `run`, `condition`, `repeat` | numbers from 0 |
//! | `scenario`, every swept key | the condition |
//! | `start_s`, `end_s`, `lug_passes` | the window, and how far the wheel turned in it, in lug angles |
//! | `lugs`, `multi_lugged` | their number, and whether the rim clears flat ground |
//! | `truth`, `touched_share` | the true class by the contacts, and its share |
//! | `bound_kappa_a` | (57); for an olig-lugged wheel its own, see [`bounds`]. The bound of `kappa_ms` is its square |
//! | `kappa_a_20_hz`, `kappa_ms_20_hz`, ... | of the acceleration at each bandwidth, over the computed reference |
//! | `rolled_touched_share` | of the wheel rolled without slip over the same ground |
//! | `steepest_rad` | its steepest line between contacts of neighbouring lugs |
//! | `bound_on_slope` | of `c_m_largest` with that line; none for olig-lugged wheels |
//! | `c_m_median`, `c_m_largest` | of its lugs' stays |
//! | `c_f_largest` | the largest turn about a lug over the lug angle |
//! | `displacement_kappa_a`, `displacement_kappa_ms` | of its displacement |
//! | `relative_kappa_a`, `relative_kappa_ms` | of its displacement above the lines between takeovers: `C_f²` and `C_f⁴`, mean over the turn |
//!
//! The displacement's columns are empty on movable or yielding ground.
//!
//! The result has a [`Statement`] for every limit: how often windows on which every lug
//! touched exceed the limit, and how tight it is.

mod displacement;
mod row;
mod statement;
pub mod tally;

pub use statement::{Part, Point, Statement, ThresholdScore};

use super::analysis::{Analysis, Finished, Observed, Report};
use super::cells::Number;
use super::table::{Columns, NoRows, Stop};
use super::{Reading, Study, StudyError};
use crate::document::Misfit;
use crate::features::record::Record;
use crate::features::reference::Reference;
use crate::features::{Extractor, Settings, Window};
use crate::quantity::RangeError;
use crate::terrain::Terrain;
use crate::terrain::class::Wtic;
use crate::trace::{LugTally, Trace};
use crate::vibration::bounds;
use crate::wheel::Wheel;
use displacement::Ground;
use row::WindowRow;
use serde::Deserialize;
use std::ops::Range;

/// A `[thresholds]` before its checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ThresholdsTable {
    bandwidths: Vec<f64>,
}

/// At which bandwidths [Hz] the acceleration is compared with the limits.
#[derive(Debug, Clone)]
pub(super) struct Thresholds {
    pub(super) bandwidths: Vec<f64>,
}

impl Analysis for Thresholds {
    const ROWS: Option<&'static str> = Some("thresholds");
    type Plan = ThresholdsTable;
    type Row = WindowRow;
    type Score = ThresholdScore;

    fn read(plan: ThresholdsTable, file: &Reading) -> Result<Self, Misfit> {
        let ThresholdsTable { bandwidths } = plan;
        if bandwidths.is_empty() {
            let message = "name one or more bandwidths [Hz] of the acceleration";
            return Err(file.at("thresholds.bandwidths")(message));
        }
        for (number, bandwidth) in bandwidths.iter().enumerate() {
            let key = format!("thresholds.bandwidths.{number}");
            RangeError::positive("bandwidth", "Hz", *bandwidth).map_err(file.at(&key))?;
            if bandwidths[..number].contains(bandwidth) {
                return Err(file.at(&key)(format!("{bandwidth} Hz is named twice")));
            }
        }
        Ok(Self { bandwidths })
    }

    fn columns(&self, study: &Study) -> Columns {
        WindowRow::columns(study, &self.bandwidths)
    }

    /// A run whose channels cannot be used, on a smooth wheel for one, has no windows.
    fn rows(&self, run: &Observed, _: &mut Stop) -> Result<Vec<WindowRow>, NoRows> {
        let Ok(record) = Record::of(run.trace) else {
            return Ok(Vec::new());
        };
        let scenario = run.study.scenario(run.run);
        let terrain = Terrain::generate(&scenario.terrain, run.study.seed, run.run.stream);
        let mut ground = Ground::of(&scenario, &terrain);
        let mut extractors = self.extractors().map_err(NoRows::failed)?;
        let windows = record.windows(Window::Seconds(scenario.window()));
        let row = |window: Range<usize>| {
            let accelerations = extractors
                .iter_mut()
                .map(|extractor| acceleration(&record, &window, extractor));
            let accelerations = accelerations.collect();
            let displacement = ground
                .as_mut()
                .and_then(|ground| ground.displacement(&record, &window, &mut extractors[0]));
            WindowRow {
                acceleration: accelerations,
                displacement: displacement.unwrap_or_default(),
                ..window_row(run, &record, &window)
            }
        };
        Ok(windows.into_iter().map(row).collect())
    }

    fn score(&self, done: &Finished, rows: Vec<WindowRow>) -> Result<ThresholdScore, StudyError> {
        Ok(ThresholdScore::of(done.study, &self.bandwidths, &rows))
    }

    fn report(_: &ThresholdScore) -> Option<Report> {
        Some(Report {
            stem: "thresholds",
            rows: "thresholds",
            table: "thresholds.csv",
            csv: None,
        })
    }
}

impl Thresholds {
    fn extractors(&self) -> Result<Vec<Extractor>, RangeError> {
        let settings = self.bandwidths.iter().map(|&bandwidth| Settings {
            bandwidth,
            ..Settings::default()
        });
        settings.map(Extractor::new).collect()
    }
}

/// A window with its wheel and its truth.
fn window_row(run: &Observed, record: &Record, window: &Range<usize>) -> WindowRow {
    let times = [window.start, window.end].map(|sample| record.time(sample));
    let (truth, touched_share) = truth(run.trace, times);
    WindowRow {
        place: run.place(),
        times: times.map(Number::from),
        lug_passes: record.lug_passes(window).into(),
        lugs: record.wheel.lug_count(),
        multi_lugged: record.wheel.is_multi_lugged(),
        truth,
        touched_share,
        bound_kappa_a: amplitude_bound(&record.wheel).into(),
        ..WindowRow::default()
    }
}

/// The true class of a window between two times [s], and the share of its lugs that touched.
fn truth(trace: &Trace, times: [f64; 2]) -> (Option<Wtic>, Number) {
    let known = trace.truth.as_ref();
    let truth = known.and_then(|truth| truth.window_of(times));
    let share = |lugs: LugTally| f64::from(lugs.touched) / f64::from(lugs.passed);
    let share = truth.and_then(|truth| truth.lugs).map(share);
    (truth.map(|truth| truth.class), share.into())
}

/// The bound of a wheel's amplitudes.
fn amplitude_bound(wheel: &Wheel) -> Option<f64> {
    if wheel.is_multi_lugged() {
        Some(bounds::amplitude_bound(wheel.lug_count()))
    } else {
        bounds::amplitude_bound_off_a_bump(wheel)
    }
}

/// `κ_A` and `κ_ms`, where the window can have features.
fn acceleration(record: &Record, window: &Range<usize>, extractor: &mut Extractor) -> [Number; 2] {
    let features = extractor.features(record, window.clone(), &Reference::computed());
    let features = features.ok();
    Number::of_all(features.map(|features| [features.kappa_a, features.kappa_ms]))
}
