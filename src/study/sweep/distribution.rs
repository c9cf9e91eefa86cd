//! Distributions that swept keys are drawn from, each by its quantile function.

use crate::quantity::RangeError;
use crate::statistics::normal_quantile;
use serde::Deserialize;

/// A distribution of a key's values, in the key's unit.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Distribution {
    /// All values between two are equally likely.
    Uniform(Ends),
    /// All ratios between two values are equally likely.
    LogUniform(Ends),
    /// Normal.
    Normal(Normal),
    /// Its logarithm is normal.
    LogNormal(LogNormal),
    /// Likelihood rises in a straight line to a most likely value and falls in another.
    Triangular(Triangular),
    /// Some values, numbers or not, equally likely.
    OneOf(Vec<toml::Value>),
}

/// The names of the distributions, as a study file has them.
pub(super) const NAMES: [&str; 6] = [
    "uniform",
    "log_uniform",
    "normal",
    "log_normal",
    "triangular",
    "one_of",
];

/// Least and greatest value.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Ends {
    from: f64,
    to: f64,
}

/// Mean and standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Normal {
    mean: f64,
    sd: f64,
}

/// Two thirds (68.3 %) lie between the median over the factor and the median times the factor.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LogNormal {
    median: f64,
    factor: f64,
}

/// Least, most likely and greatest value.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Triangular {
    from: f64,
    mode: f64,
    to: f64,
}

/// The key below the distribution that is wrong, and why.
type Misfit = (&'static str, RangeError);

impl Distribution {
    /// # Errors
    /// The first number that describes no distribution.
    pub(super) fn check(&self) -> Result<(), Misfit> {
        match self {
            Self::Uniform(ends) => ends.check(f64::NEG_INFINITY),
            Self::LogUniform(ends) => ends.check(0.0),
            Self::Normal(Normal { mean, sd }) => {
                finite("mean", *mean)?;
                positive("standard deviation", *sd).map_err(|error| ("sd", error))
            }
            Self::LogNormal(LogNormal { median, factor }) => {
                positive("median", *median).map_err(|error| ("median", error))?;
                above("factor", "-", *factor, 1.0).map_err(|error| ("factor", error))
            }
            Self::Triangular(triangular) => triangular.check(),
            Self::OneOf(values) => {
                let count = values.len() as f64;
                let checked = RangeError::check("number of values", "-", count, [1.0, 1.0e5]);
                checked.map(|_| ()).map_err(|error| ("", error))
            }
        }
    }

    /// The value that a share `u` in (0, 1) of all values lies below, as TOML. Numbers have 12
    /// digits: more would only show how they were computed.
    pub(super) fn value(&self, u: f64) -> String {
        if let Self::OneOf(values) = self {
            let index = (u * values.len() as f64) as usize;
            return values[index.min(values.len() - 1)].to_string();
        }
        let number = super::in_twelve_digits(self.quantile(u));
        toml::Value::Float(number).to_string()
    }

    fn quantile(&self, u: f64) -> f64 {
        match *self {
            Self::Uniform(Ends { from, to }) => from * (1.0 - u) + to * u,
            Self::LogUniform(Ends { from, to }) => from * libm::pow(to / from, u),
            Self::Normal(Normal { mean, sd }) => mean + sd * normal_quantile(u),
            Self::LogNormal(LogNormal { median, factor }) => {
                median * libm::pow(factor, normal_quantile(u))
            }
            Self::Triangular(triangular) => triangular.quantile(u),
            Self::OneOf(_) => f64::NAN,
        }
    }
}

impl Ends {
    /// Finite, in order, above `least`.
    fn check(self, least: f64) -> Result<(), Misfit> {
        finite("from", self.from)?;
        above("least value", "key's", self.from, least).map_err(|error| ("from", error))?;
        finite("to", self.to)?;
        above("greatest value", "key's", self.to, self.from).map_err(|error| ("to", error))
    }
}

impl Triangular {
    fn check(self) -> Result<(), Misfit> {
        let Self { from, mode, to } = self;
        Ends { from, to }.check(f64::NEG_INFINITY)?;
        let checked = RangeError::check("most likely value", "key's", mode, [from, to]);
        checked.map(|_| ()).map_err(|error| ("mode", error))
    }

    /// The integral of the likelihood, a parabola on either side of the mode, inverted.
    fn quantile(self, u: f64) -> f64 {
        let Self { from, mode, to } = self;
        let (width, rise) = (to - from, mode - from);
        if u * width <= rise {
            from + (u * width * rise).sqrt()
        } else {
            to - ((1.0 - u) * width * (to - mode)).sqrt()
        }
    }
}

fn finite(key: &'static str, value: f64) -> Result<(), Misfit> {
    let checked = RangeError::check(
        "number of a distribution",
        "key's",
        value,
        [-1.0e300, 1.0e300],
    );
    checked.map(|_| ()).map_err(|error| (key, error))
}

fn positive(quantity: &'static str, value: f64) -> Result<(), RangeError> {
    RangeError::positive(quantity, "key's", value).map(|_| ())
}

fn above(
    quantity: &'static str,
    unit: &'static str,
    value: f64,
    least: f64,
) -> Result<(), RangeError> {
    if value > least && value.is_finite() {
        return Ok(());
    }
    Err(RangeError {
        quantity,
        unit,
        range: format!("above {least} and finite"),
        value,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use statrs::distribution::{ContinuousCDF, Normal as Gauss, Triangular as Triangle};

    proptest! {
        #[test]
        fn a_share_u_of_every_distribution_lies_below_its_quantile(
            u in 0.001..0.999f64, from in 0.1..5.0f64, width in 0.1..9.0f64, bend in 0.0..1.0f64,
        ) {
            let (to, mode) = (from + width, from + bend * width);
            let below = |distribution: Distribution| -> f64 { distribution.value(u).parse().unwrap() };
            let ends = Ends { from, to };
            // 1e-9: values have 12 digits, and the steepest of these spread over two decades.
            let uniform = (below(Distribution::Uniform(ends)) - from) / width;
            prop_assert!((uniform - u).abs() < 1e-9);
            let log = (below(Distribution::LogUniform(ends)) / from).ln() / (to / from).ln();
            prop_assert!((log - u).abs() < 1e-9);
            let normal = Distribution::Normal(Normal { mean: from, sd: width });
            let share = Gauss::new(from, width).unwrap().cdf(below(normal));
            prop_assert!((share - u).abs() < 1e-9);
            let log_normal = Distribution::LogNormal(LogNormal { median: from, factor: 1.0 + width });
            let z = (below(log_normal) / from).ln() / (1.0 + width).ln();
            prop_assert!((Gauss::standard().cdf(z) - u).abs() < 1e-9);
            let triangular = Distribution::Triangular(Triangular { from, mode, to });
            let share = Triangle::new(from, to, mode).unwrap().cdf(below(triangular));
            prop_assert!((share - u).abs() < 1e-9);
        }
    }

    #[test]
    fn each_of_some_values_has_its_equal_share_of_the_draws() {
        let of: Distribution = toml::from_str::<toml::Table>("one_of = [12, \"x\", 2.5]")
            .unwrap()
            .try_into()
            .unwrap();
        let drawn = [0.01, 0.33, 0.34, 0.66, 0.67, 0.99].map(|u| of.value(u));
        assert_eq!(drawn, ["12", "12", "\"x\"", "\"x\"", "2.5", "2.5"]);
    }
}
