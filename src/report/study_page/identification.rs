//! Terrain parameters and what they predict.

use super::value_cell;
use crate::identification::{Force, Standing};
use crate::identification::{Parameter, TerrainParameters};
use crate::recognition::confusion::Share;
use crate::report::page::{Cell, Column, Figure, Section, Table, four_digits};
use crate::report::{IdentifiedGround, force_curves, parameter_figure};
use crate::soil::{Soil, table_6};
use crate::study::identification::Published;
use crate::study::identification::score::{
    Accuracy, CarriedScore, Choice, GroundScore, GroupScore, IdentificationScore, ModelScore,
    ParameterScore, PredictionScore, Source,
};
use crate::terrain::class::{TerrainLabel, Wtic};

/// The force errors by the model of the class recognised, beside those published.
pub fn answer(score: &IdentificationScore) -> String {
    let told = score.grounds.iter().filter_map(|ground| {
        let by_class = |model: &&ModelScore| model.choice == Choice::Recognized && model.groups > 0;
        let model = ground.models.iter().find(by_class)?;
        let published = score.published.map(|published| {
            let errors = Force::ALL.map(|force| published.error(ground.label.class(), force));
            format!(" (published {})", three(errors))
        });
        let errors = three(Force::ALL.map(|force| model.means.error(force)));
        let published = published.unwrap_or_default();
        Some(format!("{errors} % on {}{published}", ground.scenario))
    });
    let told: Vec<String> = told.collect();
    if told.is_empty() {
        return "No model could be fitted.".to_owned();
    }
    format!(
        "By the model of the class recognised, pull, load and torque of a condition come back within {}.",
        told.join("; ")
    )
}

fn three(values: [Option<f64>; 3]) -> String {
    values.map(percent).join(" / ")
}

fn percent(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), |value| format!("{value:.1}"))
}

/// Errors, parameters, force curves, predictions.
pub fn sections(score: &IdentificationScore) -> Vec<Section> {
    let mut sections = vec![
        Section::new("How well do the forces come back?")
            .prose(
                "Errors are the mean size of the error over the mean size of the force: on the rows fitted, on the \
                 means of a condition's rows, and on rows left out of the fit in turn. Scatter is what the rows' own \
                 uncertainties would leave of error. Covered is the share of the forces left out that lie within \
                 their 95 % interval.",
            )
            .table(force_errors(score)),
        parameters(score),
    ];
    sections.extend(curves(score));
    sections.extend(predictions(score));
    sections.extend(carried(score));
    sections
}

