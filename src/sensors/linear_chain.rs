//! One motion measured again by other sensors, at the output rate.
//!
//! Most of what sensors do to a quantity is linear and the same at all times: they weigh quantities against one another,
//! filter, delay, amplify and add. Such stages commute with the change of rate, so that they may follow it. The quantities
//! pass the ideal chain once; a set of sensors then costs Fourier transforms at the output rate instead of 128 000 samples
//! a second of every channel:
//!
//! ```text
//! y = g F⁻¹[ H(f) e^(-2πi f τ) F[Σ w_i x_i + v] ] + b + d t + hum + F⁻¹[ A(f) F[n] ]
//! ```
//!
//! with weights `w` (tilt, cross-axis sensitivity, crosstalk), drive vibration `v`, the digital filters' own responses `H` at
//! the sensor rate (mount, bandwidth, single pole), a delay `τ`, white noise `n` of the same density and the anti-alias
//! filter's response `A`. Steps of a converter that noise dithers are noise of their variance.
//!
//! A channel with a stage of another kind passes the whole chain, bit by bit: curved gains, soft or reached ranges, dead
//! bands, held readings, steps without dither, a loose mount. All channels do where samples leak past the anti-alias
//! filter, the clock is wrong, or samples are kept at the sensor rate.
//!
//! # Error
//! Without noise a linear channel departs from the whole chain by less than 0.1 % of its standard deviation, the first and
//! last 0.1 s aside, where the two continue the quantity differently. Noise and drive vibration have the same spectra and
//! other draws.

use super::decimator::Decimator;
use super::drive_vibration::Vibrating;
use super::fast_channel::{FastChannel, Signal};
use super::noise::WhiteNoise;
use super::second_order::SecondOrder;
use super::single_pole::SinglePole;
use super::slow_channels::SlowChannels;
use super::transducer::{Reading, Transducer};
use super::{ANALOGUE, Observed, Quantities, SensorChain, Sensors, channel};
use crate::quantity::{RangeError, SampleRate};
use crate::signal::{Backward, Forward, Plans, smooth_above};
use crate::simulation::WheelState;
use crate::trace::Channel;
use realfft::num_complex::Complex;
use std::f64::consts::{PI, TAU};

/// Quantities of a motion: acceleration upward and forward, normal force, drawbar pull, driving torque, forward speed.
const QUANTITIES: usize = 6;

/// Samples behind the last that hold its value, lead back to the first one's and hold that: what filters and delays reach
/// beyond either end.
const RETURN: [usize; 3] = [256, 512, 256];

/// Samples at the output rate on either side of the anti-alias filter's impulse; its response is shorter.
const IMPULSE: usize = 128;

/// How many standard deviations of noise stay within a range.
const WITHIN: f64 = 6.0;

/// Largest magnitude between states over that at them: what an interpolation may add.
const OVERSHOOT: f64 = 1.2;

fn quantities(state: &WheelState) -> [f64; QUANTITIES] {
    let hub = &state.hub;
    [
        state.vertical_acceleration,
        state.forward_acceleration,
        hub.normal_force,
        hub.drawbar_pull,
        hub.driving_torque,
        state.forward_speed,
    ]
}

/// How a channel weighs them: `offset + Σ weights · quantities`.
struct Weighing {
    weights: [f64; QUANTITIES],
    offset: f64,
}

impl Weighing {
    fn of(&self, quantities: &[Vec<f64>; QUANTITIES]) -> Vec<f64> {
        let mut sums = vec![self.offset; quantities[0].len()];
        let weighed = self.weights.iter().zip(quantities);
        for (weight, samples) in weighed.filter(|(weight, _)| **weight != 0.0) {
            let pairs = sums.iter_mut().zip(samples);
            pairs.for_each(|(sum, sample)| *sum += weight * sample);
        }
        sums
    }

    /// No smaller than any magnitude of the sum.
    fn bound(&self, peaks: &[f64; QUANTITIES]) -> f64 {
        let products = self.weights.iter().zip(peaks);
        products.fold(self.offset.abs(), |sum, (weight, peak)| {
            sum + weight.abs() * peak
        })
    }
}

