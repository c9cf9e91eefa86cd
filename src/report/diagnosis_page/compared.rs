//! What was compared, and what it took.

use crate::diagnosis::Diagnosis;
use crate::report::page::{Cell, Column, Section, Table};

/// Conditions with their runs, and how much was simulated.
pub fn section(diagnosis: &Diagnosis) -> Section {
    let compared = &diagnosis.compared;
    let rows = compared.conditions.iter().map(|condition| {
        vec![
            Cell::text(&condition.condition),
            Cell::Count(condition.runs as u64),
            Cell::Count(condition.cells as u64),
        ]
    });
    let depth = compared.depth;
    Section::new("What was compared?")
        .prose(format!(
            "Simulated: {} replicates of every condition as shipped; every parameter a standard deviation up \
             and down, and every effect at {} magnitude(s), with {} stream(s) of ground and noise each. With \
             nothing kept from before that takes {}.",
            depth.replicates, depth.levels, depth.streams, compared.cost
        ))
        .table(Table {
            caption: "Conditions".to_owned(),
            columns: Column::named(["condition", "measured runs", "statistics that both sides have"]),
            rows: rows.collect(),
        })
}
