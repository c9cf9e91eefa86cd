//! Campaigns from cases.

use super::cases::draw;
use super::design::{Design, assignment};
use super::folder::{self, Manifest, PROGRAM, Posed, as_json};
use super::order::Order;
use super::truth::{Truth, sha256};
use super::{ChallengeError, GROUNDS};
use crate::dataset::Provenance;
use crate::dataset::hdf5::RunFileWriter;
use crate::quantity::{RangeError, Seed};
use crate::scenario::experiment::ExperimentError;
use crate::scenario::{Scenario, ScenarioError};
use crate::trace::Trace;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The file of the order, which is as secret as the truth.
const ORDER: &str = "order.json";

/// An order as stored in the folder.
#[derive(Serialize, Deserialize)]
struct Begun {
    program: String,
    order: Order,
}

impl Begun {
    fn new(order: &Order) -> Self {
        Self {
            program: PROGRAM.to_owned(),
            order: order.clone(),
        }
    }
}

/// The seed of the trial that was begun in `folder`; none where there is no trial.
///
/// # Errors
/// `File` and `Content` where its order cannot be read.
pub fn begun(folder: &Path) -> Result<Option<Seed>, ChallengeError> {
    let file = folder::truth(folder).join(ORDER);
    if !file.exists() {
        return Ok(None);
    }
    let begun: Begun = folder::parsed(&file, &folder::read(&file)?)?;
    Ok(Some(begun.order.seed))
}

/// What came of an order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Made {
    /// What is published.
    pub manifest: Manifest,
    /// Cases that could not be simulated, with the reason; they are not diagnosed.
    pub failed: Vec<(String, String)>,
}

/// Makes the campaigns of an order in `folder`, and seals their truth; existing ones of the same order are
/// reused. `size` is first called with the total to be simulated \[s\], `progress` for every step \[s\], from
/// several threads, and may stop. Cases are made on the current thread pool; the bytes do not depend on its
/// size.
///
/// # Errors
/// `NotEmpty` and `OtherOrder` for a folder with other content, `NoGround` and `Duration` for an invalid
/// order, `File` and `Campaign` where a file cannot be written, `Stopped`.
pub fn make(
    folder: &Path,
    order: &Order,
    size: &dyn Fn(f64),
    progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<Made, ChallengeError> {
    order.check()?;
    let designs = designs(order)?;
    let cases = draw(order, &designs)?;
    begin(folder, order, &designs)?;
    let seconds = |case: &Truth| {
        let design = design_of(case, &designs);
        design.runs() as f64 * design.scenario.driven()
    };
    size(cases.iter().map(seconds).sum());
    let work = Work {
        folder,
        designs: &designs,
        progress,
        stopped: AtomicBool::new(false),
        done: AtomicUsize::new(0),
    };
    let made = cases.par_iter().with_max_len(1).map(|case| work.case(case));
    let made: Result<Vec<Outcome>, Halt> = made.collect();
    let made = made.map_err(|halt| match halt {
        Halt::Failed(error) => error,
        Halt::Stopped => ChallengeError::Stopped {
            done: work.done.load(Ordering::Relaxed),
            total: cases.len(),
        },
    })?;
    finish(folder, made)
}

fn designs(order: &Order) -> Result<Vec<Design>, ChallengeError> {
    let named = GROUNDS
        .iter()
        .filter(|ground| order.grounds.iter().any(|it| it == *ground));
    let read = |ground: &&str| {
        let design = Design::of(ground, order.duration).expect("the order is checked");
        design.map_err(|error| too_long(order, &error))
    };
    named.map(read).collect()
}

/// Only the duration can make a committed scenario unsound.
fn too_long(order: &Order, error: &ScenarioError) -> ChallengeError {
    RangeError {
        quantity: "duration",
        unit: "s",
        range: format!("possible for every scenario ({error})"),
        value: order.duration.unwrap_or(f64::NAN),
    }
    .into()
}

fn design_of<'d>(case: &Truth, designs: &'d [Design]) -> &'d Design {
    let found = designs.iter().find(|design| design.ground == case.ground);
    found.expect("cases are drawn on the order's grounds")
}

/// Takes the folder for the order, and publishes the scenarios.
fn begin(folder: &Path, order: &Order, designs: &[Design]) -> Result<(), ChallengeError> {
    let (campaigns, truth) = (folder::campaigns(folder), folder::truth(folder));
    let (file, text) = (truth.join(ORDER), as_json(&Begun::new(order)));
    if file.exists() {
        if folder::read(&file)? != text {
            return Err(ChallengeError::OtherOrder(folder.to_owned()));
        }
    } else if !folder::is_empty(folder)? {
        return Err(ChallengeError::NotEmpty(folder.to_owned()));
    }
    folder::make_folder(&truth)?;
    folder::check_room(&truth)?;
    folder::write(&file, &text)?;
    folder::make_folder(&campaigns)?;
    for design in designs {
        let file = campaigns.join(format!("{}.toml", design.ground));
        folder::write(&file, design.scenario.text())?;
    }
    Ok(())
}

