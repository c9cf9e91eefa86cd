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
    Section::new("Compared conditions and statistics")
        .prose(format!(
            "Training data: {} random rigs of this layout, {:.0} s of driving; their parameters and effects are \
             drawn from the priors.",
            compared.rigs, compared.driven
        ))
        .table(Table {
            caption: "Conditions".to_owned(),
            columns: Column::named(["condition", "measured runs", "statistics that both sides have"]),
            rows: rows.collect(),
        })
}
