//! Pages as a reader meets them: on a screen, on a telephone, on paper.

mod chromium;

use chromium::{look, sheets};
use lugwheel::recognition::confusion::Confusion;
use lugwheel::report::page::{Cell, Code, Column, Figure, Page, Provenance, Section, Table};
use lugwheel::report::{confusion_figure, page};

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
