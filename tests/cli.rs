//! The program itself: its words, its exit codes, and what it leaves on the disk.

use lugwheel::dataset::hdf5::RunFile;
use serde_json::Value;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Half a second of computing or less: slate, where each run has its own ground.
const SHORT: [&str; 4] = [
    "--set",
    "duration=0.5",
    "--set",
    "rig.single_wheel.forward_speed=0.02",
];

/// The program in `folder`.
pub fn program(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lugwheel"));
    command.current_dir(folder);
    command
}

pub fn run(folder: &Path, words: &str) -> Output {
    program(folder)
        .args(words.split_whitespace())
        .output()
        .unwrap()
}

/// `command single_wheel_ht` for half a second with more `words`.
fn short(folder: &Path, command: &str, words: &str) -> Output {
    let mut program = program(folder);
    program.args([command, "single_wheel_ht"]).args(SHORT);
    program.args(words.split_whitespace()).output().unwrap()
}

pub fn done(output: Output) -> String {
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), errors.as_str()), (Some(0), ""));
    String::from_utf8(output.stdout).unwrap()
}

/// What lies in `folder`.
fn left(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// What `dataset --out runs.h5` leaves.
const DATA_SET: [&str; 5] = [
    "runs.croissant.json",
    "runs.datasheet.md",
    "runs.h5",
    "runs.splits.csv",
    "runs.windows.csv",
];

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn a_data_set_has_the_same_bytes_with_one_thread_and_two_and_its_runs_are_the_same_alone() {
    let folder = folder();
    let at = folder.path();
    done(short(at, "dataset", "--runs 5 --jobs 1 --out one.h5"));
    done(short(at, "dataset", "--runs 5 --jobs 2 --out two.h5"));
    done(short(at, "simulate", "--run 3 --out alone.h5"));
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    assert!(read("one.h5") == read("two.h5"));
    let file = RunFile::open(at.join("two.h5")).unwrap();
    let ids: Vec<String> = (0..5).map(|run| format!("run_{run:06}")).collect();
    assert_eq!(file.runs(), ids);
    let alone = RunFile::open(at.join("alone.h5")).unwrap();
    assert_eq!(alone.runs(), ["run_000003"]);
    let trace = alone.read("run_000003").unwrap();
    assert!(trace == file.read("run_000003").unwrap());
    assert!(trace.channels != file.read("run_000002").unwrap().channels);
}

#[test]
fn features_are_the_windows_of_the_traces_and_raw_is_kept_when_asked() {
    let folder = folder();
    let at = folder.path();
    done(short(at, "dataset", "--runs 4 --out traces.h5"));
    done(short(
        at,
        "dataset",
        "--runs 4 --features --out features.h5",
    ));
    done(short(at, "dataset", "--runs 4 --raw --out raw.h5"));
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    assert!(read("traces.windows.csv") == read("features.windows.csv"));
    assert!(read("traces.windows.csv") == read("raw.windows.csv"));
    assert!(read("features.h5").len() < read("traces.h5").len());
    let raw = RunFile::open(at.join("raw.h5")).unwrap();
    let force = raw.read("run_000003").unwrap();
    assert!(force.channel("normal_force_raw").is_some());
    // The datasheet's command makes the same again.
    let sheet = fs::read_to_string(at.join("features.datasheet.md")).unwrap();
    let command = sheet.split("```").nth(1).unwrap().trim_start_matches("sh");
    let words: String = command.replace('"', "").replace("lugwheel ", "");
    done(run(at, &format!("{} --out again.h5", words.trim())));
    assert!(read("again.h5") == read("features.h5"));
    refuses(
        "dataset quick --raw --features",
        2,
        &["--raw", "--features"],
    );
}

#[test]
fn the_seed_is_1_unless_given_and_another_seed_is_another_run() {
    let folder = folder();
    let at = folder.path();
    for (name, seed) in [("a.h5", ""), ("b.h5", "--seed 1"), ("c.h5", "--seed 2")] {
        done(short(at, "simulate", &format!("--out {name} {seed}")));
    }
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    assert!(read("a.h5") == read("b.h5"));
    let c = RunFile::open(at.join("c.h5")).unwrap();
    assert_eq!(c.provenance().seed.unwrap().0, 2);
    let a = RunFile::open(at.join("a.h5")).unwrap();
    assert!(a.read("run_000000").unwrap().channels != c.read("run_000000").unwrap().channels);
}

#[test]
fn a_scenario_with_keys_set_is_in_the_file_and_simulates_to_the_same_file() {
    let folder = folder();
    let at = folder.path();
    done(short(at, "simulate", "--raw --out a.h5"));
    let file = RunFile::open(at.join("a.h5")).unwrap();
    let scenario = file.provenance().scenario.clone().unwrap();
    assert!(
        scenario.contains("# m, split slate"),
        "comments stay: {scenario}"
    );
    let trace = file.read("run_000000").unwrap();
    assert_eq!(
        trace.channel("acceleration_y_raw").unwrap().sample_rate,
        128e3
    );
    fs::write(at.join("again.toml"), scenario).unwrap();
    done(run(at, "simulate again.toml --out b.h5"));
    assert!(fs::read(at.join("a.h5")).unwrap() == fs::read(at.join("b.h5")).unwrap());
}

#[test]
fn results_go_to_a_folder_of_the_scenarios_name_unless_told_otherwise() {
    let folder = folder();
    let at = folder.path();
    let said = done(short(at, "simulate", ""));
    assert!(
        said.ends_with("written to output/single_wheel_ht/run.h5\n"),
        "{said}"
    );
    done(short(at, "dataset", "--runs 1"));
    let mut files = vec!["run.h5"];
    files.extend(DATA_SET);
    assert_eq!(left(&at.join("output/single_wheel_ht")), files);
    let drawn = done(run(at, "plot output/single_wheel_ht/run.h5"));
    assert_eq!(drawn, "output/single_wheel_ht/run_run_000000.svg\n");
    let svg = fs::read_to_string(at.join(drawn.trim())).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("hard terrain (HT)"));
}

