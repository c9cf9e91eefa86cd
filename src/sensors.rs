//! Sensor models: [`WheelState`] in, [`Channel`]s of a trace out.
//!
//! ```text
//! state -> rate up -> delay, clock -> mount, bandwidth -> gain, bias -> noise -> range, steps -> rate down
//!        (physics rate to sensor rate)                                        (sensor rate to output rate)
//! ```
//!
//! This is the chain of the fast channels: acceleration, forces, torque, speed. The wheel angle is latched at
//! the output rate, and a camera measures sinkage and slip frame by frame. Every parameter of a sensor has a
//! neutral value, which is its default.

pub mod accelerometer;
pub mod decimator;
pub mod drive_vibration;
pub mod encoder;
mod fast_channel;
mod fir;
pub mod force_torque;
mod interpolator;
pub mod linear_chain;
pub mod loose_mount;
mod noise;
mod sampling;
mod second_order;
mod single_pole;
mod slow_channels;
#[cfg(test)]
mod spectrum;
mod stages;
pub mod transducer;
pub mod vision;

use crate::quantity::{RangeError, SampleRate, Seed};
use crate::simulation::WheelState;
use crate::trace::Channel;
use accelerometer::{Accelerometer, Axis};
use decimator::whole_ratio;
use drive_vibration::Vibrating;
use encoder::Encoder;
use fast_channel::{FastChannel, Mount, Signal};
use force_torque::ForceTorque;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use slow_channels::SlowChannels;
use transducer::Transducer;
use vision::Vision;

/// All sensors of a rig and how they are sampled.
///
/// The default is ideal: 128 kHz down to 2 kHz, no error anywhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Sensors {
    /// Rate \[Hz\] at which accelerometer and force sensor are sampled.
    pub rate: SampleRate,
    /// Rate \[Hz\] of the stored samples; divides `rate`.
    pub output_rate: SampleRate,
    /// Whether to store the samples of the fast channels at the sensor rate too, as `<channel>_raw`. Above
    /// half of the physics rate they contain only noise.
    pub raw: bool,
    /// Whether samples pass an anti-alias filter before most of them are dropped.
    pub anti_alias: bool,
    /// Share [-] of the stored samples' signal that bypasses the anti-alias filter.
    pub alias_leak: f64,
    /// Share [-] of the stored samples' signal that passes a moving average over the dropped samples instead
    /// of the anti-alias filter.
    pub alias_mean: f64,
    /// Relative error [-] of the sampling clock: above 0 it runs slow, so that the true sample interval is
    /// longer than nominal.
    pub clock_error: f64,
    /// On the axle.
    pub accelerometer: Accelerometer,
    /// Between wheel and axle.
    pub force_torque: ForceTorque,
    /// Wheel angle and forward speed.
    pub encoder: Encoder,
    /// Sinkage and slip.
    pub vision: Vision,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            rate: SampleRate::REFERENCE,
            output_rate: SampleRate::OUTPUT,
            raw: false,
            anti_alias: true,
            alias_leak: 0.0,
            alias_mean: 0.0,
            clock_error: 0.0,
            accelerometer: Accelerometer::default(),
            force_torque: ForceTorque::default(),
            encoder: Encoder::default(),
            vision: Vision::default(),
        }
    }
}

impl Sensors {
    /// Sensors of a good laboratory, calibrated and tared; values and type of device are documented at each
    /// sensor's own `realistic`.
    pub fn realistic() -> Self {
        Self {
            accelerometer: Accelerometer::realistic(),
            force_torque: ForceTorque::realistic(),
            encoder: Encoder::realistic(),
            vision: Vision::realistic(),
            ..Self::default()
        }
    }

    /// Whether such sensors can be.
    ///
    /// # Errors
    /// `RangeError` for the first figure that cannot, such as an output rate that does not divide
    /// the sensor rate; it names the nearest that do.
    pub fn check(&self) -> Result<(), RangeError> {
        self.decimation()?;
        RangeError::check("clock error", "-", self.clock_error, [-0.1, 0.1])?;
        RangeError::check("alias leak", "-", self.alias_leak, [0.0, 1.0])?;
        RangeError::check("alias mean", "-", self.alias_mean, [0.0, 1.0])?;
        let rate = self.rate.hertz();
        self.accelerometer.check(rate)?;
        self.force_torque.check(rate)?;
        self.encoder.check(rate)?;
        self.vision.check()
    }
}

