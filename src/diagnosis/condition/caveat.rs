//! What a comparison rests on less than it should.

use crate::gap::Condition;
use crate::terrain::class::TerrainLabel;
use serde::Serialize;
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
    /// A number that is not stated, and its source.
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
    /// Half of the runs or more have another slip than stated.
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
                "at least half of the runs ran at another slip than stated, as by a fault of the rig: the slips stated are kept",
            ),
            Self::NotSimulated(channels) => {
                let are = if channels.len() == 1 { "is" } else { "are" };
                write!(f, "{} {are} not simulated", channels.join(", "))
            }
            Self::SetDown => f.write_str(
                "simulated runs start with touchdown, which causes an impact stronger than those of rolling: if \
                 the measured ones start in steady rolling, give the scenario a lead-in (--set lead_in=2)",
            ),
            Self::Noiseless => f.write_str(
                "the simulated sensors are without noise, so that simulated repeats scatter less than measured \
                 ones: specify the sensor noise in the scenario",
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
