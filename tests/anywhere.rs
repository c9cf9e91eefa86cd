//! The program needs no file of the repository: every command works in an empty folder.

use crate::cli::{done, run};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;
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
