//! What is run on a ground, and how rigs differ there: `scenarios/challenge/*.toml`.

use super::GROUNDS;
use super::truth::{Edit, Rig};
use crate::document::Document;
use crate::quantity::SampleRate;
use crate::scenario::{Scenario, ScenarioError, ready};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Standard deviation of what differs between rigs, as a share of the one stated: within
/// [`USUAL`] almost always.
pub(super) const SPREAD: f64 = 0.5;
/// Largest departure [standard deviations] of a plain rig.
const USUAL: f64 = 1.0;
/// Departures [standard deviations] far in the tails.
const FAR: [f64; 2] = [2.0, 2.5];
/// Parameters far in the tails at a time.
const FAR_PARAMETERS: usize = 2;

/// A design file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DesignTable {
    #[serde(rename = "version")]
    _version: i64,
    scenario: String,
    physics_rate: SampleRate,
    keys: Vec<String>,
    conditions: Vec<Vec<f64>>,
    repeats: u32,
    lifted: Lifted,
    set: BTreeMap<String, f64>,
    variability: Variability,
    parameter: Vec<Parameter>,
}

/// Runs with the wheel held off the ground, one at each speed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Lifted {
    clearance: f64,
    slip: f64,
    forward_speeds: Vec<f64>,
}

/// Runs made alike.
#[derive(Debug)]
pub(super) struct Condition {
    /// What they set.
    pub set: Vec<String>,
    /// How many there are.
    pub repeats: u32,
    /// Whether the wheel is held off the ground.
    pub is_lifted: bool,
}

/// What doubles the terrain's variability.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Variability {
    factor: f64,
    keys: Vec<String>,
}

/// A number in which every rig differs from its scenario; all its keys move together.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Parameter {
    keys: Vec<String>,
    moves: Moves,
    sd: f64,
}

/// Along what a parameter moves.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Moves {
    /// Its logarithm.
    Factor,
    /// Itself.
    Sum,
}

/// Campaigns on one ground.
#[derive(Debug)]
pub(super) struct Design {
    /// Its name.
    pub(super) ground: &'static str,
    /// What is published: the experiment as it is thought to be.
    pub(super) scenario: Scenario,
    /// Steps per second of the campaigns, other than the scenario's.
    pub(super) physics_rate: SampleRate,
    /// On the ground, then off it.
    pub(super) conditions: Vec<Condition>,
    variability: Variability,
    parameters: Vec<Parameter>,
}

impl Design {
    /// The committed design of a ground of that name, with runs of `duration` [s] where given, and
    /// no longer lead-in.
    ///
    /// # Errors
    /// `ScenarioError` where the scenario cannot be that long.
    pub(super) fn of(ground: &str, duration: Option<f64>) -> Option<Result<Self, ScenarioError>> {
        let ground = GROUNDS.into_iter().find(|known| *known == ground)?;
        Some(Self::read(ground, duration))
    }

    fn read(ground: &'static str, duration: Option<f64>) -> Result<Self, ScenarioError> {
        let table = DesignTable::of(ground);
        let scenario = ready::scenario(&table.scenario).expect("a design names a ready scenario");
        let mut set = table.set;
        if let Some(duration) = duration {
            set.insert("duration".to_owned(), duration);
            // Runs cut short are for trying a trial: they are not to cost what the others do.
            if let Some(lead_in) = set.get_mut("lead_in") {
                *lead_in = lead_in.min(duration);
            }
        }
        let assigned: Vec<String> = set
            .iter()
            .map(|(key, value)| assignment(key, *value))
            .collect();
        let scenario = Scenario::ready(scenario)?.with_all(&assigned)?;
        let on_ground = table.conditions.iter().map(|row| {
            let set = table.keys.iter().zip(row);
            Condition {
                set: set.map(|(key, value)| assignment(key, *value)).collect(),
                repeats: table.repeats,
                is_lifted: false,
            }
        });
        let rig = scenario.rig.path();
        let of_rig = |key: &str, value: f64| assignment(&format!("{rig}.{key}"), value);
        let speeds = table.lifted.forward_speeds.iter();
        let lifted = speeds.map(|speed| Condition {
            set: vec![
                of_rig("lifted", table.lifted.clearance),
                of_rig("slip", table.lifted.slip),
                of_rig("forward_speed", *speed),
            ],
            repeats: 1,
            is_lifted: true,
        });
        Ok(Self {
            ground,
            scenario,
            physics_rate: table.physics_rate,
            conditions: on_ground.chain(lifted).collect(),
            variability: table.variability,
            parameters: table.parameter,
        })
    }

