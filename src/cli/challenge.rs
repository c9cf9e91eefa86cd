//! `challenge`: blind trials of the diagnosis.

mod asking;

use super::interrupt::{self, Interrupted};
use super::output::{self, Output};
use super::progress::Progress;
use super::series::Jobs;
use super::target::Claim;
use crate::challenge::score::Scores;
use crate::challenge::{self, ChallengeError, GROUNDS, Order, Selection};
use crate::quantity::Seed;
use crate::report::{Entries, detection_figure, matrix_figure, power_figure, reliability_figure};
use asking::Asking;
use clap::{Args, Subcommand};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use std::fmt;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Test the diagnosis in blind trials
///
/// `make` simulates campaigns with hidden causes, `run` diagnoses them, `score` reveals the true causes
/// and computes scores.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Challenge {
    #[command(subcommand)]
    action: Action,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel challenge make --out output/trial --cases 24
  lugwheel challenge run output/trial
  lugwheel challenge score output/trial

Written to the folder: campaigns/ (may be published: manifest.json with a SHA-256 of every truth, one scenario
per ground, one run file per case), truth/ (secret until all cases are answered: the truths and the seed),
bank/ and answers/ of the diagnoses, and score/ (scores.json, figures).
All three commands continue after an interruption. `sha256sum truth/case_0001.json` verifies a truth against
the manifest.

Sets: C0 no effect (parameters deviate), C1 one effect, C2 one effect in another form than the catalogue's,
C3 one effect that is excluded from the diagnosis, C4 two effects; all; and calibration, whose seeds
are never those of a case that is scored.";

#[derive(Debug, Subcommand)]
enum Action {
    Make(Make),
    Run(Run),
    Score(Score),
}

/// Simulate campaigns with hidden causes
#[derive(Debug, Args)]
struct Make {
    /// Folder of the trial
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// C0, C1, C2, C3, C4, some of them with commas between, all or calibration
    #[arg(long, value_name = "NAME", default_value = "all")]
    set: Selection,
    /// Maximum number of cases, balanced over sets, effects and magnitudes; all if not given
    #[arg(long, value_name = "N")]
    cases: Option<NonZeroUsize>,
    /// Ground of the campaigns: sand, hard, gravel (about fifteen times as long); may be given several times
    #[arg(long, value_name = "NAME", default_values_t = ["sand".to_owned(), "hard".to_owned()], value_parser = GROUNDS)]
    ground: Vec<String>,
    /// Duration of each of the twelve runs of a case, and their longest lead-in [s]; 8 and 2 if not given
    #[arg(long, value_name = "SECONDS")]
    duration: Option<f64>,
    /// Seal the effects without their detectability d', which takes one to five campaigns per effect and some thirty per ground
    #[arg(long)]
    without_detectability: bool,
    /// Seed of all cases and salts: it determines the truth. Drawn by the operating system
    /// if not given, and stored in truth/
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    #[command(flatten)]
    jobs: Jobs,
}

/// Diagnose every campaign that has no answer yet
#[derive(Debug, Args)]
struct Run {
    /// Folder of the trial
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Parallel campaigns, which share the cores; use 1 until the simulation cache is filled
    #[arg(long, value_name = "N", default_value = "1")]
    jobs: NonZeroUsize,
    /// Simulated duration of the random rigs [s], as for `diagnose`
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = super::positive)]
    budget: Option<f64>,
    /// Do not search for the run that separates the most probable effects, as for `diagnose`
    #[arg(long)]
    without_next_run: bool,
    /// Folder of the simulation cache [default: DIR/bank]
    #[arg(long, value_name = "DIR")]
    bank: Option<PathBuf>,
}

/// Reveal the true causes and score the answers
#[derive(Debug, Args)]
struct Score {
    /// Folder of the trial
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Some cases could not be made or diagnosed.
#[derive(Debug, thiserror::Error)]
#[error("challenge: {} cases failed ({}) - see {}", failed.len(), shortened(failed), place.display())]
pub struct FailedCases {
    failed: Vec<(String, String)>,
    place: PathBuf,
}

/// The first failed case and its reason.
fn shortened(failed: &[(String, String)]) -> String {
    let first = failed
        .first()
        .map(|(case, reason)| format!("{case}: {reason}"));
    let more = if failed.len() > 1 { "; …" } else { "" };
    first.unwrap_or_default() + more
}

impl Challenge {
    /// Makes, runs or scores a trial.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        match &self.action {
            Action::Make(command) => command.run(output),
            Action::Run(command) => command.run(output),
            Action::Score(command) => command.run(output),
        }
    }
}

impl Make {
    fn run(&self, output: &Output) -> anyhow::Result<()> {
        let order = Order {
            selection: self.set.clone(),
            cases: self.cases.map(NonZeroUsize::get),
            grounds: self.ground.clone(),
            duration: self.duration,
            without_detectability: self.without_detectability,
            seed: self.seed()?,
        };
        // A trial goes on in its own folder.
        if challenge::begun(&self.out)?.is_none() {
            output.claim(&[]).folder(&self.out)?;
        }
        let progress = OnceLock::new();
        let size = |simulated: f64| {
            progress.get_or_init(|| Progress::new(output, "campaigns", simulated));
        };
        let on_progress = |simulated: f64| {
            if let Some(progress) = progress.get() {
                progress.advance(simulated);
            }
            go_on()
        };
        let made = pool(self.jobs.count())?
            .install(|| challenge::make(&self.out, &order, &size, &on_progress))
            .map_err(interrupted)?;
        drop(progress);
        output.print(&MadeSummary {
            folder: self.out.display().to_string(),
            cases: made.manifest.cases.len(),
            failed: made.failed.len(),
        })?;
        failures(made.failed, &self.out.join("truth/failed.txt"))
    }

