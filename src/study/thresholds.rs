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
//! `thresholds.txt` has a table for every [`Statement`]: how often windows on which every lug
//! touched exceed the limit, and how tight it is.

mod displacement;
mod statement;
pub mod tally;
mod text;

pub use statement::{Part, Point, Statement, ThresholdScore};

use super::table::{NoRows, Rows, Stop, Table, cell, condition_cells};
use super::{Run, Study};
use crate::document::{Document, Misfit};
use crate::features::record::Record;
use crate::features::reference::Reference;
use crate::features::{Extractor, Settings, Window};
use crate::quantity::RangeError;
use crate::terrain::Terrain;
use crate::trace::{LugTally, Trace};
use crate::vibration::bounds;
use crate::wheel::Wheel;
use displacement::{Displacement, Ground};
use serde::Deserialize;
use std::ops::Range;

/// Name of the table.
pub(super) const NAME: &str = "thresholds";

/// Columns of the displacement, in the order of [`displacement_cells`].
const DISPLACEMENT: [&str; 10] = [
    "rolled_touched_share",
    "steepest_rad",
    "bound_on_slope",
    "c_m_median",
    "c_m_largest",
    "c_f_largest",
    "displacement_kappa_a",
    "displacement_kappa_ms",
    "relative_kappa_a",
    "relative_kappa_ms",
];

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

impl ThresholdsTable {
    pub(super) fn read(self, document: &Document) -> Result<Thresholds, Misfit> {
        let at = |place: &str, message: String| Misfit {
            place: document.place(place),
            message,
        };
        let Self { bandwidths } = self;
        if bandwidths.is_empty() {
            let message = "name one or more bandwidths [Hz] of the acceleration".to_owned();
            return Err(at("thresholds.bandwidths", message));
        }
        for (number, bandwidth) in bandwidths.iter().enumerate() {
            let place = format!("thresholds.bandwidths.{number}");
            RangeError::positive("bandwidth", "Hz", *bandwidth)
                .map_err(|error| at(&place, error.to_string()))?;
            if bandwidths[..number].contains(bandwidth) {
                return Err(at(&place, format!("{bandwidth} Hz is named twice")));
            }
        }
        Ok(Thresholds { bandwidths })
    }
}

/// The columns of `κ_A` and `κ_ms` at a bandwidth [Hz].
pub(super) fn acceleration_columns(bandwidth: f64) -> [String; 2] {
    ["a", "ms"].map(|of| format!("kappa_{of}_{bandwidth}_hz"))
}

/// The table, if the study tests the limits.
pub(super) struct Windows<'s> {
    study: &'s Study,
    thresholds: &'s Thresholds,
}

impl<'s> Windows<'s> {
    pub(super) fn of(study: &'s Study) -> Option<Self> {
        let thresholds = study.thresholds.as_ref()?;
        Some(Self { study, thresholds })
    }

    fn extractors(&self) -> Result<Vec<Extractor>, RangeError> {
        let bandwidths = self.thresholds.bandwidths.iter();
        let settings = bandwidths.map(|&bandwidth| Settings {
            bandwidth,
            ..Settings::default()
        });
        settings.map(Extractor::new).collect()
    }

    /// Run, condition and window.
    fn first_cells(&self, run: &Run, record: &Record, window: &Range<usize>) -> Vec<String> {
        let numbers = [run.number, run.condition, u64::from(run.repeat)];
        let mut cells: Vec<String> = numbers.map(|number| number.to_string()).into();
        cells.extend(condition_cells(self.study, run));
        let times = [window.start, window.end].map(|sample| cell(Some(record.time(sample))));
        cells.extend(times);
        cells.push(cell(Some(record.lug_passes(window))));
        cells.push(record.wheel.lug_count().to_string());
        cells.push(record.wheel.is_multi_lugged().to_string());
        cells
    }
}

