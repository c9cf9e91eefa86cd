//! A study on a cluster: its shares as an array of Slurm jobs, followed to the end.
//!
//! ```text
//! array            task I of N runs share I of N, and skips complete shards
//! collecting job   when the last task has ended, successfully or not: collects the shards
//! ```
//!
//! The results are in the shards, so no other state is needed: a failed task, a lost node or an unavailable
//! controller costs at most the shards being written. A task whose node is lost is requeued by Slurm. When
//! all jobs have left the queue and shards are incomplete, their tasks are submitted again, a bounded number
//! of times.
//!
//! Jobs are identified by their name, which encodes study and folder. A following process may stop and be
//! restarted: queued jobs of that name are followed, not submitted twice. Accounting is not used: completed
//! shards are read from the folder, running jobs from the queue.
//!
//! Program, study file, scenarios and folder must be at the same path on all nodes.

mod programs;
mod script;

pub use programs::Programs;

use super::folder::{Before, Folder};
use super::shard::{self, Shard};
use super::{Study, StudyError};
use crate::quantity::hexadecimal;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroU32;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// How often the tasks of shards that are not whole are submitted, the first time included.
pub const TRIES: u32 = 3;

/// Default maximum number of tasks, to limit the load of the scheduler.
const MANY_TASKS: u32 = 1000;

/// Folder of the jobs' logs, in the folder of the study.
const WORDS: &str = "slurm";

/// How a study is handed to a cluster; none of it changes the results.
#[derive(Debug, Clone)]
pub struct Submission {
    /// Folder of the results.
    pub out: PathBuf,
    /// Whether to continue in the folder and follow the jobs that work on it.
    pub resume: bool,
    /// This program, as the nodes find it.
    pub program: PathBuf,
    /// The file of the study, as the nodes find it, or its name where it is part of the program.
    pub study: PathBuf,
    /// Threads, and so cores, of a task.
    pub threads: NonZeroU32,
    /// Most tasks; 1000 if absent, and never more than shards or than the cluster's largest array.
    pub tasks: Option<NonZeroU32>,
    /// Further options of `sbatch`, for every job.
    pub options: Vec<String>,
}

/// Requests to Slurm.
pub trait Queue {
    /// Submits a job with these options of `sbatch` and this script; returns its number.
    ///
    /// # Errors
    /// If Slurm rejects it.
    fn submit(&self, options: &[String], script: &str) -> Result<u32, SlurmError>;

    /// The jobs of this name, every task of an array for itself; also those that ended lately, as
    /// far as Slurm remembers.
    ///
    /// # Errors
    /// Where Slurm does not answer.
    fn jobs(&self, name: &str) -> Result<Vec<Job>, SlurmError>;

    /// Largest number of a task of an array.
    ///
    /// # Errors
    /// Where Slurm does not answer.
    fn largest_task(&self) -> Result<u32, SlurmError>;
}

/// A job, or a task of an array of jobs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Job {
    /// Number of the job or of its array.
    pub number: u32,
    /// Whether it is a task of an array.
    pub is_task: bool,
    /// What it is at.
    pub state: JobState,
}

/// What a job is at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum JobState {
    /// In the queue, for this reason.
    Waiting(String),
    /// On a node.
    Running,
    /// Ended on request.
    Cancelled,
    /// Ended otherwise, as Slurm calls it.
    Ended(String),
}

/// Events reported while following the jobs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum News {
    /// Jobs were submitted.
    Submitted {
        /// Number of the array of jobs.
        array: u32,
        /// Tasks of the array.
        tasks: usize,
        /// Name of all jobs of this study and folder.
        name: String,
    },
    /// How far the study is. After each the caller decides how long to wait for the next.
    Standing(Standing),
    /// Slurm does not respond; the request is repeated. The caller decides when.
    Silence(String),
    /// All jobs have ended, shards are not whole, and their tasks are submitted again.
    Again {
        /// Shards that are not whole.
        missing: usize,
        /// How the tasks ended that did not complete, where Slurm remembers: state and number.
        ended: BTreeMap<String, usize>,
    },
}

/// How far a study on a cluster is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Standing {
    /// Runs in shards that are there.
    pub done: u64,
    /// Jobs on nodes.
    pub running: usize,
    /// Jobs in the queue.
    pub waiting: usize,
    /// Why one of them waits.
    pub reason: String,
}

