//! Pages as a reader meets them: on a screen, on a telephone, on paper.

use crate::chromium::{look, point_at, sheets};
use lugwheel::recognition::confusion::Confusion;
use lugwheel::report::page::{Cell, Code, Column, Figure, Page, Provenance, Section, Table};
use lugwheel::report::{StudyReport, confusion_figure, page, study_page};
use lugwheel::study::{Options, Study};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::LazyLock;
use tempfile::TempDir;

/// Widths [px] of a screen and of a telephone.
const SCREEN: u32 = 1280;
const TELEPHONE: u32 = 375;

/// A page with every part, wide and long.
fn sample() -> String {
    let mut confusion = Confusion::default();
    confusion.counts[0] = [58, 0, 0, 2];
    let columns = ["wheel and ground", "load", "share", "pull", "remark"];
    let row = |name: &str, load, pull| {
        vec![
            Cell::text(name),
            Cell::Count(load),
            Cell::Written(format!("{load} of 300"), load as f64 / 300.0),
            pull,
            Cell::Code("lugwheel simulate single_wheel_st --set rig.single_wheel.slip=0.3".into()),
        ]
    };
    let commands = ["lugwheel demo --seed 1 --out ".to_owned() + &"a_long_folder/".repeat(12)];
    page(&Page {
        title: "How a wheel feels its ground".to_owned(),
        question: "Does it pull?".to_owned(),
        answer: "It does: 18.2 N [17.1, 19.3].".to_owned(),
        intro: "A word in advance.".to_owned(),
        sections: vec![
            Section::new("Numbers")
                .answer("Some are missing.")
                .prose("One paragraph.\n\nAnother.")
                .table(Table {
                    caption: "Loads and pulls".to_owned(),
                    columns: Column::named(columns),
                    rows: vec![
                        row(
                            "wheel 10",
                            100,
                            Cell::Estimate(1.5e6, [1.0e6, f64::INFINITY]),
                        ),
                        row("wheel 9", 20, Cell::Missing),
                        row("wheel 101", 3, Cell::Number(-4.0)),
                        row("a wheel", 3, Cell::Number(0.5)),
                    ],
                }),
            Section::new("Figures").figure(Figure::new(
                confusion_figure(&confusion, "Classes answered"),
                "Answers counted.",
            )),
            Section::new("Code").code(Code {
                caption: "A file".to_owned(),
                text: "key = \"value\"\n".repeat(80),
                is_folded: true,
            }),
        ],
        provenance: Provenance {
            facts: vec![("fingerprint".to_owned(), "0123456789abcdef".repeat(4))],
            commands: commands.to_vec(),
            ..Provenance::default()
        },
    })
}

#[test]
fn a_page_opens_without_an_error_and_draws_its_figures() {
    let found = look(&sample(), SCREEN);
    assert_eq!(found["errors"], serde_json::json!([]));
    let drawings = found["drawings"].as_array().unwrap();
    assert_eq!(drawings.len(), 1);
    for drawing in drawings {
        assert!(drawing["width"].as_f64().unwrap() > 300.0, "{drawing}");
        assert!(drawing["parts"].as_u64().unwrap() > 10, "{drawing}");
        assert_eq!(drawing["outside"], serde_json::json!([]), "{drawing}");
        assert_eq!(drawing["overlaps"], serde_json::json!([]), "{drawing}");
    }
}

#[test]
fn a_page_stays_within_the_width_of_a_telephone() {
    let found = look(&sample(), TELEPHONE);
    assert_eq!(found["width"], TELEPHONE);
    assert_eq!(found["pageWidth"], TELEPHONE, "{}", found["wideBoxes"]);
    assert_eq!(found["wideBoxes"], serde_json::json!([]));
    for drawing in found["drawings"].as_array().unwrap() {
        let width = drawing["width"].as_f64().unwrap();
        assert!((200.0..=f64::from(TELEPHONE)).contains(&width), "{drawing}");
    }
}

