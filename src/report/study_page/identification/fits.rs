//! What every fit rests on: its rows, the class recognised, the remarks on each model, repeats fitted alone.

use super::{fit_cell, numbered};
use crate::recognition::confusion::CLASSES;
use crate::report::page::{Cell, Section, Table};
use crate::statistics::Share;
use crate::study::identification::score::{
    FitOutcome, FitScore, GroupScore, IdentificationScore, RepeatScore,
};

/// Rows, recognition, models and repeats of every fit.
pub(super) fn section(score: &IdentificationScore) -> Section {
    Section::new("Rows and quality of the fits")
        .table(rows(score))
        .table(models(score))
        .table(without(score))
        .table(repeats(score))
}

/// The fits with their cells of names.
fn fits(score: &IdentificationScore) -> impl Iterator<Item = (Cell, &GroupScore)> {
    let numbered = numbered(score);
    let groups = score.groups.iter().enumerate();
    groups.map(move |(number, group)| (fit_cell(numbered, number, group), group))
}

fn rows(score: &IdentificationScore) -> Table {
    let row = |(fit, group): (Cell, &GroupScore)| {
        let mut cells = vec![fit, Cell::text(group.label.as_str())];
        cells.extend([group.rows, group.above_ground].map(|count| Cell::Count(count as u64)));
        cells.extend(group.answers.map(Cell::Count));
        cells.extend([group.recognized, group.label.class()].map(|it| Cell::text(it.as_str())));
        cells
    };
    let names = ["fit", "ground", "rows", "rim above ground"].into_iter();
    let names = names.chain(CLASSES.map(|class| class.as_str()));
    Table::of(
        names.chain(["recognised", "nominal class"]),
        fits(score).map(row),
    )
    .captioned(
        "Steady rows, windows by class answered, the class recognised and that of the ground",
    )
}

/// A row for every model fitted, and for every remark on it.
fn models(score: &IdentificationScore) -> Table {
    let rows = fits(score).flat_map(|(fit, group)| {
        let models = group.fits.iter();
        models.flat_map(move |model| of_model(&fit, model))
    });
    Table::of(["fit", "model", "reduced chi-square", "remarks"], rows)
        .captioned("Fits of every model; without a number it could not be fitted")
}

fn of_model(fit: &Cell, FitScore { class, outcome }: &FitScore) -> Vec<Vec<Cell>> {
    let (chi_square, remarks) = match outcome {
        FitOutcome::Refused(reason) => (Cell::Missing, vec![reason.as_str()]),
        FitOutcome::Found(found) => {
            let remarks = found.combinations.iter().chain(&found.warnings);
            let remarks = remarks.map(String::as_str).collect();
            (Cell::Number(found.reduced_chi_square), remarks)
        }
    };
    // An empty number leaves its column one of numbers.
    let blank = Cell::Written(String::new(), f64::NAN);
    let numbers = std::iter::once(chi_square).chain(std::iter::repeat(blank));
    let count = remarks.len().max(1);
    let remarks = remarks.into_iter().chain(std::iter::repeat(""));
    let rows = numbers.zip(remarks).take(count);
    rows.map(|(number, remark)| {
        let model = Cell::text(class.as_str());
        vec![fit.clone(), model, number, Cell::text(remark)]
    })
    .collect()
}

fn without(score: &IdentificationScore) -> Table {
    let rows = fits(score).flat_map(|(fit, group)| {
        let without = group.without.iter();
        without.map(move |(run, reason)| vec![fit.clone(), Cell::Count(*run), Cell::text(reason)])
    });
    Table::of(["fit", "run", "reason"], rows).captioned("Runs without a steady row")
}

/// Empty where no condition was repeated.
fn repeats(score: &IdentificationScore) -> Table {
    let share = |share: Option<Share>| {
        let of = |Share { value, n, .. }: Share| {
            let held = (value * n as f64).round();
            Cell::Written(format!("{held} of {n}"), value)
        };
        share.map_or(Cell::Missing, of)
    };
    let rows = fits(score).flat_map(|(fit, group)| {
        group.repeats.iter().map(move |repeat: &RepeatScore| {
            let counts = [repeat.fits, repeat.identified].map(|count| Cell::Count(count as u64));
            let numbers = [repeat.deviation, repeat.half_width];
            let mut cells = vec![fit.clone(), Cell::text(repeat.parameter.name())];
            cells.extend(counts);
            cells.extend(numbers.map(|number| number.map_or(Cell::Missing, Cell::Number)));
            cells.extend([repeat.holds_mean, repeat.holds_own].map(share));
            cells
        })
    });
    let columns = [
        "fit",
        "parameter",
        "repeats",
        "identified",
        "deviation",
        "half-width",
        "intervals with the mean",
        "with the scenario's own",
    ];
    Table::of(columns, rows).captioned(
        "Repeats fitted alone: standard deviation and mean half-width of the 95 % interval in ln k_s, ln c, ln K and \
         phi [rad]",
    )
}
