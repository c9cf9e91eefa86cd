//! Campaigns from cases.

use super::cases::draw;
use super::design::Design;
use super::folder::{self, Manifest, PROGRAM, Posed, as_json};
use super::oracle::{self, Bench, Oracle};
use super::order::Order;
use super::runs::{NoRuns, Runner, affected};
use super::truth::{Hidden, Truth, sha256};
use super::{ChallengeError, GROUNDS};
use crate::dataset::Provenance;
use crate::dataset::hdf5::RunFileWriter;
use crate::diagnosis::sealed;
use crate::quantity::{RangeError, Seed};
use crate::scenario::ScenarioError;
use crate::trace::Trace;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

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
    let work = Work {
        folder,
        order,
        designs: &designs,
        runner: Runner::new(progress),
        done: AtomicUsize::new(0),
    };
    size(work.size(&cases));
    let made = work.oracles(&cases).and_then(|oracles| {
        let cases = cases.par_iter().with_max_len(1);
        let made = cases.map(|case| work.case(case, &oracles));
        made.collect::<Result<Vec<Outcome>, Halt>>()
    });
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

/// What the threads share.
struct Work<'a> {
    folder: &'a Path,
    order: &'a Order,
    designs: &'a [Design],
    runner: Runner<'a>,
    done: AtomicUsize,
}

/// Oracles by ground; none where one cannot be simulated or is not needed.
type Oracles = BTreeMap<&'static str, Oracle>;

