//! What explains the difference between measured runs and a simulator.
//!
//! ```text
//! library ──▶ emulator ──▶ screen ──▶ fits ──▶ ranking ──▶ verdict
//! measured ──▶ observation ──┘                    ▲
//!                     forest ─────────────────────┘
//! ```
//!
//! A [`Library`] holds what a simulator says: replicates, changes by parameters, changes by effects
//! of several magnitudes. An [`Emulator`] makes functions of them, an [`Observation`] sets measured
//! runs beside. [`screen()`] tells what could be seen at all, and a [`Verdict`] weighs nothing,
//! parameters, every effect, pairs of them and the unknown by what each says of conditions that it
//! has not seen; a [`Forest`] gives a second opinion. All of it works on numbers alone.

mod calibration;
mod check;
mod emulator;
mod fit;
mod forest;
mod grid;
mod hypothesis;
mod next_run;
mod observation;
mod product;
mod ranking;
mod responses;
mod screen;
mod shape;
mod shrinkage;
mod unknown;
mod verdict;
#[cfg(test)]
mod worlds;

pub use calibration::Calibration;
pub use emulator::Emulator;
pub use fit::Problem;
pub use forest::Forest;
pub use next_run::{FurtherRuns, NextRun};
pub use observation::Observation;
pub use responses::{Candidate, DiagnosisError, Level, Library, Measured, Responses};
pub use screen::{Alarm, Screened, Suspicion, screen};
pub use shrinkage::Shrinkage;
pub use verdict::{Answer, Located, Recalibrated, Suspect, Verdict};
