//! Data sets for learners: the small variant of the published one, its files, its splits.

use crate::common::python;
use crate::common::results::{done, into, resumed};
use lugwheel::dataset::hdf5::RunFile;
use lugwheel::learning::DataSet;
use lugwheel::study::{Options, Study, StudyError};
use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

/// `scenarios/studies/dataset.toml` with twenty runs of two windows of half a second: two draws, two
/// repeats, at a rate that is good enough for bookkeeping, without the gravel pile, which takes seconds
/// to pour.
fn small(folder: &TempDir, edit: impl Fn(String) -> String) -> Study {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let text = std::fs::read_to_string(root.join("studies/dataset.toml")).unwrap();
    let scenarios = format!("\"{}/", root.display());
    let changes = [
        ("single_wheel_gt", "single_wheel_ref"),
        ("\"../", scenarios.as_str()),
        ("repeats = 10", "repeats = 2"),
        ("count = 40", "count = 2"),
        ("duration = 15.0", "duration = 1.0"),
        // Ten times as fast: a reference of six lug passes is short, and lugs pass in a window.
        ("from = 0.008, to = 0.03", "from = 0.08, to = 0.3"),
        (
            "lead_in = 6.0",
            "lead_in = 0.2\nwindow = 0.5\nphysics_rate = 4000",
        ),
    ];
    let small = changes.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    let file = folder.path().join("dataset.toml");
    std::fs::write(&file, edit(small)).unwrap();
    Study::load(&file).unwrap_or_else(|error| panic!("{error}"))
}

/// The small study's folder, made once.
static WHOLE: LazyLock<(TempDir, PathBuf)> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let outcome = done(&small(&folder, |text| text), &into(&out));
    let kept = outcome.scores.dataset.as_ref().map(DataSet::runs);
    assert_eq!((outcome.runs, kept), (20, Some(20)));
    (folder, out)
});

const FILES: [&str; 6] = [
    "dataset.h5",
    "dataset.windows.csv",
    "dataset.splits.csv",
    "dataset.datasheet.md",
    "dataset.croissant.json",
    "runs.h5",
];

fn bytes(out: &Path) -> Vec<Vec<u8>> {
    let read = |name: &&str| std::fs::read(out.join(name)).unwrap();
    FILES.iter().map(read).collect()
}

/// The cells of some columns of a table, row by row.
fn cells<const N: usize>(path: &Path, names: [&str; N]) -> Vec<[String; N]> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let headers = reader.headers().unwrap().clone();
    let place = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let places = names.map(place);
    let records = reader.records().map(Result::unwrap);
    records
        .map(|record| places.map(|place| record[place].to_owned()))
        .collect()
}

#[test]
fn the_published_study_has_2000_runs_of_15_s_on_five_grounds() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/studies/dataset.toml");
    let study = Study::load(path).unwrap();
    assert_eq!(study.run_count(), 2000);
    let runs: Vec<_> = study.runs().collect();
    assert!(
        runs.iter()
            .step_by(50)
            .all(|run| study.scenario(run).duration == 15.0)
    );
    let streams: BTreeSet<u64> = runs.iter().map(|run| run.stream).collect();
    assert_eq!(streams.len(), 2000, "no two runs share a ground");
}

#[test]
fn a_data_set_holds_the_runs_as_they_are_alone_and_their_conditions() {
    let (folder, out) = &*WHOLE;
    let study = small(folder, |text| text);
    let file = RunFile::open(out.join("dataset.h5")).unwrap();
    assert_eq!(file.runs().len(), 20);
    let run = study.runs().nth(17).unwrap();
    let alone = study.run(&run, &mut |_| ControlFlow::Continue(())).unwrap();
    let kept = file.read("run_000017").unwrap();
    let (alone, of) = (
        alone.channel("normal_force").unwrap(),
        kept.channel("normal_force").unwrap(),
    );
    // In single precision, as every run file has it.
    assert!(
        alone
            .samples
            .iter()
            .zip(&of.samples)
            .all(|(a, b)| *a as f32 == *b as f32)
    );
    assert!(kept.truth.is_some());
    let notes = &kept.attributes.notes;
    let start = "scenario single_wheel_sgt, rig.single_wheel.forward_speed = 0.";
    assert!(notes.starts_with(start), "{notes}");
}

