//! Files and folders that a command is about to write: none of them destroys anything.
//!
//! A command claims its targets before it computes. A claim is refused where
//!
//! - the target is an input of the same command, by whatever name: files are compared by what they
//!   are on the disk (device and inode), so neither a relative path nor a link hides an input;
//! - something exists under the target's name, unless `--force` allows to replace it;
//! - with `--force`, the target is write-protected, a folder where a file is to be written, or a
//!   file where a folder is to be made.
//!
//! A claim makes the folders above the target and tries whether they take a file, so that a full disk or
//! a folder that cannot be written to is reported before any work. A file that may be replaced stays until
//! the new one is whole ([`whole_file`](crate::whole_file)).

use super::output::{self, ELSEWHERE, Output};
use crate::whole_file;
use std::fs::{self, Metadata};
use std::io::{self, ErrorKind::NotADirectory, ErrorKind::NotFound};
use std::path::{Path, PathBuf};

/// Why a target cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum TargetError {
    /// The command reads it.
    #[error("{} is {}, which this command reads; name another output", target.display(), same_as(target, input))]
    IsInput {
        /// The output asked for.
        target: PathBuf,
        /// The input it is.
        input: PathBuf,
    },
    /// Something of this name exists.
    #[error("{} exists; give --force to replace it, or name another output", .0.display())]
    Exists(PathBuf),
    /// The folder holds files.
    #[error("the folder {} is not empty; give --force to replace files of the same names in it, or name another folder", .0.display())]
    NotEmpty(PathBuf),
    /// A file that its owner protects.
    #[error("{} is write-protected, and --force does not replace such a file; name another output", .0.display())]
    Protected(PathBuf),
    /// A folder bears the name of a file.
    #[error("{} is a folder; name a file", .0.display())]
    IsFolder(PathBuf),
    /// A file bears the name of a folder.
    #[error("{} is a file; name a folder", .0.display())]
    IsFile(PathBuf),
    /// A device or a pipe, which cannot hold a whole file.
    #[error("{} is not a regular file; name one", .0.display())]
    Irregular(PathBuf),
}

/// What a claim has to heed.
#[derive(Debug, Clone, Copy)]
pub struct Claim<'a> {
    /// Whether existing files may be replaced.
    pub force: bool,
    /// Files that the command reads.
    pub inputs: &'a [&'a Path],
    /// How another place is named.
    pub elsewhere: &'static str,
}

impl Output {
    /// A claim on what a command that reads `inputs` is about to write.
    pub fn claim<'a>(&self, inputs: &'a [&'a Path]) -> Claim<'a> {
        Claim {
            force: self.force,
            inputs,
            elsewhere: ELSEWHERE,
        }
    }
}

impl Claim<'_> {
    /// Claims a file to write and makes the folder above it.
    ///
    /// # Errors
    /// `TargetError`, or the system's reason where the folder cannot be made.
    pub fn file(self, target: &Path) -> anyhow::Result<()> {
        self.free(target)?;
        let parent = match target.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        output::make_folder_or(parent, self.elsewhere)?;
        whole_file::check_room(parent).map_err(|error| self.refused("write", target, &error))
    }

    /// Claims a folder for files of the command's choice and makes it.
    ///
    /// # Errors
    /// `TargetError`, or the system's reason where the folder cannot be made or read.
    pub fn folder(self, target: &Path) -> anyhow::Result<()> {
        self.own_folder(target)?;
        let is_empty =
            || whole_file::is_vacant(target).map_err(|it| self.refused("read", target, &it));
        if !self.force && !is_empty()? {
            return Err(TargetError::NotEmpty(target.to_owned()).into());
        }
        Ok(())
    }

    /// Claims a folder whose files the command recognises as its own, and makes it.
    ///
    /// # Errors
    /// `TargetError`, or the system's reason where the folder cannot be made or written to.
    pub fn own_folder(self, target: &Path) -> anyhow::Result<()> {
        if fs::metadata(target).is_ok_and(|found| !found.is_dir()) {
            return Err(TargetError::IsFile(target.to_owned()).into());
        }
        let is_new = !target.exists();
        output::make_folder_or(target, self.elsewhere)?;
        whole_file::check_room(target).map_err(|error| {
            if is_new {
                // What cannot be used is not left behind.
                let _ = fs::remove_dir(target);
            }
            self.refused("write in the folder", target, &error)
        })
    }

    /// Claims the files of these names in a folder that is claimed.
    ///
    /// # Errors
    /// `TargetError`, or the system's reason.
    pub fn files_in(
        self,
        folder: &Path,
        names: impl IntoIterator<Item = impl AsRef<Path>>,
    ) -> anyhow::Result<()> {
        for name in names {
            self.free(&folder.join(name))?;
        }
        Ok(())
    }

