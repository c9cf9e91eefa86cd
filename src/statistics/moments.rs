//! Means and variances.

/// Arithmetic mean; none of no values.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let sum = |(sum, count), value| (sum + value, count + 1_u64);
    let (sum, count) = values.into_iter().fold((0.0, 0), sum);
    (count > 0).then(|| sum / count as f64)
}

/// Mean of the samples that are numbers.
pub fn finite_mean(samples: &[f64]) -> Option<f64> {
    mean(samples.iter().copied().filter(|x| x.is_finite()))
}

/// Mean and unbiased variance; the variance of one value is 0.
pub fn mean_and_variance(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    [mean, square / (count - 1.0).max(1.0)]
}

/// Standard deviation of a sample, from the unbiased variance; none of fewer than two values.
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let [_, variance] = mean_and_variance(values);
    (values.len() > 1).then(|| libm::sqrt(variance))
}

/// Batches into which a series is cut for the error of its mean.
const BATCHES: usize = 8;

/// Standard error of the mean of a series whose samples are correlated, by the scatter of the means of eight batches (Law
/// 2015, *Simulation Modeling and Analysis*, section 9.5.3); without what is not a number, and 0 of fewer than two values.
pub fn batch_means_error(series: &[f64]) -> f64 {
    let length = series.len().div_ceil(BATCHES).max(1);
    let means: Vec<f64> = series.chunks(length).filter_map(finite_mean).collect();
    let count = means.len() as f64;
    standard_deviation(&means).map_or(0.0, |scatter| scatter / libm::sqrt(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deviation_of_a_sample_divides_by_one_less_than_its_size() {
        assert_eq!(standard_deviation(&[1.0, 3.0]), Some(libm::sqrt(2.0)));
        assert_eq!(standard_deviation(&[1.0]), None);
        assert_eq!(mean([]), None);
    }

    #[test]
    fn the_error_of_a_mean_counts_batches_and_not_the_samples_that_are_alike_within_them() {
        let alternating =
            |period: usize| -> Vec<f64> { (0..800).map(|k| (k / period % 2) as f64).collect() };
        // Batches of 100 samples are 0 and 1 in turn: a deviation of sqrt(2/7) over sqrt(8).
        let expected = libm::sqrt(2.0 / 7.0 / 8.0);
        assert!((batch_means_error(&alternating(100)) - expected).abs() < 1e-12);
        // Within batches the samples cancel.
        assert!(batch_means_error(&alternating(1)) < 1e-12);
        assert_eq!(batch_means_error(&[3.0]), 0.0);
        assert_eq!(batch_means_error(&[]), 0.0);
    }

    #[test]
    fn a_mean_leaves_gaps_out_where_it_is_asked_to() {
        assert_eq!(finite_mean(&[1.0, f64::NAN, 3.0]), Some(2.0));
        assert_eq!(finite_mean(&[f64::NAN]), None);
        assert!(mean([1.0, f64::NAN]).is_some_and(f64::is_nan));
    }
}
