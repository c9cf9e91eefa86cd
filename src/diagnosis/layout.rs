//! Which channels and means a measured run has, and a simulated run cut to them.
//!
//! A statistic depends on rate and length of its record, so both sides have to have the same. What
//! is sampled more slowly than the simulation keeps it passes a low pass; counters and cameras are
//! latched instead, as they are on a rig.

use crate::signal::{band_limited, linear, nearest};
use crate::trace::{Channel, Mean, Trace, unit_of};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use std::fmt;

/// Channels that a sensor latches at its instants, without a filter.
const LATCHED: [&str; 3] = ["wheel_angle", "sinkage", "slip_ratio"];

/// Step [s] of the lengths that are compared, and the length from which on it is taken. A rig's clock
/// gives a sample more or less; simulations of the one length serve the other too.
const STEP: (f64, f64) = (0.5, 2.0);

/// Uncertainty [-] of a slip, and part of any other mean, where it is not stated.
const USUAL: f64 = 0.01;

/// Part of a sample [-] within which instants are the same.
const SAME: f64 = 1.0e-6;

/// A time series to be had.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    /// Name of the channel.
    pub name: String,
    /// Samples per second [Hz].
    pub rate: f64,
    /// Time [s] of its first sample after the first of the run.
    offset: f64,
    /// Number of samples.
    count: usize,
}

/// A steady mean to be had.
#[derive(Debug, Clone, PartialEq)]
struct Averaged {
    name: String,
    /// Whether its standard deviation is known.
    has_sd: bool,
    /// Number of samples behind it.
    n: u64,
    /// Its standard uncertainty, in its unit: of so many samples, or of one where they were not
    /// counted; what is usual where it is not stated.
    error: f64,
}

/// What a run has of the channels that a simulation makes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// Time series by name.
    pub series: Vec<Series>,
    means: Vec<Averaged>,
}

/// Uncertainty of a mean that states none, in its unit. No simulation misses its slip, and without
/// any uncertainty a thousandth would be a gap.
fn usual_uncertainty(mean: &Mean) -> f64 {
    match &*mean.name {
        "slip_ratio" => USUAL,
        _ => USUAL * mean.value.abs(),
    }
}

impl Layout {
    /// The layout of a measured run, of its first `longest` [s].
    pub fn of(trace: &Trace, longest: f64) -> Self {
        let usable = |channel: &&Channel| {
            let sampled = channel.sample_rate > 0.0 && channel.sample_rate.is_finite();
            let placed = sampled && channel.start.is_finite() && !channel.samples.is_empty();
            placed && unit_of(&channel.name).is_some()
        };
        let channels: Vec<&Channel> = trace.channels.iter().filter(usable).collect();
        let start = start(&channels);
        let series = channels.into_iter().map(|channel| {
            let offset = channel.start - start;
            let most = ((longest - offset) * channel.sample_rate + SAME).max(0.0) as usize;
            Series {
                name: channel.name.clone(),
                rate: channel.sample_rate,
                offset,
                count: channel.samples.len().min(most),
            }
        });
        let mut series: Vec<Series> = series.filter(|series| series.count > 0).collect();
        series.sort_by(|a, b| a.name.cmp(&b.name));
        round_down(&mut series);
        let known = trace.means.iter().filter(|mean| {
            let is_known = unit_of(&mean.name).is_some();
            is_known && mean.value.is_finite()
        });
        let mut means: Vec<Averaged> = known
            .map(|mean| Averaged {
                name: mean.name.clone(),
                has_sd: mean.sd.is_finite(),
                n: mean.n,
                error: if mean.sd > 0.0 && mean.sd.is_finite() {
                    mean.sd / libm::sqrt(mean.n.max(1) as f64)
                } else {
                    usual_uncertainty(mean)
                },
            })
            .collect();
        means.sort_by(|a, b| a.name.cmp(&b.name));
        Self { series, means }
    }

