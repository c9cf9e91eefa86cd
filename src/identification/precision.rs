//! Widths of intervals, from stated uncertainties or from the residual scatter.

use crate::statistics::student_quantile;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// Significance level below which a scatter is not attributed to chance.
pub(super) const UNLIKELY: f64 = 1e-3;

/// Residual scatter and the quantile for its intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Precision {
    /// Standard deviation of a weighted residual: 1 where the stated uncertainties are consistent.
    pub sigma: f64,
    /// 97.5 % quantile of the standardised error of an estimate.
    quantile: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Reduced chi square, where it exceeds what the stated uncertainties explain.
    pub misfit: Option<f64>,
}

impl Precision {
    /// With `known` uncertainties consistent with the scatter (p >= 0.001): these and the normal
    /// distribution. Otherwise the residual scatter and Student's t.
    pub fn new(known: bool, chi_square: f64, freedom: usize) -> Self {
        let reduced = chi_square / freedom as f64;
        let misfit =
            (known && freedom > 0 && by_chance(chi_square, freedom) < UNLIKELY).then_some(reduced);
        let (sigma, quantile) = match freedom {
            _ if known && misfit.is_none() => (1.0, Normal::standard().inverse_cdf(0.975)),
            0 => (f64::INFINITY, f64::INFINITY),
            _ => (libm::sqrt(reduced), student_quantile(0.975, freedom as f64)),
        };
        Self {
            sigma,
            quantile,
            freedom,
            misfit,
        }
    }

    /// Half-width of a 95 % interval in standard deviations for unit residuals.
    pub fn half_width(&self) -> f64 {
        self.sigma * self.quantile
    }

    /// Rise of the sum of squares at the ends of a 95 % interval; not below rounding.
    pub fn limit(&self) -> f64 {
        (self.half_width() * self.half_width()).max(1e-20)
    }
}

/// Probability of a sum of squares at least this large (chi-square survival function).
pub(super) fn by_chance(chi_square: f64, freedom: usize) -> f64 {
    let distribution = ChiSquared::new(freedom as f64);
    distribution.map_or(1.0, |distribution| distribution.sf(chi_square))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        let stated = Precision::new(true, 19.0, 19);
        assert!((stated.half_width() - 1.959_964).abs() < 1e-6 && stated.misfit.is_none());
        let scattered = Precision::new(false, 4.0 * 19.0, 19);
        assert!((scattered.half_width() / 2.0 - 2.093_024).abs() < 1e-5);
    }

    #[test]
    fn a_significant_scatter_widens_the_intervals_and_is_reported() {
        // 99.9 % quantile of chi square with 19 degrees of freedom: 43.82.
        assert!(Precision::new(true, 43.7, 19).misfit.is_none());
        let misfit = Precision::new(true, 43.9, 19);
        assert!((misfit.misfit.unwrap() - 43.9 / 19.0).abs() < 1e-12);
        assert!((misfit.sigma - (43.9f64 / 19.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn without_a_degree_of_freedom_intervals_are_infinite() {
        assert_eq!(Precision::new(false, 0.0, 0).half_width(), f64::INFINITY);
    }
}