/// Why a cluster did not finish a study.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SlurmError {
    /// A program of Slurm cannot be started.
    #[error(
        "cannot start {program}: {reason}; submit from a machine of the cluster, or omit --slurm"
    )]
    NoProgram {
        /// Its name.
        program: &'static str,
        /// The system's reason.
        reason: String,
    },
    /// A program of Slurm refused.
    #[error("{program}: {reason}")]
    Refused {
        /// Its name.
        program: &'static str,
        /// Its words.
        reason: String,
    },
    /// The caller follows no longer.
    #[error(
        "the jobs go on; the same command with --resume follows them again, scancel --name={name} ends them"
    )]
    Left {
        /// Name of the jobs.
        name: String,
    },
    /// Jobs were cancelled.
    #[error(
        "jobs were cancelled before {missing} shards of runs were whole; --resume submits the rest"
    )]
    Cancelled {
        /// Shards that are not whole.
        missing: usize,
    },
    /// Tasks fail again and again.
    #[error(
        "{missing} shards of runs are not whole after {TRIES} tries of their tasks; {last_words}"
    )]
    Unfinished {
        /// Shards that are not whole.
        missing: usize,
        /// Last line of the log of one of the tasks.
        last_words: String,
    },
}

impl Study {
    /// Runs the study on a cluster, and returns when all shards are complete and no job is left.
    ///
    /// The tables are written by the collecting job, or by [`Study::collect`].
    ///
    /// `on_news` is called for every event; a `Break` ends the following, while the jobs continue.
    ///
    /// # Errors
    /// `NotEmpty` where the folder is not empty and `resume` is not set; `OtherStudy` where it belongs to
    /// another study; `File` for errors of the file system; `Slurm` with its reasons.
    pub fn execute_on(
        &self,
        queue: &dyn Queue,
        submission: &Submission,
        on_news: &mut dyn FnMut(News) -> ControlFlow<()>,
    ) -> Result<(), StudyError> {
        let before = if submission.resume {
            Before::ThisStudy
        } else {
            Before::NoStudy
        };
        // First, so that no folder is created where there is no Slurm.
        let largest_task = queue.largest_task()?;
        let folder = Folder::open(self, &submission.out, before)?;
        let words = folder.make(WORDS)?;
        let mut following = Following {
            study: self,
            queue,
            submission,
            tasks: submission.tasks_of(self, largest_task),
            folder: &folder,
            name: job_name(&folder, &submission.out),
            words,
            seen: BTreeSet::new(),
            last: None,
            on_news,
        };
        following.run_to_the_end()
    }
}

impl Submission {
    /// Into how many tasks a study is divided where an array ends at `largest_task`.
    fn tasks_of(&self, study: &Study, largest_task: u32) -> u32 {
        let asked = self.tasks.map_or(MANY_TASKS, NonZeroU32::get);
        let shards = shard::all(study).len() as u32;
        asked.min(shards).min(largest_task).max(1)
    }
}

/// The name of all jobs of a study in a folder.
fn job_name(folder: &Folder, out: &Path) -> String {
    let place = out.canonicalize().unwrap_or_else(|_| out.to_owned());
    let mut hash = Sha256::new();
    hash.update(folder.fingerprint());
    hash.update(place.as_os_str().as_encoded_bytes());
    format!("lugwheel-{}", &hexadecimal(&hash.finalize())[..12])
}

/// One who follows the jobs of a study.
struct Following<'s> {
    study: &'s Study,
    queue: &'s dyn Queue,
    submission: &'s Submission,
    /// Into how many tasks the study is divided.
    tasks: u32,
    folder: &'s Folder,
    name: String,
    words: PathBuf,
    /// Numbers of the jobs found in the queue or submitted so far.
    seen: BTreeSet<u32>,
    /// The last array submitted, and one of its tasks.
    last: Option<(u32, u32)>,
    on_news: &'s mut dyn FnMut(News) -> ControlFlow<()>,
}

