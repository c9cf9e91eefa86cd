//! Terrain parameters and what they predict.

mod fits;

use super::{Drawing, Shown};
use crate::identification::{Force, Standing};
use crate::identification::{Parameter, TerrainParameters};
use crate::report::page::{Cell, Column, Figure, Section, Table};
use crate::report::{IdentifiedGround, force_curves, parameter_figure};
use crate::soil::{Soil, table_6};
use crate::statistics::Share;
use crate::study::identification::score::{
    Accuracy, CarriedScore, Choice, DriftScore, GroundScore, GroupScore, IdentificationScore,
    ModelScore, ParameterScore, PredictionScore, Source,
};
use crate::table::four_digits;
use crate::terrain::class::{TerrainLabel, Wtic};

impl Shown for IdentificationScore {
    fn stem(&self) -> Option<&'static str> {
        Some("identification")
    }

    /// The force errors by the model of the class recognised, beside those published.
    fn answer(&self) -> String {
        let errors = self.grounds.iter().filter_map(|ground| {
            let by_class =
                |model: &&ModelScore| model.choice == Choice::Recognized && model.groups > 0;
            let model = ground.models.iter().find(by_class)?;
            let published = self.published.map(|published| {
                let errors = Force::ALL.map(|force| published.error(ground.label.class(), force));
                format!(" (published {})", three(errors))
            });
            let errors = three(Force::ALL.map(|force| model.means.error(force)));
            let published = published.unwrap_or_default();
            Some(format!("{errors} % on {}{published}", ground.scenario))
        });
        let errors: Vec<String> = errors.collect();
        if errors.is_empty() {
            return "No model could be fitted.".to_owned();
        }
        let groups = || self.groups.iter();
        let rows: usize = groups().map(|group| group.rows).sum();
        let drifting = match groups().map(|group| group.not_steady).sum::<usize>() {
            0 => String::new(),
            drifting => {
                format!(
                    " {drifting} of {rows} rows are not steady: their parameters are less certain."
                )
            }
        };
        format!(
            "With the model of the recognised class, the errors of pull, load and torque of a condition are \
             {}.{drifting}",
            errors.join("; ")
        )
    }

    /// Errors, parameters, force curves, predictions.
    fn sections(&self) -> Vec<Section> {
        let mut sections = vec![
            Section::new("Force errors")
                .prose(
                    "Errors are mean absolute errors over mean absolute forces: on the fitted rows, on the means of a \
                     condition's rows, and by cross-validation. Scatter is the error expected from the uncertainties \
                     of the rows. Covered is the share of the forces left out that are within their 95 % interval.",
                )
                .table(force_errors(self)),
            parameters(self),
            fits::section(self),
        ];
        sections.extend(curves(self));
        sections.extend(predictions(self));
        sections.extend(carried(self));
        sections
    }

    /// The parameters of one group of every scenario: the first, or that at `from`.
    fn drawings(&self) -> Vec<Drawing> {
        vec![Drawing::new("parameters.svg", parameter_drawing(self))]
    }
}

fn three(values: [Option<f64>; 3]) -> String {
    values.map(percent).join(" / ")
}

fn percent(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), |value| format!("{value:.1}"))
}

/// The force errors of every ground and model, beside those published, a row a force.
pub fn force_errors(score: &IdentificationScore) -> Table {
    let rows = score.grounds.iter().flat_map(|ground| {
        let fitted = ground.models.iter().filter(|model| model.groups > 0);
        let models = fitted.flat_map(|model| {
            let name = model_name(ground, model);
            Force::ALL.map(|force| {
                let numbers = model_errors(model, force);
                row_of_force(ground, &name, force, numbers)
            })
        });
        let published = score.published.into_iter().flat_map(|published| {
            Force::ALL.map(|force| {
                // It stands for all rows of a ground: they were fitted.
                let error = percent_cell(published.error(ground.label.class(), force));
                let numbers = std::iter::once(error).chain(std::iter::repeat_n(Cell::Missing, 4));
                row_of_force(ground, "published", force, numbers)
            })
        });
        models.chain(published).collect::<Vec<_>>()
    });
    let errors = ["fitted", "means", "left out", "scatter of means", "covered"];
    Table {
        caption: "Errors of drawbar pull, load and driving torque".to_owned(),
        columns: Column::named(["scenario", "ground", "model", "force"])
            .into_iter()
            .chain(errors.map(|what| Column::new(what, "%")))
            .collect(),
        rows: rows.collect(),
    }
}

