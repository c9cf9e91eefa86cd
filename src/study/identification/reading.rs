//! The rows of `steady.csv` as they are fitted.

use super::steady::{DRIFTS, INTERVAL, VALUES, answered_column};
use crate::identification::{Drift, SteadyLoad, SteadyRow, Uncertainty};
use crate::recognition::confusion::CLASSES;
use crate::study::table::{Stored, StoredRow};

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

/// The rows of the table of the steady intervals.
pub(super) fn rows(text: &str) -> Vec<Row> {
    let row = |row: StoredRow| Row {
        run: row.count("run"),
        condition: row.count("condition"),
        repeat: row.count("repeat") as u32,
        answers: CLASSES.map(|class| row.count(&answered_column(class))),
        steady: match row.text("reason") {
            "" => Ok(steady(&row)),
            reason => Err(reason.to_owned()),
        },
    };
    Stored::read(text).rows().map(row).collect()
}

fn steady(row: &StoredRow) -> SteadyRow {
    // An empty cell is no number.
    let number = |column: &str| row.number(column).unwrap_or(f64::NAN);
    let drifts = Drift::CHANNELS.into_iter().zip(DRIFTS);
    let drifts = drifts.filter_map(|(channel, column)| {
        let rate = row.number(column)?;
        Some(Drift { channel, rate })
    });
    let [slip, sinkage, drawbar_pull, load, driving_torque] =
        VALUES.map(|[value, _]| number(value));
    SteadyRow {
        load: SteadyLoad {
            slip,
            sinkage,
            drawbar_pull,
            load,
            driving_torque,
            uncertainty: uncertainty(row),
        },
        interval: INTERVAL.map(number),
        drifts: drifts.collect(),
    }
}

/// None where one of them is not known.
fn uncertainty(row: &StoredRow) -> Option<Uncertainty> {
    let deviations = row.numbers(VALUES.map(|[_, deviation]| deviation))?;
    let [slip, sinkage, drawbar_pull, load, driving_torque] = deviations;
    let are_finite = deviations.iter().all(|it| it.is_finite());
    are_finite.then_some(Uncertainty {
        slip,
        sinkage,
        drawbar_pull,
        load,
        driving_torque,
    })
}
