//! `lugwheel identify`: parameters from files, and never a number without its warning.

use lugwheel::dataset::Provenance;
use lugwheel::dataset::hdf5::RunFileWriter;
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use lugwheel::soil::closed_form::{self, Rim};
use lugwheel::soil::table_6;
use lugwheel::soil::wheel_load::sinkage_at;
use lugwheel::terrain::class::{TerrainLabel, Wtic};
use lugwheel::trace::{Channel, Mean, RunAttributes, Trace, unit_of};
use lugwheel::wheel::Wheel;
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::TempDir;

const SLIPS: [f64; 8] = [0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
const LOADS: [f64; 3] = [60.0, 109.0, 200.0];

/// A run of means at `slip` under `load` [N] as Eq. (62)-(64) give them on the sand of Table 6.
pub(crate) fn run(slip: f64, load: f64) -> Trace {
    let wheel = Wheel::rover();
    let smooth = Wheel {
        lugs: None,
        ..wheel
    };
    let sinkage = sinkage_at(&smooth, &table_6::sand(), load, slip).unwrap();
    let loads = closed_form::loads(Rim::from(&wheel), &table_6::sand(), sinkage, slip);
    let mean = |(name, value): (&str, f64)| Mean {
        name: name.to_owned(),
        unit: unit_of(name).unwrap().to_owned(),
        value,
        // An exact sinkage is no unknown of its row, which makes fits quick.
        sd: if name == "sinkage" {
            0.0
        } else {
            1e-3 * value.abs()
        },
        n: 100,
    };
    let means = [
        ("drawbar_pull", loads.drawbar_pull),
        ("driving_torque", loads.driving_torque),
        ("normal_force", loads.normal_force),
        ("sinkage", sinkage),
    ];
    Trace {
        attributes: RunAttributes {
            wheel_radius: wheel.radius,
            wheel_width: wheel.width,
            lug_count: Some(24),
            lug_height: 0.01,
            load,
            slip_ratio: slip,
            terrain: Some(TerrainLabel::Sand),
            ..RunAttributes::default()
        },
        means: means.map(mean).into(),
        ..Trace::default()
    }
}

pub(crate) fn campaign() -> Vec<(String, Trace)> {
    let pairs = LOADS
        .iter()
        .flat_map(|load| SLIPS.map(|slip| (slip, *load)));
    pairs
        .enumerate()
        .map(|(number, (slip, load))| (format!("p{number:02}"), run(slip, load)))
        .collect()
}

pub(crate) fn mean<'t>(trace: &'t mut Trace, name: &str) -> &'t mut f64 {
    let mut means = trace.means.iter_mut();
    &mut means.find(|mean| mean.name == name).unwrap().value
}

/// A folder with these runs in `runs.h5`.
pub(crate) fn folder(runs: &[(String, Trace)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("runs.h5"), runs);
    folder
}

pub(crate) fn write(path: &Path, runs: &[(String, Trace)]) {
    let mut file = RunFileWriter::create(path, &Provenance::measured()).unwrap();
    for (id, trace) in runs {
        file.add(id, trace).unwrap();
    }
    file.finish().unwrap();
}

pub(crate) fn lugwheel(folder: &TempDir, command: &str, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lugwheel"))
        .current_dir(folder.path())
        .arg(command)
        .args(words.split_whitespace())
        .output()
        .unwrap()
}

pub(crate) fn identify(folder: &TempDir, words: &str) -> Output {
    lugwheel(folder, "identify", &format!("runs.h5 {words}"))
}

pub(crate) fn done(output: Output) -> String {
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), errors.as_str()), (Some(0), ""));
    String::from_utf8(output.stdout).unwrap()
}

pub(crate) fn json(folder: &TempDir, words: &str) -> Value {
    let text = done(identify(folder, &format!("--json {words}")));
    serde_json::from_str(&text).unwrap()
}

