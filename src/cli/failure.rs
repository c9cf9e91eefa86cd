//! What went wrong, in words and as an exit code.

use super::challenge::FailedCases;
use super::documents::NoDocument;
use super::identify::{GivenTwice, NothingIdentified};
use super::inspect::Doubtful;
use super::interrupt::Interrupted;
use super::keys::NoKey;
use super::recognize::Unfit;
use super::study::{FailedRuns, UnansweredCampaigns};
use crate::challenge::ChallengeError;
use crate::dataset::csv::CampaignError;
use crate::dataset::hdf5::RunFileError;
use crate::diagnosis::InvestigationError;
use crate::document::Fault;
use crate::effects::EffectError;
use crate::scenario::ScenarioError;
use crate::study::StudyError;
use crate::study::results::ResultsError;
use crate::whole_file;
use clap::builder::styling::{AnsiColor, Style};
use serde::Serialize;
use std::error::Error;
use std::io::{self, Write};

/// How the word `error` looks, as in wrong usage; plain where stderr is no terminal or `NO_COLOR` is set.
const ERROR: Style = AnsiColor::Red.on_default().bold();

/// The command did not do what it should.
const FAILED: u8 = 1;
/// An input file is missing or not what it should be. (2 is wrong usage, reported by clap.)
const INVALID_INPUT: u8 = 3;
/// A study or a trial was finished with failed runs or campaigns without an answer.
const FAILED_RUNS: u8 = 4;
/// Ctrl-C, as shells number it.
const INTERRUPTED: u8 = 130;

/// Prints `error` with its causes to stderr, with `--json` as a document to stdout too, and returns
/// the exit code for it. What was finished, as an inspection that found errors, has printed its result,
/// which stays the only document.
pub(super) fn report(error: &anyhow::Error, json: bool) -> u8 {
    // There is no reader if this fails.
    let message = message(error).replacen("error:", &format!("{ERROR}error:{ERROR:#}"), 1);
    let _ = write!(anstream::stderr(), "{message}");
    let code = exit_code(error);
    if json && code != FAILED_RUNS && !error.is::<Doubtful>() {
        print(&Failure::of(error));
    }
    code
}

/// Prints wrong usage, or the help that was asked for; the exit code.
pub(super) fn report_usage(error: &clap::Error, json: bool) -> u8 {
    if json && error.use_stderr() {
        print(&Failure::of_usage(error));
    }
    let _ = error.print();
    u8::try_from(error.exit_code()).unwrap_or(FAILED)
}

fn print(error: &Failure) {
    let document = serde_json::json!({ "error": error });
    let _ = writeln!(std::io::stdout(), "{document:#}");
}

/// An error as machines read it.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Failure {
    /// `usage`, `invalid_input`, `interrupted`, `failed_runs` where the rest was done, or `failed`.
    pub kind: &'static str,
    /// The error and its causes, a line each.
    pub message: String,
    /// The input file at fault.
    pub file: Option<String>,
    /// The line in it, from 1.
    pub line: Option<usize>,
}

impl Failure {
    /// Wrong usage.
    pub(super) fn of_usage(error: &clap::Error) -> Self {
        let message = error.to_string();
        Self {
            kind: "usage",
            message: message.trim_start_matches("error: ").trim_end().to_owned(),
            file: None,
            line: None,
        }
    }

    /// What a command failed with.
    pub(super) fn of(error: &anyhow::Error) -> Self {
        let fault = error.chain().find_map(fault);
        let unreadable = || {
            let run_file = error.chain().find_map(|cause| cause.downcast_ref());
            run_file.map(|error: &RunFileError| error.path().display().to_string())
        };
        let message = message(error);
        Self {
            kind: match exit_code(error) {
                INTERRUPTED => "interrupted",
                INVALID_INPUT => "invalid_input",
                FAILED_RUNS => "failed_runs",
                _ => "failed",
            },
            message: message.trim_start_matches("error: ").trim_end().to_owned(),
            file: fault.map(|fault| fault.file.clone()).or_else(unreadable),
            line: fault.map(|fault| fault.line),
        }
    }
}

