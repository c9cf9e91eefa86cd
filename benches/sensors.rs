//! Cost of the sensor chain: time for one second of states, with noise on every channel, and for a motion of 10 s that is
//! measured again.

use criterion::{Criterion, criterion_group, criterion_main};
use lugwheel::quantity::{SampleRate, Seed};
use lugwheel::scenario::Scenario;
use lugwheel::sensors::{Observed, SensorChain, Sensors};
use lugwheel::simulation::WheelState;
use std::ops::ControlFlow;

/// One second: 128 000 samples at the sensor rate, whatever the physics rate.
fn second(sensors: &Sensors, physics_rate: f64) -> usize {
    let rate = SampleRate::new(physics_rate).expect("a whole rate");
    let observed = Observed {
        physics_rate: rate,
        wheel_radius: 0.14,
        seed: Seed(1),
        run: 0,
    };
    let mut chain = SensorChain::new(sensors, &observed).expect("rates that divide");
    let mut state = WheelState::default();
    for step in 0..rate.whole() {
        state.time = f64::from(step) * rate.period();
        state.vertical_acceleration = f64::from(step % 97) - 48.0;
        state.hub.normal_force = 100.0 + f64::from(step % 89);
        chain.push(&state);
    }
    chain.finish().len()
}

fn chain(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("one second of states through the sensors");
    for (name, sensors, physics_rate) in [
        ("ideal, 128 kHz", Sensors::default(), 128_000.0),
        ("realistic, 128 kHz", Sensors::realistic(), 128_000.0),
        ("realistic, 8 kHz", Sensors::realistic(), 8_000.0),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| second(&sensors, physics_rate));
        });
    }
    group.finish();
}

/// A motion of 10 s on slate at its default rate, read again by a laboratory's sensors: by the whole chain, and by its linear
/// part at the output rate.
fn again(criterion: &mut Criterion) {
    let path = format!(
        "{}/scenarios/single_wheel_ht.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let scenario = Scenario::load(path).expect("a ready scenario");
    let scenario = scenario.with("duration=10").expect("a key of it");
    let go_on = &mut |_| ControlFlow::Continue(());
    let recording = scenario.record(Seed(1), 0, go_on).expect("it runs");
    let sensors = Sensors::realistic();
    let many = recording.for_many(&sensors).expect("rates that divide");
    let mut group = criterion.benchmark_group("10 s of motion measured again");
    group.bench_function("whole chain", |bencher| {
        bencher.iter(|| recording.measure(&sensors));
    });
    group.bench_function("linear chain", |bencher| {
        bencher.iter(|| many.measure(&sensors));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = chain, again
}
criterion_main!(benches);
