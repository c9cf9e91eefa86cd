//! Run files: what is written comes back, whole or not at all, and always the same bytes.

use lugwheel::dataset::Provenance;
use lugwheel::dataset::hdf5::{RunFile, RunFileError, RunFileWriter};
use lugwheel::quantity::Seed;
use lugwheel::terrain::class::{TerrainLabel, Wtic};
use lugwheel::trace::wheel::{Lugs, Plate};
use lugwheel::trace::{
    AtLimit, CHANNELS, Channel, ClassWindow, Contact, LugTally, Mean, RunAttributes, Trace, Truth,
};
use proptest::collection::{btree_map, vec};
use proptest::option;
use proptest::prelude::*;
use std::path::Path;
use std::process::Command;

fn channel(name: &str, unit: &str, samples: Vec<f64>) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        sample_rate: 1000.0,
        start: 0.0,
        samples,
    }
}

/// A run whose force looks like noise, so that it cannot be compressed to nothing.
fn noisy(samples: u32) -> Trace {
    let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 8) * 1.0e-5;
    let attributes = RunAttributes {
        wheel_radius: 0.14,
        wheel_width: 0.15,
        lug_count: Some(28),
        lug_height: 0.015,
        load: 100.0,
        speed: 0.014,
        slip_ratio: 0.1,
        terrain: Some(TerrainLabel::Sand),
        ..RunAttributes::default()
    };
    Trace {
        attributes,
        channels: vec![channel(
            "normal_force",
            "N",
            (0..samples).map(noise).collect(),
        )],
        ..Trace::default()
    }
}

fn write(path: &Path, runs: &[(&str, &Trace)]) -> Result<(), RunFileError> {
    let provenance = Provenance::simulated("version = 1\n", Seed(u64::MAX));
    let mut writer = RunFileWriter::create(path, &provenance)?;
    for (id, trace) in runs {
        writer.add(id, trace)?;
    }
    writer.finish()
}

fn files_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name());
    names
        .map(|name| name.to_string_lossy().into_owned())
        .collect()
}

// Random runs.

fn label() -> impl Strategy<Value = TerrainLabel> {
    prop_oneof![
        Just(TerrainLabel::Reference),
        Just(TerrainLabel::Gravel),
        Just(TerrainLabel::HardWithGravel),
    ]
}

fn class() -> impl Strategy<Value = Wtic> {
    prop_oneof![
        Just(Wtic::Alct),
        Just(Wtic::Slct),
        Just(Wtic::Leis),
        Just(Wtic::Uwtic)
    ]
}

/// Any text HDF5 can hold: all of Unicode but NUL.
fn text() -> impl Strategy<Value = String> {
    "[^\0]{0,40}"
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        prop::num::f64::NORMAL | prop::num::f64::ZERO | prop::num::f64::NEGATIVE,
        Just(f64::INFINITY)
    ]
}

/// Values that single precision holds exactly, so that they must come back to the bit.
fn sample() -> impl Strategy<Value = f64> {
    (prop::num::f32::NORMAL | prop::num::f32::ZERO | prop::num::f32::NEGATIVE).prop_map(f64::from)
}

prop_compose! {
    fn any_channel()(
        known in option::of(0..CHANNELS.len()),
        other in "[a-zµ][a-z_0-9 ]{0,12}",
        unit in text(),
        sample_rate in 0.1..1.0e6_f64,
        start in -1.0e3..1.0e3_f64,
        samples in vec(sample(), 0..300),
    ) -> Channel {
        let name = known.map_or(other, |i| CHANNELS[i].0.to_owned());
        Channel { name, unit, sample_rate, start, samples }
    }
}

fn plate() -> impl Strategy<Value = Plate> {
    prop_oneof![
        number().prop_map(|diameter| Plate::Disc { diameter }),
        (number(), number()).prop_map(|sides| Plate::rectangle([sides.0, sides.1])),
    ]
}

