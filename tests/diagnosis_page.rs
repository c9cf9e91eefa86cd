//! The page of a diagnosis, as a reader meets it who was not there.

use crate::chromium::{look, point_at, sheets};
use lugwheel::diagnosis::arm::Arm;
use lugwheel::diagnosis::condition::{Case, Cases, LONGEST};
use lugwheel::diagnosis::inference::{BaseRates, SelfTest};
use lugwheel::diagnosis::parameter::{Offsets, Parameter};
use lugwheel::diagnosis::{
    Answer, ArmTraces, BUDGET, Compared, ComparedCondition, Diagnosis, EndResults, Gaps, InUnits,
    Located, MeanError, NextRun, Recalibrated, Screened, Settings, Step, Suspect, Variants,
    Verdict,
};
use lugwheel::effects::Application;
use lugwheel::gap::stages::{Stage, StageShare, Stages};
use lugwheel::gap::{Cell, Closed, Colour, Condition, Covariate, Entry, Global, Statistic, Test};
use lugwheel::quantity::Seed;
use lugwheel::report::page::Page;
use lugwheel::report::{self, DiagnosisReport, diagnosis_page};
use lugwheel::scenario::Scenario;
use lugwheel::trace::{Channel, RunAttributes, Trace};
use std::ops::ControlFlow;

const SEED: Seed = Seed(5);
/// Slip [-], load [N] and speed [m/s] of each condition.
const CONDITIONS: [[f64; 3]; 5] = [
    [0.1, 100.0, 0.02],
    [0.3, 100.0, 0.02],
    [0.5, 100.0, 0.02],
    [0.1, 60.0, 0.05],
    [0.3, 60.0, 0.05],
];
const CHANNELS: [(&str, f64, f64); 5] = [
    ("acceleration_y", 0.0, 0.3),
    ("normal_force", 100.0, 6.0),
    ("drawbar_pull", 18.0, 3.0),
    ("driving_torque", 4.2, 0.5),
    ("sinkage", 0.014, 0.001),
];
const EFFECTS: [&str; 5] = [
    "slip_sinkage",
    "lug_action",
    "gain_error.drawbar_pull",
    "low_pass.normal_force",
    "wheel_eccentricity",
];

fn scenario() -> Scenario {
    let folder = env!("CARGO_MANIFEST_DIR");
    let quick = Scenario::load(format!("{folder}/scenarios/quick.toml")).unwrap();
    quick
        .with_all(&["duration=1.0", "physics_rate=8000"])
        .unwrap()
}

/// Four seconds of all channels, `times` as strong as they should be.
fn run([slip_ratio, load, speed]: [f64; 3], times: f64) -> Trace {
    let channel = |&(name, mean, wave): &(&str, f64, f64)| Channel {
        name: name.to_owned(),
        unit: String::new(),
        sample_rate: 500.0,
        start: 0.0,
        samples: (0..2000)
            .map(|i| f64::from(i) / 500.0)
            .map(|t| {
                let fast = 0.2 * libm::sin(700.0 * t + libm::sin(91.0 * t));
                times * (mean + wave * (libm::sin(9.0 * t) + fast))
            })
            .collect(),
    };
    Trace {
        attributes: RunAttributes {
            wheel_radius: 0.14,
            wheel_width: 0.15,
            lug_count: Some(28),
            lug_height: 0.015,
            load,
            speed,
            slip_ratio,
            ..RunAttributes::default()
        },
        channels: CHANNELS.iter().map(channel).collect(),
        ..Trace::default()
    }
}

fn cases() -> Vec<Case> {
    let runs: Vec<Trace> = CONDITIONS.map(|it| run(it, 1.0)).to_vec();
    Cases::of(&scenario(), &runs, LONGEST).unwrap().cases
}