/// Runs that cannot be used: the exit code and what is said of them.
pub(crate) fn refused(folder: &TempDir, words: &str, code: i32, parts: &[&str]) {
    let output = identify(folder, words);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{words}: {errors}");
    for part in parts {
        assert!(errors.contains(part), "{words}: no {part:?} in {errors}");
    }
    assert_eq!(output.stdout, b"");
}

pub(crate) fn warned(found: &Value, kind: &str) -> bool {
    let warnings = found["warnings"].as_array().unwrap();
    warnings.iter().any(|warning| warning["kind"] == kind)
}

#[test]
fn a_file_given_twice_is_refused_as_its_rows_would_count_as_independent() {
    let folder = folder(&campaign());
    refused(&folder, "./runs.h5", 3, &["./runs.h5 is given twice"]);
}

#[test]
fn what_inspect_calls_wrong_is_the_first_warning() {
    let mut runs = campaign();
    for (_, run) in &mut runs {
        run.attributes.load *= 1000.0;
    }
    let found = json(&folder(&runs), "--law paper");
    assert_eq!(found["warnings"][0]["kind"], "measurement_error");
    assert!(!warned(
        &json(&folder(&campaign()), "--law paper"),
        "measurement_error"
    ));
}

#[test]
fn loads_made_by_the_equations_give_the_sand_of_table_6_back() {
    let found = json(&folder(&campaign()), "--law paper");
    let truth = [
        ("k_s", 2.4904e6, "N/m^(N+2)"),
        ("n0", 0.8169, "1"),
        ("n1", 1.296, "1"),
        ("c1", 0.4424, "1"),
        ("c2", -0.6379, "1"),
        ("c", 308.6, "Pa"),
        ("phi", 29.67, "deg"),
        ("K", 0.0066, "m"),
    ];
    let parameters = found["parameters"].as_object().unwrap();
    assert_eq!(parameters.len(), truth.len());
    for (name, expected, unit) in truth {
        let told = &parameters[name];
        let value = told["value"].as_f64().unwrap();
        // What loads without noise and the fit's tolerance leave open.
        assert!((value / expected - 1.0).abs() < 1e-3, "{name}: {told}");
        let ends: Vec<Option<f64>> = told["ci95"]
            .as_array()
            .unwrap()
            .iter()
            .map(Value::as_f64)
            .collect();
        match &ends[..] {
            [Some(low), Some(high)] => assert!((low..=high).contains(&&expected), "{name}: {told}"),
            ends => assert_eq!(
                (ends, &told["identifiable"]),
                (&[None, None][..], &false.into())
            ),
        }
        assert_eq!(told["unit"], unit);
    }
    for force in ["drawbar_pull", "load", "driving_torque"] {
        let error = found["force_error_percent"][force].as_f64().unwrap();
        assert!(error < 0.01, "{force}: {error} %");
    }
    assert_eq!(found["class"], "LEIS");
    assert_eq!(found["runs"].as_array().unwrap().len(), 24);
    let row = &found["rows"][3];
    assert_eq!((&row["run"], &row["slip"]), (&"p03".into(), &0.2.into()));
    assert_eq!(found["left_out"], Value::Array(Vec::new()));
    assert_eq!(found["termination"], "converged");
}

/// The published points of two wheels, imported.
fn published() -> TempDir {
    let data = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/ding2011/points.toml"
    );
    let folder = tempfile::tempdir().unwrap();
    done(lugwheel(
        &folder,
        "import",
        &format!("{data} --out runs.h5"),
    ));
    folder
}