    /// Whether a file may be written: it is no input, and what has its name may be replaced.
    fn free(self, target: &Path) -> anyhow::Result<()> {
        self.not_an_input(target)?;
        let found = found(target).map_err(|error| self.refused("write", target, &error))?;
        Ok(found.map_or(Ok(()), |found| self.replaceable(target, &found))?)
    }

    fn refused(self, action: &str, target: &Path, error: &io::Error) -> anyhow::Error {
        output::refused(action, target, error, self.elsewhere)
    }

    fn not_an_input(self, target: &Path) -> Result<(), TargetError> {
        let Some(input) = self.inputs.iter().find(|input| is_same(target, input)) else {
            return Ok(());
        };
        Err(TargetError::IsInput {
            target: target.to_owned(),
            input: (*input).to_owned(),
        })
    }

    fn replaceable(self, target: &Path, found: &Metadata) -> Result<(), TargetError> {
        // A link to nothing is replaced as a link, its goal untouched.
        let behind = fs::metadata(target).unwrap_or_else(|_| found.clone());
        let refused = if behind.is_dir() {
            TargetError::IsFolder
        } else if !behind.is_file() && !behind.is_symlink() {
            TargetError::Irregular
        } else if !self.force {
            TargetError::Exists
        } else if behind.permissions().readonly() {
            TargetError::Protected
        } else {
            return Ok(());
        };
        Err(refused(target.to_owned()))
    }
}

/// What bears the name, links not followed.
fn found(target: &Path) -> io::Result<Option<Metadata>> {
    match fs::symlink_metadata(target) {
        Ok(found) => Ok(Some(found)),
        // A file where a folder should be comes out when the folder is made.
        Err(error) if matches!(error.kind(), NotFound | NotADirectory) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether two paths lead to one file.
pub fn is_same(a: &Path, b: &Path) -> bool {
    same_file::is_same_file(a, b).unwrap_or(false)
}

/// An input's name, where the target has another.
fn same_as(target: &Path, input: &Path) -> String {
    if target == input {
        "an input".to_owned()
    } else {
        format!("the input {} by another name", input.display())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(claim: Claim, target: &Path) -> String {
        claim.file(target).unwrap_err().to_string()
    }

    #[test]
    fn an_input_is_no_output_by_relative_name_symbolic_or_hard_link_even_by_force() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("rig.h5"), b"measured").unwrap();
        fs::create_dir(at("sub")).unwrap();
        std::os::unix::fs::symlink(at("rig.h5"), at("soft.h5")).unwrap();
        fs::hard_link(at("rig.h5"), at("hard.h5")).unwrap();
        let input = at("rig.h5");
        let claim = Claim {
            force: true,
            inputs: &[&input],
            elsewhere: output::ELSEWHERE,
        };
        for name in ["rig.h5", "sub/../rig.h5", "soft.h5", "hard.h5"] {
            let refusal = refusal(claim, &at(name));
            assert!(refusal.contains("which this command reads"), "{refusal}");
        }
        assert_eq!(fs::read(input).unwrap(), b"measured");
    }

    #[test]
    fn what_exists_is_replaced_by_force_only_and_never_where_it_is_write_protected() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let by_force = |force| Claim {
            force,
            inputs: &[],
            elsewhere: output::ELSEWHERE,
        };
        fs::write(at("a.h5"), b"old").unwrap();
        assert!(refusal(by_force(false), &at("a.h5")).contains("--force"));
        by_force(true).file(&at("a.h5")).unwrap();
        let mut protected = fs::metadata(at("a.h5")).unwrap().permissions();
        protected.set_readonly(true);
        fs::set_permissions(at("a.h5"), protected).unwrap();
        assert!(refusal(by_force(true), &at("a.h5")).contains("write-protected"));
        std::os::unix::fs::symlink(at("nothing"), at("broken.h5")).unwrap();
        assert!(refusal(by_force(false), &at("broken.h5")).contains("exists"));
        assert!(refusal(by_force(true), folder.path()).contains("is a folder"));
        assert!(refusal(by_force(true), Path::new("/dev/null")).contains("not a regular file"));
    }

    #[test]
    fn folders_above_a_target_are_made_and_a_full_folder_needs_force() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("a/b/c.svg");
        let free = Claim {
            force: false,
            inputs: &[],
            elsewhere: output::ELSEWHERE,
        };
        free.file(&deep).unwrap();
        free.folder(&folder.path().join("a/b")).unwrap();
        fs::write(&deep, b"mine").unwrap();
        let refusal = free.folder(&folder.path().join("a/b")).unwrap_err();
        assert!(refusal.to_string().contains("not empty"), "{refusal}");
        let file = free.folder(&deep).unwrap_err().to_string();
        assert!(file.contains("is a file; name a folder"), "{file}");
    }
}
