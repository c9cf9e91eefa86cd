//! Identification scores as CSV, a row a number.

use super::score::{Accuracy, CarriedScore, DriftScore, GroupScore, IdentificationScore};
use crate::identification::Force;
use crate::study::table::{bare, cell, line};
use crate::terrain::class::Wtic;

impl IdentificationScore {
    /// One row for every number, see the [module](super::score).
    pub fn to_csv(&self) -> String {
        let shared = self.groups.first().map(|group| &group.shared);
        let keys = shared.into_iter().flatten().map(|(key, _)| key.as_str());
        let names = std::iter::once("scenario").chain(keys);
        let names = names.chain(COLUMNS).map(str::to_owned);
        let mut text = line(&names.collect::<Vec<_>>());
        for group in &self.groups {
            add_group(&mut text, group);
            let predicted = self.predictions.iter();
            for prediction in
                predicted.filter(|p| p.scenario == group.scenario && p.shared == group.shared)
            {
                let accuracy = &prediction.accuracy;
                add_accuracy(&mut text, group, "predicted", prediction.class, accuracy);
            }
        }
        for CarriedScore { from, to, accuracy } in &self.carried {
            let Some(group) = self.groups.iter().find(|group| group.scenario == *to) else {
                continue;
            };
            let source = self.groups.iter().find(|group| group.scenario == *from);
            let model = source.and_then(GroupScore::parameters);
            let what = format!("carried from {from}");
            // All values of a key count together.
            let every = GroupScore {
                shared: group
                    .shared
                    .iter()
                    .map(|(key, _)| (key.clone(), String::new()))
                    .collect(),
                ..group.clone()
            };
            let class = model.map_or(Wtic::Uwtic, |(class, _)| class);
            add_accuracy(&mut text, &every, &what, class, accuracy);
        }
        text
    }
}

/// Columns after the group's.
const COLUMNS: [&str; 12] = [
    "label",
    "recognized",
    "model",
    "what",
    "name",
    "unit",
    "value",
    "low",
    "high",
    "own",
    "covered",
    "of",
];

fn add_group(text: &mut String, group: &GroupScore) {
    for drift in &group.drifts {
        add_drift(text, group, drift);
    }
    for fit in &group.fits {
        let Some(found) = fit.found() else {
            continue;
        };
        for parameter in &found.parameters {
            let ends = parameter.ci95.map(cell);
            let values = [parameter.parameter.name(), parameter.unit].map(str::to_owned);
            let mut cells = first_cells(group, "parameter", fit.class.as_str());
            cells.extend(values);
            cells.push(cell(Some(parameter.value)));
            cells.extend(ends);
            cells.push(cell(parameter.own));
            cells.extend([String::new(), String::new()]);
            text.push_str(&line(&cells));
        }
        add_accuracy(text, group, "fitted", fit.class, &found.fitted);
        add_accuracy(text, group, "means", fit.class, &found.means);
        add_accuracy(text, group, "left_out", fit.class, &found.left_out);
    }
}

/// What still changes, whatever the model.
fn add_drift(text: &mut String, group: &GroupScore, drift: &DriftScore) {
    let mut cells = first_cells(group, "not_steady", "");
    cells.extend([drift.channel, &drift.unit].map(str::to_owned));
    cells.push(cell(Some(drift.rate)));
    cells.extend(drift.rates.map(|rate| cell(Some(rate))));
    cells.push(String::new());
    cells.extend([drift.rows, group.rows].map(|count| count.to_string()));
    text.push_str(&line(&cells));
}

fn add_accuracy(
    text: &mut String,
    group: &GroupScore,
    what: &str,
    class: Wtic,
    accuracy: &Accuracy,
) {
    for force in Force::ALL {
        let Some(error) = accuracy.error(force) else {
            continue;
        };
        let share = accuracy.covered.get(&force);
        let held = share.map(|share| (share.value * share.n as f64).round());
        let mut cells = first_cells(group, what, class.as_str());
        cells.extend([force.name(), "%"].map(str::to_owned));
        cells.push(cell(Some(error)));
        cells.extend(std::iter::repeat_n(String::new(), 3));
        cells.push(held.map_or_else(String::new, |held| held.to_string()));
        cells.push(share.map_or_else(String::new, |share| share.n.to_string()));
        text.push_str(&line(&cells));
    }
}

fn first_cells(group: &GroupScore, what: &str, model: &str) -> Vec<String> {
    let mut cells = vec![group.scenario.clone()];
    cells.extend(group.shared.iter().map(|(_, value)| bare(value)));
    cells.push(group.label.to_string());
    cells.push(group.recognized.to_string());
    cells.push(model.to_owned());
    cells.push(what.to_owned());
    cells
}