#[test]
fn published_means_are_two_wheels_on_sand_with_what_not_to_believe_said_first() {
    let folder = published();
    let found = json(&folder, "--law paper");
    let [smooth, lugged] = &found.as_array().unwrap()[..] else {
        panic!("{found}");
    };
    let lugs = [smooth, lugged].map(|one| one["wheel"]["lug_count"].as_u64());
    assert_eq!(lugs, [Some(0), Some(30)]);
    for one in [smooth, lugged] {
        assert_eq!(one["class"], "LEIS");
        assert_eq!(one["runs"][0]["class_by"], "known");
        // Six points at one load leave k_s and n0 open, and say so.
        for name in ["k_s", "n0"] {
            assert_eq!(one["parameters"][name]["identifiable"], false);
            assert_eq!(
                one["parameters"][name]["ci95"],
                serde_json::json!([null, null])
            );
        }
        // Told is what soils usually have, of all that explains the points as well.
        assert!(warned(one, "exponent_assumed"), "{}", one["warnings"]);
        let n0 = one["parameters"]["n0"]["value"].as_f64().unwrap();
        assert!((0.5..1.5).contains(&n0), "{n0}");
        // At the load both wheels sink, pull and turn as measured: to 15 % of their means.
        for quantity in ["sinkage", "drawbar_pull", "driving_torque"] {
            let error = one["prediction_error_percent"][quantity].as_f64().unwrap();
            assert!(error < 15.0, "{quantity}: {error} %");
        }
    }
    let row = &lugged["rows"][2]["predicted"]["sinkage"];
    let [low, high] = [0, 1].map(|end| row["interval95"][end].as_f64().unwrap());
    assert!((low..high).contains(&0.0075), "{row}");
    let said = done(identify(&folder, "--law paper"));
    let [warning, table, errors] =
        ["WARNING", "95 % interval", "Table 7, ST"].map(|part| said.find(part).unwrap());
    assert!(warning < table && table < errors, "{said}");
    assert!(
        said.contains("by the class of the terrain in the paper"),
        "{said}"
    );
    assert!(said.contains("not identifiable"), "{said}");
}

#[test]
fn a_given_class_is_taken_and_sets_what_table_4_sets() {
    let found = json(&folder(&campaign()), "--class slct");
    assert_eq!(
        (&found["class"], &found["runs"][0]["class_by"]),
        (&"SLCT".into(), &"given".into())
    );
    assert_eq!(found["parameters"]["c"]["value"], 0.0);
    assert_eq!(found["parameters"]["c"]["standing"], "set_by_class");
    assert!(warned(&found, "loads_differ"), "{}", found["warnings"]);
}

#[test]
fn forces_that_the_model_does_not_describe_are_warned_of_by_misfit() {
    let mut runs = campaign();
    for (number, (_, trace)) in runs.iter_mut().enumerate() {
        *mean(trace, "drawbar_pull") += [8.0, -8.0][number % 2];
    }
    let folder = folder(&runs);
    let found = json(&folder, "");
    let warnings = found["warnings"].as_array().unwrap();
    let misfit = warnings.iter().find(|w| w["kind"] == "misfit").unwrap();
    let meaning = misfit["meaning"].as_str().unwrap();
    assert!(
        meaning.starts_with("the model does not describe these loads"),
        "{meaning}"
    );
    let said = done(identify(&folder, ""));
    assert!(said.contains("\nWARNINGS\n"), "{said}");
}

#[test]
fn the_circle_through_the_lugs_and_an_exit_angle_change_the_answer_and_are_told() {
    let folder = folder(&campaign());
    let rim = json(&folder, "");
    let tips = json(&folder, "--cylinder lug-tips --exit-angle -0.2");
    assert_eq!(tips["setting"]["cylinder"], "lug_tips");
    assert_eq!(tips["setting"]["exit_angle"], -0.2);
    let k_s = [&rim, &tips].map(|found| found["parameters"]["k_s"]["value"].as_f64().unwrap());
    assert!((k_s[1] / k_s[0] - 1.0).abs() > 0.01, "{k_s:?}");
}

