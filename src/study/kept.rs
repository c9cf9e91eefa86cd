//! The `[dataset]` of a study file: its runs, or their features, as one data set for machine learning.
//!
//! Once all shards are present, runs are moved one by one from the [files of the shards](super::traces) into
//! `dataset.h5`. So memory contains one run per thread, and an interruption costs one shard.

use super::analysis::{Analysis, Finished, Observed, Report};
use super::recognition::BY_DEFAULT;
use super::runs::swept_fields;
use super::table::{Columns, NoRows, Stop};
use super::traces::{self, fact, provenance};
use super::{Reading, Study, StudyError};
use crate::dataset::hdf5::{RunFileWriter, write_table};
use crate::dataset::records::{Field, Records};
use crate::document::Misfit;
use crate::learning::windows::Windower;
use crate::learning::{ChannelFact, DataSet, Facts, Kept, run_fields, run_id, windows};
use serde::Deserialize;

/// A `[dataset]`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Dataset {
    keep: Keep,
}

/// Content stored per run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Keep {
    /// Every channel at its output rate, and all that features use.
    Traces,
    /// Features and class of every window.
    Features,
}

fn fields(study: &Study) -> Vec<Field> {
    let mut fields = run_fields(swept_fields(study));
    fields.extend(windows::fields());
    fields
}

impl Analysis for Dataset {
    const ROWS: Option<&'static str> = Some("dataset");
    type Plan = Self;
    /// Cells of the [`fields`].
    type Row = Vec<String>;
    type Score = DataSet;

    fn read(plan: Self, _: &Reading) -> Result<Self, Misfit> {
        Ok(plan)
    }

    fn needs_traces(&self) -> bool {
        self.keep == Keep::Traces
    }

    fn columns(&self, study: &Study) -> Columns {
        let names = fields(study).into_iter().map(|field| field.name);
        Columns::default().with(names)
    }

    fn rows(&self, run: &Observed, stop: &mut Stop) -> Result<Vec<Vec<String>>, NoRows> {
        let reference = run.reference(stop)?;
        let settings = BY_DEFAULT.settings(&run.study.scenario(run.run));
        let mut windower = Windower::new(settings, reference).map_err(NoRows::failed)?;
        let place = run.place();
        let first = [
            run_id(place.run),
            place.condition.to_string(),
            run.run.stream.to_string(),
            place.scenario,
        ];
        let windows = windower.rows(run.trace).into_iter();
        let row = |cells: Vec<String>| [&first[..], &place.values, &cells].concat();
        Ok(windows.map(row).collect())
    }

    /// Makes the data set from the windows and the shards' runs.
    ///
    /// # Errors
    /// `Dataset` and `File` where a file cannot be read or written; `Stopped`.
    fn score(&self, done: &Finished, rows: Vec<Vec<String>>) -> Result<DataSet, StudyError> {
        let windows = Records {
            fields: fields(done.study),
            rows,
        };
        let (kept, channels) = match self.keep {
            Keep::Traces => (Kept::Traces, merge(done)?),
            Keep::Features => (Kept::Features, Vec::new()),
        };
        let provenance = provenance(done.study);
        let facts = Facts {
            command: format!("lugwheel study {}", done.study.file),
            created_by: provenance.created_by.clone(),
            seed: done.study.seed,
            kept,
            channels,
            failed: done.failed,
        };
        let set = DataSet::new(facts, windows);
        let path = done.folder.path_of("dataset.h5");
        if self.keep == Keep::Features {
            write_table(&path, set.windows(), &provenance)?;
        }
        for (ending, text) in set.texts(&fact(&path)?) {
            let name = format!("dataset.{ending}");
            done.folder.write(&name, text.as_bytes())?;
        }
        Ok(set)
    }

    fn report(_: &DataSet) -> Option<Report> {
        None
    }
}

/// Merges the runs of all shards into one file; returns the channels of the first.
fn merge(done: &Finished) -> Result<Vec<ChannelFact>, StudyError> {
    let path = done.folder.path_of("dataset.h5");
    let mut writer = RunFileWriter::create(path, &provenance(done.study))?;
    let mut channels = None;
    for shard in done.shards {
        let file = traces::open(done.folder, shard)?;
        for id in file.runs() {
            done.go_on()?;
            let trace = file.read(id)?;
            writer.add(id, &trace)?;
            channels.get_or_insert_with(|| ChannelFact::of(&trace));
        }
    }
    writer.finish()?;
    Ok(channels.unwrap_or_default())
}