impl Work<'_> {
    /// The simulated time \[s\] of all campaigns and of what their detectability takes.
    fn size(&self, cases: &[Truth]) -> f64 {
        let of_cases = cases.iter().map(|case| {
            let design = design_of(case, self.designs);
            let motions = case.effects.iter().map(|it| self.motions(it, design));
            let motions: usize = motions.sum();
            (design.runs() + motions) as f64 * design.scenario.driven()
        });
        let asked = self.asked(cases);
        let of_oracles = asked.iter();
        let of_oracles = of_oracles.map(|it| oracle::runs(it) as f64 * it.scenario.driven());
        of_cases.chain(of_oracles).sum()
    }

    /// How many motions the detectability of an effect takes.
    fn motions(&self, hidden: &Hidden, design: &Design) -> usize {
        if self.order.without_detectability {
            return 0;
        }
        oracle::motions(hidden, design)
    }

    /// The grounds of cases whose truth is not there yet, and is to contain a detectability.
    fn asked(&self, cases: &[Truth]) -> Vec<&Design> {
        if self.order.without_detectability {
            return Vec::new();
        }
        let is_asked = |design: &&Design| {
            let own = cases.iter().filter(|case| case.ground == design.ground);
            own.into_iter()
                .any(|case| !case.effects.is_empty() && self.known(case).is_none())
        };
        self.designs.iter().filter(is_asked).collect()
    }

    fn bench<'d>(&'d self, design: &'d Design) -> Bench<'d> {
        Bench {
            design,
            runner: &self.runner,
        }
    }

    fn oracles(&self, cases: &[Truth]) -> Result<Oracles, Halt> {
        let mut oracles = Oracles::new();
        for design in self.asked(cases) {
            if let Some(oracle) = self.oracle(design)? {
                oracles.insert(design.ground, oracle);
            }
        }
        Ok(oracles)
    }

    /// The oracle of a ground, which is simulated once a trial; none where it cannot be.
    fn oracle(&self, design: &Design) -> Result<Option<Oracle>, Halt> {
        let Order {
            selection, seed, ..
        } = self.order;
        let name = format!("oracle_{}.bin", design.ground);
        let path = folder::truth(self.folder).join(name);
        let title = oracle_title(design, self.order);
        if let Some(known) = sealed::read(&path, &title) {
            let simulated = oracle::runs(design) as f64 * design.scenario.driven();
            let _ = self.runner.report(simulated);
            return Ok(Some(known));
        }
        let oracle = match Oracle::of(self.bench(design), selection.family, *seed) {
            Ok(oracle) => oracle,
            Err(NoRuns::Failed(_)) => return Ok(None),
            Err(NoRuns::Stopped) => return Err(Halt::Stopped),
        };
        sealed::write(&path, &title, &oracle)
            .map_err(|error| folder::file_error("write", &path, error))?;
        Ok(Some(oracle))
    }

    fn truth_file(&self, case: &Truth) -> PathBuf {
        folder::truth(self.folder).join(format!("{}.json", case.case))
    }

    /// The truth of a case that is there; none where it is another's or not whole.
    fn known(&self, drawn: &Truth) -> Option<Truth> {
        let file = self.truth_file(drawn);
        let text = folder::read(&file).ok()?;
        let known: Truth = folder::parsed(&file, &text).ok()?;
        (known.as_drawn() == *drawn && known.text() == text).then_some(known)
    }

    /// The truth of a case as it is sealed.
    fn sealed(&self, drawn: &Truth, oracles: &Oracles) -> Result<Truth, Halt> {
        let design = design_of(drawn, self.designs);
        if let Some(known) = self.known(drawn) {
            for hidden in &known.effects {
                let motions = self.motions(hidden, design) as f64;
                let _ = self.runner.report(motions * design.scenario.driven());
            }
            return Ok(known);
        }
        let mut truth = drawn.clone();
        let oracle = oracles.get(design.ground);
        for hidden in &mut truth.effects {
            let found = oracle.map(|it| it.detectability(self.bench(design), drawn, hidden));
            match found {
                Some(Ok(found)) => {
                    hidden.detectability = Some(found.known);
                    hidden.detectability_beside_parameters = Some(found.beside_parameters);
                }
                Some(Err(NoRuns::Stopped)) => return Err(Halt::Stopped),
                Some(Err(NoRuns::Failed(_))) | None => {}
            }
        }
        folder::write(&self.truth_file(drawn), &truth.text())?;
        Ok(truth)
    }

    /// Makes a case, unless it is there.
    fn case(&self, drawn: &Truth, oracles: &Oracles) -> Result<Outcome, Halt> {
        let design = design_of(drawn, self.designs);
        let truth = self.sealed(drawn, oracles)?;
        let file = format!("{}.h5", truth.case);
        let path = folder::campaigns(self.folder).join(&file);
        if path.exists() {
            // A request to stop is honoured by the next case.
            let simulated = design.runs() as f64 * design.scenario.driven();
            let _ = self.runner.report(simulated);
        } else {
            match self.traces(&truth, design) {
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
            seal: sha256(truth.text().as_bytes()),
        }))
    }

    /// The runs of a case, as a rig would have measured them.
    fn traces(&self, truth: &Truth, design: &Design) -> Result<Vec<Trace>, NoRuns> {
        let scenario = affected(truth, design, &truth.effects)?;
        let mut traces = Vec::new();
        for (repeat, condition) in design.order() {
            let number = traces.len() as u64;
            let scenario = scenario.with_all(&condition.set)?;
            let mut trace = self.runner.run(&scenario, truth.seed, number)?;
            trace.attributes.repeat = repeat;
            traces.push(trace);
        }
        Ok(traces)
    }
}

/// An oracle of another version of the program, order or design is simulated again.
fn oracle_title(design: &Design, order: &Order) -> String {
    let key = format!("{}{design:?}", as_json(&Begun::new(order)));
    format!("lugwheel oracle 1 {}", sha256(key.as_bytes()))
}

fn write_campaign(path: &Path, traces: &[Trace]) -> Result<(), ChallengeError> {
    let mut file = RunFileWriter::create(path, &Provenance::measured())?;
    for (number, trace) in (1..).zip(traces) {
        file.add(&format!("run_{number:02}"), trace)?;
    }
    file.finish()?;
    Ok(())
}
