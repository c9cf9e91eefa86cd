//! One experiment from its ground to its trace; nothing in it reads a file or a clock.

use super::Scenario;
use super::extensions::Extensions;
use super::recording::{Motion, Recording};
use crate::effects::{EffectError, Setup};
use crate::quantity::{RangeError, Seed};
use crate::sensors::{Observed, SensorChain, Sensors};
use crate::simulation::rig::Rig;
use crate::simulation::{Simulation, SimulationError, WheelState};
use crate::terrain::class::TerrainLabel;
use crate::terrain::{Terrain, TerrainSpec};
use crate::trace::truth::TruthRecorder;
use crate::trace::{RunAttributes, Trace, Truth};
use crate::wheel::Wheel;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Why an experiment left no trace.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExperimentError {
    /// The wheel's run could not begin or go on.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The sensors cannot be built at these rates.
    #[error(transparent)]
    Sensors(#[from] RangeError),
    /// An effect has nothing to edit.
    #[error(transparent)]
    Effect(#[from] EffectFault),
    /// The caller stopped it.
    #[error("stopped before its end")]
    Stopped,
}

/// An effect that a scenario cannot have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct EffectFault {
    /// Its number among the scenario's effects, from 0.
    pub index: usize,
    /// What is wrong with it.
    pub error: EffectError,
}

/// What is built: the things of a scenario, edited by its effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// The ground.
    pub terrain: TerrainSpec,
    /// The wheel.
    pub wheel: Wheel,
    /// What holds, loads and drives the wheel.
    pub rig: Rig,
    /// How the run is measured.
    pub sensors: Sensors,
}

impl Experiment {
    fn setup(&mut self) -> Setup<'_> {
        Setup {
            terrain: &mut self.terrain,
            wheel: &mut self.wheel,
            rig: &mut self.rig,
            sensors: &mut self.sensors,
        }
    }

    fn check(&self) -> Result<(), RangeError> {
        self.terrain.check()?;
        self.wheel.checked()?;
        self.rig.check()?;
        self.sensors.check()
    }
}

/// Steps between two reports of progress.
const REPORT_EVERY: u64 = 4096;

/// Distance between the points of the ground kept as truth [m].
const PROFILE_SPACING: f64 = 1.0e-3;

/// A run before it begins.
struct Made {
    experiment: Experiment,
    extensions: Extensions,
    observed: Observed,
}

impl Made {
    fn terrain(&self) -> Terrain {
        let Observed { seed, run, .. } = self.observed;
        let mut terrain = Terrain::generate(&self.experiment.terrain, seed, run);
        if let Some(heights) = &self.extensions.heights {
            terrain = terrain.with_heights(Arc::clone(heights));
        }
        if let Some(law) = &self.extensions.soil_law {
            terrain = terrain.with_soil_law(Arc::clone(law));
        }
        terrain
    }

    fn simulation(&self, terrain: &Terrain) -> Result<Simulation, SimulationError> {
        let Experiment { wheel, rig, .. } = &self.experiment;
        let lugs = self.extensions.lugs.clone();
        let rate = self.observed.physics_rate;
        let simulation = Simulation::with_lugs(lugs, terrain, wheel, rig, rate)?;
        Ok(match &self.extensions.drive {
            Some(profile) => simulation.following(Arc::clone(profile)),
            None => simulation,
        })
    }
}

impl Scenario {
    /// What is built: the scenario's things, edited by its effects in their order.
    ///
    /// # Errors
    /// `EffectFault` for the first effect that finds nothing to edit, or whose edit leaves
    /// something that cannot be.
    pub fn experiment(&self) -> Result<Experiment, EffectFault> {
        let mut experiment = Experiment {
            terrain: self.terrain.clone(),
            wheel: self.wheel,
            rig: self.rig,
            sensors: self.sensors,
        };
        for (index, effect) in self.effects.iter().enumerate() {
            effect
                .apply(&mut experiment.setup())
                .and_then(|()| Ok(experiment.check()?))
                .map_err(|error| EffectFault { index, error })?;
        }
        Ok(experiment)
    }

