//! Vibration of motor and gear, estimated from runs with a lifted wheel.
//!
//! A lifted wheel is excited by its drive only, with the sensor's noise added. Runs at different wheel speeds
//! separate the two: with the law of [`crate::sensors::drive_vibration`], the variance between 2 and 100 Hz
//! is
//!
//! ```text
//! v(ω) = v_n + p b² (ω/ω_0)⁴,   p = (2/π) (arctan(f_2/f_c) - arctan(f_1/f_c))
//! ```
//!
//! with the noise `v_n`, the root mean square `b` of the broadband part at `ω_0`, and `p` the share of
//! low-passed white noise between `f_1` and `f_2`. At one speed `b` includes the noise and is an upper bound.
//!
//! The line of the gear mesh is the largest line of the spectrum, if it exceeds the level that noise reaches
//! once in a thousand records, at one order of the wheel in all runs.

use super::doubts::Doubts;
use super::subject::Subject;
use super::{Finding, Severity, number};
use crate::sensors::drive_vibration::{CORNER, STATED_AT};
use crate::signal::{Plans, hann_powers};
use crate::statistics::upper_median;
use crate::trace::Trace;
use std::f64::consts::{FRAC_2_PI, LN_2, TAU};

/// Band [Hz] in which the vibration is measured: above drift and below the broadband part's corner.
const BAND: [f64; 2] = [2.0, CORNER];

/// Lines of the spectrum in the band without which it is not measured.
const FEWEST_LINES: usize = 50;

/// Lines on either side of a peak that a Hann window gives to it.
const LEAKAGE: usize = 2;

/// Probability that noise alone makes a line in a record.
const FALSE_LINE: f64 = 1.0e-3;

/// Variance of a sum of periodogram lines under a Hann window, over that of as many independent ones:
/// `1 + 2 (4/9 + 1/36)`.
const HANN_CORRELATION: f64 = 1.944;

/// Ratio of the fastest to the slowest wheel speed from which on noise and vibration part.
const SPREAD: f64 = 1.3;

/// Reduced chi square above which the variances do not follow the law.
const MISFIT: f64 = 4.0;

/// Lifted runs of a file, as they are read.
#[derive(Debug, Default)]
pub struct LiftedRuns {
    runs: Vec<Lifted>,
}

/// Vibration of one run between the ends of [`BAND`].
#[derive(Debug)]
struct Lifted {
    run: String,
    simulated: bool,
    /// Wheel speed [rad/s].
    wheel_speed: f64,
    /// Variance [m²/s⁴] of what is no line, over the share `p` of the band.
    variance: f64,
    /// Its relative standard error [-].
    relative_error: f64,
    line: Option<Line>,
}

/// A line of the spectrum.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// Periods a turn of the wheel [-], and the distance of the spectrum's lines in it.
    order: f64,
    resolution: f64,
    /// Root mean square [m/s²].
    rms: f64,
}

/// What the runs have in common.
#[derive(Debug, Clone, Copy)]
struct Size {
    /// Root mean square of the broadband part at [`STATED_AT`] and its standard error [m/s²].
    broadband: f64,
    broadband_error: f64,
    /// Root mean square [m/s²] of noise of the same spectrum that does not grow with speed; `None` where it is in the
    /// broadband part.
    noise: Option<f64>,
    /// Reduced chi square of the law; `None` with as many parameters as runs.
    misfit: Option<f64>,
}

impl LiftedRuns {
    /// Adds a run if its wheel is lifted, turns, and its acceleration is there.
    pub fn add(&mut self, run: &str, trace: &Trace) {
        if trace.attributes.is_lifted() {
            self.runs.extend(Lifted::of(run, trace));
        }
    }

    /// How much the drive vibrates, in the keys of a scenario.
    pub fn findings(&self) -> Vec<Finding> {
        let Some(first) = self.runs.first() else {
            return Vec::new();
        };
        let mut doubts = Doubts::of(&first.run);
        let size = Size::of(&self.runs);
        let line = self.common_line();
        let measured = self.runs.iter().any(|run| !run.simulated);
        let guess = if measured {
            set(&size, line)
        } else {
            String::new()
        };
        doubts.channel(
            "acceleration_y",
            Severity::Info,
            &self.seen(&size, line),
            &guess,
        );
        doubts.into_findings()
    }