/// Publishes the cases.
fn finish(folder: &Path, made: Vec<Outcome>) -> Result<Made, ChallengeError> {
    let mut posed = Vec::new();
    let mut failed = Vec::new();
    for outcome in made {
        match outcome {
            Ok(case) => posed.push(case),
            Err(reason) => failed.push(reason),
        }
    }
    if !failed.is_empty() {
        let lines = failed
            .iter()
            .map(|(case, reason)| format!("{case}: {reason}\n"));
        let text: String = lines.collect();
        folder::write(&folder::truth(folder).join("failed.txt"), &text)?;
    }
    let manifest = Manifest::new(posed);
    let file = folder::campaigns(folder).join("manifest.json");
    folder::write(&file, &as_json(&manifest))?;
    Ok(Made { manifest, failed })
}

/// A case to publish, or one that cannot be simulated, and why.
type Outcome = Result<Posed, (String, String)>;

enum Halt {
    Failed(ChallengeError),
    Stopped,
}

impl<E: Into<ChallengeError>> From<E> for Halt {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// Why a campaign has no runs.
enum NoRuns {
    Failed(String),
    Stopped,
}

impl From<ScenarioError> for NoRuns {
    fn from(error: ScenarioError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<ExperimentError> for NoRuns {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Stopped => Self::Stopped,
            other => Self::Failed(other.to_string()),
        }
    }
}

/// What the threads share.
struct Work<'a> {
    folder: &'a Path,
    designs: &'a [Design],
    progress: &'a (dyn Fn(f64) -> ControlFlow<()> + Sync),
    stopped: AtomicBool,
    done: AtomicUsize,
}

impl Work<'_> {
    /// Makes a case, unless it is there.
    fn case(&self, truth: &Truth) -> Result<Outcome, Halt> {
        let design = design_of(truth, self.designs);
        let text = truth.text();
        let file = format!("{}.h5", truth.case);
        let path = folder::campaigns(self.folder).join(&file);
        let sealed = folder::truth(self.folder).join(format!("{}.json", truth.case));
        folder::write(&sealed, &text)?;
        if path.exists() {
            // A wish to stop concerns the next case.
            let _ = self.report(design.runs() as f64 * design.scenario.driven());
        } else {
            match self.traces(truth, design) {
                Ok(traces) => write_campaign(&path, &traces)?,
                Err(NoRuns::Failed(reason)) => return Ok(Err((truth.case.clone(), reason))),
                Err(NoRuns::Stopped) => return Err(Halt::Stopped),
            }
        }
        let bytes = std::fs::read(&path).map_err(|it| folder::unreadable(&path, it))?;
        self.done.fetch_add(1, Ordering::Relaxed);
        Ok(Ok(Posed {
            case: truth.case.clone(),
            file,
            sha256: sha256(&bytes),
            scenario: format!("{}.toml", design.ground),
            scenario_sha256: sha256(design.scenario.text().as_bytes()),
            without: truth.without(),
            seal: sha256(text.as_bytes()),
        }))
    }

    /// The runs of a case, as a rig would have measured them.
    fn traces(&self, truth: &Truth, design: &Design) -> Result<Vec<Trace>, NoRuns> {
        let scenario = altered(truth, design)?;
        let mut traces = Vec::new();
        for (repeat, condition) in design.order() {
            let number = traces.len() as u64;
            let scenario = scenario.with_all(&condition.set)?;
            let mut before = 0.0;
            let trace = scenario.run(truth.seed, number, &mut |time| {
                let step = time - before;
                before = time;
                self.report(step)
            })?;
            let _ = self.report(scenario.driven() - before);
            let mut trace = trace.as_measured();
            trace.attributes.repeat = repeat;
            traces.push(trace);
        }
        Ok(traces)
    }

    fn report(&self, simulated: f64) -> ControlFlow<()> {
        if self.stopped.load(Ordering::Relaxed) || (self.progress)(simulated).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// The scenario of a case: a rig that differs, at its own physics rate, with what is withheld.
fn altered(truth: &Truth, design: &Design) -> Result<Scenario, NoRuns> {
    let mut edits: Vec<String> = truth
        .edits
        .iter()
        .map(|edit| assignment(&edit.key, edit.value))
        .collect();
    edits.push(assignment("physics_rate", design.physics_rate.hertz()));
    let mut scenario = design.scenario.with_all(&edits)?;
    for hidden in &truth.effects {
        let effect = hidden.application();
        let effect = effect.map_err(|error| NoRuns::Failed(error.to_string()))?;
        scenario = scenario.with_effect(&effect)?;
    }
    Ok(scenario)
}

fn write_campaign(path: &Path, traces: &[Trace]) -> Result<(), ChallengeError> {
    let mut file = RunFileWriter::create(path, &Provenance::measured())?;
    for (number, trace) in (1..).zip(traces) {
        file.add(&format!("run_{number:02}"), trace)?;
    }
    file.finish()?;
    Ok(())
}