impl Sensors {
    /// How every analogue channel weighs quantities.
    fn weighings(&self) -> [Weighing; ANALOGUE.len()] {
        let [upward, forward, offset] = self.accelerometer.axis().weights();
        let weighing = |weights, offset| Weighing { weights, offset };
        let [normal, pull, torque] = self
            .force_torque
            .crosstalk
            .map(|[n, p, t]| weighing([0.0, 0.0, n, p, t, 0.0], 0.0));
        [
            weighing([upward, forward, 0.0, 0.0, 0.0, 0.0], offset),
            normal,
            pull,
            torque,
            weighing([0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 0.0),
        ]
    }

    /// Whether all channels are sampled through the anti-alias filter, at the instants stated.
    fn sample_linearly(&self) -> bool {
        let filtered = self.anti_alias && self.alias_leak == 0.0 && self.alias_mean == 0.0;
        filtered && self.clock_error == 0.0 && !self.raw
    }
}

impl Transducer {
    /// Whether its stages are linear for a quantity of at most this magnitude, sampled at `rate` [Hz].
    fn is_linear(&self, largest: f64, rate: f64) -> bool {
        let noise = self.noise_density * libm::sqrt(0.5 * rate);
        let offsets = self.bias.abs() + self.hum.abs() + self.ripple.abs();
        let reading = self.gain.abs() * largest + offsets + WITHIN * (noise + self.rumble);
        let straight = self.curvature == 0.0 && self.soft_range.is_infinite();
        let within = self.range.is_infinite() || (reading < self.range && self.drift == 0.0);
        let fine = self.resolution <= 2.0 * noise && self.truncation == 0.0;
        straight && within && fine && self.hold * rate < 1.5
    }

    /// Density [unit/√Hz] of its noise and of the steps that noise dithers, at a sensor rate [Hz].
    fn whole_noise(&self, rate: f64) -> f64 {
        let steps = self.resolution / libm::sqrt(12.0);
        libm::hypot(self.noise_density, steps / libm::sqrt(0.5 * rate))
    }

    /// What is left of it behind filters, noise and steps.
    fn behind_filters(&self) -> Self {
        Self {
            gain: self.gain,
            bias: self.bias,
            drift: self.drift,
            rumble: self.rumble,
            hum: self.hum,
            ripple: self.ripple,
            ..Self::default()
        }
    }
}

/// A motion as the ideal chain reads it, for sensors at the same rates.
pub struct LinearChain {
    /// Every quantity at the output rate.
    quantities: [Vec<f64>; QUANTITIES],
    /// No smaller than any magnitude of every quantity at the sensor rate.
    peaks: [f64; QUANTITIES],
    /// The wheel's turning at the output rate.
    turning: Vec<WheelState>,
    observed: Observed,
    sensor_rate: SampleRate,
    output_rate: SampleRate,
    /// Time [s] of the first state.
    start: f64,
    transform: Transform,
}

impl LinearChain {
    /// The motion that these states have, for sensors at the rates of `sensors`.
    ///
    /// # Errors
    /// `RangeError` where the rates do not divide.
    pub fn new(
        states: impl Iterator<Item = WheelState> + Clone,
        observed: Observed,
        sensors: &Sensors,
    ) -> Result<Self, RangeError> {
        let ideal = Sensors {
            rate: sensors.rate,
            output_rate: sensors.output_rate,
            ..Sensors::default()
        };
        let mut chains = Vec::new();
        for _ in 0..QUANTITIES {
            chains.push(neutral(&ideal, &observed)?);
        }
        let mut peaks = [0.0_f64; QUANTITIES];
        for state in states.clone() {
            let values = chains.iter_mut().zip(&mut peaks).zip(quantities(&state));
            for ((chain, peak), value) in values {
                chain.push(value);
                *peak = peak.max(OVERSHOOT * value.abs());
            }
        }
        let mut read = chains.into_iter().map(|chain| chain.finish(0.0).0.samples);
        let quantities: [Vec<f64>; QUANTITIES] =
            std::array::from_fn(|_| read.next().unwrap_or_default());
        let start = states.clone().next().map_or(0.0, |state| state.time);
        Ok(Self {
            turning: every(states, observed.physics_rate, ideal.output_rate),
            transform: Transform::new(quantities[0].len(), &ideal)?,
            quantities,
            peaks,
            observed,
            sensor_rate: ideal.rate,
            output_rate: ideal.output_rate,
            start,
        })
    }