#[test]
fn a_known_parameter_is_not_fitted_and_fixes_what_it_was_mixed_up_with() {
    // One load leaves k_s, n0, n1 and c open.
    let folder = folder(&campaign()[8..16]);
    let standing = |found: &Value, name: &str| found["parameters"][name]["standing"].clone();
    let alone = json(&folder, "--law paper");
    assert_eq!(standing(&alone, "k_s"), "not_identifiable");
    let found = json(&folder, "--law paper --known n0=0.8169 --known c=308.6");
    assert_eq!(found["parameters"]["n0"]["value"], 0.8169);
    assert_eq!(standing(&found, "n0"), "given");
    assert_eq!(standing(&found, "c"), "given");
    assert_eq!(standing(&found, "k_s"), "identified");
    let k_s = found["parameters"]["k_s"]["value"].as_f64().unwrap();
    assert!((k_s / 2.4904e6 - 1.0).abs() < 1e-3, "{k_s}");
    let hard = json(&folder, "--class ALCT --known c=308.6");
    assert_eq!(standing(&hard, "c"), "set_by_class");
    assert!(warned(&hard, "known_not_used"), "{}", hard["warnings"]);
}

#[test]
fn runs_of_several_files_are_fitted_together_and_named_with_their_file() {
    let runs = campaign();
    let folder = folder(&runs[..12]);
    let path = folder.path().join("more.h5");
    write(&path, &runs[12..]);
    let text = done(identify(&folder, "more.h5 --json"));
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["runs"].as_array().unwrap().len(), 24);
    assert_eq!(found["runs"][0]["run"], "runs.h5:p00");
    assert_eq!(found["runs"][12]["run"], "more.h5:p12");
    let together = json(&self::folder(&runs), "");
    assert_eq!(found["parameters"], together["parameters"]);
    refused(&folder, "none.h5", 3, &["none.h5"]);
}

#[test]
fn the_commands_of_the_guide_work() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("src/guide/identification.md")).unwrap();
    let after = page.split("<!-- identify -->\n```sh\n").nth(1).unwrap();
    let commands = after.split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for command in commands.lines() {
        let words = command.strip_prefix("lugwheel ").unwrap();
        let data = root.join("tests/data").display().to_string();
        let words = words.replace("tests/data", &data);
        let (name, words) = words.split_once(' ').unwrap();
        done(lugwheel(&folder, name, words));
    }
    assert_eq!(commands.lines().count(), 5);
    assert!(folder.path().join("figures/forces_LEIS_2.svg").exists());
}

/// What is wrong with a run, and what is said of it.
type Fault = (fn(&mut Trace), &'static [&'static str]);

const FAULTS: [Fault; 7] = [
    (
        |t| *mean(t, "normal_force") = -109.0,
        &[
            "row 1: load [N] must be above 0",
            "got -109",
            "sign of normal_force",
        ],
    ),
    (
        |t| *mean(t, "sinkage") = 12.0,
        &["row 1: sinkage [m]", "radius 0.155, got 12", "in m"],
    ),
    (
        |t| *mean(t, "sinkage") = f64::NAN,
        &[
            "row 1: sinkage [m]",
            "got NaN",
            "record the channel or mean sinkage",
        ],
    ),
    (
        |t| *mean(t, "sinkage") = -0.001,
        &["got -0.001", "--cylinder lug-tips"],
    ),
    (
        |t| *mean(t, "drawbar_pull") = f64::NAN,
        &["row 1: drawbar pull [N] must be finite, got NaN", "--run"],
    ),
    (
        |t| t.means.retain(|mean| mean.name != "drawbar_pull"),
        &["drawbar_pull is missing", "as a channel or as a mean"],
    ),
    (
        |t| t.attributes.terrain = None,
        &["no channel acceleration_y", "give it with --class"],
    ),
];

#[test]
fn a_faulty_run_is_left_out_with_its_reason_and_the_others_are_fitted() {
    for (edit, parts) in FAULTS {
        let mut runs = campaign();
        edit(&mut runs[5].1);
        let found = json(&folder(&runs), "--law paper");
        let left_out = &found["left_out"].as_array().unwrap()[..];
        let [one] = left_out else {
            panic!("{left_out:?}");
        };
        assert_eq!(one["run"], "p05");
        let reason = one["reason"].as_str().unwrap();
        for part in parts {
            assert!(reason.contains(part), "no {part:?} in {reason}");
        }
        assert_eq!(found["runs"].as_array().unwrap().len(), 23);
    }
}

