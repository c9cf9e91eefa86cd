//! The bootstrap: a statistic over items drawn with replacement.

use rand::{Rng, RngExt};

/// Values of a `statistic` of `count` resamples of `items`, each as many items drawn with replacement, in ascending
/// order; those that have none are left out.
pub fn bootstrap<T>(
    items: &[T],
    count: usize,
    rng: &mut impl Rng,
    statistic: impl Fn(&[&T]) -> Option<f64>,
) -> Vec<f64> {
    let mut resample = || -> Vec<&T> {
        let draw = |_| &items[rng.random_range(0..items.len())];
        (0..items.len()).map(draw).collect()
    };
    let values = (0..count).filter_map(|_| statistic(&resample()));
    super::sorted(values)
}
