//! How far the gap closes.

use super::words::{self, listed, percent};
use crate::diagnosis::{Diagnosis, Shrinkage};
use crate::gap::Closed;
use crate::report::gap_waterfall;
use crate::report::page::{Cell, Column, Figure, Section, Table};

/// The waterfall, its numbers, and what simulations of the answer gave.
pub fn section(diagnosis: &Diagnosis) -> Section {
    let section = Section::new("How far does the gap close?");
    let Some(shrinkage) = &diagnosis.verdict.shrinkage else {
        return section.prose("No effect could be tried, so nothing was closed.");
    };
    let added = listed(&shrinkage.effects, "and");
    let section = section.answer(answer(shrinkage, &added)).figure(Figure::new(
        gap_waterfall(shrinkage, &added),
        "Scores of conditions that the fit has not seen: each condition is predicted by what the others \
         tell. A score is the mean distance of a measured run from simulated ones, counted in spreads of \
         replicates per statistic, less half of their own.",
    ));
    section
        .prose(placebo(shrinkage))
        .table(scores(shrinkage, &added))
        .table(simulated_again(diagnosis))
}

fn answer(shrinkage: &Shrinkage, added: &str) -> String {
    match shrinkage.closed {
        Some(closed) => format!(
            "{added} closes {} of what recalibration leaves of the gap{}.",
            percent(closed.value),
            interval(&closed)
        ),
        None => "Recalibration leaves no gap that an effect could close.".to_owned(),
    }
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

fn placebo(shrinkage: &Shrinkage) -> String {
    let Some(placebo) = shrinkage.placebo else {
        return "There is no other effect to compare that with.".to_owned();
    };
    let told = percent(placebo);
    let Some(closed) = shrinkage.closed else {
        return format!("The best of the other effects would close {told}.");
    };
    let judged = match closed.value > placebo {
        true => "less, as it should be: the closure is not that of just any effect added",
        false => "no less: the closure says nothing for this effect",
    };
    format!("The best of the other effects that can be told from it would close {told}, {judged}.")
}

fn scores(shrinkage: &Shrinkage, added: &str) -> Table {
    let row = |name: &str, score: f64| vec![Cell::text(name), Cell::Number(score)];
    let floor = match shrinkage.floor_is_measured {
        true => "floor, from measured repeats",
        false => "floor, from simulated replicates",
    };
    Table {
        caption:
            "Mean energy scores on held-out conditions, in spreads of replicates per statistic"
                .to_owned(),
        columns: Column::named(["simulator", "score"]),
        rows: vec![
            row("as shipped", shrinkage.as_shipped),
            row("recalibrated", shrinkage.recalibrated),
            row(&format!("with {added}"), shrinkage.with_effect),
            row(floor, shrinkage.floor),
        ],
    }
}

fn simulated_again(diagnosis: &Diagnosis) -> Table {
    let rows = diagnosis.again.iter().map(|again| {
        let kept = match again.as_predicted {
            true => "yes",
            false => "no: the scores above promise too much",
        };
        vec![
            Cell::text(words::arm(&again.arm)),
            Cell::Number(again.gap),
            Cell::text(kept),
        ]
    });
    Table {
        caption: "The fits simulated again, fitted to all conditions, to check what was predicted"
            .to_owned(),
        columns: Column::named(["simulated", "score", "as predicted"]),
        rows: rows.collect(),
    }
}
