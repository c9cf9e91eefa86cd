//! Which class a run is fitted as, and who says so.

use crate::features::Settings;
use crate::features::reference::Reference;
use crate::quantity::RangeError;
use crate::recognition::confusion::CLASSES;
use crate::recognition::known::{Source, known_class};
use crate::recognition::{Method, Recognizer, class_of_most};
use crate::terrain::class::Wtic;
use crate::trace::Trace;
use serde::Serialize;

/// The class of a run, and who says so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Told {
    /// The class; never UWTIC.
    pub class: Wtic,
    /// Who says so.
    pub by: ToldBy,
}

/// Who says what class a run has.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(tag = "class_by", rename_all = "snake_case")]
pub enum ToldBy {
    /// The caller.
    Given,
    /// The vibration of most windows.
    Recognized {
        /// Windows of this class.
        windows: usize,
        /// All windows of the run.
        of_windows: usize,
    },
    /// The run's file.
    Known {
        /// What in it.
        source: Source,
        /// Why the class was not recognised.
        because: String,
    },
}

/// Tells the classes of runs.
pub struct Teller {
    given: Option<Wtic>,
    recognizer: Recognizer,
}

impl Teller {
    /// By the class `given`, else by recognition lug by lug, which takes nothing over a reference.
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
    /// Why none is told, with the way out.
    pub fn tell(&mut self, trace: &Trace) -> Result<Told, String> {
        if let Some(class) = self.given {
            let by = ToldBy::Given;
            return Ok(Told { class, by });
        }
        self.recognized(trace).or_else(|because| {
            let known = known_class(trace, [0.0, trace.duration()]);
            match known.filter(|known| known.class != Wtic::Uwtic) {
                Some(known) => Ok(Told {
                    class: known.class,
                    by: ToldBy::Known {
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
    fn recognized(&mut self, trace: &Trace) -> Result<Told, String> {
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
            let by = ToldBy::Recognized {
                windows,
                of_windows,
            };
            return Ok(Told { class, by });
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
