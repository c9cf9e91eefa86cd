//! Figures of runs: well-formed whatever a run holds, and honest about what it does not.

use lugwheel::features::record::Unusable;
use lugwheel::gap::{
    Cell, Comparison, Margins, ParameterSpread, Reading, Readings, Run, Statistic,
};
use lugwheel::identification::{Identified, Parameter, Standing};
use lugwheel::quantity::Seed;
use lugwheel::recognition::confusion::Confusion;
use lugwheel::recognition::{Answer, Recognized};
use lugwheel::report::figure::Layout;
use lugwheel::report::{
    FeaturePoint, Group, IdentifiedGround, ReportError, confusion_figure, feature_planes,
    feature_values, gap_map, laid_out_trace_figure, parameter_figure, trace_figure,
    traverse_figure,
};
use lugwheel::scenario::Scenario;
use lugwheel::terrain::class::{TerrainLabel, Wtic};
use lugwheel::trace::{Channel, ClassWindow, Mean, RunAttributes, Trace, Truth};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Length of the made-up runs [s] and their wheel speed [rad/s].
const DURATION: f64 = 15.0;
const WHEEL_SPEED: f64 = 0.5;

fn channel(name: &str, unit: &str, rate: f64, value: impl Fn(f64) -> f64) -> Channel {
    let samples = (0..(DURATION * rate) as usize).map(|i| value(i as f64 / rate));
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        sample_rate: rate,
        start: 0.0,
        samples: samples.collect(),
    }
}

/// Repeats in 0..1 with every lug pass.
fn lug_phase(t: f64) -> f64 {
    (28.0 * WHEEL_SPEED * t / TAU).fract()
}

/// Each lug strikes and rings at 60 Hz.
fn impacts(t: f64) -> f64 {
    let since = lug_phase(t) * TAU / (28.0 * WHEEL_SPEED);
    1.5 * libm::exp(-since / 0.02) * libm::cos(TAU * 60.0 * since)
}

/// A run such as the paper's single wheel would leave on sand, with one impulse each lug pass.
fn sand() -> Trace {
    let speed = 0.9 * 0.14 * WHEEL_SPEED;
    let window = |start: f64, class, terrain| ClassWindow {
        start,
        end: start + 1.0,
        class,
        terrain,
        lugs: None,
    };
    let windows = (0..15).map(|i| match i {
        0..=8 => window(f64::from(i), Wtic::Leis, TerrainLabel::Sand),
        9 => window(9.0, Wtic::Uwtic, TerrainLabel::Sand),
        _ => window(f64::from(i), Wtic::Slct, TerrainLabel::SandWithGravel),
    });
    let ground = |i: i32| {
        let x = f64::from(i) * 0.005;
        [x, 0.003 * libm::sin(9.0 * x)]
    };
    Trace {
        attributes: RunAttributes {
            wheel_radius: 0.14,
            wheel_width: 0.15,
            lug_count: Some(28),
            lug_height: 0.015,
            wheel_mass: Some(4.0),
            plate: None,
            slope_deg: 0.0,
            load: 100.0,
            speed,
            slip_ratio: 0.1,
            terrain: Some(TerrainLabel::Sand),
            class: Some(Wtic::Leis),
            repeat: 1,
            day: "2".to_owned(),
            notes: "synthetic".to_owned(),
            physics_rate: Some(128_000.0),
            ..RunAttributes::default()
        },
        channels: vec![
            channel("acceleration_y", "m/s^2", 2000.0, impacts),
            channel("normal_force", "N", 200.0, |t| {
                100.0 + 6.0 * libm::sin(TAU * lug_phase(t))
            }),
            channel("drawbar_pull", "N", 200.0, |t| {
                18.0 + 3.0 * libm::cos(TAU * lug_phase(t))
            }),
            channel("driving_torque", "N m", 200.0, |t| {
                4.1 + 0.4 * libm::sin(TAU * lug_phase(t))
            }),
            channel("sinkage", "m", 50.0, |t| {
                0.011 - 0.011 * libm::exp(-t / 0.6)
            }),
            channel("slip_ratio", "1", 50.0, |t| {
                0.1 + 0.01 * libm::sin(TAU * lug_phase(t))
            }),
            channel("wheel_angle", "rad", 500.0, |t| WHEEL_SPEED * t),
            channel("forward_speed", "m/s", 50.0, |_| speed),
        ],
        means: Vec::new(),
        truth: Some(Truth {
            class_windows: windows.collect(),
            profile: (-60..400).map(ground).collect(),
            ..Truth::default()
        }),
    }
}