#[test]
fn with_json_stdout_is_one_document_with_si_units() {
    let folder = folder();
    let at = folder.path();
    let json = |output| serde_json::from_str::<Value>(&done(output)).unwrap();
    let simulated = json(short(at, "simulate", "--out run.h5 --json"));
    assert_eq!(simulated["terrain"], "HT");
    assert_eq!(simulated["steady"]["normal_force"]["unit"], "N");
    let load = simulated["steady"]["normal_force"]["value"]
        .as_f64()
        .unwrap();
    // The load commanded is 100 N; half a second is not yet steady.
    assert!((80.0..120.0).contains(&load), "{load}");
    let set = json(short(at, "dataset", "--json --runs 2 --out runs.h5"));
    assert_eq!(set["runs"], 2);
    let sinkage = &set["steady"]["sinkage"];
    let [min, mean, max] = ["min", "mean", "max"].map(|key| sinkage[key].as_f64().unwrap());
    assert!(min < mean && mean < max, "{sinkage}");
    let inspected = json(run(at, "--json inspect runs.h5"));
    assert_eq!(inspected["runs"].as_array().unwrap().len(), 2);
    let drawn = json(run(at, "plot runs.h5 --run run_000001 --out f.svg --json"));
    assert_eq!(drawn["figure"], "f.svg");
}

/// Expects this exit code, one clear message that has all `parts`, and nothing left.
fn refuses(words: &str, code: i32, parts: &[&str]) {
    let folder = folder();
    fs::write(folder.path().join("note.txt"), "no HDF5").unwrap();
    fs::create_dir(folder.path().join("sub")).unwrap();
    let output = run(folder.path(), words);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{words}: {errors}");
    assert_eq!(output.stdout, b"", "{words}");
    for part in parts {
        assert!(errors.contains(part), "{words}: {errors}");
    }
    assert!(errors.starts_with("error: ") && !errors.contains("panicked"));
    let mut left = left(folder.path());
    left.retain(|name| name != "output");
    assert_eq!(left, ["note.txt", "sub"], "{words}");
    assert_eq!(fs::read_dir(folder.path().join("sub")).unwrap().count(), 0);
}

#[test]
fn wrong_usage_exits_with_2_and_says_what_is_wrong() {
    refuses("simulat quick", 2, &["unrecognized subcommand", "simulate"]);
    refuses("simulate", 2, &["<SCENARIO>"]);
    refuses("simulate quick --seed x", 2, &["--seed", "'x'"]);
    refuses("dataset quick --runs 0", 2, &["--runs", "1..=999999"]);
    refuses("dataset quick --jobs 0", 2, &["--jobs"]);
    refuses("import note.txt", 2, &["--out <FILE.h5>"]);
}