#[test]
fn where_every_run_is_faulty_the_exit_code_is_3_and_each_reason_is_told_once() {
    for (edit, parts) in FAULTS {
        let mut runs = campaign();
        runs.truncate(5);
        runs.iter_mut().for_each(|(_, trace)| edit(trace));
        let runs = folder(&runs);
        refused(&runs, "--law paper", 3, parts);
        refused(
            &runs,
            "--law paper",
            3,
            &["no terrain parameters from runs.h5; runs p00, p01, p02, p03, p04"],
        );
    }
}

#[test]
fn too_few_rows_and_one_slip_name_the_stage_and_the_way_out() {
    let few = folder(&campaign()[..2]);
    let stage = "k_s, n0 and n1 (Eq. 74) need 3 rows or more for class LEIS, got 2";
    refused(
        &few,
        "",
        3,
        &["runs p00, p01", stage, "add runs at other slips"],
    );
    // On hard ground the torque of a wheel held by friction says nothing.
    let held = folder(&campaign()[..1]);
    refused(
        &held,
        "--class ALCT",
        3,
        &["run p00", "c1 and c2 (Eq. 73) need 2 rows"],
    );
    let one_slip: Vec<_> = LOADS
        .iter()
        .map(|load| (format!("load{load}"), run(0.2, *load)))
        .collect();
    let slip = "all rows have slip 0.2";
    refused(
        &folder(&one_slip),
        "",
        3,
        &[slip, "give rows at two slips or more"],
    );
}

#[test]
fn wheels_that_nobody_measured_are_told_to_be_stated_at_import() {
    let mut runs = campaign();
    for (_, trace) in &mut runs {
        trace.attributes.wheel_radius = f64::NAN;
    }
    let parts = [
        "wheel radius [m] must be above 0 and finite, got NaN",
        "import it again",
    ];
    refused(&folder(&runs), "", 3, &parts);
}

#[test]
fn wrong_usage_exits_with_2_and_no_runs_with_3() {
    let folder = folder(&[]);
    refused(&folder, "--class gravel", 2, &["gravel", "ALCT"]);
    refused(&folder, "--cylinder square", 2, &["lug-tips"]);
    refused(&folder, "--exit-angle 0.2", 2, &["in [-1, 0]"]);
    refused(&folder, "--exit-angle x", 2, &["give a number"]);
    refused(&folder, "--known phi", 2, &["NAME=VALUE"]);
    refused(
        &folder,
        "--known psi=30",
        2,
        &["\"psi\"", "c1, c2, k_s, n0, n1, c, phi, K"],
    );
    refused(
        &folder,
        "--known phi=steep",
        2,
        &["\"steep\" is no number", "in deg"],
    );
    refused(
        &folder,
        "--known K=11.4",
        2,
        &["K [m] must be in", "got 11.4"],
    );
    refused(&folder, "", 3, &["has no runs"]);
    refused(&folder, "--run x", 3, &["has no runs"]);
}

/// Two runs of one wheel, on slate and on sand, with the vibration of a simulation.
static SIMULATED: LazyLock<[Trace; 2]> = LazyLock::new(|| {
    ["single_wheel_ht", "single_wheel_st"].map(|name| {
        let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let edits = [
            "duration=8.5",
            "window=4.25",
            "rig.single_wheel.forward_speed=0.02",
        ];
        let scenario = Scenario::load(path).unwrap().with_all(&edits).unwrap();
        let go_on = &mut |_| ControlFlow::Continue(());
        scenario.run(Seed(11), 0, go_on).unwrap()
    })
});

