//! The answer in figures: which causes are left, how large the difference is, and how far all that can be trusted.

use super::units::{of_level, shown};
use super::words::{self, listed, percent};
use super::{end_results, shrinkage};
use crate::diagnosis::inference::SelfTest;
use crate::diagnosis::{Diagnosis, EndResults, InUnits, Step, Verdict};
use crate::gap::Statistic;
use crate::report::page::Section;
use crate::table::four_digits;

/// Causes of a set that are listed.
const LISTED: usize = 6;

/// What a reader needs who reads nothing else.
pub fn section(diagnosis: &Diagnosis) -> Section {
    let verdict = &diagnosis.verdict;
    let mechanism = verdict.mechanism.as_ref();
    let facts = [
        ("90 % set of causes", Some(set(verdict))),
        (
            "where the cause acts",
            mechanism.map(|it| format!("{} (probability {})", it.of, percent(it.probability))),
        ),
        ("difference", Some(differences(diagnosis))),
        ("closed share of the gap", closed(diagnosis)),
        (
            "next measurement",
            verdict
                .next_run
                .as_ref()
                .map(|next| format!("a run {}", next.run)),
        ),
        ("reliability", Some(reliability(&diagnosis.self_test))),
    ];
    let facts = facts
        .into_iter()
        .filter_map(|(name, text)| Some((name.to_owned(), text?)));
    Section::new("The answer in figures").facts(facts.collect())
}

fn set(verdict: &Verdict) -> String {
    let mut causes: Vec<String> = verdict.set.iter().take(LISTED).cloned().collect();
    let others = verdict.set.len() - causes.len();
    if others > 0 {
        causes.push(format!("{others} others"));
    }
    listed(&causes, "or")
}

/// Pull, sinkage and vertical vibration, step by step.
fn differences(diagnosis: &Diagnosis) -> String {
    let of = |channel: &str| {
        let steps: Vec<String> = diagnosis
            .end_results
            .iter()
            .filter_map(|step| step_of_mean(step, channel))
            .collect();
        (!steps.is_empty()).then(|| format!("{}: {}", words::channel(channel), steps.join(", ")))
    };
    let all = [
        of("drawbar_pull"),
        of("sinkage"),
        vibration(&diagnosis.in_units),
    ];
    let all: Vec<String> = all.into_iter().flatten().collect();
    if all.is_empty() {
        return "no steady mean was measured".to_owned();
    }
    format!(
        "root mean square over conditions, measured minus simulated; {}",
        all.join("; ")
    )
}

fn step_of_mean(results: &EndResults, channel: &str) -> Option<String> {
    let mean = results.means.iter().find(|it| it.channel == channel)?;
    let (unit, factor) = shown(mean.unit);
    let error = four_digits(factor * mean.error);
    Some(format!(
        "{error} {unit} {}",
        end_results::step(results.step)
    ))
}

/// Standard deviations of the vertical acceleration.
fn vibration(rows: &[InUnits]) -> Option<String> {
    let own = rows.iter().filter(|row| {
        &*row.cell.channel == "acceleration_y" && row.cell.statistic == Statistic::Deviation
    });
    let own: Vec<&InUnits> = own.collect();
    let step = |of: Step, simulated: &dyn Fn(&InUnits) -> Option<f64>| {
        let errors = own.iter().map(|row| {
            let error = of_level(row.measured) - of_level(simulated(row)?);
            Some(error * error)
        });
        let squares: Vec<f64> = errors.collect::<Option<_>>()?;
        if squares.is_empty() {
            return None;
        }
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        let error = four_digits(libm::sqrt(mean));
        Some(format!("{error} m/s² {}", end_results::step(of)))
    };
    let steps = [
        step(Step::AsShipped, &|row| Some(row.as_shipped)),
        step(Step::Recalibrated, &|row| row.recalibrated),
        step(Step::WithEffect, &|row| row.with_effect),
    ];
    let steps: Vec<String> = steps.into_iter().flatten().collect();
    (!steps.is_empty()).then(|| {
        format!(
            "standard deviation of the vertical acceleration: {}",
            steps.join(", ")
        )
    })
}

fn closed(diagnosis: &Diagnosis) -> Option<String> {
    let closed = diagnosis.closed?;
    let added = listed(&diagnosis.closed_with, "and");
    Some(shrinkage::of_the_gap(&closed, &added))
}

/// What the method reaches on campaigns of this layout.
fn reliability(test: &SelfTest) -> String {
    format!(
        "on {} simulated campaigns of this layout with known causes the cause is found in {}, an effect is named falsely \
         in {}, the 90 % sets contain the cause in {}, and the calibration error is {:.2}",
        test.campaigns,
        percent(test.right),
        percent(test.falsely_named),
        percent(test.coverage),
        test.calibration_error
    )
}