    /// The mean line of all runs where all have it at one order.
    fn common_line(&self) -> Option<Line> {
        let lines: Option<Vec<Line>> = self.runs.iter().map(|run| run.line).collect();
        let lines = lines?;
        let count = lines.len() as f64;
        let order = lines.iter().map(|line| line.order).sum::<f64>() / count;
        let agree = |line: &Line| (line.order - order).abs() <= 1.5 * line.resolution;
        let stated = self.runs.iter().zip(&lines);
        let rms = stated
            .map(|(run, line)| line.rms / run.growth())
            .sum::<f64>()
            / count;
        lines.iter().all(agree).then_some(Line {
            order,
            rms,
            ..lines[0]
        })
    }

    /// The vibration in words.
    fn seen(&self, size: &Size, line: Option<Line>) -> String {
        let [slow, fast] = range(&self.runs).map(number);
        let runs = match self.runs.len() {
            1 => format!("lifted wheel at {slow} rad/s"),
            count => format!("lifted wheel in {count} runs at {slow} to {fast} rad/s"),
        };
        let millimetres = |x: f64| number(1.0e3 * x);
        let mut seen = format!(
            "{runs}: vibration of the drive at {STATED_AT} rad/s is {} +- {} mm/s^2 rms broadband",
            millimetres(size.broadband),
            millimetres(size.broadband_error)
        );
        seen += match size.noise {
            Some(_) => " without the sensor's noise",
            None => " with the sensor's noise in it (runs at two speeds part them)",
        };
        match line {
            Some(Line { order, rms, .. }) => {
                let (order, rms) = (number(order), millimetres(rms));
                seen += &format!(", and a line of order {order} with {rms} mm/s^2");
            }
            None => seen += ", and no line of one order",
        }
        if size.misfit.is_some_and(|misfit| misfit > MISFIT) {
            seen += "; it does not grow with the square of wheel speed, so the figure holds for these speeds only";
        }
        seen
    }
}

/// The keys that simulate a vibration.
fn set(size: &Size, line: Option<Line>) -> String {
    const KEY: &str = "sensors.accelerometer.drive_vibration";
    let mut keys = format!(
        "simulate it with --set {KEY}.broadband={}",
        number(size.broadband)
    );
    if let Some(Line { order, rms, .. }) = line {
        let (rms, order) = (number(rms), number(order));
        keys += &format!(" --set {KEY}.mesh={rms} --set {KEY}.mesh_order={order}");
    }
    keys
}

impl Lifted {
    fn of(run: &str, trace: &Trace) -> Option<Self> {
        let subject = Subject::of(trace);
        let wheel_speed = subject.wheel_speed().or(subject.expected_wheel_speed())?;
        let wheel_speed = wheel_speed.abs();
        let acceleration = trace.channel("acceleration_y")?;
        let samples = acceleration.steady();
        let is_whole = samples.iter().all(|sample| sample.is_finite());
        if subject.is_rest() || wheel_speed == 0.0 || samples.is_empty() || !is_whole {
            return None;
        }
        let transform = Plans::default().forward(samples.len());
        let powers = hann_powers(&transform, samples);
        let spacing = acceleration.sample_rate / samples.len() as f64;
        let top = BAND[1].min(0.4 * acceleration.sample_rate);
        let lines = (BAND[0] / spacing).ceil() as usize..(top / spacing) as usize;
        // Powers are those from the second line on.
        let band = powers.get(lines.start.checked_sub(1)?..lines.end.checked_sub(1)?)?;
        if band.len() < FEWEST_LINES {
            return None;
        }
        let peak = peak(band);
        let line = peak.map(|peak| Line {
            order: TAU * (lines.start as f64 + peak.place) * spacing / wheel_speed,
            resolution: TAU * spacing / wheel_speed,
            rms: peak.power.sqrt(),
        });
        let all: f64 = band.iter().sum();
        let share = FRAC_2_PI * ((top / CORNER).atan() - (BAND[0] / CORNER).atan());
        Some(Self {
            run: run.to_owned(),
            simulated: trace.is_simulated(),
            wheel_speed,
            variance: (all - peak.map_or(0.0, |peak| peak.power)).max(0.0) / share,
            relative_error: (HANN_CORRELATION / band.len() as f64).sqrt(),
            line,
        })
    }

