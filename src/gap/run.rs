//! A run as it is compared.

use super::readings::Readings;
use super::statistics::Statistician;
use crate::identification::{SteadyLoad, steady_loads};
use crate::trace::{RunAttributes, Trace};

/// One run: its condition, what was read from it, and its rows for the identification.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Wheel, condition, day.
    pub attributes: RunAttributes,
    /// What was read.
    pub readings: Readings,
    /// Its steady loads; none where they were not all measured.
    pub loads: Vec<SteadyLoad>,
}

impl Run {
    /// Reads a run.
    pub fn read(statistician: &mut Statistician, trace: &Trace) -> Self {
        Self {
            attributes: trace.attributes.clone(),
            readings: statistician.read(trace),
            loads: steady_loads(trace).unwrap_or_default(),
        }
    }
}
