//! The rows of a group, and the models fitted to them.

use super::Plan;
use super::steady::IntervalRow;
use crate::identification::{
    Drift, Estimate, Identification, IdentifyError, Law, PredictedForce, RIGID_SINKAGE, Setting,
    SteadyLoad, SteadyRow, Uncertainty, pool,
};
use crate::recognition::class_of_most;
use crate::scenario::Scenario;
use crate::study::Study;
use crate::study::group::{Group, value_in};
use crate::study::table::Place;
use crate::terrain::class::Wtic;
use rayon::prelude::*;

/// The steady rows of a group.
pub(super) struct GroupRows {
    pub group: Group,
    /// The scenario of its first condition; wheel and ground are those of all.
    pub scenario: Scenario,
    pub setting: Setting,
    pub rows: Vec<GroupRow>,
    /// Answers to its windows, in the order of the classes.
    pub answers: [u64; 4],
    /// Why runs have no steady interval, with their numbers.
    pub without: Vec<(u64, String)>,
}

/// A row of a group.
pub(super) struct GroupRow {
    pub condition: u64,
    pub repeat: u32,
    /// The value of the first key that the fit joins, as TOML.
    pub value: String,
    /// Its uncertainties are those of the group, widened by what still changes.
    pub steady: SteadyRow,
}

impl GroupRows {
    pub fn new(study: &Study, plan: &Plan, group: Group, rows: &[IntervalRow]) -> Self {
        let scenario = study.scenario_of(group.conditions[0]);
        let mut found = Self {
            setting: plan.setting(&scenario),
            scenario,
            rows: Vec::new(),
            answers: [0; 4],
            without: Vec::new(),
            group,
        };
        let mut last_run = None;
        for row in rows {
            let Place {
                run,
                condition,
                repeat,
                ..
            } = row.place;
            if !found.group.conditions.contains(&condition) {
                continue;
            }
            if last_run.replace(run) != Some(run) {
                let counts = found.answers.iter_mut().zip(row.answered);
                counts.for_each(|(sum, count)| *sum += count);
            }
            let value = value_in(study, condition, &plan.over[0]).unwrap_or_default();
            match row.steady() {
                Ok(steady) => found.rows.push(GroupRow {
                    condition,
                    repeat,
                    value,
                    steady,
                }),
                Err(reason) => found.without.push((run, reason)),
            }
        }
        let loads = found.rows.iter_mut().map(|row| &mut row.steady.load);
        pool(&mut loads.collect::<Vec<_>>());
        found.rows.iter_mut().for_each(|row| row.steady.widen());
        found
    }

    /// The class of its ground's label.
    pub fn label_class(&self) -> Wtic {
        self.scenario.terrain.label().class()
    }

    /// The class recognised.
    pub fn recognized(&self) -> Wtic {
        class_of_most(self.answers)
    }

    /// Number of rows with the rim held above the ground by the lugs.
    pub fn above_ground(&self) -> usize {
        let above = self.rows.iter().filter(|row| is_above(&row.steady.load));
        above.count()
    }

    /// Rows in which something still changes.
    pub fn not_steady(&self) -> usize {
        let drifting = self.rows.iter().filter(|row| !row.steady.is_steady());
        drifting.count()
    }

    /// What still changes in the rows.
    pub fn drifts(&self) -> impl Iterator<Item = Drift> {
        self.rows.iter().flat_map(|row| &row.steady.drifts).copied()
    }

    /// Repeats that have rows, in order.
    pub fn repeats(&self) -> Vec<u32> {
        let mut repeats: Vec<u32> = self.rows.iter().map(|row| row.repeat).collect();
        repeats.sort_unstable();
        repeats.dedup();
        repeats
    }

    /// Those loads that are `wanted`, as the model of a class takes them.
    pub fn loads(&self, class: Wtic, wanted: impl Fn(&GroupRow) -> bool) -> Vec<SteadyLoad> {
        let wanted = self.rows.iter().filter(|row| wanted(row));
        wanted
            .map(|row| as_taken(&row.steady.load, class, &self.setting.law))
            .collect()
    }

    /// The model of a class fitted to all rows.
    pub fn fit(&self, class: Wtic) -> Result<Fitted, IdentifyError> {
        let rows = self.loads(class, |_| true);
        let identification = Identification::new(&rows, class, &self.setting)?;
        let mut estimate = identification.estimate()?;
        identification.profile(&mut estimate);
        Ok(Fitted {
            fitted: identification.predict(&estimate, &rows)?,
            means: self.means(&identification, &estimate)?,
            left_out: self.left_out(&estimate),
            estimate,
        })
    }

    /// The mean forces of each condition.
    fn means(
        &self,
        identification: &Identification,
        estimate: &Estimate,
    ) -> Result<Vec<PredictedForce>, IdentifyError> {
        let mut means = Vec::new();
        for condition in &self.group.conditions {
            let rows = self.loads(estimate.class, |row| row.condition == *condition);
            means.extend(PredictedForce::means(
                &identification.predict(estimate, &rows)?,
            ));
        }
        Ok(means)
    }

    /// The forces at each value of the first key joined, predicted by a fit to the others; none
    /// where the others are too few.
    fn left_out(&self, whole: &Estimate) -> Vec<PredictedForce> {
        let class = whole.class;
        let mut values: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !values.contains(&row.value.as_str()) {
                values.push(&row.value);
            }
        }
        let predicted = |value: &&str| {
            let others = self.loads(class, |row| row.value != *value);
            let left_out = self.loads(class, |row| row.value == *value);
            let identification = Identification::new(&others, class, &self.setting).ok()?;
            let estimate = identification.estimate_near(whole).ok()?;
            identification.predict(&estimate, &left_out).ok()
        };
        let predicted: Vec<Vec<PredictedForce>> = values.par_iter().filter_map(predicted).collect();
        predicted.concat()
    }
}

/// A model fitted to a group.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fitted {
    pub estimate: Estimate,
    /// The forces of the rows fitted.
    pub fitted: Vec<PredictedForce>,
    /// The mean forces of each condition.
    pub means: Vec<PredictedForce>,
    /// The forces of rows left out in turn.
    pub left_out: Vec<PredictedForce>,
}

fn is_above(load: &SteadyLoad) -> bool {
    load.sinkage < RIGID_SINKAGE
}

/// A load as the model of a class takes it: without lugs, a rim above the ground has the sinkage of hard
/// ground, exactly.
fn as_taken(load: &SteadyLoad, class: Wtic, law: &Law) -> SteadyLoad {
    let lugs_reach = matches!(law, Law::Own(own) if own.lugs.is_some());
    if class != Wtic::Leis || lugs_reach || !is_above(load) {
        return *load;
    }
    let exact = |uncertainty: Uncertainty| Uncertainty {
        sinkage: 0.0,
        ..uncertainty
    };
    SteadyLoad {
        sinkage: RIGID_SINKAGE,
        uncertainty: load.uncertainty.map(exact),
        ..*load
    }
}