    /// Number of runs of a campaign.
    pub(super) fn runs(&self) -> usize {
        let repeats = self.conditions.iter().map(|it| it.repeats as usize);
        repeats.sum()
    }

    /// Conditions in the order in which they are run, each with the number of the repeat.
    pub(super) fn order(&self) -> impl Iterator<Item = (u32, &Condition)> {
        let most = self.conditions.iter().map(|it| it.repeats).max();
        (1..=most.unwrap_or(0)).flat_map(|repeat| {
            let run = self
                .conditions
                .iter()
                .filter(move |it| it.repeats >= repeat);
            run.map(move |condition| (repeat, condition))
        })
    }

    /// What changes where a rig is of this kind.
    pub(super) fn edits(&self, rig: Rig, rng: &mut impl Rng) -> Vec<Edit> {
        let mut departures: Vec<f64> = self.parameters.iter().map(|_| usual(rng)).collect();
        if rig == Rig::Tails {
            let count = FAR_PARAMETERS.min(departures.len());
            for place in rand::seq::index::sample(rng, departures.len(), count) {
                let far = rng.random_range(FAR[0]..FAR[1]);
                departures[place] = if rng.random() { far } else { -far };
            }
        }
        self.departed(rig, &departures)
    }

    /// How many parameters differ from rig to rig.
    pub(super) fn parameters(&self) -> usize {
        self.parameters.len()
    }

    /// The edits of rigs with one parameter off by its stated standard deviation each.
    pub(super) fn departures(&self) -> impl Iterator<Item = Vec<Edit>> {
        (0..self.parameters()).map(|place| {
            let mut departures = vec![0.0; self.parameters()];
            departures[place] = 1.0;
            self.departed(Rig::Plain, &departures)
        })
    }

    /// The edits of a rig whose parameters are off by these standard deviations.
    fn departed(&self, rig: Rig, departures: &[f64]) -> Vec<Edit> {
        let mut values = BTreeMap::new();
        for (parameter, departure) in self.parameters.iter().zip(departures) {
            let offset = departure * parameter.sd;
            for key in &parameter.keys {
                let stated = self.number(key);
                let value = match parameter.moves {
                    Moves::Factor => stated * libm::exp(offset),
                    Moves::Sum => stated + offset,
                };
                values.insert(key.clone(), value);
            }
        }
        if rig == Rig::Variable {
            for key in &self.variability.keys {
                let value = values
                    .entry(key.clone())
                    .or_insert_with(|| self.number(key));
                *value *= self.variability.factor;
            }
        }
        let edit = |(key, value)| Edit { key, value };
        values.into_iter().map(edit).collect()
    }

    /// The number of the scenario under a key.
    fn number(&self, key: &str) -> f64 {
        let tree = serde_json::to_value(&self.scenario).expect("a scenario is tables and numbers");
        let found = tree.pointer(&format!("/{}", key.replace('.', "/")));
        found
            .and_then(serde_json::Value::as_f64)
            .expect("the committed designs name numbers of their scenarios")
    }
}

/// A departure [standard deviations] of a rig like most.
fn usual(rng: &mut impl Rng) -> f64 {
    loop {
        let drawn: f64 = StandardNormal.sample(rng);
        let departure = SPREAD * drawn;
        if departure.abs() <= USUAL {
            return departure;
        }
    }
}

