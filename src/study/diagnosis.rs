//! The `[diagnosis]` of a study file: what [`diagnosis`](crate::diagnosis) makes of its runs.
//!
//! Runs that differ in the keys of `over` only, and their repeats, are a *campaign*. Of each run a
//! campaign has what a rig would have written: channels, load, speed, slip and wheel as commanded, name of
//! the ground. It is diagnosed as `lugwheel diagnose` would, against the scenario that the file names;
//! without one, against the scenario of its runs with the keys of `[set]`, without its effects: no
//! swept key is withheld but load, speed, slip, duration and wheel, which runs state themselves.
//!
//! Swept magnitudes of an effect (`effect.slip_sinkage`, `effect.gain_error.drawbar_pull`; the neutral
//! one is a campaign without it) thus show from where on it is named, swept values of a parameter
//! which errors are read as `parameter`. Repeats and conditions of a rig have nothing in common:
//! `random_numbers = "independent"`.
//!
//! Campaigns are diagnosed one after the other when all runs are there. What is simulated for one is
//! kept in `bank/` for all, each answer in `diagnoses/`: what was stopped goes on from both. All
//! draws come from the study's seed.
//!
//! What came of it stands in `diagnosis.txt` and `diagnosis.csv`, see [`score`].

mod asking;
mod campaign;
mod csv;
pub mod score;
mod text;
mod truth;

use super::group::{check_over, slip_of};
use super::{ScenarioFolder, Study, in_one_line};
use crate::diagnosis::BUDGET;
use crate::document::{Document, Misfit};
use crate::effects;
use crate::quantity::RangeError;
use crate::scenario::Scenario;
use serde::Deserialize;
use std::path::PathBuf;

/// Why a campaign joins swept keys only.
const NOT_SWEPT: &str =
    "a campaign joins runs that differ: sweep it, or name the keys that change its runs in `over`";

/// A `[diagnosis]` before its checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DiagnosisTable {
    scenario: Option<PathBuf>,
    over: Option<Vec<String>>,
    #[serde(default = "usual_budget")]
    budget: f64,
    #[serde(default)]
    without: Vec<String>,
}

fn usual_budget() -> f64 {
    BUDGET
}

/// How the campaigns of a study are diagnosed.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    /// Keys whose conditions a campaign joins.
    over: Vec<String>,
    against: Against,
    /// Driving [s] that may be simulated for a campaign.
    budget: f64,
    /// Effects to do without.
    without: Vec<String>,
}

/// What campaigns are held against.
#[derive(Debug, Clone)]
enum Against {
    /// All against the scenario that the file names.
    Named(Box<Scenario>),
    /// Each against its own without effects, by name.
    Own(Vec<(String, Scenario)>),
}

impl Plan {
    /// The scenario that the file names, as it was read.
    pub(super) fn scenario_text(&self) -> Option<&str> {
        match &self.against {
            Against::Named(scenario) => Some(scenario.text()),
            Against::Own(_) => None,
        }
    }

    /// What runs of the scenario `name` are held against.
    fn against(&self, name: &str) -> &Scenario {
        match &self.against {
            Against::Named(scenario) => scenario,
            Against::Own(all) => {
                let own = all.iter().find(|(own, _)| own == name);
                &own.expect("the table has every scenario of the study").1
            }
        }
    }
}

impl DiagnosisTable {
    /// Checks the table against a study that is sound without it.
    pub(super) fn read(
        self,
        study: &Study,
        document: &Document,
        folder: ScenarioFolder,
    ) -> Result<Plan, Misfit> {
        let at = |key: String| {
            let place = document.place(&format!("diagnosis{key}"));
            move |message: String| Misfit { place, message }
        };
        let over = self.over.unwrap_or_else(|| slip_of(study));
        check_over(study, &over, NOT_SWEPT).map_err(at(".over".to_owned()))?;
        RangeError::positive("budget", "s", self.budget)
            .map_err(|error| at(".budget".to_owned())(error.to_string()))?;
        for (index, name) in self.without.iter().enumerate() {
            effects::seat_of(name)
                .map_err(|error| at(format!(".without.{index}"))(error.to_string()))?;
        }
        let against = match self.scenario {
            Some(path) => folder
                .scenario(&path)
                .map(|scenario| Against::Named(Box::new(scenario)))
                .map_err(at(".scenario".to_owned()))?,
            None => Against::Own(own(study).map_err(at(String::new()))?),
        };
        Ok(Plan {
            over,
            against,
            budget: self.budget,
            without: self.without,
        })
    }
}

/// Every scenario of a study with the keys of `[set]`, without effects.
fn own(study: &Study) -> Result<Vec<(String, Scenario)>, String> {
    let own = |named: &super::Named| {
        let scenario = named.scenario.with_all(&study.settings);
        let mut scenario = scenario.map_err(|error| {
            let error = in_one_line(&error);
            format!(
                "without what is swept its scenario is none; name another (`scenario`): {error}"
            )
        })?;
        scenario.effects.clear();
        Ok((named.name.clone(), scenario))
    };
    study.scenarios.iter().map(own).collect()
}
