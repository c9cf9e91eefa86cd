//! Joint fit of all rows and channels (Eq. 62-64).

use super::least_squares::Residuals;
use super::model::Model;
use super::observation::Observation;
use super::parameter::Coordinates;
use super::row::SteadyLoad;
use super::weight::Scale;

/// Residuals of loads, slip and sinkage against Eq. (62)-(64).
#[derive(Debug, Clone)]
pub(super) struct Joint {
    model: Model,
    rows: Vec<Observation>,
}

impl Joint {
    pub fn new(model: Model, rows: &[SteadyLoad]) -> Self {
        let scale = Scale::of(rows);
        let observed = |row: &SteadyLoad| Observation::new(&model, row, scale.of_row(row));
        Self {
            rows: rows.iter().map(observed).collect(),
            model,
        }
    }

    /// Number of measured forces used.
    pub fn forces(&self) -> usize {
        self.rows.iter().map(Observation::forces).sum()
    }
}

impl Residuals for Joint {
    fn residuals(&self, at: &Coordinates) -> Vec<f64> {
        let rows = self.rows.iter();
        rows.flat_map(|row| row.residuals(&self.model, at))
            .collect()
    }

    fn gradient(&self, at: &Coordinates) -> Vec<Coordinates> {
        let rows = self.rows.iter();
        rows.flat_map(|row| row.gradient(&self.model, at)).collect()
    }
}
