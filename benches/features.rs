//! Cost of recognition: the features of one window of the paper, 15 s at 2 kHz, and its class.

use criterion::{Criterion, criterion_group, criterion_main};
use lugwheel::features::record::Record;
use lugwheel::features::reference::Reference;
use lugwheel::features::{Extractor, Settings};
use lugwheel::recognition::improved;
use lugwheel::trace::{Channel, RunAttributes, Trace};
use std::hint::black_box;

/// Wheel speed [rad/s]: 20 mm/s at a rim radius of 0.14 m, ten lug passes in the window.
const WHEEL_SPEED: f64 = 0.159;

fn channel(name: &str, unit: &str, value: impl Fn(f64) -> f64) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        sample_rate: 2000.0,
        start: 0.0,
        samples: (0..30_000).map(|i| value(f64::from(i) / 2000.0)).collect(),
    }
}

/// Lugs that strike and ring at 60 Hz.
fn impacts(time: f64) -> f64 {
    let alpha = std::f64::consts::TAU / 28.0;
    let since = (WHEEL_SPEED * time / alpha - 0.5).rem_euclid(1.0) * alpha / WHEEL_SPEED;
    1.5 * libm::exp(-since / 0.02) * libm::cos(std::f64::consts::TAU * 60.0 * since)
}

fn record() -> Record {
    let trace = Trace {
        attributes: RunAttributes {
            wheel_radius: 0.14,
            wheel_width: 0.15,
            lug_count: Some(28),
            lug_height: 0.015,
            ..RunAttributes::default()
        },
        channels: vec![
            channel("acceleration_y", "m/s^2", impacts),
            channel("wheel_angle", "rad", |time| WHEEL_SPEED * time),
        ],
        ..Trace::default()
    };
    Record::of(&trace).expect("it has all that a record needs")
}

fn window(criterion: &mut Criterion) {
    let record = record();
    let whole = 0..record.len();
    let mut extractor = Extractor::new(Settings::default()).expect("the defaults are in range");
    let reference = Reference::computed();
    let mut group = criterion.benchmark_group("one window of 15 s at 2 kHz");
    group.bench_function("features", |bencher| {
        bencher.iter(|| extractor.features(black_box(&record), whole.clone(), &reference));
    });
    group.bench_function("improved", |bencher| {
        bencher.iter(|| improved::class(&mut extractor, black_box(&record), whole.clone()));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(50);
    targets = window
}
criterion_main!(benches);
