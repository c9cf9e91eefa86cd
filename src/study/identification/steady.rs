//! `steady.csv`: the steady intervals of every run, and what was recognised in it.

use crate::features::reference::Reference;
use crate::features::{Settings, Window};
use crate::identification::{Drift, SteadyLoad, SteadyRow, Uncertainty, steady_rows};
use crate::recognition::confusion::CLASSES;
use crate::recognition::{Method, RecognitionError, Recognizer, class_of_most};
use crate::study::Study;
use crate::study::analysis::Observed;
use crate::study::cells::Number;
use crate::study::table::{Columns, NoRows, Place};
use crate::terrain::class::{TerrainLabel, Wtic};
use serde::{Deserialize, Serialize};

/// A steady interval of a run, or a run without one.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::study) struct IntervalRow {
    pub place: Place,
    label: TerrainLabel,
    label_class: Wtic,
    /// Answers to the run's windows, in the order of [`CLASSES`].
    pub answered: [u64; 4],
    recognized: Wtic,
    /// Slip, sinkage, pull, load and torque, each with its standard uncertainty.
    loads: [[Number; 2]; 5],
    interval: [Number; 2],
    /// Rates of change, in the order of [`Drift::CHANNELS`].
    drifts: [Number; Drift::CHANNELS.len()],
    /// Why there is no steady interval.
    reason: String,
}

/// The columns of the steady intervals of a study.
pub(super) fn columns(study: &Study) -> Columns {
    let answered = |class: Wtic| format!("answered_{}", class.as_str().to_lowercase());
    Columns::of_place(study)
        .with(["label", "label_class"])
        .with(CLASSES.map(answered))
        .with(["recognized", "slip", "slip_sd", "sinkage_m", "sinkage_sd_m"])
        .with(["drawbar_pull_n", "drawbar_pull_sd_n", "load_n", "load_sd_n"])
        .with(["driving_torque_n_m", "driving_torque_sd_n_m"])
        .with(["from_s", "to_s"])
        .with(["drawbar_pull_drift_n_s", "load_drift_n_s"])
        .with(["driving_torque_drift_n_m_s", "sinkage_drift_m_s", "reason"])
}

/// The steady intervals of a run; a run without one has a row with the reason.
///
/// # Errors
/// `Failed` where a setting of the recognition is out of its range.
pub(super) fn rows(run: &Observed) -> Result<Vec<IntervalRow>, NoRows> {
    let label = run.study.scenario(run.run).terrain.label();
    let answered = answers(run)?;
    let without = IntervalRow {
        place: run.place(),
        label,
        label_class: label.class(),
        answered,
        recognized: class_of_most(answered),
        loads: Default::default(),
        interval: Default::default(),
        drifts: Default::default(),
        reason: String::new(),
    };
    Ok(match steady_rows(run.trace) {
        Ok(rows) => rows.iter().map(|it| without.clone().with(it)).collect(),
        Err(reason) => vec![IntervalRow {
            reason: reason.to_string(),
            ..without
        }],
    })
}

/// How many windows of a run were answered by each class; none where no method can use it, on a smooth wheel for
/// one.
fn answers(run: &Observed) -> Result<[u64; 4], NoRows> {
    let scenario = run.study.scenario(run.run);
    let settings = match &run.study.analyses.recognition {
        Some(recognition) => recognition.settings(&scenario),
        None => Settings {
            window: Window::Seconds(scenario.window()),
            ..Settings::default()
        },
    };
    // Lug by lug needs no reference.
    let recognizer = Recognizer::new(settings, Reference::computed(), &[Method::Improved]);
    let windows = match recognizer.map_err(NoRows::failed)?.recognize(run.trace) {
        Ok(windows) => windows,
        Err(RecognitionError::Record(_)) => Vec::new(),
        Err(error) => return Err(NoRows::failed(error)),
    };
    Ok(CLASSES.map(|class| {
        let of_class = windows.iter().filter(|w| w.answers[0].class == class);
        of_class.count() as u64
    }))
}

impl IntervalRow {
    /// The row of a run with one of its steady intervals.
    fn with(self, steady: &SteadyRow) -> Self {
        let rate = |channel| {
            let drift = steady.drifts.iter().find(|drift| drift.channel == channel);
            drift.map(|drift| drift.rate).into()
        };
        Self {
            loads: of_load(&steady.load),
            interval: steady.interval.map(Number::from),
            drifts: Drift::CHANNELS.map(rate),
            ..self
        }
    }

    /// Loads and what still changes in them.
    ///
    /// # Errors
    /// Why there are none.
    pub fn steady(&self) -> Result<SteadyRow, String> {
        if !self.reason.is_empty() {
            return Err(self.reason.clone());
        }
        let drifts = Drift::CHANNELS.into_iter().zip(self.drifts);
        let drifts = drifts.filter_map(|(channel, rate)| {
            let rate = rate.get()?;
            Some(Drift { channel, rate })
        });
        Ok(SteadyRow {
            load: to_load(self.loads),
            interval: self.interval.map(or_nan),
            drifts: drifts.collect(),
        })
    }
}

/// An empty cell is not a number.
fn or_nan(number: Number) -> f64 {
    number.get().unwrap_or(f64::NAN)
}

fn of_load(load: &SteadyLoad) -> [[Number; 2]; 5] {
    let values = [
        load.slip,
        load.sinkage,
        load.drawbar_pull,
        load.load,
        load.driving_torque,
    ];
    let deviations = load.uncertainty.as_ref();
    let deviations = deviations.map(|it| {
        [
            it.slip,
            it.sinkage,
            it.drawbar_pull,
            it.load,
            it.driving_torque,
        ]
    });
    let deviations = Number::of_all(deviations);
    std::array::from_fn(|place| [values[place].into(), deviations[place]])
}

/// Without uncertainties where one of them is not known.
fn to_load(loads: [[Number; 2]; 5]) -> SteadyLoad {
    let [slip, sinkage, drawbar_pull, load, driving_torque] = loads.map(|[value, _]| or_nan(value));
    let uncertainty = |[slip, sinkage, drawbar_pull, load, driving_torque]: [f64; 5]| Uncertainty {
        slip,
        sinkage,
        drawbar_pull,
        load,
        driving_torque,
    };
    SteadyLoad {
        slip,
        sinkage,
        drawbar_pull,
        load,
        driving_torque,
        uncertainty: Number::all(loads.map(|[_, deviation]| deviation)).map(uncertainty),
    }
}
