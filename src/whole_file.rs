//! Files that are either complete or absent.
//!
//! A file is written beside its target and renamed to it when complete. An existing target is not replaced
//! before; a writer that fails or is dropped leaves no file, one that is killed leaves a *part*, recognisable
//! by its name:
//!
//! ```text
//! .lugwheel-8GkB2x.part    what is there of the file, locked by its writer
//! .lugwheel-8GkB2x.lock    locked in its place where a library writes it that has locks of its own
//! ```
//!
//! The system releases the lock when the writer dies, however it dies. The first part that a process
//! begins in a folder removes those there that are not locked. On file systems without locks
//! they stay; where locks hold on one machine only, other machines must not write into the folder.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::{NamedTempFile, TempPath};

/// How the name of a part and of its lock begins.
const PREFIX: &str = ".lugwheel-";

/// How the name of a part ends, and that of a lock.
const ENDINGS: [&str; 2] = [".part", ".lock"];

/// Bytes that a folder takes before a result is begun there: any result is longer.
const PROBE: usize = 4096;

/// A file that a library writes under the name of its [`part`](Self::part), and that will take its
/// target's name.
#[derive(Debug)]
pub struct WholeFile {
    target: PathBuf,
    /// Removed before the lock: fields drop in order.
    part: TempPath,
    _lock: Locked,
}

impl WholeFile {
    /// Room for a file beside `target`; there is none yet under the name of its part.
    ///
    /// # Errors
    /// Where the target is a folder, or its folder does not exist or cannot be written to.
    pub fn begin(target: &Path) -> io::Result<Self> {
        let lock = Locked::create(folder_of(target)?, ENDINGS[1])?;
        let part = lock.0.path().with_extension(&ENDINGS[0][1..]);
        Ok(Self {
            target: target.to_owned(),
            part: TempPath::try_from_path(part)?,
            _lock: lock,
        })
    }

    /// The file as long as it is a part.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Gives the file its name, once all of it is on the disk.
    ///
    /// # Errors
    /// Where the disk is full or the name cannot be taken.
    pub fn finish(self) -> io::Result<()> {
        File::open(&self.part)?.sync_all()?;
        let named = self.part.persist(&self.target);
        named.map_err(|error| without_the_part(error.error))
    }
}

/// Writes all of a file, and waits until it is on the disk.
///
/// # Errors
/// Where the target is a folder, its folder does not exist or cannot be written to, the disk is full
/// or the name cannot be taken.
pub fn write(target: &Path, bytes: &[u8]) -> io::Result<()> {
    let part = written(target, bytes)?;
    part.as_file().sync_all()?;
    name(part, target)
}

/// Writes all of a file without waiting for the disk: what a crash of the system tears, its reader has
/// to find.
///
/// # Errors
/// Those of [`write`](write()).
pub fn write_unsynced(target: &Path, bytes: &[u8]) -> io::Result<()> {
    name(written(target, bytes)?, target)
}

fn written(target: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let Locked(mut part) = Locked::create(folder_of(target)?, ENDINGS[0])?;
    part.write_all(bytes).map_err(without_the_part)?;
    Ok(part)
}

fn name(part: NamedTempFile, target: &Path) -> io::Result<()> {
    let named = part.persist(target);
    named.map_err(|error| without_the_part(error.error))?;
    Ok(())
}

/// Checks that `folder` accepts a file of a few kilobytes, which is then removed.
///
/// # Errors
/// Where the folder does not exist or cannot be written to, or the disk is full.
pub fn check_room(folder: &Path) -> io::Result<()> {
    let Locked(mut part) = Locked::create(folder, ENDINGS[0])?;
    part.write_all(&[0; PROBE]).map_err(without_the_part)
}

/// Whether a file of this name is a part or its lock.
pub fn is_part(name: &OsStr) -> bool {
    name.to_string_lossy().starts_with(PREFIX)
}

/// Whether there is nothing at `path`, or a folder with nothing but parts.
///
/// # Errors
/// Where it cannot be read.
pub fn is_vacant(path: &Path) -> io::Result<bool> {
    let entries = match fs::read_dir(path) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(true),
        Err(error) => return Err(error),
    };
    for entry in entries {
        if !is_part(&entry?.file_name()) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Removes the parts in `folder` whose writer was killed, and never one whose writer runs. What cannot
/// be removed stays.
pub fn remove_abandoned_parts(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| is_part(&entry.file_name())) {
        let path = entry.path();
        let lock = path.with_extension(&ENDINGS[1][1..]);
        // A lock is there before its part and after it.
        if path != lock && lock.exists() {
            continue;
        }
        let file = File::options().write(true).open(&path);
        // Locked until both are removed, so that no other process removes them.
        if let Ok(file) = file
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(path.with_extension(&ENDINGS[0][1..]));
            let _ = fs::remove_file(&path);
        }
    }
}

