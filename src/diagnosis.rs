//! What explains the difference between measured runs and a simulator.
//!
//! ```text
//!  measured runs ─▶ conditions ─────────────────────────────────────────┐
//!       scenario ─▶     │                                               ▼
//!     parameters ─▶     └─▶ random rigs ─▶ inference: trained model ─▶ judgement ─▶ verdict ─▶ validation
//!        effects ─▶ candidates ─▶              └─▶ self-test                 └─▶ next run
//! ```
//!
//! A [`Case`](condition::Case) is one measured condition as the simulator repeats it. Together they are a layout, of which
//! [random rigs](rigs) are simulated: parameters off their values, [effects](crate::effects) of the
//! [candidates](candidate) left out of the scenario. [`inference`] learns from them how statistics depend on parameters and
//! causes, and tests itself on rigs that it has not seen. The same model judges the measured statistics; a [`Verdict`] is
//! what its probabilities come to.
//!
//! What the verdict claims is then simulated: the scenario recalibrated, and with the effects found, each an
//! [`Arm`](arm::Arm) of the scenario, whose runs a [`Bank`](bank::Bank) keeps. That shows how far the [gap](Gaps) closes, and
//! which [further run](NextRun) would separate what is left open.

pub mod arm;
mod arm_traces;
pub mod bank;
pub mod candidate;
pub mod condition;
mod discrepancy;
mod end_results;
mod further;
pub mod inference;
mod investigation;
mod layout;
mod model_file;
mod next_run;
pub mod parameter;
pub mod rigs;
mod screen;
pub(crate) mod sealed;
mod simulated_runs;
mod validation;
mod verdict;

pub use arm_traces::ArmTraces;
pub use end_results::{EndResults, MeanError, Step};
pub use further::{Further, further_runs};
pub use investigation::{
    BUDGET, Compared, ComparedCondition, Diagnosis, Estimate, Investigation, InvestigationError,
    OnProgress, Progress, Settings, Stage,
};
pub use next_run::NextRun;
pub use screen::{ALIKE, Screened};
pub use simulated_runs::SimulatedRuns;
pub use validation::{Gaps, InUnits, Variants};
pub use verdict::{Answer, Located, Mechanism, Recalibrated, Suspect, Verdict, place_of};
