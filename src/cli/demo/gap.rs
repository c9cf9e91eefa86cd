//! A rig that differs from its scenario, and its diagnosis.

use super::small_study::{SmallStudy, shipped};
use crate::cli::diagnose::Diagnose;
use crate::cli::diagnose::summary::Summary;
use crate::cli::output;
use crate::cli::series::Jobs;
use crate::diagnosis::Answer;
use crate::diagnosis::condition::LONGEST;
use crate::effects::names_but;
use crate::report::page::{Figure, Section};
use crate::report::{gap_waterfall, probability_bars};
use crate::scenario::Scenario;
use std::path::Path;

const STUDY: &str = include_str!("gap.toml");

/// What the rig and its scenario have: noise of real sensors, without which channels agree better than any
/// rig's, and a record that begins when the wheel rolls.
const KNOWN: [&str; 6] = [
    "lead_in=1.0",
    "sensors.accelerometer.acceleration_y.noise_density=4.9e-5",
    "sensors.force_torque.normal_force.noise_density=2.0e-3",
    "sensors.force_torque.drawbar_pull.noise_density=2.0e-3",
    "sensors.force_torque.driving_torque.noise_density=1.2e-4",
    "sensors.encoder.forward_speed.noise_density=1.0e-6",
];
const KNOWN_FILE: &str = "known.toml";

/// What the rig has and its scenario lacks: its name, its magnitude, what it is.
const HIDDEN: (&str, &str, &str) = ("slip_sinkage", "0.8", "sinkage that grows with slip");

/// Effects that are tried, few enough for a demo.
const TRIED: [&str; 6] = [
    "slip_sinkage",
    "bulldozing",
    "rate_dependent_soil",
    "slope",
    "rail_friction",
    "gain_error",
];

/// Driving that may be simulated [s].
const BUDGET: f64 = 1200.0;

/// The rig's runs as a study in the folder of the demo.
pub fn rig(folder: &Path, seed: u64) -> anyhow::Result<SmallStudy> {
    let (name, magnitude, _) = HIDDEN;
    let known = Scenario::ready(shipped("st"))?.with_all(&KNOWN)?;
    let rig = known.with_all(&[format!("effect.{name}={magnitude}")])?;
    output::write_file(&folder.join(KNOWN_FILE), known.text())?;
    output::write_file(&folder.join("rig.toml"), rig.text())?;
    SmallStudy::prepare(folder, "gap", STUDY, seed)
}

/// The diagnosis of the rig's runs against the sand as shipped.
pub fn diagnosis(rig: &SmallStudy, folder: &Path, seed: u64, jobs: Jobs) -> Diagnose {
    Diagnose {
        measured: rig.folder.join("dataset.h5"),
        scenario: folder.join(KNOWN_FILE),
        set: vec!["physics_rate=8000".to_owned()],
        without: names_but(&TRIED),
        run: Vec::new(),
        out: folder.join("diagnosis"),
        bank: folder.join("bank"),
        budget: BUDGET,
        time: None,
        dry_run: false,
        // Its runs are simulated.
        discrepancy: 0.0,
        ablation: None,
        without_next_run: false,
        longest: LONGEST,
        seed,
        jobs,
    }
}

/// The section of the page.
pub fn section(summary: &Summary) -> Section {
    let (name, magnitude, what) = HIDDEN;
    let verdict = &summary.diagnosis.verdict;
    let right = verdict.verdict == Answer::Effect
        && verdict
            .named
            .iter()
            .any(|set| set.iter().any(|it| it == name));
    let judged = if right {
        "It was found."
    } else {
        "It was not named: so few and short runs do not always suffice."
    };
    let section = Section::new("Diagnosis of a rig against its simulation")
        .answer(summary.answer.clone())
        .prose(format!(
            "Six runs of 3 s at three conditions represent a rig. Its sand has {name} = {magnitude}, {what}; \
             the scenario has not, and the diagnosis has no information on it. {judged} The diagnosis tried {} \
             of the catalogue's effects and recalibrated the parameters of the scenario. Its report is {}.",
            TRIED.len(),
            summary.page
        ))
        .figure(Figure::new(
            probability_bars(&verdict.probabilities),
            "Posterior probabilities of the explanations.",
        ));
    match &summary.diagnosis.gap {
        Some(gaps) => section.figure(Figure::new(
            gap_waterfall(gaps, summary.diagnosis.closed, "the effect"),
            "Gap between rig and simulation, and its shrinkage step by step.",
        )),
        None => section,
    }
}