impl DesignTable {
    /// The committed design of a ground.
    fn of(ground: &str) -> Self {
        let design = ready::challenge(ground).expect("every ground has a design");
        let document = Document::parse(design.text);
        document
            .and_then(|document| document.read())
            .expect("the committed designs are part of the program")
    }
}

/// `key=value` of a scenario.
pub(super) fn assignment(key: &str, value: f64) -> String {
    format!("{key}={value:?}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use std::ops::ControlFlow;

    fn designs(duration: Option<f64>) -> Vec<Design> {
        let read = |ground: &&str| Design::of(ground, duration).unwrap().unwrap();
        GROUNDS.iter().map(read).collect()
    }

    #[test]
    fn every_ground_has_a_design_of_twelve_runs_of_ten_seconds_at_a_rate_of_its_own() {
        for design in designs(None) {
            assert_eq!(design.runs(), 12, "{}", design.ground);
            assert_eq!(design.scenario.driven(), 10.0);
            assert_ne!(design.physics_rate, design.scenario.physics_rate());
            for condition in &design.conditions {
                design.scenario.with_all(&condition.set).unwrap();
            }
        }
        assert!(Design::of("mud", None).is_none());
    }

    #[test]
    fn a_plain_rig_is_within_a_standard_deviation_and_one_in_the_tails_has_two_parameters_beyond() {
        let design = &designs(None)[0];
        let departures = |rig: Rig, run: u64| -> Vec<f64> {
            let edits = design.edits(rig, &mut Seed(3).rng("rig", run));
            let of_key = |parameter: &Parameter| {
                let edit = edits.iter().find(|it| it.key == parameter.keys[0]).unwrap();
                let stated = design.number(&edit.key);
                match parameter.moves {
                    Moves::Factor => (edit.value / stated).ln() / parameter.sd,
                    Moves::Sum => (edit.value - stated) / parameter.sd,
                }
            };
            design.parameters.iter().map(of_key).collect()
        };
        let rounding = 1.0e-9;
        for run in 0..50 {
            assert!(
                departures(Rig::Plain, run)
                    .iter()
                    .all(|d| d.abs() <= USUAL + rounding)
            );
            let far = departures(Rig::Tails, run);
            let far: Vec<&f64> = far.iter().filter(|d| d.abs() > USUAL + rounding).collect();
            assert_eq!(far.len(), FAR_PARAMETERS);
            assert!(
                far.iter()
                    .all(|d| (2.0 - rounding..2.5 + rounding).contains(&d.abs()))
            );
        }
    }

    #[test]
    fn doubled_variability_comes_on_top_of_what_the_rig_has() {
        let design = &designs(None)[0];
        let roughness = |rig: Rig| {
            let edits = design.edits(rig, &mut Seed(3).rng("rig", 0));
            edits
                .iter()
                .find(|it| it.key.ends_with("rms"))
                .unwrap()
                .value
        };
        assert_eq!(roughness(Rig::Variable), 2.0 * roughness(Rig::Plain));
    }

    /// From rest into the ground. Gravel, which takes ten times as long, is only built.
    fn simulate(design: &Design, edits: &[Edit]) {
        let set: Vec<String> = edits
            .iter()
            .map(|it| assignment(&it.key, it.value))
            .collect();
        let scenario = design.scenario.with_all(&set).unwrap();
        let scenario = scenario.with_all(&design.conditions[2].set).unwrap();
        if design.ground != "gravel" {
            let go_on = &mut |_| ControlFlow::Continue(());
            scenario.run(Seed(1), 0, go_on).unwrap();
        }
    }

    #[test]
    fn rigs_at_the_ends_of_the_tails_and_of_variability_can_be_simulated() {
        for design in designs(Some(0.1)) {
            let count = design.parameters.len();
            for sign in [-1.0, 1.0] {
                for place in 0..count {
                    let mut departures = vec![0.0; count];
                    departures[place] = sign * FAR[1];
                    simulate(&design, &design.departed(Rig::Tails, &departures));
                }
                let usual = vec![sign * USUAL; count];
                simulate(&design, &design.departed(Rig::Variable, &usual));
            }
        }
    }
}