fn short(force: Force) -> &'static str {
    match force {
        Force::DrawbarPull => "pull",
        Force::Load => "load",
        Force::DrivingTorque => "torque",
    }
}

fn model_name(ground: &GroundScore, model: &ModelScore) -> String {
    let class = ground.label.class();
    let name = match model.choice {
        Choice::Recognized => "of the class recognised".to_owned(),
        Choice::Always(of) if of == class => of.to_string(),
        Choice::Always(of) => format!("{of} (wrong here)"),
    };
    // Else its errors would be read beside those of other fits.
    if model.groups < ground.groups {
        format!("{name}: {} of {} fits", model.groups, ground.groups)
    } else {
        name
    }
}

fn row_of_force(
    ground: &GroundScore,
    model: &str,
    force: Force,
    numbers: impl IntoIterator<Item = Cell>,
) -> Vec<Cell> {
    let names = [&ground.scenario, ground.label.as_str(), model, short(force)];
    names.into_iter().map(Cell::text).chain(numbers).collect()
}

fn model_errors(model: &ModelScore, force: Force) -> [Cell; 5] {
    [
        percent_cell(model.fitted.error(force)),
        percent_cell(model.means.error(force)),
        percent_cell(model.left_out.error(force)),
        percent_cell(model.means.scatter_percent.get(force)),
        covered(&model.left_out, force),
    ]
}

fn errors(accuracy: &Accuracy) -> [Cell; 3] {
    Force::ALL.map(|force| percent_cell(accuracy.error(force)))
}

fn covered(accuracy: &Accuracy, force: Force) -> Cell {
    let cell = |share: &Share| Cell::Written(format!("{:.0}", 100.0 * share.value), share.value);
    accuracy.covered.get(&force).map_or(Cell::Missing, cell)
}

fn percent_cell(value: Option<f64>) -> Cell {
    value.map_or(Cell::Missing, |value| {
        Cell::Written(percent(Some(value)), value)
    })
}

fn parameters(score: &IdentificationScore) -> Section {
    let section = Section::new("Identified parameters")
        .prose(
            "With the model of the recognised class, or of the label's class if none was recognised. Every model \
             replaces the wheel by its rim: the parameters include the effect of the lugs, and an interval need \
             not contain the soil's own value. Parameters that the loads do not identify have no interval.",
        )
        .figure(Figure::new(
            parameter_drawing(score),
            "Parameters and their 95 % intervals by ground; a diamond is the scenario's own value.",
        ))
        .table(identified_parameters(score));
    let section = match not_steady(score) {
        Some(table) => section.table(table),
        None => section,
    };
    if numbered(score) {
        section.table(numbers(score))
    } else {
        section
    }
}

/// Number of keys above which a fit is named by its number: their values would fill the table.
const KEYS: usize = 2;

fn numbered(score: &IdentificationScore) -> bool {
    score.groups.iter().any(|group| group.shared.len() > KEYS)
}

/// What each number of a fit stands for.
fn numbers(score: &IdentificationScore) -> Table {
    let keys = score.groups.iter().map(|group| &group.shared);
    let keys = keys.max_by_key(|shared| shared.len());
    let keys = keys.into_iter().flatten();
    let keys = keys.map(|(key, _)| last_part(key).replace('_', " "));
    let first = ["fit", "scenario"].map(str::to_owned);
    let row = |(number, group): (usize, &GroupScore)| {
        let values = group.shared.iter().map(|(_, value)| Cell::toml(value));
        let first = [Cell::Count(number as u64 + 1), Cell::text(&group.scenario)];
        first.into_iter().chain(values).collect()
    };
    let rows = score.groups.iter().enumerate().map(row);
    Table::of(first.into_iter().chain(keys), rows).captioned("Fits by number")
}

