//! A motion measured again at the output rate, against the whole chain at 128 kHz.

use crate::common::{mean, ready, recorded, rms};
use lugwheel::effects::{Application, Form, Stage, catalogue};
use lugwheel::scenario::Scenario;
use lugwheel::scenario::recording::Recording;
use lugwheel::sensors::Sensors;
use lugwheel::trace::{Channel, Trace};
use std::sync::LazyLock;

/// Three seconds of the paper's wheel on slate, lugs striking.
static SLATE: LazyLock<(Scenario, Recording)> = LazyLock::new(|| {
    let edits = [
        "duration=3",
        "lead_in=1",
        "rig.single_wheel.forward_speed=0.05",
    ];
    let scenario = ready("single_wheel_ht", &edits);
    let recording = recorded(&scenario);
    (scenario, recording)
});

/// What the whole chain and the linear one make of the motion with an effect.
fn both(effect: &str, form: Form) -> [Trace; 2] {
    let (scenario, recording) = &*SLATE;
    let effect: Application = effect.parse().unwrap();
    let edited = scenario
        .with_effect(&effect.in_form(form).unwrap())
        .unwrap();
    with(recording, &edited.experiment().unwrap().sensors)
}

fn with(recording: &Recording, sensors: &Sensors) -> [Trace; 2] {
    let many = recording.for_many(sensors).unwrap();
    [
        recording.measure(sensors).unwrap(),
        many.measure(sensors).unwrap(),
    ]
}

fn deviation(samples: &[f64]) -> f64 {
    let middle = mean(samples.iter().copied());
    rms(samples.iter().map(|x| x - middle))
}

/// Largest departure of one from the other, in standard deviations, the first and last 0.1 s aside.
fn apart(whole: &Channel, linear: &Channel) -> f64 {
    assert_eq!(whole.samples.len(), linear.samples.len(), "{}", whole.name);
    assert_eq!(
        [whole.start, whole.sample_rate],
        [linear.start, linear.sample_rate]
    );
    let edge = (0.1 * whole.sample_rate) as usize;
    let inner = edge..whole.samples.len() - edge;
    let pairs = whole.samples[inner.clone()]
        .iter()
        .zip(&linear.samples[inner.clone()]);
    let largest = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    largest / deviation(&whole.samples[inner]).max(1e-12)
}

fn worst(traces: &[Trace; 2]) -> f64 {
    let pairs = traces[0].channels.iter().zip(&traces[1].channels);
    pairs
        .map(|(whole, linear)| apart(whole, linear))
        .fold(0.0, f64::max)
}

#[test]
fn every_effect_of_the_sensors_that_draws_nothing_is_read_as_by_the_whole_chain() {
    let draws = ["added_noise", "drive_vibration"];
    let effects = catalogue().filter(|effect| effect.stage == Stage::Sensors);
    for effect in effects.filter(|effect| !draws.contains(&effect.name)) {
        for seat in effect.seats {
            let typical = seat.levels[1];
            let name = match seat.channel {
                "" => format!("{}={typical}", effect.name),
                channel => format!("{}.{channel}={typical}", effect.name),
            };
            let application: Application = name.parse().unwrap();
            for form in [Form::Own, Form::Other] {
                if application.in_form(form).is_ok() {
                    let apart = worst(&both(&name, form));
                    assert!(apart < 1.0e-3, "{name}, {form}: {apart}");
                }
            }
        }
    }
}

#[test]
fn what_is_linear_does_not_pass_the_whole_chain() {
    for effect in [
        "low_pass.acceleration_y=300",
        "channel_delay.acceleration_y=0.0033",
    ] {
        let [whole, linear] = both(effect, Form::Own);
        assert_ne!(whole.channels[0], linear.channels[0], "{effect}");
    }
}

/// Root mean square in bands of 100 Hz of what a trace has and an ideal one has not.
fn bands(trace: &Trace, name: &str) -> Vec<f64> {
    let (scenario, recording) = &*SLATE;
    let ideal = recording.measure(&scenario.sensors).unwrap();
    let [samples, ideal] = [trace, &ideal].map(|trace| &trace.channel(name).unwrap().samples);
    let added: Vec<f64> = samples.iter().zip(ideal).map(|(a, b)| a - b).collect();
    let tone = |frequency: f64| {
        let phase = |k: usize| std::f64::consts::TAU * frequency * k as f64 / 2000.0;
        let part =
            |wave: fn(f64) -> f64| mean(added.iter().enumerate().map(|(k, x)| x * wave(phase(k))));
        part(f64::sin).hypot(part(f64::cos))
    };
    let lines = |band: u32| (0..100).map(move |line| f64::from(100 * band + line) + 0.5);
    (0..10).map(|band| rms(lines(band).map(tone))).collect()
}

#[test]
fn noise_of_a_laboratory_s_sensors_and_of_a_drive_has_the_whole_chain_s_spectrum() {
    let mut sensors = Sensors::realistic();
    sensors.force_torque.crosstalk = Sensors::default().force_torque.crosstalk;
    sensors.accelerometer.cross_axis = 0.0;
    sensors.accelerometer.acceleration_y.noise_density = 2.0e-3;
    sensors.accelerometer.drive_vibration.broadband = 2.0e-3;
    let traces = with(&SLATE.1, &sensors);
    for name in ["acceleration_y", "normal_force", "driving_torque"] {
        let [whole, linear] = [&traces[0], &traces[1]].map(|trace| bands(trace, name));
        for (band, (whole, linear)) in whole.iter().zip(&linear).enumerate() {
            // A hundred lines with two parts each scatter by 7 %, their ratio by 10 %.
            let ratio = linear / whole;
            assert!((0.6..1.6).contains(&ratio), "{name}, band {band}: {ratio}");
        }
    }
}

#[test]
fn a_channel_that_clips_passes_the_whole_chain_bit_by_bit_and_others_do_not_wait_for_it() {
    let [whole, linear] = both("clipping.acceleration_y=0.2", Form::Own);
    assert_eq!(whole.channels[0], linear.channels[0]);
    assert!(apart(&whole.channels[1], &linear.channels[1]) < 1.0e-3);
}
