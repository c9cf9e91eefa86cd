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

use super::recognition::Recognition;
use super::references::References;
use super::table::{NoRows, Rows, Stop, Table, cell, condition_cells};
use super::{Run, Study};
use crate::features::band_powers::{BANDS, BandPowers};
use crate::features::record::Record;
use crate::features::{Extractor, Settings};
use crate::quantity::RangeError;
use crate::recognition::{Answer, Recognized, Recognizer};
use crate::trace::{LugTally, Trace};

/// Name of the table.
pub(super) const NAME: &str = "windows";

/// The table of the windows of a study.
pub(super) struct Windows<'s> {
    study: &'s Study,
    recognition: &'s Recognition,
    references: References<'s>,
}

/// A window as it is written.
struct Window {
    start: f64,
    end: f64,
    lug_passes: Option<f64>,
    p: Option<[f64; 4]>,
    answers: Vec<Answer>,
    powers: Option<BandPowers>,
}

impl<'s> Windows<'s> {
    /// The table, if the study recognises.
    pub(super) fn of(study: &'s Study) -> Option<Self> {
        let recognition = study.recognition.as_ref()?;
        Some(Self {
            study,
            recognition,
            references: References::new(study, recognition),
        })
    }

    fn windows(&self, run: &Run, trace: &Trace, stop: &mut Stop) -> Result<Vec<Window>, NoRows> {
        let record = match Record::of(trace) {
            Ok(record) => record,
            Err(reason) => return Ok(self.unusable(trace, &reason.to_string())),
        };
        let reference = self.references.of(run, stop)?;
        let settings = self.recognition.settings(&self.study.scenario(run));
        let failed = |error: &dyn std::error::Error| NoRows::Failed(error.to_string());
        let recognizer = Recognizer::new(settings, reference, &self.recognition.methods);
        let recognized = recognizer.map_err(|error| failed(&error))?.recognize(trace);
        let recognized = recognized.map_err(|error| failed(&error))?;
        let powers = powers(&record, settings).map_err(|error| failed(&error))?;
        let windows = recognized.into_iter().zip(powers);
        Ok(windows
            .map(|(window, powers)| Window::new(window, powers))
            .collect())
    }

    /// The true class windows of a record that no method can use.
    fn unusable(&self, trace: &Trace, reason: &str) -> Vec<Window> {
        let methods = self.recognition.methods.iter();
        let unknown = methods.map(|_| Answer::unknown(reason));
        let windows = trace.truth.iter().flat_map(|truth| &truth.class_windows);
        windows
            .map(|window| Window {
                start: window.start,
                end: window.end,
                lug_passes: None,
                p: None,
                answers: unknown.clone().collect(),
                powers: None,
            })
            .collect()
    }

    fn first_cells(&self, run: &Run) -> Vec<String> {
        let numbers = [run.number, run.condition, u64::from(run.repeat)];
        let mut cells: Vec<String> = numbers.map(|number| number.to_string()).into();
        cells.extend(condition_cells(self.study, run));
        cells
    }
}

impl Table for Windows<'_> {
    fn name(&self) -> &'static str {
        NAME
    }

    fn header(&self) -> Vec<String> {
        let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        let mut names: Vec<String> = owned(&["run", "condition", "repeat", "scenario"]);
        names.extend(self.study.keys().map(str::to_owned));
        names.extend::<Vec<String>>(owned(&["start_s", "end_s", "lug_passes"]));
        names.extend::<Vec<String>>(owned(&["label", "label_class", "truth"]));
        names.extend::<Vec<String>>(owned(&["touched_share", "entered_share"]));
        names.extend((1..=4).map(|number| format!("p{number}")));
        for method in &self.recognition.methods {
            names.push(class_column(method.as_str()));
            names.push(format!("{}_confidence", method.as_str()));
            names.push(format!("{}_reason", method.as_str()));
        }
        names.extend((1..=BANDS).map(power_column));
        names
    }

    fn rows(&self, run: &Run, trace: &Trace, stop: &mut Stop) -> Result<Rows, NoRows> {
        let windows = self.windows(run, trace, stop)?;
        let row = |window: &Window| {
            let mut cells = self.first_cells(run);
            cells.extend([window.start, window.end].map(|time| cell(Some(time))));
            cells.push(cell(window.lug_passes));
            cells.extend(truth_cells(trace, window));
            cells.extend(window.value_cells());
            cells
        };
        Ok(windows.iter().map(row).collect())
    }

    fn rows_of_failed(&self, _: &Run, _: &str) -> Rows {
        Vec::new()
    }
}

/// The column of a method's answers.
pub(super) fn class_column(method: &str) -> String {
    format!("{method}_class")
}

/// The column of a band's power, the lowest being band 1.
pub(super) fn power_column(band: usize) -> String {
    format!("power_{band}")
}

/// The vibration of every window in bands, where it can be used.
fn powers(record: &Record, settings: Settings) -> Result<Vec<Option<BandPowers>>, RangeError> {
    let mut extractor = Extractor::new(settings)?;
    let windows = record.windows(settings.window).into_iter();
    let powers = windows.map(|window| extractor.band_powers(record, window).ok());
    Ok(powers.collect())
}

impl Window {
    fn new(recognized: Recognized, powers: Option<BandPowers>) -> Self {
        let Recognized {
            start,
            end,
            lug_passes,
            p,
            answers,
        } = recognized;
        Self {
            start,
            end,
            lug_passes: Some(lug_passes),
            p: p.ok(),
            answers,
            powers,
        }
    }

    fn value_cells(&self) -> Vec<String> {
        let number = |number: usize| cell(self.p.map(|p| p[number]));
        let mut cells: Vec<String> = (0..4).map(number).collect();
        for answer in &self.answers {
            cells.push(answer.class.to_string());
            cells.push(cell(Some(answer.confidence)));
            cells.push(answer.reason.clone());
        }
        cells.extend((0..BANDS).map(|band| cell(self.powers.map(|powers| powers[band]))));
        cells
    }
}

/// Label, its class, the truth of a window, and the shares of the lugs behind it.
fn truth_cells(trace: &Trace, window: &Window) -> Vec<String> {
    let known = trace.truth.as_ref();
    let truth = known.and_then(|truth| truth.window_of([window.start, window.end]));
    let label = truth.map(|truth| truth.terrain);
    let label = label.or(trace.attributes.terrain);
    // No lug passed: no share, which is an empty cell.
    let shares = truth.and_then(|truth| truth.lugs).map(LugTally::shares);
    let text = |text: Option<&str>| text.unwrap_or_default().to_owned();
    vec![
        text(label.map(|label| label.as_str())),
        text(label.map(|label| label.class().as_str())),
        text(truth.map(|truth| truth.class.as_str())),
        cell(shares.map(|[touched, _]| touched)),
        cell(shares.map(|[_, entered]| entered)),
    ]
}