fn traces(case: &Case) -> ArmTraces {
    ArmTraces {
        condition: case.condition.clone(),
        measured: run(CONDITIONS[0], 1.0),
        as_shipped: Some(run(CONDITIONS[0], 0.6)),
        recalibrated: Some(run(CONDITIONS[0], 0.8)),
        with_effect: Some(run(CONDITIONS[0], 0.98)),
    }
}

fn entries(cases: &[Case]) -> Vec<Entry> {
    let statistics = [
        Statistic::SteadyMean,
        Statistic::Deviation,
        Statistic::OrderLevel(28),
        Statistic::Band(18),
    ];
    let campaign = Condition::campaign();
    let conditions = cases.iter().map(|case| &case.condition);
    let mut entries = Vec::new();
    let mut add = |cell: Cell, condition: &Condition, z: f64| {
        entries.push(Entry {
            channel: cell.channel.to_string(),
            domain: cell.domain(),
            unit: cell.unit(),
            condition: condition.clone(),
            measured: 1.0 + 0.1 * z,
            simulated: 1.0,
            difference: 0.1 * z,
            error: 0.1,
            z,
            freedom: 7.0,
            p: 0.01,
            q: 0.02,
            margin: 0.05,
            colour: if z > 3.0 {
                Colour::Gap
            } else {
                Colour::Undecided
            },
            cell,
        });
    };
    for (place, condition) in conditions.enumerate() {
        for (row, (channel, ..)) in CHANNELS.iter().enumerate() {
            for (column, statistic) in statistics.into_iter().enumerate() {
                let z = ((7 * place + 3 * row + 5 * column) % 11) as f64 - 4.0;
                add(Cell::new(*channel, statistic), condition, z);
            }
        }
    }
    let slope = Cell::new("sinkage", Statistic::Slope(Covariate::Slip));
    add(slope, &campaign, 5.5);
    entries
}

fn suspect(name: &str, probability: f64) -> Suspect {
    let seat = Application::new(name, 0.1).map_or("-", |it| it.seat().unit);
    Suspect {
        name: name.to_owned(),
        probability,
        magnitude: 0.81,
        unit: seat,
        ci95: [0.7, 0.93],
        equivalent_to: Vec::new(),
        detectable: Some(0.12),
        absorbed: 0.31,
    }
}

fn verdict(cases: &[Case]) -> Verdict {
    let probabilities = [
        ("none", 0.001),
        ("parameter", 0.03),
        ("unknown", 0.012),
        ("slip_sinkage", 0.81),
        ("lug_action", 0.06),
        ("slip_sinkage+wheel_eccentricity", 0.03),
        ("gain_error.drawbar_pull", 0.007),
    ];
    let probabilities = probabilities.map(|(name, p)| (name.to_owned(), p));
    let moved = |name: &str, offset| Recalibrated {
        name: name.to_owned(),
        offset,
        deviation: 0.2,
    };
    let recalibration = vec![
        moved("soil_moduli", -1.2),
        moved("soil_cohesion", 0.1),
        moved("soil_friction_angle", 3.4),
    ];
    Verdict {
        verdict: Answer::Effect,
        named: vec![vec!["slip_sinkage".to_owned(), "lug_action".to_owned()]],
        probabilities: probabilities.into(),
        set: vec!["slip_sinkage".to_owned()],
        mechanism: None,
        effects: vec![
            Suspect {
                equivalent_to: vec!["lug_action".to_owned()],
                ..suspect("slip_sinkage", 0.84)
            },
            suspect("lug_action", 0.06),
            Suspect {
                magnitude: f64::INFINITY,
                ci95: [150.0, f64::INFINITY],
                detectable: None,
                ..suspect("low_pass.normal_force", 0.01)
            },
        ],
        parameters: recalibration.clone(),
        recalibration,
        located: vec![Located {
            condition: cases[1].condition.clone(),
            cell: Cell::new("sinkage", Statistic::SteadyMean),
            deviations: 12.3,
        }],
        next_run: Some(NextRun {
            run: "with a smooth wheel (slip 0.1)".to_owned(),
            between: ["slip_sinkage".to_owned(), "lug_action".to_owned()],
            separation: [0.11, 0.94],
        }),
        reasons: vec!["simulated, it closes nothing".to_owned()],
    }
}