#[test]
fn an_invalid_input_file_exits_with_3_and_the_message_shows_the_way() {
    let near = "did you mean single_wheel_st";
    refuses("simulate singel_wheel_st", 3, &["singel_wheel_st", near]);
    refuses(
        "simulate sub",
        3,
        &["cannot read scenario sub", "directory"],
    );
    refuses("simulate note.txt", 3, &["note.txt:1:"]);
    let typo = "simulate quick --set rig.single_wheel.slop=0.3";
    refuses(typo, 3, &["unknown field `slop`", "did you mean `slip`?"]);
    let unit = "simulate quick --set rig.single_wheel.load=100N";
    refuses(unit, 3, &["`rig.single_wheel.load=100N`", "here in N"]);
    let millimetres = "simulate quick --set wheel.radius=140";
    refuses(millimetres, 3, &["wheel.radius=140:", "[m]", "140"]);
    refuses("simulate quick --set slip", 3, &["write key=value"]);
    let short = "keys like it in this scenario: `rig.single_wheel.load`";
    refuses("simulate quick --set load=100N", 3, &[short]);
    refuses("inspect missing.h5", 3, &["cannot read missing.h5"]);
    refuses("inspect note.txt", 3, &["note.txt is not an HDF5 file"]);
    refuses("plot sub", 3, &["cannot read sub"]);
    refuses("challenge score sub", 3, &["cannot read sub/campaigns"]);
    refuses("import moon.toml --out a.h5", 3, &["campaign moon.toml"]);
    refuses("import note.txt --out a.h5", 3, &["note.txt:1:"]);
}

#[test]
fn a_file_that_cannot_be_written_is_told_before_the_run_and_exits_with_1() {
    let begun = Instant::now();
    let long = "--set duration=1000 --set rig.single_wheel.forward_speed=0.01";
    for (out, part) in [
        ("sub", "sub is a folder; name a file"),
        (
            "note.txt/run.h5",
            "cannot make the folder note.txt: File exists",
        ),
        ("note.txt", "note.txt exists; give --force"),
        ("note.txt --force", "it is no HDF5 file; name another file"),
    ] {
        refuses(&format!("simulate quick {long} --out {out}"), 1, &[part]);
    }
    assert!(begun.elapsed() < Duration::from_secs(10));
}

#[test]
fn a_failed_run_is_named_with_its_reason_and_leaves_the_file_of_before() {
    let folder = folder();
    let at = folder.path();
    done(short(at, "dataset", "--runs 2 --out runs.h5"));
    let before = fs::read(at.join("runs.h5")).unwrap();
    let sinks =
        "dataset quick --runs 4 --jobs 2 --set rig.single_wheel.load=50000 --out runs.h5 --force";
    let output = run(at, sinks);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    let lines: Vec<&str> = errors.lines().collect();
    assert_eq!(
        lines[0],
        "error: run 0 of seed 1 failed; no file was written"
    );
    assert!(
        lines[1].starts_with("  because: at ") && lines[1].contains("sunk"),
        "{errors}"
    );
    assert_eq!(lines.len(), 2, "{errors}");
    assert!(before == fs::read(at.join("runs.h5")).unwrap());
    done(short(at, "dataset", "--runs 1 --out runs.h5 --force"));
    assert_eq!(RunFile::open(at.join("runs.h5")).unwrap().runs().len(), 1);
    assert_eq!(left(at), DATA_SET);
}

/// A campaign of two runs in `folder`; the second has `cell` for its last force.
fn write_campaign(folder: &Path, cell: &str) {
    let run = |file: &str| {
        format!(
            "[[run]]\nfile = \"{file}\"\ncolumns = {{ time_s = \"t\", normal_force = \"F\" }}\nload_n = 10\n"
        )
    };
    let campaign = format!("version = 1\n{}{}", run("one.csv"), run("two.csv"));
    fs::write(folder.join("campaign.toml"), campaign).unwrap();
    let samples = |cell: &str| format!("t,F\n0.0,10.1\n0.1,9.9\n0.2,{cell}\n");
    fs::write(folder.join("one.csv"), samples("10.0")).unwrap();
    fs::write(folder.join("two.csv"), samples(cell)).unwrap();
}

