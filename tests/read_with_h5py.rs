//! Run files and h5py: it reads what this program writes, and the other way round.

use crate::common::python;
use lugwheel::dataset::Provenance;
use lugwheel::dataset::hdf5::{RunFile, RunFileError, RunFileWriter, write_table};
use lugwheel::dataset::inspection::{Severity, inspect};
use lugwheel::dataset::records::{Field, Records};
use lugwheel::quantity::Seed;
use lugwheel::terrain::class::{TerrainLabel, Wtic};
use lugwheel::trace::{AtLimit, Channel, ClassWindow, Contact, Mean, RunAttributes, Trace, Truth};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Runs `check.py` with these arguments; fails with what it says.
fn python(arguments: &[&str]) {
    python::run(python::with_h5py(), "h5py/check.py", arguments);
}

fn simulated() -> Trace {
    let attributes = RunAttributes {
        wheel_radius: 0.14,
        wheel_width: 0.15,
        lug_count: Some(28),
        lug_height: 0.015,
        wheel_mass: Some(4.0),
        plate: None,
        slope_deg: 0.0,
        load: 100.0,
        speed: 0.014,
        slip_ratio: 0.1,
        terrain: Some(TerrainLabel::SandWithGravel),
        class: Some(Wtic::Leis),
        repeat: 3,
        day: "2023-05-01".to_owned(),
        notes: String::new(),
        physics_rate: Some(128_000.0),
        ..RunAttributes::default()
    };
    let normal_force = Channel {
        name: "normal_force".to_owned(),
        unit: "N".to_owned(),
        sample_rate: 500.0,
        start: 0.25,
        samples: (0..40_000).map(|i| 100.0 + f64::from(i % 7)).collect(),
    };
    let wheel_angle = Channel {
        name: "wheel_angle".to_owned(),
        unit: "rad".to_owned(),
        sample_rate: 10.0,
        start: 0.0,
        samples: (0..5).map(|i| f64::from(i) / 3.0).collect(),
    };
    Trace {
        attributes,
        channels: vec![normal_force, wheel_angle],
        means: Vec::new(),
        truth: Some(truth()),
    }
}

fn truth() -> Truth {
    let contact = |lug, start, end, entered| Contact {
        lug,
        start,
        end,
        entered,
    };
    let window = ClassWindow {
        start: 0.0,
        end: 15.0,
        class: Wtic::Leis,
        terrain: TerrainLabel::SandWithGravel,
        lugs: None,
    };
    Truth {
        contacts: vec![contact(3, 0.5, 1.25, true), contact(4, 1.0, 2.5, false)],
        class_windows: vec![window],
        parameters: [("cohesion".to_owned(), 300.0)].into(),
        profile: vec![[0.0, 0.0], [0.1, 0.002]],
        at_limit: AtLimit {
            carriage: 0.25,
            motor: 0.0,
        },
    }
}

fn measured() -> Trace {
    let drawbar_pull = Mean {
        name: "drawbar_pull".to_owned(),
        unit: "N".to_owned(),
        value: -6.5,
        sd: 0.7,
        n: 1200,
    };
    Trace {
        means: vec![drawbar_pull],
        ..Trace::default()
    }
}

/// A file of a simulated and a measured run.
fn runs(folder: &Path) -> PathBuf {
    let path = folder.join("two_runs.h5");
    let provenance = Provenance::simulated("version = 1  # 5 µm\n", Seed(u64::MAX));
    let mut writer = RunFileWriter::create(&path, &provenance).unwrap();
    writer.add("simulated", &simulated()).unwrap();
    writer.add("measured", &measured()).unwrap();
    writer.finish().unwrap();
    path
}

#[test]
fn h5py_finds_names_units_values_and_attributes() {
    let folder = tempfile::tempdir().unwrap();
    python(&["read", runs(folder.path()).to_str().unwrap()]);
}

#[test]
fn xarray_finds_the_time_of_channels_and_texts_of_tables() {
    let Some(python) = python::with_or_skip(&["xarray", "h5netcdf", "netCDF4"]) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let row = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
    let records = Records {
        fields: vec![
            Field::whole("run", "number"),
            Field::text("scenario", "name of its file"),
            Field::number("load", "N", "load"),
        ],
        rows: vec![row(["0", "sand, µ", "100.5"]), row(["1", "slate", ""])],
    };
    let provenance = Provenance::measured();
    write_table(folder.path().join("runs.h5"), &records, &provenance).unwrap();
    std::fs::write(folder.path().join("runs.csv"), records.to_csv()).unwrap();
    let file = runs(folder.path());
    let [file, folder] = [&file, folder.path()].map(|path| path.to_str().unwrap());
    python::run(python, "python/netcdf.py", &[file, folder]);
}

#[test]
fn a_campaign_in_other_types_of_number_and_text_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.h5");
    python(&["write", path.to_str().unwrap()]);
    let file = RunFile::open(&path).unwrap();
    let trace = file.read("first").unwrap();
    let RunAttributes {
        wheel_radius,
        lug_count,
        load,
        terrain,
        ref notes,
        ..
    } = trace.attributes;
    assert_eq!((lug_count, load, notes.as_str()), (Some(28), 100.0, ""));
    assert_eq!(wheel_radius as f32, 0.14_f32);
    assert_eq!(terrain, Some(TerrainLabel::Sand));
    let force = trace.channel("normal_force").unwrap();
    assert_eq!(
        (force.unit.as_str(), &force.samples[..]),
        ("N", &[99.0, 101.0][..])
    );
    assert_eq!(file.provenance().seed, None);
    assert_eq!(file.provenance().scenario, None);
}

