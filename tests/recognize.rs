//! `lugwheel recognize`: right on hard ground and sand, and never sure of what it cannot know.

use lugwheel::dataset::Provenance;
use lugwheel::dataset::hdf5::{RunFile, RunFileWriter};
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use lugwheel::terrain::class::{TerrainLabel, Wtic};
use lugwheel::trace::{Channel, Trace};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Six lug passes at the paper's highest speed.
const EDITS: [&str; 3] = [
    "duration=8.5",
    "window=4.25",
    "rig.single_wheel.forward_speed=0.02",
];

static HARD: LazyLock<Trace> = LazyLock::new(|| simulated("single_wheel_ht"));
static SAND: LazyLock<Trace> = LazyLock::new(|| simulated("single_wheel_st"));

fn scenario(name: &str) -> Scenario {
    let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Scenario::load(path).unwrap().with_all(&EDITS).unwrap()
}

fn simulated(name: &str) -> Trace {
    let go_on = &mut |_| ControlFlow::Continue(());
    scenario(name).run(Seed(11), 0, go_on).unwrap()
}

/// A folder with these runs in `runs.h5`, as measured ones.
fn folder(runs: &[(&str, &Trace)]) -> TempDir {
    folder_of(&Provenance::measured(), runs)
}

fn folder_of(provenance: &Provenance, runs: &[(&str, &Trace)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("runs.h5"), provenance, runs);
    folder
}

fn write(path: &Path, provenance: &Provenance, runs: &[(&str, &Trace)]) {
    let mut file = RunFileWriter::create(path, provenance).unwrap();
    for (id, trace) in runs {
        file.add(id, trace).unwrap();
    }
    file.finish().unwrap();
}

/// `lugwheel recognize runs.h5` with more `words`.
fn recognize(folder: &TempDir, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lugwheel"))
        .current_dir(folder.path())
        .args(["recognize", "runs.h5"])
        .args(words.split_whitespace())
        .output()
        .unwrap()
}

fn done(output: Output) -> String {
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), errors.as_str()), (Some(0), ""));
    String::from_utf8(output.stdout).unwrap()
}

fn json(folder: &TempDir, words: &str) -> Value {
    let text = done(recognize(folder, &format!("--json {words}")));
    serde_json::from_str(&text).unwrap()
}

fn refused(folder: &TempDir, words: &str, code: i32, part: &str) {
    let output = recognize(folder, words);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{words}: {errors}");
    assert!(errors.contains(part), "{words}: {errors}");
    assert_eq!(output.stdout, b"");
}

/// Windows of a run edited from the one on hard ground.
fn windows_after(edit: impl Fn(&mut Trace), words: &str) -> Vec<Value> {
    let mut trace = HARD.clone();
    edit(&mut trace);
    let found = json(&folder(&[("r", &trace)]), words);
    found["windows"].as_array().unwrap().clone()
}

fn channel<'t>(trace: &'t mut Trace, name: &str) -> &'t mut Channel {
    let mut channels = trace.channels.iter_mut();
    channels.find(|channel| channel.name == name).unwrap()
}

fn acceleration(trace: &mut Trace) -> &mut Vec<f64> {
    &mut channel(trace, "acceleration_y").samples
}

fn without(trace: &mut Trace, name: &str) {
    trace.channels.retain(|channel| channel.name != name);
}

fn unlabelled(trace: &Trace) -> Trace {
    let mut trace = trace.clone();
    trace.truth = None;
    trace.attributes.terrain = None;
    trace.attributes.class = None;
    trace
}

#[test]
fn slate_is_alct_and_sand_is_leis_and_every_key_is_there() {
    let folder = folder(&[("hard", &HARD), ("sand", &SAND)]);
    let found = json(&folder, "--window 4.25");
    let windows = found["windows"].as_array().unwrap();
    assert_eq!(windows.len(), 4);
    for window in windows {
        let class = if window["run"] == "hard" {
            "ALCT"
        } else {
            "LEIS"
        };
        assert_eq!(
            (&window["class"], &window["truth"]),
            (&class.into(), &class.into())
        );
        let length = window["end_s"].as_f64().unwrap() - window["start_s"].as_f64().unwrap();
        assert!((length - 4.25).abs() < 1e-3, "{window}");
        let confidence = window["confidence"].as_f64().unwrap();
        assert!((0.5..=1.0).contains(&confidence), "{window}");
        assert!(window["reason"].as_str().unwrap().contains("lug passes"));
        assert_eq!(window["p"].as_array().unwrap().len(), 4);
    }
    let answers = ["ALCT", "SLCT", "LEIS", "UWTIC"];
    let row = |class: &str| answers.map(|answer| found["confusion"][class][answer].as_u64());
    assert_eq!(row("ALCT"), [2, 0, 0, 0].map(Some));
    assert_eq!(row("LEIS"), [0, 0, 2, 0].map(Some));
    assert_eq!(found["accuracy"], 1.0);
    assert_eq!(found["known_from"]["ground_truth"], 4);
    let said = done(recognize(&folder, "--run sand --window 4.25"));
    assert!(
        said.contains("accuracy 1.000 (0.342 to 1.000), 2 windows"),
        "{said}"
    );
}

