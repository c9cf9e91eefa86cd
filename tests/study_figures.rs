//! `plot` draws the results of a study over its swept keys.

use crate::cli::{done, run};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Four conditions on sand, two repeats of each, a second long.
const STUDY: &str = r#"
version = 1
scenarios = ["quick"]
seed = 3
repeats = 2
random_numbers = "independent"
[set]
duration = 1.0
lead_in = 0.5
physics_rate = 4000
window = 0.5
[[sweep]]
key = "rig.single_wheel.slip"
values = [0.0, 0.3]
[[sweep]]
key = "rig.single_wheel.load"
values = [60.0, 100.0]
[recognition]
methods = ["paper"]
"#;

/// The folder of the study, finished.
static FINISHED: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("four.toml"), STUDY).unwrap();
    done(run(folder.path(), "study four.toml --out four --quiet"));
    folder
});

const SLIP: &str = "four/over_rig.single_wheel.slip";
const LOAD: &str = "four/over_rig.single_wheel.load";

/// A folder with a copy of the study's tables and page.
fn copy() -> TempDir {
    let copy = TempDir::new().unwrap();
    fs::create_dir(copy.path().join("four")).unwrap();
    for name in ["runs.csv", "recognition.csv", "report.html"] {
        let name = format!("four/{name}");
        fs::copy(FINISHED.path().join(&name), copy.path().join(&name)).unwrap();
    }
    copy
}

fn refusal(folder: &Path, words: &str) -> String {
    let refused = run(folder, words);
    assert_ne!(refused.status.code(), Some(0), "{words}");
    String::from_utf8(refused.stderr).unwrap()
}

/// Mean drawbar pull of the repeats [N] at a slip and load, from the table.
fn pull(folder: &Path, slip: &str, load: &str) -> f64 {
    let table = fs::read_to_string(folder.join("four/runs.csv")).unwrap();
    let mut rows = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let place = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let [at_slip, at_load] = ["slip", "load"].map(|key| place(&format!("rig.single_wheel.{key}")));
    let pulls: Vec<f64> = rows
        .filter(|row| row[at_slip] == slip && row[at_load] == load)
        .map(|row| row[place("drawbar_pull_mean_n")].parse().unwrap())
        .collect();
    assert_eq!(pulls.len(), 2);
    (pulls[0] + pulls[1]) / 2.0
}

#[test]
fn each_swept_key_has_a_figure_whose_marks_are_the_means_of_the_table_with_key_and_unit() {
    let folder = copy();
    let drawn = done(run(folder.path(), "plot four"));
    let expected = [format!("{SLIP}.svg"), format!("{LOAD}.svg")];
    assert_eq!(drawn.lines().collect::<Vec<_>>(), expected);
    let [slip, load] = expected.map(|name| fs::read_to_string(folder.path().join(name)).unwrap());
    assert!(slip.contains(">rig.single_wheel.slip [-]<"), "{slip}");
    assert!(load.contains(">rig.single_wheel.load [N]<"), "{load}");
    for (at_slip, at_load) in [("0.0", "60.0"), ("0.3", "100.0")] {
        let pull = format!("{:.2}", pull(folder.path(), at_slip, at_load).abs());
        let marks = load.lines().filter(|line| line.contains("<title>"));
        let place =
            format!("at rig.single_wheel.load = {at_load} N; rig.single_wheel.slip = {at_slip}<");
        let mut marks = marks.filter(|mark| mark.contains("drawbar pull") && mark.contains(&place));
        let mark = marks.next().unwrap();
        // Four digits are written; five of the mean may round otherwise.
        assert!(mark.contains(&pull[..4]), "{pull}: {mark}");
        assert_eq!(marks.next(), None);
    }
    assert!(slip.contains("LEIS, share of correct answers"), "{slip}");
}

#[test]
fn one_key_is_drawn_into_the_file_named_in_its_format() {
    let folder = copy();
    let of = |words: &str| done(run(folder.path(), &format!("plot four {words}")));
    of("--over slip --out slip.pdf --width 88mm --no-title");
    let pdf = fs::read(folder.path().join("slip.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF-"));
    let drawn: Value = serde_json::from_str(&of(
        "--over rig.single_wheel.load --format png --width 88mm --json",
    ))
    .unwrap();
    let figure = &drawn["figures"][0];
    assert_eq!(figure["key"], "rig.single_wheel.load");
    assert_eq!(figure["figure"], format!("{LOAD}.png"));
    let png = fs::read(folder.path().join(format!("{LOAD}.png"))).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
}

#[test]
fn the_page_of_a_study_is_its_report() {
    let folder = copy();
    let named = done(run(folder.path(), "plot four --format html"));
    assert_eq!(named.trim(), "four/report.html");
    done(run(folder.path(), "plot four --out page.html"));
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("page.html") == read("four/report.html"));
    let itself = refusal(folder.path(), "plot four --out four/report.html --force");
    assert!(itself.contains("which this command reads"), "{itself}");
    let report = String::from_utf8(read("page.html")).unwrap();
    assert!(report.contains("Results over rig.single_wheel.load [N]"));
    let answer = "quick from ";
    assert!(report.contains("Windows recognised") && !report.contains(answer));
}

#[test]
fn what_is_not_swept_not_drawn_or_there_already_is_refused_with_the_way_out() {
    let folder = copy();
    let refused = |words: &str| refusal(folder.path(), &format!("plot four {words}"));
    let several = refused("--out one.svg");
    let keys = "sweeps rig.single_wheel.slip, rig.single_wheel.load";
    assert!(
        several.contains(keys) && several.contains("--over KEY"),
        "{several}"
    );
    let unknown = refused("--over wheel.radius");
    assert!(
        unknown.contains(keys) && unknown.contains("names none"),
        "{unknown}"
    );
    let mcap = refused("--out a.mcap");
    assert!(mcap.contains("contain one run"), "{mcap}");
    let run_id = refused("--run run_000000");
    assert!(run_id.contains("--over"), "{run_id}");
    let existing = PathBuf::from(format!("{SLIP}.svg"));
    fs::write(folder.path().join(&existing), "mine").unwrap();
    let existing_is_kept = refused("--over slip");
    assert!(existing_is_kept.contains("--force"), "{existing_is_kept}");
    let all = refused("");
    assert!(all.contains("--force") && !folder.path().join(format!("{LOAD}.svg")).exists());
    done(run(folder.path(), "plot four --over slip --force"));
    let drawn = fs::read_to_string(folder.path().join(existing)).unwrap();
    assert!(drawn.starts_with("<svg"));
    fs::remove_file(folder.path().join("four/runs.csv")).unwrap();
    let none = run(folder.path(), "plot four");
    assert_eq!(none.status.code(), Some(3));
}
