//! Weights of the measured forces.

use super::row::{SteadyLoad, Uncertainty};

/// Standard uncertainties of the rows: their own where every row has them, otherwise one per channel in
/// proportion to its size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Whether the rows' own are used.
    pub known: bool,
    channels: Uncertainty,
}

impl Scale {
    /// The sizes of channels are their root mean squares, with a lower limit for pull and torque: a tenth of
    /// the load, and of the load times a tenth of a metre.
    pub fn of(rows: &[SteadyLoad]) -> Self {
        let rms = |channel: fn(&SteadyLoad) -> f64| {
            let measured = rows.iter().map(channel).filter(|value| !value.is_nan());
            let squares: f64 = measured.clone().map(|value| value * value).sum();
            libm::sqrt(squares / measured.count() as f64)
        };
        let load = rms(|row| row.load);
        Self {
            known: rows.iter().all(|row| row.uncertainty.is_some()),
            channels: Uncertainty {
                slip: 0.0,
                sinkage: 0.0,
                drawbar_pull: rms(|row| row.drawbar_pull).max(0.1 * load),
                load,
                driving_torque: rms(|row| row.driving_torque).max(0.01 * load),
            },
        }
    }

    /// The uncertainties of a row.
    pub fn of_row(&self, row: &SteadyLoad) -> Uncertainty {
        match row.uncertainty {
            Some(uncertainty) if self.known => uncertainty,
            _ => self.channels,
        }
    }
}