    /// How much louder than at [`STATED_AT`] the drive is at its speed [-].
    fn growth(&self) -> f64 {
        let speed = self.wheel_speed / STATED_AT;
        speed * speed
    }

    /// The variance's weight in a fit: over the square of its standard error.
    fn weight(&self) -> f64 {
        (self.relative_error * self.variance)
            .max(f64::MIN_POSITIVE)
            .powi(-2)
    }
}

impl Size {
    /// By least squares of the variances, each weighed by its own error.
    fn of(runs: &[Lifted]) -> Self {
        let [slow, fast] = range(runs);
        if fast > SPREAD * slow {
            Self::parted(runs)
        } else {
            Self::with_noise(runs)
        }
    }

    /// The broadband part and noise of their own.
    fn parted(runs: &[Lifted]) -> Self {
        let mut sums = [0.0; 5];
        for run in runs {
            let weight = run.weight();
            let (x, y) = (run.growth().powi(2), run.variance);
            let terms = [
                weight,
                weight * x,
                weight * x * x,
                weight * y,
                weight * x * y,
            ];
            sums.iter_mut()
                .zip(terms)
                .for_each(|(sum, term)| *sum += term);
        }
        let [one, x, xx, y, xy] = sums;
        let determinant = one * xx - x * x;
        let slope = (one * xy - x * y) / determinant;
        let noise = (y - slope * x) / one;
        if noise < 0.0 || slope < 0.0 {
            return Self::one_alone(runs, slope < 0.0);
        }
        let residual = |run: &Lifted| {
            run.weight() * (run.variance - noise - slope * run.growth().powi(2)).powi(2)
        };
        let chi_square: f64 = runs.iter().map(residual).sum();
        let freedom = runs.len() - 2;
        Self {
            noise: Some(noise.sqrt()),
            misfit: (freedom > 0).then(|| chi_square / freedom as f64),
            ..Self::broadband(slope, (one / determinant).sqrt())
        }
    }

    /// Noise only where the variance does not grow with speed, vibration only where the fit has no noise.
    fn one_alone(runs: &[Lifted], is_noise: bool) -> Self {
        if !is_noise {
            let vibration = Alone::of(runs, |run| run.growth().powi(2));
            return Self {
                noise: Some(0.0),
                misfit: Some(vibration.chi_square / (runs.len() - 1) as f64),
                ..Self::broadband(vibration.variance, vibration.error)
            };
        }
        let noise = Alone::of(runs, |_| 1.0);
        let growths = runs.iter().map(|run| run.growth().powi(2));
        Self {
            broadband: 0.0,
            broadband_error: (noise.error / growths.fold(0.0, f64::max)).sqrt(),
            noise: Some(noise.variance.sqrt()),
            misfit: Some(noise.chi_square / (runs.len() - 1) as f64),
        }
    }

    /// All of the variance, at one speed.
    fn with_noise(runs: &[Lifted]) -> Self {
        let vibration = Alone::of(runs, |run| run.growth().powi(2));
        Self::broadband(vibration.variance, vibration.error)
    }

    /// A broadband part of this `variance` [m²/s⁴] with its standard error.
    fn broadband(variance: f64, error: f64) -> Self {
        let rms = variance.sqrt();
        Self {
            broadband: rms,
            broadband_error: (0.5 * error / rms).min(error.sqrt()),
            noise: None,
            misfit: None,
        }
    }
}

/// Least squares of the variances by one part that grows in a given way with speed.
struct Alone {
    /// That part where its growth is 1, and its standard error [m²/s⁴].
    variance: f64,
    error: f64,
    chi_square: f64,
}

impl Alone {
    fn of(runs: &[Lifted], growth: impl Fn(&Lifted) -> f64) -> Self {
        let sum = |term: &dyn Fn(&Lifted) -> f64| -> f64 {
            runs.iter().map(|run| run.weight() * term(run)).sum()
        };
        let square = sum(&|run| growth(run).powi(2));
        let variance = sum(&|run| growth(run) * run.variance) / square;
        Self {
            variance,
            error: square.recip().sqrt(),
            chi_square: sum(&|run| (run.variance - variance * growth(run)).powi(2)),
        }
    }
}