prop_compose! {
    fn attributes()(
        sizes in [number(), number(), number(), number(), number(), number()],
        counts in any::<(Option<u32>, u32)>(),
        (wheel_mass, slope_deg, plate, lug_thickness) in (option::of(number()), number(), option::of(plate()), option::of(number())),
        terrain in option::of(label()),
        class in option::of(class()),
        day in text(),
        notes in text(),
        physics_rate in option::of(number()),
        angle_zero_unknown in any::<bool>(),
        import_notes in vec("[a-z0-9:,° ]{1,20}", 0..3),
    ) -> RunAttributes {
        let [wheel_radius, wheel_width, lug_height, load, speed, slip_ratio] = sizes;
        let (lug_count, repeat) = counts;
        let Lugs { count: lug_count, height: lug_height } = Lugs::stated(lug_count, lug_height);
        RunAttributes {
            wheel_radius, wheel_width, lug_count, lug_height, lug_thickness, load, speed, slip_ratio,
            wheel_mass, slope_deg, plate,
            terrain, class, repeat, day, notes, physics_rate, angle_zero_unknown, import_notes,
        }
    }
}

prop_compose! {
    fn truth()(
        contacts in vec((any::<u32>(), number(), number(), any::<bool>()), 0..20),
        windows in vec((number(), number(), class(), label()), 0..5),
        parameters in btree_map("[a-z_]{1,12}", number(), 0..6),
        profile in vec([number(), number()], 0..30),
        limited in [0.01..1.0_f64, 0.0..1.0],
    ) -> Truth {
        let contact = |(lug, start, end, entered)| Contact { lug, start, end, entered };
        let window = |(start, end, class, terrain)| ClassWindow { start, end, class, terrain, lugs: None };
        Truth {
            contacts: contacts.into_iter().map(contact).collect(),
            class_windows: windows.into_iter().map(window).collect(),
            parameters,
            profile,
            at_limit: AtLimit { carriage: limited[0], motor: limited[1] },
        }
    }
}

prop_compose! {
    fn trace()(
        attributes in attributes(),
        channels in vec(any_channel(), 0..4),
        means in vec(("[a-z_]{1,12}", text(), number(), number(), 0..1_u64 << 53), 0..4),
        truth in option::of(truth()),
    ) -> Trace {
        let mean = |(name, unit, value, sd, n)| Mean { name, unit, value, sd, n };
        let mut trace = Trace {
            attributes,
            channels,
            means: means.into_iter().map(mean).collect(),
            truth,
        };
        // A file has one channel of a name, and lists them by name.
        trace.channels.sort_by(|a, b| a.name.cmp(&b.name));
        trace.channels.dedup_by(|a, b| a.name == b.name);
        trace.means.sort_by(|a, b| a.name.cmp(&b.name));
        trace.means.dedup_by(|a, b| a.name == b.name);
        trace
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_run_comes_back_as_it_was(runs in vec(trace(), 0..3), seed: u64, scenario in text()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.h5");
        let provenance = Provenance::simulated(scenario, Seed(seed));
        let mut writer = RunFileWriter::create(&path, &provenance).unwrap();
        let ids: Vec<String> = (0..runs.len()).map(|i| format!("run_{i}")).collect();
        for (id, run) in ids.iter().zip(&runs) {
            writer.add(id, run).unwrap();
        }
        writer.finish().unwrap();

        let file = RunFile::open(&path).unwrap();
        prop_assert_eq!(file.provenance(), &provenance);
        prop_assert_eq!(file.runs(), &ids[..]);
        for (id, run) in ids.iter().zip(&runs) {
            prop_assert_eq!(&file.read(id).unwrap(), run);
            prop_assert_eq!(&file.attributes(id).unwrap(), &run.attributes);
        }
    }
}

#[test]
fn runs_and_channels_are_read_in_the_order_of_their_letters_however_many() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.h5");
    let names: Vec<String> = (0..20).map(|i| format!("n{i:02}")).collect();
    let channels = names.iter().rev().map(|name| channel(name, "N", vec![1.0]));
    let trace = Trace {
        channels: channels.collect(),
        ..noisy(0)
    };
    let runs: Vec<(&str, &Trace)> = names.iter().map(|name| (name.as_str(), &trace)).collect();
    write(&path, &runs).unwrap();
    let file = RunFile::open(&path).unwrap();
    assert_eq!(file.runs(), names);
    let read = file.read("n07").unwrap();
    let read: Vec<&String> = read.channels.iter().map(|channel| &channel.name).collect();
    assert_eq!(read, names.iter().collect::<Vec<_>>());
}

