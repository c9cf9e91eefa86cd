//! The program needs no file of the repository: every command works in an empty folder.

use crate::cli::{done, run};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder that is empty at first.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn run(&self, words: &str) -> Output {
        run(self.0.path(), words)
    }

    fn says(&self, words: &str) -> String {
        done(self.run(words))
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.path().join(name), text).unwrap();
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.0.path().join(name)).unwrap()
    }
}

/// The text of a file of the repository.
fn committed(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

#[test]
fn runs_of_ready_scenarios_are_made_read_and_drawn_in_an_empty_folder() {
    let here = Folder::new();
    let short = "--quiet --set duration=2 --set rig.single_wheel.forward_speed=0.03";
    here.says(&format!("simulate single_wheel_st {short} --out run.h5"));
    here.says(&format!(
        "dataset scenarios/single_wheel_ht.toml {short} --runs 2 --out runs.h5"
    ));
    here.says("inspect runs.h5");
    here.says("plot run.h5 --out run.svg");
    here.says("recognize runs.h5");
    let identified = here.run("identify run.h5");
    assert_eq!(identified.status.code(), Some(3));
    let effects = here.says("effects");
    assert!(here.read("run.svg").starts_with(b"<svg") && effects.contains("rail_friction"));
}

#[test]
fn a_ready_study_goes_on_where_its_file_began_and_a_study_of_ones_own_names_ready_scenarios() {
    let here = Folder::new();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/studies/quick.toml");
    here.says(&format!("study {file} --out quick --quiet"));
    let runs = here.read("quick/runs.csv");
    here.says("study quick --out quick --resume --quiet");
    assert!(runs == here.read("quick/runs.csv"));
    here.write(
        "mine.toml",
        "version = 1\nscenarios = [\"single_wheel_ht\", \"../rover_ht.toml\"]\nseed = 1\nrepeats = 1\n\
         random_numbers = \"common\"\n[set]\nduration = 0.2\n",
    );
    let said = here.says("study mine --quiet");
    assert!(said.contains("2 runs, 0 failed"), "{said}");
}

#[test]
fn a_new_scenario_runs_as_written_and_is_not_written_over() {
    let here = Folder::new();
    let listed = here.says("scenarios");
    assert!(
        listed.contains("rover_gt") && listed.contains("table3"),
        "{listed}"
    );
    here.says("new my_rig --from rover_st");
    let mine = String::from_utf8(here.read("my_rig.toml")).unwrap();
    let ready = committed("scenarios/rover_st.toml");
    let (first, rest) = ready.split_once('\n').unwrap();
    assert!(mine.starts_with(first) && mine.ends_with(rest), "{mine}");
    here.says("simulate my_rig --set duration=0.2 --quiet");
    let refused = here.run("new my_rig");
    assert_eq!(refused.status.code(), Some(1));
    here.says("new my_study --from studies/quick");
    let shown = here.says("scenarios --show studies/quick");
    assert!(shown.contains("Six short runs"), "{shown}");
}

#[test]
fn a_key_is_explained_and_an_unknown_one_is_answered_with_those_like_it() {
    let here = Folder::new();
    let line = here.says("keys rig.single_wheel.slip");
    assert!(
        line.contains("in [-1, 1]") && line.contains("Slip ratio"),
        "{line}"
    );
    let found = here.says("keys noise_density");
    assert_eq!(found.matches("noise_density ").count(), 5, "{found}");
    let unknown = here.run("keys wheel.lugs.hight");
    let message = String::from_utf8(unknown.stderr).unwrap();
    assert!(message.contains("wheel.lugs.height"), "{message}");
    let schema: Value = serde_json::from_str(&here.says("keys --json-schema")).unwrap();
    assert_eq!(schema["properties"]["duration"]["type"], "number");
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let here = Folder::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = here.says(&format!("completions {shell}"));
        assert!(script.contains("recognize"), "{script}");
    }
    assert!(here.says("man").contains("lugwheel\\-simulate"));
    here.says("man --out pages");
    let page = String::from_utf8(here.read("pages/lugwheel-challenge-make.1")).unwrap();
    assert!(page.contains("\\-\\-cases"), "{page}");
    assert!(here.says("--version").starts_with("lugwheel 0."));
}

#[test]
fn a_file_is_used_before_a_ready_document_of_its_name() {
    let here = Folder::new();
    let sand = committed("scenarios/single_wheel_st.toml");
    here.write(
        "single_wheel_st.toml",
        &sand.replace("duration = 15.0", "duration = 0.25"),
    );
    let said = here.says("simulate single_wheel_st --quiet --out run.h5");
    assert!(said.contains("0.25 s on ST"), "{said}");
}