#[test]
fn a_campaign_is_imported_whole_or_not_at_all() {
    let folder = folder();
    let at = folder.path();
    write_campaign(at, "10.2");
    let said = done(run(at, "import campaign.toml --out runs.h5"));
    assert!(
        said.starts_with("campaign.toml: 2 runs\nchannels  normal_force\n"),
        "{said}"
    );
    assert!(said.ends_with("written to runs.h5\n"), "{said}");
    let before = fs::read(at.join("runs.h5")).unwrap();
    let json = done(run(at, "import campaign.toml --out again.h5 --json"));
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["runs"], &json["doubts"]), (&2.into(), &0.into()));
    assert!(
        before == fs::read(at.join("again.h5")).unwrap(),
        "the same bytes"
    );
    write_campaign(at, "ten");
    let output = run(at, "import campaign.toml --out runs.h5 --force");
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{errors}");
    assert!(
        errors.starts_with("error: campaign.toml:8:42: two.csv:4: column \"F\" holds \"ten\""),
        "{errors}"
    );
    assert!(
        before == fs::read(at.join("runs.h5")).unwrap(),
        "the file of before stays"
    );
    let files = ["again.h5", "campaign.toml", "one.csv", "runs.h5", "two.csv"];
    assert_eq!(left(at), files);
}

#[test]
fn what_an_import_doubts_it_says_and_inspect_explains() {
    let folder = folder();
    let at = folder.path();
    write_campaign(at, "10.2");
    let campaign = fs::read_to_string(at.join("campaign.toml")).unwrap();
    let kilograms = campaign.replacen("load_n = 10", "load_n = 98.1", 1);
    fs::write(at.join("campaign.toml"), kilograms).unwrap();
    let said = done(run(at, "import campaign.toml --out runs.h5"));
    assert!(
        said.contains("1 finding; see lugwheel inspect runs.h5\n"),
        "{said}"
    );
    let inspected = run(at, "inspect runs.h5");
    let said = String::from_utf8(inspected.stdout).unwrap();
    assert!(said.contains("a 9.8th: kilogram against newton?"), "{said}");
    assert_eq!(inspected.status.code(), Some(3));
}

#[test]
fn a_full_disk_is_told_and_leaves_nothing() {
    let folder = folder();
    // The shell's limit [512 B blocks] stands for the disk's end; a run needs some 20 kB.
    let line = "ulimit -f 16; trap '' XFSZ; exec \"$@\"";
    let mut shell = Command::new("sh");
    shell.args(["-c", line, "sh", env!("CARGO_BIN_EXE_lugwheel"), "simulate"]);
    shell.arg("single_wheel_ht");
    shell.args(SHORT).args(["--out", "run.h5"]);
    let output = shell.current_dir(folder.path()).output().unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(
        errors.contains("cannot write run.h5: File too large"),
        "{errors}"
    );
    assert_eq!(left(folder.path()), Vec::<String>::new());
}

#[test]
fn an_interrupted_data_set_stops_at_once_and_leaves_nothing() {
    let folder = folder();
    let at = folder.path();
    let words = "dataset single_wheel_ref --set duration=1000 --out runs.h5";
    let mut program = program(at);
    program.args(words.split_whitespace());
    let child = program.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = child.spawn().unwrap();
    let begun = Instant::now();
    while left(at).is_empty() {
        assert!(begun.elapsed() < Duration::from_secs(20), "no file begun");
        thread::sleep(Duration::from_millis(20));
    }
    let pid = child.id().to_string();
    let killed = Command::new("kill").args(["-INT", &pid]).status();
    assert!(killed.unwrap().success());
    let interrupted = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(interrupted.elapsed() < Duration::from_secs(5));
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(errors, "error: interrupted; nothing was written\n");
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(left(at), Vec::<String>::new());
}

#[test]
fn a_reader_that_leaves_is_no_failure_and_a_full_stdout_is() {
    let folder = folder();
    let at = folder.path();
    done(short(at, "simulate", "--out run.h5"));
    let mut inspect = program(at);
    inspect.args(["inspect", "run.h5"]).stderr(Stdio::piped());
    let mut child = inspect.stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    done(child.wait_with_output().unwrap());
    let full = File::create("/dev/full").unwrap();
    let output = inspect.stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(
        errors.starts_with("error: cannot write to stdout"),
        "{errors}"
    );
}

#[test]
fn every_command_explains_itself() {
    let folder = folder();
    for command in [
        "demo",
        "scenarios",
        "new",
        "keys",
        "completions",
        "man",
        "simulate",
        "dataset",
        "import",
        "inspect",
        "plot",
        "recognize",
    ] {
        let short = done(run(folder.path(), &format!("{command} -h")));
        assert!(
            short.contains("Usage: lugwheel") && short.contains("--json"),
            "{short}"
        );
        assert!(
            short.lines().all(|line| line.chars().count() <= 120),
            "{short}"
        );
    }
    let help = done(run(folder.path(), "--help"));
    assert!(
        help.contains("Exit codes") && help.contains("lugwheel demo"),
        "{help}"
    );
}

