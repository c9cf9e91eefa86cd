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
    fn a_mean_leaves_gaps_out_where_it_is_asked_to() {
        assert_eq!(finite_mean(&[1.0, f64::NAN, 3.0]), Some(2.0));
        assert_eq!(finite_mean(&[f64::NAN]), None);
        assert!(mean([1.0, f64::NAN]).is_some_and(f64::is_nan));
    }
}
