//! The limits of Eq. (55) to (58), put to the windows of a study.

use crate::common::results::{done, into, resumed};
use lugwheel::report::study_page::texts;
use lugwheel::report::threshold_figure;
use lugwheel::study::thresholds::{Statement, ThresholdScore};
use lugwheel::study::{Options, Scores, Study};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Windows of two seconds at 0.1 m/s, at a rate that is good enough for bookkeeping.
fn study(folder: &TempDir, scenario: &str, rest: &str) -> Study {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scenario = here.join(format!("scenarios/{scenario}.toml"));
    let text = format!(
        "version = 1\nscenarios = [{scenario:?}]\nseed = 107\nrepeats = 2\nrandom_numbers = \"common\"\n\
         [set]\nduration = 2.0\nwindow = 2.0\nlead_in = 0.5\nphysics_rate = 4000\n\
         rig.single_wheel.start_up = 0.1\nrig.single_wheel.forward_speed = 0.1\n{rest}\n\
         [thresholds]\nbandwidths = [20.0, 200.0]\n"
    );
    let file = folder.path().join("study.toml");
    std::fs::write(&file, text).unwrap();
    Study::load(&file).unwrap_or_else(|error| panic!("{error}"))
}

/// Few lugs and many, on a flat slab and on cobbles.
fn small(folder: &TempDir) -> Study {
    let rest = "[[sweep]]\nkey = \"wheel.lugs.count\"\nvalues = [6, 24]\n\
                [[sweep]]\nkeys = [\"terrain.hard.roughness.rms\", \"terrain.hard.roughness.shortest\"]\n\
                rows = [[0.0, 0.002], [0.02, 0.02]]\n";
    study(folder, "single_wheel_ht", rest)
}

fn held(study: &Study, options: &Options) -> Option<ThresholdScore> {
    let outcome = done(study, options);
    assert!(outcome.failed.is_empty());
    outcome.scores.thresholds
}

/// The small study, done once.
static SMALL: LazyLock<(TempDir, PathBuf, ThresholdScore)> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let score = held(&small(&folder), &into(&out)).unwrap();
    (folder, out, score)
});

fn column(out: &Path, name: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_path(out.join("thresholds.csv")).unwrap();
    let headers = reader.headers().unwrap().clone();
    let index = headers.iter().position(|header| header == name);
    let index = index.unwrap_or_else(|| panic!("no column {name} among {headers:?}"));
    let records = reader.records().map(Result::unwrap);
    records.map(|record| record[index].to_owned()).collect()
}

fn numbers(out: &Path, name: &str) -> Vec<f64> {
    let cells = column(out, name);
    cells.iter().map(|cell| cell.parse().unwrap()).collect()
}

fn named<'s>(score: &'s ThresholdScore, name: &str, multi_lugged: bool) -> &'s Statement {
    let of =
        |statement: &&Statement| statement.name == name && statement.multi_lugged == multi_lugged;
    score
        .statements
        .iter()
        .find(of)
        .unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn on_flat_ground_every_displacement_is_the_references_for_many_lugs_and_few() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let rest = "[[sweep]]\nkey = \"wheel.lugs.count\"\nvalues = [6, 24, 48]\n";
    let score = held(&study(&folder, "single_wheel_ref", rest), &into(&out)).unwrap();
    assert_eq!((score.windows, score.all_touched), (6, 6));
    for name in [
        "c_m_median",
        "c_m_largest",
        "displacement_kappa_a",
        "displacement_kappa_ms",
    ] {
        // A stay loses the heights of a pose at either end, 1.6 % of its own.
        let ones = numbers(&out, name);
        assert!(
            ones.iter().all(|one| (one - 1.0).abs() < 0.016),
            "{name}: {ones:?}"
        );
    }
    // Of lugs many enough to follow each other without the rim.
    for name in ["c_f_largest", "relative_kappa_a", "relative_kappa_ms"] {
        let ones = &numbers(&out, name)[2..];
        assert!(
            ones.iter().all(|one| (one - 1.0).abs() < 0.03),
            "{name}: {ones:?}"
        );
    }
    assert!(
        numbers(&out, "steepest_rad")
            .iter()
            .all(|slope| *slope == 0.0)
    );
    assert!(
        numbers(&out, "rolled_touched_share")
            .iter()
            .all(|share| *share == 1.0)
    );
    // Contacts give way and ring: within a quarter of the impulses of the reference below 20 Hz.
    let accelerations = numbers(&out, "kappa_ms_20_hz");
    assert!(
        accelerations.iter().all(|ratio| (ratio - 1.0).abs() < 0.25),
        "{accelerations:?}"
    );
}

