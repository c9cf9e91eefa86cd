//! The folder of a study's results.

use super::shard::Shard;
use super::{Study, StudyError, VERSION_OF_PROGRAM};
use crate::whole_file;
use std::collections::HashSet;
use std::io;
use std::path::{Path, PathBuf};

/// The commit that the program was built from, if known at build time.
const COMMIT: Option<&str> = option_env!("LUGWHEEL_COMMIT");

/// A folder with results of one study only.
pub(super) struct Folder {
    path: PathBuf,
    fingerprint: String,
}

/// Who may have written into a folder before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Before {
    /// No study.
    NoStudy,
    /// This study.
    ThisStudy,
}

impl Folder {
    /// Makes the folder, or joins what [`Before`] allows.
    pub(super) fn open(study: &Study, path: &Path, before: Before) -> Result<Self, StudyError> {
        let folder = Self {
            path: path.to_owned(),
            fingerprint: study.fingerprint(),
        };
        let origin = folder.origin(study);
        let empty =
            whole_file::is_vacant(path).map_err(|source| file_error("read", path, source))?;
        if !empty && before == Before::NoStudy {
            let folder = path.to_owned();
            return Err(StudyError::NotEmpty { folder });
        }
        let found = std::fs::read_to_string(path.join("origin.txt"));
        if !empty && !found.is_ok_and(|found| found == origin) {
            let folder = path.to_owned();
            return Err(StudyError::OtherStudy { folder });
        }
        folder.found(study, &origin)?;
        Ok(folder)
    }

    /// Writes what does not depend on any run. The origin comes first: processes that start
    /// together recognise each other by it, and write the same.
    fn found(&self, study: &Study, origin: &str) -> Result<(), StudyError> {
        make_folder(&self.path)?;
        self.write("origin.txt", origin.as_bytes())?;
        self.make(SHARDS)?;
        self.make("scenarios")?;
        self.write("study.toml", study.text.as_bytes())?;
        for named in &study.scenarios {
            let name = format!("scenarios/{}.toml", named.name);
            self.write(&name, named.scenario.text().as_bytes())?;
        }
        for (name, text) in study.analyses.scenarios() {
            self.write(&format!("{name}.toml"), text.as_bytes())?;
        }
        Ok(())
    }

    fn origin(&self, study: &Study) -> String {
        let Self { fingerprint, .. } = self;
        let seed = study.seed.0;
        let commit = COMMIT.unwrap_or("unknown");
        format!("{VERSION_OF_PROGRAM}\ncommit {commit}\nseed {seed}\nfingerprint {fingerprint}\n")
    }

    /// A hash of all that decides the results.
    pub(super) fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// The place of a file in the folder.
    pub(super) fn path_of(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The rows of a shard for the table of this name, where they are there and whole.
    pub(super) fn rows(&self, shard: &Shard, table: &str) -> Option<String> {
        let text = std::fs::read_to_string(self.path.join(name(shard, table))).ok()?;
        shard.open(&self.fingerprint, &text).map(str::to_owned)
    }

    /// Computing times of a shard's runs as CSV lines, where they are there.
    pub(super) fn times(&self, shard: &Shard) -> Option<String> {
        std::fs::read_to_string(self.path.join(name(shard, TIMES))).ok()
    }

    /// Writes the computing times of a shard; before its rows, so that a whole shard has them.
    pub(super) fn write_times(&self, shard: &Shard, times: &str) -> Result<(), StudyError> {
        self.write(&name(shard, TIMES), times.as_bytes())
    }

    /// Writes the rows of a shard for the table of this name.
    pub(super) fn write_rows(
        &self,
        shard: &Shard,
        table: &str,
        rows: &str,
    ) -> Result<(), StudyError> {
        let sealed = shard.seal(&self.fingerprint, rows);
        self.write(&name(shard, table), sealed.as_bytes())
    }

    /// Numbers of the shards that have a file for the table of this name, whole or not.
    pub(super) fn present(&self, table: &str) -> HashSet<usize> {
        let ending = format!(".{table}.csv");
        let entries = std::fs::read_dir(self.path.join(SHARDS)).into_iter();
        let number = |entry: std::fs::DirEntry| {
            let name = entry.file_name();
            name.to_str()?.strip_suffix(&ending)?.parse().ok()
        };
        entries.flatten().flatten().filter_map(number).collect()
    }

    /// Removes what processes that were killed were writing, here and in the folders in it.
    pub(super) fn remove_abandoned_parts(&self) {
        whole_file::remove_abandoned_parts(&self.path);
        let entries = std::fs::read_dir(&self.path).into_iter().flatten();
        for entry in entries.flatten() {
            whole_file::remove_abandoned_parts(&entry.path());
        }
    }

    /// Makes a folder in this one.
    pub(super) fn make(&self, name: &str) -> Result<PathBuf, StudyError> {
        let path = self.path.join(name);
        make_folder(&path)?;
        Ok(path)
    }

    /// Writes a whole file or nothing.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        let path = self.path.join(name);
        whole_file::write(&path, bytes).map_err(|source| file_error("write", &path, source))
    }
}

/// The folder of the shards.
const SHARDS: &str = "shards";

/// What the file of computing times is named for.
const TIMES: &str = "times";

fn name(shard: &Shard, table: &str) -> String {
    format!("{SHARDS}/{:05}.{table}.csv", shard.number)
}

pub(super) fn file_error(action: &'static str, path: &Path, source: io::Error) -> StudyError {
    let path = path.to_owned();
    StudyError::File {
        action,
        path,
        source,
    }
}

fn make_folder(path: &Path) -> Result<(), StudyError> {
    std::fs::create_dir_all(path).map_err(|source| file_error("make the folder", path, source))
}