/// The run observed by the sensors. Their noise depends on it, one random stream per channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed {
    /// Rate \[Hz\] of the states.
    pub physics_rate: SampleRate,
    /// Rim radius \[m\].
    pub wheel_radius: f64,
    /// Where the series' draws come from.
    pub seed: Seed,
    /// Number of the run in its series.
    pub run: u64,
}

/// Name and unit of every analogue channel: acceleration, the three loads, forward speed.
const ANALOGUE: [(&str, &str); 5] = [
    ("acceleration_y", "m/s^2"),
    ("normal_force", "N"),
    ("drawbar_pull", "N"),
    ("driving_torque", "N m"),
    ("forward_speed", "m/s"),
];

impl Sensors {
    /// Number of samples at the sensor rate per stored sample.
    ///
    /// # Errors
    /// `RangeError` where that is no whole number.
    fn decimation(&self) -> Result<u32, RangeError> {
        whole_ratio("output rate", self.output_rate, "sensor rate", self.rate)
    }

    /// The figures of every analogue channel.
    pub fn transducers(&self) -> [Transducer; ANALOGUE.len()] {
        let loads = &self.force_torque;
        [
            self.accelerometer.acceleration_y,
            loads.normal_force,
            loads.drawbar_pull,
            loads.driving_torque,
            self.encoder.forward_speed,
        ]
    }

    /// The analogue channel of this place at work on a run.
    fn analogue_channel(
        &self,
        place: usize,
        observed: &Observed,
    ) -> Result<FastChannel, RangeError> {
        let (name, unit) = ANALOGUE[place];
        let signal = Signal {
            name,
            unit,
            transducer: self.transducers()[place],
        };
        let rng = observed.seed.rng(&format!("sensors.{name}"), observed.run);
        let mut channel = FastChannel::new(self, observed.physics_rate, signal, rng)?;
        if place == 0 {
            channel.stand_on(Mount::of(&self.accelerometer, self.rate.hertz()));
        }
        Ok(channel)
    }
}

/// What the analogue channels are given: quantities as they act on the sensors.
struct Quantities {
    axis: Axis,
    drive: Option<Vibrating>,
    force_torque: ForceTorque,
}

impl Quantities {
    /// Of states at `rate` [Hz].
    fn new(sensors: &Sensors, observed: &Observed, rate: f64) -> Self {
        let accelerometer = &sensors.accelerometer;
        let rng = observed.seed.rng("sensors.drive_vibration", observed.run);
        Self {
            axis: accelerometer.axis(),
            drive: Vibrating::new(accelerometer.drive_vibration, rate, rng),
            force_torque: sensors.force_torque,
        }
    }

    /// At the next state.
    fn of(&mut self, state: &WheelState) -> [f64; ANALOGUE.len()] {
        let [normal, pull, torque] = self.force_torque.bridges(&state.hub);
        let mut acceleration = self.axis.along(state);
        if let Some(drive) = &mut self.drive {
            acceleration += drive.acceleration(state);
        }
        [acceleration, normal, pull, torque, state.forward_speed]
    }
}

/// A sensor that a user brings.
pub trait Sensor {
    /// Looks at the next state of the record, one a physics step.
    fn push(&mut self, state: &WheelState);

    /// What it measured.
    fn finish(self: Box<Self>) -> Channel;
}

/// The sensors of one run; memory grows with the stored samples, not with the physics rate.
pub struct SensorChain {
    quantities: Quantities,
    fast: Vec<FastChannel>,
    slow: SlowChannels,
    own: Vec<Box<dyn Sensor>>,
    /// Time [s] of the first state.
    start: f64,
    steps: u64,
}

impl SensorChain {
    /// Sensors on a wheel whose states come one after another.
    ///
    /// # Errors
    /// `RangeError` where [`Sensors::check`] finds one, or where the physics rate does not divide
    /// the sensor rate.
    pub fn new(sensors: &Sensors, observed: &Observed) -> Result<Self, RangeError> {
        sensors.check()?;
        let physics_rate = observed.physics_rate;
        whole_ratio("physics rate", physics_rate, "sensor rate", sensors.rate)?;
        RangeError::positive("wheel radius", "m", observed.wheel_radius)?;
        let places = 0..ANALOGUE.len();
        let fast = places.map(|place| sensors.analogue_channel(place, observed));
        Ok(Self {
            quantities: Quantities::new(sensors, observed, physics_rate.hertz()),
            fast: fast.collect::<Result<_, _>>()?,
            slow: SlowChannels::new(sensors, observed),
            own: Vec::new(),
            start: 0.0,
            steps: 0,
        })
    }

    /// Adds sensors of the user's own, whose channels come last.
    pub fn add(&mut self, sensors: impl IntoIterator<Item = Box<dyn Sensor>>) {
        self.own.extend(sensors);
    }