impl Following<'_> {
    fn run_to_the_end(&mut self) -> Result<(), StudyError> {
        for tried in 0..=TRIES {
            let ended = self.until_no_job_is_left()?;
            let shards = self.study.missing(self.folder);
            let missing = shards.len();
            if missing == 0 {
                return Ok(());
            }
            if ended.contains(&JobState::Cancelled) {
                return Err(SlurmError::Cancelled { missing }.into());
            }
            if tried == TRIES {
                break;
            }
            if tried > 0 {
                let ended = counted(&ended);
                self.report(News::Again { missing, ended })?;
            }
            self.submit(&shards)?;
        }
        Err(SlurmError::Unfinished {
            missing: self.study.missing(self.folder).len(),
            last_words: self.last_words(),
        }
        .into())
    }

    /// Follows the jobs in the queue; returns the final states of the tasks found there.
    fn until_no_job_is_left(&mut self) -> Result<Vec<JobState>, SlurmError> {
        loop {
            let jobs = match self.queue.jobs(&self.name) {
                Ok(jobs) => jobs,
                // A controller that answered before is down for a while.
                Err(SlurmError::Refused { reason, .. }) if !self.seen.is_empty() => {
                    self.report(News::Silence(reason))?;
                    continue;
                }
                Err(error) => return Err(error),
            };
            let live = jobs.iter().filter(|job| job.state.is_live());
            self.seen.extend(live.map(|job| job.number));
            let Some(standing) = self.standing(&jobs) else {
                let ours = jobs
                    .into_iter()
                    .filter(|job| job.is_task && self.seen.contains(&job.number));
                return Ok(ours.map(|job| job.state).collect());
            };
            self.report(News::Standing(standing))?;
        }
    }

    /// How far the study is, as long as it has jobs in the queue.
    fn standing(&self, jobs: &[Job]) -> Option<Standing> {
        let running = jobs.iter().filter(|job| job.state == JobState::Running);
        let reasons = jobs.iter().filter_map(|job| match &job.state {
            JobState::Waiting(reason) => Some(reason),
            _ => None,
        });
        let (running, waiting) = (running.count(), reasons.clone().count());
        (running + waiting > 0).then(|| Standing {
            done: self.study.runs_present(self.folder),
            running,
            waiting,
            reason: reasons.min().cloned().unwrap_or_default(),
        })
    }

    /// Submits the tasks of these shards, and the collecting job behind them.
    fn submit(&mut self, missing: &[Shard]) -> Result<(), StudyError> {
        let of = self.tasks;
        let task = |shard: &Shard| shard.number as u32 % of + 1;
        let tasks: BTreeSet<u32> = missing.iter().map(task).collect();
        let script = script::Script {
            submission: self.submission,
            name: &self.name,
            words: &self.words,
        };
        let array = self
            .queue
            .submit(&script.array_options(&tasks), &script.task(of))?;
        self.last = tasks.first().map(|task| (array, *task));
        self.seen.insert(array);
        let collecting = self
            .queue
            .submit(&script.collecting_options(array), &script.collecting())?;
        self.seen.insert(collecting);
        self.report(News::Submitted {
            array,
            tasks: tasks.len(),
            name: self.name.clone(),
        })?;
        Ok(())
    }

    fn report(&mut self, news: News) -> Result<(), SlurmError> {
        match (self.on_news)(news) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(SlurmError::Left {
                name: self.name.clone(),
            }),
        }
    }

    /// Last line of the log of the first task of the last array, or the likely cause if it is empty.
    fn last_words(&self) -> String {
        const LINES: usize = 3;
        let words = self.words.display();
        let Some((array, task)) = self.last else {
            return format!("see their logs in {words}");
        };
        let file = self.words.join(format!("{array}_{task}.log"));
        let Ok(text) = std::fs::read_to_string(&file) else {
            return format!(
                "no task wrote a log in {words}: program, study and folder must lie where all nodes see them under the same path"
            );
        };
        let lines: Vec<&str> = text.lines().filter(|line| !line.is_empty()).collect();
        let last = lines[lines.len().saturating_sub(LINES)..].join("\n  ");
        format!("{} reads:\n  {last}", file.display())
    }
}

/// How often each state occurs among those of tasks that did not complete.
fn counted(states: &[JobState]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for state in states {
        match state {
            JobState::Ended(name) if name != "COMPLETED" => {
                *counts.entry(name.clone()).or_default() += 1;
            }
            _ => (),
        }
    }
    counts
}

impl JobState {
    /// Whether the job is in the queue or on a node.
    fn is_live(&self) -> bool {
        matches!(self, Self::Waiting(_) | Self::Running)
    }
}
