//! Blind trials of the diagnosis: campaigns with sealed truth, and the score of the answers.
//!
//! ```text
//! order ──▶ cases ──▶ campaigns/  manifest.json, a scenario a ground, a run file a case
//!             └─────▶ truth/      the true effects, salted; hashed in the manifest
//!           campaigns/ ──▶ diagnosis ──▶ answers/
//!           campaigns/ + truth/ + answers/ ──▶ score
//! ```
//!
//! [`make()`] draws the cases of an [`Order`] and simulates them. A campaign looks like a measured one: it
//! contains no scenario, seed, ground truth or physics rate, commands are as commanded, and the file's
//! position in the list is random. The truth is in a [`Truth`], whose SHA-256 is published in the
//! [`Manifest`] (commitment scheme): it cannot be changed later, and cannot be guessed, since it contains 128
//! random bits of salt. [`answer()`] reads the campaigns only; [`score()`] opens the truth, rejects what does
//! not match its seal, and scores.
//!
//! All randomness comes from the order's seed. Without it no seal can be opened, and with it everything can
//! be reproduced, so a trial keeps its seed (in `truth/`) until its answers are complete. Seeds of cases for
//! scoring, of cases for calibrating a diagnosis and of all other uses are disjoint: see [`Family`].
//!
//! The truth of every effect has its detectability `d'`, for which `oracle` simulates the rig with the effect and without:
//! a trial is scored by it, since a miss of what cannot be seen is no fault.
//!
//! The sets are those of [`Set`]; runs, rig variations and the magnitudes of every effect are defined in
//! `scenarios/challenge/`, frozen before any score.

mod answer;
mod answering;
mod cases;
mod design;
mod folder;
mod frozen;
mod making;
mod oracle;
mod order;
mod runs;
pub mod score;
mod truth;

pub use answer::{Answer, Closed, Compared, Mechanism, Screened, Suspect, Verdict};
pub use answering::{Answered, Progress, Question, Unanswered, answer};
pub use folder::{Manifest, Posed};
pub use making::{Made, begun, make};
pub use order::{Family, Order, Selection, Set};
pub use score::score;
pub use truth::{Edit, Hidden, Level, Rig, Truth};

use crate::dataset::hdf5::RunFileError;
use crate::whole_file;
use std::io;
use std::path::PathBuf;

/// The grounds on which campaigns can be made.
pub const GROUNDS: [&str; 3] = ["sand", "hard", "gravel"];

/// What to do about a file or folder of a trial that the system refuses.
fn way_out(refusal: &io::Error) -> String {
    let reason = whole_file::reason(refusal);
    whole_file::way_out(&reason, "put the trial in another folder")
}

/// Why a trial cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChallengeError {
    /// A file of the trial cannot be read.
    #[error("cannot read {}: {}", path.display(), whole_file::reason(source))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The file system refused to write.
    #[error("cannot {action} {}: {}; {}", path.display(), whole_file::reason(source), way_out(source))]
    File {
        /// What was to be done.
        action: &'static str,
        /// With what.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A file is not what it should be.
    #[error("{} is not as expected: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A campaign cannot be written.
    #[error(transparent)]
    Campaign(#[from] RunFileError),
    /// There is no such set of cases.
    #[error("there is no set `{0}`; there are C0, C1, C2, C3, C4, all and calibration")]
    NoSet(String),
    /// There is no such ground.
    #[error("there is no ground `{0}`; there are sand, hard and gravel")]
    NoGround(String),
    /// The duration of runs cannot be.
    #[error(transparent)]
    Duration(#[from] crate::quantity::RangeError),
    /// The folder is not empty.
    #[error("{} is not empty; name another folder", .0.display())]
    NotEmpty(PathBuf),
    /// The folder contains another trial.
    #[error(
        "{} holds a trial of another order; name another folder, or leave set, cases, grounds and \
         seed as they were", .0.display()
    )]
    OtherOrder(PathBuf),
    /// The answers there belong to another trial or program.
    #[error("{} holds answers to other campaigns or of another program; remove it", .0.display())]
    OtherAnswers(PathBuf),
    /// A truth is not the one that was sealed.
    #[error("the truth of {0} is not the one that was sealed: its hash differs")]
    TruthAltered(String),
    /// A case is posed without other effects than those excluded by its truth.
    #[error("{0} excludes other effects than its truth: the manifest was altered")]
    QuestionAltered(String),
    /// Nothing to score yet.
    #[error("no campaign in {} is diagnosed yet; `lugwheel challenge run` does it", .0.display())]
    Unanswered(PathBuf),
    /// A run file or a scenario is not the one that was published.
    #[error("{} is not the file that was published: its hash differs", .0.display())]
    CampaignAltered(PathBuf),
    /// The caller stopped it.
    #[error("stopped with {done} of {total} cases done; the same again goes on with the others")]
    Stopped {
        /// Cases done.
        done: usize,
        /// Cases requested.
        total: usize,
    },
}
