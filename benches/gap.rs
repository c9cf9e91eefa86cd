//! Cost of reading a run for the gap map: 10 s at 2 kHz, eight channels.

use criterion::{Criterion, criterion_group, criterion_main};
use lugwheel::features::Settings;
use lugwheel::features::reference::Reference;
use lugwheel::gap::Statistician;
use lugwheel::trace::{CHANNELS, Channel, RunAttributes, Trace};
use std::hint::black_box;

/// Wheel speed [rad/s].
const WHEEL_SPEED: f64 = 0.7;

fn channel(name: &str, unit: &str, value: impl Fn(f64) -> f64) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        sample_rate: 2000.0,
        start: 0.0,
        samples: (0..20_000).map(|i| value(f64::from(i) / 2000.0)).collect(),
    }
}

/// Lugs that strike and ring at 60 Hz.
fn impacts(time: f64) -> f64 {
    let alpha = std::f64::consts::TAU / 28.0;
    let since = (WHEEL_SPEED * time / alpha - 0.5).rem_euclid(1.0) * alpha / WHEEL_SPEED;
    1.5 * libm::exp(-since / 0.02) * libm::cos(std::f64::consts::TAU * 60.0 * since)
}

fn run() -> Trace {
    let mut channels: Vec<Channel> = CHANNELS
        .iter()
        .enumerate()
        .map(|(place, (name, unit))| channel(name, unit, move |t| impacts(t + 0.01 * place as f64)))
        .collect();
    channels[6] = channel("wheel_angle", "rad", |time| WHEEL_SPEED * time);
    Trace {
        attributes: RunAttributes {
            wheel_radius: 0.14,
            wheel_width: 0.15,
            lug_count: Some(28),
            lug_height: 0.015,
            load: 100.0,
            speed: 0.09,
            slip_ratio: 0.1,
            ..RunAttributes::default()
        },
        channels,
        ..Trace::default()
    }
}

fn statistics(criterion: &mut Criterion) {
    let trace = run();
    let mut statistician = Statistician::new(Settings::default(), Reference::computed())
        .expect("the defaults are in range");
    criterion.bench_function("statistics of a run of 10 s at 2 kHz", |bencher| {
        bencher.iter(|| statistician.read(black_box(&trace)));
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = statistics
}
criterion_main!(benches);
