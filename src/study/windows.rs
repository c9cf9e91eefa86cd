//! `windows.csv`: one row per window of every run that did not fail.
//!
//! | columns | content |
//! |---|---|
//! | `run`, `condition`, `repeat` | numbers from 0 |
//! | `scenario`, every swept key | the condition |
//! | `start_s`, `end_s` | the window |
//! | `lug_passes` | how far the wheel turned in it, in lug angles |
//! | `label`, `label_class` | the ground, and its class ([`TerrainLabel::class`]) |
//! | `truth` | the true class by the contacts in it |
//! | `touched_share`, `entered_share` | of the lugs that passed the bottom |
//! | `p1` ... `p4` | the feature vector |
//! | `paper_class`, `paper_confidence`, `paper_reason`, ... | the answer of each method |
//! | `power_1` ... | the vibration in bands, see [`band_powers`](crate::features::band_powers) |
//!
//! The truth of a window is that of the true class window that contains most of it. A run with channels that
//! no method can use has its true class windows as windows, with unknown class.
//!
//! [`TerrainLabel::class`]: crate::terrain::class::TerrainLabel::class

use super::Study;
use super::analysis::Observed;
use super::cells::{Number, list};
use super::recognition::Recognition;
use super::table::{Columns, NoRows, Place, Stop};
use crate::features::band_powers::{BANDS, BandPowers};
use crate::features::record::Record;
use crate::features::{Extractor, Settings};
use crate::quantity::RangeError;
use crate::recognition::{Answer, Recognized, Recognizer};
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::LugTally;
use serde::{Deserialize, Serialize};

/// A window.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct WindowRow {
    pub(super) place: Place,
    pub(super) times: [Number; 2],
    pub(super) lug_passes: Number,
    pub(super) label: Option<TerrainLabel>,
    pub(super) label_class: Option<Wtic>,
    pub(super) truth: Option<Wtic>,
    /// Shares of the lugs that passed the bottom: that touched, and that entered.
    pub(super) lug_shares: [Number; 2],
    /// Feature vector.
    pub(super) p: [Number; 4],
    /// One of every method.
    #[serde(deserialize_with = "list")]
    pub(super) answers: Vec<AnswerRow>,
    pub(super) powers: [Number; BANDS],
}

/// The answer of a method to a window.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct AnswerRow {
    pub(super) class: Wtic,
    confidence: Number,
    reason: String,
}

impl From<Answer> for AnswerRow {
    fn from(answer: Answer) -> Self {
        Self {
            class: answer.class,
            confidence: answer.confidence.into(),
            reason: answer.reason,
        }
    }
}

/// The columns of the windows of a study.
pub(super) fn columns(study: &Study, recognition: &Recognition) -> Columns {
    let methods = recognition.methods.iter().map(|method| {
        ["class", "confidence", "reason"].map(|what| format!("{}_{what}", method.as_str()))
    });
    Columns::of_place(study)
        .with(["start_s", "end_s", "lug_passes"])
        .with(["label", "label_class", "truth"])
        .with(["touched_share", "entered_share"])
        .with((1..=4).map(|number| format!("p{number}")))
        .list(methods)
        .with((1..=BANDS).map(|band| format!("power_{band}")))
}

/// The windows of a run.
///
/// # Errors
/// `Stopped` on request of `stop`, `Failed` where there is no reference or a setting is out of its range.
pub(super) fn rows(
    recognition: &Recognition,
    run: &Observed,
    stop: &mut Stop,
) -> Result<Vec<WindowRow>, NoRows> {
    let record = match Record::of(run.trace) {
        Ok(record) => record,
        Err(reason) => return Ok(unusable(recognition, run, &reason.to_string())),
    };
    let reference = run.reference(stop)?;
    let settings = recognition.settings(&run.study.scenario(run.run));
    let recognizer = Recognizer::new(settings, reference, &recognition.methods);
    let recognized = recognizer.map_err(NoRows::failed)?.recognize(run.trace);
    let recognized = recognized.map_err(NoRows::failed)?;
    let powers = powers(&record, settings).map_err(NoRows::failed)?;
    let windows = recognized.into_iter().zip(powers);
    Ok(windows
        .map(|(window, powers)| WindowRow::new(run, window, powers))
        .collect())
}

/// The true class windows of a record that no method can use.
fn unusable(recognition: &Recognition, run: &Observed, reason: &str) -> Vec<WindowRow> {
    let methods = recognition.methods.iter();
    let unknown: Vec<AnswerRow> = methods.map(|_| Answer::unknown(reason).into()).collect();
    let windows = run
        .trace
        .truth
        .iter()
        .flat_map(|truth| &truth.class_windows);
    windows
        .map(|window| WindowRow {
            answers: unknown.clone(),
            ..WindowRow::at(run, [window.start, window.end])
        })
        .collect()
}

/// The vibration of every window in bands, where it can be used.
fn powers(record: &Record, settings: Settings) -> Result<Vec<Option<BandPowers>>, RangeError> {
    let mut extractor = Extractor::new(settings)?;
    let windows = record.windows(settings.window).into_iter();
    let powers = windows.map(|window| extractor.band_powers(record, window).ok());
    Ok(powers.collect())
}

impl WindowRow {
    fn new(run: &Observed, recognized: Recognized, powers: Option<BandPowers>) -> Self {
        Self {
            lug_passes: recognized.lug_passes.into(),
            p: Number::of_all(recognized.p.ok()),
            answers: recognized.answers.into_iter().map(Into::into).collect(),
            powers: Number::of_all(powers),
            ..Self::at(run, [recognized.start, recognized.end])
        }
    }

    /// Label, its class, the truth of a window between two times [s], and the shares of the lugs behind it.
    fn at(run: &Observed, times: [f64; 2]) -> Self {
        let known = run.trace.truth.as_ref();
        let truth = known.and_then(|truth| truth.window_of(times));
        let label = truth.map(|truth| truth.terrain);
        let label = label.or(run.trace.attributes.terrain);
        // No lug passed: no share, which is an empty cell.
        let shares = truth.and_then(|truth| truth.lugs).map(LugTally::shares);
        Self {
            place: run.place(),
            times: times.map(Number::from),
            label,
            label_class: label.map(TerrainLabel::class),
            truth: truth.map(|truth| truth.class),
            lug_shares: Number::of_all(shares),
            ..Self::default()
        }
    }

    /// The scenario at 0, and from 1 on the values of the swept keys.
    pub(super) fn part(&self, place: usize) -> &str {
        match place {
            0 => &self.place.scenario,
            key => &self.place.values[key - 1],
        }
    }
}
