//! Which wheel-terrain interaction class (WTIC) a window of vibration belongs to (Section 4).
//!
//! Two methods, neither trained on labelled terrain:
//!
//! - [`Method::Paper`]: the paper's regions of the feature space (Eq. 59-61), verbatim.
//! - [`Method::Improved`]: lug by lug, from the synchrony of impacts with the lugs and their strength
//!   relative to the expected one. Zero of the wheel angle, lag, sign, scale and lug count are checked
//!   against the data; [`alignment`] estimates zero and lag.
//!
//! Both return UWTIC, with the reason, where the evidence is insufficient. [`baseline`] is a conventional
//! classifier trained on band powers; [`known`] is the reference class of a window, and [`confusion`] is the
//! confusion matrix.

pub mod alignment;
#[cfg(feature = "baseline")]
pub mod baseline;
pub mod confusion;
pub mod improved;
pub mod known;
pub mod paper;

use crate::features::record::{Record, RecordError, Unusable};
use crate::features::reference::Reference;
use crate::features::{Extractor, Settings};
use crate::quantity::RangeError;
use crate::terrain::class::Wtic;
use crate::trace::Trace;
use alignment::LugOffset;
use confusion::CLASSES;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Method of recognition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Method {
    /// By the paper's regions, see [`paper`].
    Paper,
    /// Lug by lug, see [`improved`].
    Improved,
}

impl Method {
    /// The method in files and on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Improved => "improved",
        }
    }
}

/// Result of a method for a window.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The class.
    pub class: Wtic,
    /// Confidence of the method [-], in [0, 1]; defined by each method.
    pub confidence: f64,
    /// Why it is this class.
    pub reason: String,
    /// Phase of the lug strikes, if they are synchronous and the wheel angle was measured.
    pub offset: Option<LugOffset>,
}

impl Answer {
    /// An unknown class with its reason.
    pub(crate) fn unknown(reason: impl ToString) -> Self {
        Self {
            class: Wtic::Uwtic,
            confidence: 0.0,
            reason: reason.to_string(),
            offset: None,
        }
    }
}

/// A window of a run and its class.
#[derive(Debug, Clone, PartialEq)]
pub struct Recognized {
    /// Begin \[s\].
    pub start: f64,
    /// End \[s\].
    pub end: f64,
    /// Lug passes in it [-].
    pub lug_passes: f64,
    /// Feature vector `P`, or why there is none.
    pub p: Result<[f64; 4], Unusable>,
    /// The results, in the order of the methods requested.
    pub answers: Vec<Answer>,
}

/// Why a run has no answers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecognitionError {
    /// The run lacks what every method needs.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A setting is out of its range.
    #[error(transparent)]
    Range(#[from] RangeError),
}

/// Recognises windows by one or several methods.
pub struct Recognizer {
    extractor: Extractor,
    reference: Reference,
    methods: Vec<Method>,
}

impl Recognizer {
    /// A recogniser that answers by each of `methods`, its features taken over `reference`.
    ///
    /// # Errors
    /// Those of [`Settings::check`].
    pub fn new(
        settings: Settings,
        reference: Reference,
        methods: &[Method],
    ) -> Result<Self, RangeError> {
        Ok(Self {
            extractor: Extractor::new(settings)?,
            reference,
            methods: methods.to_vec(),
        })
    }

    /// The class of every window of a run.
    ///
    /// # Errors
    /// `RecognitionError::Record` where acceleration, rotation or lugs are missing or in another
    /// unit. A window that cannot be used is no error: its class is UWTIC, with the reason.
    pub fn recognize(&mut self, trace: &Trace) -> Result<Vec<Recognized>, RecognitionError> {
        let record = Record::of(trace)?;
        let windows = record.windows(self.extractor.settings().window);
        Ok(windows
            .into_iter()
            .map(|window| self.window(&record, window))
            .collect())
    }

    fn window(&mut self, record: &Record, window: Range<usize>) -> Recognized {
        let features = self
            .extractor
            .features(record, window.clone(), &self.reference);
        let p = features.map(|features| features.p());
        let answers = self.methods.iter().map(|method| match method {
            Method::Paper => match &p {
                Ok(p) => paper::class(*p, record.wheel.lug_count()),
                Err(reason) => Answer::unknown(reason),
            },
            Method::Improved => improved::class(&mut self.extractor, record, window.clone()),
        });
        Recognized {
            start: record.time(window.start),
            end: record.time(window.end),
            lug_passes: record.lug_passes(&window),
            answers: answers.collect(),
            p,
        }
    }
}
/// The class of more than half of some windows, of which so many read [`CLASSES`] each; UWTIC where
/// there is none.
pub fn class_of_most(windows: [u64; 4]) -> Wtic {
    let all: u64 = windows.iter().sum();
    let most = CLASSES.into_iter().zip(windows).find(|(_, n)| 2 * n > all);
    most.map_or(Wtic::Uwtic, |(class, _)| class)
}
