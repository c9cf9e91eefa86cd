//! Which run would tell two explanations apart.
//!
//! Of two effects the second, at the magnitude that mimics the first best, leaves the χ²
//! `dᵀ P d (1 − cos²)`. Every run that could be made adds its own part to the products: the run
//! that leaves most decides best.

use super::emulator::{Emulated, Emulator};
use super::responses::{DiagnosisError, Library};
use super::screen::{Projected, Screen};
use serde::Serialize;

/// Runs that could be made, simulated: in reverse, at a second load, at a second speed and the
/// same slip, with a smooth wheel, with the wheel lifted.
#[derive(Debug, Default)]
pub struct FurtherRuns {
    runs: Vec<(String, Emulated)>,
}

/// A run to make.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextRun {
    /// What it is.
    pub run: String,
    /// What it tells apart.
    pub between: [String; 2],
    /// Cosine [-] of the projected signatures without and with it.
    pub cosine: [f64; 2],
    /// Deviations between the two without and with it [-].
    pub deviations: [f64; 2],
}

impl FurtherRuns {
    /// Runs with a name each, in a library of the same parameters and candidates.
    ///
    /// # Errors
    /// Those of [`Emulator::new`]; no error where there are none.
    pub fn new(names: Vec<String>, library: &Library) -> Result<Self, DiagnosisError> {
        if names.is_empty() {
            return Ok(Self::default());
        }
        let emulated = Emulator::new(library)?.conditions;
        Ok(Self {
            runs: names.into_iter().zip(emulated).collect(),
        })
    }

    /// The run that tells the first of two candidates, as many typical levels strong as it was
    /// estimated, from the second best.
    pub(super) fn between(
        &self,
        emulator: &Emulator,
        screen: &Screen,
        [a, b]: [usize; 2],
        strength: f64,
    ) -> Option<NextRun> {
        let apart = |projected: &Projected| {
            let square = projected.products[(a, a)].max(0.0) * strength * strength;
            let cosine = projected.cosine(a, b);
            (
                cosine,
                libm::sqrt(square * (1.0 - cosine * cosine).max(0.0)),
            )
        };
        let before = apart(&screen.projected());
        let tried = self
            .runs
            .iter()
            .map(|(name, emulated)| (name, apart(&screen.with(emulated).projected())));
        let (name, after) = tried.max_by(|x, y| x.1.1.total_cmp(&y.1.1))?;
        Some(NextRun {
            run: name.clone(),
            between: [a, b].map(|number| emulator.candidates[number].name.clone()),
            cosine: [before.0, after.0],
            deviations: [before.1, after.1],
        })
    }
}