/// Of `sensors.vision.delay` the `delay`.
fn last_part(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or(key)
}

/// The parameters of one group of every ground, drawn.
pub fn parameter_drawing(score: &IdentificationScore) -> String {
    let ground = |group: &GroupScore| {
        let (_, parameters) = group.parameters()?;
        Some(IdentifiedGround {
            name: group.label.to_string(),
            label: group.label,
            parameters: parameters.iter().map(|it| it.identified).collect(),
            own: parameters.iter().map(|it| it.own).collect(),
        })
    };
    let grounds: Vec<IdentifiedGround> = score.references().filter_map(ground).collect();
    parameter_figure(&grounds)
}

/// The parameters of every group with their intervals, beside the scenario's own and, where the study
/// has published errors, beside those of Table 6.
pub fn identified_parameters(score: &IdentificationScore) -> Table {
    let is_beside = score.published.is_some();
    let numbered = numbered(score);
    let rows = score.groups.iter().enumerate().flat_map(|(number, group)| {
        let fit = fit_cell(numbered, number, group);
        let (class, parameters) = group.parameters().unwrap_or((Wtic::Uwtic, &[]));
        let row = move |score: &ParameterScore| {
            let mut cells = vec![fit.clone()];
            cells.push(Cell::text(class.as_str()));
            cells.push(Cell::text(score.parameter.name()));
            cells.push(Cell::text(score.unit));
            cells.push(value(score));
            cells.push(score.own.map_or(Cell::Missing, Cell::Number));
            if is_beside {
                let published = table_6_value(group.label, score.parameter);
                cells.push(published.map_or(Cell::Missing, Cell::Number));
            }
            cells
        };
        parameters.iter().map(row)
    });
    let mut names = vec![
        "fit",
        "model",
        "parameter",
        "unit",
        "identified",
        "the scenario's own",
    ];
    if is_beside {
        names.push("the paper's ground (Table 6)");
    }
    Table::of(names, rows)
        .captioned("Parameters with their 95 % intervals; in brackets if not identifiable")
}

/// The name of a fit, or its number.
fn fit_cell(numbered: bool, number: usize, group: &GroupScore) -> Cell {
    if numbered {
        Cell::Count(number as u64 + 1)
    } else {
        Cell::Text(place(&group.scenario, &group.shared))
    }
}

/// What still changes in the rows of every group; none where all are steady.
pub fn not_steady(score: &IdentificationScore) -> Option<Table> {
    let numbered = numbered(score);
    let rows = score.groups.iter().enumerate().flat_map(|(number, group)| {
        group.drifts.iter().map(move |drift| {
            vec![
                fit_cell(numbered, number, group),
                Cell::text(drift.channel),
                Cell::Count(drift.rows as u64),
                Cell::Count(group.rows as u64),
                rate_cell(drift),
                Cell::text(&drift.unit),
            ]
        })
    });
    let columns = [
        "fit",
        "not steady",
        "in rows",
        "of",
        "rate: mean [least, greatest]",
        "unit",
    ];
    let table = Table::of(columns, rows).captioned(
        "Rows whose values still change along their interval; the change is in their uncertainty",
    );
    (!table.rows.is_empty()).then_some(table)
}

/// The mean rate, with the least and the greatest where there are several.
fn rate_cell(drift: &DriftScore) -> Cell {
    let [mean, least, greatest] = [drift.rate, drift.rates[0], drift.rates[1]].map(four_digits);
    let range = match drift.rows {
        1 => String::new(),
        _ => format!(" [{least}, {greatest}]"),
    };
    Cell::Written(format!("{mean}{range}"), drift.rate)
}