fn in_units(cases: &[Case]) -> Vec<InUnits> {
    let row = |case: &Case, channel: &str, statistic, size: f64| {
        let cell = Cell::new(channel, statistic);
        let grown = size * (1.0 + case.attributes.slip_ratio);
        InUnits {
            condition: case.condition.clone(),
            unit: cell.unit(),
            cell,
            measured: grown,
            as_shipped: 0.6 * size,
            recalibrated: Some(0.8 * size),
            with_effect: Some(0.98 * grown),
        }
    };
    let of_case = |case: &Case| -> Vec<InUnits> {
        let rows = CHANNELS.iter().flat_map(|(channel, mean, wave)| {
            let level = 20.0 * libm::log10(*wave);
            [
                row(case, channel, Statistic::SteadyMean, *mean),
                row(case, channel, Statistic::Deviation, level),
            ]
        });
        rows.collect()
    };
    cases.iter().flat_map(of_case).collect()
}

fn diagnosis(cases: &[Case]) -> Diagnosis {
    let test = |p| Test { statistic: 3.0, p };
    let screened = |(place, name): (usize, &&str)| Screened {
        name: (*name).to_owned(),
        score: 10.0 * place as f64,
        detectable: (place != 4).then_some(0.1),
        absorbed: 0.2,
        equivalent: match place {
            0 => vec![("lug_action".to_owned(), 0.97)],
            1 => vec![("slip_sinkage".to_owned(), 0.97)],
            _ => Vec::new(),
        },
        unit: "-",
    };
    let cosine = |a: usize, b: usize| match (a.min(b), a.max(b)) {
        (a, b) if a == b => 1.0,
        (0, 1) => 0.97,
        (a, b) => 0.2 * a as f64 - 0.15 * b as f64,
    };
    Diagnosis {
        gap: Some(Gaps {
            as_shipped: 3.1,
            recalibrated: 2.2,
            with_effect: 0.9,
            floor: 0.6,
            floor_with_discrepancy: Some(0.8),
        }),
        closed: Some(Closed {
            value: 0.81,
            ci95: [0.7, 0.9],
            clusters: 5,
        }),
        closed_with: vec!["slip_sinkage".to_owned()],
        verdict: verdict(cases),
        limits: Default::default(),
        self_test: SelfTest {
            rigs: 200,
            campaigns: 1300,
            right: 0.81,
            probability_of_truth: 0.78,
            falsely_named: 0.02,
            calibration_error: 0.03,
            coverage: 0.9,
            threshold: 0.1,
            effects: Vec::new(),
        },
        global: Global {
            energy: test(0.001),
            strongest: test(0.0004),
            at: None,
            least_p: 0.001,
        },
        map: entries(cases),
        screen: EFFECTS.iter().enumerate().map(screened).collect(),
        isolability: (0..EFFECTS.len())
            .map(|a| (0..EFFECTS.len()).map(|b| cosine(a, b)).collect())
            .collect(),
        in_units: in_units(cases),
        end_results: vec![
            end_results(Step::AsShipped, 4.0),
            end_results(Step::Recalibrated, 3.0),
            end_results(Step::WithEffect, 0.8),
        ],
        compared: Compared {
            conditions: cases
                .iter()
                .map(|case| ComparedCondition {
                    condition: case.condition.to_string(),
                    runs: 2,
                    cells: 180,
                })
                .collect(),
            parameters: vec!["soil_cohesion".to_owned()],
            candidates: EFFECTS.map(str::to_owned).to_vec(),
            rigs: 200,
            driven: 14_000.0,
        },
        caveats: vec!["motor_current is not simulated".to_owned()],
    }
}

