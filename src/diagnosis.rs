//! What explains the difference between measured runs and a simulator.
//!
//! ```text
//! measured runs ─▶ cases ─┐                        ┌─▶ observation ─┐
//!      scenario ─▶        ├─▶ plan ─▶ bank ─▶ library ─▶ emulator ──┴─▶ screen ─▶ fits ─▶ ranking ─▶ verdict
//!    parameters ─▶ arms ──┘            ▲ ▼                                               ▲
//!       effects ─▶                cache folder                             forest ───────┘
//! ```
//!
//! A [`Case`](condition::Case) is one measured condition as the simulator repeats it, an
//! [`Arm`](arm::Arm) a way in which the scenario may be wrong: [parameters](parameter) off their
//! values, [effects](crate::effects) left out. A [`Plan`](plan::Plan) lists what is to be simulated
//! within a budget, a [`Bank`](bank::Bank) does it, each thing once.
//!
//! A [`Library`] holds what came of it: replicates, changes by parameters, changes by effects of
//! several magnitudes. An [`Emulator`] makes functions of them, an [`Observation`] sets measured runs
//! beside; where fits end is simulated, which pins the emulator there. [`screen()`] tells what could
//! be seen at all, and a [`Verdict`] weighs nothing, parameters, every effect, pairs of them and the
//! unknown by what each says of conditions that it has not seen; a [`Forest`] gives a second opinion.
//! From the library on, all works on numbers alone. An [`Ablation`] leaves out a part of this, to tell
//! what it is worth.

mod ablation;
mod again;
pub mod arm;
mod arm_traces;
pub mod bank;
mod calibration;
mod check;
pub mod condition;
pub mod cost;
mod denoising;
mod emulator;
mod end_results;
mod fit;
mod forest;
mod form;
mod further;
mod grid;
mod hypothesis;
mod investigation;
mod kriging;
mod layout;
mod library;
mod next_run;
mod observation;
pub mod parameter;
mod pins;
pub mod plan;
mod product;
mod ranking;
mod responses;
mod scatter;
mod screen;
mod shape;
mod shrinkage;
mod tail;
mod unknown;
mod verdict;
#[cfg(test)]
mod worlds;

pub use ablation::{Ablation, NoSuchPart};
pub use again::{InUnits, SimulatedAgain};
pub use arm_traces::ArmTraces;
pub use calibration::Calibration;
pub use emulator::Emulator;
pub use end_results::{EndResults, MeanError, Step};
pub use fit::Problem;
pub use forest::Forest;
pub use further::{Further, further_runs};
pub use investigation::{
    Arms, BUDGET, Compared, ComparedCondition, Diagnosis, Gaps, Investigation, InvestigationError,
    Settings,
};
pub use next_run::{FurtherRuns, NextRun};
pub use observation::Observation;
pub use responses::{Candidate, DiagnosisError, Level, Library, Measured, Moved, Responses};
pub use screen::{Alarm, Screened, Suspicion, screen};
pub use shrinkage::Shrinkage;
pub use verdict::{Answer, Explanation, Located, Recalibrated, Suspect, Verdict};