    /// The channels that `sensors` make of the motion, whose states these are again.
    ///
    /// # Errors
    /// Those of [`SensorChain::new`].
    pub fn read<States>(
        &self,
        sensors: &Sensors,
        states: States,
    ) -> Result<Vec<Channel>, RangeError>
    where
        States: Iterator<Item = WheelState> + Clone,
    {
        let rates = [sensors.rate, sensors.output_rate];
        if !sensors.sample_linearly() || rates != [self.sensor_rate, self.output_rate] {
            let mut chain = SensorChain::new(sensors, &self.observed)?;
            states.for_each(|state| chain.push(&state));
            return Ok(chain.finish());
        }
        sensors.check()?;
        let mut channels = Vec::new();
        let weighings = sensors.weighings().into_iter().zip(sensors.transducers());
        for (place, (weighing, transducer)) in weighings.enumerate() {
            let mut largest = weighing.bound(&self.peaks);
            let mut is_held = true;
            if place == 0 {
                largest += sensors.accelerometer.drive_vibration.bound(&self.turning);
                is_held = sensors.accelerometer.loose_mount.holds(largest);
            }
            let is_linear = transducer.is_linear(largest, self.sensor_rate.hertz());
            channels.push(if is_held && is_linear {
                self.linear(sensors, place, &weighing)
            } else {
                self.whole(sensors, place, states.clone())?
            });
        }
        let mut slow = SlowChannels::new(sensors, &self.observed);
        for (step, state) in (0..).zip(states) {
            slow.push(step, &state);
        }
        channels.extend(slow.finish(self.start, self.turning.len()));
        Ok(channels)
    }

    /// One channel by the whole chain.
    fn whole(
        &self,
        sensors: &Sensors,
        place: usize,
        states: impl Iterator<Item = WheelState>,
    ) -> Result<Channel, RangeError> {
        let rate = self.observed.physics_rate.hertz();
        let mut quantities = Quantities::new(sensors, &self.observed, rate);
        let mut chain = sensors.analogue_channel(place, &self.observed)?;
        states.for_each(|state| chain.push(quantities.of(&state)[place]));
        Ok(chain.finish(self.start).0)
    }

    /// One channel whose stages are linear.
    fn linear(&self, sensors: &Sensors, place: usize, weighing: &Weighing) -> Channel {
        let (name, unit) = ANALOGUE[place];
        let transducer = sensors.transducers()[place];
        let (rate, output_rate) = (self.sensor_rate.hertz(), self.output_rate.hertz());
        let draws = |stage: &str| self.observed.seed.rng(stage, self.observed.run);
        let mut samples = weighing.of(&self.quantities);
        let mut filters = Filters::of(&transducer, rate);
        if place == 0 {
            let vibration = sensors.accelerometer.drive_vibration;
            let rng = draws("sensors.drive_vibration");
            if let Some(mut drive) = Vibrating::new(vibration, output_rate, rng) {
                let pairs = samples.iter_mut().zip(&self.turning);
                pairs.for_each(|(sample, state)| *sample += drive.acceleration(state));
            }
            filters.mount = sensors.accelerometer.mount(rate);
        }
        if !filters.are_none() {
            samples = self
                .transform
                .filtered(&samples, |bin| filters.response(bin));
        }
        let rng = draws(&format!("sensors.{name}"));
        let mut reading = Reading::new(transducer.behind_filters(), output_rate, rng.clone());
        reading.read(&mut samples);
        let density = transducer.whole_noise(rate);
        if let Some(mut noise) = WhiteNoise::of_density(density, output_rate, rng) {
            let white: Vec<f64> = samples.iter().map(|_| noise.draw()).collect();
            let seen = self.transform.anti_aliased(&white);
            let pairs = samples.iter_mut().zip(seen);
            pairs.for_each(|(sample, noise)| *sample += noise);
        }
        channel(name, unit, output_rate, self.start, samples)
    }
}

/// A channel without errors.
fn neutral(ideal: &Sensors, observed: &Observed) -> Result<FastChannel, RangeError> {
    let signal = Signal {
        name: "",
        unit: "",
        transducer: Transducer::default(),
    };
    FastChannel::new(
        ideal,
        observed.physics_rate,
        signal,
        observed.seed.rng("", 0),
    )
}

/// The states at the instants of the output, or last before them.
fn every(
    states: impl Iterator<Item = WheelState>,
    physics_rate: SampleRate,
    output_rate: SampleRate,
) -> Vec<WheelState> {
    let ratio = physics_rate.hertz() / output_rate.hertz();
    let mut next = 0.0;
    let due = (0_u64..).zip(states).filter(|(step, _)| {
        let due = *step as f64 >= next;
        if due {
            next += ratio;
        }
        due
    });
    due.map(|(_, state)| state).collect()
}

/// Filters of a channel, and its delay.
struct Filters {
    mount: Option<SecondOrder>,
    low_pass: Option<SecondOrder>,
    single_pole: Option<SinglePole>,
    /// Delay [s].
    delay: f64,
}

impl Filters {
    fn of(transducer: &Transducer, rate: f64) -> Self {
        Self {
            mount: None,
            low_pass: transducer.low_pass(rate),
            single_pole: SinglePole::new(transducer.single_pole, rate),
            delay: transducer.delay,
        }
    }

