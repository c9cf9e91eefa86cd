//! One motion, measured as often as need be.
//!
//! Most of the time of a run goes into the motion. An effect that edits the sensors only
//! ([`crate::effects::Stage::Sensors`]) leaves it alone: record it once, and measure it with each
//! set of sensors. What the sensors look at takes 88 bytes a step, 1.4 MB a second at 16 kHz.

use crate::quantity::RangeError;
use crate::sensors::linear_chain::LinearChain;
use crate::sensors::{Observed, SensorChain, Sensors};
use crate::simulation::{Loads, WheelState};
use crate::trace::{Channel, RunAttributes, Trace, Truth};

/// All that sensors look at in a state.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sight {
    time: f64,
    position: f64,
    wheel_angle: f64,
    wheel_speed: f64,
    forward_speed: f64,
    forward_acceleration: f64,
    vertical_acceleration: f64,
    hub: Loads,
    sinkage: f64,
}

/// The motion of one run, kept to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    pub(super) observed: Observed,
    pub(super) attributes: RunAttributes,
    pub(super) truth: Truth,
    pub(super) motion: Motion,
}

/// States on their way into a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Motion(Vec<Sight>);

impl Motion {
    pub(super) fn push(&mut self, state: &WheelState) {
        self.0.push(Sight {
            time: state.time,
            position: state.position,
            wheel_angle: state.wheel_angle,
            wheel_speed: state.wheel_speed,
            forward_speed: state.forward_speed,
            forward_acceleration: state.forward_acceleration,
            vertical_acceleration: state.vertical_acceleration,
            hub: state.hub,
            sinkage: state.sinkage,
        });
    }
}

impl Recording {
    /// The trace that these sensors make of the motion, bit by bit that of a run with them.
    ///
    /// # Errors
    /// `RangeError` for sensors that cannot be, or a rate that does not divide.
    pub fn measure(&self, sensors: &Sensors) -> Result<Trace, RangeError> {
        let mut chain = SensorChain::new(sensors, &self.observed)?;
        self.states().for_each(|state| chain.push(&state));
        Ok(self.trace(chain.finish()))
    }

    /// The motion ready to be measured many times by sensors at the rates of `sensors`.
    ///
    /// # Errors
    /// `RangeError` for a rate that does not divide.
    pub fn for_many(&self, sensors: &Sensors) -> Result<Remeasured<'_>, RangeError> {
        let chain = LinearChain::new(self.states(), self.observed, sensors)?;
        Ok(Remeasured {
            recording: self,
            chain,
        })
    }

    fn states(&self) -> impl Iterator<Item = WheelState> + Clone {
        self.motion.0.iter().map(Sight::state)
    }

    fn trace(&self, channels: Vec<Channel>) -> Trace {
        Trace {
            attributes: self.attributes.clone(),
            channels,
            means: Vec::new(),
            truth: Some(self.truth.clone()),
        }
    }
}

/// A motion that is measured many times, by [`LinearChain`].
pub struct Remeasured<'r> {
    recording: &'r Recording,
    chain: LinearChain,
}

impl Remeasured<'_> {
    /// The trace that these sensors make of the motion: that of [`Recording::measure`] within the errors that
    /// [`crate::sensors::linear_chain`] states, with other draws of noise.
    ///
    /// # Errors
    /// `RangeError` for sensors that cannot be.
    pub fn measure(&self, sensors: &Sensors) -> Result<Trace, RangeError> {
        let channels = self.chain.read(sensors, self.recording.states())?;
        Ok(self.recording.trace(channels))
    }
}

impl Sight {
    fn state(&self) -> WheelState {
        WheelState {
            time: self.time,
            position: self.position,
            wheel_angle: self.wheel_angle,
            wheel_speed: self.wheel_speed,
            forward_speed: self.forward_speed,
            forward_acceleration: self.forward_acceleration,
            vertical_acceleration: self.vertical_acceleration,
            hub: self.hub,
            sinkage: self.sinkage,
            ..WheelState::default()
        }
    }
}