#[test]
fn forces_keep_six_digits_wheel_angle_and_unknown_channels_all_gaps_stay_gaps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.h5");
    let third = 1.0e5 / 3.0;
    let trace = Trace {
        channels: vec![
            channel("motor_current", "A", vec![third]),
            channel("normal_force", "N", vec![third, f64::NAN]),
            channel("wheel_angle", "rad", vec![third]),
        ],
        ..noisy(0)
    };
    write(&path, &[("a", &trace)]).unwrap();
    let read = RunFile::open(&path).unwrap().read("a").unwrap();
    assert_eq!(read.channels[0].samples, [third]);
    assert_eq!(read.channels[2].samples, [third]);
    let force = &read.channels[1].samples;
    // Half a unit in the last of 24 binary digits.
    assert!(
        (force[0] / third - 1.0).abs() <= 2.0_f64.powi(-24),
        "{}",
        force[0]
    );
    assert!(force[1].is_nan());
    let first =
        |trace: &Trace| -> Vec<f64> { trace.channels.iter().map(|it| it.samples[0]).collect() };
    assert_eq!(first(&trace.as_kept()), first(&read));
}

#[test]
fn lugs_behind_a_class_come_back_where_they_were_counted_in_all_windows() {
    let folder = tempfile::tempdir().unwrap();
    let window = |start: f64, lugs| ClassWindow {
        start,
        end: start + 15.0,
        class: Wtic::Slct,
        terrain: TerrainLabel::Gravel,
        lugs,
    };
    let counted = |touched| {
        Some(LugTally {
            passed: 10,
            touched,
            entered: 2,
        })
    };
    let read = |name: &str, windows: [Option<LugTally>; 2]| -> Vec<Option<LugTally>> {
        let [first, second] = windows;
        let truth = Truth {
            class_windows: vec![window(0.0, first), window(15.0, second)],
            ..Truth::default()
        };
        let mut trace = noisy(10);
        trace.truth = Some(truth);
        let path = folder.path().join(name);
        write(&path, &[("a", &trace)]).unwrap();
        let read = RunFile::open(&path).unwrap().read("a").unwrap();
        let windows = read.truth.unwrap().class_windows;
        windows.iter().map(|window| window.lugs).collect()
    };
    let (all, some) = ([counted(5), counted(7)], [counted(5), None]);
    assert_eq!(read("all.h5", all), all);
    assert_eq!(read("some.h5", some), [None, None]);
}

#[test]
fn the_same_runs_give_the_same_bytes_a_second_later() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["first.h5", "second.h5"].map(|name| folder.path().join(name));
    let mut trace = noisy(40_000);
    trace.attributes.notes = "every kind of group".to_owned();
    trace.means.push(Mean {
        name: "sinkage".to_owned(),
        unit: "m".to_owned(),
        value: 0.01,
        sd: 0.001,
        n: 10,
    });
    trace.truth = Some(Truth {
        contacts: vec![
            Contact {
                lug: 3,
                start: 0.0,
                end: 1.0,
                entered: true,
            },
            Contact {
                lug: 4,
                start: 0.5,
                end: 1.5,
                entered: false,
            },
        ],
        class_windows: vec![ClassWindow {
            start: 0.0,
            end: 15.0,
            class: Wtic::Leis,
            terrain: TerrainLabel::Sand,
            lugs: None,
        }],
        parameters: [("c".to_owned(), 300.0)].into(),
        profile: vec![[0.0, 0.0], [0.1, 0.002]],
        at_limit: AtLimit::default(),
    });
    write(&first, &[("a", &trace), ("b", &noisy(10))]).unwrap();
    // HDF5 would note seconds.
    std::thread::sleep(std::time::Duration::from_millis(1100));
    write(&second, &[("a", &trace), ("b", &noisy(10))]).unwrap();
    assert!(std::fs::read(first).unwrap() == std::fs::read(second).unwrap());
}

