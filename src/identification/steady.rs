//! Steady intervals of a run, as rows of mean loads.

use super::drift::{Drift, SteadyRow};
use super::row::{SteadyLoad, Uncertainty};
use crate::statistics::upper_median;
use crate::trace::slope::Slope;
use crate::trace::{Channel, Trace};

/// Why a run gives no rows.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SteadyError {
    /// A quantity is neither a channel nor a mean.
    #[error(
        "{0} is missing or has no finite value: the identification needs it as a channel or as a mean"
    )]
    Missing(&'static str),
    /// No load was measured and the commanded one is negative.
    #[error(
        "normal_force is missing, and the commanded load (load_n) is {0} N: a wheel on the ground \
         carries more than 0"
    )]
    Unloaded(String),
    /// The wheel was lifted off the ground.
    #[error("the commanded load (load_n) is 0 N: a lifted wheel does not load the terrain")]
    Lifted,
    /// Slip is never steady for long enough.
    #[error("slip never stays within {tolerance} for a tenth of the run: no steady interval")]
    NeverSteady {
        /// The tolerance of slip, formatted.
        tolerance: String,
    },
    /// The forces on a sloping track include the wheel's own weight, and its mass is not given.
    #[error(
        "the track slopes by {0}°, and force sensors tared on the level then read a part of the wheel's own weight: \
         state its mass in the campaign (wheel = {{ mass_kg = ... }}; 0 where the forces are the contact's \
         alone) and import it again"
    )]
    SlopeWithoutMass(String),
}

/// An interval of steady slip with its row, or the reason why there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Its middle half \[s\], which gives the row.
    pub interval: [f64; 2],
    /// The row.
    pub row: Result<SteadyRow, SteadyError>,
}

/// Maximum number of equal parts of a run in the search for steady slip: a steady interval lasts a tenth of
/// the run or longer.
const PARTS: usize = 60;

/// Change of slip [-] below which it counts as steady, where its noise is smaller.
const TOLERANCE: f64 = 0.01;

/// Number of blocks whose means give the uncertainty of the interval's mean.
const BLOCKS: usize = 8;

/// Relative calibration uncertainty of a force [-], which the scatter does not show; a rig that controls its
/// load to a thousandth does not measure it so well. For pull, and for torque over the wheel's radius, at
/// least that of a tenth of the load.
pub const CALIBRATION: f64 = 0.01;

/// One row for each steady interval of a run: the middle half of every stretch of a tenth of the run or
/// longer with constant slip.
///
/// A run of one condition gives one row. A quantity without a time series is taken from its mean; slip and
/// load without either as commanded. Uncertainties are those of the mean of eight block means, or of a mean's
/// samples taken as independent, combined with the [`CALIBRATION`] of the forces. Sinkage and driving torque
/// are NaN where the run lacks them.
///
/// A stretch that lacks a required quantity gives no row; the others do. Forces on a slope are converted to
/// those of the contact.
///
/// # Errors
/// `Lifted`; `NeverSteady`; where no stretch gives a row the reason of the first: `Missing` without
/// drawbar pull or load, `SlopeWithoutMass`.
pub fn steady_loads(trace: &Trace) -> Result<Vec<SteadyLoad>, SteadyError> {
    let rows = steady_rows(trace)?.into_iter();
    Ok(rows.map(|row| row.load).collect())
}

/// The rows of [`steady_loads`], each with the drifts in its interval.
///
/// # Errors
/// Those of [`steady_loads`].
pub fn steady_rows(trace: &Trace) -> Result<Vec<SteadyRow>, SteadyError> {
    let rows = steady_stretches(trace)?
        .into_iter()
        .map(|stretch| stretch.row);
    let (rows, refused): (Vec<_>, Vec<_>) = rows.partition(Result::is_ok);
    match refused.into_iter().next() {
        Some(reason) if rows.is_empty() => reason.map(|row| vec![row]),
        _ => rows.into_iter().collect(),
    }
}

/// The stretches of [`steady_rows`], including those that give no row.
///
/// # Errors
/// `Lifted`; `NeverSteady`.
pub fn steady_stretches(trace: &Trace) -> Result<Vec<Stretch>, SteadyError> {
    if trace.attributes.is_lifted() {
        return Err(SteadyError::Lifted);
    }
    let intervals = match trace.channel("slip_ratio") {
        Some(slip) => plateaus(slip)?,
        None => vec![middle_half(0.0, trace.duration(), start(trace))],
    };
    let row = |interval| {
        Ok(SteadyRow {
            load: load(trace, interval)?,
            interval,
            drifts: Drift::within(trace, interval),
        })
    };
    let stretch = |interval| Stretch {
        interval,
        row: row(interval),
    };
    Ok(intervals.into_iter().map(stretch).collect())
}

