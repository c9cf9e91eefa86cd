//! Faults of sensors and descriptions against grounds: which of them `inspect` finds, and how often it doubts
//! what is right.
//!
//! `cargo test --release --test all inspection_faults:: -- --ignored --nocapture` writes
//! `output/reference/inspection.txt`.

use crate::common::edit_samples;
use lugwheel::dataset::inspection::{Severity, findings};
use lugwheel::quantity::{GRAVITY, Seed};
use lugwheel::scenario::Scenario;
use lugwheel::trace::Trace;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::ops::ControlFlow;

const SEED: Seed = Seed(211);

const GROUNDS: [&str; 6] = ["ref", "ht", "gt", "hgt", "st", "sgt"];
const SLIPS: [f64; 6] = [-0.2, 0.0, 0.1, 0.2, 0.3, 0.6];
const LOADS: [f64; 4] = [60.0, 100.0, 150.0, 200.0];

/// A clean run of a single wheel, as a rig would hand it over.
fn clean(ground: &str, slip: f64, load: f64) -> Trace {
    let path = format!(
        "{}/scenarios/single_wheel_{ground}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let set = [
        "duration=4".to_owned(),
        "rig.single_wheel.forward_speed=0.03".to_owned(),
        format!("rig.single_wheel.slip={slip}"),
        format!("rig.single_wheel.load={load:?}"),
    ];
    let scenario = Scenario::load(path).unwrap().with_all(&set).unwrap();
    let run = (1000.0 * (slip + 1.0) + load) as u64;
    scenario
        .run(SEED, run, &mut |_| ControlFlow::Continue(()))
        .unwrap()
        .as_measured()
}

fn is_doubted(trace: &Trace) -> bool {
    findings("run", trace)
        .iter()
        .any(|finding| finding.severity > Severity::Info)
}

