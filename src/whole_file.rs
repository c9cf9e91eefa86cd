//! Files that are whole or not there.
//!
//! A file grows beside its target and takes the target's name when it is complete. What bore that
//! name before stays until then; a writer that fails or is dropped leaves nothing, one that is
//! killed leaves a *part*, whose name says so.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// How the name of a part begins.
const PREFIX: &str = ".lugwheel-";

/// A file that will take its target's name.
#[derive(Debug)]
pub struct WholeFile {
    target: PathBuf,
    part: NamedTempFile,
}

impl WholeFile {
    /// An empty file beside `target`, with the permissions of any new file.
    ///
    /// # Errors
    /// Where the target is a folder, or its folder does not exist or cannot be written to.
    pub fn begin(target: &Path) -> io::Result<Self> {
        if target.is_dir() {
            return Err(io::Error::new(
                io::ErrorKind::IsADirectory,
                "it is a folder",
            ));
        }
        let folder = match target.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(".part");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let part = builder.tempfile_in(folder).map_err(without_the_part)?;
        let target = target.to_owned();
        Ok(Self { target, part })
    }

    /// The file as long as it is a part.
    pub fn part(&self) -> &Path {
        self.part.path()
    }

    /// Gives the file its name, once all of it is on the disk.
    ///
    /// # Errors
    /// Where the disk is full or the name cannot be taken.
    pub fn finish(self) -> io::Result<()> {
        self.part.as_file().sync_all()?;
        let named = self.part.persist(&self.target);
        named.map_err(|error| without_the_part(error.error))?;
        Ok(())
    }
}

/// Writes all of a file.
///
/// # Errors
/// Those of [`WholeFile::begin`] and [`WholeFile::finish`].
pub fn write(target: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = WholeFile::begin(target)?;
    // Tells a part that grows from one whose writer was killed. Some file systems know no locks;
    // there such parts stay.
    let _ = file.part.as_file().lock();
    file.part.write_all(bytes).map_err(without_the_part)?;
    file.finish()
}

/// Whether a file of this name is a part.
pub fn is_part(name: &OsStr) -> bool {
    name.to_string_lossy().starts_with(PREFIX)
}

/// Removes the parts in `folder` that nobody writes any more, as far as can be told: those that
/// [`write`](write()) began and whose writer was killed. What cannot be removed stays.
pub fn remove_abandoned_parts(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| is_part(&entry.file_name())) {
        let path = entry.path();
        let file = File::options().write(true).open(&path);
        if file.is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_file(path);
        }
    }
}

/// The error without the path of a part, which says nothing to anybody.
fn without_the_part(error: io::Error) -> io::Error {
    let message = error.to_string();
    match message.split_once(" at path") {
        Some((reason, _)) => io::Error::new(error.kind(), reason.to_owned()),
        None => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect()
    }

    #[test]
    fn what_was_there_stays_until_the_new_file_is_whole_and_if_it_never_is() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.csv");
        write(&target, b"old").unwrap();
        let file = WholeFile::begin(&target).unwrap();
        fs::write(file.part(), b"half").unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"old");
        drop(file);
        assert_eq!(names(folder.path()), ["a.csv"]);
        let file = WholeFile::begin(&target).unwrap();
        fs::write(file.part(), b"new").unwrap();
        file.finish().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.csv"]);
    }

    #[test]
    fn only_parts_without_a_writer_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at(".lugwheel-killed.part"), b"half").unwrap();
        fs::write(at("other"), b"whole").unwrap();
        let held = WholeFile::begin(&at("held")).unwrap();
        held.part.as_file().lock().unwrap();
        remove_abandoned_parts(folder.path());
        let mut left = names(folder.path());
        left.sort();
        assert_eq!(left.len(), 2, "{left:?}");
        assert!(held.part().exists() && left[1] == "other");
    }

    #[test]
    fn an_error_names_its_reason_and_not_the_part() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("none/a.csv");
        let error = write(&missing, b"").unwrap_err().to_string();
        assert_eq!(error, "No such file or directory (os error 2)");
        let error = write(folder.path(), b"").unwrap_err().to_string();
        assert_eq!(error, "it is a folder");
    }
}
