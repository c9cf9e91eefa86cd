//! What simulated points tell of others nearby.
//!
//! A defect is a Gaussian process of squared exponential correlation over parameters and effects
//! (Sacks, Welch, Mitchell and Wynn 1989, Stat. Sci. 4:409-423): a point's defect is a weighted sum of
//! those that are known, and so is its slope along a parameter.

use super::emulator::Emulator;
use super::pins::Point;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Distance [prior standard deviations, typical magnitudes] over which a defect changes.
const LENGTH: f64 = 2.0;
/// Variance of a defect's error over its own: points side by side share what they tell.
const OWN: f64 = 0.005;

/// A defect known at some points.
pub(super) struct Kriging<'a> {
    emulator: &'a Emulator,
    known: Vec<&'a Point>,
    among: Option<Cholesky<f64, Dyn>>,
}

impl<'a> Kriging<'a> {
    pub fn new(emulator: &'a Emulator, known: Vec<&'a Point>) -> Self {
        let among = DMatrix::from_fn(known.len(), known.len(), |i, j| {
            let own = if i == j { OWN } else { 0.0 };
            alike(emulator, known[i], known[j]) + own
        });
        Self {
            emulator,
            known,
            among: among.cholesky(),
        }
    }

    /// Weights of known points, and the share of the variance that they tell.
    pub fn weights(&self, point: &Point) -> (Vec<f64>, f64) {
        let to_point = self.to(point);
        let weights = self.solved(&to_point);
        let told = weights.dot(&to_point);
        (weights.iter().copied().collect(), told)
    }

    /// Weights of known points in the slope along a parameter.
    pub fn slope(&self, point: &Point, parameter: usize) -> Vec<f64> {
        let ahead = |known: &&Point| known.offsets[parameter] - point.offsets[parameter];
        let ahead = DVector::from_iterator(self.known.len(), self.known.iter().map(ahead));
        let slopes = self.to(point).component_mul(&ahead) / (LENGTH * LENGTH);
        self.solved(&slopes).iter().copied().collect()
    }

    fn to(&self, point: &Point) -> DVector<f64> {
        let known = self.known.iter();
        let alike = known.map(|known| alike(self.emulator, known, point));
        DVector::from_iterator(self.known.len(), alike)
    }

    fn solved(&self, right: &DVector<f64>) -> DVector<f64> {
        let weights = self.among.as_ref().map(|among| among.solve(right));
        weights.unwrap_or_else(|| DVector::zeros(self.known.len()))
    }
}

/// Correlation of the defects of two points [-].
fn alike(emulator: &Emulator, a: &Point, b: &Point) -> f64 {
    let apart = emulator.apart(a, b) / LENGTH;
    libm::exp(-0.5 * apart * apart)
}