fn end_results(step: Step, error: f64) -> EndResults {
    EndResults {
        step,
        means: vec![MeanError {
            channel: "sinkage",
            unit: "m",
            error: 1.0e-3 * error,
            conditions: 3,
        }],
        features: Some(0.1 * error),
        class: None,
        terrain: Some(Stages {
            distance: error,
            shares: vec![StageShare {
                stage: Stage::Sinkage,
                distance: error,
                share: Some(1.0),
            }],
        }),
    }
}

fn settings() -> Settings {
    Settings {
        longest: LONGEST,
        budget: BUDGET,
        without: vec!["slope".to_owned()],
        seed: SEED,
        rates: BaseRates::default(),
        discrepancy: 0.0,
        ablation: None,
        without_next_run: false,
    }
}

/// The page of the diagnosis that `change` makes of the sample, and of such traces.
fn changed(change: impl FnOnce(&mut Diagnosis), traces: Option<&ArmTraces>) -> Page {
    let cases = cases();
    let mut diagnosis = diagnosis(&cases);
    change(&mut diagnosis);
    diagnosis_page(&DiagnosisReport {
        diagnosis: &diagnosis,
        measured: "rig",
        name: "quick",
        scenario: &scenario(),
        cases: &cases,
        traces,
        settings: &settings(),
        facts: &[("measured".to_owned(), "rig.h5, SHA-256 0123".to_owned())],
        commands: &["lugwheel diagnose --measured rig.h5 --scenario quick".to_owned()],
    })
}

fn sample() -> String {
    report::page(&changed(|_| {}, Some(&traces(&cases()[0]))))
}

#[test]
fn the_answer_comes_first_with_probability_magnitude_and_what_it_closes() {
    let page = changed(|_| {}, None);
    for told in [
        "slip_sinkage or lug_action, with probability 90 % (alone 87 %, together with a second effect 3.0 %)",
        "slip_sinkage = 0.8100 [0.7000, 0.9300]",
        "closes 81 % of the gap that remains after recalibration (95 % interval 70 % to 90 %",
    ] {
        assert!(page.answer.contains(told), "{told}: {}", page.answer);
    }
    let html = report::page(&page);
    let [answer, reason] = ["An effect is missing", "simulated, it closes nothing"]
        .map(|text| html.find(text).unwrap());
    assert!(answer < reason);
}

#[test]
fn every_kind_of_answer_says_what_it_is_and_how_probable() {
    let answer = |kind: Answer| {
        let page = changed(
            |diagnosis| {
                diagnosis.verdict.verdict = kind;
                diagnosis.verdict.named.clear();
            },
            None,
        );
        page.answer
    };
    assert!(answer(Answer::None).contains("explains these runs without any change"));
    let parameter = answer(Answer::Parameter);
    for told in [
        "(probability 3.0 %",
        "Most probable are slip_sinkage (81 %)",
    ] {
        assert!(parameter.contains(told), "{told}: {parameter}");
    }
    let unknown = answer(Answer::Unknown);
    assert!(unknown.contains("(probability 1.2 %). It shows most in the sinkage: steady mean"));
    let undecided = answer(Answer::Undecided);
    assert!(undecided.contains("slip_sinkage (81 %)"), "{undecided}");
    assert!(
        undecided.contains("The most informative next run is with a smooth wheel"),
        "{undecided}"
    );
}

