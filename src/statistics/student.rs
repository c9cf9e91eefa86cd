//! Student's t distribution.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Quantile of Student's t; infinite without a degree of freedom.
pub fn student_quantile(share: f64, freedom: f64) -> f64 {
    let distribution = StudentsT::new(0.0, 1.0, freedom);
    distribution.map_or(f64::INFINITY, |t| t.inverse_cdf(share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        assert!((student_quantile(0.975, 19.0) - 2.093_024).abs() < 1e-6);
        assert!((student_quantile(0.975, 1.0) - 12.706_205).abs() < 1e-5);
        assert_eq!(student_quantile(0.975, 0.0), f64::INFINITY);
    }
}
