//! What a comparison rests on less than it should.

use super::Case;
use super::record::{Record, names};
use crate::gap::Condition;
use crate::scenario::Scenario;
use crate::terrain::class::TerrainLabel;
use crate::trace::wheel::Lugs;
use crate::trace::{Trace, unit_of};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// What a comparison with a scenario rests on less than it should.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Caveat {
    /// Lugs of the measured wheel, and those of the scenario's.
    Lugs {
        /// As measured.
        measured: String,
        /// As in the scenario.
        scenario: String,
    },
    /// The ground was called otherwise than the scenario's.
    Ground {
        /// As measured.
        measured: TerrainLabel,
        /// As in the scenario.
        scenario: TerrainLabel,
    },
    /// A number that no run tells, and whence it was taken.
    Taken {
        /// What was missing.
        what: &'static str,
        /// Whence it was taken.
        from: &'static str,
    },
    /// A run whose measured slip contradicts the slip stated.
    WrongSlip {
        /// Its place in the campaign.
        run: usize,
    },
    /// Runs in which a channel drifts.
    NotSteady {
        /// The channel.
        channel: String,
        /// How many runs.
        drifting: usize,
        /// Of how many that have it.
        runs: usize,
    },
    /// Most runs have another slip than stated.
    OtherSlips,
    /// Channels that no simulation makes.
    NotSimulated(Vec<String>),
    /// Simulated records begin as the wheel is set down.
    SetDown,
    /// Simulated sensors are without noise.
    Noiseless,
    /// A run that was not compared, and why.
    LeftOut {
        /// Its place in the campaign.
        run: usize,
        /// Why.
        reason: String,
    },
    /// A condition that was not compared, and why.
    Outside {
        /// Which.
        condition: Condition,
        /// Why.
        reason: String,
    },
}

impl fmt::Display for Caveat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lugs { measured, scenario } => write!(
                f,
                "the measured wheel has {measured}, the scenario's {scenario}"
            ),
            Self::Ground { measured, scenario } => write!(
                f,
                "the ground was called {measured}, the scenario's is {scenario}"
            ),
            Self::Taken { what, from } => write!(f, "{what} is not stated: taken from {from}"),
            Self::WrongSlip { run } => write!(
                f,
                "run {} of those given ran at another slip than stated: the measured one is taken",
                run + 1
            ),
            Self::NotSteady {
                channel,
                drifting,
                runs,
            } => write!(
                f,
                "{channel} is not steady in {drifting} of {runs} runs: its means there depend on how long and \
                 from what start the wheel had been rolling"
            ),
            Self::OtherSlips => f.write_str(
                "most runs ran at another slip than stated, as by a fault of the rig: the slips stated are kept",
            ),
            Self::NotSimulated(channels) => {
                write!(f, "no simulation makes {}", channels.join(", "))
            }
            Self::SetDown => f.write_str(
                "simulated runs begin as the wheel is set down, which jolts it more than rolling does: where \
                 the measured ones begin in steady rolling, give the scenario a lead-in (--set lead_in=2)",
            ),
            Self::Noiseless => f.write_str(
                "simulated sensors are without noise, and agree better than any rig's: give the scenario's \
                 sensors the noise of the rig's",
            ),
            Self::LeftOut { run, reason } => {
                write!(f, "run {} of those given is left out: {reason}", run + 1)
            }
            Self::Outside { condition, reason } => {
                write!(f, "{condition} is left out: {reason}")
            }
        }
    }
}

/// In what measured wheels and grounds differ from the scenario's.
pub(super) fn differences(scenario: &Scenario, records: &[Record]) -> Vec<Caveat> {
    let of_scenario = Lugs {
        count: Some(scenario.wheel.lug_count()),
        height: scenario.wheel.lug_height(),
    };
    let stated = of_scenario.to_string();
    let ground = scenario.terrain.label();
    let mut caveats = Vec::new();
    for Record { attributes, .. } in records {
        // What is not stated of the measured lugs is taken from the scenario's.
        let completed = attributes.lugs().completed(of_scenario).to_string();
        caveats.extend((completed != stated).then(|| Caveat::Lugs {
            measured: attributes.lugs().to_string(),
            scenario: stated.clone(),
        }));
        let other = attributes.terrain.filter(|label| *label != ground);
        caveats.extend(other.map(|measured| Caveat::Ground {
            measured,
            scenario: ground,
        }));
    }
    caveats
}

/// What no rig's records are like, where there are records.
pub(super) fn unlike_a_rig(scenario: &Scenario, cases: &[Case]) -> Vec<Caveat> {
    let set_down = scenario.lead_in == 0.0;
    let mut transducers = scenario.sensors.transducers().into_iter();
    let noiseless = transducers.all(|transducer| transducer.noise_density == 0.0);
    let known = [(set_down, Caveat::SetDown), (noiseless, Caveat::Noiseless)];
    let mut cases = cases.iter();
    let has_series = cases.any(|case| !case.layout.series.is_empty());
    let stated = known.into_iter().filter(|(is, _)| has_series && *is);
    stated.map(|(_, caveat)| caveat).collect()
}

pub(super) fn not_simulated(measured: &[Trace]) -> Option<Caveat> {
    let mut foreign: Vec<String> = measured.iter().flat_map(names).collect();
    foreign.retain(|name| unit_of(name).is_none());
    foreign.sort();
    foreign.dedup();
    (!foreign.is_empty()).then_some(Caveat::NotSimulated(foreign))
}

/// Channels that drift along runs on the ground.
pub(super) fn not_steady(measured: &[Trace]) -> Vec<Caveat> {
    let mut counts = BTreeMap::<&str, [usize; 2]>::new();
    let on_ground = measured.iter().filter(|run| !run.attributes.is_lifted());
    for trace in on_ground {
        for channel in &trace.channels {
            if let Some(steadiness) = trace.steadiness(&channel.name) {
                let [drifting, runs] = counts.entry(&channel.name).or_default();
                *drifting += usize::from(steadiness.rate().is_some());
                *runs += 1;
            }
        }
    }
    let drifting = counts
        .into_iter()
        .filter(|(_, [drifting, _])| *drifting > 0);
    drifting
        .map(|(channel, [drifting, runs])| Caveat::NotSteady {
            channel: channel.to_owned(),
            drifting,
            runs,
        })
        .collect()
}
