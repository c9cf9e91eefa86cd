//! What simulations and measurements say: statistics of each condition, as rows of numbers.

use crate::effects::Seat;
use crate::gap::{Cell, Condition, GapError};

/// Why nothing can be concluded from numbers.
#[derive(Debug, thiserror::Error)]
pub enum DiagnosisError {
    /// There is no condition.
    #[error("no condition was both measured and simulated")]
    NoCondition,
    /// Rows that do not belong together.
    #[error("{condition}: {what} has {found} numbers instead of {expected}")]
    Shape {
        /// Condition of the rows.
        condition: String,
        /// What has the wrong length.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length of everything else.
        expected: usize,
    },
    /// A number is infinite or none.
    #[error("{condition}: {what} is not finite")]
    NotFinite {
        /// Condition of the rows.
        condition: String,
        /// Which row.
        what: &'static str,
    },
    /// The replicates tell no spread.
    #[error("{condition}: {error}")]
    Replicates {
        /// Condition of the replicates.
        condition: String,
        /// Why.
        error: GapError,
    },
}

/// An effect on a seat, that may be the cause.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its name with the channel, as in files.
    pub name: String,
    /// Unit, neutral value, range and prior of its magnitude.
    pub seat: Seat,
    /// Whether the motion stays what it is: it takes no simulation to see it elsewhere.
    pub of_sensors: bool,
}

impl Candidate {
    /// Its name without the channel.
    pub fn cause(&self) -> &str {
        self.name
            .split_once('.')
            .map_or(&*self.name, |(cause, _)| cause)
    }

    /// How far a magnitude is from neutral: 0 there, and one to one. Its distance in the seat's unit;
    /// its inverse where only an infinite magnitude changes nothing, as of a filter's corner.
    pub fn strength(&self, magnitude: f64) -> f64 {
        match self.seat.neutral.is_finite() {
            true => magnitude - self.seat.neutral,
            false => 1.0 / magnitude,
        }
    }

    /// The magnitude of a strength.
    pub fn magnitude(&self, strength: f64) -> f64 {
        match self.seat.neutral.is_finite() {
            true => self.seat.neutral + strength,
            // Less than no effect is none.
            false => 1.0 / strength.max(0.0),
        }
    }

    /// Strengths of the low, the typical and the high level.
    pub fn levels(&self) -> [f64; 3] {
        self.seat.levels.map(|level| self.strength(level))
    }

    /// Strength of the typical level.
    pub fn typical(&self) -> f64 {
        let [_, typical, _] = self.levels();
        typical
    }

    /// What a strength is told as: the distance from the neutral magnitude, or the magnitude itself
    /// where the neutral one is infinite; none where it is infinite.
    pub(super) fn detectable(&self, strength: f64) -> Option<f64> {
        let told = match self.seat.neutral.is_finite() {
            true => strength,
            false => self.magnitude(strength),
        };
        (strength.is_finite() && told.is_finite()).then_some(told)
    }

    /// Prior density of a strength, per its unit.
    pub fn density(&self, strength: f64) -> f64 {
        let density = self.seat.density(self.magnitude(strength));
        match self.seat.neutral.is_finite() {
            true => density,
            false if strength == 0.0 => 0.0,
            false => density / (strength * strength),
        }
    }
}

/// Changes of the statistics by an effect of one magnitude.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Magnitude, in the seat's unit.
    pub magnitude: f64,
    /// One row a stream: statistics with the effect less those without, cell by cell.
    pub changes: Vec<Vec<f64>>,
}

/// Changes of the statistics by a parameter off the middle of its prior by `θ` standard deviations:
/// `slope θ + bend θ²`.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// One row a stream; at least one.
    pub slope: Vec<Vec<f64>>,
    /// One row a stream; none where only one way was simulated.
    pub bend: Vec<Vec<f64>>,
}

/// What a simulator says of one condition, in the cells' units.
#[derive(Debug, Clone, PartialEq)]
pub struct Responses {
    /// Which condition.
    pub condition: Condition,
    /// Slip ratio [-], load [N] and speed [m/s]; not a number where unknown.
    pub covariates: [f64; 3],
    /// The cells, in the order of every row.
    pub cells: Vec<Cell>,
    /// Size by which each cell is judged, in its unit.
    pub sizes: Vec<f64>,
    /// Replicates without effect, at the middle of the parameters.
    pub base: Vec<Vec<f64>>,
    /// What each parameter changes.
    pub parameters: Vec<Moved>,
    /// By candidate, its levels; none where the simulation of it failed.
    pub effects: Vec<Vec<Level>>,
}

/// What a simulator says of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Library {
    /// Names of the parameters that recalibration may move.
    pub parameters: Vec<String>,
    /// What may be missing.
    pub candidates: Vec<Candidate>,
    /// Condition by condition. Statistics of the campaign as a whole are not among them: they hold
    /// every condition, so none could be held out.
    pub conditions: Vec<Responses>,
}

/// Measured runs of one condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// One row a run, in the order of the library's cells and in their units.
    pub runs: Vec<Vec<f64>>,
    /// Day of each run; runs of one day and condition belong together.
    pub days: Vec<String>,
}

impl Responses {
    /// # Errors
    /// `Shape` and `NotFinite` for rows that do not fit together.
    pub(super) fn check(&self, library: &Library) -> Result<(), DiagnosisError> {
        let cells = self.cells.len();
        self.expect("the sizes", self.sizes.len(), cells)?;
        self.expect(
            "the parameters",
            self.parameters.len(),
            library.parameters.len(),
        )?;
        self.expect("the effects", self.effects.len(), library.candidates.len())?;
        self.rows("a replicate", &self.base)?;
        for moved in &self.parameters {
            self.rows("a parameter's change", &moved.slope)?;
            self.rows("a parameter's change", &moved.bend)?;
        }
        for level in self.effects.iter().flatten() {
            self.rows("an effect's change", &level.changes)?;
        }
        Ok(())
    }

    pub(super) fn rows(&self, what: &'static str, rows: &[Vec<f64>]) -> Result<(), DiagnosisError> {
        for row in rows {
            self.expect(what, row.len(), self.cells.len())?;
            if !row.iter().all(|value| value.is_finite()) {
                let condition = self.condition.to_string();
                return Err(DiagnosisError::NotFinite { condition, what });
            }
        }
        Ok(())
    }

    fn expect(
        &self,
        what: &'static str,
        found: usize,
        expected: usize,
    ) -> Result<(), DiagnosisError> {
        if found == expected {
            return Ok(());
        }
        Err(DiagnosisError::Shape {
            condition: self.condition.to_string(),
            what,
            found,
            expected,
        })
    }
}
