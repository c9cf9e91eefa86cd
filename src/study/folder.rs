//! The folder of a study's results.

use super::shard::Shard;
use super::{Study, StudyError, VERSION_OF_PROGRAM};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A folder that holds results of one study, and nothing else.
pub(super) struct Folder {
    path: PathBuf,
    fingerprint: String,
}

/// Who may have written into a folder before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Before {
    /// Nobody.
    Nobody,
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
        if is_empty(path).map_err(|source| file_error("read", path, source))? {
            folder.found(study, &origin)?;
            return Ok(folder);
        }
        if before == Before::Nobody {
            let folder = path.to_owned();
            return Err(StudyError::NotEmpty { folder });
        }
        match std::fs::read_to_string(path.join("origin.txt")) {
            Ok(found) if found == origin => Ok(folder),
            _ => Err(StudyError::OtherStudy {
                folder: path.to_owned(),
            }),
        }
    }

    /// Writes what does not depend on any run; the origin last, as it says that the rest is there.
    fn found(&self, study: &Study, origin: &str) -> Result<(), StudyError> {
        for folder in ["shards", "scenarios"] {
            let path = self.path.join(folder);
            std::fs::create_dir_all(&path).map_err(|source| file_error("make", &path, source))?;
        }
        for named in &study.scenarios {
            let name = format!("scenarios/{}.toml", named.name);
            self.write(&name, named.scenario.text().as_bytes())?;
        }
        self.write("study.toml", study.text.as_bytes())?;
        self.write("origin.txt", origin.as_bytes())
    }

    fn origin(&self, study: &Study) -> String {
        let Self { fingerprint, .. } = self;
        let seed = study.seed.0;
        format!("{VERSION_OF_PROGRAM}\nseed {seed}\nfingerprint {fingerprint}\n")
    }

    /// The rows of a shard, where it is there and whole.
    pub(super) fn rows(&self, shard: &Shard) -> Option<String> {
        let text = std::fs::read_to_string(self.path.join(rows_name(shard))).ok()?;
        shard.open(&self.fingerprint, &text).map(str::to_owned)
    }

    /// Computing times of a shard's runs as CSV lines, where they are there.
    pub(super) fn times(&self, shard: &Shard) -> Option<String> {
        std::fs::read_to_string(self.path.join(times_name(shard))).ok()
    }

    /// Writes a shard; its times first, so that a whole shard has them.
    pub(super) fn write_shard(
        &self,
        shard: &Shard,
        rows: &str,
        times: &str,
    ) -> Result<(), StudyError> {
        self.write(&times_name(shard), times.as_bytes())?;
        let sealed = shard.seal(&self.fingerprint, rows);
        self.write(&rows_name(shard), sealed.as_bytes())
    }

    /// Writes a file beside its name and gives it that name when it is whole.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        let path = self.path.join(name);
        write_whole(&path, bytes).map_err(|source| file_error("write", &path, source))
    }
}

fn rows_name(shard: &Shard) -> String {
    format!("shards/{:05}.csv", shard.number)
}

fn times_name(shard: &Shard) -> String {
    format!("shards/{:05}.times.csv", shard.number)
}

fn file_error(action: &'static str, path: &Path, source: io::Error) -> StudyError {
    let path = path.to_owned();
    StudyError::File {
        action,
        path,
        source,
    }
}

/// Whether there is nothing at `path`, or a folder with nothing in it.
fn is_empty(path: &Path) -> io::Result<bool> {
    match std::fs::read_dir(path) {
        Ok(mut entries) => Ok(entries.next().is_none()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(true),
        Err(error) => Err(error),
    }
}

fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lugwheel-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut part = builder.tempfile_in(path.parent().unwrap_or(Path::new(".")))?;
    part.write_all(bytes)?;
    part.as_file().sync_all()?;
    part.persist(path)?;
    Ok(())
}
