//! `steady.csv`: the steady intervals of every run, and what was recognised in it.

use crate::features::reference::Reference;
use crate::features::{Settings, Window};
use crate::identification::{Drift, SteadyLoad, SteadyRow, Uncertainty, steady_rows};
use crate::recognition::confusion::CLASSES;
use crate::recognition::{Method, RecognitionError, Recognizer, class_of_most};
use crate::study::table::{NoRows, Rows, Stop, Table, cell, condition_cells};
use crate::study::{Run, Study};
use crate::terrain::class::Wtic;
use crate::trace::Trace;

/// Name of the table.
pub(in crate::study) const NAME: &str = "steady";

/// Columns of a row's values, each followed by one of its uncertainty.
pub(super) const VALUES: [[&str; 2]; 5] = [
    ["slip", "slip_sd"],
    ["sinkage_m", "sinkage_sd_m"],
    ["drawbar_pull_n", "drawbar_pull_sd_n"],
    ["load_n", "load_sd_n"],
    ["driving_torque_n_m", "driving_torque_sd_n_m"],
];

/// Columns of the interval.
pub(super) const INTERVAL: [&str; 2] = ["from_s", "to_s"];

/// Columns of the rates of change, in the order of [`Drift::CHANNELS`].
pub(super) const DRIFTS: [&str; 4] = [
    "drawbar_pull_drift_n_s",
    "load_drift_n_s",
    "driving_torque_drift_n_m_s",
    "sinkage_drift_m_s",
];

/// The table of the steady intervals, if the study identifies.
pub(in crate::study) struct SteadyRows<'s> {
    study: &'s Study,
}

impl<'s> SteadyRows<'s> {
    pub(in crate::study) fn of(study: &'s Study) -> Option<Self> {
        study.identification.as_ref()?;
        Some(Self { study })
    }

    /// Condition, ground and answers.
    fn first_cells(&self, run: &Run, trace: &Trace) -> Result<Vec<String>, NoRows> {
        let numbers = [run.number, run.condition, u64::from(run.repeat)];
        let mut cells: Vec<String> = numbers.map(|number| number.to_string()).into();
        cells.extend(condition_cells(self.study, run));
        let label = self.study.scenario(run).terrain.label();
        cells.extend([label.as_str(), label.class().as_str()].map(str::to_owned));
        let answers = self.answers(run, trace)?;
        cells.extend(answers.map(|count| count.to_string()));
        cells.push(class_of_most(answers).to_string());
        Ok(cells)
    }

    /// How many windows of a run were answered by each class; none where no method can use it, on
    /// a smooth wheel for one.
    fn answers(&self, run: &Run, trace: &Trace) -> Result<[u64; 4], NoRows> {
        let scenario = self.study.scenario(run);
        let settings = match &self.study.recognition {
            Some(recognition) => recognition.settings(&scenario),
            None => Settings {
                window: Window::Seconds(scenario.window()),
                ..Settings::default()
            },
        };
        let failed = |error: &dyn std::error::Error| NoRows::Failed(error.to_string());
        // Lug by lug needs no reference.
        let recognizer = Recognizer::new(settings, Reference::computed(), &[Method::Improved]);
        let mut recognizer = recognizer.map_err(|error| failed(&error))?;
        let windows = match recognizer.recognize(trace) {
            Ok(windows) => windows,
            Err(RecognitionError::Record(_)) => Vec::new(),
            Err(error) => return Err(failed(&error)),
        };
        Ok(CLASSES.map(|class| {
            let of_class = windows.iter().filter(|w| w.answers[0].class == class);
            of_class.count() as u64
        }))
    }
}

impl Table for SteadyRows<'_> {
    fn name(&self) -> &'static str {
        NAME
    }

    fn header(&self) -> Vec<String> {
        let owned = |names: &[&str]| -> Vec<String> {
            names.iter().map(|name| (*name).to_owned()).collect()
        };
        let mut names = owned(&["run", "condition", "repeat", "scenario"]);
        names.extend(self.study.keys().map(str::to_owned));
        names.extend(owned(&["label", "label_class"]));
        names.extend(CLASSES.map(answered_column));
        names.push("recognized".to_owned());
        names.extend(VALUES.iter().flat_map(|pair| owned(pair)));
        names.extend(owned(&INTERVAL));
        names.extend(owned(&DRIFTS));
        names.push("reason".to_owned());
        names
    }

    /// A run without a steady interval has a row with the reason.
    fn rows(&self, run: &Run, trace: &Trace, _: &mut Stop) -> Result<Rows, NoRows> {
        let first = self.first_cells(run, trace)?;
        let row = |then: Vec<String>| [&first[..], &then[..]].concat();
        Ok(match steady_rows(trace) {
            Ok(rows) => rows.iter().map(|steady| row(cells_of(steady))).collect(),
            Err(reason) => {
                let values = 2 * VALUES.len() + INTERVAL.len() + DRIFTS.len();
                let mut cells = vec![String::new(); values];
                cells.push(reason.to_string());
                vec![row(cells)]
            }
        })
    }

    fn rows_of_failed(&self, _: &Run, _: &str) -> Rows {
        Rows::new()
    }
}

/// The column of the windows answered by a class.
pub(super) fn answered_column(class: Wtic) -> String {
    format!("answered_{}", class.as_str().to_lowercase())
}

/// Values, interval and drifts of a row, and no reason why there is none.
fn cells_of(row: &SteadyRow) -> Vec<String> {
    let mut cells = value_cells(&row.load);
    cells.extend(row.interval.map(|time| cell(Some(time))));
    cells.extend(Drift::CHANNELS.map(|channel| {
        let drift = row.drifts.iter().find(|drift| drift.channel == channel);
        cell(drift.map(|drift| drift.rate))
    }));
    cells.push(String::new());
    cells
}

fn value_cells(load: &SteadyLoad) -> Vec<String> {
    let values = [
        load.slip,
        load.sinkage,
        load.drawbar_pull,
        load.load,
        load.driving_torque,
    ];
    let deviation = |of: fn(&Uncertainty) -> f64| load.uncertainty.as_ref().map(of);
    let deviations = [
        deviation(|u| u.slip),
        deviation(|u| u.sinkage),
        deviation(|u| u.drawbar_pull),
        deviation(|u| u.load),
        deviation(|u| u.driving_torque),
    ];
    let pairs = values.into_iter().zip(deviations);
    pairs
        .flat_map(|(value, deviation)| [cell(Some(value)), cell(deviation)])
        .collect()
}