    /// Measures the next state.
    pub fn push(&mut self, state: &WheelState) {
        if self.steps == 0 {
            self.start = state.time;
        }
        self.own.iter_mut().for_each(|sensor| sensor.push(state));
        let values = self.quantities.of(state);
        for (channel, value) in self.fast.iter_mut().zip(values) {
            channel.push(value);
        }
        self.slow.push(self.steps, state);
        self.steps += 1;
    }

    /// The channels of the run: the fast ones and the wheel angle at the output rate, sample `k`
    /// at `k / output_rate` after the first state; sinkage and slip at the frame rate, slip from
    /// the first frame that has a partner; raw ones last, if kept.
    pub fn finish(self) -> Vec<Channel> {
        let start = self.start;
        let fast = self.fast.into_iter();
        let (mut channels, raw): (Vec<_>, Vec<_>) = fast.map(|fast| fast.finish(start)).unzip();
        let count = channels[0].samples.len();
        channels.extend(self.slow.finish(start, count));
        channels.extend(raw.into_iter().flatten());
        channels.extend(self.own.into_iter().map(|sensor| sensor.finish()));
        channels
    }
}

fn channel(name: &str, unit: &str, sample_rate: f64, start: f64, samples: Vec<f64>) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        sample_rate,
        start,
        samples,
    }
}

#[cfg(test)]
mod tests {
    use super::spectrum::{amplitude, decibels};
    use super::*;
    use crate::signal::Plans;
    use sha2::{Digest, Sha256};
    use std::f64::consts::TAU;

    const SEED: Seed = Seed(42);

    fn rate(hertz: u32) -> SampleRate {
        SampleRate::new(f64::from(hertz)).unwrap()
    }

    fn observed(physics: u32, run: u64) -> Observed {
        Observed {
            physics_rate: rate(physics),
            wheel_radius: 0.14,
            seed: SEED,
            run,
        }
    }

    /// A wheel that rolls steadily at a slip of 0.2 while a tone shakes and loads it.
    fn shaken(time: f64, frequency: f64) -> WheelState {
        let tone = libm::sin(TAU * frequency * time);
        let mut state = WheelState {
            time,
            position: 0.014 * time,
            wheel_angle: 0.125 * time,
            forward_speed: 0.014,
            vertical_acceleration: tone,
            sinkage: 0.012,
            ..WheelState::default()
        };
        state.hub.normal_force = 100.0 + 10.0 * tone;
        state.hub.drawbar_pull = 20.0 + 3.0 * tone;
        state.hub.driving_torque = 3.0 + 0.4 * tone;
        state
    }

    fn measured(sensors: &Sensors, physics: u32, seconds: f64, frequency: f64) -> Vec<Channel> {
        let mut chain = SensorChain::new(sensors, &observed(physics, 17)).unwrap();
        for step in 0..(seconds * f64::from(physics)) as u32 {
            chain.push(&shaken(f64::from(step) / f64::from(physics), frequency));
        }
        chain.finish()
    }

