//! One experiment from its ground to its trace; nothing in it reads a file or a clock.

use super::Scenario;
use crate::quantity::{RangeError, Seed};
use crate::sensors::SensorChain;
use crate::simulation::{Simulation, SimulationError};
use crate::terrain::Terrain;
use crate::terrain::class::TerrainLabel;
use crate::trace::truth::TruthRecorder;
use crate::trace::{RunAttributes, Trace, Truth};
use std::ops::ControlFlow;

/// Why an experiment left no trace.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExperimentError {
    /// The wheel's run could not begin or go on.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The sensors cannot be built at these rates.
    #[error(transparent)]
    Sensors(#[from] RangeError),
    /// The caller stopped it.
    #[error("stopped before its end")]
    Stopped,
}

/// Steps between two reports of progress.
const REPORT_EVERY: u64 = 4096;

/// Distance between the points of the ground kept as truth [m].
const PROFILE_SPACING: f64 = 1.0e-3;

impl Scenario {
    /// Runs the experiment: run `run` of the series that `seed` begins.
    ///
    /// `progress` hears the simulated time [s] now and then, and may stop the run.
    ///
    /// # Errors
    /// `Simulation` where the ground does not carry the wheel or the motion is not defined,
    /// `Sensors` for rates that do not divide, `Stopped` when `progress` said so.
    pub fn run(
        &self,
        seed: Seed,
        run: u64,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Trace, ExperimentError> {
        let rate = self.physics_rate();
        let terrain = Terrain::generate(&self.terrain, seed, run);
        let mut chain = SensorChain::new(&self.sensors, rate, self.wheel.radius, seed, run)?;
        let mut truth = TruthRecorder::new(&self.wheel, self.window());
        let mut simulation = Simulation::new(&terrain, &self.wheel, &self.rig, rate)?;
        let steps_in = |time: f64| (time * rate.hertz()).round() as u64;
        let lead_in = steps_in(self.lead_in);
        let mut way = [0.0_f64, 0.0];
        for step in 0..lead_in + steps_in(self.duration) {
            let Some(state) = simulation.next() else {
                break;
            };
            let state = state?;
            let label = simulation.label();
            if step >= lead_in {
                chain.push(&state);
                truth.push(&state, label);
            }
            way = [way[0].min(state.position), way[1].max(state.position)];
            if step % REPORT_EVERY == 0 && progress(state.time).is_break() {
                return Err(ExperimentError::Stopped);
            }
        }
        let truth = Truth {
            parameters: terrain.parameters(),
            profile: simulation.undisturbed(
                way[0] - self.wheel.radius,
                way[1] + self.wheel.radius,
                PROFILE_SPACING,
            ),
            ..truth.finish()
        };
        Ok(Trace {
            attributes: self.attributes(&truth, run),
            channels: chain.finish(),
            means: Vec::new(),
            truth: Some(truth),
        })
    }

    fn attributes(&self, truth: &Truth, run: u64) -> RunAttributes {
        let drive = self.rig.drive();
        RunAttributes {
            wheel_radius: self.wheel.radius,
            wheel_width: self.wheel.width,
            lug_count: self.wheel.lug_count(),
            lug_height: self.wheel.lug_height(),
            load: self.rig.load(),
            speed: drive.forward_speed,
            slip_ratio: drive.commanded_slip(self.wheel.radius),
            terrain: self.label(),
            class: truth.class(),
            repeat: u32::try_from(run).unwrap_or(u32::MAX),
            day: String::new(),
            notes: String::new(),
            physics_rate: Some(self.physics_rate().hertz()),
        }
    }

    /// The one ground of the run; none where it crosses several.
    fn label(&self) -> Option<TerrainLabel> {
        match &self.terrain {
            crate::terrain::TerrainSpec::Sequence(sections) if sections.len() > 1 => None,
            terrain => Some(terrain.label()),
        }
    }
}