fn replaced(mut trace: Trace, name: &str, edit: impl Fn(&mut Channel)) -> Trace {
    let mut channels = trace.channels.iter_mut();
    edit(channels.find(|channel| channel.name == name).unwrap());
    trace
}

/// Fails unless `xml` is one element with balanced tags, quoted attributes, known entities.
fn assert_well_formed(xml: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = xml.trim();
    let mut elements = 0;
    while let Some(start) = rest.find('<') {
        assert!(
            start == 0 || !open.is_empty(),
            "text outside: {}",
            &rest[..start]
        );
        assert_entities(&rest[..start]);
        let end = start + rest[start..].find('>').expect("a tag without an end");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
            continue;
        }
        assert!(!open.is_empty() || elements == 0, "two roots");
        elements += 1;
        let body = tag.strip_suffix('/').unwrap_or(tag);
        assert_attributes(body);
        if body.len() == tag.len() {
            open.push(body.split_whitespace().next().unwrap());
        }
    }
    assert!(open.is_empty(), "still open: {open:?}");
    assert!(rest.is_empty(), "after the root: {rest}");
}

fn assert_entities(text: &str) {
    for part in text.split('&').skip(1) {
        let name = part.split(';').next().unwrap();
        assert!(
            ["amp", "lt", "gt", "quot", "#39"].contains(&name),
            "&{name}"
        );
    }
    assert!(
        text.chars().all(|c| c >= ' ' || c == '\n'),
        "control character"
    );
}

fn assert_attributes(tag: &str) {
    let pieces: Vec<&str> = tag.split('"').collect();
    assert_eq!(pieces.len() % 2, 1, "quotes of <{tag}>");
    let mut names: Vec<&str> = Vec::new();
    for pair in pieces.chunks_exact(2) {
        assert_entities(pair[1]);
        let name = pair[0].split_whitespace().last().unwrap();
        assert!(name.ends_with('='), "{name} in <{tag}>");
        assert!(!names.contains(&name), "{name} twice in <{tag}>");
        names.push(name);
    }
    assert!(!tag.contains("NaN") && !tag.contains("inf"), "<{tag}>");
}

#[test]
fn a_whole_run_is_drawn_whole() {
    let svg = trace_figure(&sand(), "003").unwrap();
    assert_well_formed(&svg);
    for header in [
        "Run 003: sand (ST)",
        "28 lugs of 15 mm",
        "Wheel and ground at 7.5",
        "LEIS on ST",
        "SLCT on SGT",
        "Vertical acceleration",
        "drawbar pull <tspan font-style=\"italic\">F</tspan><tspan font-size=\"10.08\" dy=\"3.08\">DP<",
        "Driving torque",
        "Sinkage",
        "Slip ratio",
        "order per lug pass",
    ] {
        assert!(svg.contains(header), "{header}");
    }
    assert!(!svg.contains("Not recorded"));
    // 45 000 samples; the acceleration alone would take 400 kB as text.
    assert!(svg.len() < 250_000, "{} bytes", svg.len());
}

#[test]
fn a_run_after_a_lead_in_is_drawn_where_on_its_track_it_was() {
    let place = |edits: [&str; 2]| -> f64 {
        let name = "scenarios/single_wheel_ht.toml";
        let path = format!("{}/{name}", env!("CARGO_MANIFEST_DIR"));
        let scenario = Scenario::from_toml(&std::fs::read_to_string(path).unwrap(), name).unwrap();
        let scenario = scenario.with_all(&edits).unwrap();
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        let svg = trace_figure(&scenario.run(Seed(1), 0, go_on).unwrap(), "1").unwrap();
        let (_, still) = svg.split_once("Wheel and ground at 2.50 s, ").unwrap();
        still.split(' ').next().unwrap().parse().unwrap()
    };
    let whole = place(["lead_in=0", "duration=5"]);
    let late = place(["lead_in=2", "duration=1"]);
    assert!(
        whole > 25.0 && (whole - late).abs() <= 1.0,
        "{whole} mm, {late} mm"
    );
}

