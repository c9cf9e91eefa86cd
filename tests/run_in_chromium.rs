//! A run in a page as a reader meets it: the wheel moves, traces are zoomed, values are read off.

use crate::chromium::play;
use lugwheel::quantity::Seed;
use lugwheel::report::page::Provenance;
use lugwheel::report::{page, run_page};
use lugwheel::scenario::Scenario;
use lugwheel::trace::{Channel, RunAttributes, Trace};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::LazyLock;

/// Widths [px] of a screen and of a telephone.
const SCREEN: u32 = 1280;
const TELEPHONE: u32 = 390;

/// Where the slider is put [s].
const SLID: f64 = 1.5;

fn simulated(ground: &str) -> Trace {
    let name = format!("scenarios/single_wheel_{ground}.toml");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(&name);
    let text = std::fs::read_to_string(path).unwrap();
    let scenario = Scenario::from_toml(&text, &name).unwrap();
    let scenario = scenario.with("duration=3").unwrap();
    let go_on = &mut |_: f64| ControlFlow::Continue(());
    scenario.run(Seed(1), 0, go_on).unwrap().as_kept()
}

fn shown(trace: &Trace) -> String {
    page(&run_page(trace, "run_000000", Provenance::default()).unwrap())
}

static SAND: LazyLock<(Trace, Value)> = LazyLock::new(|| {
    let trace = simulated("st");
    let seen = play(&shown(&trace), SCREEN, SLID);
    (trace, seen)
});

/// The number before the unit, as it is written in a page.
fn number(text: &Value) -> f64 {
    let text = text.as_str().unwrap().replace('−', "-");
    text.split(' ').next().unwrap().parse().unwrap()
}

/// The sample of a channel nearest to a time [s].
fn sample(trace: &Trace, name: &str, time: f64) -> f64 {
    let channel = trace.channel(name).unwrap();
    let index = ((time - channel.start) * channel.sample_rate).round();
    channel.samples[index as usize]
}

/// The time [s] at which values are said to be.
fn time_of(seen: &Value) -> f64 {
    let said = seen["at"].as_str().unwrap();
    said.split(' ').nth(2).unwrap().parse().unwrap()
}

/// That every value in the page is the sample of its channel, to the digits that are written.
fn assert_values_are_samples(trace: &Trace, seen: &Value) {
    let time = time_of(seen);
    for (name, factor) in [
        ("acceleration_y", 1.0),
        ("normal_force", 1.0),
        ("drawbar_pull", 1.0),
        ("driving_torque", 1.0),
        ("sinkage", 1e3),
        ("slip_ratio", 1.0),
        ("wheel_angle", 1.0),
        ("forward_speed", 1e3),
    ] {
        let read = number(&seen["values"][name]);
        // The time is written to 0.1 ms: rounding may take it to the next sample.
        let mut times = [time, time - 5e-5, time + 5e-5].into_iter();
        let is_sample = |time| {
            let stored = factor * sample(trace, name, time);
            (read - stored).abs() <= 6e-6 * stored.abs() + 1e-12
        };
        assert!(times.any(is_sample), "{name} at {time} s: {read}");
    }
}

#[test]
fn the_slider_moves_the_wheel_the_cursor_and_the_values() {
    let (trace, seen) = &*SAND;
    assert_eq!(seen["errors"], serde_json::json!([]));
    let (start, slid) = (&seen["start"], &seen["slid"]);
    assert_eq!(slid["clock"], "1.50 s");
    for moved in ["wheel", "rut", "cursor"] {
        assert!(slid[moved].is_string(), "{moved}");
        assert_ne!(start[moved], slid[moved], "{moved}");
    }
    assert_eq!(slid["lugs"], 28);
    assert_eq!(slid["arrows"], 3, "normal force, pull, torque");
    let bearing = trace.truth.iter().flat_map(|truth| &truth.contacts);
    let bearing = bearing.filter(|contact| (contact.start..=contact.end).contains(&SLID));
    assert_eq!(slid["bearing"], bearing.count());
    assert_values_are_samples(trace, slid);
}

#[test]
fn the_pointer_reads_samples_off_and_a_click_brings_the_wheel_there() {
    let (trace, seen) = &*SAND;
    let (hovered, clicked) = (&seen["hovered"], &seen["clicked"]);
    assert!((time_of(hovered) - 0.75).abs() < 0.01);
    assert_values_are_samples(trace, hovered);
    assert_eq!(hovered["clock"], "1.50 s", "the wheel stays");
    let slider = clicked["slider"].as_f64().unwrap();
    assert!((slider - 0.75).abs() < 0.02, "{slider}");
    assert_ne!(clicked["wheel"], hovered["wheel"]);
}

