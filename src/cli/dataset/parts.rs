//! Runs of a data set that is not complete yet, a part each, in a folder beside the file to be.
//!
//! ```text
//! sand.h5.parts/origin.txt         what decides the bytes: program, seed, what is kept, scenario
//!               run_000003.h5      the run's traces, where traces are kept
//!               run_000003.json    its class, steady values and windows; written last
//! ```
//!
//! A run is whole where its JSON is. A command that is interrupted or killed loses the runs it was
//! simulating; `--resume` simulates what is missing. The complete file is always put together from
//! the parts, so its bytes are the same with and without an interruption. A lock on `origin.txt`
//! keeps a second command out.

use crate::cli::output;
use crate::cli::series::Outcome;
use crate::dataset::Provenance;
use crate::dataset::hdf5::{RunFile, RunFileWriter};
use crate::learning::run_id;
use crate::trace::Trace;
use crate::whole_file;
use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// The parts of one data set.
pub struct Parts {
    folder: PathBuf,
    /// Locked as long as this command works.
    _lock: File,
}

/// What to do about parts that an earlier command left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Before {
    /// Go on from them.
    Resume,
    /// Remove them.
    Discard,
    /// Refuse to work.
    Keep,
}

/// What is known of a run beside its traces.
#[derive(Debug, Serialize, Deserialize)]
pub struct RunFacts {
    /// Class, ground and steady values.
    pub outcome: Outcome,
    /// A row of cells for every window.
    pub windows: Vec<Vec<String>>,
}

/// A part that is there.
pub struct Part {
    /// Class, steady values and windows.
    pub facts: RunFacts,
    /// Traces, where they are kept.
    pub trace: Option<Trace>,
}

impl Parts {
    /// The parts beside `out`, of runs that `origin` decides.
    ///
    /// # Errors
    /// Where another command works on them, where they are there and neither resumed nor discarded,
    /// where they are of another origin, or where the folder cannot be made.
    pub fn open(out: &Path, origin: &str, before: Before) -> anyhow::Result<Self> {
        let folder = folder_of(out);
        let mark = folder.join(ORIGIN);
        let found = fs::read_to_string(&mark).ok();
        let shown = folder.display();
        match (&found, before) {
            (None, _) => {
                let empty = fs::read_dir(&folder).map_or(true, |mut files| files.next().is_none());
                ensure!(
                    empty,
                    "the folder {shown} holds other files; name another --out"
                );
            }
            (Some(_), Before::Keep) => anyhow::bail!(
                "{shown} holds runs of an interrupted data set; go on from them with --resume, or \
                 discard them with --force"
            ),
            (Some(found), Before::Resume) => ensure!(
                found == origin,
                "{shown} holds runs of another scenario, seed, choice of --features or --raw, or \
                 version of the program; repeat the command that made them, discard them with \
                 --force, or name another --out"
            ),
            (Some(_), Before::Discard) => {}
        }
        output::make_folder(&folder)?;
        let lock = locked(&mark)?;
        if before == Before::Discard {
            remove_parts(&folder)?;
        }
        whole_file::remove_abandoned_parts(&folder);
        if found.is_none_or(|found| found != origin)
            && let Err(error) = fs::write(&mark, origin)
        {
            // Half of it is no origin.
            let _ = fs::remove_file(&mark).and_then(|()| fs::remove_dir(&folder));
            return Err(output::refused("write", &mark, &error, output::ELSEWHERE));
        }
        Ok(Self {
            folder,
            _lock: lock,
        })
    }

    /// Whether a run is whole.
    pub fn has(&self, run: u64) -> bool {
        self.path_of(run, "json").is_file()
    }

    /// How many runs are whole.
    pub fn count(&self) -> usize {
        let names = names(&self.folder).unwrap_or_default();
        names.iter().filter(|name| name.ends_with(".json")).count()
    }

    /// Adds a run, its traces where they are kept.
    ///
    /// # Errors
    /// Where the disk is full or a trace cannot be stored.
    pub fn add(&self, run: u64, facts: &RunFacts, kept: Option<&Trace>) -> anyhow::Result<()> {
        if let Some(trace) = kept {
            let mut file = RunFileWriter::create(self.path_of(run, "h5"), &Provenance::measured())?;
            file.add(&run_id(run), trace)?;
            file.finish()?;
        }
        let text = serde_json::to_string(facts)?;
        output::write_file(&self.path_of(run, "json"), &text)
    }

    /// A run that was added.
    ///
    /// # Errors
    /// Where its files are not as they were written.
    pub fn read(&self, run: u64, has_trace: bool) -> anyhow::Result<Part> {
        let path = self.path_of(run, "json");
        let shown = path.display();
        let text = fs::read_to_string(&path).with_context(|| format!("cannot read {shown}"))?;
        let facts = serde_json::from_str(&text)
            .with_context(|| format!("{shown} is damaged; remove it and --resume"))?;
        let trace = has_trace.then(|| RunFile::open(self.path_of(run, "h5"))?.read(&run_id(run)));
        Ok(Part {
            facts,
            trace: trace.transpose()?,
        })
    }

    /// Removes the folder, once the data set is complete.
    ///
    /// # Errors
    /// Where the system refuses.
    pub fn remove(&self) -> anyhow::Result<()> {
        remove_parts(&self.folder)?;
        output::remove_file(&self.folder.join(ORIGIN))?;
        // A folder with other files stays.
        let _ = fs::remove_dir(&self.folder);
        Ok(())
    }

    fn path_of(&self, run: u64, ending: &str) -> PathBuf {
        self.folder.join(format!("{}.{ending}", run_id(run)))
    }
}

/// What decides the bytes of the runs.
const ORIGIN: &str = "origin.txt";

/// `sand.h5` to `sand.h5.parts`.
fn folder_of(out: &Path) -> PathBuf {
    let mut name = out.file_name().unwrap_or_default().to_owned();
    name.push(".parts");
    out.with_file_name(name)
}

fn locked(mark: &Path) -> anyhow::Result<File> {
    let shown = mark.display();
    let opened = File::options().append(true).create(true).open(mark);
    let file = opened.map_err(|error| output::refused("write", mark, &error, output::ELSEWHERE))?;
    if let Err(fs::TryLockError::WouldBlock) = file.try_lock() {
        anyhow::bail!("another command works on this data set (it has locked {shown})");
    }
    Ok(file)
}

fn names(folder: &Path) -> anyhow::Result<Vec<String>> {
    let entries = fs::read_dir(folder)?;
    let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    names.collect()
}

/// Removes the files of all runs.
fn remove_parts(folder: &Path) -> anyhow::Result<()> {
    let is_part = |name: &&String| {
        let stem = name.strip_suffix(".h5").or(name.strip_suffix(".json"));
        stem.is_some_and(|stem| stem.starts_with("run_"))
    };
    for name in names(folder)?.iter().filter(is_part) {
        output::remove_file(&folder.join(name))?;
    }
    Ok(())
}