#[test]
fn a_study_ends_with_its_report_that_has_its_question_its_runs_and_its_command() {
    let folder = folder();
    let study = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/studies/quick.toml");
    let command = format!("study {} --out quick", study.display());
    let said = done(run(folder.path(), &command));
    assert_eq!(said.lines().last(), Some("report: quick/report.html"));
    let report = fs::read_to_string(folder.path().join("quick/report.html")).unwrap();
    let report = report.replace("&#x2f;", "/");
    for part in [
        "<h1>Six short runs</h1>",
        "How do drawbar pull and sinkage depend on the slip ratio",
        "Mean drawbar pull: single_wheel_ref",
        "6 = 2 × 3 × 1 (scenarios × entries of each sweep × repeats), 0 failed",
        &format!("lugwheel {command}"),
    ] {
        assert!(report.contains(part), "{part}");
    }
    assert_eq!(
        report.matches("<figure>").count(),
        3,
        "the swept key, and a run of each scenario"
    );
}

#[test]
#[ignore = "simulates for a minute on two cores: cargo test --test all cli:: -- --ignored"]
fn the_demo_ends_with_its_report_whose_commands_write_the_same_bytes() {
    let folder = folder();
    let at = folder.path();
    let begun = Instant::now();
    let said = done(run(at, "demo --out shown"));
    assert!(
        begun.elapsed() < Duration::from_secs(180),
        "three minutes at most"
    );
    assert_eq!(said.lines().last(), Some("shown/report.html"));
    let report = fs::read_to_string(at.join("shown/report.html")).unwrap();
    let report = report.replace("&#x2f;", "/");
    let page = report.split("<pre tabindex=\"0\">").nth(1).unwrap();
    let commands: Vec<&str> = page.split("</pre>").next().unwrap().lines().collect();
    assert_eq!(commands[0], "lugwheel demo --seed 1 --out shown");
    let before = fs::read(at.join("shown/st.h5")).unwrap();
    let again = commands
        .iter()
        .find(|c| c.ends_with("shown/st.h5"))
        .unwrap();
    fs::remove_file(at.join("shown/st.h5")).unwrap();
    done(run(at, again.strip_prefix("lugwheel ").unwrap()));
    assert!(before == fs::read(at.join("shown/st.h5")).unwrap());
}

#[test]
fn the_catalogue_of_effects_is_a_table_an_entry_or_json_and_a_typo_is_told_its_neighbours() {
    let folder = TempDir::new().unwrap();
    let table = done(run(folder.path(), "effects"));
    assert!(table.contains("\nrail_friction "), "{table}");
    let entry = done(run(folder.path(), "effects rail_friction"));
    for part in [
        "vertical guide",
        "frame_flaws.friction",
        "Rollon",
        "0.5, 2, 6",
    ] {
        assert!(entry.contains(part), "{part} is not in\n{entry}");
    }
    let json: Value = serde_json::from_str(&done(run(folder.path(), "effects --json"))).unwrap();
    let effects = json.as_array().unwrap();
    let tilt = effects
        .iter()
        .find(|effect| effect["name"] == "sensor_tilt")
        .unwrap();
    assert_eq!(tilt["stage"], "sensors");
    assert_eq!(tilt["seats"][0]["levels"][1], 1.0);
    refuses("effects rail_frition", 3, &["did you mean `rail_friction`"]);
}

#[test]
fn an_effect_on_the_command_line_is_in_the_run_and_in_its_recorded_scenario() {
    let folder = TempDir::new().unwrap();
    let simulated = |words: &str| {
        let text = done(short(
            folder.path(),
            "simulate",
            &format!("--json --quiet {words}"),
        ));
        serde_json::from_str::<Value>(&text).unwrap()["steady"]["normal_force"]["value"]
            .as_f64()
            .unwrap()
    };
    let plain = simulated("--out plain.h5");
    let gained = simulated("--out gained.h5 --effect gain_error.normal_force=0.05");
    assert!((gained / plain - 1.05).abs() < 1e-9, "{gained} {plain}");
    let file = RunFile::open(folder.path().join("gained.h5")).unwrap();
    let scenario = file.provenance().scenario.as_deref().unwrap();
    assert!(scenario.contains("name = \"gain_error.normal_force\""));
    refuses(
        "simulate quick --effect gain_error.normal_force=5",
        3,
        &["gain_error [-] must be in [-0.5, 0.5], got 5"],
    );
}
