//! What the ready data set's runs on slate ask of the rig.

use crate::cli::{done, run};
use lugwheel::dataset::hdf5::RunFile;
use std::fs;
use tempfile::TempDir;

/// The ready data set with its runs on slate only.
fn on_slate() -> String {
    let root = env!("CARGO_MANIFEST_DIR");
    let text = fs::read_to_string(format!("{root}/scenarios/studies/dataset.toml")).unwrap();
    let other_ground =
        |line: &&str| line.contains("single_wheel_") && !line.contains("single_wheel_ht");
    let kept: Vec<&str> = text.lines().filter(|line| !other_ground(line)).collect();
    let scenarios = format!("\"{root}/scenarios/");
    kept.join("\n").replace("\"../", &scenarios)
}

#[test]
#[ignore = "simulates 400 runs of 21 s: four minutes in release"]
fn on_slate_no_run_pulls_more_than_its_load_and_none_reaches_the_limits_of_the_rig() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("slate.toml"), on_slate()).unwrap();
    done(run(folder.path(), "study slate.toml --out slate"));
    let file = RunFile::open(folder.path().join("slate/dataset.h5")).unwrap();
    let [mut mean_pull, mut pull, mut torque, mut limited] = [0.0_f64; 4];
    for id in file.runs() {
        let trace = file.read(id).unwrap();
        let peak = |name: &str| {
            let samples = &trace.channel(name).unwrap().samples;
            samples.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
        };
        let mean = trace.steady_mean("drawbar_pull").unwrap();
        mean_pull = mean_pull.max(mean / trace.attributes.load);
        pull = pull.max(peak("drawbar_pull"));
        torque = torque.max(peak("driving_torque"));
        let truth = trace.truth.unwrap();
        limited += f64::from(u8::from(truth.at_limit.any()));
    }
    let count = file.runs().len();
    let table = format!(
        "# cargo test --release --test all slate_rig:: -- --ignored\n\
         # Runs of scenarios/studies/dataset.toml on slate (seed 31): the largest of all.\n\
         runs                              {count:>8}\n\
         mean pull over load [-]           {mean_pull:>8.3}\n\
         sample of pull [N]                {pull:>8.1}\n\
         sample of torque [N m]            {torque:>8.2}\n\
         runs with a drive at its limit    {limited:>8}\n"
    );
    let place = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/output/reference/slate_rig.txt"
    );
    fs::write(place, &table).unwrap();
    assert_eq!(count, 400);
    assert!(mean_pull < 1.0 && pull < 1000.0, "{table}");
    assert!(torque < 1.05 * 54.0, "{table}");
}