/// The force errors of every ground and model, beside those published.
pub fn force_errors(score: &IdentificationScore) -> Table {
    let rows = score.grounds.iter().flat_map(|ground| {
        let fitted = ground.models.iter().filter(|model| model.groups > 0);
        let models = fitted.map(|model| model_row(ground, model));
        let published = score
            .published
            .map(|published| published_row(ground, &published));
        models.chain(published).collect::<Vec<_>>()
    });
    let of_forces = ["fitted", "means", "left out", "scatter of means", "covered"];
    let columns = of_forces.iter().flat_map(|what| {
        Force::ALL.map(|force| Column::new(format!("{what}, {}", short(force)), "%"))
    });
    Table {
        caption: "Errors of drawbar pull, load and driving torque".to_owned(),
        columns: Column::named(["scenario", "ground", "model"])
            .into_iter()
            .chain(columns)
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

fn model_row(ground: &GroundScore, model: &ModelScore) -> Vec<Cell> {
    let class = ground.label.class();
    let name = match model.choice {
        Choice::Recognized => "of the class recognised".to_owned(),
        Choice::Always(of) if of == class => of.to_string(),
        Choice::Always(of) => format!("{of} (wrong here)"),
    };
    // Else its errors would be read beside those of other fits.
    let name = match model.groups < ground.groups {
        true => format!("{name}: {} of {} fits", model.groups, ground.groups),
        false => name,
    };
    let ModelScore {
        fitted,
        means,
        left_out,
        ..
    } = model;
    let mut cells = first_cells(ground, name);
    for accuracy in [fitted, means, left_out] {
        cells.extend(errors(accuracy));
    }
    cells.extend(Force::ALL.map(|force| percent_cell(means.scatter_percent.get(force))));
    cells.extend(covered(left_out));
    cells
}

/// The published errors stand for all rows of a ground: they were fitted.
fn published_row(ground: &GroundScore, published: &Published) -> Vec<Cell> {
    let errors = Force::ALL.map(|force| percent_cell(published.error(ground.label.class(), force)));
    let mut cells = first_cells(ground, "published".to_owned());
    cells.extend(errors);
    cells.extend(std::iter::repeat_n(Cell::Missing, 12));
    cells
}

fn first_cells(ground: &GroundScore, model: String) -> Vec<Cell> {
    vec![
        Cell::text(&ground.scenario),
        Cell::text(ground.label.as_str()),
        Cell::Text(model),
    ]
}

fn errors(accuracy: &Accuracy) -> [Cell; 3] {
    Force::ALL.map(|force| percent_cell(accuracy.error(force)))
}

fn covered(accuracy: &Accuracy) -> [Cell; 3] {
    Force::ALL.map(|force| {
        let share = accuracy.covered.get(&force);
        let told =
            |share: &Share| Cell::Written(format!("{:.0}", 100.0 * share.value), share.value);
        share.map_or(Cell::Missing, told)
    })
}

fn percent_cell(value: Option<f64>) -> Cell {
    value.map_or(Cell::Missing, |value| {
        Cell::Written(percent(Some(value)), value)
    })
}

fn parameters(score: &IdentificationScore) -> Section {
    Section::new("Which parameters does the ground have?")
        .prose(
            "By the model of the class recognised, or of the label's class where none was. A rim stands for the wheel \
             in every model: what lugs do is in the parameters, so that an interval need not hold the soil's own \
             value. Where the loads do not fix a parameter, it has no interval.",
        )
        .figure(Figure::new(
            parameter_drawing(score),
            "Parameters and their 95 % intervals by ground; a diamond is the scenario's own value.",
        ))
        .table(identified_parameters(score))
}

/// The parameters of one group of every ground, drawn.
pub fn parameter_drawing(score: &IdentificationScore) -> String {
    let ground = |group: &GroupScore| {
        let (_, parameters) = group.parameters()?;
        Some(IdentifiedGround {
            name: group.label.to_string(),
            label: group.label,
            parameters: parameters.iter().map(|told| told.identified).collect(),
            own: parameters.iter().map(|told| told.own).collect(),
        })
    };
    let grounds: Vec<IdentifiedGround> = score.references().filter_map(ground).collect();
    parameter_figure(&grounds)
}

/// The parameters of every group with their intervals, beside the scenario's own and, where the study
/// has published errors, beside those of Table 6.
pub fn identified_parameters(score: &IdentificationScore) -> Table {
    let is_beside = score.published.is_some();
    let rows = score.groups.iter().flat_map(|group| {
        let (class, parameters) = group.parameters().unwrap_or((Wtic::Uwtic, &[]));
        let row = move |told: &ParameterScore| {
            let mut cells = vec![Cell::text(place(&group.scenario, &group.shared))];
            cells.push(Cell::text(class.as_str()));
            cells.push(Cell::text(told.parameter.name()));
            cells.push(Cell::text(told.unit));
            cells.push(value(told));
            cells.push(told.own.map_or(Cell::Missing, Cell::Number));
            if is_beside {
                let published = table_6_value(group.label, told.parameter);
                cells.push(published.map_or(Cell::Missing, Cell::Number));
            }
            cells
        };
        parameters.iter().map(row)
    });
    let mut names = vec![
        "fitted",
        "model",
        "parameter",
        "unit",
        "identified",
        "the scenario's own",
    ];
    if is_beside {
        names.push("the paper's ground (Table 6)");
    }
    Table {
        caption:
            "Parameters with their 95 % intervals; in brackets where the loads do not fix them"
                .to_owned(),
        columns: Column::named(names),
        rows: rows.collect(),
    }
}

fn value(told: &ParameterScore) -> Cell {
    let text = four_digits(told.value);
    match (told.identifiable, told.ci95) {
        (false, _) if told.identified.standing == Standing::NotIdentifiable => {
            Cell::Written(format!("({text})"), told.value)
        }
        (false, _) => Cell::Written(format!("{text}, set"), told.value),
        (true, [Some(low), Some(high)]) if low == high => {
            Cell::Written(format!("{text}, set"), told.value)
        }
        (true, [low, high]) => {
            let ends = [
                low.unwrap_or(f64::NEG_INFINITY),
                high.unwrap_or(f64::INFINITY),
            ];
            Cell::Estimate(told.value, ends)
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
        .map(|(key, value)| format!(", {key} = {value}"));
    format!("{scenario}{}", values.collect::<String>())
}

fn curves(score: &IdentificationScore) -> Option<Section> {
    let figures = score.references().filter_map(|group| {
        let source = group.source.as_ref()?;
        let Source {
            estimate, loads, ..
        } = source;
        let title = format!(
            "{}: forces and what its parameters give back",
            group.scenario
        );
        let caption = format!("{} steady rows of {}.", loads.len(), group.scenario);
        Some(Figure::new(
            force_curves(&title, estimate, &source.predictor()?, loads),
            caption,
        ))
    });
    let figures: Vec<Figure> = figures.collect();
    let section = Section::new("Do the forces follow the slip?");
    (!figures.is_empty()).then(|| figures.into_iter().fold(section, Section::figure))
}

fn predictions(score: &IdentificationScore) -> Option<Section> {
    if score.predictions.is_empty() {
        return None;
    }
    let key = score.predictions[0].shared.first();
    let row = |told: &PredictionScore| {
        let beyond: Vec<&str> = told.beyond.iter().map(|force| force.name()).collect();
        let first = told.shared.first().map(|(_, value)| value.as_str());
        let mut cells = vec![
            Cell::text(&told.scenario),
            first.map_or(Cell::Missing, value_cell),
            Cell::text(told.class.as_str()),
        ];
        cells.extend(errors(&told.accuracy));
        cells.extend(covered(&told.accuracy));
        cells.push(Cell::Text(beyond.join(", ")));
        cells
    };
    let forces = ["error", "covered"].iter().flat_map(|what| {
        Force::ALL.map(|force| Column::new(format!("{what}, {}", short(force)), "%"))
    });
    let first = ["scenario", key.map_or("at", |(key, _)| key), "model"];
    Some(
        Section::new("How far do the parameters predict?").table(Table {
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
    let row = |told: &CarriedScore| {
        let mut cells = vec![Cell::text(&told.from), Cell::text(&told.to)];
        cells.extend(errors(&told.accuracy));
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
    let section = Section::new("What is it worth to identify anew on new ground?");
    (!table.rows.is_empty()).then(|| section.table(table))
}