fn value(score: &ParameterScore) -> Cell {
    let text = four_digits(score.value);
    match (score.identifiable, score.ci95) {
        (false, _) if score.identified.standing == Standing::NotIdentifiable => {
            Cell::Written(format!("({text})"), score.value)
        }
        (false, _) => Cell::Written(format!("{text}, set"), score.value),
        (true, [Some(low), Some(high)]) if low == high => {
            Cell::Written(format!("{text}, set"), score.value)
        }
        (true, [low, high]) => {
            let ends = [
                low.unwrap_or(f64::NEG_INFINITY),
                high.unwrap_or(f64::INFINITY),
            ];
            Cell::Estimate(score.value, ends)
        }
    }
}

/// What the paper identified on its own ground of this label; 0 where its class fixes it.
fn table_6_value(label: TerrainLabel, parameter: Parameter) -> Option<f64> {
    let soil: Soil = match label {
        TerrainLabel::Hard => table_6::hard(),
        TerrainLabel::Gravel => table_6::gravel(),
        TerrainLabel::Sand => table_6::sand(),
        _ => return None,
    };
    // Its cohesive modulus is 0: the width of the wheel does not matter.
    let width = 1.0;
    Some(TerrainParameters::of(&soil, width).get(parameter))
}

fn place(scenario: &str, shared: &[(String, String)]) -> String {
    let values = shared
        .iter()
        .map(|(key, value)| format!(", {} = {value}", last_part(key)));
    format!("{scenario}{}", values.collect::<String>())
}

fn curves(score: &IdentificationScore) -> Option<Section> {
    let figures = score.references().filter_map(|group| {
        let source = group.source.as_ref()?;
        let Source {
            estimate, loads, ..
        } = source;
        let title = format!("{}: measured and fitted forces", group.scenario);
        let caption = format!("{} steady rows of {}.", loads.len(), group.scenario);
        Some(Figure::new(
            force_curves(&title, estimate, &source.predictor()?, loads),
            caption,
        ))
    });
    let figures: Vec<Figure> = figures.collect();
    let section = Section::new("Forces against slip");
    (!figures.is_empty()).then(|| figures.into_iter().fold(section, Section::figure))
}

fn predictions(score: &IdentificationScore) -> Option<Section> {
    if score.predictions.is_empty() {
        return None;
    }
    let key = score.predictions[0].shared.first();
    let row = |score: &PredictionScore| {
        let beyond: Vec<&str> = score.beyond.iter().map(|force| force.name()).collect();
        let first = score.shared.first().map(|(_, value)| value.as_str());
        let mut cells = vec![
            Cell::text(&score.scenario),
            first.map_or(Cell::Missing, Cell::toml),
            Cell::text(score.class.as_str()),
        ];
        cells.extend(errors(&score.accuracy));
        cells.extend(Force::ALL.map(|force| covered(&score.accuracy, force)));
        cells.push(Cell::Text(beyond.join(", ")));
        cells
    };
    let forces = ["error", "covered"].iter().flat_map(|what| {
        Force::ALL.map(|force| Column::new(format!("{what}, {}", short(force)), "%"))
    });
    let first = ["scenario", key.map_or("at", |(key, _)| key), "model"];
    Some(
        Section::new("Prediction at other conditions").table(Table {
            caption: "Forces predicted by the parameters from the reference condition".to_owned(),
            columns: Column::named(first)
                .into_iter()
                .chain(forces)
                .chain([Column::new("above twice the published error", "")])
                .collect(),
            rows: score.predictions.iter().map(row).collect(),
        }),
    )
}

fn carried(score: &IdentificationScore) -> Option<Section> {
    let row = |score: &CarriedScore| {
        let mut cells = vec![Cell::text(&score.from), Cell::text(&score.to)];
        cells.extend(errors(&score.accuracy));
        cells
    };
    let forces = Force::ALL.map(|force| Column::new(format!("error, {}", short(force)), "%"));
    let table = Table {
        caption: "Forces predicted by the parameters of another ground".to_owned(),
        columns: Column::named(["found on", "kept on"])
            .into_iter()
            .chain(forces)
            .collect(),
        rows: score.carried.iter().map(row).collect(),
    };
    let section = Section::new("Transfer of parameters to another ground");
    (!table.rows.is_empty()).then(|| section.table(table))
}
