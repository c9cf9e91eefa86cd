//! Shares of counts.

use serde::Serialize;
use std::fmt;

/// A share of a count and its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Share {
    /// The share [-].
    pub value: f64,
    /// Wilson's 95 % interval [-].
    pub ci95: [f64; 2],
    /// Trials.
    pub n: u64,
}

/// Two-sided 95 % quantile of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

impl Share {
    /// `hits` of `n`; no share of nothing.
    ///
    /// # Reference
    /// Wilson (1927), J. Am. Stat. Assoc. 22:209-212.
    pub fn of(hits: u64, n: u64) -> Option<Self> {
        if n == 0 {
            return None;
        }
        let (trials, value) = (n as f64, hits as f64 / n as f64);
        let scale = 1.0 / (1.0 + Z * Z / trials);
        let centre = scale * (value + Z * Z / (2.0 * trials));
        let half = scale
            * Z
            * libm::sqrt(value * (1.0 - value) / trials + Z * Z / (4.0 * trials * trials));
        Some(Self {
            value,
            ci95: [(centre - half).max(0.0), (centre + half).min(1.0)],
            n,
        })
    }

    /// The share and the ends of its interval [-].
    pub fn with_ends(&self) -> [f64; 3] {
        [self.value, self.ci95[0], self.ci95[1]]
    }

    /// The share and the ends of its interval [%].
    pub fn percent(&self) -> [f64; 3] {
        self.with_ends().map(|share| 100.0 * share)
    }
}

/// `0.967 [0.886, 0.991]`.
impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [value, low, high] = self.with_ends();
        write!(f, "{value:.3} [{low:.3}, {high:.3}]")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_s_interval_of_292_of_300_is_the_textbook_s() {
        let share = Share::of(292, 300).unwrap();
        assert!((share.ci95[0] - 0.948_2).abs() < 2e-4, "{share:?}");
        assert!((share.ci95[1] - 0.986_4).abs() < 2e-4, "{share:?}");
        assert_eq!(Share::of(0, 5).unwrap().ci95[0], 0.0);
        assert_eq!(Share::of(0, 0), None);
    }
}
