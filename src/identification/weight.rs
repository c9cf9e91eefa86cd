//! How much each measured force counts.

use super::model::Model;
use super::parameter::Coordinates;
use super::row::{self, SteadyLoad, Uncertainty};
use crate::soil::wheel_load::WheelLoad;

/// Standard uncertainties of the forces: the rows' own where every row has them, else one for each
/// channel in proportion to its size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Whether the rows' own are used.
    pub known: bool,
    channels: Uncertainty,
}

impl Scale {
    /// The channels' sizes are their root mean squares; pull and torque weigh at most as if they
    /// were a tenth of the load and of the load a tenth of a metre off.
    pub fn of(rows: &[SteadyLoad]) -> Self {
        let rms = |channel: fn(&SteadyLoad) -> f64| {
            let squares: f64 = rows.iter().map(|row| channel(row) * channel(row)).sum();
            libm::sqrt(squares / rows.len() as f64)
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

/// Turns the errors of a row's pull, load and torque into as many independent ones of standard
/// deviation 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Whitener {
    /// Inverse of the Cholesky factor of the errors' covariance, in the order of `channels`.
    inverse: [[f64; 3]; 3],
    /// Load alone, or load, pull and torque.
    channels: usize,
}

impl Whitener {
    /// Errors of slip and sinkage reach all three forces at once, by the model's slopes at `at`.
    pub fn new(model: &Model, at: &Coordinates, row: &SteadyLoad, scale: Scale) -> Self {
        let covariance = covariance(model, at, row, scale);
        Self {
            inverse: inverse_cholesky(|i, j| covariance[i][j]),
            channels: if row::slips(row, model.class) { 3 } else { 1 },
        }
    }

    /// Number of errors.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The independent errors that make up `error`.
    pub fn whiten(&self, error: WheelLoad) -> impl Iterator<Item = f64> {
        let error = in_order(error);
        let inverse = self.inverse;
        (0..self.channels).map(move |i| (0..=i).map(|j| inverse[i][j] * error[j]).sum())
    }
}

/// Variances [N²; torque N²·m²] of a row's forces.
pub(super) fn variances(
    model: &Model,
    at: &Coordinates,
    row: &SteadyLoad,
    scale: Scale,
) -> WheelLoad {
    let covariance = covariance(model, at, row, scale);
    let [normal_force, drawbar_pull, driving_torque] = [0, 1, 2].map(|i| covariance[i][i]);
    WheelLoad {
        normal_force,
        drawbar_pull,
        driving_torque,
    }
}

/// Covariance of the errors of a row's load, pull and torque.
fn covariance(model: &Model, at: &Coordinates, row: &SteadyLoad, scale: Scale) -> [[f64; 3]; 3] {
    let uncertainty = scale.of_row(row);
    let own = [
        uncertainty.load,
        uncertainty.drawbar_pull,
        uncertainty.driving_torque,
    ];
    let [by_slip, by_sinkage] = slopes(model, at, row, uncertainty);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let own = if i == j { own[i] * own[i] } else { 0.0 };
            own + by_slip[i] * by_slip[j] + by_sinkage[i] * by_sinkage[j]
        })
    })
}

/// Load first: it is the one that stays where pull and torque say nothing.
fn in_order(load: WheelLoad) -> [f64; 3] {
    [load.normal_force, load.drawbar_pull, load.driving_torque]
}

/// Changes of the loads over one standard uncertainty of slip, and of sinkage.
fn slopes(
    model: &Model,
    at: &Coordinates,
    row: &SteadyLoad,
    uncertainty: Uncertainty,
) -> [[f64; 3]; 2] {
    let soil = model.soil(at);
    let change = |[low, high]: [SteadyLoad; 2], span: f64, sd: f64| {
        if sd == 0.0 {
            return [0.0; 3];
        }
        let [low, high] = [low, high].map(|row| in_order(model.contact(at, &row).loads(&soil)));
        [0, 1, 2].map(|i| (high[i] - low[i]) / span * sd)
    };
    // One-sided at the ends of the slip's range and at 0, where |s| has a kink.
    const SLIP: f64 = 1e-4;
    let low = if row.slip > 1.0 - SLIP {
        row.slip - SLIP
    } else {
        row.slip
    };
    let slips = [low, low + SLIP].map(|slip| SteadyLoad { slip, ..*row });
    let part = 1e-4 * row.sinkage;
    let sinkages = [-part, part].map(|d| SteadyLoad {
        sinkage: row.sinkage + d,
        ..*row
    });
    [
        change(slips, SLIP, uncertainty.slip),
        change(sinkages, 2.0 * part, uncertainty.sinkage),
    ]
}

/// Inverse of the lower triangle `L` with `L Lᵀ` the covariance.
fn inverse_cholesky(covariance: impl Fn(usize, usize) -> f64) -> [[f64; 3]; 3] {
    let mut factor = [[0.0; 3]; 3];
    let mut inverse = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = covariance(i, j) - known;
            factor[i][j] = if i == j {
                libm::sqrt(rest)
            } else {
                rest / factor[j][j]
            };
        }
        inverse[i][i] = 1.0 / factor[i][i];
        for j in 0..i {
            let sum: f64 = (j..i).map(|k| factor[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -sum * inverse[i][i];
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_factor_makes_correlated_errors_independent() {
        let covariance = [[4.0, 1.0, 0.5], [1.0, 9.0, -2.0], [0.5, -2.0, 1.0]];
        let inverse = inverse_cholesky(|i, j| covariance[i][j]);
        for i in 0..3 {
            for j in 0..3 {
                let mut whitened = 0.0;
                for (k, row) in covariance.iter().enumerate() {
                    for (l, entry) in row.iter().enumerate() {
                        whitened += inverse[i][k] * entry * inverse[j][l];
                    }
                }
                let expected = f64::from(u8::from(i == j));
                assert!((whitened - expected).abs() < 1e-12);
            }
        }
    }
}
