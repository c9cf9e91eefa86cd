//! The channels of a shard's runs in a file of their own, for the tables `[dataset]` and
//! `[diagnosis]` of a study.
//!
//! They go to `shards/<number>.traces.h5`, run by run, and its checksum to another file.

use super::folder::{Folder, file_error};
use super::shard::Shard;
use super::{Run, Study, StudyError};
use crate::dataset::Provenance;
use crate::dataset::hdf5::{RunFile, RunFileError, RunFileWriter};
use crate::learning::{FileFact, run_id};
use crate::trace::Trace;
use std::path::Path;

/// The file of a shard's runs while they are made.
pub(super) struct Traces {
    writer: RunFileWriter,
}

impl Traces {
    /// Begins the file, where the study needs the channels.
    pub(super) fn begin(
        study: &Study,
        folder: &Folder,
        shard: &Shard,
    ) -> Result<Option<Self>, StudyError> {
        if !study.analyses.need_traces() {
            return Ok(None);
        }
        let path = folder.path_of(&traces_name(shard));
        let writer = RunFileWriter::create(path, &provenance(study))?;
        Ok(Some(Self { writer }))
    }

    /// Adds a run, its condition in its notes.
    pub(super) fn add(
        &mut self,
        study: &Study,
        run: &Run,
        mut trace: Trace,
    ) -> Result<(), StudyError> {
        trace.attributes.notes = format!("scenario {}", study.condition_of(run));
        Ok(self.writer.add(&run_id(run.number), &trace)?)
    }

    /// Completes the file and writes its checksum.
    pub(super) fn finish(self, folder: &Folder, shard: &Shard) -> Result<(), StudyError> {
        self.writer.finish()?;
        let fact = fact(&folder.path_of(&traces_name(shard)))?;
        let seal = seal(folder, &fact);
        folder.write(&seal_name(shard), seal.as_bytes())
    }
}

/// Whether the runs of a shard are there, where the study needs them, and as they were written.
pub(super) fn is_whole(study: &Study, folder: &Folder, shard: &Shard) -> bool {
    let sealed = || {
        let fact = FileFact::of(&folder.path_of(&traces_name(shard))).ok()?;
        let found = std::fs::read_to_string(folder.path_of(&seal_name(shard))).ok()?;
        Some(found == seal(folder, &fact))
    };
    !study.analyses.need_traces() || sealed().unwrap_or(false)
}

/// Whether the runs of a shard are there, where the study needs them.
pub(super) fn is_there(study: &Study, folder: &Folder, shard: &Shard) -> bool {
    !study.analyses.need_traces() || folder.path_of(&seal_name(shard)).exists()
}

/// The runs of a shard that did not fail.
pub(super) fn open(folder: &Folder, shard: &Shard) -> Result<RunFile, RunFileError> {
    RunFile::open(folder.path_of(&traces_name(shard)))
}

fn traces_name(shard: &Shard) -> String {
    format!("shards/{:05}.traces.h5", shard.number)
}

fn seal_name(shard: &Shard) -> String {
    format!("shards/{:05}.traces.sha256", shard.number)
}

/// Sidecar of the runs of a shard: their origin and checksum.
fn seal(folder: &Folder, fact: &FileFact) -> String {
    format!("study {}\nsha256 {}\n", folder.fingerprint(), fact.sha256)
}

pub(super) fn fact(path: &Path) -> Result<FileFact, StudyError> {
    FileFact::of(path).map_err(|source| file_error("read", path, source))
}

/// The runs are of several scenarios, which their notes name.
pub(super) fn provenance(study: &Study) -> Provenance {
    Provenance {
        seed: Some(study.seed),
        ..Provenance::measured()
    }
}
