//! The paper's regions of the feature space (Eq. 59-61) with its limits (57), (58), verbatim.
//!
//! The confidence of an answer is `m / (m + 0.1)`, where `m` is the distance [decades] of the
//! feature vector from the nearest border of its region, along one feature; that of UWTIC is taken
//! from the distance to the nearest region. It orders answers and is no probability.

use super::Answer;
use crate::terrain::class::Wtic;

/// Half-width `ε_f` of `κ_f` about 1 [-].
pub const EPSILON_F: f64 = 0.15;
/// Lower limits `ε_Al, ε_mvl, ε_msl` of `κ_A, κ_mv, κ_ms` [-].
pub const LOWER: f64 = 0.5;
/// Upper limit `ε_mvu` of `κ_mv` [-].
pub const EPSILON_MVU: f64 = 10.0;

/// Margin [decades] at which the confidence is one half.
const HALF_CONFIDENCE: f64 = 0.1;

/// Names of the features in reasons.
const NAMES: [&str; 4] = [
    "p1 (frequency)",
    "p2 (amplitudes)",
    "p3 (mean)",
    "p4 (mean square)",
];

/// A box in the feature space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// The class of what lies in it.
    pub class: Wtic,
    /// Lowest and highest of each of `p_1 ... p_4` [-].
    pub limits: [[f64; 2]; 4],
}

/// Upper limit `ε_Au` of `κ_A` [-]: `(1 - cos α) / (1 - cos(α/2)) = 4 cos²(α/4)` (Eq. 57).
pub fn amplitude_limit(lug_angle: f64) -> f64 {
    let half = libm::cos(0.25 * lug_angle);
    4.0 * half * half
}

/// The three regions (59), (60), (61) for a wheel of this lug angle [rad].
pub fn regions(lug_angle: f64) -> [Region; 3] {
    let lg = libm::log10;
    let (a, ms) = (
        amplitude_limit(lug_angle),
        amplitude_limit(lug_angle) * amplitude_limit(lug_angle),
    );
    let same = [lg(1.0 - EPSILON_F), lg(1.0 + EPSILON_F)];
    let mean = [lg(LOWER), lg(EPSILON_MVU)];
    let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
    let region = |class, limits| Region { class, limits };
    [
        region(
            Wtic::Alct,
            [same, [lg(LOWER), lg(a)], mean, [lg(LOWER), lg(ms)]],
        ),
        region(
            Wtic::Slct,
            [
                [low, same[0]],
                [lg(a), high],
                [mean[1], high],
                [lg(ms), high],
            ],
        ),
        region(Wtic::Leis, [same, [low, lg(LOWER)], mean, [low, lg(LOWER)]]),
    ]
}

impl Region {
    /// Distance [decades] of each feature into the region; below zero outside.
    fn margins(&self, p: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|i| {
            let [low, high] = self.limits[i];
            (p[i] - low).min(high - p[i])
        })
    }
}

/// The class of a feature vector of a wheel of this lug angle [rad].
pub fn class(p: [f64; 4], lug_angle: f64) -> Answer {
    let margins = regions(lug_angle).map(|region| (region.class, region.margins(p)));
    let inside = |(_, margins): &(Wtic, [f64; 4])| margins.iter().all(|margin| *margin >= 0.0);
    let smallest = |margins: [f64; 4]| margins.into_iter().fold(f64::INFINITY, f64::min);
    if p.iter().any(|p| p.is_nan()) {
        return Answer::unknown("a feature is no number");
    }
    if let Some((class, margins)) = margins.into_iter().find(inside) {
        return Answer {
            class,
            confidence: confidence(smallest(margins)),
            reason: format!("P lies in the region of {class}"),
        };
    }
    let nearest = margins
        .into_iter()
        .max_by(|a, b| shortfall(a.1).total_cmp(&shortfall(b.1)));
    let (class, margins) = nearest.expect("there are three regions");
    let outside: Vec<&str> = (0..4)
        .filter(|&i| margins[i] < 0.0)
        .map(|i| NAMES[i])
        .collect();
    Answer {
        class: Wtic::Uwtic,
        confidence: confidence(-smallest(margins)),
        reason: format!(
            "nearest to {class}, but {} lies outside",
            outside.join(", ")
        ),
    }
}

/// Sum of the negative margins.
fn shortfall(margins: [f64; 4]) -> f64 {
    margins.into_iter().map(|margin| margin.min(0.0)).sum()
}

fn confidence(margin: f64) -> f64 {
    if margin.is_infinite() {
        1.0
    } else {
        margin / (margin + HALF_CONFIDENCE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn eq_57_and_58_read_as_printed_at_24_and_28_lugs() {
        for (lugs, expected) in [(24.0, 3.983), (28.0, 3.987)] {
            let alpha: f64 = TAU / lugs;
            let printed = (1.0 - alpha.cos()) / (1.0 - (alpha / 2.0).cos());
            assert!((amplitude_limit(alpha) - printed).abs() < 1e-12);
            assert!((printed - expected).abs() < 5e-4);
            let [alct, ..] = regions(alpha);
            assert!((alct.limits[3][1] - 2.0 * printed.log10()).abs() < 1e-12);
        }
    }
}