/// Slowest and fastest wheel speed [rad/s].
fn range(runs: &[Lifted]) -> [f64; 2] {
    let speeds = || runs.iter().map(|run| run.wheel_speed);
    [
        speeds().fold(f64::INFINITY, f64::min),
        speeds().fold(0.0, f64::max),
    ]
}

/// A peak of a spectrum.
#[derive(Debug, Clone, Copy)]
struct Peak {
    /// Its middle, in lines.
    place: f64,
    /// Its mean square, less that of the noise below it.
    power: f64,
}

/// The largest peak of `powers`, if noise makes one as large less often than [`FALSE_LINE`].
///
/// Powers of noise are distributed exponentially, with a median of `ln 2` of their mean.
fn peak(powers: &[f64]) -> Option<Peak> {
    let level = upper_median(powers.iter().copied())? / LN_2;
    let (line, largest) = powers
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(b.1))?;
    let threshold = level * (powers.len() as f64 / FALSE_LINE).ln();
    // The low pass doubles the level from the band's end to its beginning; lines in between stand on less than twice the median.
    if *largest <= 2.0 * threshold {
        return None;
    }
    let near = line.saturating_sub(LEAKAGE)..(line + LEAKAGE + 1).min(powers.len());
    let above = |line: usize| (powers[line] - level).max(0.0);
    let power: f64 = near.clone().map(above).sum();
    let place = near.map(|line| line as f64 * above(line)).sum::<f64>() / power;
    Some(Peak { place, power })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A run at this wheel speed [rad/s] whose variance is that of noise and vibration [m/s² rms].
    fn lifted(wheel_speed: f64, noise: f64, broadband: f64) -> Lifted {
        let mut run = Lifted {
            run: "run".to_owned(),
            simulated: false,
            wheel_speed,
            variance: 0.0,
            relative_error: 0.05,
            line: None,
        };
        run.variance = noise * noise + (broadband * run.growth()).powi(2);
        run
    }

    #[test]
    fn two_speeds_part_the_drives_vibration_from_the_sensors_noise() {
        let size = Size::of(&[lifted(0.05, 3.0e-4, 2.0e-3), lifted(0.2, 3.0e-4, 2.0e-3)]);
        assert!((size.broadband / 2.0e-3 - 1.0).abs() < 1e-9, "{size:?}");
        assert!(
            (size.noise.unwrap() / 3.0e-4 - 1.0).abs() < 1e-9,
            "{size:?}"
        );
    }

    #[test]
    fn a_variance_that_does_not_grow_with_speed_is_noise() {
        let size = Size::of(&[lifted(0.05, 3.1e-4, 0.0), lifted(0.2, 3.0e-4, 0.0)]);
        assert_eq!(size.broadband, 0.0);
        assert!(
            (size.noise.unwrap() / 3.05e-4 - 1.0).abs() < 0.02,
            "{size:?}"
        );
    }

    #[test]
    fn vibration_that_grows_with_speed_itself_misses_the_square_law() {
        let linear = [0.05, 0.1, 0.2].map(|speed| lifted(speed, 0.0, 2.0e-3 * STATED_AT / speed));
        assert!(Size::of(&linear).misfit.unwrap() > MISFIT);
        let square = [0.05, 0.1, 0.2].map(|speed| lifted(speed, 1.0e-4, 2.0e-3));
        assert!(Size::of(&square).misfit.unwrap() < 1e-6);
    }

    #[test]
    fn a_sine_is_one_line_of_its_mean_square_at_its_frequency() {
        let sine = |i: i32| 3.0 * libm::sin(TAU * 40.3 * f64::from(i) / 1000.0);
        // A floor, so that the level is not nil.
        let floor = |i: i32| 1.0e-3 * libm::sin(f64::from(i * i) * PI / 7.7);
        let samples: Vec<f64> = (0..1000).map(|i| sine(i) + floor(i)).collect();
        let powers = hann_powers(&Plans::default().forward(1000), &samples);
        let peak = peak(&powers).unwrap();
        assert!((peak.power / 4.5 - 1.0).abs() < 0.01, "{peak:?}");
        assert!((1.0 + peak.place - 40.3).abs() < 0.05, "{peak:?}");
    }
}