#[test]
fn the_page_has_every_section_in_order_and_needs_nothing_else() {
    let html = sample();
    let headings = [
        "Basis of the answer",
        "Closed share of the difference",
        "Gap map",
        "Candidate effects",
        "Recalibrated parameters",
        "Measured and simulated runs",
        "Effect of the gap on forces, class and terrain",
        "Gap in physical units",
        "Isolability of the effects",
        "Recommended next run",
        "Compared conditions and statistics",
        "Provenance and reproduction",
    ];
    let places = headings.map(|heading| html.find(&format!(">{heading}</h2>")));
    assert!(
        places.iter().all(Option::is_some) && places.is_sorted(),
        "{places:?}"
    );
    for loads in ["src=", "href=\"http", "@import", "url(", "fetch("] {
        assert!(!html.contains(loads), "{loads}");
    }
    for told in [
        "rig.h5, SHA-256 0123",
        "slip-sinkage in excess of",
        "motor_current is not simulated",
        "differ by 0.94 standard deviations per statistic",
        "150.0, unbounded",
        "error of sinkage",
        "distance of the terrain",
    ] {
        assert!(html.contains(told), "{told}");
    }
}

#[test]
fn the_same_diagnosis_makes_the_same_page_byte_by_byte() {
    assert!(sample() == sample());
}

#[test]
fn what_is_missing_is_left_out_or_said_and_breaks_nothing() {
    let page = changed(
        |diagnosis| {
            (diagnosis.gap, diagnosis.closed) = (None, None);
            diagnosis.verdict.next_run = None;
            diagnosis.verdict.named.clear();
            diagnosis.verdict.effects.clear();
            diagnosis.verdict.recalibration.clear();
            diagnosis.verdict.parameters.clear();
            diagnosis.verdict.probabilities.clear();
            diagnosis.verdict.located.clear();
            diagnosis.map.clear();
            diagnosis.screen.clear();
            diagnosis.isolability.clear();
            diagnosis.in_units.clear();
            diagnosis.end_results.clear();
        },
        None,
    );
    let html = report::page(&page);
    for told in [
        "The variants of the scenario could not be simulated",
        "No effect was tried",
        "No traces: ",
        "Measurement and simulation have no statistic in common",
    ] {
        assert!(html.contains(told), "{told}");
    }
    assert!(!html.contains("Isolability of the effects"));
}

#[test]
fn without_an_effect_the_third_arm_is_not_shown() {
    let mut without = traces(&cases()[0]);
    without.with_effect = None;
    let page = changed(
        |diagnosis| {
            diagnosis.verdict.verdict = Answer::Parameter;
            diagnosis.verdict.named.clear();
            diagnosis.end_results.pop();
            for row in &mut diagnosis.in_units {
                row.with_effect = None;
            }
        },
        Some(&without),
    );
    let html = report::page(&page);
    assert!(html.contains("No effect is named"));
    assert!(!html.contains("with effect</button>"));
}

#[test]
fn numbers_that_are_none_or_infinite_reach_no_figure() {
    let cases = cases();
    let mut broken = traces(&cases[0]);
    for channel in &mut broken.measured.channels {
        channel.samples[3..900].fill(f64::NAN);
        channel.samples[1000] = f64::INFINITY;
    }
    let page = changed(
        |diagnosis| {
            let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
            for (entry, bad) in diagnosis.map.iter_mut().zip(bad.iter().cycle()) {
                (entry.z, entry.error, entry.freedom) = (*bad, *bad, *bad);
            }
            // The first condition keeps its numbers.
            for (row, bad) in diagnosis
                .in_units
                .iter_mut()
                .skip(10)
                .zip(bad.iter().cycle())
            {
                (row.measured, row.recalibrated) = (*bad, Some(*bad));
            }
            for row in &mut diagnosis.isolability {
                row[0] = f64::NAN;
            }
            let gap = diagnosis.gap.as_mut().unwrap();
            (gap.as_shipped, gap.with_effect) = (f64::NAN, f64::INFINITY);
            let suspect = &mut diagnosis.verdict.effects[0];
            (suspect.magnitude, suspect.ci95) = (f64::NAN, [f64::NAN; 2]);
            (suspect.probability, suspect.absorbed) = (f64::NAN, f64::NAN);
        },
        Some(&broken),
    );
    let html = report::page(&page);
    let drawings: Vec<&str> = html.split("<svg xmlns").skip(1).collect();
    // Two of the six for telephones too.
    assert_eq!(drawings.len(), 6 + 2);
    for drawing in drawings {
        let drawing = drawing.split("</figure>").next().unwrap();
        for number in ["NaN", "inf\"", "inf,", "inf "] {
            assert!(!drawing.contains(number), "{number}");
        }
    }
}

