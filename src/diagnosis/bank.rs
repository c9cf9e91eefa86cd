//! Simulated statistics, each thing simulated once.
//!
//! A [`Request`] is one arm in one case with one stream of random numbers; the answer is a
//! [`Run`] read as the measured ones are, or why there is none. Answers are kept in a folder under
//! the hash of all that makes them: scenario, case, seed, stream, program. What is in the folder is
//! not simulated again, so work that was stopped goes on, and a second diagnosis is fast.
//!
//! A stream is the same ground and noise in every arm of a case, and another in every case:
//! differences between arms are not hidden by their scatter, and cases are independent. Arms that differ in their sensors only share one motion, which is recorded, measured
//! with each of them, and dropped.

mod store;

use super::arm::Arm;
use super::condition::{Case, statistician};
use crate::gap::{Run, Statistician};
use crate::quantity::{RangeError, Seed};
use crate::scenario::Scenario;
use crate::scenario::caught::caught;
use crate::scenario::experiment::{Experiment, ExperimentError};
use crate::scenario::recording::Recording;
use crate::trace::Trace;
use crate::whole_file;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use store::{Key, Store};

/// One run to be had.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// What is otherwise than in the scenario.
    pub arm: Arm,
    /// Place of the case in the bank.
    pub case: usize,
    /// Which ground and noise; another case has others under the same number.
    pub stream: u64,
}

/// Why an arm has no run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Failure(pub String);

/// What came of a request.
pub type Outcome = Result<Run, Failure>;

/// How far a bank is with its requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Requests answered.
    pub done: u64,
    /// Requests made.
    pub total: u64,
    /// Motions simulated for them: what takes the time.
    pub motions: u64,
    /// Motions that were to be simulated.
    pub motions_total: u64,
}

/// What to do about a file or folder of a bank that the system refuses.
fn way_out(refusal: &io::Error) -> String {
    let reason = whole_file::reason(refusal);
    whole_file::way_out(&reason, "name another folder (--bank)")
}

