//! Where measured runs and simulated replicates of the same conditions differ.
//!
//! ```text
//! traces ──▶ statistics ──▶ comparison ──▶ map       which cells differ, and by how much
//!                                │    └──▶ curves    ... and how that depends on the condition
//!                                └───────▶ distance  how far apart in one number, how much is closed
//!            stages: which part of the input brings the difference into the answer
//! ```
//!
//! A [`Statistician`] reads some hundred [`statistics`] from every run, each under the name of its
//! [`Cell`]: channel, domain, statistic. A [`Comparison`] sets measured runs beside replicates,
//! condition by condition, and tells what has no counterpart. Its [`map()`](Comparison::map) tests
//! every cell against the spread of the replicates and answers gap, equivalent or undecided.
//! [`Whitening`] and [`closed`] make one number of it, [`stages`] follows it along the chain.
//!
//! Nothing here knows the simulator: replicates are traces like any others, measured ones too.

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
pub mod stages;
pub mod statistics;
mod tail;
mod tree;

pub use cell::{Cell, Covariate, Domain, Kappa, Measure, NoCell, Statistic};
pub use comparison::{Caveat, Comparison, FEWEST_REPLICATES, Table};
pub use condition::Condition;
pub(crate) use condition::conditions;
pub(crate) use curves::class_of;
pub use distance::{Closed, Scores, Whitening, closed, energy_score, least_energy_score};
pub use global::{Global, PERMUTATIONS, Test};
pub use map::{Colour, Entry, GapMap, LEVEL, Margins, ParameterSpread};
pub use readings::{Reading, Readings, Run};
pub use statistics::Statistician;

use crate::identification::IdentifyError;
use crate::quantity::RangeError;
use crate::recognition::RecognitionError;

/// Why runs cannot be compared.
#[derive(Debug, thiserror::Error)]
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
    /// So few replicates tell no spread.
    #[error("{0} replicates, fewer than {FEWEST_REPLICATES}: they tell no spread")]
    TooFewReplicates(usize),
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
