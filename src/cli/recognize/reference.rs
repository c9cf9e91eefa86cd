//! What the features are taken over.

use super::Unfit;
use crate::dataset::hdf5::{RunFile, RunFileError};
use crate::features::Settings;
use crate::features::reference::{Reference, ReferenceError};
use crate::quantity::SlipRatio;
use crate::scenario::Scenario;
use crate::sensors::Sensors;
use crate::terrain::class::TerrainLabel;
use crate::trace::RunAttributes;
use std::path::Path;

/// A reference, and in words what it is.
pub struct Chosen {
    pub reference: Reference,
    pub origin: String,
}

/// Ratio of two wheel speeds [-] from which each has a reference of its own; between them it is
/// interpolated.
const APART: f64 = 1.1;

/// The reference from the runs of a file, all on REF where they state their ground.
///
/// # Errors
/// `Unfit` where a run is on other ground, or cannot be used; those of reading the file.
pub fn measured(path: &Path, settings: Settings) -> anyhow::Result<Chosen> {
    let file = RunFile::open(path)?;
    let unfit = |reason: String| Unfit::NoReference {
        path: path.to_owned(),
        reason,
    };
    for id in file.runs() {
        match file.attributes(id)?.terrain {
            None | Some(TerrainLabel::Reference) => {}
            Some(other) => {
                let reason = format!("run {id} is on {other}, not on REF (flat hard ground)");
                return Err(unfit(reason).into());
            }
        }
    }
    let mut unread: Option<RunFileError> = None;
    let runs = file.runs().iter().map_while(|id| match file.read(id) {
        Ok(trace) => Some(trace),
        Err(error) => {
            unread = Some(error);
            None
        }
    });
    let reference = Reference::measured(runs, settings);
    if let Some(error) = unread {
        return Err(error.into());
    }
    let reference = reference.map_err(|error| unfit(error.to_string()))?;
    let count = file.runs().len();
    let origin = format!("measured, {count} runs of {}", path.display());
    Ok(Chosen { reference, origin })
}

/// The computed reference; through the sensors of the file's scenario, where they are not ideal.
pub fn computed(file: &RunFile, runs: &[String], settings: Settings) -> Chosen {
    let ideal = || Chosen {
        reference: Reference::computed(),
        origin: "computed".to_owned(),
    };
    let Some(text) = &file.provenance().scenario else {
        return ideal();
    };
    let name = format!("scenario in {}", file.path().display());
    let scenario = match Scenario::from_toml(text, &name) {
        Ok(scenario) => scenario,
        Err(error) => {
            return Chosen {
                origin: format!("computed for ideal sensors, as the {name} is none: {error}"),
                ..ideal()
            };
        }
    };
    let sensors = Sensors {
        raw: false,
        ..scenario.sensors
    };
    if sensors == Sensors::default() || scenario.wheel.lug_count() == 0 {
        return ideal();
    }
    let attributes = runs.iter().filter_map(|id| file.attributes(id).ok());
    let commanded = scenario.rig.drive().full_wheel_speed(scenario.wheel.radius);
    let speeds = apart(
        attributes
            .map(|run| wheel_speed(&run))
            .chain(commanded.ok()),
    );
    match Reference::through_sensors(&scenario.wheel, &sensors, &speeds, settings) {
        Ok(reference) => Chosen {
            reference,
            origin: "computed, through the sensors of the scenario".to_owned(),
        },
        Err(error) => Chosen {
            origin: format!("computed for ideal sensors: {}", reason(&error)),
            ..ideal()
        },
    }
}

fn reason(error: &ReferenceError) -> String {
    format!("through the scenario's there is none, as {error}")
}

/// Commanded wheel speed [rad/s].
fn wheel_speed(run: &RunAttributes) -> f64 {
    let slip = SlipRatio::new(run.slip_ratio).ok();
    let speed = slip.and_then(|slip| slip.wheel_speed(run.wheel_radius, run.speed));
    speed.unwrap_or(f64::NAN)
}

/// The speeds above 0, at least a factor [`APART`] from each other.
fn apart(speeds: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut speeds: Vec<f64> = speeds
        .map(f64::abs)
        .filter(|speed| *speed > 0.0 && speed.is_finite())
        .collect();
    speeds.sort_by(f64::total_cmp);
    let mut kept: Vec<f64> = Vec::new();
    for speed in speeds {
        if kept.last().is_none_or(|last| speed >= APART * last) {
            kept.push(speed);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousand_runs_at_three_speeds_need_three_references() {
        let speeds = (0..1000).map(|i| [0.1, 0.2, 0.3][i % 3] * (1.0 + 1.0e-6 * i as f64));
        let kept = apart(speeds.chain([0.0, f64::NAN, f64::INFINITY]));
        assert_eq!(kept.len(), 3, "{kept:?}");
    }
}