    /// Whether there is nothing to compare.
    pub fn is_empty(&self) -> bool {
        self.series.is_empty() && self.means.is_empty()
    }

    /// Whether a channel of this name is there, as a series or as a mean.
    pub fn has(&self, name: &str) -> bool {
        let mut means = self.means.iter();
        self.series.iter().any(|series| series.name == name) || means.any(|mean| mean.name == name)
    }

    /// What has to be alike in repeats: names and rates.
    pub fn kind(&self) -> String {
        let series = self.series.iter();
        let series = series.map(|series| format!("{} at {:?} Hz", series.name, series.rate));
        let means = self.means.iter().map(|mean| format!("mean {}", mean.name));
        series.chain(means).collect::<Vec<_>>().join(", ")
    }

    /// Length [s] of the longest series; 0 where there are means only.
    pub fn duration(&self) -> f64 {
        let ends = self
            .series
            .iter()
            .map(|series| series.offset + series.count as f64 / series.rate);
        ends.fold(0.0, f64::max)
    }

    /// No longer than another of the same kind, and known no better.
    pub fn shorten(&mut self, other: &Self) {
        for (mine, its) in self.series.iter_mut().zip(&other.series) {
            mine.count = mine.count.min(its.count);
        }
        for (mine, its) in self.means.iter_mut().zip(&other.means) {
            mine.error = mine.error.max(its.error);
        }
    }

    /// Makes means as uncertain as those measured.
    pub fn blur(&self, imitated: &mut Trace, rng: &mut impl Rng) {
        for averaged in &self.means {
            let error: f64 = StandardNormal.sample(rng);
            let of = imitated.means.iter_mut();
            for mean in of.filter(|mean| mean.name == averaged.name) {
                mean.value += averaged.error * error;
            }
        }
    }

    /// The channels and means of a measured run of this kind, as long as they shall be.
    pub fn cut(&self, measured: &Trace) -> Trace {
        let channels = self.series.iter().filter_map(|series| {
            let channel = measured.channel(&series.name)?;
            let count = series.count.min(channel.samples.len());
            Some(Channel {
                samples: channel.samples[..count].to_vec(),
                ..channel.clone()
            })
        });
        let is_kept = |mean: &&Mean| self.means.iter().any(|kept| kept.name == mean.name);
        Trace {
            attributes: measured.attributes.clone(),
            channels: channels.collect(),
            means: measured.means.iter().filter(is_kept).cloned().collect(),
            truth: None,
        }
    }

    /// A simulated run as one of this kind: its channels sampled and averaged as they are there.
    pub fn imitate(&self, simulated: &Trace) -> Trace {
        let start = start(&simulated.channels.iter().collect::<Vec<_>>());
        let channels = self.series.iter().filter_map(|series| {
            let channel = simulated.channel(&series.name)?;
            (!channel.samples.is_empty()).then(|| series.sampled(channel, start))
        });
        let means = self.means.iter().filter_map(|mean| mean.over(simulated));
        Trace {
            attributes: simulated.attributes.clone(),
            channels: channels.collect(),
            means: means.collect(),
            truth: None,
        }
    }
}

/// Cuts all to a whole number of steps.
fn round_down(series: &mut [Series]) {
    let lengths = series
        .iter()
        .map(|series| series.count as f64 / series.rate);
    let shortest = lengths.fold(f64::INFINITY, f64::min);
    if shortest < STEP.1 {
        return;
    }
    let whole = STEP.0 * libm::floor(shortest / STEP.0 + SAME);
    for Series { rate, count, .. } in series {
        *count = (*count).min((whole * *rate + SAME) as usize);
    }
}

/// Time [s] of the first sample of all.
fn start(channels: &[&Channel]) -> f64 {
    let starts = channels.iter().map(|channel| channel.start);
    starts.reduce(f64::min).unwrap_or(0.0)
}

