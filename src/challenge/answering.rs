//! Diagnosis of the campaigns, one by one, without access to their truth.

use super::ChallengeError;
use super::answer::Answer;
use super::folder::{self, Campaigns, PROGRAM, Posed};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Input of a diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Question<'a> {
    /// The case.
    pub case: &'a str,
    /// Run file of the campaign.
    pub measured: PathBuf,
    /// The scenario that it is to be compared with.
    pub scenario: PathBuf,
    /// Effects to do without.
    pub without: &'a [String],
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Unanswered {
    /// The diagnosis failed, and why.
    Failed(String),
    /// It was stopped.
    Stopped,
}

/// How many cases were answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answered {
    /// Cases with an answer, from this time or before.
    pub answered: usize,
    /// Cases without one, and why.
    pub failed: Vec<(String, String)>,
}

/// Calls `diagnose` for every case in `folder` without an answer, on the current thread pool; it returns the
/// JSON text of an [`Answer`]. `progress` is called for every case, first for those answered before, and may
/// stop.
///
/// # Errors
/// `File` and `Content` where there are no campaigns, `CampaignAltered` for one that was changed,
/// `OtherAnswers` where the answers there are to other campaigns, `Stopped`.
pub fn answer(
    folder: &Path,
    diagnose: &(dyn Fn(&Question) -> Result<String, Unanswered> + Sync),
    progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
) -> Result<Answered, ChallengeError> {
    let campaigns = Campaigns::open(folder)?;
    let answers = folder::answers(folder);
    begin(&answers, &campaigns)?;
    let total = campaigns.manifest.cases.len();
    let cases = campaigns.manifest.cases.iter();
    let open: Vec<&Posed> = cases.filter(|it| known(&answers, it).is_none()).collect();
    // All of them first: a changed file is to be reported before hours of work.
    for posed in &open {
        campaigns.check(posed)?;
    }
    let done = AtomicUsize::new(total - open.len());
    let stopped = || ChallengeError::Stopped {
        done: done.load(Ordering::Relaxed),
        total,
    };
    let report = || {
        let done = done.load(Ordering::Relaxed);
        progress(Progress { done, total })
    };
    if report().is_break() {
        return Err(stopped());
    }
    let asked = open.par_iter().with_max_len(1).map(|posed| {
        let failed = ask(&campaigns, posed, &answers, diagnose).map_err(|halt| match halt {
            Halt::Failed(error) => error,
            Halt::Stopped => stopped(),
        })?;
        done.fetch_add(1, Ordering::Relaxed);
        match report() {
            ControlFlow::Continue(()) => Ok(failed),
            ControlFlow::Break(()) => Err(stopped()),
        }
    });
    let failed: Result<Vec<Option<(String, String)>>, ChallengeError> = asked.collect();
    let failed: Vec<(String, String)> = failed?.into_iter().flatten().collect();
    Ok(Answered {
        answered: total - failed.len(),
        failed,
    })
}

/// How far the questions are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Cases diagnosed.
    pub done: usize,
    /// All cases.
    pub total: usize,
}

/// Takes the folder for answers of this program to these campaigns.
fn begin(answers: &Path, campaigns: &Campaigns) -> Result<(), ChallengeError> {
    let (file, text) = (
        answers.join("origin.txt"),
        format!("{PROGRAM}\nmanifest {}\n", campaigns.sha256),
    );
    let is_known = file.exists() && folder::read(&file)? == text;
    if !is_known && !folder::is_empty(answers)? {
        return Err(ChallengeError::OtherAnswers(answers.to_owned()));
    }
    folder::make_folder(answers)?;
    folder::check_room(answers)?;
    if is_known {
        Ok(())
    } else {
        folder::write(&file, &text)
    }
}

enum Halt {
    Failed(ChallengeError),
    Stopped,
}

impl From<ChallengeError> for Halt {
    fn from(error: ChallengeError) -> Self {
        Self::Failed(error)
    }
}

/// Diagnoses one case; its failure, if any.
fn ask(
    campaigns: &Campaigns,
    posed: &Posed,
    answers: &Path,
    diagnose: &(dyn Fn(&Question) -> Result<String, Unanswered> + Sync),
) -> Result<Option<(String, String)>, Halt> {
    let question = Question {
        case: &posed.case,
        measured: campaigns.path_of(&posed.file),
        scenario: campaigns.path_of(&posed.scenario),
        without: &posed.without,
    };
    let path = |ending: &str| answers.join(format!("{}.{ending}", posed.case));
    let begun = Instant::now();
    let answered =
        diagnose(&question).and_then(|text| match serde_json::from_str::<Answer>(&text) {
            Ok(_) => Ok(text),
            Err(error) => Err(Unanswered::Failed(format!("its answer is none: {error}"))),
        });
    match answered {
        Ok(text) => {
            let seconds = begun.elapsed().as_secs_f64();
            folder::write(&path("seconds"), &format!("{seconds:.3}\n"))?;
            folder::write(&path("json"), &text)?;
            Ok(None)
        }
        Err(Unanswered::Failed(reason)) => {
            folder::write(&path("failed.txt"), &format!("{reason}\n"))?;
            Ok(Some((posed.case.clone(), reason)))
        }
        Err(Unanswered::Stopped) => Err(Halt::Stopped),
    }
}

/// The answer to a case, where there is one.
pub(super) fn known(answers: &Path, posed: &Posed) -> Option<Answer> {
    let file = answers.join(format!("{}.json", posed.case));
    let text = std::fs::read_to_string(file).ok()?;
    serde_json::from_str(&text).ok()
}

/// Time [s] that an answer took, where it is known.
pub(super) fn seconds(answers: &Path, posed: &Posed) -> Option<f64> {
    let file = answers.join(format!("{}.seconds", posed.case));
    std::fs::read_to_string(file).ok()?.trim().parse().ok()
}

/// Whether the diagnosis failed on a case.
pub(super) fn has_failed(answers: &Path, posed: &Posed) -> bool {
    answers.join(format!("{}.failed.txt", posed.case)).exists()
}