#[test]
fn a_click_on_a_header_sorts_by_number_or_by_text_and_another_turns_it_round() {
    let found = look(&sample(), SCREEN);
    let columns = found["tables"][0].as_array().unwrap();
    let is = |number: usize, order: &str, expected: [&str; 4]| {
        assert_eq!(columns[number][order], serde_json::json!(expected));
    };
    is(0, "up", ["a wheel", "wheel 9", "wheel 10", "wheel 101"]);
    is(0, "down", ["wheel 101", "wheel 10", "wheel 9", "a wheel"]);
    is(1, "up", ["3", "3", "20", "100"]);
    is(
        2,
        "down",
        ["100 of 300", "20 of 300", "3 of 300", "3 of 300"],
    );
    let greatest = "1.500e6 [1.000e6, unbounded]";
    is(3, "up", ["−4.000", "0.5000", greatest, "–"]);
    is(3, "down", [greatest, "0.5000", "−4.000", "–"]);
    assert_eq!(columns[3]["said"], "ascending");
}

#[test]
fn a_page_prints_with_what_is_folded_on_the_screen() {
    // Eighty lines do not fit below the rest on one sheet.
    let printed = sheets(&sample());
    assert!((2..6).contains(&printed), "{printed}");
}

/// Two grounds at three slips, asked for classes, limits and parameters: a second of each run.
const STUDY: &str = r#"
version = 1
title = "Everything at once"
scenarios = ["SCENARIOS/single_wheel_ht.toml", "SCENARIOS/single_wheel_st.toml"]
seed = 5
repeats = 1
random_numbers = "independent"
[set]
duration = 8.0
window = 4.0
lead_in = 1.0
rig.single_wheel.forward_speed = 0.02
[[sweep]]
key = "rig.single_wheel.slip"
values = [0.0, 0.2, 0.4]
[recognition]
[recognition.published]
ALCT = [58, 0, 0, 2]
SLCT = [0, 118, 0, 2]
LEIS = [0, 0, 116, 4]
[thresholds]
bandwidths = [20.0, 100.0]
[identification]
[identification.published]
ALCT = [15.2, 11.68, 15.52]
SLCT = [11.85, 6.67, 8.46]
LEIS = [8.11, 7.64, 7.75]
"#;

/// The page of that study and what its folder holds.
static STUDY_PAGE: LazyLock<String> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let file = folder.path().join("everything.toml");
    fs::write(
        &file,
        STUDY.replace("SCENARIOS", scenarios.to_str().unwrap()),
    )
    .unwrap();
    let study = Study::load(&file).unwrap();
    let options = Options {
        out: folder.path().join("out"),
        jobs: None,
        resume: false,
        shard: None,
    };
    let outcome = study
        .execute(&options, &|_| ControlFlow::Continue(()))
        .unwrap();
    let run = study.runs().next().unwrap();
    let still = study.run(&run, &mut |_| ControlFlow::Continue(())).unwrap();
    page(&study_page(&StudyReport {
        study: &study,
        name: "everything",
        outcome: &outcome,
        stills: &[("single_wheel_ht".to_owned(), still)],
        facts: &[("program".to_owned(), "lugwheel".to_owned())],
        commands: &["lugwheel study everything.toml --out out".to_owned()],
    }))
});

#[test]
fn the_page_of_a_study_draws_what_it_asked_for_within_its_frames() {
    let found = look(&STUDY_PAGE, SCREEN);
    assert_eq!(found["errors"], serde_json::json!([]));
    let drawings = found["drawings"].as_array().unwrap();
    let titles: Vec<&str> = drawings
        .iter()
        .map(|d| d["title"].as_str().unwrap())
        .collect();
    // Two methods, two of features, the paper's limits, parameters, forces of two grounds, a run.
    assert!(drawings.len() >= 12, "{titles:?}");
    for drawing in drawings {
        assert!(drawing["width"].as_f64().unwrap() > 300.0, "{drawing}");
        assert!(drawing["parts"].as_u64().unwrap() > 5, "{drawing}");
        assert_eq!(drawing["outside"], serde_json::json!([]), "{drawing}");
        assert_eq!(drawing["overlaps"], serde_json::json!([]), "{drawing}");
    }
    assert!(found["tables"].as_array().unwrap().len() >= 8);
    assert_eq!(found["cutTables"], serde_json::json!([]));
}