impl Table for Windows<'_> {
    fn name(&self) -> &'static str {
        NAME
    }

    fn header(&self) -> Vec<String> {
        let mut names: Vec<String> = ["run", "condition", "repeat", "scenario"]
            .map(str::to_owned)
            .into();
        names.extend(self.study.keys().map(str::to_owned));
        names.extend(["start_s", "end_s", "lug_passes", "lugs", "multi_lugged"].map(str::to_owned));
        names.extend(["truth", "touched_share", "bound_kappa_a"].map(str::to_owned));
        names.extend(
            self.thresholds
                .bandwidths
                .iter()
                .flat_map(|b| acceleration_columns(*b)),
        );
        names.extend(DISPLACEMENT.map(str::to_owned));
        names
    }

    /// A run whose channels cannot be used, on a smooth wheel for one, has no windows.
    fn rows(&self, run: &Run, trace: &Trace, _: &mut Stop) -> Result<Rows, NoRows> {
        let Ok(record) = Record::of(trace) else {
            return Ok(Rows::new());
        };
        let scenario = self.study.scenario(run);
        let terrain = Terrain::generate(&scenario.terrain, self.study.seed, run.stream);
        let mut ground = Ground::of(&scenario, &terrain);
        let extractors = self.extractors();
        let mut extractors = extractors.map_err(|error| NoRows::Failed(error.to_string()))?;
        let windows = record.windows(Window::Seconds(scenario.window()));
        let row = |window: Range<usize>| {
            let mut cells = self.first_cells(run, &record, &window);
            cells.extend(truth_cells(trace, &record, &window));
            cells.push(cell(amplitude_bound(&record.wheel)));
            for extractor in &mut extractors {
                cells.extend(acceleration_cells(&record, &window, extractor));
            }
            let displacement = ground
                .as_mut()
                .and_then(|ground| ground.displacement(&record, &window, &mut extractors[0]));
            cells.extend(displacement_cells(displacement, &record.wheel));
            cells
        };
        Ok(windows.into_iter().map(row).collect())
    }

    fn rows_of_failed(&self, _: &Run, _: &str) -> Rows {
        Rows::new()
    }
}

/// The true class of a window, and the share of its lugs that touched.
fn truth_cells(trace: &Trace, record: &Record, window: &Range<usize>) -> [String; 2] {
    let times = [window.start, window.end].map(|sample| record.time(sample));
    let known = trace.truth.as_ref();
    let truth = known.and_then(|truth| truth.window_of(times));
    let share = |lugs: LugTally| f64::from(lugs.touched) / f64::from(lugs.passed);
    [
        truth.map_or_else(String::new, |truth| truth.class.to_string()),
        cell(truth.and_then(|truth| truth.lugs).map(share)),
    ]
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
fn acceleration_cells(
    record: &Record,
    window: &Range<usize>,
    extractor: &mut Extractor,
) -> [String; 2] {
    let features = extractor.features(record, window.clone(), &Reference::computed());
    let features = features.ok();
    [
        cell(features.map(|features| features.kappa_a)),
        cell(features.map(|features| features.kappa_ms)),
    ]
}

fn displacement_cells(
    displacement: Option<Displacement>,
    wheel: &Wheel,
) -> [String; DISPLACEMENT.len()] {
    let values = displacement.map(|displacement| {
        let Displacement {
            touched_share,
            steepest,
            scaling: [median, largest],
            longest,
            ratios: [kappa_a, kappa_ms],
            relative: [relative_a, relative_ms],
        } = displacement;
        let on_slope = bounds::amplitude_bound_on_slope(wheel.lug_count(), steepest);
        [
            touched_share,
            steepest,
            if wheel.is_multi_lugged() {
                on_slope
            } else {
                f64::NAN
            },
            median,
            largest,
            longest,
            kappa_a,
            kappa_ms,
            relative_a,
            relative_ms,
        ]
    });
    std::array::from_fn(|column| cell(values.map(|values| values[column])))
}
