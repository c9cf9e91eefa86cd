//! Pressure-sinkage points of a plate test.

use super::plates::PlateError;
use crate::trace::wheel::Plate;
use crate::trace::{Channel, Trace};

/// Fraction of the greatest sinkage [-] by which a plate may rise and still count as first loading: sensor
/// noise.
const NOISE: f64 = 0.01;

/// One plate with its loading curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressing {
    /// The plate.
    pub plate: Plate,
    /// Sinkage \[m\] and pressure \[Pa\], in the order of time.
    pub points: Vec<[f64; 2]>,
}

impl Pressing {
    /// The points of a run: from time series of `sinkage` and `normal_force` those of first loading up to the
    /// greatest force; from means one point. Unloading, reloading and non-finite samples are excluded.
    ///
    /// # Errors
    /// `NoPlate` for a run of a wheel, `Missing` without sinkage or force.
    pub fn of(trace: &Trace) -> Result<Self, PlateError> {
        let plate = trace.attributes.plate.ok_or(PlateError::NoPlate)?;
        let pressure = |force: f64| force / plate.area();
        let points = match (trace.channel("sinkage"), trace.channel("normal_force")) {
            (Some(sinkage), Some(force)) => first_loading(&paired(sinkage, force)),
            _ => {
                let mean = |name| trace.steady_mean(name).ok_or(PlateError::Missing(name));
                vec![[mean("sinkage")?, mean("normal_force")?]]
            }
        };
        let points = points
            .iter()
            .map(|[sinkage, force]| [*sinkage, pressure(*force)]);
        Ok(Self {
            plate,
            points: points.collect(),
        })
    }
}

/// Sinkages [m] with the forces [N] at the same times, interpolated where sample times differ.
fn paired(sinkage: &Channel, force: &Channel) -> Vec<[f64; 2]> {
    let at = |time: f64| {
        let place = (time - force.start) * force.sample_rate;
        // Times are integer multiples of the period up to rounding.
        let before = libm::floor(place + 1.0e-6);
        let part = (place - before).max(0.0);
        let sample = |place: f64| force.samples.get(place as usize).copied();
        let low = (before >= 0.0).then(|| sample(before)).flatten()?;
        if part < 1.0e-6 {
            Some(low)
        } else {
            Some(low + part * (sample(before + 1.0)? - low))
        }
    };
    let points = sinkage.samples.iter().enumerate();
    let points = points.filter_map(|(index, z)| Some([*z, at(sinkage.time(index))?]));
    points
        .filter(|point| point.iter().all(|x| x.is_finite()))
        .collect()
}

/// The points up to the greatest force at which the plate is as deep as ever before.
fn first_loading(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let peak = (0..points.len()).max_by(|a, b| points[*a][1].total_cmp(&points[*b][1]));
    let down = &points[..peak.map_or(0, |peak| peak + 1)];
    let noise = NOISE * down.iter().map(|[sinkage, _]| *sinkage).fold(0.0, f64::max);
    let mut deepest = f64::NEG_INFINITY;
    let mut fresh = Vec::new();
    for [sinkage, force] in down {
        if *sinkage >= deepest - noise {
            fresh.push([*sinkage, *force]);
        }
        deepest = deepest.max(*sinkage);
    }
    fresh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{Mean, RunAttributes};

    fn channel(name: &str, sample_rate: f64, samples: Vec<f64>) -> Channel {
        Channel {
            name: name.to_owned(),
            unit: String::new(),
            sample_rate,
            start: 0.0,
            samples,
        }
    }

    fn trace(channels: Vec<Channel>) -> Trace {
        Trace {
            attributes: RunAttributes {
                plate: Some(Plate::rectangle([0.1, 0.1])),
                ..RunAttributes::default()
            },
            channels,
            ..Trace::default()
        }
    }

    #[test]
    fn unloading_loading_again_and_lifting_press_no_undisturbed_soil() {
        // Down to 20 mm, up to 5 mm, down to 30 mm, out.
        let sinkage = [0.0, 0.01, 0.02, 0.005, 0.015, 0.025, 0.03, 0.01];
        let force = [0.0, 10.0, 20.0, 1.0, 12.0, 25.0, 30.0, 0.0];
        let run = trace(vec![
            channel("sinkage", 10.0, sinkage.into()),
            channel("normal_force", 10.0, force.into()),
        ]);
        let points = Pressing::of(&run).unwrap().points;
        let sinkages: Vec<f64> = points.iter().map(|point| point[0]).collect();
        assert_eq!(sinkages, [0.0, 0.01, 0.02, 0.025, 0.03]);
        assert!((points[1][1] - 1000.0).abs() < 1e-9);
    }

    #[test]
    fn forces_of_another_rate_are_taken_at_the_sinkages_times_and_gaps_are_left_out() {
        let run = trace(vec![
            channel("sinkage", 10.0, vec![0.0, 0.01, f64::NAN, 0.03]),
            channel("normal_force", 4.0, vec![0.0, 25.0]),
        ]);
        let points = Pressing::of(&run).unwrap().points;
        assert_eq!(points.len(), 2);
        assert!((points[1][1] - 1000.0).abs() < 1e-9, "{points:?}");
    }

    #[test]
    fn means_are_a_point_and_a_wheel_is_no_plate() {
        let mut run = trace(Vec::new());
        assert_eq!(Pressing::of(&run), Err(PlateError::Missing("sinkage")));
        let mean = |name: &str, value| Mean {
            name: name.to_owned(),
            unit: String::new(),
            value,
            sd: f64::NAN,
            n: 0,
        };
        run.means = vec![mean("sinkage", 0.01), mean("normal_force", 50.0)];
        let points = Pressing::of(&run).unwrap().points;
        assert!((points[0][1] - 5000.0).abs() < 1e-9);
        run.attributes.plate = None;
        assert_eq!(Pressing::of(&run), Err(PlateError::NoPlate));
    }
}