/// Why a bank gives no answers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BankError {
    /// The file system refused.
    #[error("cannot {action} {}: {}; {}", path.display(), whole_file::reason(source), way_out(source))]
    File {
        /// What was to be done.
        action: &'static str,
        /// With what.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The caller stopped it.
    #[error("stopped with {done} of {total} runs there; the same again goes on with the others")]
    Stopped {
        /// Requests answered.
        done: u64,
        /// Requests made.
        total: u64,
    },
    /// A request for a case that is not there.
    #[error("there is no case {case}: the bank has {cases}")]
    NoCase {
        /// The case asked for.
        case: usize,
        /// Number of cases.
        cases: usize,
    },
    /// Statistics cannot be taken so.
    #[error(transparent)]
    Range(#[from] RangeError),
}

/// Simulated runs of measured conditions, in a folder.
#[derive(Debug)]
pub struct Bank {
    store: Store,
    cases: Vec<Case>,
    seed: Seed,
    version: String,
}

impl Bank {
    /// A bank of these cases in `folder`, which is made where there is none. Streams belong to
    /// `seed`; `version` is that of the program, whose next one may simulate otherwise.
    ///
    /// # Errors
    /// `File` where the folder cannot be made.
    pub fn open(
        folder: &Path,
        cases: Vec<Case>,
        seed: Seed,
        version: &str,
    ) -> Result<Self, BankError> {
        Ok(Self {
            store: Store::open(folder)?,
            cases,
            seed,
            version: version.to_owned(),
        })
    }

    /// The cases.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// What came of each request, in their order: [`for_each`](Self::for_each), all kept.
    ///
    /// # Errors
    /// Those of [`for_each`](Self::for_each).
    pub fn readings(
        &self,
        requests: &[Request],
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Vec<Outcome>, BankError> {
        let answers = Mutex::new(vec![None; requests.len()]);
        let keep = |place: usize, outcome| {
            // A lock is poisoned by a panic only, and storing an answer has none.
            answers.lock().expect("no thread panicked")[place] = Some(outcome);
        };
        self.for_each(requests, progress, &keep)?;
        let answers = answers.into_inner().expect("no thread panicked");
        Ok(answers.into_iter().flatten().collect())
    }

    /// Calls `seen(place, outcome)` once per request, from several threads and in any order; what is
    /// not in the folder is simulated, on the threads of the pool that this is called in. Nothing is kept in memory.
    ///
    /// `progress` is called at every outcome and many times within a run, from several threads; a
    /// `Break` stops all at once, and what is done stays in the folder. A run that fails has its
    /// reason for an answer.
    ///
    /// # Errors
    /// `Stopped` when `progress` breaks; `NoCase`; `File` where an answer cannot be kept.
    pub fn for_each(
        &self,
        requests: &[Request],
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
        seen: &(dyn Fn(usize, Outcome) + Sync),
    ) -> Result<(), BankError> {
        let missing = self.missing(requests, seen)?;
        let known = (requests.len() - missing.len()) as u64;
        let groups = by_motion(missing);
        let work = Work {
            bank: self,
            requests,
            progress,
            seen,
            motions_total: groups.len() as u64,
            done: AtomicU64::new(known),
            motions: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
        };
        let each = groups.par_iter().with_max_len(1);
        let finished = each.try_for_each(|group| work.finish(group));
        finished.map_err(|halt| work.error(halt))
    }

    /// What is to be simulated; `seen` is called with the outcomes that are in the cache.
    fn missing(
        &self,
        requests: &[Request],
        seen: &(dyn Fn(usize, Outcome) + Sync),
    ) -> Result<Vec<Task>, BankError> {
        let places = requests.par_iter().enumerate();
        let found: Result<Vec<Option<Task>>, BankError> = places
            .map(|(place, request)| match self.find(place, request)? {
                Found::Missing(task) => Ok(Some(task)),
                Found::Answer(outcome) => {
                    seen(place, *outcome);
                    Ok(None)
                }
            })
            .collect();
        Ok(found?.into_iter().flatten().collect())
    }

    /// The answer to a request where it is known without simulating, else what is to be done.
    fn find(&self, place: usize, request: &Request) -> Result<Found, BankError> {
        let cases = self.cases.len();
        let case = request.case;
        let known = self.cases.get(case);
        let case = known.ok_or(BankError::NoCase { case, cases })?;
        let (scenario, experiment) = match built(&request.arm, case) {
            Ok(built) => built,
            Err(failure) => return Ok(Found::Answer(Box::new(Err(failure)))),
        };
        let key = self.key(&scenario, request);
        Ok(match self.store.read(&key, &case.attributes) {
            Some(outcome) => Found::Answer(Box::new(outcome)),
            None => Found::Missing(Task {
                place,
                key,
                motion: motion(&scenario, &experiment, self.run(request)),
            }),
        })
    }

    /// The run of the seed's series for a request of one of the cases. Cases do not share streams: what they have
    /// in common would be taken for the simulator's word.
    pub fn run(&self, request: &Request) -> u64 {
        let case = Key::of(&self.cases[request.case].reading()).number();
        (case << 32) | request.stream
    }

    /// The hash of all that makes an answer.
    fn key(&self, scenario: &Scenario, request: &Request) -> Key {
        let Self {
            cases,
            seed,
            version,
            ..
        } = self;
        Key::of(&format!(
            "{version}\nseed {}\nstream {}\n{}{}",
            seed.0,
            self.run(request),
            cases[request.case].reading(),
            scenario.to_toml(),
        ))
    }
}

/// A request on its way.
enum Found {
    Answer(Box<Outcome>),
    Missing(Task),
}

/// A request to be simulated.
struct Task {
    place: usize,
    key: Key,
    /// Hash of the motion that it measures.
    motion: Key,
}

/// The scenario of an arm, and what is built of it.
fn built(arm: &Arm, case: &Case) -> Result<(Scenario, Experiment), Failure> {
    let scenario = arm.scenario(case).map_err(|error| failed(&error))?;
    let experiment = scenario.experiment().map_err(|error| failed(&error))?;
    Ok((scenario, experiment))
}

/// Whether a case can have an arm.
pub(super) fn is_possible(arm: &Arm, case: &Case) -> bool {
    built(arm, case).is_ok()
}

fn failed(reason: &dyn std::fmt::Display) -> Failure {
    Failure(reason.to_string())
}

/// The hash of all that makes a motion: a scenario without its sensors.
fn motion(scenario: &Scenario, experiment: &Experiment, run: u64) -> Key {
    let Experiment {
        terrain,
        wheel,
        rig,
        ..
    } = experiment;
    let times = [
        scenario.duration,
        scenario.lead_in,
        scenario.physics_rate().hertz(),
    ];
    Key::of(&format!("{terrain:?} {wheel:?} {rig:?} {times:?} {run}"))
}

/// Tasks with one motion together, in the order of their first ones; among them equal ones.
fn by_motion(tasks: Vec<Task>) -> Vec<Vec<Task>> {
    let mut places = BTreeMap::new();
    let mut groups: Vec<Vec<Task>> = Vec::new();
    for task in tasks {
        let place = *places.entry(task.motion).or_insert(groups.len());
        match groups.get_mut(place) {
            Some(group) => group.push(task),
            None => groups.push(vec![task]),
        }
    }
    groups
}

/// Why a group was not finished.
enum Halt {
    Stopped,
    Failed(BankError),
}

/// What the threads share.
struct Work<'b> {
    bank: &'b Bank,
    requests: &'b [Request],
    progress: &'b (dyn Fn(Progress) -> ControlFlow<()> + Sync),
    seen: &'b (dyn Fn(usize, Outcome) + Sync),
    done: AtomicU64,
    motions: AtomicU64,
    motions_total: u64,
    stopped: AtomicBool,
}

impl Work<'_> {
    /// Answers and keeps the tasks of one motion.
    fn finish(&self, group: &[Task]) -> Result<(), Halt> {
        let mut statistician = statistician().map_err(|error| Halt::Failed(error.into()))?;
        let traces = Traces::of(group, self)?;
        let mut kept = BTreeSet::new();
        for task in group {
            if self.report().is_break() {
                return Err(Halt::Stopped);
            }
            let again = !kept.insert(task.key);
            let known = again.then(|| self.kept(task)).flatten();
            let outcome = match known {
                Some(outcome) => outcome,
                None => self.answer(task, &traces, &mut statistician)?,
            };
            (self.seen)(task.place, outcome);
            self.done.fetch_add(1, Ordering::Relaxed);
        }
        // These are kept: a wish to stop concerns the next.
        let _ = self.report();
        Ok(())
    }

    /// The answer to a request that was made twice, from the folder.
    fn kept(&self, task: &Task) -> Option<Outcome> {
        let case = &self.bank.cases[self.requests[task.place].case];
        self.bank.store.read(&task.key, &case.attributes)
    }

    fn answer(
        &self,
        task: &Task,
        traces: &Traces,
        statistician: &mut Statistician,
    ) -> Result<Outcome, Halt> {
        let request = &self.requests[task.place];
        let case = &self.bank.cases[request.case];
        let read = || {
            let trace = traces.trace(request, case, self)?;
            let mut rng = self.bank.seed.rng("reading", self.bank.run(request));
            Ok(case.read_simulated(statistician, &trace, &mut rng))
        };
        let outcome = match caught(read, panicked) {
            Ok(run) => Ok(run),
            Err(NoRun::Stopped) => return Err(Halt::Stopped),
            Err(NoRun::Failed(failure)) => Err(failure),
        };
        let kept = self.bank.store.write(&task.key, &title(request), &outcome);
        kept.map_err(Halt::Failed)?;
        Ok(outcome)
    }

    /// Reports the progress; `Break` to stop.
    fn report(&self) -> ControlFlow<()> {
        let progress = Progress {
            done: self.done.load(Ordering::Relaxed),
            total: self.requests.len() as u64,
            motions: self.motions.load(Ordering::Relaxed),
            motions_total: self.motions_total,
        };
        if self.stopped.load(Ordering::Relaxed) || (self.progress)(progress).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    fn error(&self, halt: Halt) -> BankError {
        match halt {
            Halt::Failed(error) => error,
            Halt::Stopped => BankError::Stopped {
                done: self.done.load(Ordering::Relaxed),
                total: self.requests.len() as u64,
            },
        }
    }
}

/// A request, in one line.
fn title(request: &Request) -> String {
    let Request { arm, case, stream } = request;
    format!("{arm}, case {case}, stream {stream}")
}

/// Why a request has no run.
enum NoRun {
    Stopped,
    Failed(Failure),
}

impl From<ExperimentError> for NoRun {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Stopped => Self::Stopped,
            error => Self::Failed(failed(&error)),
        }
    }
}

