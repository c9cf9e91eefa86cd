//! How far the gap closes.

use super::words::{listed, percent};
use crate::diagnosis::{Diagnosis, Gaps};
use crate::gap::Closed;
use crate::report::gap_waterfall;
use crate::report::page::{Cell, Column, Figure, Section, Table};

/// The waterfall and its numbers.
pub fn section(diagnosis: &Diagnosis) -> Section {
    let section = Section::new("Shrinkage of the gap");
    let Some(gaps) = &diagnosis.gap else {
        return section.prose("The variants of the scenario could not be simulated.");
    };
    let added = if diagnosis.closed_with.is_empty() {
        "no effect".to_owned()
    } else {
        listed(&diagnosis.closed_with, "and")
    };
    section
        .answer(answer(diagnosis.closed, &added))
        .figure(Figure::new(
            gap_waterfall(gaps, diagnosis.closed, &added),
            "The score is the energy score: mean distance of a measured run from simulated runs of the same \
             condition, in scatters per statistic, less half the mean distance between these. Parameters and \
             magnitudes are fitted to all conditions.",
        ))
        .table(scores(gaps, &added))
}

fn answer(closed: Option<Closed>, added: &str) -> String {
    match closed {
        Some(closed) => format!("{}.", of_the_gap(&closed, added)),
        None => "No gap remains after recalibration.".to_owned(),
    }
}

/// How much of the gap is closed by what is added.
pub fn of_the_gap(closed: &Closed, added: &str) -> String {
    format!(
        "{added} closes {} of the gap that remains after recalibration{}",
        percent(closed.value),
        interval(closed)
    )
}

fn interval(closed: &Closed) -> String {
    if closed.clusters < 2 {
        return ", from one condition and so without an interval".to_owned();
    }
    let [low, high] = closed.ci95.map(percent);
    format!(
        " (95 % interval {low} to {high}, over {} conditions and days)",
        closed.clusters
    )
}

fn scores(gaps: &Gaps, added: &str) -> Table {
    let row = |name: &str, score: f64| vec![Cell::text(name), Cell::Number(score)];
    Table {
        caption: "Mean energy scores of simulated runs, in scatters per statistic".to_owned(),
        columns: Column::named(["simulator", "score"]),
        rows: vec![
            row("as shipped", gaps.as_shipped),
            row("recalibrated", gaps.recalibrated),
            row(&format!("with {added}"), gaps.with_effect),
            row("floor", gaps.floor),
        ],
    }
}