#[test]
fn windows_on_which_lugs_missed_are_in_the_table_but_are_not_held_to_the_limits() {
    let (_, out, score) = &*SMALL;
    let truth = column(out, "truth");
    let all_touched = |multi: &str| {
        let lugged = column(out, "multi_lugged");
        let both = truth.iter().zip(&lugged);
        both.filter(|(truth, lugged)| *truth == "ALCT" && *lugged == multi)
            .count()
    };
    let (many, few) = (all_touched("true"), all_touched("false"));
    assert!(truth.len() == 8 && score.windows == 8 && score.all_touched == many + few);
    assert!(
        many >= 2 && many + few < 8,
        "cobbles leave lugs out: {truth:?}"
    );
    for (multi, expected) in [(true, many), (false, few)] {
        let statement = named(score, "acceleration_ms_200_hz", multi);
        assert_eq!(statement.parts[0].tally.n, expected);
        assert_eq!(statement.points.len(), expected);
        for key in [
            "wheel.lugs.count",
            "terrain.hard.roughness.rms, terrain.hard.roughness.shortest",
        ] {
            let parts = statement.parts.iter().filter(|part| part.by == key);
            assert_eq!(
                parts.map(|part| part.tally.n).sum::<usize>(),
                expected,
                "{key}"
            );
        }
    }
}

#[test]
fn limits_are_the_papers_for_many_lugs_and_for_few_the_one_off_a_bump() {
    let (_, _, score) = &*SMALL;
    let limit = |name: &str, multi| named(score, name, multi).parts[0].tally.bound;
    let near = |found: [f64; 2], expected: f64| {
        assert!(
            found.iter().all(|limit| (limit - expected).abs() < 5e-3),
            "{found:?}"
        );
    };
    near(limit("contact", true), 3.983);
    near(limit("acceleration_a_20_hz", true), 3.983);
    near(limit("acceleration_ms_20_hz", true), 15.864);
    near(limit("jumps_ms_20_hz", true), 1.2);
    near(limit("contact", false), 9.507);
    near(limit("displacement_ms", false), 90.388);
    // Corrected ones are derived for wheels that go from lug to lug.
    let derived = |name: &str| score.statements.iter().filter(|s| s.name == name).count();
    assert_eq!(
        [derived("contact_on_slope"), derived("relative_ms")],
        [1, 1]
    );
    let scores = Scores {
        thresholds: Some(score.clone()),
        ..Scores::default()
    };
    let text = &texts(&scores)[0].text;
    assert!(
        text.contains("of 8 windows the true class is ALCT"),
        "{text}"
    );
    for statement in &score.statements {
        let row = format!("\n  {} ", statement.name);
        assert!(text.contains(&row), "{row}");
    }
}

#[test]
fn a_figure_has_a_mark_for_every_window_and_a_line_for_the_limit() {
    let (_, _, score) = &*SMALL;
    let statement = named(score, "acceleration_a_20_hz", true);
    let figure = threshold_figure(statement, &score.axes);
    // Two entries of the legend.
    assert_eq!(
        figure.matches("<circle").count(),
        statement.points.len() + 2
    );
    assert!(figure.contains(">wheel.lugs.count<") && figure.contains(">24<"));
    assert!(
        !figure.contains(">6<"),
        "no window of six lugs belongs here"
    );
    assert!(figure.contains("terrain.hard.roughness (rms, shortest)"));
}

fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let files = entries.filter(|path| path.is_file() && !path.ends_with("timing.csv"));
    let read = |path: PathBuf| {
        let name = PathBuf::from(path.file_name().unwrap());
        (name, std::fs::read(path).unwrap())
    };
    let mut found: Vec<(PathBuf, Vec<u8>)> = files.map(read).collect();
    found.sort();
    found
}

#[test]
fn a_study_shared_torn_and_resumed_leaves_the_bytes_of_one_that_was_not() {
    let folder = TempDir::new().unwrap();
    let study = small(&folder);
    let (_, whole, _) = &*SMALL;
    let parts = folder.path().join("parts");
    for share in [2, 1] {
        let options = Options {
            shard: Some((share, 2)),
            ..into(&parts)
        };
        assert_eq!(held(&study, &options).is_some(), share == 1);
    }
    assert_eq!(contents(&parts), contents(whole));
    std::fs::remove_file(parts.join("shards/00003.thresholds.csv")).unwrap();
    assert!(held(&study, &resumed(&parts)).is_some());
    assert_eq!(contents(&parts), contents(whole));
}