#[test]
fn a_drag_keys_the_mouse_wheel_and_two_fingers_zoom_to_more_detail() {
    let (_, seen) = &*SAND;
    let points = |at: &str| seen[at]["points"][0].as_u64().unwrap();
    let times = |at: &str| seen[at]["times"].as_array().unwrap().clone();
    // 6000 samples on a thousand pixels, by bounds; a tenth of them, one by one.
    assert!(points("slid") < 6000 && (600..=604).contains(&points("dragged")));
    for zoomed in ["dragged", "zoomed", "wheeled", "pinched"] {
        assert_ne!(times(zoomed), times("slid"), "{zoomed}");
    }
    assert_eq!(
        times("stepped"),
        times("slid"),
        "0 brings the whole run back"
    );
    // A hundredth of the view.
    let step = seen["stepped"]["slider"].as_f64().unwrap();
    assert!((step - 0.03).abs() < 0.011, "{step}");
    // Two fingers a fifth of the run apart take it as wide as the frame.
    assert!((1190..=1210).contains(&points("pinched")));
}

#[test]
fn a_run_plays_until_it_is_paused() {
    let (_, seen) = &*SAND;
    assert_eq!(seen["playing"], "Pause");
    let played = seen["played"]["slider"].as_f64().unwrap();
    assert!(played > 0.005 && played < 3.0, "{played}");
    assert_eq!(seen["rested"]["wheel"], seen["played"]["wheel"]);
}

#[test]
fn on_a_telephone_panels_are_stacked_and_no_label_lies_on_another() {
    for ground in ["ht", "st", "hgt"] {
        let seen = play(&shown(&simulated(ground)), TELEPHONE, SLID);
        assert_eq!(seen["errors"], serde_json::json!([]), "{ground}");
        assert_eq!(seen["pageWidth"], TELEPHONE, "{ground}");
        assert_eq!(seen["overlaps"], serde_json::json!([]), "{ground}");
        assert_eq!(seen["slid"]["panels"].as_array().unwrap().len(), 8);
    }
    assert_eq!(SAND.1["overlaps"], serde_json::json!([]));
}

/// A rig that records two channels, one of them of its own kind, with a gap.
fn measured() -> Trace {
    let channel = |name: &str, unit: &str, rate: f64| Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        sample_rate: rate,
        start: 0.0,
        samples: (0..(3.0 * rate) as usize)
            .map(|i| 0.25 * f64::from(i as u32 % 7))
            .collect(),
    };
    let mut pull = channel("drawbar_pull", "N", 50.0);
    pull.samples[70..80].fill(f64::NAN);
    Trace {
        attributes: RunAttributes {
            wheel_radius: f64::NAN,
            lug_height: f64::NAN,
            load: f64::NAN,
            speed: f64::NAN,
            slip_ratio: f64::NAN,
            ..RunAttributes::default()
        },
        channels: vec![pull, channel("motor <current>", "A", 100.0)],
        ..Trace::default()
    }
}

#[test]
fn a_measured_run_without_wheel_or_ground_has_its_traces_and_is_told_what_is_missing() {
    let seen = play(&shown(&measured()), TELEPHONE, SLID);
    assert_eq!(seen["errors"], serde_json::json!([]));
    assert_eq!(
        seen["slid"]["panels"],
        serde_json::json!(["Forces [N]", "motor <current> [A]"])
    );
    assert_eq!(seen["slid"]["wheel"], Value::Null);
    assert_eq!(seen["slid"]["values"]["drawbar_pull"], "–", "in the gap");
    assert_eq!(seen["slid"]["values"]["motor <current>"], "0.75 A");
    let notes = seen["slid"]["notes"].to_string();
    for missing in [
        "Not recorded: acceleration_y",
        "no wheel radius",
        "leave gaps",
    ] {
        assert!(notes.contains(missing), "{missing}: {notes}");
    }
}

#[test]
fn a_wheel_is_drawn_over_level_ground_where_no_profile_was_recorded() {
    let mut trace = simulated("st").as_measured();
    trace.channels.retain(|channel| channel.name != "sinkage");
    let seen = play(&shown(&trace), SCREEN, SLID);
    assert_eq!(seen["errors"], serde_json::json!([]));
    assert_eq!(seen["slid"]["lugs"], 28);
    let notes = seen["slid"]["notes"].to_string();
    for told in ["profile was not recorded", "standing on the ground"] {
        assert!(notes.contains(told), "{told}: {notes}");
    }
}

#[test]
fn fifteen_seconds_take_less_than_3_mb_and_a_longer_record_is_kept_by_its_bounds() {
    let mut trace = simulated("st");
    let page = shown(&trace);
    assert!(5 * page.len() < 3_000_000, "{} bytes for 3 s", page.len());
    let pull = trace.channels.iter_mut();
    let pull = pull.filter(|channel| channel.name == "drawbar_pull");
    for channel in pull {
        channel.samples = (0..400_000).map(|i| f64::from(i % 1000)).collect();
        channel.sample_rate = 400_000.0 / 3.0;
        channel.samples[200_000] = 5000.0;
    }
    let seen = play(&shown(&trace), SCREEN, SLID);
    let notes = seen["slid"]["notes"].to_string();
    assert!(notes.contains("of 400000 samples, the least and the greatest of each 7 are shown"));
    let read = seen["slid"]["values"]["drawbar_pull"].as_str().unwrap();
    assert!(read.contains("to 5000 N"), "{read}");
}