/// Steady means of a smooth wheel at four slips, and a time series.
fn write_campaign(here: &Folder) {
    here.write(
        "means.csv",
        "slip,pull,torque,depth,load\n0.0,-2.1,1.2,8.1,80\n0.2,12.4,4.1,11.9,80\n0.4,17.9,5.6,15.2,80\n0.6,20.3,6.4,18.8,80\n",
    );
    let series: String = (0..400)
        .map(|i| format!("{},{}\n", 0.01 * f64::from(i), 80.0 + f64::from(i % 7)))
        .collect();
    here.write("series.csv", &format!("t,Fz\n{series}"));
    here.write(
        "mine.toml",
        r#"
version = 1
[[run]]
file = "series.csv"
columns = { time_s = "t", normal_force = { column = "Fz", unit = "N" } }
wheel = { radius_m = 0.14, width_m = 0.15, lug_count = 28, lug_height_m = 0.015 }
load_n = 80
speed_m_s = 0.014
slip_ratio = 0.1
[table]
file = "means.csv"
columns = { drawbar_pull = { column = "pull", unit = "N" }, driving_torque = { column = "torque", unit = "N m" }, sinkage = { column = "depth", unit = "mm" }, normal_force = { column = "load", unit = "N" } }
slip_ratio = { column = "slip" }
load_n = 80
terrain = "ST"
wheel = { radius_m = 0.14, width_m = 0.15, lug_count = 0, lug_height_m = 0.0 }
"#,
    );
}

#[test]
fn csv_files_of_a_rig_are_imported_inspected_and_drawn_in_an_empty_folder() {
    let here = Folder::new();
    write_campaign(&here);
    let said = here.says("import mine.toml --out mine.h5");
    assert!(said.contains("5 runs"), "{said}");
    let said = here.says("inspect mine.h5");
    assert!(said.contains("normal_force"), "{said}");
    here.says("plot mine.h5 --out first.html");
    let refused = here.run("import mine.toml --out mine.h5");
    let message = String::from_utf8(refused.stderr).unwrap();
    assert!(message.contains("--force"), "{message}");
    fs::remove_file(here.0.path().join("means.csv")).unwrap();
    let missing = here.run("import mine.toml --out again.h5");
    assert_eq!(missing.status.code(), Some(3));
}

/// An installed copy of the program.
fn installed(root: &Path) -> PathBuf {
    let cargo = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args([
            "install",
            "--path",
            ".",
            "--locked",
            "--offline",
            "--debug",
            "--quiet",
        ])
        .arg("--root")
        .arg(root)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&cargo.stderr);
    assert!(cargo.status.success(), "{errors}");
    root.join("bin/lugwheel")
}

/// What every command is run with, in this order.
const EVERYTHING: [&str; 24] = [
    "scenarios",
    "new my_rig --from single_wheel_st",
    "keys wheel.lugs",
    "effects",
    "completions bash",
    "man --out pages",
    "simulate my_rig --set duration=2 --set lead_in=1 --out run.h5",
    "dataset single_wheel_ht --set duration=2 --runs 2 --out runs.h5",
    "inspect run.h5",
    "plot run.h5 --out run.svg",
    "plot run.h5 --out run.pdf --width 88mm --no-title",
    "plot run.h5 --out run.html",
    "recognize runs.h5",
    "import mine.toml --out mine.h5",
    "inspect mine.h5",
    "study quick --out quick",
    "plot quick --out slip.png --width 88mm",
    "dataset my_rig --set duration=2 --set lead_in=1 --runs 2 --out rig.h5",
    "diagnose --measured rig.h5 --scenario single_wheel_st --dry-run",
    "challenge make --out trial --set C0 --cases 1 --ground hard --duration 1",
    "challenge run trial --budget 1200",
    "challenge score trial",
    "demo --out shown",
    "identify mine.h5",
];

#[test]
#[ignore = "compiles an installed copy and simulates for minutes: cargo test --test all anywhere:: -- --ignored"]
fn every_command_of_an_installed_copy_works_in_an_empty_folder() {
    let root = tempfile::tempdir().unwrap();
    let program = installed(root.path());
    let here = Folder::new();
    write_campaign(&here);
    let run = |words: &str| {
        let mut command = Command::new(&program);
        command.current_dir(here.0.path());
        command.args(words.split_whitespace()).output().unwrap()
    };
    let help = String::from_utf8(run("--help").stdout).unwrap();
    let (_, commands) = help.split_once("Commands:\n").unwrap();
    let lines = commands.lines().take_while(|line| !line.is_empty());
    let names = lines.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    for name in names.filter(|name| !["help", ""].contains(name)) {
        let is_run = |words: &&str| words.split(' ').next() == Some(name);
        assert!(EVERYTHING.iter().any(is_run), "{name}");
    }
    for words in EVERYTHING {
        let output = run(words);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{words}: {errors}");
    }
}

#[test]
fn a_blind_trial_is_made_and_a_diagnosis_estimated_in_an_empty_folder() {
    let here = Folder::new();
    here.says("challenge make --out trial --cases 1 --ground hard --duration 0.1 --quiet");
    let short = "--quiet --set duration=2 --set rig.single_wheel.forward_speed=0.03";
    here.says(&format!("simulate single_wheel_st {short} --out run.h5"));
    let estimate =
        here.run("diagnose --measured run.h5 --scenario single_wheel_st --dry-run --quiet");
    let said = String::from_utf8(estimate.stdout).unwrap();
    assert!(said.contains("random rigs"), "{said}");
}
