//! The runs of a campaign, as a rig would have written them.

use crate::dataset::hdf5::RunFileError;
use crate::learning::run_id;
use crate::study::analysis::Finished;
use crate::study::group::Group;
use crate::study::{Study, traces};
use crate::trace::Trace;
use std::ops::Range;

/// The runs of a group that did not fail, in the order of their numbers, without ground truth.
pub(super) fn measured(done: &Finished, group: &Group) -> Result<Vec<Trace>, RunFileError> {
    let mut measured = Vec::new();
    for shard in done.shards {
        let wanted = wanted(done.study, group, &shard.runs);
        if wanted.is_empty() {
            continue;
        }
        let file = traces::open(done.folder, shard)?;
        for id in wanted.iter().filter(|id| file.runs().contains(id)) {
            measured.push(file.read(id)?.as_measured());
        }
    }
    Ok(measured)
}

/// The ids of those runs with these numbers that belong to the group.
fn wanted(study: &Study, group: &Group, numbers: &Range<u64>) -> Vec<String> {
    let runs = study.runs_in(numbers.clone());
    let of_group = runs.filter(|run| group.conditions.contains(&run.condition));
    of_group.map(|run| run_id(run.number)).collect()
}
