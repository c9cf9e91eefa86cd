//! What `inspect` doubts in logs as people have them, and what it must not doubt.

use crate::cli::{done, run};
use crate::common::opened_for_editing;
use crate::import::{doubts, imported};
use lugwheel::dataset::Provenance;
use lugwheel::dataset::hdf5::{RunFile, RunFileWriter};
use lugwheel::dataset::inspection::{Finding, Severity, findings, inspect};
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use lugwheel::trace::Trace;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn data(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/inspection");
    folder.join(name)
}

fn simulated(name: &str, set: &[&str]) -> Trace {
    let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let scenario = Scenario::load(path).unwrap().with_all(set).unwrap();
    scenario
        .run(Seed(5), 0, &mut |_| ControlFlow::Continue(()))
        .unwrap()
}

fn doubted(trace: &Trace) -> Vec<Finding> {
    let mut found = findings("run", trace);
    found.retain(|finding| finding.severity > Severity::Info);
    found
}

/// Doubts about a campaign of `tests/data/inspection`.
fn doubts_of(campaign: &str) -> Vec<String> {
    let (_folder, file) = imported(&format!("data/inspection/{campaign}.toml"));
    doubts(&inspect(&file))
}

#[test]
fn the_one_resistance_of_kls_1_beyond_load_and_entry_angle_is_doubted() {
    let doubts = doubts_of("kls1");
    let [doubt] = &doubts[..] else {
        panic!("{doubts:#?}")
    };
    let part = "kls1_smooth_w59_s10 drawbar_pull: torque over radius less pull leaves a resistance of 15.79 N";
    assert!(doubt.contains(part), "{doubt}");
}

#[test]
fn a_pull_that_is_not_tared_gives_more_power_than_the_torque_puts_in() {
    let doubts = doubts_of("pull_untared");
    for (run, ratio) in [
        ("run_000000", "2.232"),
        ("run_000001", "1.48"),
        ("run_000002", "1.137"),
    ] {
        let part = format!("output power is {ratio} times the input power of the torque");
        let found = doubts.iter().find(|doubt| doubt.contains(run));
        assert!(
            found.is_some_and(|doubt| doubt.contains(&part)),
            "{run}: {doubts:#?}"
        );
    }
    assert_eq!(doubts.len(), 3, "{doubts:#?}");
}

#[test]
fn a_pull_of_the_other_sign_leaves_a_resistance_beyond_load_and_entry_angle() {
    let doubts = doubts_of("pull_reversed");
    assert_eq!(doubts.len(), 5, "{doubts:#?}");
    assert!(
        doubts
            .iter()
            .all(|doubt| doubt.contains("leaves a resistance of")),
        "{doubts:#?}"
    );
}

#[test]
fn a_sinkage_counted_upward_falls_with_slip() {
    let doubts = doubts_of("sinkage_upward");
    let part = "of 5 runs of this wheel and load lies below 0 and falls from -4.8 to -13.1 mm";
    assert!(
        doubts.iter().any(|doubt| doubt.contains(part)),
        "{doubts:#?}"
    );
}

#[test]
fn quantised_wheel_speeds_are_not_clipped_nor_is_an_angle_from_0_to_360_degrees_reversed() {
    assert_eq!(doubts_of("wheel_speeds"), [""; 0]);
    assert_eq!(doubts_of("wrapped_angle"), [""; 0]);
}

#[test]
fn a_filter_and_a_size_of_numbers_that_hdf5_lacks_are_named_with_a_way_out() {
    for (name, found, way_out) in [
        (
            "lzf.h5",
            "compressed by lzf, a filter that this HDF5 lacks",
            "compression=\"gzip\"",
        ),
        (
            "f16.h5",
            "floating point numbers of 16 bits",
            ".astype(\"float32\")",
        ),
    ] {
        let file = RunFile::open(data(name)).unwrap();
        let inspection = inspect(&file);
        let [finding] = &inspection.findings[..] else {
            panic!("{inspection}")
        };
        assert_eq!(finding.severity, Severity::Error);
        let message = &finding.message;
        assert!(
            message.contains(found) && message.contains(way_out),
            "{message}"
        );
        assert!(!message.contains("damaged"), "{message}");
    }
}