#[test]
fn the_name_is_taken_only_by_a_whole_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.h5");
    write(&path, &[("old", &noisy(10))]).unwrap();

    let mut writer = RunFileWriter::create(&path, &Provenance::measured()).unwrap();
    writer.add("new", &noisy(10)).unwrap();
    assert_eq!(RunFile::open(&path).unwrap().runs(), ["old"]);
    drop(writer);
    assert_eq!(RunFile::open(&path).unwrap().runs(), ["old"]);
    assert_eq!(files_in(folder.path()), ["runs.h5"]);

    write(&path, &[("new", &noisy(10))]).unwrap();
    assert_eq!(RunFile::open(&path).unwrap().runs(), ["new"]);
    assert_eq!(files_in(folder.path()), ["runs.h5"]);
}

#[cfg(unix)]
#[test]
fn a_run_file_has_the_permissions_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let [path, other] = ["runs.h5", "other"].map(|name| folder.path().join(name));
    write(&path, &[]).unwrap();
    std::fs::write(&other, "").unwrap();
    let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&other));
}

#[test]
fn a_run_that_cannot_be_stored_is_refused_and_the_file_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.h5");
    let mut writer = RunFileWriter::create(&path, &Provenance::measured()).unwrap();
    writer.add("a", &noisy(10)).unwrap();
    let mut twice = noisy(10);
    twice.channels.push(twice.channels[0].clone());
    let mut nul = noisy(10);
    nul.attributes.notes = "a\0b".to_owned();
    let mut no_rate = noisy(10);
    no_rate.channels[0].sample_rate = 0.0;
    let refused = [
        ("a", noisy(10), "already has a run"),
        ("b/c", noisy(10), "must be a name without \"/\""),
        ("", noisy(10), "must be a name"),
        ("b", twice, "channel \"normal_force\" is there twice"),
        ("b", nul, "NUL"),
        (
            "b",
            no_rate,
            "sample rate [Hz] of channel normal_force must be above 0",
        ),
    ];
    for (id, trace, part) in refused {
        let error = writer.add(id, &trace).unwrap_err();
        assert!(matches!(error, RunFileError::Unfit { .. }), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
    writer.add("b", &noisy(20)).unwrap();
    writer.finish().unwrap();
    assert_eq!(RunFile::open(&path).unwrap().runs(), ["a", "b"]);
}

#[test]
fn a_folder_that_cannot_be_written_to_is_named_with_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let error = write(&folder.path().join("none/runs.h5"), &[])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("none/runs.h5: No such file or directory; make the folder first or"),
        "{error}"
    );
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let error = write(&file.join("runs.h5"), &[]).unwrap_err().to_string();
    assert!(error.contains("Not a directory"), "{error}");
    let error = write(folder.path(), &[]).unwrap_err().to_string();
    assert!(
        error.ends_with("it is a folder; name a file in it"),
        "{error}"
    );
    assert_eq!(files_in(folder.path()), ["file"]);
}

#[test]
fn a_truncated_file_is_an_error_at_every_length() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.h5");
    write(&path, &[("a", &noisy(5_000))]).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for length in [0, 7, 8, 100, 1_000, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).unwrap();
        let error = RunFile::open(&path).map(|_| ()).unwrap_err();
        let expected = match error {
            RunFileError::NotHdf5 { .. } => length < 8,
            RunFileError::Damaged { .. } => length >= 8,
            _ => false,
        };
        assert!(expected, "{length} bytes: {error}");
        assert!(error.to_string().contains("runs.h5"), "{error}");
    }
}

/// The bytes of HDF5's text heaps, the only part of a run file without a checksum.
fn in_text_heap(file: &[u8]) -> Vec<bool> {
    let mut inside = vec![false; file.len()];
    for start in 0..file.len() - 16 {
        if &file[start..start + 4] == b"GCOL" {
            let size = u64::from_le_bytes(file[start + 8..start + 16].try_into().unwrap());
            inside[start..start + size as usize].fill(true);
        }
    }
    inside
}

