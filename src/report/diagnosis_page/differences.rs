//! Where measured and simulated runs differ.

use super::DiagnosisReport;
use super::{units, words};
use crate::gap::{Colour, Entry, GapMap};
use crate::report::gap_map;
use crate::report::page::{Cell, Column, Figure, Section, Table};

/// The map as shipped, and what recalibration leaves.
pub fn section(report: &DiagnosisReport) -> Section {
    let diagnosis = report.diagnosis;
    let map = GapMap {
        global: diagnosis.global.clone(),
        entries: diagnosis.map.clone(),
        caveats: Vec::new(),
    };
    let section = Section::new("Gap map")
        .answer(answer(&map))
        .prose(
            "Rows are channels, columns domains of statistics: time, wheel orders (order), lug pass (lug), \
             frequency, pairs of channels (cross), vibration features, steady loads, dependence on distance \
             (history), curves over all runs. A field contains its strongest statistic with z, the difference \
             over its standard error; vermilion is a gap, green is equivalent, grey is undecided. The strip below \
             it has one part per condition.",
        );
    let title = format!("{} against {} (nominal)", report.measured, report.name);
    let section = if map.entries.is_empty() {
        section.prose("Measurement and simulation have no statistic in common.")
    } else {
        section.figure(Figure::new(
            gap_map(&map, &title),
            "The gap map, before any recalibration.",
        ))
    };
    let located = located(report);
    if located.rows.is_empty() {
        return section.prose("After recalibration no statistic differs significantly.");
    }
    section.table(located)
}

fn answer(map: &GapMap) -> String {
    let gaps = map.count(Colour::Gap);
    let all = map.entries.len();
    let strongest = map
        .entries
        .iter()
        .filter(|entry| entry.colour == Colour::Gap);
    let strongest = strongest.max_by(|a, b| a.z.abs().total_cmp(&b.z.abs()));
    match strongest {
        Some(entry) => format!(
            "{gaps} of {all} statistics differ, strongest the {} at {} (z = {}).",
            words::cell(&entry.cell),
            entry.condition,
            signed(entry.z)
        ),
        None => format!("None of {all} statistics is shown to differ."),
    }
}

fn signed(z: f64) -> String {
    format!("{z:+.1}").replace('-', "−")
}

/// Strongest cells after recalibration, beside their difference as shipped.
fn located(report: &DiagnosisReport) -> Table {
    let diagnosis = report.diagnosis;
    let rows = diagnosis.verdict.located.iter().map(|located| {
        let entry = diagnosis
            .map
            .iter()
            .find(|entry| entry.cell == located.cell && entry.condition == located.condition);
        let [difference, unit] = entry.map_or([Cell::Missing, Cell::Missing], as_shipped);
        vec![
            Cell::text(words::channel(&located.cell.channel)),
            Cell::text(words::statistic(located.cell.statistic)),
            Cell::text(located.condition.to_string()),
            Cell::Written(signed(located.deviations), located.deviations),
            difference,
            unit,
        ]
    });
    Table {
        caption: "Strongest remaining statistics after recalibration, on held-out conditions, and their difference as \
         shipped with its 95 % interval"
            .to_owned(),
        columns: vec![
            Column::new("channel", ""),
            Column::new("statistic", ""),
            Column::new("condition", ""),
            Column::new("left after recalibration", "deviations"),
            Column::new("measured minus nominal", ""),
            Column::new("unit", ""),
        ],
        rows: rows.collect(),
    }
}

/// Difference with its interval, and its unit.
fn as_shipped(entry: &Entry) -> [Cell; 2] {
    let (unit, factor) = units::shown(&entry.unit);
    let half = units::half_width(entry);
    let ends = [entry.difference - half, entry.difference + half];
    [
        Cell::Estimate(factor * entry.difference, ends.map(|end| factor * end)),
        Cell::text(unit),
    ]
}
