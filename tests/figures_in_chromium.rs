//! Figures of a page as a reader uses them: values are read off, and what is dense is zoomed.

use crate::chromium::point_at;
use lugwheel::report::figure::Layout;
use lugwheel::report::page::{Figure, Page, Section};
use lugwheel::report::{SweptKey, page, sweep_figure, trace_figure};
use lugwheel::study::conditions::{Condition, Mean, QUANTITIES};
use lugwheel::trace::{Channel, RunAttributes, Trace};
use serde_json::{Value, json};
use std::sync::LazyLock;

/// Widths [px] of a screen and of a telephone.
const SCREEN: u32 = 1280;
const TELEPHONE: u32 = 390;
/// Where lines are read, in parts of their frame.
const PLACES: [f64; 3] = [0.25, 0.5, 0.9];

const KEY: &str = "rig.single_wheel.slip";
const SLIPS: [&str; 3] = ["0.0", "0.1", "0.3"];
const PULLS: [f64; 3] = [-2.5, 11.25, 30.75];

fn conditions() -> Vec<Condition> {
    let condition = |(slip, pull): (&str, f64)| {
        let mut means = [None; QUANTITIES.len()];
        means[0] = Mean::of(&[pull]);
        Condition {
            scenario: "sand".to_owned(),
            values: vec![slip.to_owned()],
            runs: 1,
            failed: 0,
            means,
            unsteady: Vec::new(),
        }
    };
    SLIPS.into_iter().zip(PULLS).map(condition).collect()
}

/// A pull that rises by 2 N/s for 10 s.
fn rising() -> Trace {
    let pull = Channel {
        name: "drawbar_pull".to_owned(),
        unit: "N".to_owned(),
        sample_rate: 400.0,
        start: 0.0,
        samples: (0..=4000).map(|i| 2.0 * f64::from(i) / 400.0).collect(),
    };
    Trace {
        attributes: RunAttributes::default(),
        channels: vec![pull],
        ..Trace::default()
    }
}

fn shown() -> String {
    let conditions = conditions();
    let swept = SweptKey {
        key: KEY,
        keys: vec![KEY],
        conditions: &conditions,
        methods: Vec::new(),
    };
    let over_slip = sweep_figure(&swept, Layout::SCREEN);
    let over_time = trace_figure(&rising(), "rising").unwrap();
    let section = Section::new("Figures")
        .figure(Figure::new(over_slip, "Pull over slip."))
        .figure(Figure::new(over_time, "Pull over time."));
    page(&Page {
        sections: vec![section],
        ..Page::default()
    })
}

static SEEN: LazyLock<Value> = LazyLock::new(|| point_at(&shown(), SCREEN, &PLACES));

/// What the marks of the first figure say: pull and slip as stored.
fn readings() -> Vec<String> {
    let written = ["−2.500", "11.25", "30.75"];
    let pairs = SLIPS.iter().zip(written);
    pairs
        .map(|(slip, pull)| format!("sand: drawbar pull {pull} N at {KEY} = {slip}"))
        .collect()
}

#[test]
fn a_pointer_a_finger_and_the_keyboard_read_the_data_of_a_mark_with_both_values_and_units() {
    assert_eq!(SEEN["errors"], json!([]));
    let figure = &SEEN["figures"][0];
    assert_eq!(figure["marks"], json!(readings()));
    assert_eq!(figure["left"], Value::Null, "gone with the pointer");
    assert_eq!(figure["touched"], json!(readings()[0]));
    assert_eq!(figure["stepped"], json!(readings()[0]));
    assert_eq!(figure["steppedOn"], json!(readings()[1]));
}

/// Number in front of a unit, in a line of a reading.
fn number(line: &str, before: &str) -> f64 {
    let text = line.strip_suffix(before).unwrap().rsplit(' ').next();
    text.unwrap().replace('−', "-").parse().unwrap()
}

#[test]
fn a_line_is_read_where_the_pointer_is_as_finely_as_it_is_drawn() {
    let lines = SEEN["figures"][1]["lines"].as_array().unwrap();
    for (place, line) in PLACES.iter().zip(lines) {
        let mut rows = line.as_str().unwrap().lines();
        let time = number(rows.next().unwrap(), " s");
        let pull = rows.next().unwrap().split(" to ").last().unwrap();
        let pull = number(pull, " N");
        // A pixel of a frame of about 1090 px is 9 ms; its height is 150 px for 23 N.
        assert!((time - 10.0 * place).abs() < 0.02, "{line}");
        assert!((pull - 2.0 * time).abs() < 0.1, "{line}");
    }
    let stepped = SEEN["figures"][1]["stepped"].as_str().unwrap();
    assert!(stepped.starts_with("time 0.1"), "{stepped}");
}

#[test]
fn the_mouse_wheel_and_a_drag_zoom_with_ticks_in_view_and_a_double_click_shows_all() {
    for figure in SEEN["figures"].as_array().unwrap() {
        let view = |name: &str| -> Vec<f64> {
            let view = figure[name].as_array().unwrap().iter();
            view.map(|it| it.as_f64().unwrap()).collect()
        };
        let whole = view("whole");
        assert!((view("wheeled")[2] / whole[2] - 0.5).abs() < 1e-9);
        assert!(figure["ticks"].as_u64().unwrap() > 2, "{figure}");
        let dragged = view("dragged");
        assert!((dragged[2] / whole[2] - 0.25).abs() < 0.01, "{dragged:?}");
        assert!((dragged[0] / whole[2] - 0.25).abs() < 0.01, "{dragged:?}");
        assert_eq!(view("reset"), whole);
        assert_eq!(view("zeroed"), whole);
    }
    assert_eq!(SEEN["figures"][0]["zoomedMark"], json!(readings()[0]));
}

#[test]
fn on_a_telephone_every_mark_is_read_by_touch_and_the_page_stays_within_its_width() {
    let seen = point_at(&shown(), TELEPHONE, &PLACES);
    assert_eq!(seen["errors"], json!([]));
    assert_eq!(seen["pageWidth"], TELEPHONE);
    assert_eq!(seen["figures"][0]["marks"], json!(readings()));
    assert_eq!(seen["figures"][0]["touched"], json!(readings()[0]));
}
