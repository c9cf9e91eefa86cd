//! The page of a diagnosis: what explains the difference, what that rests on, how far it closes the
//! gap, and what to measure next.

mod answer;
mod compared;
mod differences;
mod effects;
mod end_results;
mod figures;
mod parameters;
mod shrinkage;
mod units;
mod words;

use super::figure::Layout;
use super::page::{Figure, Page, Provenance, Section};
use super::{arm_curves, arm_traces};
use crate::diagnosis::condition::Case;
use crate::diagnosis::{ArmTraces, Diagnosis, Settings};
use crate::scenario::Scenario;

/// A diagnosis and what it was made of.
#[derive(Debug, Clone, Copy)]
pub struct DiagnosisReport<'a> {
    /// What came of it.
    pub diagnosis: &'a Diagnosis,
    /// What the measured runs are called: their file.
    pub measured: &'a str,
    /// What the scenario is called.
    pub name: &'a str,
    /// The scenario as it came.
    pub scenario: &'a Scenario,
    /// The conditions that were compared.
    pub cases: &'a [Case],
    /// Runs to look at; none where they could not be made.
    pub traces: Option<&'a ArmTraces>,
    /// How the diagnosis was made.
    pub settings: &'a Settings,
    /// What it was made of, beside what stands above: files with their hashes, version.
    pub facts: &'a [(String, String)],
    /// Commands that make it again.
    pub commands: &'a [String],
}

impl DiagnosisReport<'_> {
    /// The effect or effects of the answer as a few words; empty where it names none.
    fn named(&self) -> String {
        let sets = self.diagnosis.verdict.named.iter();
        let first = sets.filter_map(|set| set.first().cloned());
        first.collect::<Vec<_>>().join(" and ")
    }
}

/// The page of a diagnosis, in this order: the answer with its probability, in figures, and what it rests on, how
/// far the gap closes, where the sides differ, which effects may explain it, what recalibration
/// moved, measured and simulated runs before and after, what the gap does to end results, the gap in plain units, which effects these
/// runs can discriminate, what to measure next, what was compared. It holds nothing that depends on a
/// clock or a machine.
pub fn diagnosis_page(report: &DiagnosisReport) -> Page {
    let DiagnosisReport { diagnosis, .. } = *report;
    let sections = [
        Some(figures::section(diagnosis)),
        Some(answer::rests_on(diagnosis)),
        Some(shrinkage::section(diagnosis)),
        Some(differences::section(report)),
        Some(effects::suspects(diagnosis)),
        Some(parameters::section(report)),
        Some(looks(report)),
        end_results::section(report),
        units::section(diagnosis),
        effects::isolability(report),
        Some(answer::next_run(diagnosis)),
        Some(compared::section(diagnosis)),
    ];
    Page {
        title: format!("Where {} and {} differ, and why", report.measured, report.name),
        question: format!(
            "Why does scenario {} disagree with the measurements in {}?",
            report.name, report.measured
        ),
        answer: answer::sentence(report),
        intro: "A gap is a difference between measured and simulated runs at the same load, speed and slip. Three \
         simulators are compared with the measurements: the nominal scenario, the scenario with its parameters \
         recalibrated within their priors, and the recalibrated scenario with an effect added. An effect is \
         inferred from the remainder after recalibration only."
            .to_owned(),
        sections: sections.into_iter().flatten().collect(),
        provenance: provenance(report),
    }
}

/// Traces, spectra and curves, before and after.
fn looks(report: &DiagnosisReport) -> Section {
    let named = report.named();
    let mut section = Section::new("Measured and simulated runs");
    if named.is_empty() {
        section = section.prose(
            "No effect is named: only the nominal and the recalibrated scenario are simulated.",
        );
    }
    let drawn = |traces, layout| arm_traces(traces, &named, layout);
    let traces = report.traces.and_then(|traces| {
        let narrow = drawn(traces, Layout::TELEPHONE)?;
        Some((traces, drawn(traces, Layout::SCREEN)?, narrow))
    });
    section = match traces {
        Some((traces, svg, narrow)) => section.figure(Figure::new(
            svg,
            format!(
                "The first measured run at {}, where most statistics differ, and one simulated run of each \
                 variant on the same realisation of the ground. Ground and noise of the measured run are other \
                 realisations: level, range and periods are comparable, individual samples are not.",
                traces.condition
            ),
        ).narrow(narrow)),
        None => section.prose(
            "No traces: the condition with the largest gap has no time series, or could not be simulated.",
        ),
    };
    let drawn = |layout| arm_curves(&report.diagnosis.in_units, report.cases, &named, layout);
    match drawn(Layout::SCREEN).zip(drawn(Layout::TELEPHONE)) {
        Some((svg, narrow)) => section.figure(Figure::new(
            svg,
            "Means of the measured runs of a condition and of simulated runs of each variant; parameters and \
             magnitudes are fitted to all conditions.",
        ).narrow(narrow)),
        None => section.prose("No curves: no steady value was compared."),
    }
}

fn provenance(report: &DiagnosisReport) -> Provenance {
    let DiagnosisReport {
        settings, scenario, ..
    } = *report;
    let without = if settings.without.is_empty() {
        "none".to_owned()
    } else {
        settings.without.join(", ")
    };
    let own = [
        ("seed of the simulations", settings.seed.0.to_string()),
        (
            "longest part of a run compared",
            format!("{} s", settings.longest),
        ),
        ("driving allowed", format!("{} s", settings.budget)),
        (
            "discrepancy assumed",
            format!("{} margins of equivalence", settings.discrepancy),
        ),
        ("excluded effects", without),
    ];
    let own = own.map(|(name, value)| (name.to_owned(), value));
    Provenance {
        facts: report.facts.iter().cloned().chain(own).collect(),
        commands: report.commands.to_vec(),
        files: vec![("the scenario as used".to_owned(), scenario.to_toml())],
    }
}
