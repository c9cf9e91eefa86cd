//! Every ready study, cut short: one value of every sweep, runs of a second at 0.2 m/s, in which some
//! lugs pass. Each has to end with its tables.

use lugwheel::study::{Options, Study};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use toml::{Table, Value};

/// Keys that a short study sets for itself, and those of its rig.
const ITS_OWN: [(&str, f64); 4] = [
    ("duration", 1.0),
    ("window", 0.5),
    ("lead_in", 0.1),
    ("physics_rate", 4000.0),
];
const ITS_DRIVE: [(&str, f64); 2] = [("forward_speed", 0.2), ("start_up", 0.05)];
/// Driving [s] that does for the shallowest diagnosis of such runs.
const SHALLOW: f64 = 200.0;
const RIGS: [&str; 2] = ["rig.single_wheel", "rig.rover_leg"];

fn is_its_own(key: &str) -> bool {
    let drive = |(own, _): &(&str, f64)| RIGS.iter().any(|rig| key == format!("{rig}.{own}"));
    ITS_OWN.iter().any(|(own, _)| *own == key) || ITS_DRIVE.iter().any(drive)
}

fn studies() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/studies")
}

fn absolute(path: &mut Value) {
    let whole = studies().join(path.as_str().unwrap());
    *path = Value::String(whole.display().to_string());
}

/// The first entries of a sweep, of which `joined` keys need two, without keys that a short study sets
/// for itself. Nothing where none is left.
fn cut(sweep: &Value, joined: &[String]) -> Option<Table> {
    let mut sweep = sweep.as_table().unwrap().clone();
    if let Some(keys) = sweep.get("keys").cloned() {
        let keys = keys.as_array().unwrap();
        let is_kept = |key: &Value| !is_its_own(key.as_str().unwrap());
        let kept: Vec<usize> = (0..keys.len()).filter(|&i| is_kept(&keys[i])).collect();
        let pick = |row: &[Value]| Value::Array(kept.iter().map(|&i| row[i].clone()).collect());
        let rows = sweep["rows"].as_array().unwrap();
        let first = Value::Array(
            rows.iter()
                .take(1)
                .map(|row| pick(row.as_array().unwrap()))
                .collect(),
        );
        sweep.insert("keys".to_owned(), pick(keys));
        sweep.insert("rows".to_owned(), first);
        return (!kept.is_empty()).then_some(sweep);
    }
    if let Some(drawn) = sweep.get_mut("distributions") {
        let rig = &mut drawn["rig"]["single_wheel"];
        rig.as_table_mut().unwrap().remove("forward_speed");
        sweep.insert("count".to_owned(), Value::Integer(1));
        return Some(sweep);
    }
    let key = sweep["key"].as_str().unwrap().to_owned();
    if is_its_own(&key) {
        return None;
    }
    let most = if joined.contains(&key) { 2 } else { 1 };
    match sweep.get_mut("values") {
        Some(values) => values.as_array_mut().unwrap().truncate(most),
        None => {
            let from = sweep.remove("grid").unwrap()["from"].clone();
            sweep.insert("values".to_owned(), Value::Array(vec![from]));
        }
    }
    Some(sweep)
}

/// The keys of which a fit or a campaign of the study joins several values.
fn joined(study: &Table) -> Vec<String> {
    let tables = ["identification", "diagnosis"];
    let Some(table) = tables.iter().find_map(|table| study.get(*table)) else {
        return Vec::new();
    };
    let slips =
        ["rig.single_wheel.slip", "rig.rover_leg.slip"].map(|key| Value::String(key.to_owned()));
    let over = table.get("over").and_then(Value::as_array).cloned();
    let over = over.unwrap_or(slips.into());
    over.iter()
        .map(|key| key.as_str().unwrap().to_owned())
        .collect()
}

