//! What the gap does to forces, features, class and terrain.

use super::DiagnosisReport;
use super::units::shown;
use super::words;
use crate::diagnosis::{EndResults, Step};
use crate::gap::stages::{Stage, Stages};
use crate::report::page::{Cell, Column, Section, Table};

/// Errors of end results by step, and which part of the measurements brings them.
pub fn section(report: &DiagnosisReport) -> Option<Section> {
    let steps = &report.diagnosis.end_results;
    let shipped = steps.first()?;
    let rows = rows(shipped, steps);
    if rows.is_empty() {
        return None;
    }
    let mut columns = Column::named(["result", "unit"]);
    columns.extend(steps.iter().map(|it| Column::new(step(it.step), "")));
    let section = Section::new("Effect of the gap on forces, class and terrain")
        .prose(
            "Errors of the end results of a simulation, with parameters and magnitudes fitted to all conditions: \
             root mean square errors of steady means, distance of the features' logarithms, share of windows with \
             another class, and distance between the terrain parameters identified from both sides, in units of \
             an uninformative interval.",
        )
        .table(Table {
            caption: "Errors of end results, means over conditions".to_owned(),
            columns,
            rows,
        });
    let shares = shares(report);
    if shares.is_empty() {
        return Some(section);
    }
    let section = section
        .prose(
            "Contributions of the parts of the input to the distance: each part of the simulated input is \
             replaced by the measured one in every combination, and its contribution averaged over all orders \
             (Shapley 1953). The shares sum to one; a negative share reduces the distance.",
        )
        .table(Table {
            caption: "Shares of the parts of the input in the errors of features, class and terrain".to_owned(),
            columns: Column::named(["result", "simulator", "measured part", "share of its error"]),
            rows: shares,
        });
    Some(section)
}

fn rows(shipped: &EndResults, steps: &[EndResults]) -> Vec<Vec<Cell>> {
    let row = |name: String, unit: &str, of: &dyn Fn(&EndResults) -> Option<f64>| {
        let values = steps.iter().map(|step| match of(step) {
            Some(value) => Cell::Number(value),
            None => Cell::Missing,
        });
        let named = [Cell::text(name), Cell::text(unit)];
        named.into_iter().chain(values).collect::<Vec<Cell>>()
    };
    let means = shipped.means.iter().map(|mean| {
        let (unit, factor) = shown(mean.unit);
        row(
            format!("error of {}", words::channel(mean.channel)),
            unit,
            &|step| {
                let own = step.means.iter().find(|it| it.channel == mean.channel);
                own.map(|it| factor * it.error)
            },
        )
    });
    let mut rows: Vec<Vec<Cell>> = means.collect();
    if shipped.features.is_some() {
        rows.push(row("distance of features".to_owned(), "decades", &|step| {
            step.features
        }));
    }
    if shipped.class.is_some() {
        rows.push(row("windows with another class".to_owned(), "%", &|step| {
            step.class.map(|share| 100.0 * share)
        }));
    }
    if shipped.terrain.is_some() {
        rows.push(row("distance of the terrain".to_owned(), "-", &|step| {
            step.terrain.as_ref().map(|terrain| terrain.distance)
        }));
    }
    rows
}

fn shares(report: &DiagnosisReport) -> Vec<Vec<Cell>> {
    let vibration = report
        .traces
        .map_or_else(Vec::new, |traces| traces.stages());
    let of_vibration = vibration.iter().flat_map(|(step, stages)| {
        let features = of_stages("features", *step, &stages.features);
        [features, of_stages("class", *step, &stages.class)]
    });
    let terrain = report.diagnosis.end_results.iter();
    let of_terrain = terrain.filter_map(|it| {
        let stages = it.terrain.as_ref()?;
        Some(of_stages("terrain", it.step, stages))
    });
    of_vibration.chain(of_terrain).flatten().collect()
}

fn of_stages(result: &str, of: Step, stages: &Stages) -> Vec<Vec<Cell>> {
    let shares = stages.shares.iter().filter_map(|it| {
        Some(vec![
            Cell::text(result),
            Cell::text(step(of)),
            Cell::text(part(it.stage)),
            Cell::Number(it.share?),
        ])
    });
    shares.collect()
}

/// Name of a simulator for readers.
pub fn step(step: Step) -> &'static str {
    match step {
        Step::AsShipped => "nominal",
        Step::Recalibrated => "recalibrated",
        Step::WithEffect => "with effect",
    }
}

fn part(stage: Stage) -> &'static str {
    match stage {
        Stage::AboveBand => "acceleration above the features' band",
        Stage::InBand => "acceleration within the features' band",
        Stage::Rotation => "rotation of the wheel",
        Stage::Slip => "slip",
        Stage::Sinkage => "sinkage",
        Stage::DrawbarPull => "drawbar pull",
        Stage::Load => "load",
        Stage::DrivingTorque => "driving torque",
    }
}
