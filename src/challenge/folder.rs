//! The folder of a trial.
//!
//! ```text
//! campaigns/   what is published: manifest.json, <ground>.toml, <case>.h5
//! truth/       what is not: order.json, oracle_<ground>.bin, <case>.json, failed.txt
//! answers/     <case>.json, <case>.seconds, <case>.failed.txt, origin.txt
//! ```

use super::ChallengeError;
use super::truth::{Truth, sha256};
use crate::whole_file;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// Value of `format` in a manifest.
const FORMAT: &str = "lugwheel-challenge";
/// The version of the manifest: since 2 scenarios have their hash.
const FORMAT_VERSION: u32 = 2;

/// Which program wrote or answered.
pub(super) const PROGRAM: &str = concat!("lugwheel ", env!("CARGO_PKG_VERSION"));

/// A case as it is published.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Posed {
    /// Its name.
    pub case: String,
    /// Its run file.
    pub file: String,
    /// SHA-256 of that.
    pub sha256: String,
    /// The scenario that it is to be compared with.
    pub scenario: String,
    /// SHA-256 of that.
    pub scenario_sha256: String,
    /// Effects that the diagnosis is to do without. That a case has such an order shows its
    /// question to who reads the manifest; the diagnosis gets the order alone.
    pub without: Vec<String>,
    /// SHA-256 of the truth's file, with its salt.
    pub seal: String,
}

/// What is published of a trial.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    format: String,
    format_version: u32,
    created_by: String,
    /// The cases in the order of their names.
    pub cases: Vec<Posed>,
}

impl Manifest {
    pub(super) fn new(cases: Vec<Posed>) -> Self {
        Self {
            format: FORMAT.to_owned(),
            format_version: FORMAT_VERSION,
            created_by: PROGRAM.to_owned(),
            cases,
        }
    }
}

/// The published part of a trial, the only input of a diagnosis.
#[derive(Debug)]
pub(super) struct Campaigns {
    path: PathBuf,
    pub(super) manifest: Manifest,
    /// SHA-256 of the manifest's file.
    pub(super) sha256: String,
}

impl Campaigns {
    /// # Errors
    /// `File` where there is no manifest, `Content` where it is none.
    pub(super) fn open(folder: &Path) -> Result<Self, ChallengeError> {
        let path = campaigns(folder);
        let file = path.join("manifest.json");
        let text = read(&file)?;
        let manifest: Manifest = parsed(&file, &text)?;
        let known = [FORMAT, &FORMAT_VERSION.to_string()];
        let found = [&manifest.format, &manifest.format_version.to_string()];
        if known != found {
            let reason = format!(
                "expected {} {}, found {} {}",
                known[0], known[1], found[0], found[1]
            );
            return Err(ChallengeError::Content { path: file, reason });
        }
        Ok(Self {
            path,
            manifest,
            sha256: sha256(text.as_bytes()),
        })
    }

    pub(super) fn path_of(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// # Errors
    /// `CampaignAltered` where a case's run file or scenario is not the one published; `File`.
    pub(super) fn check(&self, posed: &Posed) -> Result<(), ChallengeError> {
        let published = [
            (&posed.file, &posed.sha256),
            (&posed.scenario, &posed.scenario_sha256),
        ];
        for (name, published) in published {
            let path = self.path_of(name);
            let bytes = std::fs::read(&path).map_err(|source| unreadable(&path, source))?;
            if sha256(&bytes) != *published {
                return Err(ChallengeError::CampaignAltered(path));
            }
        }
        Ok(())
    }
}

/// The truth of a case, as it was sealed.
///
/// # Errors
/// `File` where there is none, `TruthAltered` where it is another.
pub(super) fn unsealed(folder: &Path, posed: &Posed) -> Result<Truth, ChallengeError> {
    let text = read(&truth(folder).join(format!("{}.json", posed.case)))?;
    let truth = Truth::open(&text, &posed.seal).filter(|truth| truth.case == posed.case);
    truth.ok_or_else(|| ChallengeError::TruthAltered(posed.case.clone()))
}

pub(super) fn campaigns(folder: &Path) -> PathBuf {
    folder.join("campaigns")
}

pub(super) fn truth(folder: &Path) -> PathBuf {
    folder.join("truth")
}

pub(super) fn answers(folder: &Path) -> PathBuf {
    folder.join("answers")
}

/// Whether there is nothing at `path`, or an empty folder.
pub(super) fn is_empty(path: &Path) -> Result<bool, ChallengeError> {
    whole_file::is_vacant(path).map_err(|source| unreadable(path, source))
}

pub(super) fn make_folder(path: &Path) -> Result<(), ChallengeError> {
    std::fs::create_dir_all(path).map_err(|source| file_error("make the folder", path, source))
}

pub(super) fn read(path: &Path) -> Result<String, ChallengeError> {
    std::fs::read_to_string(path).map_err(|source| unreadable(path, source))
}

/// Writes a whole file or none.
pub(super) fn write(path: &Path, text: &str) -> Result<(), ChallengeError> {
    whole_file::write(path, text.as_bytes()).map_err(|source| file_error("write", path, source))
}

/// Refuses a folder that cannot be written to, before any work.
pub(super) fn check_room(path: &Path) -> Result<(), ChallengeError> {
    whole_file::check_room(path).map_err(|source| file_error("write in the folder", path, source))
}

/// Parses a JSON file.
pub(super) fn parsed<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, ChallengeError> {
    serde_json::from_str(text).map_err(|error| ChallengeError::Content {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

pub(super) fn as_json(value: &impl Serialize) -> String {
    let text = serde_json::to_string_pretty(value).expect("names and finite numbers");
    text + "\n"
}

pub(super) fn unreadable(path: &Path, source: io::Error) -> ChallengeError {
    ChallengeError::Unreadable {
        path: path.to_owned(),
        source,
    }
}

pub(super) fn file_error(action: &'static str, path: &Path, source: io::Error) -> ChallengeError {
    ChallengeError::File {
        action,
        path: path.to_owned(),
        source,
    }
}
