//! Consistency of the fitted load with the measured load.

use super::forces::{Force, forces};
use super::model::Model;
use super::observation::variances;
use super::parameter::Coordinates;
use super::precision::{UNLIKELY, by_chance};
use super::row::SteadyLoad;
use super::weight::Scale;
use std::fmt;

/// Mean error [%] of the load above which it counts as missed even if errors of slip and sinkage could
/// explain it: the largest error of the closed form on the paper's grounds (Table 7).
const LARGEST_PUBLISHED: f64 = 11.68;

/// Difference between fitted and measured loads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadMissed {
    /// Mean absolute difference over the mean load [%].
    pub percent: f64,
    /// Standard uncertainty of a load over the mean load [%], as root mean square.
    pub own_percent: f64,
    /// As `own_percent`, with the propagated errors of slip and sinkage [%].
    pub carried_percent: f64,
    /// Slip ratio [-] of the row with the largest difference.
    pub worst_slip: f64,
    /// That difference over the row's load [%]: above 0 where more is predicted than measured.
    pub worst_percent: f64,
}

/// A row's load.
struct Load {
    slip: f64,
    measured: f64,
    /// Predicted minus measured [N].
    difference: f64,
    /// Standard uncertainty of the measured load [N].
    own: f64,
    /// As `own`, with the propagated errors of slip and sinkage [N].
    carried: f64,
}

impl LoadMissed {
    /// `None` where rows state no uncertainties or the differences are not significant (p > 0.001): given the
    /// uncertainties of the loads alone, or also given those of slip and sinkage if the mean error does not
    /// exceed any published one.
    pub(super) fn of(model: &Model, rows: &[SteadyLoad], at: &Coordinates) -> Option<Self> {
        let scale = Scale::of(rows);
        let loads: Vec<Load> = rows
            .iter()
            .filter_map(|row| Load::of(model, row, at, &scale))
            .collect();
        let mean =
            |of: &dyn Fn(&Load) -> f64| loads.iter().map(of).sum::<f64>() / loads.len() as f64;
        let size = mean(&|load| load.measured);
        let percent = 100.0 * mean(&|load| load.difference.abs()) / size;
        let is_beyond = |sd: fn(&Load) -> f64| {
            let squares = loads.iter().map(|load| load.difference / sd(load));
            by_chance(squares.map(|z| z * z).sum(), loads.len()) < UNLIKELY
        };
        let is_missed = is_beyond(|load| load.carried)
            || percent > LARGEST_PUBLISHED && is_beyond(|load| load.own);
        if !scale.known || !is_missed {
            return None;
        }
        let size_of = |load: &&Load| (load.difference / load.measured).abs();
        let worst = loads
            .iter()
            .max_by(|one, other| size_of(one).total_cmp(&size_of(other)))?;
        let rms =
            |of: fn(&Load) -> f64| 100.0 * libm::sqrt(mean(&|load| of(load) * of(load))) / size;
        Some(Self {
            percent,
            own_percent: rms(|load| load.own),
            carried_percent: rms(|load| load.carried),
            worst_slip: worst.slip,
            worst_percent: 100.0 * worst.difference / worst.measured,
        })
    }
}

impl Load {
    fn of(model: &Model, row: &SteadyLoad, at: &Coordinates, scale: &Scale) -> Option<Self> {
        let load = forces(model, at, row).find(|predicted| predicted.force == Force::Load)?;
        let sd = scale.of_row(row);
        let variance = variances(model, at, row, sd).normal_force;
        Some(Self {
            slip: row.slip,
            measured: load.measured,
            difference: load.predicted - load.measured,
            own: sd.load,
            carried: libm::sqrt(variance),
        })
    }
}

impl fmt::Display for LoadMissed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "at the measured slip and sinkage the predicted load deviates by {:.0} % from the measured load, by {:+.0} % \
             at slip {:.2}; its uncertainty is {:.1} %, with the errors of slip and sinkage {:.0} %",
            self.percent,
            self.worst_percent,
            self.worst_slip,
            self.own_percent,
            self.carried_percent,
        )
    }
}
