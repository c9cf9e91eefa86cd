//! What every condition gave.

use crate::report::figure::Layout;
use crate::report::page::{Cell, Column, Figure, Section, Table};
use crate::report::sweep_figure::unit_behind_number;
use crate::report::{SweptKey, sweep_figure};
use crate::scenario::keys::unit_of;
use crate::study::Study;
use crate::study::conditions::{Condition, Mean, QUANTITIES, Unsteady, varied};

/// Conditions shown in the table, and conditions in a figure; a page is no place for more.
const SHOWN: usize = 400;
const DRAWN: usize = 2000;

/// From where to where the pull goes, scenario by scenario, and at which values of the swept keys.
pub fn answer(study: &Study, conditions: &[Condition]) -> String {
    let keys: Vec<(&str, String)> = varied(study.keys(), conditions)
        .into_iter()
        .map(|key| (key, unit_behind_number(key)))
        .collect();
    let places = study
        .keys()
        .map(|key| keys.iter().find(|(it, _)| *it == key));
    let places: Vec<_> = places.collect();
    let place = |condition: &Condition| {
        let values = places.iter().zip(&condition.values);
        let values = values.filter_map(|(key, value)| {
            let (key, unit) = (*key)?;
            Some(format!("{key} = {}{unit}", Cell::toml(value).written()))
        });
        values.collect::<Vec<_>>().join(", ")
    };
    let of_scenarios = conditions.chunk_by(|a, b| a.scenario == b.scenario);
    let pulls: Vec<String> = of_scenarios
        .filter_map(|conditions| of_scenario(conditions, &place))
        .collect();
    if pulls.is_empty() {
        return "No run recorded a drawbar pull.".to_owned();
    }
    format!("Mean drawbar pull: {}.", pulls.join("; "))
}

/// The range of the pull in one scenario; `place` names the values of a condition.
fn of_scenario(conditions: &[Condition], place: &dyn Fn(&Condition) -> String) -> Option<String> {
    let pulls = conditions.iter();
    let pulls = pulls.filter_map(|condition| Some((condition.means[0]?, condition)));
    let mut pulls: Vec<(Mean, &Condition)> = pulls.collect();
    pulls.sort_by(|(a, _), (b, _)| a.value.total_cmp(&b.value));
    let at = |(mean, condition): &(Mean, &Condition)| {
        let place = place(condition);
        let place = match place.as_str() {
            "" => String::new(),
            place => format!(" at {place}"),
        };
        format!("{} N{}{place}", written(mean), mark(condition))
    };
    let scenario = &conditions[0].scenario;
    Some(match &pulls[..] {
        [] => return None,
        [least, .., most] if written(&least.0) == written(&most.0) => {
            let pull = written(&least.0);
            format!("{scenario} {pull} N{} in all conditions", mark(least.1))
        }
        [least, .., most] => format!("{scenario} from {} to {}", at(least), at(most)),
        [one] => format!("{scenario} {}", at(one)),
    })
}

/// That the pull of a condition is not a steady value; nothing where it is.
fn mark(condition: &Condition) -> String {
    let pull = QUANTITIES[0].name;
    let mut unsteady = condition.unsteady.iter();
    let rates = unsteady
        .find(|it| it.quantity == pull)
        .and_then(Unsteady::range);
    rates.map_or_else(String::new, |rates| format!(" (not steady: {rates})"))
}

fn written(pull: &Mean) -> String {
    mean_cell(0, Some(*pull)).written()
}

/// The means of every condition: a figure for every swept key, and a table.
pub fn section(study: &Study, conditions: &[Condition]) -> Section {
    let tested = if is_any_unsteady(conditions) {
        " \"Drifting\" values still change along the run and are not those of a steady state; \"too short\" are \
         runs of less than two and a half lug passes in that half, which cannot show it. runs.csv has the rates of \
         every run."
    } else {
        ""
    };
    let on_lugs = if conditions.iter().any(Condition::is_on_lugs) {
        " Sinkage is the depth of the rim below the undisturbed surface: below 0 the wheel stands on its lugs and the \
         rim is above the surface."
    } else {
        ""
    };
    let section = Section::new("Means of every condition").prose(format!(
        "Means over the middle half of each run; a click on a header sorts.{on_lugs}{tested}"
    ));
    let section = figures(study, conditions)
        .into_iter()
        .fold(section, Section::figure)
        .table(table(study, conditions));
    if conditions.len() <= SHOWN {
        return section;
    }
    let all = conditions.len();
    section.prose(format!(
        "These are the first {SHOWN} of {all} conditions; runs.csv has all."
    ))
}

fn is_any_unsteady(conditions: &[Condition]) -> bool {
    conditions.iter().any(|it| !it.unsteady.is_empty())
}

fn table(study: &Study, conditions: &[Condition]) -> Table {
    let shown: Vec<usize> = (0..QUANTITIES.len())
        .filter(|&i| {
            conditions
                .iter()
                .any(|condition| condition.means[i].is_some())
        })
        .collect();
    let quantities = shown.iter().map(|&i| &QUANTITIES[i]);
    let quantities = quantities.map(|quantity| Column::new(quantity.name, quantity.unit));
    let keys = study.keys();
    let keys = keys.map(|key| Column::new(key, &unit_of(key).unwrap_or_default()));
    let is_any_unsteady = is_any_unsteady(conditions);
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
        cells.extend(shown.iter().map(|&i| mean_cell(i, condition.means[i])));
        cells.extend(is_any_unsteady.then(|| unsteady_cell(&condition.unsteady)));
        cells
    };
    let intervals = if study.repeats() > 1 {
        ", with Student's 95 % interval over the runs"
    } else {
        "; one run has no interval"
    };
    Table {
        caption: format!("Means of the runs of a condition{intervals}"),
        columns: columns.collect(),
        rows: conditions.iter().take(SHOWN).map(row).collect(),
    }
}

/// A figure for every key swept over two values or more.
fn figures(study: &Study, conditions: &[Condition]) -> Vec<Figure> {
    if conditions.len() > DRAWN {
        return Vec::new();
    }
    let figure = |key| {
        let swept = SweptKey {
            key,
            keys: study.keys().collect(),
            conditions,
            methods: Vec::new(),
        };
        let caption = format!("Means of the steady state over {}.", swept.key_and_unit());
        Figure::new(sweep_figure(&swept, Layout::SCREEN), caption)
            .narrow(sweep_figure(&swept, Layout::TELEPHONE))
    };
    let keys = varied(study.keys(), conditions).into_iter();
    keys.map(figure).collect()
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
        let rates = unsteady
            .range()
            .map_or_else(String::new, |rates| format!(" ({rates})"));
        let drifting = counted("drifting", unsteady.drifting, quantity);
        let drifting = drifting.map(|text| text + &rates);
        drifting
            .into_iter()
            .chain(counted("too short", unsteady.too_short, quantity))
    });
    Cell::text(parts.collect::<Vec<String>>().join(", "))
}

fn mean_cell(quantity: usize, mean: Option<Mean>) -> Cell {
    let cut = |value| QUANTITIES[quantity].without_rounding(value);
    mean.map_or(Cell::Missing, |Mean { value, ci95 }| {
        let (value, ci95) = (cut(value), ci95.map(|ends| ends.map(cut)));
        ci95.map_or(Cell::Number(value), |ci95| Cell::Estimate(value, ci95))
    })
}
