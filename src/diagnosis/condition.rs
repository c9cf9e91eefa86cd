//! Measured runs -> the scenario of each condition, and how to read both sides alike.
//!
//! Load, speed and slip of a [`Case`] are those stated of the measured runs, its duration the measured one;
//! wheel, ground, rig and sensors are the scenario's. Under a load of 0 N the wheel was held off the ground: what
//! shows there is the drive's or a sensor's. What was not stated is taken from the channels. So is the slip
//! of a run whose channel contradicts it: a label is easily wrong. But where at least half of the runs contradict theirs,
//! the rig drives otherwise than it was stated (a wrong encoder, a wrong radius): then the slips stated
//! are kept, and the contradiction is a gap to be explained. Rates and channels are those that were
//! measured: what a run has as a mean only, the simulated one has as a mean only.

mod caveat;
mod group;
mod limitations;
mod record;

pub use caveat::Caveat;

use super::layout::Layout;
use crate::features::Settings;
use crate::features::reference::Reference;
use crate::gap::{self, Condition, Run, Statistician};
use crate::quantity::RangeError;
use crate::scenario::Scenario;
use crate::trace::{RunAttributes, Trace};
use group::{Group, grouped, without_broken};
use limitations::{differences, not_simulated, not_steady, unlike_a_rig};
use rand::Rng;
use record::{Record, Repetition, Slips};

/// Longest part \[s\] of a measured run that is compared, by default.
pub const LONGEST: f64 = 20.0;

/// One measured condition as the simulator repeats it.
#[derive(Debug, Clone)]
pub struct Case {
    /// Which condition.
    pub condition: Condition,
    /// The scenario at its load, speed and slip, as long as was measured, at the measured rates.
    pub scenario: Scenario,
    /// Wheel and condition as measured; both sides are read with them.
    pub attributes: RunAttributes,
    /// Places of its runs in the campaign: repeats of each other.
    pub runs: Vec<usize>,
    layout: Layout,
}

/// The conditions of a campaign.
#[derive(Debug, Clone)]
pub struct Cases {
    /// One a condition and kind of record, in the order in which they were measured.
    pub cases: Vec<Case>,
    /// What to keep in mind.
    pub caveats: Vec<Caveat>,
}

/// Why a campaign cannot be compared with a scenario.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// There are no runs.
    #[error("there are no measured runs")]
    NoRuns,
    /// All runs were made with another wheel.
    #[error(
        "the measured wheel has a {quantity} of {measured} m, the scenario's {scenario} m: more \
         than 2 % apart; set wheel.{quantity} to the measured one"
    )]
    OtherWheel {
        /// `radius` or `width`.
        quantity: &'static str,
        /// As measured \[m\].
        measured: f64,
        /// As in the scenario \[m\].
        scenario: f64,
    },
    /// No run and no condition is left.
    #[error("none of the measured runs can be repeated: {}", .0.join("; "))]
    NoneLeft(Vec<String>),
}

/// The reader of runs of both sides: features over the computed reference.
///
/// # Errors
/// None with the default settings.
pub fn statistician() -> Result<Statistician, RangeError> {
    Statistician::new(Settings::default(), Reference::computed())
}

