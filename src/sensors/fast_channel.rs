//! One analogue channel from the physics rate to the output rate.

use super::Sensors;
use super::accelerometer::Accelerometer;
use super::decimator::{Decimator, whole_ratio};
use super::interpolator::Interpolator;
use super::loose_mount::Clatter;
use super::sampling::Resampler;
use super::second_order::SecondOrder;
use super::transducer::{Reading, Transducer};
use crate::quantity::{RangeError, SampleRate};
use crate::trace::Channel;
use rand_chacha::ChaCha8Rng;

/// Samples at the sensor rate that are worked on at once: they fit a processor's first cache.
const BLOCK: u32 = 1024;

/// What a fast channel carries, and the figures of its transducer.
pub(super) struct Signal {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) transducer: Transducer,
}

/// What a sensor stands on: a mount that may resonate and may be loose; the default is rigid.
#[derive(Default)]
pub(super) struct Mount {
    resonance: Option<SecondOrder>,
    clatter: Option<Clatter>,
}

impl Mount {
    /// The mount of an accelerometer that is sampled at `rate` [Hz].
    pub(super) fn of(accelerometer: &Accelerometer, rate: f64) -> Self {
        Self {
            resonance: accelerometer.mount(rate),
            clatter: Clatter::new(accelerometer.loose_mount, rate),
        }
    }

    fn apply(&mut self, values: &mut [f64]) {
        if let Some(clatter) = &mut self.clatter {
            clatter.apply(values);
        }
        if let Some(resonance) = &mut self.resonance {
            resonance.apply(values);
        }
    }
}

/// A channel at work: values at the physics rate in, samples at the output rate kept.
pub(super) struct FastChannel {
    signal: Signal,
    rates: Rates,
    /// Values that wait for their block to fill.
    waiting: Vec<f64>,
    /// How many fill it.
    block: usize,
    interpolator: Interpolator,
    resampler: Option<Resampler>,
    sampler: Sampler,
}

#[derive(Clone, Copy)]
struct Rates {
    sensor: f64,
    output: f64,
}

impl FastChannel {
    /// # Errors
    /// `RangeError` where the rates of physics, sensor and output do not divide each other.
    pub(super) fn new(
        sensors: &Sensors,
        physics_rate: SampleRate,
        signal: Signal,
        rng: ChaCha8Rng,
    ) -> Result<Self, RangeError> {
        let factor = whole_ratio("physics rate", physics_rate, "sensor rate", sensors.rate)?;
        let rates = Rates {
            sensor: sensors.rate.hertz(),
            output: sensors.output_rate.hertz(),
        };
        let block = (BLOCK / factor).max(1) as usize;
        let delay = signal.transducer.delay * rates.sensor;
        Ok(Self {
            waiting: Vec::with_capacity(block),
            block,
            interpolator: Interpolator::new(factor),
            resampler: Resampler::new(delay, 1.0 + sensors.clock_error),
            sampler: Sampler::new(sensors, signal.transducer, rng)?,
            signal,
            rates,
        })
    }

    /// Puts the sensor on a mount.
    pub(super) fn stand_on(&mut self, mount: Mount) {
        self.sampler.mount = mount;
    }

    /// Takes the value of the next state.
    #[inline]
    pub(super) fn push(&mut self, value: f64) {
        self.waiting.push(value);
        if self.waiting.len() == self.block {
            self.work();
        }
    }

    fn work(&mut self) {
        let mut fast = std::mem::take(&mut self.sampler.spare);
        fast.clear();
        self.interpolator.push(&self.waiting, &mut fast);
        self.waiting.clear();
        if let Some(resampler) = &mut self.resampler {
            let mut shifted = Vec::with_capacity(fast.len());
            resampler.push(&fast, &mut shifted);
            fast = shifted;
        }
        self.sampler.sample(&mut fast);
        self.sampler.spare = fast;
    }

    /// The samples at the output rate, and those at the sensor rate if they were to be kept.
    /// `start` is the time [s] of the first value.
    pub(super) fn finish(mut self, start: f64) -> (Channel, Option<Channel>) {
        self.work();
        let mut rest = Vec::new();
        self.interpolator.finish(&mut rest);
        if let Some(mut resampler) = self.resampler {
            let mut shifted = Vec::new();
            resampler.push(&rest, &mut shifted);
            resampler.finish(&mut shifted);
            rest = shifted;
        }
        self.sampler.sample(&mut rest);
        let (kept, raw) = self.sampler.finish();
        let Signal { name, unit, .. } = self.signal;
        let channel = |name: String, sample_rate, samples| Channel {
            name,
            unit: unit.to_owned(),
            sample_rate,
            start,
            samples,
        };
        (
            channel(name.to_owned(), self.rates.output, kept),
            raw.map(|raw| channel(format!("{name}_raw"), self.rates.sensor, raw)),
        )
    }
}

/// A way past the anti-alias filter.
struct Leak {
    /// Share [-] of the samples that takes it.
    share: f64,
    decimator: Decimator,
    kept: Vec<f64>,
}

impl Leak {
    fn blend(mut self, filtered: &mut [f64]) {
        self.decimator.finish(&mut self.kept);
        for (sample, leaked) in filtered.iter_mut().zip(self.kept) {
            *sample += self.share * (leaked - *sample);
        }
    }
}

/// The part of a channel that runs at the sensor rate.
struct Sampler {
    mount: Mount,
    reading: Reading,
    decimator: Decimator,
    kept: Vec<f64>,
    leaks: Vec<Leak>,
    raw: Option<Vec<f64>>,
    /// Room for a block, reused.
    spare: Vec<f64>,
}

impl Sampler {
    fn new(sensors: &Sensors, transducer: Transducer, rng: ChaCha8Rng) -> Result<Self, RangeError> {
        let factor = sensors.decimation()?;
        Ok(Self {
            mount: Mount::default(),
            reading: Reading::new(transducer, sensors.rate.hertz(), rng),
            decimator: if sensors.anti_alias {
                Decimator::new(sensors.rate, sensors.output_rate)?
            } else {
                Decimator::without_filter(factor)
            },
            kept: Vec::new(),
            leaks: [
                (sensors.alias_leak, Decimator::without_filter(factor)),
                (sensors.alias_mean, Decimator::by_mean(factor)),
            ]
            .into_iter()
            .filter(|(share, _)| *share > 0.0)
            .map(|(share, decimator)| Leak {
                share,
                decimator,
                kept: Vec::new(),
            })
            .collect(),
            raw: sensors.raw.then(Vec::new),
            spare: Vec::new(),
        })
    }

    fn sample(&mut self, values: &mut [f64]) {
        self.mount.apply(values);
        self.reading.read(values);
        if let Some(raw) = &mut self.raw {
            raw.extend_from_slice(values);
        }
        self.decimator.push(values, &mut self.kept);
        for leak in &mut self.leaks {
            leak.decimator.push(values, &mut leak.kept);
        }
    }

    fn finish(mut self) -> (Vec<f64>, Option<Vec<f64>>) {
        self.decimator.finish(&mut self.kept);
        for leak in self.leaks {
            leak.blend(&mut self.kept);
        }
        (self.kept, self.raw)
    }
}
