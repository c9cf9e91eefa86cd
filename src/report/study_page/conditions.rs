//! What every condition gave.

use crate::report::page::{Cell, Column, Section, Table};
use crate::study::Study;
use crate::study::conditions::{Condition, Mean, QUANTITIES, Unsteady};
use crate::table::four_digits;

/// Conditions shown; a page is no place for more.
const SHOWN: usize = 400;

/// From where to where the pull goes, scenario by scenario.
pub fn answer(conditions: &[Condition]) -> String {
    let mut pulls = Vec::<(&str, Vec<(Mean, &Condition)>)>::new();
    for condition in conditions {
        let Some(mean) = condition.means[0] else {
            continue;
        };
        let own = (mean, condition);
        match pulls
            .iter_mut()
            .find(|(name, _)| *name == condition.scenario)
        {
            Some((_, pulls)) => pulls.push(own),
            None => pulls.push((&condition.scenario, vec![own])),
        }
    }
    if pulls.is_empty() {
        return "No run recorded a drawbar pull.".to_owned();
    }
    let pulls: Vec<String> = pulls
        .into_iter()
        .map(|(scenario, pulls)| of_scenario(scenario, pulls))
        .collect();
    format!("Drawbar pull: {}.", pulls.join("; "))
}

/// The range of the pull in one scenario.
fn of_scenario(scenario: &str, mut pulls: Vec<(Mean, &Condition)>) -> String {
    pulls.sort_by(|(a, _), (b, _)| a.value.total_cmp(&b.value));
    let at = |(mean, condition): &(Mean, &Condition)| {
        let values = condition.values.iter().map(|v| Cell::toml(v).written());
        let mark = mark(condition);
        match values.collect::<Vec<_>>() {
            none if none.is_empty() => format!("{} N{mark}", written(mean)),
            values => format!("{} N{mark} at {}", written(mean), values.join(", ")),
        }
    };
    match &pulls[..] {
        [least, .., most] if written(&least.0) == written(&most.0) => {
            format!(
                "{scenario} {} N{} throughout",
                written(&least.0),
                mark(least.1)
            )
        }
        [least, .., most] => format!("{scenario} {} to {}", at(least), at(most)),
        one => format!("{scenario} {}", one.iter().map(at).collect::<String>()),
    }
}

/// That the pull of a condition is not a steady value; nothing where it is.
fn mark(condition: &Condition) -> String {
    let pull = QUANTITIES[0].name;
    let mut unsteady = condition.unsteady.iter();
    let rates = unsteady.find(|it| it.quantity == pull).and_then(rates);
    rates.map_or_else(String::new, |rates| format!(" (not steady: {rates})"))
}

/// How fast a quantity changes; `None` where it does not.
fn rates(unsteady: &Unsteady) -> Option<String> {
    let unit = &unsteady.unit;
    let [least, greatest] = unsteady.rates?.map(four_digits);
    Some(if least == greatest {
        format!("changes by {least} {unit}")
    } else {
        format!("changes by {least} to {greatest} {unit}")
    })
}

fn written(mean: &Mean) -> String {
    let value = four_digits(mean.value);
    mean.ci95.map_or(value.clone(), |[low, high]| {
        format!("{value} [{}, {}]", four_digits(low), four_digits(high))
    })
}

/// A table of the means of every condition.
pub fn section(study: &Study, conditions: &[Condition]) -> Section {
    let shown: Vec<usize> = (0..QUANTITIES.len())
        .filter(|&i| {
            conditions
                .iter()
                .any(|condition| condition.means[i].is_some())
        })
        .collect();
    let quantities = shown.iter().map(|&i| &QUANTITIES[i]);
    let quantities = quantities.map(|quantity| Column::new(quantity.name, quantity.unit));
    let keys = study.keys().map(|key| Column::new(key, ""));
    let is_any_unsteady = conditions.iter().any(|c| !c.unsteady.is_empty());
    let unsteady = is_any_unsteady.then(|| Column::new("not steady", ""));
    let columns = std::iter::once(Column::new("scenario", ""))
        .chain(keys)
        .chain([Column::new("runs", "")])
        .chain(quantities)
        .chain(unsteady);
    let row = |condition: &Condition| {
        let mut cells = vec![Cell::text(&condition.scenario)];
        cells.extend(condition.values.iter().map(|value| Cell::toml(value)));
        cells.push(Cell::Count(condition.runs as u64));
        cells.extend(shown.iter().map(|&i| mean_cell(condition.means[i])));
        cells.extend(is_any_unsteady.then(|| unsteady_cell(&condition.unsteady)));
        cells
    };
    let intervals = if study.repeats() > 1 {
        ", with Student's 95 % interval over the runs"
    } else {
        "; one run has no interval"
    };
    let tested = if is_any_unsteady {
        " \"Drifting\" values still change along the run and are not those of a steady state; \"too short\" are \
         runs of less than two and a half lug passes in that half, which cannot show it. runs.csv has the rates of \
         every run."
    } else {
        ""
    };
    let section = Section::new("Means of every condition")
        .prose(format!(
            "Means over the middle half of each run; a click on a header sorts.{tested}"
        ))
        .table(Table {
            caption: format!("Means of the runs of a condition{intervals}"),
            columns: columns.collect(),
            rows: conditions.iter().take(SHOWN).map(row).collect(),
        });
    if conditions.len() <= SHOWN {
        return section;
    }
    let all = conditions.len();
    section.prose(format!(
        "These are the first {SHOWN} of {all} conditions; runs.csv has all."
    ))
}

/// Which quantities are not known to be steady, and in how many runs.
fn unsteady_cell(unsteady: &[Unsteady]) -> Cell {
    let counted = |name: &str, count: usize, quantity: &str| match count {
        0 => None,
        1 => Some(format!("{quantity} {name}")),
        count => Some(format!("{quantity} {name} in {count} runs")),
    };
    let parts = unsteady.iter().flat_map(|unsteady| {
        let quantity = unsteady.quantity;
        let rates = rates(unsteady).map_or_else(String::new, |rates| format!(" ({rates})"));
        let drifting = counted("drifting", unsteady.drifting, quantity);
        let drifting = drifting.map(|text| text + &rates);
        drifting
            .into_iter()
            .chain(counted("too short", unsteady.too_short, quantity))
    });
    Cell::text(parts.collect::<Vec<String>>().join(", "))
}

fn mean_cell(mean: Option<Mean>) -> Cell {
    mean.map_or(Cell::Missing, |Mean { value, ci95 }| {
        ci95.map_or(Cell::Number(value), |ci95| Cell::Estimate(value, ci95))
    })
}