    /// The seed asked for, or that of the trial that goes on, or a random one.
    fn seed(&self) -> anyhow::Result<Seed> {
        if let Some(seed) = self.seed {
            return Ok(Seed(seed));
        }
        let begun = challenge::begun(&self.out)?;
        Ok(begun.unwrap_or_else(|| Seed(rand::random())))
    }
}

impl Run {
    fn run(&self, output: &Output) -> anyhow::Result<()> {
        let asking = Asking {
            folder: &self.folder,
            bank: self
                .bank
                .clone()
                .unwrap_or_else(|| self.folder.join("bank")),
            budget: self.budget,
            without_next_run: self.without_next_run,
            cores: (Jobs::ALL.count() / self.jobs).max(1),
        };
        let progress = OnceLock::new();
        let reported = AtomicUsize::new(0);
        let on_progress = |now: challenge::Progress| {
            // What was answered before takes no time and is excluded from the estimate of the time left.
            let bar = progress.get_or_init(|| {
                reported.store(now.done, Ordering::Relaxed);
                Progress::of_runs(output, "cases", now.total - now.done)
            });
            let before = reported.fetch_max(now.done, Ordering::Relaxed);
            bar.advance(now.done.saturating_sub(before) as f64);
            go_on()
        };
        let answered = pool(self.jobs.get())?
            .install(|| {
                challenge::answer(&self.folder, &|question| asking.ask(question), &on_progress)
            })
            .map_err(interrupted)?;
        drop(progress);
        output.print(&RunSummary {
            folder: self.folder.display().to_string(),
            answered: answered.answered,
            failed: answered.failed.len(),
        })?;
        failures(answered.failed, &self.folder.join("answers"))
    }
}

impl Score {
    fn run(&self, output: &Output) -> anyhow::Result<()> {
        let scores = challenge::score(&self.folder)?;
        let folder = self.folder.join("score");
        claim_scores(&folder)?;
        draw(&scores, &folder)?;
        let json = serde_json::to_string_pretty(&scores)?;
        output::write_file_or(&folder.join(SCORES[0]), &(json + "\n"), ELSEWHERE)?;
        output.print(&scores)
    }
}

/// What to do where a trial's folder refuses its scores.
const ELSEWHERE: &str = "put the trial in another folder";

/// What scoring writes: all numbers, and figures.
const SCORES: [&str; 7] = [
    "scores.json",
    "confusion.svg",
    "mean_probability.svg",
    "isolability.svg",
    "power.svg",
    "detections.svg",
    "reliability.svg",
];

/// Claims the folder of scores, in which those of before are replaced.
fn claim_scores(folder: &Path) -> anyhow::Result<()> {
    let claim = Claim {
        force: true,
        inputs: &[],
        elsewhere: ELSEWHERE,
    };
    claim.own_folder(folder)?;
    claim.files_in(folder, SCORES)
}

fn draw(scores: &Scores, folder: &Path) -> anyhow::Result<()> {
    let shares = |matrix, title| matrix_figure(matrix, Entries::Shares, title);
    let figures = [
        matrix_figure(&scores.confusion, Entries::Counts, "Truths and answers"),
        shares(&scores.posterior, "Probability of each answer by truth"),
        shares(
            &scores.isolability,
            "Isolability: cosine of projected signatures",
        ),
        power_figure(&scores.power, "Effects named, by magnitude"),
        detection_figure(&scores.detections),
        reliability_figure(&scores.probabilities.reliability),
    ];
    let [_, names @ ..] = SCORES;
    let mut named = names.iter().zip(&figures);
    named.try_for_each(|(name, svg)| output::write_file_or(&folder.join(name), svg, ELSEWHERE))
}

fn pool(threads: usize) -> anyhow::Result<ThreadPool> {
    Ok(ThreadPoolBuilder::new().num_threads(threads).build()?)
}

fn go_on() -> ControlFlow<()> {
    if interrupt::is_requested() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

fn interrupted(error: ChallengeError) -> anyhow::Error {
    match error {
        stopped @ ChallengeError::Stopped { .. } => Interrupted(stopped.to_string()).into(),
        other => other.into(),
    }
}

fn failures(failed: Vec<(String, String)>, place: &Path) -> anyhow::Result<()> {
    if failed.is_empty() {
        return Ok(());
    }
    let place = place.to_owned();
    Err(FailedCases { failed, place }.into())
}

#[derive(Debug, Serialize)]
struct MadeSummary {
    folder: String,
    cases: usize,
    failed: usize,
}

impl fmt::Display for MadeSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            folder,
            cases,
            failed,
        } = self;
        writeln!(f, "{cases} cases, {failed} more failed")?;
        writeln!(f, "to be published: {folder}/campaigns")?;
        write!(f, "to be kept until the answers are in: {folder}/truth")
    }
}

#[derive(Debug, Serialize)]
struct RunSummary {
    folder: String,
    answered: usize,
    failed: usize,
}

impl fmt::Display for RunSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            folder,
            answered,
            failed,
        } = self;
        write!(
            f,
            "{answered} cases answered, {failed} failed, in {folder}/answers"
        )
    }
}
