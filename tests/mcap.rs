//! Runs as MCAP files, read by the format's own Python package.

use crate::common::python;
use lugwheel::quantity::Seed;
use lugwheel::report::mcap_file;
use lugwheel::scenario::{Scenario, ready};
use lugwheel::trace::{Channel, Trace};
use std::ops::ControlFlow;

/// A run on sand of 3 s.
fn run() -> Trace {
    let quick = Scenario::ready(ready::scenario("quick").unwrap()).unwrap();
    let trace = quick.run(Seed(1), 0, &mut |_| ControlFlow::Continue(()));
    trace.unwrap()
}

/// Every line of `time,value` of a channel, as its Python reader prints them.
fn samples(channel: &Channel) -> String {
    let samples = channel.samples.iter().enumerate();
    let line = |(index, &sample): (usize, &f64)| {
        format!("{:.9},{:e}\n", channel.time(index), sample as f32)
    };
    samples.map(line).collect()
}

#[test]
fn an_mcap_file_has_every_sample_at_its_time_and_a_wheel_that_stands_where_the_run_says() {
    let Some(python) = python::with_or_skip(&["mcap"]) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let run = run();
    std::fs::write(path("run.mcap"), mcap_file(&run, "run").unwrap()).unwrap();
    for name in ["drawbar_pull", "sinkage"] {
        let channel = run.channel(name).unwrap();
        std::fs::write(path(&format!("{name}.csv")), samples(channel)).unwrap();
    }
    let [speed, slip] = [run.attributes.speed, run.attributes.slip_ratio].map(|it| it.to_string());
    let radius = run.attributes.wheel_radius.to_string();
    let [file, folder] = [path("run.mcap"), path("")];
    let arguments = [&file, &folder, &speed, &slip, &radius].map(String::as_str);
    python::run(python, "python/mcap_file.py", &arguments);
}

#[test]
fn the_same_run_is_the_same_mcap_file_and_one_without_channels_is_refused() {
    let run = run();
    assert!(mcap_file(&run, "run").unwrap() == mcap_file(&run, "run").unwrap());
    assert!(mcap_file(&Trace::default(), "run").is_err());
}
