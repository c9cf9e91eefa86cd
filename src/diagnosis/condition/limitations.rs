//! Limitations of a comparison by its runs and its scenario.

use super::record::{Record, names};
use super::{Case, Caveat};
use crate::scenario::Scenario;
use crate::trace::wheel::Lugs;
use crate::trace::{Trace, unit_of};
use std::collections::BTreeMap;

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
