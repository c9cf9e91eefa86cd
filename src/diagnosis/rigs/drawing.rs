//! A rig in every condition of a layout: each motion once, measured as often as there are rows of it.

use super::design::{Rig, RowDesign};
use super::table::Row;
use super::{Column, RigSet};
use crate::diagnosis::arm::Arm;
use crate::diagnosis::condition::Case;
use crate::diagnosis::parameter::Offsets;
use crate::gap::{Readings, Statistician};
use crate::quantity::{SampleRate, Seed};
use crate::scenario::Scenario;
use crate::scenario::experiment::ExperimentError;
use crate::sensors::Sensors;
use rand::RngExt;
use std::ops::ControlFlow;

/// Factor [-] between the physics rates that take turns at random: how far a statistic depends on the step is scatter.
const FASTER: f64 = 1.6;
/// Share [-] of runs at the faster one.
const OFTEN: f64 = 0.25;

/// Why a rig has no rows.
pub(super) enum NoRig {
    /// The caller stopped.
    Stopped,
    /// It cannot be simulated.
    Failed(String),
}

impl NoRig {
    fn failed(reason: &dyn std::fmt::Display) -> Self {
        Self::Failed(reason.to_string())
    }
}

/// Where one run of a rig stands.
#[derive(Clone, Copy)]
struct Place<'a> {
    case: &'a Case,
    number: usize,
}

/// Reads rigs.
pub(super) struct Drawing<'a> {
    pub set: &'a RigSet,
    pub statistician: Statistician,
    pub progress: &'a mut dyn FnMut(f64) -> ControlFlow<()>,
}

impl Drawing<'_> {
    /// The rows of a rig. Each condition is simulated once: repeats cost as much as further rigs, and teach less.
    pub fn rows(&mut self, rig: &Rig) -> Result<Vec<Row>, NoRig> {
        let set = self.set;
        let columns = &set.population.columns;
        let mut values = vec![vec![f32::NAN; columns.len()]; rig.rows.len()];
        for (number, case) in set.population.cases.iter().enumerate() {
            let mut readings = Vec::new();
            let candidates = &set.population.candidates;
            let motions = rig.rows.chunk_by(|a, b| a.shares_motion(b, candidates));
            for rows in motions {
                readings.extend(self.run(rig, rows, Place { case, number })?);
            }
            for (values, readings) in values.iter_mut().zip(&readings) {
                fill(values, columns, number, readings);
            }
        }
        let rows = rig.rows.iter().zip(values).map(|(row, values)| Row {
            rig: rig.number,
            parameters: rig.parameters.clone(),
            effects: row.effects.clone(),
            randomised: row.law.is_some(),
            values,
        });
        Ok(rows.collect())
    }

    /// What is read in rows of one motion.
    fn run(&mut self, rig: &Rig, rows: &[RowDesign], place: Place) -> Result<Vec<Readings>, NoRig> {
        let Place { case, number } = place;
        let stream = (rig.number << 16) | ((number as u64) << 8);
        let seed = Seed(self.set.seed.0 ^ 0x7269_6773);
        let mut rng = seed.rng("diagnosis.run", stream);
        let mut scenarios = Vec::new();
        for row in rows {
            scenarios.push(self.scenario(rig, row, place)?);
        }
        let plain = self.scenario(rig, &RowDesign::PLAIN, place)?;
        let faster = faster(plain.physics_rate(), plain.sensors.rate);
        let rate = faster.filter(|_| rng.random::<f64>() < OFTEN);
        let mut moved = scenarios[0].clone();
        moved.physics_rate = rate.or(moved.physics_rate);
        let recorded = moved.record(seed, stream, self.progress);
        let recording = recorded.map_err(|error| match error {
            ExperimentError::Stopped => NoRig::Stopped,
            error => NoRig::failed(&error),
        })?;
        let sensors = |scenario: &Scenario| -> Result<Sensors, NoRig> {
            let experiment = scenario.experiment();
            Ok(experiment.map_err(|error| NoRig::failed(&error))?.sensors)
        };
        let plain = sensors(&plain)?;
        let many = recording.for_many(&plain);
        let many = many.map_err(|error| NoRig::failed(&error))?;
        let measure = |sensors: &Sensors| {
            let measured = many.measure(sensors);
            measured.map_err(|error| NoRig::failed(&error))
        };
        let ideal = measure(&plain)?;
        let base = case.as_measured(&ideal, &mut rng.clone());
        let known = self.statistician.read(&base);
        let mut readings = Vec::new();
        for (row, scenario) in rows.iter().zip(&scenarios) {
            let sensors = sensors(scenario)?;
            if sensors == plain {
                readings.push(known.clone());
                continue;
            }
            let mut trace = measure(&sensors)?;
            if let Some(law) = &row.law {
                law.modulate(&mut trace, &ideal);
            }
            let trace = case.as_measured(&trace, &mut rng.clone());
            readings.push(self.statistician.read_again(&trace, &base, &known));
        }
        Ok(readings)
    }

    /// The scenario of a row.
    fn scenario(&self, rig: &Rig, row: &RowDesign, place: Place) -> Result<Scenario, NoRig> {
        let parameters = &self.set.population.parameters;
        let mut arm = Arm::of_offsets(Offsets::of_deviations(parameters, &rig.parameters));
        for part in &row.effects {
            let candidate = &self.set.population.candidates[part.candidate];
            let size = match &row.law {
                Some(law) => law.size(part.size, place.number),
                None => part.size,
            };
            let effect = candidate.application(size);
            arm = arm.with_effect(effect.map_err(|error| NoRig::failed(&error))?);
        }
        let scenario = arm.scenario(place.case);
        scenario.map_err(|error| NoRig::failed(&error))
    }
}

/// The slowest rate that is at least so many times as fast and divides the sensor rate, or else the sensor rate; none where
/// the physics is as fast as that.
fn faster(physics: SampleRate, sensors: SampleRate) -> Option<SampleRate> {
    let ratio = sensors.hertz() / (FASTER * physics.hertz());
    // A ratio of 10 may read 9.999.
    let divisor = (ratio + 1.0e-9).floor().max(1.0);
    let faster = SampleRate::new(sensors.hertz() / divisor).ok()?;
    (faster.hertz() > physics.hertz()).then_some(faster)
}

/// Sets the values of a condition to what was read; not a number where a statistic could not be taken.
fn fill(values: &mut [f32], columns: &[Column], condition: usize, readings: &Readings) {
    let pairs = values.iter_mut().zip(columns);
    for (value, column) in pairs.filter(|(_, column)| column.condition == condition) {
        if let Some(reading) = readings.get(&column.cell) {
            *value = reading.value as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faster_physics_rate_divides_the_sensor_rate() {
        let rate = |hertz: f64| SampleRate::new(hertz).unwrap();
        for (physics, sensors, expected) in [
            (8.0e3, 128.0e3, Some(12.8e3)),
            (16.0e3, 128.0e3, Some(25.6e3)),
            (8.0e3, 16.0e3, Some(16.0e3)),
            (8.0e3, 8.0e3, None),
        ] {
            assert_eq!(faster(rate(physics), rate(sensors)), expected.map(rate));
        }
    }
}