#[test]
fn what_is_missing_or_wrong_is_named_with_file_group_and_what_was_expected() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        (
            "format",
            "at /: expected an attribute format, a text, found none",
        ),
        (
            "other_format",
            "at /: expected format = \"lugwheel-runs\", found \"weather\"",
        ),
        ("version", "at /: expected format_version = 1, found 2"),
        ("runs", "at /: expected a group runs, found none"),
        (
            "load",
            "at /runs/first: expected an attribute load_n, a number, found none",
        ),
        (
            "load_text",
            "at /runs/first: expected load_n, a number, found unicode",
        ),
        (
            "lug_count",
            "at /runs/first: expected lug_count, a count, found -1",
        ),
        (
            "terrain",
            "at /runs/first: expected terrain to be one of `REF`, `HT`",
        ),
        (
            "unit",
            "at /runs/first/channels/normal_force: expected an attribute unit, a text",
        ),
        (
            "matrix",
            "at /runs/first/channels/sinkage: expected samples in one dimension",
        ),
        ("text_channel", "at /runs/first/channels/sinkage: expected"),
        (
            "contacts",
            "at /runs/first/truth: expected contacts with columns lug, start_s, end_s, entered",
        ),
    ];
    let mut arguments = vec!["spoil", folder.path().to_str().unwrap()];
    arguments.extend(cases.map(|(what, _)| what));
    python(&arguments);
    for (what, message) in cases {
        let path = folder.path().join(format!("{what}.h5"));
        let error = RunFile::open(&path)
            .and_then(|file| file.read("first"))
            .unwrap_err();
        assert!(
            matches!(error, RunFileError::Content { .. }),
            "{what}: {error}"
        );
        let text = error.to_string();
        assert!(
            text.contains(&format!("{what}.h5 {message}")),
            "{what}: {text}"
        );
    }
}

#[test]
fn a_run_that_cannot_be_read_is_a_finding_of_the_inspection() {
    let folder = tempfile::tempdir().unwrap();
    python(&["spoil", folder.path().to_str().unwrap(), "load"]);
    let file = RunFile::open(folder.path().join("load.h5")).unwrap();
    let inspection = inspect(&file);
    assert!(inspection.runs.is_empty());
    let [finding] = &inspection.findings[..] else {
        panic!("{inspection}")
    };
    assert_eq!(
        (finding.run.as_str(), finding.severity),
        ("first", Severity::Error)
    );
    assert!(finding.message.contains("load_n"), "{}", finding.message);
}

/// A run with a channel, a mean and contacts, copied by h5py as programs of these kinds write it.
fn rewritten(kinds: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("source.h5");
    let mut trace = simulated();
    trace.channels[0].samples.truncate(200);
    trace.means = measured().means;
    let mut writer = RunFileWriter::create(&path, &Provenance::measured()).unwrap();
    writer.add("first", &trace).unwrap();
    writer.finish().unwrap();
    let mut arguments = vec![
        "rewrite",
        path.to_str().unwrap(),
        folder.path().to_str().unwrap(),
    ];
    arguments.extend(kinds);
    python(&arguments);
    folder
}

#[test]
fn a_run_file_is_read_however_matlab_and_h5py_lay_out_its_numbers_and_texts() {
    let kinds = [
        "matlab",
        "matlab_columns",
        "latest",
        "big_endian",
        "integers",
        "szip",
        "checked",
        "scaled",
        "growing",
    ];
    let folder = rewritten(&kinds);
    let read = |name: &str| {
        let file = RunFile::open(folder.path().join(name)).unwrap();
        file.read("first").unwrap_or_else(|error| panic!("{error}"))
    };
    let source = read("source.h5");
    for kind in kinds {
        let trace = read(&format!("{kind}.h5"));
        assert_eq!(trace.attributes, source.attributes, "{kind}");
        assert_eq!(trace.means, source.means, "{kind}");
        assert_eq!(trace.channels[0], source.channels[0], "{kind}");
    }
}

#[test]
fn numbers_and_compressions_that_cannot_be_read_are_named_with_a_way_out_and_not_called_damage() {
    let cases = [
        ("lzf", "compressed by lzf", "compression=\"gzip\""),
        ("lzf_shuffled", "compressed by lzf", "h5repack -f GZIP=1"),
        ("lzf_truth", "compressed by lzf", "compression=\"gzip\""),
        ("half", "floating point numbers of 16 bits", "float32"),
        (
            "half_attributes",
            "floating point numbers of 16 bits",
            "float32",
        ),
        ("half_means", "floating point numbers of 16 bits", "float32"),
        ("extended", "floating point numbers of 128 bits", "float32"),
        ("complex", "expected numbers", ""),
        ("booleans", "expected numbers", ""),
        ("texts", "expected numbers", ""),
        ("interrupted", "still open for writing", "h5clear -s"),
    ];
    let folder = rewritten(&cases.map(|(kind, ..)| kind));
    for (kind, found, way_out) in cases {
        let file = RunFile::open(folder.path().join(format!("{kind}.h5")));
        let error = file
            .and_then(|file| file.read("first"))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(found) && error.contains(way_out),
            "{kind}: {error}"
        );
        assert!(!error.contains("damaged"), "{kind}: {error}");
    }
}