#[test]
fn a_file_without_labels_is_recognised_but_not_scored() {
    let folder = folder(&[("r", &unlabelled(&HARD))]);
    let found = json(&folder, "");
    assert_eq!(found["windows"][0]["class"], "ALCT");
    assert_eq!(found["windows"][0]["truth"], Value::Null);
    assert!(found.get("confusion").is_none() && found.get("accuracy").is_none());
    let said = done(recognize(&folder, ""));
    assert!(said.contains("no class is known"), "{said}");
}

#[test]
fn a_measured_run_is_scored_by_its_class_or_else_by_its_terrain() {
    let mut labelled = unlabelled(&SAND);
    labelled.attributes.terrain = Some(TerrainLabel::Sand);
    let mut classed = labelled.clone();
    classed.attributes.class = Some(Wtic::Alct);
    let folder = folder(&[("classed", &classed), ("labelled", &labelled)]);
    let found = json(&folder, "");
    assert_eq!(found["known_from"]["terrain"], 1);
    assert_eq!(found["known_from"]["run_class"], 1);
    assert_eq!(found["confusion"]["ALCT"]["LEIS"], 1);
    assert_eq!(found["confusion"]["LEIS"]["LEIS"], 1);
}

#[test]
fn without_a_wheel_angle_turning_is_integrated_and_both_methods_answer() {
    let edit = |trace: &mut Trace| without(trace, "wheel_angle");
    let window = &windows_after(edit, "")[0];
    assert_eq!(window["class"], "ALCT");
    assert!(window.get("lug_offset").is_none());
    assert!(window["p"].as_array().unwrap().iter().all(Value::is_f64));
    // The second window: the first has a joint between bricks.
    let by_regions = windows_after(edit, "--method paper --window 4.25");
    assert_eq!(by_regions[1]["class"], "ALCT", "{by_regions:?}");
}

#[test]
fn the_zero_of_the_wheel_angle_is_found_and_stated() {
    let pitch = std::f64::consts::TAU / 28.0;
    for share in [0.0, 0.3, -0.45] {
        let mut trace = HARD.clone();
        let angles = &mut channel(&mut trace, "wheel_angle").samples;
        angles.iter_mut().for_each(|a| *a += share * pitch);
        let folder = folder(&[("r", &trace)]);
        let found = json(&folder, "");
        assert_eq!(found["windows"][0]["class"], "ALCT", "{share}");
        let zero = found["wheel_angle"][0]["zero_rad"].as_f64().unwrap() - share * pitch;
        let missed = zero - pitch * (zero / pitch).round();
        // Rough slate shifts single strikes by a tenth of the pitch.
        assert!(missed.abs() < 0.1 * pitch, "{share}: {found}");
        let said = done(recognize(&folder, ""));
        assert!(said.contains("a lug points straight down"), "{said}");
    }
}

/// Made by `tests/python/mujoco_wheel.py`.
#[test]
fn hard_ground_of_another_simulator_is_alct_whatever_the_encoder_s_zero() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/mujoco/lugged_wheel.h5");
    let file = RunFile::open(&path).unwrap();
    let runs: Vec<Trace> = file
        .runs()
        .iter()
        .map(|id| file.read(id).unwrap())
        .collect();
    let pitch = std::f64::consts::TAU / 28.0;
    for share in [0.0, 0.2, 0.4, 0.6, 0.8] {
        for run in &runs {
            let mut run = run.clone();
            let angles = &mut channel(&mut run, "wheel_angle").samples;
            angles.iter_mut().for_each(|a| *a += share * pitch);
            let found = json(&folder(&[("r", &run)]), "");
            assert_eq!(found["windows"][0]["class"], "ALCT", "{share}: {found}");
        }
    }
    for lugs in [14, 24, 27, 29, 56] {
        for run in &runs {
            let mut run = run.clone();
            run.attributes.lug_count = Some(lugs);
            let window = &json(&folder(&[("r", &run)]), "")["windows"][0];
            let doubtful = window["confidence"].as_f64().unwrap() <= 0.6;
            assert!(window["class"] == "ALCT" || doubtful, "{lugs}: {window}");
        }
    }
}

#[test]
fn windows_that_cannot_be_used_are_unknown_and_say_why() {
    type Edit = fn(&mut Trace);
    let cases: [(Edit, &str, &str); 7] = [
        (|t| acceleration(t)[500] = f64::NAN, "", "no numbers"),
        (|t| acceleration(t).fill(0.25), "", "constant"),
        (
            |t| {
                acceleration(t)
                    .iter_mut()
                    .for_each(|a| *a = a.clamp(-0.1, 0.1))
            },
            "",
            "clipped",
        ),
        (
            |t| channel(t, "wheel_angle").samples.fill(1.0),
            "",
            "at rest",
        ),
        (|t| acceleration(t).truncate(2000), "", "lug passes"),
        (
            |_| {},
            "--method paper --window 1",
            "lug passes in the window",
        ),
        (
            |t| {
                let sparse = acceleration(t).iter().copied().step_by(20).collect();
                *acceleration(t) = sparse;
                channel(t, "acceleration_y").sample_rate = 100.0;
            },
            "",
            "sample rate 100 Hz is below",
        ),
    ];
    for (edit, words, reason) in cases {
        let window = &windows_after(edit, words)[0];
        assert_eq!(window["class"], "UWTIC", "{reason}");
        assert_eq!(window["p"], Value::Null, "{reason}");
        assert!(
            window["reason"].as_str().unwrap().contains(reason),
            "{window}"
        );
    }
}

