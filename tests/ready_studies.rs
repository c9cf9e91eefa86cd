//! Every ready study, cut short: one value of every sweep, runs of half a second. Each has to end
//! with its tables.

use lugwheel::study::{Options, Study};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use toml::{Table, Value};

/// Keys that a short study sets for itself.
const ITS_OWN: [(&str, f64); 4] = [
    ("duration", 0.4),
    ("window", 0.2),
    ("lead_in", 0.1),
    ("physics_rate", 4000.0),
];

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
        let is_kept = |key: &Value| ITS_OWN.iter().all(|(own, _)| key.as_str() != Some(own));
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
    if sweep.contains_key("distributions") {
        sweep.insert("count".to_owned(), Value::Integer(1));
        return Some(sweep);
    }
    let key = sweep["key"].as_str().unwrap().to_owned();
    if ITS_OWN.iter().any(|(own, _)| *own == key) {
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

/// The keys of which a fit of the study joins several values.
fn joined(study: &Table) -> Vec<String> {
    let Some(identification) = study.get("identification") else {
        return Vec::new();
    };
    let slips =
        ["rig.single_wheel.slip", "rig.rover_leg.slip"].map(|key| Value::String(key.to_owned()));
    let over = identification
        .get("over")
        .and_then(Value::as_array)
        .cloned();
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
    let set = study
        .entry("set")
        .or_insert_with(|| Value::Table(Table::new()));
    for (key, value) in ITS_OWN {
        let value = if key == "physics_rate" {
            Value::Integer(value as i64)
        } else {
            Value::Float(value)
        };
        set.as_table_mut().unwrap().insert(key.to_owned(), value);
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
    let short = folder.join(file.file_name().unwrap());
    std::fs::write(&short, study.to_string()).unwrap();
    Study::load(&short).unwrap_or_else(|error| panic!("{error}"))
}

/// The tables a study has to end with.
fn tables(file: &Path) -> Vec<&'static str> {
    let study: Table = std::fs::read_to_string(file).unwrap().parse().unwrap();
    let asked = [
        ("recognition", ["windows.csv", "recognition.txt"]),
        ("thresholds", ["thresholds.csv", "thresholds.txt"]),
        ("identification", ["steady.csv", "identification.txt"]),
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
    assert!(files.len() >= 30, "{}", files.len());
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
        for table in tables(&file) {
            assert!(out.join(table).exists(), "{}: no {table}", file.display());
        }
    }
}