/// Time [s] at which the first channel starts.
fn start(trace: &Trace) -> f64 {
    let starts = trace.channels.iter().map(|channel| channel.start);
    starts.reduce(f64::min).unwrap_or(0.0)
}

/// The middle half of `[from, to)` after `start` [s].
fn middle_half(from: f64, to: f64, start: f64) -> [f64; 2] {
    let quarter = 0.25 * (to - from);
    [start + from + quarter, start + to - quarter]
}

fn load(trace: &Trace, interval: [f64; 2]) -> Result<SteadyLoad, SteadyError> {
    let known = |name: &'static str| value(trace, name, interval);
    let needed = |name: &'static str| known(name).ok_or(SteadyError::Missing(name));
    let commanded = |value: f64| Value {
        mean: value,
        sd: 0.0,
    };
    let slip = known("slip_ratio").unwrap_or(commanded(trace.attributes.slip_ratio));
    let sinkage = known("sinkage").unwrap_or(commanded(f64::NAN));
    let slope = Slope::of(&trace.attributes)
        .ok_or_else(|| SteadyError::SlopeWithoutMass(trace.attributes.slope_deg.to_string()))?;
    let drawbar_pull = needed("drawbar_pull")?.map(|pull| slope.drawbar_pull(pull));
    let driving_torque = known("driving_torque").unwrap_or(commanded(f64::NAN));
    let load = match known("normal_force") {
        Some(load) => load.map(|load| slope.normal_force(load)),
        None if trace.attributes.load > 0.0 => commanded(slope.carried(trace.attributes.load)),
        None => return Err(unloaded(trace.attributes.load)),
    };
    let tenth = 0.1 * load.mean.abs();
    let pull_sd = drawbar_pull.as_force(tenth);
    let load_sd = load.as_force(0.0);
    let torque_sd = driving_torque.as_force(tenth * trace.attributes.wheel_radius);
    // A load of 0 has no uncertainty. `f64::min` ignores the NaN of a missing torque.
    let uncertainty = (pull_sd.min(load_sd).min(torque_sd) > 0.0).then_some(Uncertainty {
        slip: slip.sd,
        sinkage: sinkage.sd,
        drawbar_pull: pull_sd,
        load: load_sd,
        driving_torque: torque_sd,
    });
    Ok(SteadyLoad {
        slip: slip.mean,
        sinkage: sinkage.mean,
        drawbar_pull: drawbar_pull.mean,
        load: load.mean,
        driving_torque: driving_torque.mean,
        uncertainty,
    })
}

/// The error for a commanded load that is negative or zero.
fn unloaded(load: f64) -> SteadyError {
    if load.is_finite() {
        SteadyError::Unloaded(load.to_string())
    } else {
        SteadyError::Missing("normal_force")
    }
}

/// A mean and its standard uncertainty; 0 where unknown.
#[derive(Debug, Clone, Copy)]
struct Value {
    mean: f64,
    sd: f64,
}

impl Value {
    /// The mean transformed, with the same uncertainty.
    fn map(self, change: impl Fn(f64) -> f64) -> Self {
        Self {
            mean: change(self.mean),
            ..self
        }
    }

    /// Standard uncertainty of a force with this mean: the calibration of a load-carrying sensor is no better
    /// for forces below `least`.
    fn as_force(self, least: f64) -> f64 {
        let size = self.mean.abs();
        let size = if size < least { least } else { size };
        libm::hypot(self.sd, CALIBRATION * size)
    }
}

fn value(trace: &Trace, name: &str, interval: [f64; 2]) -> Option<Value> {
    let sampled = trace
        .channel(name)
        .and_then(|channel| sampled(channel, interval));
    sampled.or_else(|| {
        let mean = trace.means.iter().find(|mean| mean.name == name)?;
        // Unknown number of samples counts as one.
        let count = mean.n.max(1) as f64;
        let sd = if mean.sd > 0.0 {
            mean.sd / libm::sqrt(count)
        } else {
            0.0
        };
        Some(Value {
            mean: mean.value,
            sd,
        })
    })
}

