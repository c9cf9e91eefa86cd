//! The experiment a command runs: scenario, edits, seed.

use super::documents::{self, NoDocument, Source};
use crate::quantity::Seed;
use crate::scenario::Scenario;
use clap::Args;
use std::path::PathBuf;

/// What is simulated.
#[derive(Debug, Args)]
pub struct ScenarioArgs {
    /// Scenario file, or the name of one of `lugwheel scenarios`
    scenario: PathBuf,
    /// Set a key of the scenario, in SI units, for example rig.single_wheel.slip=0.3
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Add an effect of `lugwheel effects`, for example gain_error.drawbar_pull=0.05
    #[arg(long, value_name = "NAME=VALUE")]
    effect: Vec<String>,
    /// Seed of the random numbers; the same seed gives the same bytes
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
}

impl ScenarioArgs {
    /// Reads the scenario, with its keys set and its effects added.
    ///
    /// # Errors
    /// `NoDocument` with the names like it; `ScenarioError` for one that is none, or an edit that
    /// makes it none.
    pub fn load(&self) -> anyhow::Result<Scenario> {
        let scenario = documents::read_scenario(&self.scenario)?;
        let effects = self.effect.iter().map(|effect| format!("effect.{effect}"));
        let edits: Vec<String> = self.set.iter().cloned().chain(effects).collect();
        Ok(scenario.with_all(&edits)?)
    }

    /// Where the scenario comes from.
    ///
    /// # Errors
    /// `NoDocument` with the names like it.
    pub fn source(&self) -> Result<Source, NoDocument> {
        documents::scenario(&self.scenario)
    }

    /// The options that edit the scenario, as they would be given again.
    pub fn edits(&self) -> String {
        let set = self.set.iter().map(|set| format!(" --set {set:?}"));
        let effects = self
            .effect
            .iter()
            .map(|effect| format!(" --effect {effect:?}"));
        set.chain(effects).collect()
    }

    /// The seed.
    pub fn seed(&self) -> Seed {
        Seed(self.seed)
    }

    /// The scenario as it was asked for.
    pub fn asked(&self) -> String {
        self.scenario.display().to_string()
    }

    /// Name of the scenario without folder and ending.
    pub fn stem(&self) -> String {
        let stem = self.scenario.file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    }
}
