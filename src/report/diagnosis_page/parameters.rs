//! What recalibration moved.

use super::DiagnosisReport;
use super::words;
use crate::diagnosis::parameter::{Coordinate, Parameter};
use crate::diagnosis::{Recalibrated, Verdict};
use crate::report::page::{Cell, Column, Section, Table};
use crate::scenario::Scenario;
use crate::table::four_digits;

/// Deviations of the normal distribution that hold 95 %.
const NORMAL_95: f64 = 1.959964;
/// Share [-] by which values that are one parameter's may differ and still be one.
const SAME: f64 = 1.0e-9;

/// Values in the scenario and recalibrated.
pub fn section(report: &DiagnosisReport) -> Section {
    let verdict = &report.diagnosis.verdict;
    let section = Section::new("Recalibrated parameters");
    if verdict.recalibration.is_empty() {
        return section.prose("The scenario has no parameter to recalibrate.");
    }
    let rows = verdict.recalibration.iter().filter_map(|alone| {
        let parameter = Parameter::find(&alone.name)?;
        Some(row(report.scenario, parameter, alone, verdict))
    });
    section
        .answer(answer(verdict))
        .prose(
            "Each parameter has a prior standard deviation, the unit of the offset. A parameter with several \
             values in the scenario is changed by one factor or one shift. The 95 % intervals are conditional on \
             the explanation.",
        )
        .table(Table {
            caption: "Parameters of the scenario, recalibrated without effects, and under the most probable explanation"
                .to_owned(),
            columns: vec![
                Column::new("parameter", ""),
                Column::new("what it is", ""),
                Column::new("unit", ""),
                Column::new("in the scenario", ""),
                Column::new("recalibrated", ""),
                Column::new("offset", "prior deviations"),
                Column::new("under the most probable explanation", ""),
            ],
            rows: rows.collect(),
        })
}

fn answer(verdict: &Verdict) -> String {
    let moved = verdict.recalibration.iter().filter(|it| {
        let offset: f64 = it.offset;
        offset.abs() > NORMAL_95 * it.deviation
    });
    let names: Vec<String> = moved.map(|it| it.name.clone()).collect();
    match names.len() {
        0 => "No parameter differs significantly: every interval contains the scenario's value."
            .to_owned(),
        1 => format!("One parameter moved: {}.", names[0]),
        count => format!(
            "{count} parameters moved: {}.",
            words::listed(&names, "and")
        ),
    }
}

fn row(
    scenario: &Scenario,
    parameter: &Parameter,
    alone: &Recalibrated,
    verdict: &Verdict,
) -> Vec<Cell> {
    let mut explained = verdict.parameters.iter();
    let explained = explained.find(|it| it.name == alone.name);
    let values = parameter.values(scenario);
    let unit = words::unit(parameter.unit);
    let [low, high] = [-NORMAL_95, NORMAL_95].map(|side| alone.offset + side * alone.deviation);
    let numbers = [alone.offset, low, high].map(four_digits);
    vec![
        Cell::Code(parameter.name.to_owned()),
        Cell::text(parameter.title),
        Cell::text(unit),
        in_scenario(&values),
        moved(parameter, &values, alone),
        Cell::Written(
            format!("{} [{}, {}]", numbers[0], numbers[1], numbers[2]),
            alone.offset,
        ),
        explained.map_or(Cell::Missing, |it| moved(parameter, &values, it)),
    ]
}

/// The value that all places have; none where they differ.
fn one_value(values: &[f64]) -> Option<f64> {
    let first = *values.first()?;
    let same = |value: &f64| (value - first).abs() <= SAME * first.abs();
    values.iter().all(same).then_some(first)
}

fn in_scenario(values: &[f64]) -> Cell {
    match one_value(values) {
        Some(value) => Cell::Number(value),
        None => Cell::text(
            values
                .iter()
                .map(|value| four_digits(*value))
                .collect::<Vec<_>>()
                .join(", "),
        ),
    }
}

/// Where a parameter is after recalibration: its value, a factor or a shift.
fn moved(parameter: &Parameter, values: &[f64], recalibrated: &Recalibrated) -> Cell {
    let offsets = [0.0, -NORMAL_95, NORMAL_95].map(|side| {
        let offset: f64 = recalibrated.offset + side * recalibrated.deviation;
        offset * parameter.sd
    });
    let [value, low, high] = match (parameter.coordinate, one_value(values)) {
        (Coordinate::Logarithm, Some(value)) => offsets.map(|offset| value * libm::exp(offset)),
        (Coordinate::Plain, Some(value)) => offsets.map(|offset| value + offset),
        (Coordinate::Logarithm, None) => offsets.map(libm::exp),
        (Coordinate::Plain, None) => offsets,
    };
    let sign = match (parameter.coordinate, one_value(values)) {
        (_, Some(_)) => return Cell::Estimate(value, [low, high]),
        (Coordinate::Logarithm, None) => "×",
        (Coordinate::Plain, None) => "shift ",
    };
    let [shown, low, high] = [value, low, high].map(four_digits);
    Cell::Written(format!("{sign}{shown} [{low}, {high}]"), value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn off(offset: f64) -> Recalibrated {
        Recalibrated {
            name: String::new(),
            offset,
            deviation: 0.0,
        }
    }

    fn value(cell: &Cell) -> f64 {
        match cell {
            Cell::Estimate(value, _) | Cell::Written(_, value) => *value,
            cell => panic!("{cell:?}"),
        }
    }

    #[test]
    fn a_factor_multiplies_and_a_shift_adds_prior_deviations() {
        let cohesion = Parameter::find("soil_cohesion").unwrap();
        let moved_by_one = moved(cohesion, &[200.0], &off(1.0));
        assert!((value(&moved_by_one) - 200.0 * libm::exp(cohesion.sd)).abs() < 1e-9);
        let angle = Parameter::find("soil_friction_angle").unwrap();
        let moved_by_two = moved(angle, &[30.0, 30.0], &off(-2.0));
        assert!((value(&moved_by_two) - (30.0 - 2.0 * angle.sd)).abs() < 1e-9);
    }

    #[test]
    fn several_values_move_by_one_factor() {
        let moduli = Parameter::find("soil_moduli").unwrap();
        let cell = moved(moduli, &[1.0e3, 1.0e6], &off(0.0));
        assert_eq!(cell, Cell::Written("×1.000 [1.000, 1.000]".to_owned(), 1.0));
    }
}