/// One line a channel or mean.
impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Series {
            name,
            rate,
            offset,
            count,
        } in &self.series
        {
            writeln!(f, "channel {name} {rate:?} {offset:?} {count}")?;
        }
        for Averaged {
            name,
            has_sd,
            n,
            error,
        } in &self.means
        {
            writeln!(f, "mean {name} {has_sd} {n} {error:?}")?;
        }
        Ok(())
    }
}

impl Averaged {
    fn over(&self, simulated: &Trace) -> Option<Mean> {
        let channel = simulated.channel(&self.name)?;
        let value = channel.steady_mean()?;
        let steady = channel.steady();
        let squares = steady.iter().map(|x| (x - value) * (x - value));
        let sd = libm::sqrt(squares.sum::<f64>() / steady.len() as f64);
        Some(Mean {
            name: self.name.clone(),
            unit: channel.unit.clone(),
            value,
            sd: if self.has_sd { sd } else { f64::NAN },
            n: self.n,
        })
    }
}

impl Series {
    /// The channel of a run that starts at `start` [s], sampled at this rate.
    fn sampled(&self, channel: &Channel, start: f64) -> Channel {
        let first = start + self.offset;
        let ratio = channel.sample_rate / self.rate;
        let begin = (first - channel.start) * channel.sample_rate;
        let place = |k: usize| begin + k as f64 * ratio;
        let is_latched = LATCHED.contains(&self.name.as_str());
        let samples = &channel.samples[..];
        let read = |place: f64| match place - libm::round(place) {
            // Where every instant is a sample's, or its rate is its own, nothing is filtered.
            off if off.abs() < SAME && (ratio <= 1.0 || is_latched) => nearest(samples, place),
            _ if is_latched => linear(samples, place),
            _ => band_limited(samples, place, ratio),
        };
        Channel {
            name: self.name.clone(),
            unit: channel.unit.clone(),
            sample_rate: self.rate,
            start: first,
            samples: (0..self.count).map(|k| read(place(k))).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use std::f64::consts::TAU;

    fn channel(name: &str, rate: f64, start: f64, value: impl Fn(f64) -> f64) -> Channel {
        Channel {
            name: name.to_owned(),
            unit: unit_of(name).unwrap_or("").to_owned(),
            sample_rate: rate,
            start,
            samples: (0..(4.0 * rate) as usize)
                .map(|k| value(start + k as f64 / rate))
                .collect(),
        }
    }

    fn run(channels: Vec<Channel>) -> Trace {
        Trace {
            channels,
            ..Trace::default()
        }
    }

    fn tone(hertz: f64) -> impl Fn(f64) -> f64 {
        move |time| libm::sin(TAU * hertz * time)
    }

    fn resampled(name: &str, rate: f64, value: impl Fn(f64) -> f64) -> Vec<f64> {
        let layout = Layout::of(&run(vec![channel(name, rate, 0.0, |_| 0.0)]), 4.0);
        let simulated = run(vec![channel(name, 2000.0, 0.0, value)]);
        layout.imitate(&simulated).channels.swap_remove(0).samples
    }

    #[test]
    fn a_run_with_the_same_rates_keeps_every_bit() {
        let value = |time: f64| libm::exp(libm::sin(9.0 * time));
        for name in ["normal_force", "wheel_angle"] {
            let simulated = channel(name, 2000.0, 0.0, value);
            assert_eq!(resampled(name, 2000.0, value), simulated.samples);
        }
    }

    #[test]
    fn at_a_slower_rate_what_it_can_hold_passes_and_what_it_cannot_does_not() {
        for rate in [1000.0, 333.3, 47.0] {
            let passed = resampled("drawbar_pull", rate, tone(0.4 * rate));
            for (k, found) in passed.iter().enumerate().skip(40).take(60) {
                let expected = tone(0.4 * rate)(k as f64 / rate);
                assert!((found - expected).abs() < 0.012, "{rate} Hz, {k}: {found}");
            }
            let stopped = resampled("drawbar_pull", rate, tone(0.6 * rate));
            let loudest = stopped[40..100].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(loudest < 0.012, "{rate} Hz: {loudest}");
        }
    }

    #[test]
    fn a_counter_is_latched_and_keeps_its_ramp_to_the_ends() {
        let angles = resampled("wheel_angle", 333.3, |time| 3.0 - 0.1 * time);
        for (k, angle) in angles.iter().enumerate() {
            let expected = 3.0 - 0.1 * k as f64 / 333.3;
            assert!((angle - expected).abs() < 1e-12, "{k}: {angle}");
        }
    }

    #[test]
    fn channels_that_start_later_do_so_in_the_simulation() {
        let measured = run(vec![
            channel("normal_force", 500.0, 7.0, |_| 0.0),
            channel("sinkage", 10.0, 7.25, |_| 0.0),
        ]);
        let simulated = run(vec![
            channel("normal_force", 2000.0, 1.0, |time| time),
            channel("sinkage", 10.0, 1.0, |time| time),
        ]);
        let layout = Layout::of(&measured, 2.0);
        let found = layout.imitate(&simulated);
        let sinkage = found.channel("sinkage").unwrap();
        // Halfway between two frames 0.2 and 0.3 s after the start at 1 s.
        assert_eq!(sinkage.start, 1.25);
        assert!((sinkage.samples[0] - 1.25).abs() < 1e-12);
        // Of the first two seconds of the run.
        let counts: Vec<usize> = found.channels.iter().map(|c| c.samples.len()).collect();
        assert_eq!(counts, [1000, 17]);
        assert_eq!(layout.cut(&measured).channels[1].samples.len(), 17);
    }

    #[test]
    fn a_sample_more_or_less_makes_no_other_layout() {
        let long = |extra: usize| {
            let mut fast = channel("normal_force", 2000.0, 0.0, |time| time);
            let mut slow = channel("sinkage", 10.0, 0.0, |time| time);
            fast.samples.resize(20_000 + 37 * extra, 0.0);
            slow.samples.resize(100 + extra, 0.0);
            Layout::of(&run(vec![fast, slow]), 20.0)
        };
        assert_eq!(long(0), long(1));
        assert_eq!(long(0).to_string(), long(2).to_string());
        assert_eq!(long(0).duration(), 10.0);
    }

    #[test]
    fn a_mean_that_was_read_to_half_a_millimetre_is_simulated_no_surer() {
        let mut measured = run(Vec::new());
        measured.means.push(Mean {
            name: "sinkage".to_owned(),
            unit: "m".to_owned(),
            value: 0.01,
            sd: 0.001,
            n: 4,
        });
        let layout = Layout::of(&measured, 9.0);
        let exact = layout.imitate(&run(vec![channel("sinkage", 10.0, 0.0, |_| 0.012)]));
        let mut rng = Seed(1).rng("reading", 0);
        let square = |_| {
            let mut blurred = exact.clone();
            layout.blur(&mut blurred, &mut rng);
            let off = blurred.means[0].value - 0.012;
            off * off
        };
        let rms = libm::sqrt((0..400).map(square).sum::<f64>() / 400.0);
        // Of 400 draws the root mean square is known to 3.5 %.
        assert!((rms - 0.0005).abs() < 0.00006, "{rms}");
    }

    #[test]
    fn a_mean_is_that_of_the_middle_half_and_as_sure_as_the_measured_one() {
        let mut measured = run(Vec::new());
        measured.means.push(Mean {
            name: "sinkage".to_owned(),
            unit: "m".to_owned(),
            value: 0.01,
            sd: f64::NAN,
            n: 0,
        });
        let ramp = channel("sinkage", 10.0, 0.0, |time| time);
        let found = Layout::of(&measured, 9.0).imitate(&run(vec![ramp]));
        assert!(found.channels.is_empty());
        assert!((found.means[0].value - 1.95).abs() < 1e-12);
        assert!(found.means[0].sd.is_nan() && found.means[0].n == 0);
    }
}