#[test]
fn the_page_opens_in_a_browser_and_its_figures_are_drawn_without_overlaps() {
    let found = look(&sample(), 1280);
    assert_eq!(found["errors"], serde_json::json!([]));
    let drawings = found["drawings"].as_array().unwrap();
    let outer: Vec<_> = drawings
        .iter()
        .filter(|drawing| drawing["title"] != "")
        .collect();
    assert_eq!(outer.len(), 6);
    for drawing in outer {
        assert!(drawing["parts"].as_u64().unwrap() > 10, "{drawing}");
        assert_eq!(drawing["outside"], serde_json::json!([]), "{drawing}");
        assert_eq!(drawing["overlaps"], serde_json::json!([]), "{drawing}");
    }
    assert!(found["tables"].as_array().unwrap().len() >= 9);
    assert_eq!(found["cutTables"], serde_json::json!([]));
}

#[test]
fn the_page_stays_within_the_width_of_a_telephone() {
    let found = look(&sample(), 375);
    assert_eq!(found["pageWidth"], 375, "{}", found["wideBoxes"]);
    assert_eq!(found["wideBoxes"], serde_json::json!([]));
}

#[test]
fn every_figure_of_the_page_is_read_off() {
    let found = point_at(&sample(), 1280, &[0.5]);
    assert_eq!(found["errors"], serde_json::json!([]));
    let figures = found["figures"].as_array().unwrap();
    assert_eq!(figures.len(), 6);
    for figure in figures {
        let marks = figure["marks"].as_array().unwrap();
        let is_read = |mark: &serde_json::Value| mark.is_string();
        let lines = figure["lines"][0].as_str().unwrap_or_default();
        assert!(
            !marks.is_empty() || lines.contains(" s\nmeasured "),
            "{figure}"
        );
        assert!(marks.iter().all(is_read), "{figure}");
    }
}

#[test]
fn the_page_prints_on_a_few_sheets() {
    let printed = sheets(&sample());
    assert!((4..20).contains(&printed), "{printed}");
}

#[test]
fn arms_are_simulated_on_one_ground_with_the_channels_that_were_measured() {
    let scenario = scenario();
    let mut measured = scenario
        .run(SEED, 0, &mut |_| ControlFlow::Continue(()))
        .unwrap();
    measured.truth = None;
    measured.attributes.physics_rate = None;
    measured.channels.retain(|it| it.name != "driving_torque");
    let cases = Cases::of(&scenario, std::slice::from_ref(&measured), LONGEST).unwrap();
    let moduli = Parameter::find("soil_moduli").unwrap();
    let softer = Arm::of_offsets(Offsets::default().with(moduli, -1.0));
    let variants = Variants {
        recalibrated: softer,
        with_effect: None,
    };
    let runs = [measured];
    let traces = ArmTraces::of(&cases.cases[0], &runs, &variants, SEED).unwrap();
    // Run 0 of this seed is what was measured: the arm as shipped gives it back.
    let [shipped, recalibrated] = [traces.as_shipped, traces.recalibrated].map(Option::unwrap);
    let samples = |trace: &Trace, name: &str| trace.channel(name).unwrap().samples.clone();
    assert_eq!(
        samples(&shipped, "sinkage"),
        samples(&traces.measured, "sinkage")
    );
    let mean = |trace: &Trace| trace.channel("sinkage").unwrap().steady_mean().unwrap();
    assert!(mean(&recalibrated) > 1.2 * mean(&shipped));
    assert!(shipped.channel("driving_torque").is_none() && traces.with_effect.is_none());
}
