//! Identification scores as CSV, a row a number.

use super::score::{Accuracy, GroupScore, IdentificationScore, ParameterScore};
use crate::identification::Force;
use crate::study::cells::Number;
use crate::study::table::{Columns, bare, to_csv};
use crate::terrain::class::{TerrainLabel, Wtic};
use serde::Serialize;

/// A number of a group, see the [module](super::score).
#[derive(Clone, Serialize)]
struct NumberRow<'s> {
    scenario: &'s str,
    /// Values of the swept keys that all its runs share.
    shared: Vec<String>,
    label: TerrainLabel,
    recognized: Wtic,
    model: Option<Wtic>,
    what: String,
    name: &'s str,
    unit: &'s str,
    value: Number,
    ends: [Number; 2],
    own: Number,
    covered: Option<u64>,
    of: Option<u64>,
}

impl IdentificationScore {
    /// One row for every number, see the [module](super::score).
    pub fn to_csv(&self) -> String {
        let shared = self.groups.first().map(|group| &group.shared);
        let keys = shared.into_iter().flatten().map(|(key, _)| [key.as_str()]);
        let columns = Columns::default()
            .with(["scenario"])
            .list(keys)
            .with(["label", "recognized", "model", "what", "name", "unit"])
            .with(["value", "low", "high", "own", "covered", "of"]);
        let groups = self.groups.iter().flat_map(|group| self.rows_of(group));
        to_csv(&columns, groups.chain(self.carried_rows()))
    }

    fn rows_of<'s>(&'s self, group: &'s GroupScore) -> impl Iterator<Item = NumberRow<'s>> {
        let predicted = self
            .predictions
            .iter()
            .filter(|it| it.scenario == group.scenario && it.shared == group.shared);
        let predicted = predicted.flat_map(move |prediction| {
            let row = group.row("predicted", Some(prediction.class));
            forces(&row, &prediction.accuracy)
        });
        group.drift_rows().chain(group.fit_rows()).chain(predicted)
    }

    /// Every ground by the parameters of another; all values of a key count together.
    fn carried_rows(&self) -> impl Iterator<Item = NumberRow<'_>> {
        let group = |name: &str| self.groups.iter().find(|group| group.scenario == name);
        self.carried.iter().flat_map(move |carried| {
            let model = group(&carried.from).and_then(GroupScore::parameters);
            let class = model.map_or(Wtic::Uwtic, |(class, _)| class);
            let row = group(&carried.to).map(|to| NumberRow {
                shared: vec![String::new(); to.shared.len()],
                ..to.row(&format!("carried from {}", carried.from), Some(class))
            });
            row.into_iter()
                .flat_map(|row| forces(&row, &carried.accuracy))
        })
    }
}

impl GroupScore {
    /// A row of the group without its number.
    fn row(&self, what: &str, model: Option<Wtic>) -> NumberRow<'_> {
        NumberRow {
            scenario: &self.scenario,
            shared: self.shared.iter().map(|(_, value)| bare(value)).collect(),
            label: self.label,
            recognized: self.recognized,
            model,
            what: what.to_owned(),
            name: "",
            unit: "",
            value: Number::default(),
            ends: Default::default(),
            own: Number::default(),
            covered: None,
            of: None,
        }
    }

    /// What still changes, whatever the model.
    fn drift_rows(&self) -> impl Iterator<Item = NumberRow<'_>> {
        self.drifts.iter().map(|drift| NumberRow {
            name: drift.channel,
            unit: &drift.unit,
            value: drift.rate.into(),
            ends: drift.rates.map(Number::from),
            covered: Some(drift.rows as u64),
            of: Some(self.rows as u64),
            ..self.row("not_steady", None)
        })
    }

    /// Parameters of every model, and its errors.
    fn fit_rows(&self) -> impl Iterator<Item = NumberRow<'_>> {
        let found = self
            .fits
            .iter()
            .filter_map(|fit| Some((fit.class, fit.found()?)));
        found.flat_map(move |(class, found)| {
            let parameter = move |it: &'_ ParameterScore| NumberRow {
                name: it.parameter.name(),
                unit: it.unit,
                value: it.value.into(),
                ends: it.ci95.map(Number::from),
                own: it.own.into(),
                ..self.row("parameter", Some(class))
            };
            let errors = [
                ("fitted", &found.fitted),
                ("means", &found.means),
                ("left_out", &found.left_out),
            ];
            let errors = errors
                .into_iter()
                .flat_map(move |(what, accuracy)| forces(&self.row(what, Some(class)), accuracy));
            found.parameters.iter().map(parameter).chain(errors)
        })
    }
}

/// A row for the error of every force.
fn forces<'s>(row: &NumberRow<'s>, accuracy: &Accuracy) -> Vec<NumberRow<'s>> {
    let of_force = |force: Force| {
        let share = accuracy.covered.get(&force);
        Some(NumberRow {
            name: force.name(),
            unit: "%",
            value: accuracy.error(force)?.into(),
            covered: share.map(|share| (share.value * share.n as f64).round() as u64),
            of: share.map(|share| share.n),
            ..row.clone()
        })
    };
    Force::ALL.into_iter().filter_map(of_force).collect()
}