/// The run at several slips: its forces are replaced, its vibration is not.
fn at_slips(trace: &Trace, name: &str) -> Vec<(String, Trace)> {
    let run = |slip: f64| {
        let mut trace = trace.clone();
        trace.truth = None;
        trace.attributes.terrain = None;
        trace.attributes.class = None;
        let ripple = |value: f64, i: usize| value * (1.0 + 1e-3 * [1.0, -1.0][i % 2]);
        let mut set = |name: &str, value: f64| {
            let channel = trace.channels.iter_mut().find(|c| c.name == name);
            let samples: &mut Vec<f64> = &mut channel.unwrap().samples;
            samples
                .iter_mut()
                .enumerate()
                .for_each(|(i, x)| *x = ripple(value, i));
        };
        set("slip_ratio", slip);
        set("drawbar_pull", 100.0 * (0.1 + slip));
        set("driving_torque", 14.0 * (0.1 + slip));
        set("sinkage", 0.01 + 0.02 * slip);
        set("normal_force", 100.0);
        (format!("{name}_{slip}"), trace)
    };
    [0.1, 0.2, 0.3, 0.5].map(run).into()
}

#[test]
fn unlabelled_runs_are_grouped_by_the_class_that_their_vibration_shows() {
    let [hard, sand] = &*SIMULATED;
    let runs = [at_slips(hard, "hard"), at_slips(sand, "sand")].concat();
    let folder = folder(&runs);
    let found = json(&folder, "");
    let [alct, leis] = &found.as_array().unwrap()[..] else {
        panic!("{found}");
    };
    assert_eq!(
        (&alct["class"], &leis["class"]),
        (&"ALCT".into(), &"LEIS".into())
    );
    for (one, name) in [(alct, "hard"), (leis, "sand")] {
        let runs = one["runs"].as_array().unwrap();
        assert_eq!(runs.len(), 4);
        for run in runs {
            assert!(run["run"].as_str().unwrap().starts_with(name), "{run}");
            assert_eq!(run["class_by"], "recognized");
            assert_eq!(run["windows"], run["of_windows"]);
        }
    }
    let said = done(identify(&folder, ""));
    assert!(said.contains("recognised in 4 of 4 windows"), "{said}");
    let one = json(&folder, "--class LEIS");
    assert!(one.is_object() && one["runs"].as_array().unwrap().len() == 8);
}

#[test]
fn a_run_whose_vibration_tells_nothing_has_the_class_of_its_label_or_none() {
    let [hard, _] = &*SIMULATED;
    let mut runs = at_slips(hard, "r");
    // Without an angle the commanded slip gives the turning, with which these pulses do not keep step.
    runs.retain(|(id, _)| id != "r_0.1");
    for (_, trace) in &mut runs {
        trace
            .channels
            .retain(|channel: &Channel| channel.name != "wheel_angle");
    }
    let parts = [
        "read as UWTIC in 1 of 1 windows",
        "pulses come every",
        "--class",
    ];
    refused(&folder(&runs), "", 3, &parts);
    for (_, trace) in &mut runs {
        trace.attributes.class = Some(Wtic::Alct);
    }
    let found = json(&folder(&runs), "");
    let run = &found["runs"][0];
    assert_eq!(
        (&run["class_by"], &run["source"]),
        (&"known".into(), &"run_class".into())
    );
    assert!(run["because"].as_str().unwrap().contains("UWTIC"), "{run}");
}

#[test]
fn a_figure_is_drawn_for_every_estimate() {
    let folder = published();
    let found = json(&folder, "--out drawn");
    let figures = [&found[0]["figure"], &found[1]["figure"]];
    assert_eq!(
        figures,
        ["drawn/forces_LEIS.svg", "drawn/forces_LEIS_2.svg"]
    );
    for figure in figures {
        let path = folder.path().join(figure.as_str().unwrap());
        let svg = std::fs::read_to_string(path).unwrap();
        // Symbols and their indices are set apart.
        for header in ["Drawbar pull ", ">DP<", "Load ", " [N·m]", " [mm]"] {
            assert!(svg.contains(header), "{header}");
        }
    }
}