#[test]
fn a_flipped_bit_in_a_sample_or_in_the_structure_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.h5");
    write(&path, &[("a", &noisy(3_000))]).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let original = RunFile::open(&path).unwrap().read("a").unwrap();
    let heap = in_text_heap(&whole);
    assert!(heap.contains(&true) && heap.iter().filter(|&&inside| inside).count() < 5_000);
    let mut found = 0;
    for place in (0..whole.len()).step_by(31).filter(|&place| !heap[place]) {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x10;
        std::fs::write(&path, &bytes).unwrap();
        match RunFile::open(&path).and_then(|file| file.read("a")) {
            // A lost chunk is a gap.
            Ok(trace) if trace.channels[0].samples.iter().any(|x| x.is_nan()) => found += 1,
            // Bytes that nothing uses may change.
            Ok(trace) => assert_eq!(trace, original, "byte {place} of {}", whole.len()),
            Err(_) => found += 1,
        }
    }
    // 12 kB of samples alone, every 31st byte.
    assert!(found > 300, "{found}");
}

#[test]
fn other_files_are_refused_by_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("runs.csv");
    std::fs::write(&csv, "t,Fz\n0,1\n").unwrap();
    let error = RunFile::open(&csv).unwrap_err();
    assert!(matches!(error, RunFileError::NotHdf5 { .. }), "{error}");
    let error = RunFile::open(folder.path().join("none.h5")).unwrap_err();
    assert!(matches!(error, RunFileError::Read { .. }), "{error}");
    let error = RunFile::open(folder.path()).unwrap_err();
    assert!(matches!(error, RunFileError::Read { .. }), "{error}");
}

#[test]
fn a_run_that_is_not_there_is_answered_with_those_that_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.h5");
    let run = noisy(1);
    write(&path, &[("a", &run), ("b", &run)]).unwrap();
    let error = RunFile::open(&path)
        .unwrap()
        .read("c")
        .unwrap_err()
        .to_string();
    assert!(
        error.ends_with("runs.h5 has no run \"c\"; it has a, b"),
        "{error}"
    );
    let many: Vec<String> = (0..7).map(|i| format!("r{i}")).collect();
    let many: Vec<(&str, &Trace)> = many.iter().map(|id| (id.as_str(), &run)).collect();
    write(&path, &many).unwrap();
    let error = RunFile::open(&path)
        .unwrap()
        .read("../r0")
        .unwrap_err()
        .to_string();
    assert!(error.ends_with("it has 7 runs, r0 to r6"), "{error}");
}

/// Runs in a process of its own, below; the limit of its file sizes stands in for a full disk.
#[test]
#[ignore = "run by a_full_disk_is_reported_and_leaves_nothing, under a limit"]
fn write_more_than_the_limit() {
    let folder = std::env::var("LUGWHEEL_TEST_FOLDER").expect("set by the test that runs this one");
    let folder = Path::new(&folder);
    let path = folder.join("runs.h5");
    let run = noisy(200_000);
    let error = write(&path, &[("a", &run), ("b", &run)]).unwrap_err();
    assert!(matches!(error, RunFileError::Write { .. }), "{error}");
    let message = error.to_string();
    assert!(message.contains("File too large"), "{message}");
    assert!(message.contains("name another folder"), "{message}");
    assert_eq!(files_in(folder), ["runs.h5"]);
    assert_eq!(RunFile::open(&path).unwrap().runs(), ["old"]);
    // The library still works: a small file fits.
    write(&path, &[("new", &noisy(10))]).unwrap();
    assert_eq!(RunFile::open(&path).unwrap().runs(), ["new"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("runs.h5"), &[("old", &noisy(10))]).unwrap();
    // `ulimit -f` counts blocks of 512 bytes in sh, 1024 in bash: 100 or 200 KiB, and the runs
    // have 500 KiB each.
    let script = "trap '' XFSZ; ulimit -f 200; exec \"$0\" --exact files::write_more_than_the_limit --ignored";
    let output = Command::new("sh")
        .args(["-c", script])
        .arg(std::env::current_exe().unwrap())
        .env("LUGWHEEL_TEST_FOLDER", folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}");
    assert!(text.contains("1 passed"), "{text}");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        !errors.contains("HDF5-DIAG"),
        "HDF5 wrote to stderr: {errors}"
    );
}
