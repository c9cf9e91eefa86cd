//! Differences between measured runs and simulated replicates of the same conditions.
//!
//! ```text
//! traces ──▶ statistics ──▶ comparison ──▶ map       which cells differ, by how much
//!                                │    └──▶ curves    how that depends on the condition
//!                                └───────▶ distance  one distance, share of it closed
//!            stages: which part of the input causes the difference in a result
//! ```
//!
//! A [`Statistician`] computes some hundred [`statistics`] of every run, each identified by its [`Cell`]:
//! channel, domain, statistic. A [`Comparison`] matches measured runs with replicates by condition and lists
//! those without a counterpart. Its [`map()`](Comparison::map) tests every cell against the spread of the
//! replicates; the result is gap, equivalent or undecided. Whitening and [`closed`] reduce it to one
//! number, [`stages`] attributes it to the stages of processing.
//!
//! The comparison does not depend on the simulator: replicates and measured runs are both traces.

mod cell;
mod comparison;
mod condition;
mod curves;
mod distance;
mod evidence;
mod global;
mod map;
mod moderation;
mod readings;
mod run;
pub mod stages;
pub mod statistics;
mod tail;
mod tree;
mod whitening;

pub use cell::{Cell, Covariate, Domain, Kappa, Measure, NoCell, Statistic};
pub use comparison::{Caveat, Comparison, FEWEST_REPLICATES, Table};
pub use condition::Condition;
pub(crate) use condition::conditions;
pub(crate) use curves::class_of;
pub use distance::{Closed, Scores, closed, energy_score, least_energy_score};
pub use global::{Global, PERMUTATIONS, Test};
pub use map::{Colour, Entry, GapMap, LEVEL, Margins, ParameterSpread};
pub use readings::{Reading, Readings};
pub use run::Run;
pub use statistics::Statistician;

use crate::identification::IdentifyError;
use crate::quantity::RangeError;
use crate::recognition::RecognitionError;

/// Why runs cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GapError {
    /// The sides share no condition with a cell in common.
    #[error(
        "no condition was both measured and simulated {FEWEST_REPLICATES} times or more with a \
         channel in common; measured: {measured}; simulated: {simulated}"
    )]
    NoOverlap {
        /// Conditions and channels measured.
        measured: String,
        /// Conditions and channels simulated.
        simulated: String,
    },
    /// A setting is out of its range.
    #[error(transparent)]
    Range(RangeError),
    /// Accelerations are sampled at different rates.
    #[error(
        "accelerations are sampled at {} and {} Hz: stages are swapped at one rate only, so \
         simulate at the measured one", .0[0], .0[1]
    )]
    Rates([f64; 2]),
    /// A run lacks what features need.
    #[error(transparent)]
    Recognition(RecognitionError),
    /// No window has features.
    #[error("no window has features")]
    NoFeatures,
    /// Rows cannot be paired.
    #[error("{} measured rows and {} simulated ones cannot be paired", .0[0], .0[1])]
    Rows([usize; 2]),
    /// Rows cannot be identified.
    #[error(transparent)]
    Identify(IdentifyError),
}
