//! Scenarios, studies and designs of blind trials that are part of the program.
//!
//! Their files stand in `scenarios/`; the library embeds them, so that a program finds them by name wherever it
//! runs. A study names its scenarios by path, as in `../single_wheel_st.toml`: [`scenario_at`] maps such a path to the
//! ready scenario.
//!
//! ```
//! use lugwheel::scenario::{Scenario, ready};
//!
//! let sand = ready::scenario("single_wheel_st").unwrap();
//! assert_eq!(sand.summary(), "The single-wheel test bed on sandy terrain (ST).");
//! assert_eq!(Scenario::ready(sand)?.duration, 15.0);
//! # Ok::<(), lugwheel::scenario::ScenarioError>(())
//! ```

use std::path::Path;

/// A TOML document that is part of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadyDocument {
    /// Name of its file without folder and ending.
    pub name: &'static str,
    /// The file's text.
    pub text: &'static str,
}

/// The documents of these names in a folder.
macro_rules! documents {
    ($folder:literal: $($name:literal)*) => {
        &[$(ReadyDocument {
            name: $name,
            text: include_str!(concat!("../../", $folder, "/", $name, ".toml")),
        }),*]
    };
}

const SCENARIOS: &[ReadyDocument] = documents!("scenarios":
    "quick"
    "rover_gt" "rover_ht" "rover_ref" "rover_st"
    "single_wheel_gt" "single_wheel_hgt" "single_wheel_ht" "single_wheel_ref" "single_wheel_sgt" "single_wheel_st"
    "traverse"
);

const STUDIES: &[ReadyDocument] = documents!("scenarios/studies":
    "computed_reference"
    "convergence_fixed" "convergence_gravel"
    "dataset"
    "diagnose_slip_sinkage"
    "figure20" "figures25_27"
    "identify_load" "identify_lugs" "identify_own" "identify_own_lugs" "identify_own_speed" "identify_soil"
    "identify_speed" "identify_tips" "identify_vision"
    "quick"
    "sweep_load" "sweep_lug_height" "sweep_lugs" "sweep_noise" "sweep_roughness" "sweep_scattered_hard"
    "sweep_scattered_sand" "sweep_slip" "sweep_speed" "sweep_stones" "sweep_window"
    "table3" "table5" "table6"
    "thresholds"
);

#[cfg(feature = "study")]
const CHALLENGE: &[ReadyDocument] = documents!("scenarios/challenge":
    "gravel" "hard" "magnitudes" "sand"
);

/// Folders that a path to a ready scenario may have: none, that of the repository, and the one above a study's.
const FOLDERS: [&str; 4] = ["", ".", "scenarios", ".."];

impl ReadyDocument {
    /// What it is: the first line of its leading comment.
    pub fn summary(&self) -> &str {
        let first = self.text.lines().next().unwrap_or_default();
        first.trim_start_matches('#').trim()
    }
}

/// The ready scenarios, by name.
pub fn scenarios() -> &'static [ReadyDocument] {
    SCENARIOS
}

/// The ready scenario of this name.
pub fn scenario(name: &str) -> Option<&'static ReadyDocument> {
    named(SCENARIOS, name)
}

/// The ready scenario that a path stands for: `NAME` or `NAME.toml`, alone or in the folder `scenarios` or `..`.
pub fn scenario_at(path: &Path) -> Option<&'static ReadyDocument> {
    let folder = path.parent()?.to_str()?;
    let name = path.file_name()?.to_str()?;
    let is_ready = FOLDERS.contains(&folder);
    is_ready.then(|| scenario(name.strip_suffix(".toml").unwrap_or(name)))?
}

/// The ready studies, by name.
pub fn studies() -> &'static [ReadyDocument] {
    STUDIES
}

/// The ready study of this name.
pub fn study(name: &str) -> Option<&'static ReadyDocument> {
    named(STUDIES, name)
}

/// What blind trials are made of: a design of each ground, and the table of magnitudes.
#[cfg(feature = "study")]
pub(crate) fn challenge(name: &str) -> Option<&'static ReadyDocument> {
    named(CHALLENGE, name)
}

fn named(documents: &'static [ReadyDocument], name: &str) -> Option<&'static ReadyDocument> {
    documents.iter().find(|document| document.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn every_file_of_the_folders_is_part_of_the_program() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        for (folder, documents) in [
            ("scenarios", SCENARIOS),
            ("scenarios/studies", STUDIES),
            ("scenarios/challenge", CHALLENGE),
        ] {
            let files = fs::read_dir(root.join(folder)).unwrap();
            let paths = files.map(|file| file.unwrap().path());
            let mut tomls: Vec<_> = paths.filter(|path| path.is_file()).collect();
            tomls.sort();
            let names: Vec<&str> = tomls
                .iter()
                .map(|path| path.file_stem().unwrap().to_str().unwrap())
                .collect();
            let embedded: Vec<&str> = documents.iter().map(|document| document.name).collect();
            assert_eq!(embedded, names, "{folder}");
            for (document, path) in documents.iter().zip(&tomls) {
                assert_eq!(document.text, fs::read_to_string(path).unwrap());
            }
        }
    }

    #[test]
    fn a_path_in_another_folder_is_not_a_ready_scenario() {
        for path in [
            "quick",
            "quick.toml",
            "./quick.toml",
            "scenarios/quick.toml",
            "../quick.toml",
        ] {
            let found = scenario_at(Path::new(path));
            assert_eq!(found.map(|document| document.name), Some("quick"), "{path}");
        }
        for path in ["rigs/quick.toml", "/quick.toml", "quick.h5", "", ".."] {
            assert_eq!(scenario_at(Path::new(path)), None, "{path}");
        }
    }

    #[test]
    fn every_scenario_and_study_says_what_it_is_in_its_first_line() {
        for document in [SCENARIOS, STUDIES].concat() {
            assert!(document.text.starts_with("# "), "{}", document.name);
            assert!(
                document.summary().ends_with('.'),
                "{}: {}",
                document.name,
                document.summary()
            );
        }
    }
}
