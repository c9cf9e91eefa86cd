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
//! The results are in `diagnosis.csv`, see [`score`].

mod asking;
mod campaign;
mod csv;
pub mod score;
mod truth;

use super::analysis::{Analysis, Finished, Report};
use super::group::{check_over, slip_of};
use super::{Reading, Study, StudyError, in_one_line};
use crate::diagnosis::BUDGET;
use crate::document::Misfit;
use crate::effects;
use crate::quantity::RangeError;
use crate::scenario::Scenario;
use score::DiagnosisScore;
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

impl Analysis for Plan {
    const ROWS: Option<&'static str> = None;
    type Plan = DiagnosisTable;
    type Row = ();
    type Score = DiagnosisScore;

    fn read(table: DiagnosisTable, file: &Reading) -> Result<Self, Misfit> {
        let over = table.over.unwrap_or_else(|| slip_of(file.study));
        check_over(file.study, &over, NOT_SWEPT).map_err(file.at("diagnosis.over"))?;
        RangeError::positive("budget", "s", table.budget).map_err(file.at("diagnosis.budget"))?;
        for (index, name) in table.without.iter().enumerate() {
            let key = format!("diagnosis.without.{index}");
            effects::seat_of(name).map_err(file.at(&key))?;
        }
        let against = match table.scenario {
            Some(path) => {
                let scenario = file.folder.scenario(&path);
                let scenario = scenario.map_err(file.at("diagnosis.scenario"))?;
                Against::Named(Box::new(scenario))
            }
            None => Against::Own(own(file.study).map_err(file.at("diagnosis"))?),
        };
        Ok(Self {
            over,
            against,
            budget: table.budget,
            without: table.without,
        })
    }

    fn scenario(&self) -> Option<(&'static str, &str)> {
        match &self.against {
            Against::Named(scenario) => Some(("held_against", scenario.text())),
            Against::Own(_) => None,
        }
    }

    fn needs_traces(&self) -> bool {
        true
    }

    fn score(&self, done: &Finished, _: Vec<()>) -> Result<DiagnosisScore, StudyError> {
        asking::score(self, done)
    }

    fn report(score: &DiagnosisScore) -> Option<Report> {
        Some(Report {
            stem: "diagnosis",
            rows: "campaigns",
            table: "diagnosis.csv",
            csv: Some(score.to_csv()),
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