    fn are_none(&self) -> bool {
        let passes = self.low_pass.is_none() && self.single_pole.is_none();
        passes && self.mount.is_none() && self.delay == 0.0
    }

    /// Their response at a frequency.
    fn response(&self, bin: &Bin) -> Complex<f64> {
        let mut response = Complex::new(1.0, 0.0);
        for filter in [&self.mount, &self.low_pass].into_iter().flatten() {
            response *= filter.response(bin.step_back);
        }
        if let Some(filter) = &self.single_pole {
            response *= filter.response(bin.step_back);
        }
        if self.delay != 0.0 {
            response *= turned(-TAU * bin.frequency * self.delay);
        }
        response
    }
}

fn turned(angle: f64) -> Complex<f64> {
    let (sine, cosine) = libm::sincos(angle);
    Complex::new(cosine, sine)
}

/// A frequency of the transform.
struct Bin {
    /// In Hz.
    frequency: f64,
    /// A step of the sensor rate back in time, `z⁻¹`.
    step_back: Complex<f64>,
    /// Response of the anti-alias filter [-].
    anti_alias: f64,
}

/// Fourier transform of channels that lead from their last value back to their first.
struct Transform {
    /// Samples of a transform.
    size: usize,
    forward: Forward,
    backward: Backward,
    bins: Vec<Bin>,
}

impl Transform {
    /// For channels of `count` samples.
    fn new(count: usize, sensors: &Sensors) -> Result<Self, RangeError> {
        let size = smooth_above(count + RETURN.iter().sum::<usize>());
        let mut plans = Plans::default();
        let (forward, backward) = (plans.forward(size), plans.backward(size));
        let mut impulse = anti_alias_impulse(sensors)?;
        impulse.resize(size, 0.0);
        impulse.rotate_left(IMPULSE);
        let spectrum = forward.apply(impulse);
        let (rate, output_rate) = (sensors.rate.hertz(), sensors.output_rate.hertz());
        let bins = spectrum.iter().enumerate().map(|(k, response)| {
            let frequency = output_rate * k as f64 / size as f64;
            Bin {
                frequency,
                step_back: turned(-TAU * frequency / rate),
                anti_alias: response.re,
            }
        });
        Ok(Self {
            bins: bins.collect(),
            size,
            forward,
            backward,
        })
    }

    /// Samples behind a filter that has this response; it is settled at the first.
    fn filtered(&self, samples: &[f64], response: impl Fn(&Bin) -> Complex<f64>) -> Vec<f64> {
        let mut spectrum = self.forward.apply(looped(samples, self.size));
        let parts = spectrum.iter_mut().zip(&self.bins);
        parts.for_each(|(part, bin)| *part *= response(bin));
        self.samples(spectrum, samples.len())
    }

    /// White noise after the anti-alias filter.
    fn anti_aliased(&self, noise: &[f64]) -> Vec<f64> {
        let mut padded = noise.to_vec();
        padded.resize(self.size, 0.0);
        let mut spectrum = self.forward.apply(padded);
        let parts = spectrum.iter_mut().zip(&self.bins);
        parts.for_each(|(part, bin)| *part *= bin.anti_alias);
        self.samples(spectrum, noise.len())
    }

    fn samples(&self, spectrum: Vec<Complex<f64>>, count: usize) -> Vec<f64> {
        let mut samples = self.backward.apply(spectrum);
        samples.truncate(count);
        samples.iter_mut().for_each(|x| *x /= self.size as f64);
        samples
    }
}

/// Samples, then their last value, a half cosine to their first and that.
fn looped(samples: &[f64], size: usize) -> Vec<f64> {
    let [hold, lead, _] = RETURN;
    let (first, last) = (samples[0], samples[samples.len() - 1]);
    let mut looped = samples.to_vec();
    looped.resize(samples.len() + hold, last);
    looped.extend((0..lead).map(|k| {
        let back = 0.5 - 0.5 * libm::cos(PI * k as f64 / lead as f64);
        last + (first - last) * back
    }));
    looped.resize(size, first);
    looped
}

/// The anti-alias filter's answer, at the output rate, to an impulse of unit area at sample [`IMPULSE`].
fn anti_alias_impulse(sensors: &Sensors) -> Result<Vec<f64>, RangeError> {
    let factor = sensors.decimation()?;
    let mut impulse = vec![0.0; 2 * IMPULSE * factor as usize];
    impulse[IMPULSE * factor as usize] = f64::from(factor);
    let mut decimator = Decimator::new(sensors.rate, sensors.output_rate)?;
    let mut answer = Vec::new();
    decimator.push(&impulse, &mut answer);
    decimator.finish(&mut answer);
    Ok(answer)
}