#[test]
fn a_wheel_that_stops_has_no_slip_from_then_on_and_is_not_doubted() {
    let set = ["duration=5", "rig.single_wheel.stop_at=2"];
    let parked = simulated("single_wheel_st", &set);
    let slip = parked.channel("slip_ratio").unwrap();
    let at = |time: f64| slip.between(time, 10.0)[0];
    // The loop still winds up against a torque that grows as the wheel sinks.
    assert!((at(1.5) - 0.1).abs() < 0.02, "{slip:?}");
    assert!(at(3.5).is_nan() && at(4.5).is_nan(), "{slip:?}");
    assert_eq!(doubted(&parked), []);
    assert_eq!(doubted(&parked.as_measured()), []);
}

#[test]
fn a_wheel_that_never_moves_has_no_slip_at_all() {
    let set = ["duration=2", "rig.single_wheel.forward_speed=0"];
    let standing = simulated("single_wheel_st", &set);
    let slip = standing.channel("slip_ratio").unwrap();
    assert!(slip.samples.iter().all(|slip| slip.is_nan()));
    assert_eq!(standing.steady_mean("slip_ratio"), None);
    assert_eq!(doubted(&standing), []);
}

#[test]
fn a_wheel_that_spins_in_place_has_a_slip_of_one() {
    let path = format!(
        "{}/scenarios/single_wheel_ht.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = fs::read_to_string(path).unwrap();
    let of_slip = |line: &&str| line.starts_with("slip ");
    let slip = text.lines().find(of_slip).unwrap();
    let text = text.replace(slip, "wheel_speed = 0.1  # rad/s");
    let scenario = Scenario::from_toml(&text, "spinning.toml").unwrap();
    let set = ["duration=2", "rig.single_wheel.forward_speed=0"];
    let scenario = scenario.with_all(&set).unwrap();
    let spinning = scenario
        .run(Seed(5), 0, &mut |_| ControlFlow::Continue(()))
        .unwrap();
    let slip = spinning.steady_mean("slip_ratio").unwrap();
    // The pull stretches the belt by 0.1 mm, some of it while the slip is taken.
    assert!((slip - 1.0).abs() < 0.02, "{slip}");
    assert_eq!(doubted(&spinning), []);
}

/// A campaign of one run of means, with this slip.
fn campaign(folder: &Path, slip: &str) {
    let columns = "pull,torque,sinkage\n12.7,3.5,0.0056\n";
    fs::write(folder.join("means.csv"), columns).unwrap();
    let text = format!(
        "version = 1\n[table]\nfile = \"means.csv\"\n\
         wheel = {{ radius_m = 0.14, width_m = 0.15, lug_count = 28, lug_height_m = 0.015 }}\n\
         load_n = 100\nspeed_m_s = 0.014\nslip_ratio = {slip}\nterrain = \"ST\"\n\
         columns = {{ drawbar_pull = \"pull\", driving_torque = \"torque\", sinkage = \"sinkage\" }}\n"
    );
    fs::write(folder.join("rig.toml"), text).unwrap();
    done(run(folder, "import rig.toml --out rig.h5"));
}

/// Exit code, stdout and stderr of `inspect`.
fn inspected(folder: &Path, words: &str) -> (Option<i32>, String, String) {
    let output = run(folder, &format!("inspect {words}"));
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

#[test]
fn a_sound_file_exits_with_0_and_one_with_a_warning_with_3_when_strict() {
    let folder = TempDir::new().unwrap();
    campaign(folder.path(), "0.1");
    assert_eq!(inspected(folder.path(), "rig.h5 --strict").0, Some(0));
    // The pull is that of a driven wheel.
    fs::remove_file(folder.path().join("rig.h5")).unwrap();
    campaign(folder.path(), "-0.3");
    assert_eq!(inspected(folder.path(), "rig.h5").0, Some(0));
    let (code, said, errors) = inspected(folder.path(), "rig.h5 --strict");
    assert_eq!(code, Some(3));
    assert!(said.contains("while braking with slip -0.3"), "{said}");
    assert_eq!(errors, "error: rig.h5: 1 warning; see above\n");
}

#[test]
fn a_run_that_cannot_be_read_exits_with_3_after_the_others_were_inspected() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("runs.h5");
    let (_campaign, file) = imported("data/inspection/kls1.toml");
    let mut writer = RunFileWriter::create(&path, &Provenance::measured()).unwrap();
    for id in &file.runs()[..3] {
        writer.add(id, &file.read(id).unwrap()).unwrap();
    }
    writer.finish().unwrap();
    let spoilt = opened_for_editing(&path);
    let run = spoilt.group(&format!("runs/{}", file.runs()[1])).unwrap();
    run.delete_attr("load_n").unwrap();
    drop((run, spoilt));
    let (code, said, errors) = inspected(folder.path(), "runs.h5");
    assert_eq!(code, Some(3), "{errors}");
    assert!(
        said.contains("expected an attribute load_n, a number, found none"),
        "{said}"
    );
    assert!(said.starts_with("runs.h5: 2 runs"), "{said}");
    assert!(errors.starts_with("error: runs.h5: 1 error"), "{errors}");
    let (code, said, _) = inspected(folder.path(), "runs.h5 --json");
    let document: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(
        (code, document["runs"].as_array().unwrap().len()),
        (Some(3), 2)
    );
}

#[test]
fn no_ready_scenario_is_doubted_as_simulated_or_as_measured() {
    for name in [
        "quick",
        "single_wheel_ref",
        "single_wheel_ht",
        "single_wheel_gt",
        "single_wheel_hgt",
        "single_wheel_st",
        "single_wheel_sgt",
        "rover_ref",
        "rover_ht",
        "rover_gt",
        "rover_st",
    ] {
        // Two seconds until carriage and motor have given way to pull and torque.
        // On stones and over joints the way of a lug or two is as much as chance makes of it.
        let uneven = name.ends_with("gt") || name == "rover_ht";
        // Single stones on slate are a few a metre, and one may roll along under the wheel for 100 mm.
        let duration = match name {
            "single_wheel_hgt" => 40,
            _ if uneven => 10,
            _ => 2,
        };
        // A wheel on stone winds its drive up to the friction before it slips.
        let set = [format!("duration={duration}"), "lead_in=6".to_owned()];
        let trace = simulated(name, &set.each_ref().map(String::as_str));
        // A drive gives way to stones: the slip of some lugs is not the one commanded, and that is to be said.
        let of_stones = |found: &Finding| uneven && found.channel.as_deref() == Some("slip_ratio");
        for trace in [trace.clone(), trace.as_measured()] {
            let mut doubts = doubted(&trace);
            doubts.retain(|found| !of_stones(found));
            assert_eq!(doubts, [], "{name}");
        }
    }
}

#[test]
fn published_campaigns_raise_the_doubts_that_they_deserve() {
    for (campaign, expected) in [
        // The lugged wheel has no torque at slip 0.
        ("ding2011/points", 1),
        ("ding2011/points_from_torque", 0),
        ("chrono-scm/means", 0),
        // Three runs whose rim ran at 13 mm/s for 12.
        ("cmu-single-wheel/smooth_wheel_runs", 3),
    ] {
        let (_folder, file) = imported(&format!("data/{campaign}.toml"));
        let doubts = doubts(&inspect(&file));
        assert_eq!(doubts.len(), expected, "{campaign}: {doubts:#?}");
    }
}

#[test]
fn a_wheel_that_stops_on_any_ground_and_rig_is_not_doubted() {
    for (name, rig) in [
        ("rover_st", "rover_leg"),
        ("single_wheel_ht", "single_wheel"),
        ("single_wheel_gt", "single_wheel"),
    ] {
        let stop = format!("rig.{rig}.stop_at=2");
        let parked = simulated(name, &["duration=5", &stop]);
        let slip = parked.channel("slip_ratio").unwrap();
        assert!(
            slip.between(4.0, 10.0).iter().all(|slip| slip.is_nan()),
            "{name}: {slip:?}"
        );
        // Two seconds on gravel are one stone or two: a wheel that parks as it climbs one pulls as much as its load.
        let by_stones = |channel: &str| {
            name.ends_with("gt") && ["slip_ratio", "drawbar_pull"].contains(&channel)
        };
        for trace in [parked.clone(), parked.as_measured()] {
            let mut found = doubted(&trace);
            found.retain(|found| !found.channel.as_deref().is_some_and(by_stones));
            assert_eq!(found, [], "{name}");
        }
    }
}

/// What `inspect` says of the drive's vibration in runs of a lifted wheel at these speeds [m/s].
fn drive_vibration(speeds: &[&str], set: &[&str]) -> String {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("lifted.h5");
    let mut writer =
        RunFileWriter::create(&path, &Provenance::simulated("lifted", Seed(5))).unwrap();
    for (index, speed) in speeds.iter().enumerate() {
        let speed = format!("rig.single_wheel.forward_speed={speed}");
        let lifted = ["rig.single_wheel.lifted=0.03", "duration=30", &speed];
        let set = [&lifted[..], set].concat();
        let trace = simulated("single_wheel_ref", &set);
        writer.add(&format!("run_{index}"), &trace).unwrap();
    }
    writer.finish().unwrap();
    let found = inspect(&RunFile::open(&path).unwrap()).findings;
    let [finding] = &found[..] else {
        panic!("{found:#?}")
    };
    finding.message.clone()
}

/// The number before `unit` [-].
fn number_before(text: &str, unit: &str) -> f64 {
    let before = text.split(unit).next().unwrap();
    before.rsplit(' ').next().unwrap().parse().unwrap()
}

#[test]
fn lifted_runs_at_two_speeds_size_the_drives_vibration_under_a_noisy_sensor() {
    const VIBRATION: &str = "sensors.accelerometer.drive_vibration";
    let broadband = format!("{VIBRATION}.broadband=0.002");
    let noise = "sensors.accelerometer.acceleration_y.noise_density=2e-4";
    let seen = drive_vibration(&["0.007", "0.014", "0.028"], &[&broadband, noise]);
    let size = number_before(&seen, " +-");
    assert!((size / 2.0 - 1.0).abs() < 0.1, "{seen}");
    assert!(
        seen.ends_with("without the sensor's noise, and no line of one order"),
        "{seen}"
    );
}

#[test]
fn lifted_runs_find_the_gears_line_and_its_order() {
    const VIBRATION: &str = "sensors.accelerometer.drive_vibration";
    let mesh = [
        format!("{VIBRATION}.mesh=0.003"),
        format!("{VIBRATION}.mesh_order=400"),
    ];
    let broadband = format!("{VIBRATION}.broadband=0.001");
    let set = [mesh[0].as_str(), &mesh[1], &broadband];
    let seen = drive_vibration(&["0.010", "0.020"], &set);
    let size = number_before(&seen, " +-");
    assert!((size - 1.0).abs() < 0.1, "{seen}");
    let order = number_before(&seen, " with ");
    assert!((order / 400.0 - 1.0).abs() < 0.01, "{seen}");
    let line = seen.split(" with ").last().unwrap();
    assert!(
        (number_before(line, " mm/s^2") / 3.0 - 1.0).abs() < 0.05,
        "{seen}"
    );
}
