//! The `[dataset]` of a study file: its runs, or their features, as one data set for machine learning.
//!
//! Once all shards are present, runs are moved one by one from the [files of the shards](super::traces) into
//! `dataset.h5`. So memory contains one run per thread, and an interruption costs one shard.

use super::folder::Folder;
use super::recognition;
use super::references::References;
use super::runs::swept_fields;
use super::shard::Shard;
use super::table::{NoRows, Rows, Stop, Table, condition_cells};
use super::traces::{self, Keep, fact, provenance};
use super::{Run, Study, StudyError};
use crate::dataset::hdf5::{RunFileWriter, write_table};
use crate::dataset::records::{Field, Records};
use crate::learning::windows::Windower;
use crate::learning::{ChannelFact, DataSet, Facts, Kept, run_fields, run_id, windows};
use crate::trace::Trace;
use serde::Deserialize;
use std::ops::ControlFlow;

/// Name of the table of windows in the shards.
pub(super) const NAME: &str = "dataset";

/// A `[dataset]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DatasetTable {
    pub(super) keep: Keep,
}

/// The table of the windows of a data set.
pub(super) struct Windows<'s> {
    study: &'s Study,
    references: References<'s>,
}

impl<'s> Windows<'s> {
    /// The table, if the study makes a data set.
    pub(super) fn of(study: &'s Study) -> Option<Self> {
        study.dataset?;
        Some(Self {
            study,
            references: References::new(study, &recognition::BY_DEFAULT),
        })
    }
}

fn fields(study: &Study) -> Vec<Field> {
    let mut fields = run_fields(swept_fields(study));
    fields.extend(windows::fields());
    fields
}

impl Table for Windows<'_> {
    fn name(&self) -> &'static str {
        NAME
    }

    fn header(&self) -> Vec<String> {
        let fields = fields(self.study).into_iter();
        fields.map(|field| field.name).collect()
    }

    fn rows(&self, run: &Run, trace: &Trace, stop: &mut Stop) -> Result<Rows, NoRows> {
        let reference = self.references.of(run, stop)?;
        let settings = recognition::BY_DEFAULT.settings(&self.study.scenario(run));
        let windower = Windower::new(settings, reference);
        let mut windower = windower.map_err(|error| NoRows::Failed(error.to_string()))?;
        let mut first = vec![
            run_id(run.number),
            run.condition.to_string(),
            run.stream.to_string(),
        ];
        first.extend(condition_cells(self.study, run));
        let windows = windower.rows(trace).into_iter();
        Ok(windows
            .map(|cells| [first.clone(), cells].concat())
            .collect())
    }

    fn rows_of_failed(&self, _: &Run, _: &str) -> Rows {
        Rows::new()
    }
}

impl Study {
    /// Makes the data set from the windows in the table `text` and the shards' runs. `stop` is polled before
    /// every run.
    ///
    /// # Errors
    /// `Dataset` and `File` where a file cannot be read or written; `Stopped`.
    pub(super) fn keep(
        &self,
        folder: &Folder,
        shards: &[Shard],
        text: &str,
        failed: u64,
        stop: &dyn Fn() -> ControlFlow<()>,
    ) -> Result<Option<DataSet>, StudyError> {
        let Some(keep) = self.dataset else {
            return Ok(None);
        };
        let windows = Records::of_csv(fields(self), text);
        let (kept, channels) = match keep {
            Keep::Traces => (Kept::Traces, self.merge(folder, shards, stop)?),
            Keep::Features => (Kept::Features, Vec::new()),
        };
        let provenance = provenance(self);
        let facts = Facts {
            command: format!("lugwheel study {}", self.file),
            created_by: provenance.created_by.clone(),
            seed: self.seed,
            kept,
            channels,
            failed,
        };
        let set = DataSet::new(facts, windows);
        let path = folder.path_of("dataset.h5");
        if keep == Keep::Features {
            write_table(&path, set.windows(), &provenance)?;
        }
        for (ending, text) in set.texts(&fact(&path)?) {
            folder.write(&format!("dataset.{ending}"), text.as_bytes())?;
        }
        Ok(Some(set))
    }

    /// Merges the runs of all shards into one file; returns the channels of the first.
    fn merge(
        &self,
        folder: &Folder,
        shards: &[Shard],
        stop: &dyn Fn() -> ControlFlow<()>,
    ) -> Result<Vec<ChannelFact>, StudyError> {
        let path = folder.path_of("dataset.h5");
        let mut writer = RunFileWriter::create(path, &provenance(self))?;
        let mut channels = None;
        for shard in shards {
            let file = traces::open(folder, shard)?;
            for id in file.runs() {
                if stop().is_break() {
                    return Err(self.stopped_when_whole());
                }
                let trace = file.read(id)?;
                writer.add(id, &trace)?;
                channels.get_or_insert_with(|| ChannelFact::of(&trace));
            }
        }
        writer.finish()?;
        Ok(channels.unwrap_or_default())
    }
}