/// The fault in a text that an error reports.
fn fault<'e>(cause: &'e (dyn Error + 'static)) -> Option<&'e Fault> {
    if let Some(ScenarioError::Invalid(fault)) = cause.downcast_ref() {
        return Some(fault);
    }
    if let Some(CampaignError::Invalid(fault)) = cause.downcast_ref() {
        return Some(fault);
    }
    match cause.downcast_ref() {
        Some(StudyError::Invalid(fault)) => Some(fault),
        _ => None,
    }
}

/// The error on a line, and each cause with more information on another.
fn message(error: &anyhow::Error) -> String {
    let mut printed = String::new();
    let mut message = String::new();
    for cause in error.chain() {
        let text = text_of(cause);
        if printed.contains(&text) {
            continue;
        }
        let lead = if printed.is_empty() {
            "error"
        } else {
            "  because"
        };
        message.push_str(&format!("{lead}: {text}\n"));
        printed.push_str(&text);
    }
    message
}

/// A cause without the number that the system gives its reason.
fn text_of(cause: &(dyn Error + 'static)) -> String {
    let refusal = cause.downcast_ref::<io::Error>();
    refusal.map_or_else(|| cause.to_string(), whole_file::reason)
}

fn exit_code(error: &anyhow::Error) -> u8 {
    if error.chain().any(|cause| cause.is::<Interrupted>()) {
        INTERRUPTED
    } else if error.chain().any(is_finished) {
        FAILED_RUNS
    } else if error.chain().any(is_invalid_input) {
        INVALID_INPUT
    } else {
        FAILED
    }
}

/// Whether all was done, but some of it failed.
fn is_finished(cause: &(dyn Error + 'static)) -> bool {
    cause.is::<FailedRuns>() || cause.is::<UnansweredCampaigns>() || cause.is::<FailedCases>()
}

fn is_invalid_input(cause: &(dyn Error + 'static)) -> bool {
    cause.is::<ScenarioError>()
        || cause.is::<NoDocument>()
        || cause.is::<NoKey>()
        || cause.is::<EffectError>()
        || cause.is::<CampaignError>()
        || cause.is::<Unfit>()
        || cause.is::<ResultsError>()
        || cause.is::<NothingIdentified>()
        || cause.is::<GivenTwice>()
        || cause.is::<Doubtful>()
        || matches!(
            cause.downcast_ref::<InvestigationError>(),
            Some(
                InvestigationError::Case(_)
                    | InvestigationError::NoEffect(_)
                    | InvestigationError::Gap { .. }
            )
        )
        || matches!(
            cause.downcast_ref::<StudyError>(),
            Some(StudyError::Unreadable { .. } | StudyError::Invalid(_))
        )
        || matches!(
            cause.downcast_ref::<ChallengeError>(),
            Some(
                ChallengeError::Unreadable { .. }
                    | ChallengeError::Content { .. }
                    | ChallengeError::TruthAltered(_)
                    | ChallengeError::CampaignAltered(_)
                    | ChallengeError::QuestionAltered(_)
            )
        )
        || cause
            .downcast_ref::<RunFileError>()
            .is_some_and(is_unreadable)
}

fn is_unreadable(error: &RunFileError) -> bool {
    match error {
        RunFileError::Write { .. } | RunFileError::Unfit { .. } => false,
        RunFileError::Read { .. }
        | RunFileError::NotHdf5 { .. }
        | RunFileError::Table { .. }
        | RunFileError::StillOpen { .. }
        | RunFileError::Locked { .. }
        | RunFileError::Damaged { .. }
        | RunFileError::Encoding { .. }
        | RunFileError::Content { .. }
        | RunFileError::NoSuchRun { .. } => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    fn unreadable() -> anyhow::Error {
        let source = io::Error::from(io::ErrorKind::PermissionDenied);
        let path = "runs.h5".into();
        RunFileError::Read { path, source }.into()
    }

    #[test]
    fn a_cause_is_reported_once_though_its_effect_already_names_it() {
        let error = Err::<(), _>(unreadable()).context("no figure").unwrap_err();
        assert_eq!(
            message(&error),
            "error: no figure\n  because: cannot read runs.h5: permission denied\n"
        );
    }

    #[test]
    fn the_exit_code_distinguishes_a_bad_file_a_failure_and_ctrl_c() {
        let bad_file = Err::<(), _>(unreadable()).context("no figure").unwrap_err();
        let interrupted = anyhow::Error::from(Interrupted("nothing was written".to_owned()));
        let disk_full = anyhow::Error::from(RunFileError::Write {
            path: "runs.h5".into(),
            reason: "No space left on device".to_owned(),
            way_out: "free some space".to_owned(),
        });
        let codes = [bad_file, interrupted, disk_full].map(|error| exit_code(&error));
        assert_eq!(codes, [3, 130, 1]);
    }
}
