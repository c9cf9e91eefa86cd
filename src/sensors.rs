//! The sensor chain's settings.

use crate::quantity::{RangeError, SampleRate};
use serde::{Deserialize, Serialize};

/// How the run is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sensors {
    /// Rate [Hz] at which the sensors sample.
    pub rate: SampleRate,
    /// Rate [Hz] of the channels in the run file.
    pub output_rate: SampleRate,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            rate: SampleRate::REFERENCE,
            output_rate: SampleRate::new(2000.0).expect("2000 Hz is a rate"),
        }
    }
}

impl Sensors {
    /// # Errors
    /// `RangeError` when the output rate does not divide the sensor rate.
    pub fn check(&self) -> Result<(), RangeError> {
        if self.rate.whole().is_multiple_of(self.output_rate.whole()) {
            return Ok(());
        }
        Err(RangeError {
            quantity: "output rate",
            unit: "Hz",
            range: format!("a divisor of the sensor rate {} Hz", self.rate.whole()),
            value: self.output_rate.hertz(),
        })
    }
}