    fn named<'a>(channels: &'a [Channel], name: &str) -> &'a [f64] {
        let found = channels.iter().find(|channel| channel.name == name);
        &found.unwrap_or_else(|| panic!("no {name}")).samples
    }

    #[test]
    fn channels_have_the_names_units_and_rates_of_a_run_file() {
        let found: Vec<_> = measured(&Sensors::default(), 16_000, 0.5, 10.0)
            .into_iter()
            .map(|c| (c.name, c.unit, c.sample_rate, c.start, c.samples.len()))
            .collect();
        let expected = [
            ("acceleration_y", "m/s^2", 2000.0, 0.0, 1000),
            ("normal_force", "N", 2000.0, 0.0, 1000),
            ("drawbar_pull", "N", 2000.0, 0.0, 1000),
            ("driving_torque", "N m", 2000.0, 0.0, 1000),
            ("forward_speed", "m/s", 2000.0, 0.0, 1000),
            ("wheel_angle", "rad", 2000.0, 0.0, 1000),
            ("sinkage", "m", 10.0, 0.0, 5),
            ("slip_ratio", "1", 10.0, 0.1, 4),
        ];
        let expected = expected.map(|(name, unit, rate, start, samples)| {
            (name.to_owned(), unit.to_owned(), rate, start, samples)
        });
        assert_eq!(found, expected);
    }

    #[test]
    fn ideal_sensors_pass_constants_without_changing_a_bit() {
        for physics in [128_000, 8_000] {
            let mut chain = SensorChain::new(&Sensors::default(), &observed(physics, 0)).unwrap();
            for _ in 0..physics / 4 {
                let mut state = shaken(0.0173, 7.0);
                state.position = 0.0;
                chain.push(&state);
            }
            let state = shaken(0.0173, 7.0);
            let channels = chain.finish();
            for (name, value) in [
                ("acceleration_y", state.vertical_acceleration),
                ("normal_force", state.hub.normal_force),
                ("drawbar_pull", state.hub.drawbar_pull),
                ("driving_torque", state.hub.driving_torque),
                ("forward_speed", state.forward_speed),
                ("wheel_angle", state.wheel_angle),
            ] {
                assert_eq!(
                    named(&channels, name),
                    vec![value; 500],
                    "{name} at {physics} Hz"
                );
            }
            assert_eq!(named(&channels, "sinkage"), [state.sinkage; 3]);
        }
    }

    #[test]
    fn the_whole_chain_is_flat_and_in_time_from_either_physics_rate() {
        for (physics, frequency) in [(128_000, 800.0), (8_000, 800.0), (8_000, 30.0)] {
            let channels = measured(&Sensors::default(), physics, 1.0, frequency);
            let acceleration = named(&channels, "acceleration_y");
            for (k, found) in acceleration.iter().enumerate().take(1500).skip(500) {
                let wave = shaken(k as f64 / 2000.0, frequency).vertical_acceleration;
                // 0.1 dB is 1.2 %; the filters' ripple is a hundredth of it, and any shift in time
                // of a thousandth of a sample would show at 800 Hz as 2.5e-3.
                assert!((found - wave).abs() < 5e-4, "{physics}, {frequency}: {k}");
            }
        }
    }

    #[test]
    fn what_lies_above_the_outputs_nyquist_frequency_comes_out_80_db_down() {
        for frequency in [1_010.0, 1_700.0, 2_300.0, 7_950.0, 31_950.0, 62_700.0] {
            let channels = measured(&Sensors::default(), 128_000, 0.6, frequency);
            let middle = &named(&channels, "acceleration_y")[300..900];
            let found = decibels(amplitude(middle, frequency / 2000.0));
            assert!(found < -80.0, "{frequency} Hz at {found} dB");
        }
    }

    #[test]
    fn without_its_filter_the_chain_aliases() {
        let sensors = Sensors {
            anti_alias: false,
            ..Sensors::default()
        };
        let channels = measured(&sensors, 128_000, 0.5, 2_300.0);
        let found = amplitude(
            &named(&channels, "acceleration_y")[200..800],
            300.0 / 2000.0,
        );
        assert!((found - 1.0).abs() < 1e-6, "{found}");
    }

    #[test]
    fn noise_of_the_output_has_the_stated_density() {
        let mut sensors = Sensors::default();
        sensors.accelerometer.acceleration_y.noise_density = 1e-3;
        let chain = |run| {
            let mut chain = SensorChain::new(&sensors, &observed(8_000, run)).unwrap();
            (0..80_000).for_each(|_| chain.push(&WheelState::default()));
            chain.finish().swap_remove(0).samples
        };
        let noise = chain(0);
        // Power in the flat band, by tones spread over it (bins of a 20 000-point transform).
        let transform = Plans::default().forward(noise.len());
        let spectrum = transform.apply(noise.clone());
        let flat = &spectrum[10..8000];
        let power = flat.iter().map(|c| c.norm_sqr()).sum::<f64>() / flat.len() as f64;
        let density = libm::sqrt(2.0 * power / (2000.0 * noise.len() as f64));
        // Five standard errors of the root of a mean of 7990 exponential numbers.
        assert!((density / 1e-3 - 1.0).abs() < 0.028, "{density}");
    }

    #[test]
    fn the_same_seed_and_run_give_the_same_bits_and_another_run_does_not() {
        let sensors = Sensors::realistic();
        let samples = |run| {
            let mut chain = SensorChain::new(&sensors, &observed(8_000, run)).unwrap();
            (0..8_000).for_each(|k| chain.push(&shaken(f64::from(k) / 8e3, 9.0)));
            chain.finish()
        };
        assert_eq!(samples(3), samples(3));
        for (a, b) in samples(3).iter().zip(&samples(4)) {
            assert!(
                a.samples != b.samples || a.name == "wheel_angle",
                "{}",
                a.name
            );
        }
    }

    #[test]
    fn noise_on_one_sensor_shifts_no_other_sensors_draws() {
        let before = Sensors::realistic();
        let mut after = before;
        after.accelerometer.acceleration_y.noise_density *= 2.0;
        after.vision.mark_noise = 0.0;
        after.encoder.wheel_angle.noise = 1e-4;
        let [before, after] = [before, after].map(|sensors| measured(&sensors, 8_000, 3.0, 9.0));
        for (a, b) in before.iter().zip(&after) {
            let changed =
                ["acceleration_y", "wheel_angle", "slip_ratio"].contains(&a.name.as_str());
            assert_eq!(a != b, changed, "{}", a.name);
        }
    }

    #[test]
    fn a_delayed_channel_lags_and_a_slow_clock_stretches() {
        let mut sensors = Sensors {
            clock_error: 1e-3,
            ..Sensors::default()
        };
        sensors.force_torque.drawbar_pull.delay = 0.0123;
        let channels = measured(&sensors, 16_000, 1.0, 40.0);
        let (force, pull) = (
            named(&channels, "normal_force"),
            named(&channels, "drawbar_pull"),
        );
        let angle = named(&channels, "wheel_angle");
        for k in 300..1700 {
            let time = 1.001 * k as f64 / 2000.0;
            let (now, then) = (shaken(time, 40.0), shaken(time - 0.0123, 40.0));
            assert!((force[k] - now.hub.normal_force).abs() < 1e-3, "{k}");
            assert!((pull[k] - then.hub.drawbar_pull).abs() < 1e-3, "{k}");
            assert!((angle[k] - now.wheel_angle).abs() < 1e-12, "{k}");
        }
    }

    #[test]
    fn raw_channels_keep_every_sample_at_the_sensor_rate() {
        let sensors = Sensors {
            raw: true,
            ..Sensors::default()
        };
        let channels = measured(&sensors, 16_000, 0.25, 100.0);
        let raw = channels
            .iter()
            .find(|c| c.name == "acceleration_y_raw")
            .unwrap();
        assert_eq!((raw.sample_rate, raw.samples.len()), (128_000.0, 32_000));
        for k in 200..31_000 {
            let wave = shaken(k as f64 / 128_000.0, 100.0).vertical_acceleration;
            assert!((raw.samples[k] - wave).abs() < 1e-4);
        }
    }

    #[test]
    fn an_output_rate_that_does_not_divide_names_the_nearest_that_do() {
        let sensors = Sensors {
            output_rate: rate(40_000),
            ..Sensors::default()
        };
        assert_eq!(
            sensors.check().unwrap_err().to_string(),
            "output rate [Hz] must divide the sensor rate 128000 Hz; use 32000 or 25600, got 40000"
        );
        let error = SensorChain::new(&Sensors::default(), &observed(9_000, 0)).err();
        assert_eq!(
            error.unwrap().to_string(),
            "physics rate [Hz] must divide the sensor rate 128000 Hz; use 8000 or 6400, got 9000"
        );
    }

    #[test]
    fn a_scenario_names_only_what_departs_from_the_ideal() {
        let text = "
            output_rate = 4_000
            [accelerometer]
            tilt_deg = 1
            acceleration_y = { noise_density = 4.9e-5, bandwidth = 10_000 }
            [force_torque.normal_force]
            range = 330";
        let mut expected = Sensors {
            output_rate: rate(4_000),
            ..Sensors::default()
        };
        expected.accelerometer.tilt_deg = 1.0;
        expected.accelerometer.acceleration_y.noise_density = 4.9e-5;
        expected.accelerometer.acceleration_y.bandwidth = 10_000.0;
        expected.force_torque.normal_force.range = 330.0;
        assert_eq!(toml::from_str::<Sensors>(text).unwrap(), expected);
        for sensors in [Sensors::default(), Sensors::realistic()] {
            let back = toml::from_str::<Sensors>(&toml::to_string(&sensors).unwrap());
            assert_eq!(back.unwrap(), sensors);
            sensors.check().unwrap();
        }
        assert!(toml::from_str::<Sensors>("[vision]\nframes = 3").is_err());
    }

    /// May change only with a change that is meant to alter samples: filters, order of the
    /// stages, streams or figures of `realistic`. Not with the machine, compiler or block length.
    #[test]
    fn bits_of_a_realistic_run_are_pinned() {
        let mut hash = Sha256::new();
        for channel in measured(&Sensors::realistic(), 16_000, 2.5, 37.0) {
            hash.update(channel.name.as_bytes());
            for sample in channel.samples {
                hash.update(sample.to_le_bytes());
            }
        }
        let found: String = hash
            .finalize()
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        assert_eq!(
            found,
            "9c2c6944cba512d88f17ad49d261e77ba8e8d6677998dcf596ef5a3a782cd89b"
        );
    }
}
