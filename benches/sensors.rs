//! Cost of the sensor chain: time for one second of states, with noise on every channel.

use criterion::{Criterion, criterion_group, criterion_main};
use lugwheel::quantity::{SampleRate, Seed};
use lugwheel::sensors::{SensorChain, Sensors};
use lugwheel::simulation::WheelState;

/// One second: 128 000 samples at the sensor rate, whatever the physics rate.
fn second(sensors: &Sensors, physics_rate: f64) -> usize {
    let rate = SampleRate::new(physics_rate).expect("a whole rate");
    let mut chain = SensorChain::new(sensors, rate, 0.14, Seed(1), 0).expect("rates that divide");
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

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = chain
}
criterion_main!(benches);