fn shortened(file: &Path, folder: &Path) -> Study {
    let mut study: Table = std::fs::read_to_string(file).unwrap().parse().unwrap();
    let joined = joined(&study);
    study["scenarios"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .for_each(absolute);
    study.insert("repeats".to_owned(), Value::Integer(1));
    let scenarios = study["scenarios"].as_array_mut().unwrap();
    if scenarios.len() > 1 {
        // A gravel pile takes seconds to pour; the studies of gravel alone have it.
        scenarios.retain(|path| !path.as_str().unwrap().ends_with("_gt.toml"));
    }
    let first = study["scenarios"][0].as_str().unwrap().to_owned();
    let on_rover = first.contains("rover") || first.contains("traverse");
    let rig = RIGS[usize::from(on_rover)];
    let drive = ITS_DRIVE.map(|(key, value)| (format!("{rig}.{key}"), value));
    let own = ITS_OWN.map(|(key, value)| (key.to_owned(), value));
    let set = study
        .entry("set")
        .or_insert_with(|| Value::Table(Table::new()));
    let set = set.as_table_mut().unwrap();
    // A key may stand there as a table of its parts.
    set.remove("rig");
    for (key, value) in own.into_iter().chain(drive) {
        let whole = key == "physics_rate";
        let value = if whole {
            Value::Integer(value as i64)
        } else {
            Value::Float(value)
        };
        set.insert(key, value);
    }
    if let Some(sweeps) = study.get_mut("sweep") {
        let cut = sweeps
            .as_array()
            .unwrap()
            .iter()
            .filter_map(|sweep| cut(sweep, &joined));
        *sweeps = Value::Array(cut.map(Value::Table).collect());
    }
    if let Some(recognition) = study.get_mut("recognition").and_then(Value::as_table_mut) {
        recognition.remove("baseline");
        if let Some(reference) = recognition.get_mut("reference") {
            absolute(reference);
        }
        if let Some(settings) = recognition
            .get_mut("settings")
            .and_then(Value::as_table_mut)
        {
            settings.remove("window");
        }
    }
    if let Some(identification) = study
        .get_mut("identification")
        .and_then(Value::as_table_mut)
    {
        identification.remove("from");
    }
    if let Some(diagnosis) = study.get_mut("diagnosis").and_then(Value::as_table_mut) {
        diagnosis.insert("budget".to_owned(), Value::Float(SHALLOW));
        if let Some(scenario) = diagnosis.get_mut("scenario") {
            absolute(scenario);
        }
    }
    let short = folder.join(file.file_name().unwrap());
    std::fs::write(&short, study.to_string()).unwrap();
    Study::load(&short).unwrap_or_else(|error| panic!("{error}"))
}

/// The tables a study has to end with.
fn tables(file: &Path) -> Vec<&'static str> {
    let study: Table = std::fs::read_to_string(file).unwrap().parse().unwrap();
    let asked = [
        ("recognition", ["windows.csv", "recognition.csv"]),
        ("thresholds", ["thresholds.csv", "runs.csv"]),
        ("identification", ["steady.csv", "identification.csv"]),
        ("diagnosis", ["diagnosis.csv", "runs.csv"]),
        ("dataset", ["dataset.h5", "dataset.splits.csv"]),
    ];
    let asked = asked
        .into_iter()
        .filter(|(table, _)| study.contains_key(*table));
    let mut tables = vec!["runs.csv", "runs.h5", "origin.txt", "study.toml"];
    tables.extend(asked.flat_map(|(_, tables)| tables));
    tables
}

#[test]
fn every_ready_study_cut_short_ends_with_its_tables() {
    let entries = std::fs::read_dir(studies()).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 29, "{}", files.len());
    for file in files {
        let folder = TempDir::new().unwrap();
        let study = shortened(&file, folder.path());
        let out = folder.path().join("out");
        let options = Options {
            out: out.clone(),
            jobs: NonZeroUsize::new(2),
            resume: false,
            shard: None,
        };
        let outcome = study.execute(&options, &|_| ControlFlow::Continue(()));
        let outcome = outcome.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let failed = std::fs::read_to_string(out.join("failed.txt")).unwrap_or_default();
        assert!(outcome.failed.is_empty(), "{}: {failed}", file.display());
        if let Some(score) = &outcome.scores.diagnosis {
            assert_eq!(score.without_answer().count(), 0, "{score:?}");
        }
        for table in tables(&file) {
            assert!(out.join(table).exists(), "{}: no {table}", file.display());
        }
    }
}