fn panicked(reason: String) -> NoRun {
    NoRun::Failed(Failure(reason))
}

/// Whence the traces of one motion come.
enum Traces {
    /// It is measured once: no need to keep it.
    Once,
    /// Recorded to be measured again and again; or why it could not.
    Recorded(Box<Result<Recording, Failure>>),
}

impl Traces {
    fn of(group: &[Task], work: &Work) -> Result<Self, Halt> {
        let first = &group[0];
        if group.iter().all(|task| task.key == first.key) {
            return Ok(Self::Once);
        }
        let request = &work.requests[first.place];
        let (bank, run) = (work.bank, work.bank.run(request));
        let record = || {
            let built = built(&request.arm, &bank.cases[request.case]);
            let (scenario, _) = built.map_err(NoRun::Failed)?;
            work.motions.fetch_add(1, Ordering::Relaxed);
            Ok(scenario.record(bank.seed, run, &mut |_| work.report())?)
        };
        match caught(record, panicked) {
            Ok(recording) => Ok(Self::Recorded(Box::new(Ok(recording)))),
            Err(NoRun::Failed(failure)) => Ok(Self::Recorded(Box::new(Err(failure)))),
            Err(NoRun::Stopped) => Err(Halt::Stopped),
        }
    }

    fn trace(&self, request: &Request, case: &Case, work: &Work) -> Result<Trace, NoRun> {
        let (scenario, experiment) = built(&request.arm, case).map_err(NoRun::Failed)?;
        match self {
            Self::Once => {
                work.motions.fetch_add(1, Ordering::Relaxed);
                let go_on = &mut |_| work.report();
                let run = scenario.run(work.bank.seed, work.bank.run(request), go_on)?;
                Ok(run.as_kept())
            }
            Self::Recorded(recording) => {
                let recording = recording.as_ref().as_ref();
                let recording = recording.map_err(|failure| NoRun::Failed(failure.clone()))?;
                let measured = recording.measure(&experiment.sensors);
                let measured = measured.map_err(|error| NoRun::Failed(failed(&error)))?;
                Ok(measured.as_kept())
            }
        }
    }
}