/// The reason of the system, without its number.
pub fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    let number = text.rfind(" (os error ");
    number.map_or(text.as_str(), |at| &text[..at]).to_owned()
}

/// Remedy for a file or folder that cannot be written for a `reason` of the system's; `elsewhere` describes
/// how to name another place.
pub fn way_out(reason: &str, elsewhere: &str) -> String {
    const WAYS: [(&str, &str); 8] = [
        ("No space left", "free some space or "),
        ("quota exceeded", "free some space or "),
        ("File too large", "raise the limit (ulimit -f) or "),
        ("File exists", "move the file that is in the way or "),
        ("Not a directory", "move the file that is in the way or "),
        ("Permission denied", "make it writable or "),
        ("not permitted", "make it writable or "),
        ("No such file", "make the folder first or "),
    ];
    let known = WAYS.iter().find(|(part, _)| reason.contains(part));
    known.map_or("", |(_, way)| way).to_owned() + elsewhere
}

/// A file that no process takes for abandoned as long as this one has it open.
#[derive(Debug)]
struct Locked(NamedTempFile);

impl Locked {
    /// An empty file with the permissions of any new file.
    fn create(folder: &Path, ending: &str) -> io::Result<Self> {
        remove_abandoned_parts_once(folder);
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(ending);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        loop {
            let file = builder.tempfile_in(folder).map_err(without_the_part)?;
            // Some file systems have no locks; there no part is removed.
            let is_locked = file.as_file().lock().is_ok();
            if !is_locked || is_there(&file)? {
                return Ok(Self(file));
            }
            // It was taken for abandoned before it was locked.
        }
    }
}

/// Whether the name still leads to the file.
fn is_there(file: &NamedTempFile) -> io::Result<bool> {
    let own = same_file::Handle::from_file(file.as_file().try_clone()?)?;
    let found = same_file::Handle::from_path(file.path());
    Ok(found.is_ok_and(|found| found == own))
}

/// Removes abandoned parts when this process first writes into the folder.
fn remove_abandoned_parts_once(folder: &Path) {
    static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let mut seen = SEEN.lock().unwrap_or_else(PoisonError::into_inner);
    if seen.insert(folder.to_owned()) {
        remove_abandoned_parts(folder);
    }
}

/// The folder in which the part of a target lies.
fn folder_of(target: &Path) -> io::Result<&Path> {
    if target.is_dir() {
        return Err(io::Error::new(
            io::ErrorKind::IsADirectory,
            "it is a folder",
        ));
    }
    Ok(match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    })
}

/// The error without the path of a part, which is of no use to the user.
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
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
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
        let living = WholeFile::begin(&at("whole")).unwrap();
        fs::write(living.part(), b"half").unwrap();
        let growing = written(&at("other"), b"half").unwrap();
        let before = names(folder.path());
        assert_eq!(before.len(), 3);
        // Leftovers of killed writers.
        for name in [
            ".lugwheel-a.part",
            ".lugwheel-b.part",
            ".lugwheel-b.lock",
            ".lugwheel-c.lock",
        ] {
            fs::write(at(name), b"half").unwrap();
        }
        remove_abandoned_parts(folder.path());
        assert_eq!(names(folder.path()), before);
        assert!(living.part().exists() && growing.path().exists());
    }

    #[test]
    fn the_first_file_of_a_process_in_a_folder_clears_what_killed_writers_left_there() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(".lugwheel-killed.part"), b"half").unwrap();
        write(&folder.path().join("a.csv"), b"new").unwrap();
        assert_eq!(names(folder.path()), ["a.csv"]);
    }

    #[test]
    fn a_part_that_is_removed_before_it_is_locked_is_begun_again() {
        let folder = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            let write = |name: usize| {
                for _ in 0..50 {
                    write_unsynced(&folder.path().join(name.to_string()), b"new").unwrap();
                }
            };
            for name in 0..2 {
                scope.spawn(move || write(name));
            }
            for _ in 0..200 {
                remove_abandoned_parts(folder.path());
            }
        });
        assert_eq!(names(folder.path()), ["0", "1"]);
    }

    #[test]
    fn an_error_names_its_reason_and_not_the_part() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("none/a.csv");
        let error = write(&missing, b"").unwrap_err();
        assert_eq!(reason(&error), "No such file or directory");
        let error = write(folder.path(), b"").unwrap_err();
        assert_eq!(reason(&error), "it is a folder");
        assert_eq!(
            way_out("File too large", "name another place"),
            "raise the limit (ulimit -f) or name another place"
        );
    }
}
