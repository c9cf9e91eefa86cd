//! Quantiles of samples, by the definitions in use, and of the normal distribution.

use statrs::distribution::{Binomial, DiscreteCDF};
use std::f64::consts::{PI, SQRT_2};

/// Values in ascending order, NaN at the ends.
pub fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Median: the value in the middle, or the mean of the two there; none of no values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let sorted = sorted(values);
    let last = sorted.len().checked_sub(1)?;
    Some((sorted[last / 2] + sorted[sorted.len() / 2]) / 2.0)
}

/// Upper median: the value in the middle, or the greater of the two there; none of no values.
pub fn upper_median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median)
}

/// Quantile on straight lines between the order statistics (Hyndman and Fan's definition 7); NaN of no values.
pub fn quantile_linear(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let [below, above] = [place.floor(), place.ceil()].map(|it| sorted.get(it as usize));
    match (below, above) {
        (Some(below), Some(above)) => below + place.fract() * (above - below),
        _ => f64::NAN,
    }
}

/// Quantile by nearest rank: the smallest value that at least a `share` of all do not exceed (definition 1). There is
/// at least one value.
pub fn quantile_nearest_rank(sorted: &[f64], share: f64) -> f64 {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted[rank.clamp(1, sorted.len()) - 1]
}

/// Upper quantile: the value that follows the first `share` of all, and the last one beyond them; none of no values.
pub fn quantile_upper(sorted: &[f64], share: f64) -> Option<f64> {
    let place = (share * sorted.len() as f64) as usize;
    let last = sorted.len().checked_sub(1)?;
    Some(sorted[place.min(last)])
}

/// Quantile by nearest place: the order statistic nearest to that of [`quantile_linear`]; none of no values.
pub fn quantile_nearest_place(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    Some(sorted[libm::round(share * last as f64) as usize])
}

/// Values between which the quantile lies with 95 %: the number of values below it is binomial.
pub fn quantile_interval(sorted: &[f64], share: f64) -> [Option<f64>; 2] {
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

/// The standard normal quantile: `z` with `Φ(z) = u`, for `u` in (0, 1).
///
/// Newton's method from 0: below it Φ is convex, so every step stays right of the solution and the
/// next is nearer, until rounding ends it.
pub fn normal_quantile(u: f64) -> f64 {
    if u > 0.5 {
        return -normal_quantile(1.0 - u);
    }
    let mut z = 0.0;
    loop {
        let excess = 0.5 * libm::erfc(-z / SQRT_2) - u;
        let density = libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt();
        let next = z - excess / density;
        if next >= z || next.is_nan() {
            return z;
        }
        z = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ContinuousCDF, Normal};

    #[test]
    fn the_normal_quantile_inverts_the_distribution_function_far_into_its_tails() {
        let gauss = Normal::standard();
        for u in [
            1e-16,
            1e-9,
            0.001,
            0.025,
            0.3,
            0.5,
            0.8413447460685429,
            0.975,
            1.0 - 1e-9,
        ] {
            // 1e-10: what the other implementation's inverse is good for.
            let (ours, theirs) = (normal_quantile(u), gauss.inverse_cdf(u));
            assert!(
                (ours - theirs).abs() < 1e-10 * theirs.abs().max(1.0),
                "{u}: {ours} {theirs}"
            );
        }
        // Two-sided 95 %, from any table.
        assert!((normal_quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-14);
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
    fn the_definitions_of_a_quantile_differ_between_order_statistics_and_agree_at_them() {
        let four = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(median(four), Some(3.0));
        assert_eq!(upper_median(four), Some(4.0));
        assert_eq!(quantile_linear(&four, 0.5), 3.0);
        assert_eq!(quantile_nearest_rank(&four, 0.5), 2.0);
        assert_eq!(quantile_upper(&four, 0.5), Some(4.0));
        assert_eq!(quantile_nearest_place(&four, 0.4), Some(2.0));
        let five = [1.0, 2.0, 4.0, 8.0, 16.0];
        assert_eq!([median(five), upper_median(five)], [Some(4.0); 2]);
        assert_eq!(
            [
                quantile_linear(&five, 0.5),
                quantile_nearest_rank(&five, 0.5)
            ],
            [4.0; 2]
        );
        assert_eq!(
            [
                quantile_upper(&five, 0.5),
                quantile_nearest_place(&five, 0.5)
            ],
            [Some(4.0); 2]
        );
    }

    #[test]
    fn a_sample_ends_at_its_least_and_greatest_value_and_an_empty_one_has_no_quantile() {
        let two = [1.0, 2.0];
        assert_eq!([0.0, 1.0].map(|share| quantile_linear(&two, share)), two);
        assert_eq!(
            [0.0, 1.0].map(|share| quantile_nearest_rank(&two, share)),
            two
        );
        assert_eq!(
            [0.0, 1.0].map(|share| quantile_upper(&two, share)),
            two.map(Some)
        );
        assert_eq!(
            [0.0, 1.0].map(|share| quantile_nearest_place(&two, share)),
            two.map(Some)
        );
        assert!(quantile_linear(&[], 0.5).is_nan());
        assert_eq!(
            [median([]), upper_median([]), quantile_upper(&[], 0.5)],
            [None; 3]
        );
    }
}
