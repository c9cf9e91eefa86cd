//! A number over cases, and how far it would differ over other cases of the kind.

use crate::quantity::Seed;
use crate::statistics::{Share, bootstrap, mean, median, quantile_nearest_place};
use serde::Serialize;

/// Times the cases are drawn anew.
const RESAMPLES: usize = 1_000;
/// Quantiles [-] of a 95 % interval.
const ENDS: [f64; 2] = [0.025, 0.975];

/// A number over cases.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Score {
    /// The number; none over no case.
    pub value: Option<f64>,
    /// Its 95 % interval by percentiles of a bootstrap over cases; Wilson's where all cases of a
    /// share agree, which drawn anew agree again; none over one case of anything else.
    pub ci95: Option<[f64; 2]>,
    /// Number of cases.
    pub n: usize,
}

impl Score {
    /// A statistic of items, one a case.
    pub(super) fn of<T>(items: &[T], statistic: impl Fn(&[&T]) -> Option<f64>) -> Self {
        let all: Vec<&T> = items.iter().collect();
        Self {
            value: statistic(&all),
            ci95: interval(items, statistic),
            n: items.len(),
        }
    }

    /// Share of what is true.
    pub(super) fn share(hits: impl IntoIterator<Item = bool>) -> Self {
        let hits: Vec<bool> = hits.into_iter().collect();
        let count = hits.iter().filter(|hit| **hit).count();
        let mut score = Self::of(&hits, |drawn| {
            mean(drawn.iter().map(|hit| f64::from(u8::from(**hit))))
        });
        if count == 0 || count == hits.len() {
            score.ci95 = Share::of(count as u64, hits.len() as u64).map(|share| share.ci95);
        }
        score
    }

    /// Mean of values.
    pub(super) fn mean(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        Self::of(&values, |drawn| mean(drawn.iter().map(|value| **value)))
    }

    /// Median of values.
    pub(super) fn median(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        Self::of(&values, |drawn| median(drawn.iter().map(|value| **value)))
    }
}

/// Ends of the 95 % interval of a statistic over items drawn anew.
fn interval<T>(items: &[T], statistic: impl Fn(&[&T]) -> Option<f64>) -> Option<[f64; 2]> {
    if items.len() < 2 {
        return None;
    }
    let mut rng = Seed(0).rng("score", items.len() as u64);
    let drawn = bootstrap(items, RESAMPLES, &mut rng, statistic);
    let [low, high] = ENDS.map(|end| quantile_nearest_place(&drawn, end));
    Some([low?, high?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bootstrap_interval_of_a_mean_is_that_of_the_normal_law() {
        // 0 to 399 in equal steps: sd 115.6, of the mean 5.78.
        let score = Score::mean((0..400).map(f64::from));
        let [low, high] = score.ci95.unwrap();
        assert_eq!(score.value, Some(199.5));
        // 1000 resamples know the ends of an interval to 0.09 standard errors; four of these.
        for (end, sign) in [(low, -1.0), (high, 1.0)] {
            let expected = 199.5 + sign * 1.96 * 5.78;
            assert!((end - expected).abs() < 0.36 * 5.78, "{end} {expected}");
        }
    }

    #[test]
    fn a_share_of_all_is_not_certain_and_one_of_none_is_nothing() {
        let all = Score::share([true; 10]);
        assert_eq!(all.value, Some(1.0));
        let [low, high] = all.ci95.unwrap();
        // Wilson: 1 / (1 + 1.96² / 10) = 0.722.
        assert!((low - 0.722).abs() < 1.0e-3, "{low}");
        assert!((high - 1.0).abs() < 1.0e-12, "{high}");
        let none = Score::share([]);
        assert_eq!((none.value, none.ci95, none.n), (None, None, 0));
    }
}