/// A fault, and how a run has it.
type Fault = (&'static str, Box<dyn Fn(&mut Trace) + Sync>);

fn scaled(name: &'static str, factor: f64) -> Box<dyn Fn(&mut Trace) + Sync> {
    Box::new(move |trace| edit_samples(trace, name, |x| factor * x))
}

/// A fault of a channel by a share of the load.
fn shifted(name: &'static str, share: f64) -> Box<dyn Fn(&mut Trace) + Sync> {
    Box::new(move |trace| {
        let by = share * trace.attributes.load;
        edit_samples(trace, name, |x| x + by);
    })
}

fn without(trace: &mut Trace, names: &[&str]) {
    trace
        .channels
        .retain(|channel| !names.contains(&channel.name.as_str()));
}

fn slower(trace: &mut Trace) {
    for channel in &mut trace.channels {
        channel.sample_rate /= 1000.0;
    }
}

fn faults() -> Vec<Fault> {
    let millisecond_loads = |trace: &mut Trace| {
        slower(trace);
        without(trace, &["acceleration_y", "wheel_angle"]);
    };
    vec![
        ("pull reversed", scaled("drawbar_pull", -1.0)),
        ("pull + 50 % of the load", shifted("drawbar_pull", 0.5)),
        ("pull - 50 % of the load", shifted("drawbar_pull", -0.5)),
        ("pull x 9.81", scaled("drawbar_pull", GRAVITY)),
        ("pull / 9.81", scaled("drawbar_pull", 1.0 / GRAVITY)),
        ("pull x 1000", scaled("drawbar_pull", 1.0e3)),
        ("torque reversed", scaled("driving_torque", -1.0)),
        ("torque x 9.81", scaled("driving_torque", GRAVITY)),
        ("torque / 9.81", scaled("driving_torque", 1.0 / GRAVITY)),
        ("torque x 1000", scaled("driving_torque", 1.0e3)),
        ("torque / 1000", scaled("driving_torque", 1.0e-3)),
        ("normal force reversed", scaled("normal_force", -1.0)),
        ("normal force / 9.81", scaled("normal_force", 1.0 / GRAVITY)),
        ("sinkage x 1000", scaled("sinkage", 1.0e3)),
        ("sinkage / 1000", scaled("sinkage", 1.0e-3)),
        ("slip in per cent", scaled("slip_ratio", 100.0)),
        ("speed x 1000", scaled("forward_speed", 1.0e3)),
        ("speed x 3.6", scaled("forward_speed", 3.6)),
        ("angle reversed", scaled("wheel_angle", -1.0)),
        ("angle in degrees", scaled("wheel_angle", 360.0 / TAU)),
        ("angle in turns", scaled("wheel_angle", 1.0 / TAU)),
        (
            "gravity left in",
            Box::new(|t| edit_samples(t, "acceleration_y", |a| a + GRAVITY)),
        ),
        (
            "gravity taken off twice",
            Box::new(|t| edit_samples(t, "acceleration_y", |a| a - GRAVITY)),
        ),
        (
            "gravity left in, in g",
            Box::new(|t| edit_samples(t, "acceleration_y", |a| a / GRAVITY + 1.0)),
        ),
        ("acceleration x 1000", scaled("acceleration_y", 1.0e3)),
        (
            "acceleration / 9.81",
            scaled("acceleration_y", 1.0 / GRAVITY),
        ),
        ("time in ms", Box::new(slower)),
        ("time in ms, loads alone", Box::new(millisecond_loads)),
    ]
}

/// What is no fault.
fn sound_variants() -> Vec<Fault> {
    vec![
        ("as it is", Box::new(|_| ())),
        (
            "angle modulo a turn",
            Box::new(|t| edit_samples(t, "wheel_angle", |a| a.rem_euclid(TAU))),
        ),
        (
            "angle modulo 0.7 rad",
            Box::new(|t| edit_samples(t, "wheel_angle", |a| a.rem_euclid(0.7))),
        ),
        (
            "forces in steps of 2 N",
            Box::new(|t| edit_samples(t, "drawbar_pull", |x| (x / 2.0).round() * 2.0)),
        ),
        ("without sinkage", Box::new(|t| without(t, &["sinkage"]))),
        (
            "without angle and speed",
            Box::new(|t| without(t, &["wheel_angle", "forward_speed"])),
        ),
    ]
}

fn conditions() -> Vec<(&'static str, f64, f64)> {
    let with_loads = |ground, slip| LOADS.map(|load| (ground, slip, load));
    let with_slips = |ground| SLIPS.map(|slip| with_loads(ground, slip));
    GROUNDS.into_iter().flat_map(with_slips).flatten().collect()
}

/// A row for each of `faults`: how many of the runs of each ground are doubted.
fn rows(faults: &[Fault], runs: &[(&str, Trace)]) -> String {
    let mut text = String::new();
    for (name, apply) in faults {
        write!(text, "{name:<26}").unwrap();
        for ground in GROUNDS {
            let of_ground = runs.iter().filter(|(other, _)| *other == ground);
            let of_ground: Vec<&Trace> = of_ground.map(|(_, trace)| trace).collect();
            let doubted = of_ground.par_iter().filter(|trace| {
                let mut faulty = (**trace).clone();
                apply(&mut faulty);
                is_doubted(&faulty)
            });
            let shares = format!("{}/{}", doubted.count(), of_ground.len());
            write!(text, "{shares:>8}").unwrap();
        }
        text.push('\n');
    }
    text
}

#[test]
#[ignore = "simulates 144 runs: minutes in release"]
fn faults_of_sensors_against_grounds() {
    let runs: Vec<(&str, Trace)> = conditions()
        .into_par_iter()
        .map(|(ground, slip, load)| (ground, clean(ground, slip, load)))
        .collect();
    let grounds = GROUNDS.map(|ground| format!("{ground:>8}")).concat();
    let text = format!(
        "# cargo test --release --test all inspection_faults:: -- --ignored\n\
         # Runs doubted (warning or error) of {} a ground: 30 mm/s, 4 s, slip {SLIPS:?}, load {LOADS:?} N, seed {}.\n\n\
         no fault                  {grounds}\n{}\n\
         fault                     {grounds}\n{}",
        SLIPS.len() * LOADS.len(),
        SEED.0,
        rows(&sound_variants(), &runs),
        rows(&faults(), &runs)
    );
    println!("{text}");
    for (ground, trace) in &runs {
        for finding in findings("run", trace) {
            println!("{ground} {:?} {finding}", trace.attributes);
        }
    }
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/output/reference/inspection.txt"
    );
    std::fs::write(path, text).unwrap();
}