#[test]
fn a_gap_in_one_window_leaves_the_others_their_class() {
    let windows = windows_after(|t| acceleration(t)[10] = f64::NAN, "--window 4.25");
    let classes: Vec<&str> = windows
        .iter()
        .map(|w| w["class"].as_str().unwrap())
        .collect();
    assert_eq!(classes, ["UWTIC", "ALCT"]);
}

#[test]
fn a_file_that_lacks_what_recognition_needs_exits_with_3_and_says_what() {
    type Edit = fn(&mut Trace);
    let cases: [(Edit, &str); 4] = [
        (
            |t| without(t, "acceleration_y"),
            "no channel acceleration_y",
        ),
        (
            |t| {
                without(t, "wheel_angle");
                without(t, "forward_speed");
            },
            "neither channel wheel_angle nor forward_speed",
        ),
        (
            |t| channel(t, "acceleration_y").unit = "g".to_owned(),
            "is in \"g\", expected \"m/s^2\"",
        ),
        (
            |t| t.attributes.lug_count = Some(0),
            "the wheel has no lugs",
        ),
    ];
    for (edit, part) in cases {
        let mut trace = HARD.clone();
        edit(&mut trace);
        refused(&folder(&[("r", &trace)]), "", 3, part);
    }
    let mut smooth = HARD.clone();
    smooth.attributes.lug_count = Some(0);
    let mixed = json(&folder(&[("good", &HARD), ("smooth", &smooth)]), "");
    assert_eq!(mixed["windows"].as_array().unwrap().len(), 1);
    assert_eq!(mixed["skipped"][0]["run"], "smooth");
    refused(&folder(&[]), "", 3, "has no runs");
    let hard = folder(&[("r", &HARD)]);
    refused(&hard, "--run x", 3, "it has r");
    refused(&hard, "--window 1e9", 3, "longer than the longest run");
    let half = "above half the sample rate of acceleration_y in runs.h5 (1000 Hz)";
    refused(&hard, "--bandwidth 1001", 3, half);
}

#[test]
fn wrong_usage_exits_with_2() {
    let folder = folder(&[]);
    refused(&folder, "--window 0", 2, "above 0");
    refused(&folder, "--window NaN", 2, "above 0");
    refused(
        &folder,
        "--window 3 --window-passes 3",
        2,
        "cannot be used with",
    );
    refused(&folder, "--method best", 2, "improved");
}

#[test]
fn a_run_taken_over_itself_as_the_reference_reads_zero() {
    let mut reference = HARD.clone();
    reference.attributes.terrain = Some(TerrainLabel::Reference);
    let folder = folder(&[("r", &HARD)]);
    let measured = Provenance::measured();
    write(
        &folder.path().join("ref.h5"),
        &measured,
        &[("r", &reference)],
    );
    let found = json(&folder, "--reference ref.h5");
    for p in found["windows"][0]["p"].as_array().unwrap() {
        assert!(p.as_f64().unwrap().abs() < 1e-9, "{found}");
    }
    refused(&folder, "--reference runs.h5", 3, "is on HT, not on REF");
}

#[test]
fn simulated_runs_are_taken_over_the_reference_through_their_own_sensors() {
    let ideal = scenario("single_wheel_ht");
    let noisy = ideal.with("sensors.accelerometer.acceleration_y.noise_density=5e-4");
    for (scenario, through) in [(ideal, false), (noisy.unwrap(), true)] {
        let provenance = Provenance::simulated(scenario.text(), Seed(11));
        let found = json(&folder_of(&provenance, &[("r", &HARD)]), "");
        let origin = found["reference"].as_str().unwrap();
        assert_eq!(origin.contains("through the sensors"), through, "{origin}");
    }
}

#[test]
fn figures_are_drawn_for_every_run_and_for_all_of_them() {
    let folder = folder(&[("a b", &HARD), ("sand", &SAND)]);
    let found = json(&folder, "--out drawn --window-passes 3");
    let names = [
        "a_b",
        "sand",
        "feature_values",
        "feature_planes",
        "confusion",
    ];
    let expected = names.map(|name| Value::from(format!("drawn/{name}.svg")));
    assert_eq!(found["figures"].as_array().unwrap()[..], expected);
    for name in names {
        let path = folder.path().join(format!("drawn/{name}.svg"));
        assert!(std::fs::read_to_string(path).unwrap().starts_with("<svg"));
    }
}