#[test]
fn no_condition_and_no_ground_is_in_two_parts_and_every_ground_is_in_each() {
    let (_, out) = &*WHOLE;
    for (split, group) in [
        ("by_run", "run"),
        ("by_ground", "stream"),
        ("by_condition", "condition"),
    ] {
        let rows = cells(&out.join("dataset.splits.csv"), [group, split]);
        assert_eq!(rows.len(), 20);
        let mut parts: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for [group, part] in &rows {
            assert!(!part.is_empty());
            parts.entry(group).or_default().insert(part);
        }
        assert!(
            parts.values().all(|parts| parts.len() == 1),
            "{split}: {parts:?}"
        );
    }
    // Four runs on every ground, of few classes.
    let rows = cells(&out.join("dataset.windows.csv"), ["terrain", "by_ground"]);
    for ground in ["HT", "REF", "HGT", "ST", "SGT"] {
        let parts = rows
            .iter()
            .filter(|[terrain, _]| terrain == ground)
            .map(|[_, part]| part);
        let parts: BTreeSet<&String> = parts.collect();
        assert!(parts.len() >= 2, "{ground}: {parts:?}");
    }
}

#[test]
fn the_datasheet_counts_what_is_there_and_answers_every_part_of_the_questionnaire() {
    let (_, out) = &*WHOLE;
    let sheet = std::fs::read_to_string(out.join("dataset.datasheet.md")).unwrap();
    for heading in [
        "Motivation",
        "Composition",
        "Collection process",
        "Preprocessing, cleaning, labelling",
        "Uses",
        "Distribution and maintenance",
    ] {
        assert!(sheet.contains(&format!("\n## {heading}\n")), "{heading}");
    }
    for fact in [
        "40 windows of 20 runs under 10 conditions",
        "on 20 grounds",
        "`acceleration_y` [m/s^2] at 2000 Hz",
        "lugwheel study dataset.toml",
        "seed 31",
        "| by_ground | train |",
    ] {
        assert!(sheet.contains(fact), "{fact} is not in\n{sheet}");
    }
    let mut classes: BTreeMap<String, usize> = BTreeMap::new();
    for [class] in cells(&out.join("dataset.windows.csv"), ["class"]) {
        *classes.entry(class).or_default() += 1;
    }
    assert!(classes.len() >= 2, "{classes:?}");
    for (class, count) in classes {
        assert!(
            sheet.contains(&format!("| {class} | {count} |")),
            "{class}\n{sheet}"
        );
    }
}

#[test]
fn shares_of_a_data_set_torn_and_resumed_leave_the_bytes_of_one_that_was_not() {
    let folder = TempDir::new().unwrap();
    let study = small(&folder, |text| text);
    let out = folder.path().join("out");
    for share in [2, 1] {
        let options = Options {
            shard: Some((share, 2)),
            jobs: NonZeroUsize::new(1),
            ..into(&out)
        };
        done(&study, &options);
    }
    assert!(bytes(&out) == bytes(&WHOLE.1));
    // The runs of a shard are whole when their checksum says so.
    let traces = out.join("shards/00003.traces.h5");
    let mut torn = std::fs::read(&traces).unwrap();
    let middle = torn.len() / 2;
    torn[middle] ^= 1;
    std::fs::write(&traces, torn).unwrap();
    let resumed = resumed(&out);
    let stopped = study.execute(&resumed, &|_| ControlFlow::Break(()));
    let Err(StudyError::Stopped { whole, shards }) = stopped else {
        panic!("{stopped:?}");
    };
    assert_eq!((whole, shards), (19, 20));
    done(&study, &resumed);
    assert!(bytes(&out) == bytes(&WHOLE.1));
}

#[test]
fn features_alone_are_the_same_windows_in_a_hundredth_of_the_bytes() {
    let folder = TempDir::new().unwrap();
    let study = small(&folder, |text| text.replace("\"traces\"", "\"features\""));
    let out = folder.path().join("out");
    done(&study, &into(&out));
    let windows = |out: &Path| std::fs::read(out.join("dataset.windows.csv")).unwrap();
    assert!(windows(&out) == windows(&WHOLE.1));
    let size = |out: &Path| std::fs::metadata(out.join("dataset.h5")).unwrap().len();
    // Of 15 s a hundredth; a window of half a second has its features too, and two fill an HDF5 page.
    assert!(
        size(&out) < size(&WHOLE.1) / 10,
        "{} {}",
        size(&out),
        size(&WHOLE.1)
    );
    assert!(!out.join("shards/00000.traces.h5").exists());
}

#[test]
fn python_indexes_windows_by_part_and_reads_every_table() {
    let (_, out) = &*WHOLE;
    python::run(
        python::with_h5py(),
        "python/learn.py",
        &[out.to_str().unwrap()],
    );
}