impl Cases {
    /// The conditions of measured runs, each as `scenario` repeats it; of a run its first `longest`
    /// \[s\] at most.
    ///
    /// Radius and width have to be the scenario's within 2 %; other lugs are a caveat. Runs and
    /// conditions that cannot be repeated are left out with a caveat.
    ///
    /// # Errors
    /// `NoRuns`; `OtherWheel` where all runs have one; `NoneLeft` with the reasons where nothing
    /// is left.
    pub fn of(scenario: &Scenario, measured: &[Trace], longest: f64) -> Result<Self, CaseError> {
        if measured.is_empty() {
            return Err(CaseError::NoRuns);
        }
        let slips = Slips::of(measured);
        let mut caveats = Vec::new();
        caveats.extend(slips.caveat());
        let repetition = Repetition {
            scenario,
            longest,
            slips,
        };
        let mut records = Vec::new();
        let mut other_wheel = None;
        for (run, trace) in measured.iter().enumerate() {
            match Record::of(run, trace, &repetition) {
                Ok((record, taken)) => {
                    caveats.extend(taken);
                    records.push(record);
                }
                Err(refusal) => {
                    let reason = refusal.to_string();
                    caveats.push(Caveat::LeftOut { run, reason });
                    other_wheel = other_wheel.or(refusal.other_wheel());
                }
            }
        }
        if let (true, Some(error)) = (records.is_empty(), other_wheel) {
            return Err(error);
        }
        caveats.extend(differences(scenario, &records));
        caveats.extend(not_simulated(measured));
        caveats.extend(not_steady(measured));
        let (groups, broken): (Vec<Group>, Vec<Vec<Caveat>>) =
            grouped(records).into_iter().map(without_broken).unzip();
        caveats.extend(broken.into_iter().flatten());
        let attributes: Vec<RunAttributes> = groups.iter().map(Group::attributes).collect();
        let conditions = gap::conditions(&attributes.iter().collect::<Vec<_>>());
        let mut cases = Vec::new();
        for (group, condition) in groups.iter().zip(conditions) {
            match group.case(scenario, &condition) {
                Ok(case) => cases.push(case),
                Err(reason) => caveats.push(Caveat::Outside { condition, reason }),
            }
        }
        caveats.extend(unlike_a_rig(scenario, &cases));
        caveats.sort();
        caveats.dedup();
        if cases.is_empty() {
            let reasons = caveats
                .iter()
                .filter(|caveat| matches!(caveat, Caveat::LeftOut { .. } | Caveat::Outside { .. }));
            return Err(CaseError::NoneLeft(
                reasons.map(Caveat::to_string).collect(),
            ));
        }
        Ok(Self { cases, caveats })
    }

    /// The runs of all cases, case by case, read as their replicates are.
    pub fn read(&self, statistician: &mut Statistician, measured: &[Trace]) -> Vec<Run> {
        let runs = self.cases.iter().flat_map(|case| {
            let runs = case.runs.iter().filter_map(|run| measured.get(*run));
            runs.map(move |trace| (case, trace))
        });
        runs.map(|(case, trace)| case.read_measured(statistician, trace))
            .collect()
    }
}

impl Case {
    /// Reads a measured run of this case.
    pub fn read_measured(&self, statistician: &mut Statistician, measured: &Trace) -> Run {
        let RunAttributes {
            repeat, day, notes, ..
        } = measured.attributes.clone();
        let mut trace = self.cut(measured);
        trace.attributes = RunAttributes {
            repeat,
            day,
            notes,
            ..self.attributes.clone()
        };
        Run::read(statistician, &trace)
    }

    /// Reads a simulated run of this case as [`as_measured`](Self::as_measured).
    pub fn read_simulated(
        &self,
        statistician: &mut Statistician,
        simulated: &Trace,
        rng: &mut impl Rng,
    ) -> Run {
        Run::read(statistician, &self.as_measured(simulated, rng))
    }

    /// A simulated run of this case, cut to what was measured and with its attributes; means are as uncertain as those,
    /// by draws of `rng`.
    pub fn as_measured(&self, simulated: &Trace, rng: &mut impl Rng) -> Trace {
        let mut trace = self.imitate(simulated);
        self.layout.blur(&mut trace, rng);
        trace.attributes = self.attributes.clone();
        trace
    }

    /// A measured run of this case: its channels and means that are compared, as long as they are.
    pub fn cut(&self, measured: &Trace) -> Trace {
        self.layout.cut(measured)
    }

    /// A simulated run of this case as the rig would have written it: the channels, rates and means
    /// that were measured.
    pub fn imitate(&self, simulated: &Trace) -> Trace {
        self.layout.imitate(simulated)
    }

    /// Whether the wheel was held off the ground.
    pub fn is_lifted(&self) -> bool {
        self.attributes.is_lifted()
    }

    /// Whether a channel of this name was measured, as a series or as a mean.
    pub fn has(&self, channel: &str) -> bool {
        self.layout.has(channel)
    }

    /// What both sides are read with, as text.
    pub(super) fn reading(&self) -> String {
        let RunAttributes {
            wheel_radius,
            wheel_width,
            lug_count,
            lug_height,
            load,
            speed,
            slip_ratio,
            slope_deg,
            ..
        } = self.attributes;
        let lug_count = lug_count.map_or("unknown".to_owned(), |count| count.to_string());
        let slope = match slope_deg {
            0.0 => String::new(),
            slope => format!(" slope {slope:?}"),
        };
        let numbers = [
            wheel_radius,
            wheel_width,
            lug_height,
            load,
            speed,
            slip_ratio,
        ];
        format!("read {lug_count} {numbers:?}{slope}\n{}", self.layout)
    }
}
