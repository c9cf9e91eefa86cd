//! Sums of products of long rows.

use crate::gap::moments;

/// Numbers added side by side, so that the processor need not wait for each sum.
const LANES: usize = 4;

/// `Σ a b`.
pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (whole, rest) = (a.chunks_exact(LANES), a.len() / LANES * LANES);
    for (a, b) in whole.zip(b.chunks_exact(LANES)) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let tail: f64 = a[rest..].iter().zip(&b[rest..]).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + tail
}

/// `a b`, number by number.
pub(super) fn scaled(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// Adds `factor a` to `sums`.
pub(super) fn add(sums: &mut [f64], factor: f64, a: &[f64]) {
    for (sum, a) in sums.iter_mut().zip(a) {
        *sum += factor * a;
    }
}

/// Numbers over their deviations.
pub(super) fn scores(numbers: &[f64], variance: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let numbers = numbers.iter().zip(variance);
    numbers
        .map(|(z, variance)| z / libm::sqrt(variance))
        .collect()
}

/// Mean of rows of one length, number by number.
pub(super) fn middle(rows: &[impl AsRef<[f64]>]) -> Vec<f64> {
    let mut sums = vec![0.0; rows.first().map_or(0, |row| row.as_ref().len())];
    for row in rows {
        add(&mut sums, 1.0 / rows.len() as f64, row.as_ref());
    }
    sums
}

/// Mean of rows of one length and its variance as they scatter, number by number.
pub(super) fn mean(rows: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let numbers = 0..rows.first().map_or(0, Vec::len);
    let of = |place: usize| {
        let column: Vec<f64> = rows.iter().map(|row| row[place]).collect();
        let [mean, variance] = moments(&column);
        (mean, variance / rows.len() as f64)
    };
    numbers.map(of).unzip()
}

/// `ln Σ exp`.
pub(super) fn log_sum(logs: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + libm::log(logs.map(|log| libm::exp(log - largest)).sum::<f64>())
}