/// A column of a paper is 88 mm wide, its text 10 pt and its captions 8 pt high.
#[test]
fn a_figure_for_a_column_has_letters_of_7_pt_and_no_title_if_none_is_asked_for() {
    for (width, is_compact) in [(88.0, true), (180.0, false)] {
        let layout = Layout::on_paper(width, false);
        assert_eq!(layout.is_compact(), is_compact);
        let svg = laid_out_trace_figure(&sand(), "003", layout).unwrap();
        assert_well_formed(&svg);
        assert!(svg.contains(&format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm""#
        )));
        let points_per_pixel = width / layout.width * 72.0 / 25.4;
        assert!((14.0 * points_per_pixel - 7.0).abs() < 1e-9 && svg.contains(r#"font-size="14""#));
        assert!(!svg.contains("Run 003: sand") && !svg.contains("28 lugs"));
        assert_eq!(svg.contains("Order spectrum"), !is_compact);
    }
}

#[test]
fn every_channel_may_be_missing_and_is_then_named() {
    for channel in sand().channels {
        let mut trace = sand();
        trace.channels.retain(|kept| kept.name != channel.name);
        let svg = trace_figure(&trace, "1").unwrap();
        assert_well_formed(&svg);
        let remark = format!("Not recorded: {}.", channel.name);
        assert!(svg.contains(&remark), "{remark}");
    }
}

#[test]
fn a_run_of_means_alone_shows_its_means() {
    let trace = Trace {
        attributes: sand().attributes,
        means: vec![Mean {
            name: "drawbar_pull".to_owned(),
            unit: "N".to_owned(),
            value: 18.25,
            sd: 1.5,
            n: 30,
        }],
        ..Trace::default()
    };
    let svg = trace_figure(&trace, "7").unwrap();
    assert_well_formed(&svg);
    assert!(svg.contains("drawbar_pull: 18.25 ± 1.500 N"));
    assert!(svg.contains("Not recorded: acceleration_y, normal_force"));
}

#[test]
fn what_nobody_knows_of_a_measured_run_is_not_written() {
    let mut trace = Trace {
        attributes: sand().attributes,
        means: vec![Mean {
            name: "drawbar_pull".to_owned(),
            unit: "N".to_owned(),
            value: 18.25,
            sd: f64::NAN,
            n: 0,
        }],
        ..Trace::default()
    };
    trace.attributes.load = f64::NAN;
    trace.attributes.wheel_width = f64::NAN;
    let svg = trace_figure(&trace, "7").unwrap();
    assert!(svg.contains("drawbar_pull: 18.25 N<") && !svg.contains("NaN"));
    assert!(svg.contains("mm/s   |   slip ") && !svg.contains("load "));
}

#[test]
fn channels_that_are_empty_or_no_numbers_are_remarked_upon_and_never_panic() {
    type Edit = fn(&mut Channel);
    let faults: [(Edit, &str); 5] = [
        (|c| c.samples.clear(), "no samples"),
        (|c| c.samples.fill(f64::NAN), "is a finite number"),
        (|c| c.samples[100] = f64::INFINITY, "1 of"),
        (|c| c.sample_rate = 0.0, "a sample rate of 0 Hz"),
        (|c| c.start = f64::NAN, "from NaN s"),
    ];
    for channel in sand().channels {
        for (fault, remark) in faults {
            let svg = trace_figure(&replaced(sand(), &channel.name, fault), "1").unwrap();
            assert_well_formed(&svg);
            assert!(
                svg.contains(&format!("{}: ", channel.name)),
                "{}",
                channel.name
            );
            assert!(svg.contains(remark), "{}: {remark}", channel.name);
        }
        let one_sample = replaced(sand(), &channel.name, |c| c.samples.truncate(1));
        assert_well_formed(&trace_figure(&one_sample, "1").unwrap());
    }
}

#[test]
fn a_run_of_nothing_is_an_error_with_its_name() {
    let error = trace_figure(&Trace::default(), "17").unwrap_err();
    assert_eq!(error, ReportError::Empty("17".to_owned()));
    let only_nan = Trace {
        channels: vec![channel("sinkage", "m", 10.0, |_| f64::NAN)],
        ..Trace::default()
    };
    assert!(trace_figure(&only_nan, "17").is_err());
}

#[test]
fn names_from_a_file_cannot_add_markup_or_break_the_drawing() {
    let mut trace = sand();
    trace.attributes.notes = "</text><script>&\u{0}\u{1b}".repeat(40);
    trace.channels[0].name = "<b onload='x'>".to_owned();
    let svg = trace_figure(&trace, "\"><script>").unwrap();
    assert_well_formed(&svg);
    assert!(!svg.contains("<script") && !svg.contains("<b "));
}

/// Windows of three grounds, some of them with features that cannot be drawn.
fn points() -> Vec<FeaturePoint> {
    let grounds = [
        (TerrainLabel::Hard, [0.0, 0.1, 0.1, 0.2]),
        (TerrainLabel::Gravel, [-0.3, 0.9, 1.2, 1.8]),
        (TerrainLabel::Sand, [-0.02, -1.3, -0.2, -1.9]),
    ];
    let windows = grounds.iter().flat_map(|(terrain, p)| {
        (0..7).map(|i| FeaturePoint {
            group: Group::Terrain(*terrain),
            p: p.map(|p| p + 0.01 * f64::from(i)),
        })
    });
    let broken = [f64::NAN, f64::NEG_INFINITY].map(|value| FeaturePoint {
        group: Group::Terrain(TerrainLabel::Sand),
        p: [0.0, value, 0.0, 0.0],
    });
    windows.chain(broken).collect()
}

/// How often `part` is in `text`.
fn count(text: &str, part: &str) -> usize {
    text.matches(part).count()
}

#[test]
fn feature_values_show_every_window_in_every_panel_with_medians() {
    let svg = feature_values(&points());
    assert_well_formed(&svg);
    // Seven round marks of hard ground in each of four panels.
    assert_eq!(count(&svg, "<circle"), 28);
    for header in [
        ", frequency",
        ", sum of amplitudes",
        ", mean value",
        ", mean square",
    ] {
        // The header, and the reading of each of the 21 windows drawn.
        assert_eq!(count(&svg, header), 1 + 21, "{header}");
    }
    // The median of seven is the fourth.
    for median in ["0.03, n = 7", "1.23, n = 7", "−1.87, n = 7"] {
        assert!(svg.contains(median), "{median}");
    }
    assert!(svg.contains("2 of 23 windows"), "what is left out is told");
}

#[test]
fn feature_planes_show_every_window_six_times_over_the_paper_s_regions() {
    let svg = feature_planes(&points(), 28);
    assert_well_formed(&svg);
    // And once in the legend; so are the three regions.
    assert_eq!(count(&svg, "<circle"), 6 * 7 + 1);
    assert_eq!(count(&svg, "fill-opacity"), 6 * 3 + 3);
    assert!(svg.contains("2 of 23 windows") && svg.contains("GT, gravel"));
    for empty in [feature_planes(&[], 28), feature_values(&[])] {
        assert_well_formed(&empty);
    }
}

fn recognized(start: f64, class: Wtic) -> Recognized {
    Recognized {
        start,
        end: start + 5.0,
        lug_passes: 3.0,
        p: Err(Unusable::Constant),
        answers: vec![Answer {
            class,
            confidence: 0.875,
            reason: "<made up>".to_owned(),
            offset: None,
        }],
    }
}

#[test]
fn a_traverse_shows_answers_above_the_truth_and_needs_only_acceleration() {
    let classes = [Wtic::Leis, Wtic::Uwtic, Wtic::Slct];
    let windows: Vec<Recognized> = (0..3)
        .map(|i| recognized(5.0 * f64::from(i), classes[i as usize]))
        .collect();
    let svg = traverse_figure(&sand(), "traverse <1>", &windows).unwrap();
    assert_well_formed(&svg);
    for part in ["LEIS 0.88", "UWTIC 0.88", "True class", "LEIS on ST"] {
        assert!(svg.contains(part), "{part}");
    }
    assert!(svg.len() < 120_000, "{} bytes", svg.len());
    let mut measured = sand();
    measured.truth = None;
    let unlabelled = traverse_figure(&measured, "1", &[]).unwrap();
    assert_well_formed(&unlabelled);
    assert!(!unlabelled.contains("True class"));
    measured.channels.clear();
    let error = traverse_figure(&measured, "1", &windows).unwrap_err();
    assert_eq!(error, ReportError::Empty("1".to_owned()));
}

#[test]
fn a_peak_far_beyond_the_others_is_cut_and_told_so_that_they_show() {
    let windows: Vec<Recognized> = (0..3)
        .map(|i| recognized(5.0 * f64::from(i), Wtic::Slct))
        .collect();
    let whole = traverse_figure(&sand(), "1", &windows).unwrap();
    assert!(!whole.contains("cut"), "equal peaks stay whole");
    let struck = replaced(sand(), "acceleration_y", |c| c.samples[25_000] = 2500.0);
    let svg = traverse_figure(&struck, "1", &windows).unwrap();
    assert_well_formed(&svg);
    assert!(svg.contains("[m/s²]; cut, peaks reach 2500"), "{svg}");
}

#[test]
fn a_confusion_matrix_shows_counts_shares_and_what_did_not_occur() {
    let mut confusion = Confusion::default();
    for answer in [Wtic::Alct, Wtic::Alct, Wtic::Alct, Wtic::Uwtic] {
        confusion.add(Wtic::Alct, answer);
    }
    let svg = confusion_figure(&confusion, "HT & ST");
    assert_well_formed(&svg);
    for part in [">3<", "75.0 %", "25.0 %", "HT &amp; ST", "of 4 windows"] {
        assert!(svg.contains(part), "{part}");
    }
    assert_eq!(count(&svg, "did not occur"), 3);
    let nothing = confusion_figure(&Confusion::default(), "");
    assert_well_formed(&nothing);
    assert!(nothing.contains("no window has a known class"));
}

/// A run whose pull is off by `shift` standard deviations or so.
fn gap_run(number: u32, shift: f64) -> Run {
    let scatter = |place: u32| libm::sin(f64::from(7 * number + 3 * place));
    let readings = [
        ("acceleration_y", Statistic::OrderLevel(28), 0.0),
        ("drawbar_pull", Statistic::SteadyMean, shift),
        ("normal_force~drawbar_pull", Statistic::Coherence, 0.0),
    ];
    let reading = |(place, (channel, statistic, off)): (usize, (&str, Statistic, f64))| {
        let value = 20.0 + scatter(place as u32) + off;
        (Cell::new(channel, statistic), Reading { value, size: 20.0 })
    };
    Run {
        attributes: RunAttributes {
            slip_ratio: 0.1,
            notes: "<markup>".to_owned(),
            ..RunAttributes::default()
        },
        readings: Readings::from_iter(readings.into_iter().enumerate().map(reading)),
        loads: Vec::new(),
    }
}

#[test]
fn a_gap_map_is_well_formed_and_names_the_strongest_cell_of_every_field() {
    let replicates: Vec<Run> = (0..8).map(|number| gap_run(number, 0.0)).collect();
    let comparison = Comparison::new(&[gap_run(20, 30.0)], &replicates).unwrap();
    let map = comparison.map(&Margins::default(), &ParameterSpread::new(), Seed(1));
    let svg = gap_map(&map, "sand & <stones>");
    assert_well_formed(&svg);
    for text in [
        "28",
        "mean",
        "coherence",
        "with drawbar_pull",
        "slip 0.1",
        "gap: 1 cells",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(svg.contains("Note: no condition was measured twice"));
}

#[test]
fn parameters_are_drawn_as_what_they_are_fixed_open_or_set() {
    let parameter = |(parameter, value): (Parameter, f64)| Identified {
        parameter,
        value,
        standing: match parameter {
            Parameter::Cohesion => Standing::SetByClass,
            Parameter::SinkageModulus => Standing::NotIdentifiable,
            _ => Standing::Identified,
        },
        unidentifiable: None,
        standard_error: 0.1,
        interval: [Some(0.9 * value), Some(1.1 * value)],
        // The profile of K never ends.
        profile: (parameter == Parameter::ShearModulus).then_some([Some(0.9 * value), None]),
    };
    // Gravel's row of Table 6.
    let values = [0.0, 0.0, 4.0e8, 0.568, 0.054, 0.0, 32.17, 0.0006];
    let ground = IdentifiedGround {
        name: "GT & stones".to_owned(),
        label: TerrainLabel::Gravel,
        parameters: Parameter::ALL
            .into_iter()
            .zip(values)
            .map(parameter)
            .collect(),
        own: vec![None; 8],
    };
    for grounds in [vec![], vec![ground.clone()], vec![ground; 3]] {
        let figure = parameter_figure(&grounds);
        assert_well_formed(&figure);
        let count = |text: &str| figure.matches(&format!(">{text}<")).count();
        assert_eq!(count("not fixed"), grounds.len());
        assert_eq!(count("set to 0"), grounds.len());
        assert_eq!(count("32.2"), grounds.len());
    }
}
