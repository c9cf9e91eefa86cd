//! Values counted against their bounds.

use crate::recognition::confusion::Share;
use serde::Serialize;
use statrs::distribution::{Binomial, DiscreteCDF};

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
            median: quantile(&values, 0.5),
            q95: quantile(&values, 0.95),
            q99: quantile(&values, 0.99),
            largest: values[values.len() - 1],
            bound: [bounds[0], bounds[bounds.len() - 1]],
            tightness: quantile(&ratios, 0.99),
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
        let limit = quantile(&ratios, 0.99);
        let above = others.iter().filter(|point| point.ratio() > limit);
        Some(Self {
            quantile: limit,
            ci95: quantile_interval(&ratios, 0.99),
            n: ratios.len(),
            exceeded: Share::of(above.count() as u64, others.len() as u64)?,
        })
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The smallest value that a `share` of all do not exceed.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted[rank.clamp(1, sorted.len()) - 1]
}

/// Values between which the quantile lies with 95 %: the number of values below it is binomial.
fn quantile_interval(sorted: &[f64], share: f64) -> [Option<f64>; 2] {
    let Ok(below) = Binomial::new(share, sorted.len() as u64) else {
        return [None, None];
    };
    let [low, high] = [0.025, 0.975].map(|p| below.inverse_cdf(p) as usize);
    [
        low.checked_sub(1)
            .and_then(|rank| sorted.get(rank))
            .copied(),
        sorted.get(high).copied(),
    ]
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

    /// Ranks 982 and 997 of 1000 cover the 990th with 95 % (tables of the binomial distribution).
    #[test]
    fn the_interval_of_a_quantile_is_that_of_its_order_statistics() {
        let values: Vec<f64> = (1..=1000).map(f64::from).collect();
        let [low, high] = quantile_interval(&values, 0.99).map(Option::unwrap);
        assert!((982.0..=984.0).contains(&low), "{low}");
        assert!((996.0..=997.0).contains(&high), "{high}");
        // The largest of 100 values lies below the 99 % quantile in one case of three.
        assert_eq!(quantile_interval(&values[..100], 0.99)[1], None);
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