    /// Runs the experiment: run `run` of the series that `seed` begins.
    ///
    /// `progress` is called with the simulated time \[s\] from time to time, and may stop the run.
    ///
    /// # Errors
    /// `Simulation` where the ground does not carry the wheel or the motion is not defined,
    /// `Sensors` for rates that do not divide, `Effect` for one with nothing to edit, `Stopped` when
    /// `progress` requests it.
    pub fn run(
        &self,
        seed: Seed,
        run: u64,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Trace, ExperimentError> {
        self.run_with(Extensions::default(), seed, run, progress)
    }

    /// Runs the experiment with parts that no scenario file describes. Attributes and parameters of the trace are the
    /// scenario's.
    ///
    /// # Errors
    /// Those of [`Scenario::run`].
    pub fn run_with(
        &self,
        mut extensions: Extensions,
        seed: Seed,
        run: u64,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Trace, ExperimentError> {
        let experiment = self.experiment()?;
        let observed = self.observed(seed, run);
        let mut chain = SensorChain::new(&experiment.sensors, &observed)?;
        chain.add(std::mem::take(&mut extensions.sensors));
        let see = &mut |state: &WheelState| chain.push(state);
        let made = Made {
            experiment,
            extensions,
            observed,
        };
        let truth = self.drive(&made, progress, see)?;
        Ok(Trace {
            attributes: self.attributes(&truth, run),
            channels: chain.finish(),
            means: Vec::new(),
            truth: Some(truth),
        })
    }

    /// The motion of the run, to be measured by any sensors.
    ///
    /// # Errors
    /// Those of [`Scenario::run`].
    pub fn record(
        &self,
        seed: Seed,
        run: u64,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Recording, ExperimentError> {
        let experiment = self.experiment()?;
        let mut motion = Motion::default();
        let see = &mut |state: &WheelState| motion.push(state);
        let observed = self.observed(seed, run);
        let extensions = Extensions::default();
        let made = Made {
            experiment,
            extensions,
            observed,
        };
        let truth = self.drive(&made, progress, see)?;
        Ok(Recording {
            observed,
            attributes: self.attributes(&truth, run),
            truth,
            motion,
        })
    }

    /// A run of it, as sensors look at it.
    fn observed(&self, seed: Seed, run: u64) -> Observed {
        Observed {
            physics_rate: self.physics_rate(),
            wheel_radius: self.wheel.radius,
            seed,
            run,
        }
    }

    /// Drives the wheel along its track; `see` gets every state of the record.
    fn drive(
        &self,
        made: &Made,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
        see: &mut dyn FnMut(&WheelState),
    ) -> Result<Truth, ExperimentError> {
        let rate = made.observed.physics_rate;
        let terrain = made.terrain();
        let mut truth = TruthRecorder::new(&made.experiment.wheel, self.window());
        let mut simulation = made.simulation(&terrain)?;
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
                see(&state);
                truth.push(&state, label);
            }
            way = [way[0].min(state.position), way[1].max(state.position)];
            if step % REPORT_EVERY == 0 && progress(state.time).is_break() {
                return Err(ExperimentError::Stopped);
            }
        }
        Ok(Truth {
            parameters: terrain.parameters(),
            profile: simulation.undisturbed(
                way[0] - self.wheel.radius,
                way[1] + self.wheel.radius,
                PROFILE_SPACING,
            ),
            ..truth.finish()
        })
    }

    fn attributes(&self, truth: &Truth, run: u64) -> RunAttributes {
        let drive = self.rig.drive();
        RunAttributes {
            wheel_radius: self.wheel.radius,
            wheel_width: self.wheel.width,
            lug_count: Some(self.wheel.lug_count()),
            lug_height: self.wheel.lug_height(),
            lug_thickness: self.wheel.lugs.map(|lugs| lugs.thickness),
            wheel_mass: Some(self.wheel.mass),
            plate: None,
            slope_deg: self.rig.slope_deg(),
            load: self.rig.carried(),
            speed: drive.forward_speed,
            slip_ratio: drive.commanded_slip(self.wheel.radius),
            terrain: self.label(),
            class: truth.class(),
            repeat: u32::try_from(run).unwrap_or(u32::MAX),
            physics_rate: Some(self.physics_rate().hertz()),
            ..RunAttributes::default()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Application, Effect, Form, Stage, catalogue};

    fn short(name: &str) -> Scenario {
        let file = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let scenario = Scenario::load(file).unwrap();
        scenario
            .with_all(&["duration=0.25", "physics_rate=8000"])
            .unwrap()
    }

    fn trace(scenario: &Scenario) -> Trace {
        let go_on = &mut |_| ControlFlow::Continue(());
        scenario.run(Seed(5), 2, go_on).unwrap()
    }

    /// Every place of every effect: its name, with its channel, and its neutral value.
    fn places() -> impl Iterator<Item = (&'static Effect, String, f64)> {
        catalogue().flat_map(|effect| {
            effect.seats.iter().map(move |seat| {
                let name = [effect.name, seat.channel].join(".");
                (effect, name.trim_end_matches('.').to_owned(), seat.neutral)
            })
        })
    }

    /// A ground and what it gives without effects.
    struct Ideal {
        scenario: Scenario,
        trace: Trace,
        recording: Recording,
    }

    impl Ideal {
        fn of(name: &str) -> Self {
            let scenario = short(name);
            let go_on = &mut |_| ControlFlow::Continue(());
            Self {
                trace: trace(&scenario),
                recording: scenario.record(Seed(5), 2, go_on).unwrap(),
                scenario,
            }
        }

        /// The run with an effect; `None` where it has no meaning on this ground.
        fn with(&self, effect: &Application, stage: Stage) -> Option<Trace> {
            let edited = self.scenario.with_effect(effect).ok()?;
            Some(match stage {
                Stage::Physics => trace(&edited),
                Stage::Sensors => {
                    let experiment = edited.experiment().unwrap();
                    assert_eq!(experiment.wheel, self.scenario.wheel);
                    assert_eq!(experiment.rig, self.scenario.rig);
                    assert_eq!(experiment.terrain, self.scenario.terrain);
                    self.recording.measure(&experiment.sensors).unwrap()
                }
            })
        }
    }

    #[test]
    fn every_effect_at_its_neutral_value_changes_no_bit_of_a_run_in_either_form() {
        // Sand, and a ground with all that sand has not.
        let grounds = ["quick", "single_wheel_hgt"].map(Ideal::of);
        for (effect, name, neutral) in places() {
            let own = Application::new(&name, neutral).unwrap();
            let forms = [Some(own), own.in_form(Form::Other).ok()];
            for form in forms.into_iter().flatten() {
                let found = grounds
                    .iter()
                    .find_map(|ground| Some((ground, ground.with(&form, effect.stage)?)));
                let (ground, found) = found.unwrap();
                assert_eq!(found, ground.trace, "{name}");
            }
        }
    }

    #[test]
    fn a_recorded_motion_measured_again_is_the_direct_run_bit_by_bit() {
        let noisy = short("quick")
            .with_all(&[
                "effect.added_noise.normal_force=0.5",
                "effect.channel_delay=0.01",
                "effect.drive_vibration=0.002",
            ])
            .unwrap();
        let go_on = &mut |_| ControlFlow::Continue(());
        let recording = short("quick").record(Seed(5), 2, go_on).unwrap();
        let sensors = noisy.experiment().unwrap().sensors;
        assert_eq!(recording.measure(&sensors).unwrap(), trace(&noisy));
    }

    #[test]
    fn an_effect_stands_in_the_text_once_with_its_last_magnitude_and_form() {
        let bias = |magnitude| Application::new("bias_drift.normal_force", magnitude).unwrap();
        let scenario = short("quick").with_effect(&bias(2.0)).unwrap();
        let other = bias(-3.0).in_form(Form::Other).unwrap();
        let scenario = scenario.with_effect(&other).unwrap();
        assert_eq!(scenario.effects, [other]);
        assert_eq!(scenario.text().matches("[[effect]]").count(), 1);
        let again = Scenario::from_toml(&scenario.to_toml(), "again").unwrap();
        assert_eq!(again.effects, [other]);
        let own = again.with_effect(&bias(1.0)).unwrap();
        assert_eq!(own.effects, [bias(1.0)]);
    }

    #[test]
    fn an_effect_that_finds_nothing_to_edit_is_refused() {
        let smooth =
            short("quick").with("wheel.lugs={ count = 0, height = 0.01, thickness = 0.003 }");
        let error = smooth.unwrap().with("effect.lug_wear=0.1").unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("the effect `lug_wear` needs a wheel with lugs"),
            "{message}"
        );
    }
}
