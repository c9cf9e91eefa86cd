//! The rows of `steady.csv` as they are fitted.

use super::steady::{DRIFTS, INTERVAL, VALUES, answered_column};
use crate::identification::{Drift, SteadyLoad, SteadyRow, Uncertainty};
use crate::recognition::confusion::CLASSES;
use csv::StringRecord;

/// A steady interval of a run, or a run without one.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub run: u64,
    pub condition: u64,
    pub repeat: u32,
    /// Answers to the run's windows, in the order of [`CLASSES`].
    pub answers: [u64; 4],
    /// Its loads and what still changes in them, or why there are none.
    pub steady: Result<SteadyRow, String>,
}

/// Reads a table that this program wrote: its columns are there.
pub(super) fn rows(text: &str) -> Vec<Row> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().cloned().unwrap_or_default();
    let place = |column: &str| {
        let found = header.iter().position(|name| name == column);
        found.expect("the table of the steady intervals has this column")
    };
    let numbers = ["run", "condition", "repeat"].map(place);
    let answers = CLASSES.map(|class| place(&answered_column(class)));
    let values = VALUES.map(|pair| pair.map(place));
    let interval = INTERVAL.map(place);
    let drifts = DRIFTS.map(place);
    let reason = place("reason");
    let row = |record: StringRecord| {
        let count = |at: usize| record[at].parse::<u64>().expect("it was counted");
        let [run, condition, repeat] = numbers.map(count);
        let steady = if record[reason].is_empty() {
            Ok(SteadyRow {
                load: load(&record, values),
                interval: interval.map(|at| number(&record, at)),
                drifts: found_drifts(&record, drifts),
            })
        } else {
            Err(record[reason].to_owned())
        };
        Row {
            run,
            condition,
            repeat: repeat as u32,
            answers: answers.map(count),
            steady,
        }
    };
    reader.records().flatten().map(row).collect()
}

/// An empty cell is no number.
fn number(record: &StringRecord, at: usize) -> f64 {
    record[at].parse().unwrap_or(f64::NAN)
}

/// The rates that are there.
fn found_drifts(record: &StringRecord, places: [usize; 4]) -> Vec<Drift> {
    let drifts = Drift::CHANNELS.into_iter().zip(places);
    drifts
        .filter_map(|(channel, at)| {
            let rate = record[at].parse().ok()?;
            Some(Drift { channel, rate })
        })
        .collect()
}

fn load(record: &StringRecord, places: [[usize; 2]; 5]) -> SteadyLoad {
    let number = |at: usize| number(record, at);
    let [slip, sinkage, drawbar_pull, load, driving_torque] = places.map(|[at, _]| number(at));
    let deviations = places.map(|[_, at]| number(at));
    let uncertainty = deviations.iter().all(|sd| sd.is_finite()).then(|| {
        let [slip, sinkage, drawbar_pull, load, driving_torque] = deviations;
        Uncertainty {
            slip,
            sinkage,
            drawbar_pull,
            load,
            driving_torque,
        }
    });
    SteadyLoad {
        slip,
        sinkage,
        drawbar_pull,
        load,
        driving_torque,
        uncertainty,
    }
}
