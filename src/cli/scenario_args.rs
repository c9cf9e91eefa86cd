//! The experiment a command runs: scenario, edits, seed.

use crate::quantity::Seed;
use crate::scenario::Scenario;
use crate::study::Study;
use clap::Args;
use std::fs;
use std::path::{Path, PathBuf};

/// Documents that are found by their name.
#[derive(Debug, Clone, Copy)]
pub struct Ready {
    kind: &'static str,
    /// Folder in which one is looked for.
    folder: &'static str,
}

const SCENARIOS: Ready = Ready {
    kind: "scenario",
    folder: "scenarios",
};

const STUDIES: Ready = Ready {
    kind: "study",
    folder: "scenarios/studies",
};

/// How alike [0 to 1] two names are that one may have meant for the other.
const ALIKE: f64 = 0.8;

/// What is simulated.
#[derive(Debug, Args)]
pub struct ScenarioArgs {
    /// Scenario file, or the name of one in scenarios/
    scenario: PathBuf,
    /// Set a key of the scenario, in SI units, for example rig.single_wheel.slip=0.3
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Add an effect of `lugwheel effects`, for example gain_error.drawbar_pull=0.05
    #[arg(long, value_name = "NAME=VALUE")]
    effect: Vec<String>,
    /// Seed of all randomness; the same seed gives the same bytes
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
}

/// There is no such scenario or study.
#[derive(Debug, thiserror::Error)]
pub enum NoDocument {
    /// Nothing has the name.
    #[error("there is no {} {}, as a file or in {}/{hint}", ready.kind, asked.display(), ready.folder)]
    Missing {
        ready: Ready,
        asked: PathBuf,
        hint: String,
    },
    /// The file asks for many runs.
    #[error("{} is a study, no scenario; `lugwheel study {}` runs it", .0.display(), .0.display())]
    Study(PathBuf),
}

impl ScenarioArgs {
    /// Reads the scenario, with its keys set and its effects added.
    ///
    /// # Errors
    /// `NoDocument` with the names like it; `ScenarioError` for one that is none, or an edit that
    /// makes it none.
    pub fn load(&self) -> anyhow::Result<Scenario> {
        let scenario = read(&self.scenario)?;
        let effects = self.effect.iter().map(|effect| format!("effect.{effect}"));
        let edits: Vec<String> = self.set.iter().cloned().chain(effects).collect();
        Ok(scenario.with_all(&edits)?)
    }

    /// The file that the scenario is read from.
    ///
    /// # Errors
    /// `NoDocument` with the names like it.
    pub fn file(&self) -> Result<PathBuf, NoDocument> {
        found(&self.scenario)
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

/// The scenario of a file, or the one of that name in the folder of scenarios.
///
/// # Errors
/// `NoDocument` with the names like it, or for a study; `ScenarioError` for a text that is none.
pub fn read(asked: &Path) -> anyhow::Result<Scenario> {
    let path = found(asked)?;
    Scenario::load(&path).map_err(|error| match Study::load(&path) {
        Ok(_) => NoDocument::Study(path).into(),
        Err(_) => error.into(),
    })
}

/// The scenario file, or the one of that name in the folder of scenarios.
///
/// # Errors
/// `NoDocument` with the names like it.
pub fn found(asked: &Path) -> Result<PathBuf, NoDocument> {
    SCENARIOS.found(asked)
}

/// The study file, or the one of that name in the folder of studies.
///
/// # Errors
/// `NoDocument` with the names like it.
pub fn found_study(asked: &Path) -> Result<PathBuf, NoDocument> {
    STUDIES.found(asked)
}

impl Ready {
    /// The file asked for, or the one of that name in the folder.
    fn found(self, asked: &Path) -> Result<PathBuf, NoDocument> {
        if asked.exists() {
            return Ok(asked.to_owned());
        }
        let by_name = Path::new(self.folder).join(asked).with_extension("toml");
        if by_name.is_file() {
            return Ok(by_name);
        }
        Err(NoDocument::Missing {
            ready: self,
            asked: asked.to_owned(),
            hint: hint(asked, &names(self.folder)),
        })
    }
}

/// Names of the documents in `folder`, in the order of their letters.
fn names(folder: &str) -> Vec<String> {
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    let tomls = files
        .map(|file| file.path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    let mut names: Vec<String> = tomls
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

/// The names like the one asked for; all where none is.
fn hint(asked: &Path, names: &[String]) -> String {
    let asked = asked.file_stem().unwrap_or_default().to_string_lossy();
    let likeness = |name: &str| strsim::jaro_winkler(&asked, name);
    let mut near: Vec<&str> = names
        .iter()
        .map(String::as_str)
        .filter(|name| likeness(name) >= ALIKE)
        .collect();
    near.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
    near.truncate(3);
    match (near.is_empty(), names.is_empty()) {
        (false, _) => format!("; did you mean {}?", near.join(", ")),
        (true, false) => format!("; there are {}", names.join(", ")),
        (true, true) => ", which does not exist here or is empty".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_typo_is_answered_with_the_names_like_it_and_nonsense_with_all() {
        let names = ["quick", "rover_ht", "single_wheel_gt", "single_wheel_ht"].map(str::to_owned);
        let typo = hint(Path::new("singel_wheel_ht.toml"), &names);
        assert_eq!(typo, "; did you mean single_wheel_ht, single_wheel_gt?");
        let nonsense = hint(Path::new("zzz"), &names);
        assert!(
            nonsense.contains("quick, rover_ht, single_wheel_gt"),
            "{nonsense}"
        );
    }
}
