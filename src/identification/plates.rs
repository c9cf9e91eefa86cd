//! Pressure-sinkage parameters from plates pressed into the soil.

use crate::quantity::RangeError;

/// Modulus and exponent of `p = k zⁿ` under plates of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateFit {
    /// Sinkage modulus `k = k_c/b + k_φ` [N·m⁻⁽ⁿ⁺²⁾] under this plate.
    pub modulus: f64,
    /// Sinkage exponent `n` [-].
    pub exponent: f64,
    /// Points that counted.
    pub points: usize,
}

/// Why points give no pressure-sinkage law.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlateError {
    /// A number is no sinkage or no pressure.
    #[error("point {point}: {reason}")]
    Point {
        /// The point, from 1.
        point: usize,
        /// Quantity, range and value.
        reason: RangeError,
    },
    /// Fewer than two sinkages under pressure.
    #[error("points at two sinkages or more are needed, each with sinkage and pressure above 0")]
    TooFew,
}

impl PlateFit {
    /// The law that best explains `points` of sinkage [m] and pressure [Pa], as the plate goes
    /// down; those above the surface or without pressure do not count.
    ///
    /// Least squares of the logarithms, each point weighed by its pressure, so that errors count
    /// as they do in pressure: Wong (1980), *J. Terramechanics* 17:13-41.
    ///
    /// # Errors
    /// `Point` for a number that is not finite, `TooFew`.
    pub fn of(points: &[[f64; 2]]) -> Result<Self, PlateError> {
        for (index, [sinkage, pressure]) in points.iter().enumerate() {
            let finite = |name, unit, value| {
                RangeError::check(name, unit, value, [-f64::MAX, f64::MAX]).map_err(|reason| {
                    PlateError::Point {
                        point: index + 1,
                        reason,
                    }
                })
            };
            finite("sinkage", "m", *sinkage)?;
            finite("pressure", "Pa", *pressure)?;
        }
        let under: Vec<[f64; 2]> = points.iter().copied().filter(is_pressed).collect();
        let weight: f64 = under.iter().map(|[_, p]| p * p).sum();
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| {
            under
                .iter()
                .map(|point| point[1] * point[1] * of(point))
                .sum::<f64>()
                / weight
        };
        let [x, y] = [mean(&|p| libm::log(p[0])), mean(&|p| libm::log(p[1]))];
        let spread = mean(&|p| (libm::log(p[0]) - x) * (libm::log(p[0]) - x));
        let shared = mean(&|p| (libm::log(p[0]) - x) * (libm::log(p[1]) - y));
        // Rounding alone leaves 1e-30 of one sinkage.
        if under.len() < 2 || spread < 1e-20 {
            return Err(PlateError::TooFew);
        }
        let exponent = shared / spread;
        Ok(Self {
            modulus: libm::exp(y - exponent * x),
            exponent,
            points: under.len(),
        })
    }
}

fn is_pressed([sinkage, pressure]: &[f64; 2]) -> bool {
    *sinkage > 0.0 && *pressure > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_comes_back_whatever_lies_above_the_surface() {
        let law = |z: f64| [z, 8.0e6 * libm::pow(z, 1.46)];
        let mut points: Vec<[f64; 2]> = (1..40).map(|i| law(1e-3 * f64::from(i))).collect();
        points.push([-0.001, 30.0]);
        let fit = PlateFit::of(&points).unwrap();
        assert!((fit.modulus / 8.0e6 - 1.0).abs() < 1e-9, "{fit:?}");
        assert!((fit.exponent - 1.46).abs() < 1e-12, "{fit:?}");
        assert_eq!(fit.points, 39);
    }

    #[test]
    fn one_sinkage_or_a_gap_gives_no_law() {
        assert_eq!(PlateFit::of(&[[0.01, 5e3]; 3]), Err(PlateError::TooFew));
        let gap = PlateFit::of(&[[0.01, 5e3], [0.02, f64::NAN]]).unwrap_err();
        assert!(
            gap.to_string().starts_with("point 2: pressure [Pa]"),
            "{gap}"
        );
    }
}
