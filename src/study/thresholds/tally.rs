//! Values counted against their bounds.

use crate::statistics::{Share, quantile_interval, quantile_nearest_rank, sorted};
use serde::Serialize;

/// A value and what it is to stay below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded {
    /// The value [-].
    pub value: f64,
    /// Its bound [-].
    pub bound: f64,
}

impl Bounded {
    /// The value over its bound [-].
    pub fn ratio(&self) -> f64 {
        self.value / self.bound
    }
}

/// Values and their bounds, counted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tally {
    /// How many.
    pub n: usize,
    /// Median of the values [-].
    pub median: f64,
    /// Their 95 % quantile [-].
    pub q95: f64,
    /// Their 99 % quantile [-].
    pub q99: f64,
    /// The largest [-].
    pub largest: f64,
    /// Smallest and largest bound [-].
    pub bound: [f64; 2],
    /// The 99 % quantile of value over bound [-].
    pub tightness: f64,
    /// Share of values above their bound. Its interval takes windows for independent.
    pub violations: Share,
}

impl Tally {
    /// `None` of nothing.
    pub fn of(points: &[Bounded]) -> Option<Self> {
        let above = points.iter().filter(|point| point.value > point.bound);
        let violations = Share::of(above.count() as u64, points.len() as u64)?;
        let values = sorted(points.iter().map(|point| point.value));
        let bounds = sorted(points.iter().map(|point| point.bound));
        let ratios = sorted(points.iter().map(Bounded::ratio));
        Some(Self {
            n: points.len(),
            median: quantile_nearest_rank(&values, 0.5),
            q95: quantile_nearest_rank(&values, 0.95),
            q99: quantile_nearest_rank(&values, 0.99),
            largest: values[values.len() - 1],
            bound: [bounds[0], bounds[bounds.len() - 1]],
            tightness: quantile_nearest_rank(&ratios, 0.99),
            violations,
        })
    }
}

/// A limit taken from the values themselves, not from mechanics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Empirical {
    /// The 99 % quantile of value over bound [-].
    pub quantile: f64,
    /// Its 95 % interval from order statistics; no upper end where there are too few values.
    pub ci95: [Option<f64>; 2],
    /// Values it was made of.
    pub n: usize,
    /// Share of other values above it.
    pub exceeded: Share,
}

impl Empirical {
    /// From the values `made_of`, checked on `others`; `None` where either is nothing.
    pub fn of(made_of: &[Bounded], others: &[Bounded]) -> Option<Self> {
        let ratios = sorted(made_of.iter().map(Bounded::ratio));
        if ratios.is_empty() {
            return None;
        }
        let limit = quantile_nearest_rank(&ratios, 0.99);
        let above = others.iter().filter(|point| point.ratio() > limit);
        Some(Self {
            quantile: limit,
            ci95: quantile_interval(&ratios, 0.99),
            n: ratios.len(),
            exceeded: Share::of(above.count() as u64, others.len() as u64)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(values: impl Iterator<Item = f64>) -> Vec<Bounded> {
        values.map(|value| Bounded { value, bound: 4.0 }).collect()
    }

    #[test]
    fn a_hundred_values_up_to_5_of_which_20_exceed_4() {
        let tally = Tally::of(&points((1..=100).map(|i| 0.05 * f64::from(i)))).unwrap();
        assert_eq!(
            (tally.n, tally.violations),
            (100, Share::of(20, 100).unwrap())
        );
        assert_eq!([tally.median, tally.q95], [2.5, 4.75]);
        assert!((tally.q99 - 4.95).abs() < 1e-12 && (tally.largest - 5.0).abs() < 1e-12);
        assert!((tally.tightness - 4.95 / 4.0).abs() < 1e-12);
        assert_eq!(tally.bound, [4.0, 4.0]);
        assert_eq!(Tally::of(&[]), None);
    }

    #[test]
    fn an_empirical_limit_is_checked_on_other_values_than_it_was_made_of() {
        let made_of = points((1..=100).map(|i| 0.04 * f64::from(i)));
        let others = points([1.0, 2.0, 3.0, 5.0].into_iter());
        let limit = Empirical::of(&made_of, &others).unwrap();
        assert!((limit.quantile - 0.99).abs() < 1e-12);
        assert_eq!((limit.n, limit.exceeded), (100, Share::of(1, 4).unwrap()));
        assert_eq!(Empirical::of(&made_of, &[]), None);
    }
}
