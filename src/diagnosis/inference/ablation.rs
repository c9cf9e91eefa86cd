//! The model without one of its parts, for measuring what the part is worth.

use std::fmt;
use std::str::FromStr;

/// A part that is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ablation {
    /// The trained weights of evidence and votes: the probability of a cause is its evidence times its base rate. The
    /// weights of `unknown` and of pairs stay.
    TrainedWeights,
    /// Correlations between statistics: the covariance is diagonal, as a shrinkage to the identity makes it.
    Correlations,
    /// The emulator's own error: residuals are those of the rigs that it was fitted to.
    EmulatorError,
}

impl Ablation {
    /// All of them.
    pub const ALL: [Self; 3] = [
        Self::TrainedWeights,
        Self::Correlations,
        Self::EmulatorError,
    ];

    /// Its name in the command.
    pub fn name(self) -> &'static str {
        match self {
            Self::TrainedWeights => "trained_weights",
            Self::Correlations => "correlations",
            Self::EmulatorError => "emulator_error",
        }
    }
}

impl fmt::Display for Ablation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Ablation {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|it| it.name() == text)
            .ok_or_else(|| {
                let names = Self::ALL.map(Self::name).join(", ");
                format!("the model has the parts {names}")
            })
    }
}
