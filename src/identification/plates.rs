//! Pressure-sinkage modulus and exponent from plate tests.

use crate::quantity::RangeError;

/// Modulus and exponent of `p = k zⁿ` under plates of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateFit {
    /// Sinkage modulus `k = k_c/b + k_φ` [N·m⁻⁽ⁿ⁺²⁾] under this plate.
    pub modulus: f64,
    /// Sinkage exponent `n` [-].
    pub exponent: f64,
    /// Number of points used.
    pub points: usize,
}

/// Why points give no pressure-sinkage law.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlateError {
    /// A run of a wheel.
    #[error("the run has no plate: state plate_diameter_m, or plate_length_m and plate_width_m")]
    NoPlate,
    /// A quantity is neither a channel nor a mean.
    #[error("{0} is missing or has no finite value: a plate test needs sinkage and normal_force")]
    Missing(&'static str),
    /// A sinkage or pressure is out of range.
    #[error("point {point}: {reason}")]
    Point {
        /// The point, from 1.
        point: usize,
        /// Quantity, range and value.
        reason: RangeError,
    },
    /// Fewer than two distinct sinkages under pressure.
    #[error(
        "points at two sinkages or more are needed, each with sinkage and pressure above 0: check the signs of \
         sinkage and normal_force"
    )]
    TooFew,
}

impl PlateFit {
    /// Least-squares fit to `points` of sinkage \[m\] and pressure \[Pa\] during loading; points above the
    /// surface or without pressure are excluded.
    ///
    /// Fitted in logarithms with weights in proportion to pressure squared, so that errors are weighted as in
    /// pressure: Wong (1980), *J. Terramechanics* 17:13-41.
    ///
    /// # Errors
    /// `Point` for a number that is not finite, `TooFew`.
    pub fn of(points: &[[f64; 2]]) -> Result<Self, PlateError> {
        let sums = LogSums::of(points)?;
        let exponent = common_exponent([&sums]).ok_or(PlateError::TooFew)?;
        Ok(Self {
            modulus: sums.modulus(exponent),
            exponent,
            points: sums.points,
        })
    }
}

/// Weighted sums over the logarithms of points (sufficient statistics of the fit).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct LogSums {
    /// Number of points used.
    pub points: usize,
    weight: f64,
    /// Sums of the logarithms of sinkage and pressure.
    sums: [f64; 2],
    /// Sums of squares of the log sinkage, and of products of both.
    products: [f64; 2],
}

impl LogSums {
    /// # Errors
    /// `Point` for a number that is not finite.
    pub fn of(points: &[[f64; 2]]) -> Result<Self, PlateError> {
        let mut sums = Self::default();
        for (index, point) in points.iter().enumerate() {
            let finite = |name, unit, value| {
                RangeError::check(name, unit, value, [-f64::MAX, f64::MAX]).map_err(|reason| {
                    PlateError::Point {
                        point: index + 1,
                        reason,
                    }
                })
            };
            finite("sinkage", "m", point[0])?;
            finite("pressure", "Pa", point[1])?;
            if is_pressed(point) {
                sums = sums.and(&Self::of_point(*point));
            }
        }
        Ok(sums)
    }

    fn of_point([sinkage, pressure]: [f64; 2]) -> Self {
        let weight = pressure * pressure;
        let [x, y] = [libm::log(sinkage), libm::log(pressure)];
        Self {
            points: 1,
            weight,
            sums: [weight * x, weight * y],
            products: [weight * x * x, weight * x * y],
        }
    }

    /// Sums of both sets.
    pub fn and(&self, other: &Self) -> Self {
        let sum = |one: [f64; 2], other: [f64; 2]| [one[0] + other[0], one[1] + other[1]];
        Self {
            points: self.points + other.points,
            weight: self.weight + other.weight,
            sums: sum(self.sums, other.sums),
            products: sum(self.products, other.products),
        }
    }

    /// Weighted means of the logarithms of sinkage and pressure.
    fn means(&self) -> [f64; 2] {
        self.sums.map(|sum| sum / self.weight)
    }

    /// Modulus for this exponent through the mean of the points.
    pub fn modulus(&self, exponent: f64) -> f64 {
        let [x, y] = self.means();
        libm::exp(y - exponent * x)
    }
}

/// The common exponent of several plate sizes, each with its own modulus; `None` where no size has points at
/// two sinkages.
pub(super) fn common_exponent<'a>(sizes: impl IntoIterator<Item = &'a LogSums>) -> Option<f64> {
    let mut spread = [0.0; 2];
    let mut weight = 0.0;
    for size in sizes.into_iter().filter(|size| size.points > 0) {
        let [x, y] = size.means();
        spread[0] += size.products[0] - size.weight * x * x;
        spread[1] += size.products[1] - size.weight * x * y;
        weight += size.weight;
    }
    // At one sinkage rounding leaves about 1e-14 of the squared logarithms.
    (spread[0] > 1e-12 * weight).then(|| spread[1] / spread[0])
}

pub(super) fn is_pressed([sinkage, pressure]: &[f64; 2]) -> bool {
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
