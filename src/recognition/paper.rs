//! The paper's regions of the feature space (Eq. 59-61) with its limits (57), (58), verbatim.
//!
//! The confidence of an answer is `m / (m + 0.1)`, where `m` is the distance \[decades\] of the
//! feature vector from the nearest border of its region, along one feature; that of UWTIC is taken
//! from the distance to the nearest region. It orders answers and is no probability.

use super::Answer;
use crate::terrain::class::Wtic;
use crate::vibration::bounds::{amplitude_bound, mean_square_bound};

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

/// The three regions (59), (60), (61) of a wheel with so many lugs.
pub fn regions(lugs: u32) -> [Region; 3] {
    let lg = libm::log10;
    let (a, ms) = (lg(amplitude_bound(lugs)), lg(mean_square_bound(lugs)));
    let same = [lg(1.0 - EPSILON_F), lg(1.0 + EPSILON_F)];
    let mean = [lg(LOWER), lg(EPSILON_MVU)];
    let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
    let region = |class, limits| Region { class, limits };
    [
        region(Wtic::Alct, [same, [lg(LOWER), a], mean, [lg(LOWER), ms]]),
        region(
            Wtic::Slct,
            [[low, same[0]], [a, high], [mean[1], high], [ms, high]],
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

/// The class of a feature vector of a wheel with so many lugs.
pub fn class(p: [f64; 4], lugs: u32) -> Answer {
    let margins = regions(lugs).map(|region| (region.class, region.margins(p)));
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
            offset: None,
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
        offset: None,
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

    /// `P` of these features.
    fn p(kappas: [f64; 4]) -> [f64; 4] {
        kappas.map(f64::log10)
    }

    #[test]
    fn the_paper_s_typical_windows_lie_in_their_regions() {
        for (kappas, expected) in [
            ([1.0, 1.2, 1.1, 1.5], Wtic::Alct),
            ([0.5, 20.0, 30.0, 500.0], Wtic::Slct),
            ([1.0, 0.2, 0.8, 0.05], Wtic::Leis),
            // Fewer but weak contacts: in no region of the paper.
            ([0.5, 1.2, 1.1, 1.5], Wtic::Uwtic),
        ] {
            assert_eq!(class(p(kappas), 28).class, expected, "{kappas:?}");
        }
    }

    #[test]
    fn limits_are_the_equations_and_the_borders_belong_to_alct() {
        let [alct, slct, leis] = regions(24);
        // Eq. (57) at 24 lugs is 3.983, (58) its square 15.86.
        assert!((alct.limits[1][1] - 3.983_f64.log10()).abs() < 1e-4);
        assert!((alct.limits[3][1] - 15.86_f64.log10()).abs() < 2e-3);
        assert_eq!(alct.limits[1][1], slct.limits[1][0]);
        assert_eq!(alct.limits[1][0], leis.limits[1][1]);
        assert_eq!(class(p([1.15, 0.5, 0.5, 0.5]), 24).class, Wtic::Alct);
        assert_eq!(class(p([1.16, 0.6, 0.6, 0.6]), 24).class, Wtic::Uwtic);
    }

    #[test]
    fn an_unknown_window_names_the_features_that_lie_outside() {
        let answer = class(p([1.0, 0.2, 0.3, 0.05]), 28);
        assert_eq!(answer.class, Wtic::Uwtic);
        assert_eq!(answer.reason, "nearest to LEIS, but p3 (mean) lies outside");
        assert_eq!(class([f64::NAN; 4], 28).class, Wtic::Uwtic);
    }

    #[test]
    fn confidence_grows_with_the_distance_from_the_border() {
        let near = class(p([1.14, 1.0, 1.0, 1.0]), 28).confidence;
        let far = class(p([1.0, 1.0, 1.0, 1.0]), 28).confidence;
        assert!(near < far && far < 1.0, "{near} {far}");
    }
}
