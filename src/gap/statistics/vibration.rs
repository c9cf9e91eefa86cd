//! The features of the run's windows and the classes recognised from them.

use crate::gap::cell::{Kappa, Statistic};
use crate::gap::readings::Readings;
use crate::recognition::Recognizer;
use crate::recognition::confusion::CLASSES;
use crate::trace::Trace;
use std::sync::Arc;

/// Channels that windows are cut and judged by, beside those that every statistic depends on.
pub(super) const CHANNELS: [&str; 4] = ["acceleration_y", "normal_force", "sinkage", "slip_ratio"];

pub(super) fn read(recognizer: &mut Recognizer, trace: &Trace, readings: &mut Readings) {
    // A run without what features need has none.
    let Ok(windows) = recognizer.recognize(trace) else {
        return;
    };
    let name: Arc<str> = Arc::from("acceleration_y");
    let features: Vec<[f64; 4]> = windows
        .iter()
        .filter_map(|window| window.p.clone().ok())
        .collect();
    for kappa in Kappa::ALL {
        let values = features.iter().map(|p| p[kappa as usize]);
        let mean = values.sum::<f64>() / features.len() as f64;
        readings.note(&name, Statistic::Feature(kappa), mean);
    }
    let count = windows.len() as f64;
    for class in CLASSES {
        let recognised = windows
            .iter()
            .filter(|window| window.answers.iter().any(|answer| answer.class == class));
        let share = recognised.count() as f64 / count;
        // A twentieth added to both sides, so that all or none is no infinity.
        let logit = libm::log((share + 0.05) / (1.05 - share));
        readings.note(&name, Statistic::ClassShare(class), logit);
    }
}