/// Mean of the block means over an interval.
fn sampled(channel: &Channel, [from, to]: [f64; 2]) -> Option<Value> {
    let means = part_means(channel.between(from, to), BLOCKS);
    let known: Vec<f64> = means.into_iter().flatten().collect();
    let mean = mean_of(&known)?;
    let square: f64 = known.iter().map(|x| (x - mean) * (x - mean)).sum();
    let count = known.len() as f64;
    let sd = if known.len() > 1 {
        libm::sqrt(square / (count - 1.0) / count)
    } else {
        0.0
    };
    Some(Value { mean, sd })
}

/// Means of the finite samples in each of `parts` equal parts; `None` where a part has none.
fn part_means(samples: &[f64], parts: usize) -> Vec<Option<f64>> {
    let edge = |part: usize| part * samples.len() / parts;
    (0..parts)
        .map(|part| {
            let whole = &samples[edge(part)..edge(part + 1)];
            let finite: Vec<f64> = whole.iter().copied().filter(|x| x.is_finite()).collect();
            mean_of(&finite)
        })
        .collect()
}

fn mean_of(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Intervals of steady slip [s].
fn plateaus(slip: &Channel) -> Result<Vec<[f64; 2]>, SteadyError> {
    let parts = PARTS.min(slip.samples.len());
    let means = part_means(&slip.samples, parts);
    let tolerance = TOLERANCE.max(4.0 * noise(&means));
    let part = slip.duration() / parts as f64;
    let found: Vec<[f64; 2]> = stretches(&means, tolerance)
        .into_iter()
        .filter(|[from, to]| 10 * (to - from) >= parts)
        .filter(|[from, to]| !drifts(&means[*from..*to], tolerance))
        .map(|[from, to]| middle_half(from as f64 * part, to as f64 * part, slip.start))
        .collect();
    if found.is_empty() {
        return Err(SteadyError::NeverSteady {
            tolerance: format!("{tolerance:.3}"),
        });
    }
    Ok(found)
}

/// Standard deviation of the parts' means about a steady slip, from the median step between neighbours, which
/// is robust to the few true steps.
fn noise(means: &[Option<f64>]) -> f64 {
    let pairs = means.windows(2);
    let steps = pairs.filter_map(|pair| Some((pair[1]? - pair[0]?).abs()));
    // The median of |x - y| of two standard normal variables is 0.954.
    upper_median(steps).map_or(0.0, |median| median / 0.954)
}

/// Runs of parts whose means stay within `tolerance` of the mean of those before, as `[from, to)`.
fn stretches(means: &[Option<f64>], tolerance: f64) -> Vec<[usize; 2]> {
    let mut found = Vec::new();
    let mut from = 0;
    let mut known: Vec<f64> = Vec::new();
    for (index, mean) in means.iter().enumerate() {
        let stays = match (mean, mean_of(&known)) {
            (Some(mean), Some(before)) => (mean - before).abs() <= tolerance,
            (mean, _) => mean.is_some(),
        };
        if !stays {
            found.push([from, index]);
            known.clear();
            from = if mean.is_some() { index } else { index + 1 };
        }
        known.extend(*mean);
    }
    found.push([from, means.len()]);
    found
}

/// Whether the second half of a stretch differs from the first: a slow ramp.
fn drifts(means: &[Option<f64>], tolerance: f64) -> bool {
    let (first, second) = means.split_at(means.len() / 2);
    let mean = |half: &[Option<f64>]| {
        let known: Vec<f64> = half.iter().copied().flatten().collect();
        mean_of(&known)
    };
    mean(first)
        .zip(mean(second))
        .is_some_and(|(first, second)| (second - first).abs() > 0.5 * tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{Mean, RunAttributes};

    const RATE: f64 = 100.0;

    fn channel(name: &str, value: impl Fn(f64) -> f64) -> Channel {
        Channel {
            name: name.to_owned(),
            unit: crate::trace::unit_of(name).unwrap().to_owned(),
            sample_rate: RATE,
            start: 2.0,
            samples: (0..6000).map(|i| value(f64::from(i) / RATE)).collect(),
        }
    }

    /// A minute with this slip over time [s]; pull is 100 slips, with a ripple of 1 s.
    fn run(slip: fn(f64) -> f64) -> Trace {
        let ripple = |t: f64| libm::sin(std::f64::consts::TAU * t + 0.3 * t);
        let attributes = RunAttributes {
            load: 109.0,
            ..RunAttributes::default()
        };
        Trace {
            attributes,
            channels: vec![
                channel("slip_ratio", move |t| slip(t) + 0.005 * ripple(17.0 * t)),
                channel("sinkage", |_| 0.01),
                channel("drawbar_pull", move |t| 100.0 * slip(t) + ripple(t)),
                channel("normal_force", move |t| 109.0 + ripple(t)),
                channel("driving_torque", move |t| 5.0 + 0.1 * ripple(t)),
            ],
            ..Trace::default()
        }
    }

    #[test]
    fn a_run_of_one_condition_gives_one_row_of_its_middle_half() {
        // Started and stopped within a tenth of the run.
        let slip = |t: f64| if (5.0..55.0).contains(&t) { 0.2 } else { 0.9 };
        let rows = steady_loads(&run(slip)).unwrap();
        assert_eq!(rows.len(), 1);
        let row = rows[0];
        assert!((row.slip - 0.2).abs() < 1e-3 && (row.drawbar_pull - 20.0).abs() < 0.1);
        let uncertainty = row.uncertainty.unwrap();
        // The ripple of 1 N nearly averages out over 25 s; 1 % of 109 N remains.
        let load = uncertainty.load;
        assert!((load - 1.09).abs() < 0.01, "{load}");
        assert_eq!(uncertainty.sinkage, 0.0);
    }

    #[test]
    fn a_staircase_of_slip_gives_a_row_for_each_step() {
        let slip = |t: f64| 0.1 * (1.0 + (t / 20.0).floor());
        let rows = steady_loads(&run(slip)).unwrap();
        let slips: Vec<f64> = rows.iter().map(|row| (row.slip * 100.0).round()).collect();
        assert_eq!(slips, [10.0, 20.0, 30.0]);
        for row in rows {
            assert!((row.drawbar_pull - 100.0 * row.slip).abs() < 0.3, "{row:?}");
        }
    }

    #[test]
    fn a_drifting_sinkage_is_reported_and_its_growth_is_in_the_uncertainty() {
        let mut trace = run(|_| 0.2);
        trace.channels[1] = channel("sinkage", |t| 0.01 + 1.0e-4 * t);
        let mut row = steady_rows(&trace).unwrap().remove(0);
        let [drift] = row.drifts[..] else {
            panic!("{:?}", row.drifts);
        };
        assert_eq!(drift.channel, "sinkage");
        assert!((drift.rate / 1.0e-4 - 1.0).abs() < 0.01, "{drift:?}");
        let before = row.load.uncertainty.unwrap();
        row.widen();
        let after = row.load.uncertainty.unwrap();
        // 30 s of 0.1 mm/s.
        assert!((after.sinkage / 3.0e-3 - 1.0).abs() < 0.05, "{after:?}");
        assert_eq!(after.load, before.load);
    }

    #[test]
    fn a_ramp_of_slip_is_never_steady() {
        let refused = steady_loads(&run(|t| t / 60.0)).unwrap_err();
        assert!(
            matches!(refused, SteadyError::NeverSteady { .. }),
            "{refused}"
        );
    }

    #[test]
    fn means_give_a_row_where_there_is_no_time_series() {
        let mean = |name: &str, value: f64| Mean {
            name: name.to_owned(),
            unit: String::new(),
            value,
            sd: 0.5,
            n: 25,
        };
        let mut trace = Trace::default();
        trace.attributes.slip_ratio = 0.3;
        trace.means = vec![mean("drawbar_pull", 20.0)];
        assert_eq!(steady_loads(&trace), Err(SteadyError::Lifted));
        trace.attributes.load = f64::NAN;
        let missing = steady_loads(&trace).unwrap_err().to_string();
        assert!(missing.starts_with("normal_force is missing"), "{missing}");
        trace.attributes.load = 80.0;
        let row = steady_loads(&trace).unwrap()[0];
        assert_eq!((row.slip, row.load), (0.3, 80.0));
        // As commanded, to 1 %.
        assert!((row.uncertainty.unwrap().load - 0.8).abs() < 1e-12);
        assert!(row.sinkage.is_nan() && !row.has_torque());
        trace.means.push(mean("driving_torque", 5.0));
        assert_eq!(steady_loads(&trace).unwrap()[0].driving_torque, 5.0);
        trace.means.push(mean("normal_force", 81.0));
        let row = steady_loads(&trace).unwrap()[0];
        assert_eq!(row.load, 81.0);
        // 0.5/√25 and 1 % of 81 N.
        assert!((row.uncertainty.unwrap().load - 0.1f64.hypot(0.81)).abs() < 1e-12);
    }
}
