//! What a plan has to simulate, in numbers that do not depend on the machine.

use super::condition::Case;
use serde::Serialize;
use std::fmt;
use std::ops::AddAssign;

/// What is to be simulated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Cost {
    /// Motions to be simulated: what takes the time.
    pub motions: u64,
    /// Times that one is measured and read.
    pub measurements: u64,
    /// Length of all motions [s].
    pub driven: f64,
}

impl Cost {
    /// Motions of a case, measured so often in all.
    pub(super) fn of(case: &Case, motions: u64, measurements: u64) -> Self {
        Self {
            motions,
            measurements,
            driven: motions as f64 * case.scenario.driven(),
        }
    }
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.motions += other.motions;
        self.measurements += other.measurements;
        self.driven += other.driven;
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            motions,
            measurements,
            driven,
        } = self;
        write!(
            f,
            "{measurements} runs of {motions} motions, {driven:.0} s of driving"
        )
    }
}