#[test]
fn every_figure_of_a_study_is_read_off() {
    let found = point_at(&STUDY_PAGE, SCREEN, &[0.5]);
    assert_eq!(found["errors"], serde_json::json!([]));
    let figures = found["figures"].as_array().unwrap();
    assert!(figures.len() >= 12);
    for figure in figures {
        let marks = figure["marks"].as_array().unwrap();
        assert!(
            !marks.is_empty() || figure["lines"][0].is_string(),
            "{figure}"
        );
        assert!(marks.iter().all(serde_json::Value::is_string), "{figure}");
    }
}

#[test]
fn the_page_of_a_study_fits_a_telephone_and_paper() {
    let found = look(&STUDY_PAGE, TELEPHONE);
    assert_eq!(found["pageWidth"], TELEPHONE, "{}", found["wideBoxes"]);
    assert!(sheets(&STUDY_PAGE) > 5);
}

#[test]
fn the_page_of_a_study_has_answer_published_numbers_and_how_to_run_it_again() {
    for part in [
        "<h1>Everything at once</h1>",
        "How do the results depend on rig.single_wheel.slip in single_wheel_ht, single_wheel_st?",
        "Windows recognised as the class of their ground: paper ",
        "published 292 of 300, 97.3 % [94.8, 98.6]",
        "exceed the paper&#x27;s limits",
        "(published 15.2 / 11.7 / 15.5)",
        "ground (Table 6)",
        "lugwheel study everything.toml --out out",
        "6 = 2 × 3 × 1 (scenarios × entries of each sweep × repeats), 0 failed",
        "values = [0.0, 0.2, 0.4]",
    ] {
        assert!(STUDY_PAGE.replace("&#x2f;", "/").contains(part), "{part}");
    }
    assert!(!STUDY_PAGE.contains("Failed runs"));
}

/// Sand does not carry a hundred tonnes.
#[test]
fn a_run_that_failed_is_named_on_the_page_with_its_reason() {
    let folder = TempDir::new().unwrap();
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let file = folder.path().join("heavy.toml");
    let text = format!(
        "version = 1\nscenarios = [\"{}/single_wheel_st.toml\"]\nseed = 1\nrepeats = 1\n\
         random_numbers = \"common\"\n[set]\nduration = 0.5\nphysics_rate = 4000\n\
         [[sweep]]\nkey = \"rig.single_wheel.load\"\nvalues = [100.0, 1e6]\n",
        scenarios.display()
    );
    fs::write(&file, text).unwrap();
    let study = Study::load(&file).unwrap();
    let options = Options {
        out: folder.path().join("out"),
        jobs: None,
        resume: false,
        shard: None,
    };
    let outcome = study
        .execute(&options, &|_| ControlFlow::Continue(()))
        .unwrap();
    let html = page(&study_page(&StudyReport {
        study: &study,
        name: "heavy",
        outcome: &outcome,
        stills: &[],
        facts: &[],
        commands: &[],
    }));
    let failure = &outcome.failures[0];
    assert_eq!((outcome.failures.len(), failure.run), (1, 1));
    assert!(html.contains("1 of 2 runs failed."));
    assert!(html.contains("single_wheel_st, rig.single_wheel.load = 1000000.0"));
    assert!(
        html.contains("Drawbar pull") || html.contains("The wheel pulls "),
        "the other run counts"
    );
}
