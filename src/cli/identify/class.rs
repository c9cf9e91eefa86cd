//! Class of a run for the fit, and its source.

use crate::features::Settings;
use crate::features::reference::Reference;
use crate::quantity::RangeError;
use crate::recognition::confusion::CLASSES;
use crate::recognition::known::{Source, known_class};
use crate::recognition::{Method, Recognizer, class_of_most};
use crate::terrain::class::Wtic;
use crate::trace::Trace;
use serde::Serialize;

/// Class of a run, with its source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Classification {
    /// The class; never UWTIC.
    pub class: Wtic,
    /// Its source.
    pub by: ClassSource,
}

/// Source of the class of a run.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(tag = "class_by", rename_all = "snake_case")]
pub enum ClassSource {
    /// The command line.
    Given,
    /// Recognition from the vibration: the class of most windows.
    Recognized {
        /// Windows of this class.
        windows: usize,
        /// All windows of the run.
        of_windows: usize,
    },
    /// The run's file.
    Known {
        /// Which entry of it.
        source: Source,
        /// Why recognition failed.
        because: String,
    },
}

/// Determines the classes of runs.
pub struct Classifier {
    given: Option<Wtic>,
    recognizer: Recognizer,
}

impl Classifier {
    /// From the class `given`, otherwise by recognition lug by lug against the computed reference.
    ///
    /// # Errors
    /// Those of the recogniser's settings.
    pub fn new(given: Option<Wtic>) -> Result<Self, RangeError> {
        let settings = Settings::default();
        let recognizer = Recognizer::new(settings, Reference::computed(), &[Method::Improved])?;
        Ok(Self { given, recognizer })
    }

    /// The class of a run.
    ///
    /// # Errors
    /// The reason why it is unknown, with the remedy.
    pub fn classify(&mut self, trace: &Trace) -> Result<Classification, String> {
        if let Some(class) = self.given {
            let by = ClassSource::Given;
            return Ok(Classification { class, by });
        }
        self.recognized(trace).or_else(|because| {
            let known = known_class(trace, [0.0, trace.duration()]);
            match known.filter(|known| known.class != Wtic::Uwtic) {
                Some(known) => Ok(Classification {
                    class: known.class,
                    by: ClassSource::Known {
                        source: known.source,
                        because,
                    },
                }),
                None => Err(format!(
                    "the class is neither recognised nor in the file ({because}); give it with \
                     --class"
                )),
            }
        })
    }

    /// The class of more than half of the windows.
    fn recognized(&mut self, trace: &Trace) -> Result<Classification, String> {
        let windows = self.recognizer.recognize(trace);
        let windows = windows.map_err(|error| error.to_string())?;
        let answers: Vec<_> = windows.iter().flat_map(|window| &window.answers).collect();
        let counts = CLASSES.map(|class| {
            let of_class = answers.iter().filter(|answer| answer.class == class);
            (class, of_class.count())
        });
        let of_windows = answers.len();
        let class = class_of_most(counts.map(|(_, count)| count as u64));
        if class != Wtic::Uwtic {
            let windows = counts.iter().find(|(of, _)| *of == class);
            let windows = windows.map_or(0, |(_, count)| *count);
            let by = ClassSource::Recognized {
                windows,
                of_windows,
            };
            return Ok(Classification { class, by });
        }
        let unknown = answers.iter().find(|answer| answer.class == Wtic::Uwtic);
        let why = unknown.map_or(String::new(), |answer| format!(": {}", answer.reason));
        let found = counts.iter().filter(|(_, count)| *count > 0);
        let found: Vec<String> = found
            .map(|(class, count)| format!("{class} in {count}"))
            .collect();
        let found = found.join(", ");
        Err(format!("read as {found} of {of_windows} windows{why}"))
    }
}
