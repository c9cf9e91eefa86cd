//! `study --slurm`: what the one who follows a study on a cluster sees, and how long it waits.

use super::documents::Source;
use super::interrupt::{self, Interrupted};
use super::program;
use super::progress::Progress;
use crate::study::slurm::{News, Programs, SlurmError, Standing, Submission, TRIES};
use crate::study::{Study, StudyError};
use anyhow::Context;
use clap::Args;
use std::num::NonZeroU32;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf, absolute};
use std::thread;
use std::time::{Duration, Instant};

/// How to use a cluster.
#[derive(Debug, Args)]
pub struct Cluster {
    /// Run it on this machine's Slurm cluster, as an array of jobs, and follow them
    #[arg(long, conflicts_with_all = ["shard", "collect"])]
    slurm: bool,
    /// Option of sbatch for every job, repeatable: --slurm-option=--partition=short
    #[arg(long, value_name = "OPTION", requires = "slurm")]
    slurm_option: Vec<String>,
    /// Maximum number of array tasks [default: 1000, or what the cluster allows]
    #[arg(long, value_name = "N", requires = "slurm")]
    slurm_tasks: Option<NonZeroU32>,
}

/// What of the command concerns the jobs.
pub struct Work<'w> {
    /// Where the study comes from.
    pub study: &'w Source,
    /// The folder of the results.
    pub out: &'w Path,
    /// Threads of a task.
    pub threads: Option<NonZeroU32>,
    /// Whether to keep what the folder holds.
    pub resume: bool,
}

/// Shortest and longest time between two looks at the queue. Schedulers serve many.
const PAUSE: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(15)];

impl Cluster {
    /// Whether the study goes to a cluster.
    pub fn is_wanted(&self) -> bool {
        self.slurm
    }

    /// Has the cluster run the study, and returns when all its shards are whole.
    ///
    /// # Errors
    /// `Interrupted` when a stop is requested, `StudyError` otherwise.
    pub fn run(&self, study: &Study, work: &Work, progress: &Progress) -> anyhow::Result<()> {
        let submission = Submission {
            out: on_every_node(work.out)?,
            resume: work.resume,
            program: program::file().context("cannot locate this program")?,
            study: match work.study {
                Source::File(path) => on_every_node(path)?,
                // The program is the same on every node.
                Source::Ready(document) => PathBuf::from(document.name),
            },
            threads: work.threads.unwrap_or(NonZeroU32::MIN),
            tasks: self.slurm_tasks,
            options: self.slurm_option.clone(),
        };
        let begun = Instant::now();
        let mut on_progress = |news: News| {
            let is_look = matches!(news, News::Standing(_) | News::Silence(_));
            report(news, study, progress);
            if is_look {
                wait((begun.elapsed() / 20).clamp(PAUSE[0], PAUSE[1]))
            } else {
                ControlFlow::Continue(())
            }
        };
        match study.execute_on(&Programs, &submission, &mut on_progress) {
            Err(StudyError::Slurm(left @ SlurmError::Left { .. })) => {
                Err(Interrupted(left.to_string()).into())
            }
            other => Ok(other?),
        }
    }
}

fn on_every_node(path: &Path) -> anyhow::Result<PathBuf> {
    absolute(path).with_context(|| format!("cannot locate {}", path.display()))
}

/// Shows the news.
fn report(news: News, study: &Study, progress: &Progress) {
    match news {
        News::Standing(Standing {
            done,
            running,
            waiting,
            reason,
        }) => {
            progress.set_share(done as f64 / study.run_count() as f64);
            let why = match (running, reason.as_str()) {
                (0, reason) if !reason.is_empty() => format!(" ({reason})"),
                _ => String::new(),
            };
            progress.add_to_name(&format!("{running} jobs run, {waiting} wait{why}"));
        }
        News::Submitted { array, tasks, name } => progress.print(&format!(
            "submitted: {tasks} tasks as job {array} and a collecting job, all named {name}"
        )),
        News::Silence(reason) => {
            progress.warn(&format!("Slurm does not answer, waiting: {reason}"))
        }
        News::Again { missing, ended } => {
            let ended = ended
                .iter()
                .map(|(state, count)| format!(", {count} tasks {state}"));
            let ended: String = ended.collect();
            progress.warn(&format!(
                "{missing} shards of runs are not whole{ended}; their tasks are tried again, {TRIES} times at most"
            ));
        }
    }
}

/// Waits unless a stop is requested.
fn wait(pause: Duration) -> ControlFlow<()> {
    const SLICE: Duration = Duration::from_millis(100);
    let begun = Instant::now();
    while begun.elapsed() < pause {
        if interrupt::is_requested() {
            return ControlFlow::Break(());
        }
        thread::sleep(SLICE);
    }
    ControlFlow::Continue(())
}
