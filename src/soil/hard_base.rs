//! A soft layer over a hard base: sinkage saturates before the layer is pressed through.
//!
//! At depth `z` in a layer of thickness `H` the soil resists as ideal soil does at a greater
//! depth, which is `z` far above the base and grows without end towards it:
//!
//! ```text
//! ζ = z/(1 - z/H)      or, later and more suddenly,      ζ = -H ln(1 - z/H)
//! ```
//!
//! # Reference
//! The hyperbola is the simplest law with both limits. The logarithm: Wong (2008), *Theory of
//! Ground Vehicles*, 4th ed., of snow over ice, `p = p_w (-ln(1 - z/z_w))`.

use crate::soil::departures::Departures;
use crate::soil::real::Real;
use libm::log1p;

/// Nearness of a hard base below a soft layer, in its two forms.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HardBase {
    /// `1/H` [1/m] of the hyperbola.
    pub nearness: f64,
    /// `1/H` [1/m] of the logarithm.
    pub sudden: f64,
}

/// Share [-] of the layer that may be pressed: what is left transmits any pressure.
const DEEPEST: f64 = 0.999;

impl Departures {
    /// The hard base below the soil.
    pub fn hard_base(&self) -> HardBase {
        HardBase {
            nearness: self.base_nearness,
            sudden: self.sudden_base_nearness,
        }
    }
}

impl HardBase {
    /// Part [-] of the layer that is pressed at `depth` \[m\]; 0 on deep soil. With it the stress
    /// passes from that of soil which flows and springs back to that of hard ground, which does
    /// neither.
    pub fn pressed(&self, depth: f64) -> f64 {
        (depth * self.nearness.max(self.sudden)).clamp(0.0, 1.0)
    }

    /// Felt over real depth `ζ/z` [-] at `depth` \[m\]; 1 on deep soil.
    pub fn stretch<T: Real>(&self, depth: T) -> T {
        let deepest = T::constant(DEEPEST);
        let sudden = (depth * self.sudden).smaller(deepest);
        let logarithm = if sudden > 0.0 {
            -(-sudden).ln_1p() / sudden
        } else {
            T::constant(1.0)
        };
        logarithm / (-(depth * self.nearness).smaller(deepest) + 1.0)
    }

    /// How fast the felt depth grows with the real one, over the stretch `(dζ/dz)/(ζ/z)` [-], at
    /// `depth` \[m\]; 1 on deep soil.
    pub fn steepening(&self, depth: f64) -> f64 {
        let sudden = (depth * self.sudden).min(DEEPEST);
        let logarithm = if sudden > 0.0 {
            -sudden / ((1.0 - sudden) * log1p(-sudden)) - 1.0
        } else {
            0.0
        };
        logarithm + 1.0 / (1.0 - (depth * self.nearness).min(DEEPEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BASES: [HardBase; 3] = [
        HardBase {
            nearness: 50.0,
            sudden: 0.0,
        },
        HardBase {
            nearness: 0.0,
            sudden: 50.0,
        },
        HardBase {
            nearness: 30.0,
            sudden: 40.0,
        },
    ];

    #[test]
    fn far_above_the_base_nothing_is_felt_of_it() {
        for base in BASES {
            assert!((base.stretch(1e-6) - 1.0).abs() < 1e-4);
        }
        for depth in [0.0, 1e-3, 10.0] {
            assert_eq!(HardBase::default().stretch(depth), 1.0);
            assert_eq!(HardBase::default().pressed(depth), 0.0);
            assert_eq!(HardBase::default().steepening(depth), 1.0);
        }
    }

    #[test]
    fn towards_the_base_the_felt_depth_grows_without_end() {
        for base in BASES {
            let felt = |depth: f64| depth * base.stretch(depth);
            assert!(felt(0.01) > 0.01);
            assert!(felt(0.0199) > 2.0 * felt(0.015));
        }
        assert!(BASES.iter().all(|base| base.pressed(0.03) == 1.0));
        // The last thousandth bears any load.
        assert!(BASES[0].stretch(0.02) > 999.0 && BASES[0].stretch(0.03).is_finite());
    }

    #[test]
    fn the_logarithm_feels_the_base_later_than_the_hyperbola() {
        for depth in [0.002, 0.01, 0.019] {
            assert!(BASES[1].stretch(depth) < BASES[0].stretch(depth));
        }
    }

    #[test]
    fn steepening_is_the_logarithmic_slope_of_the_felt_depth() {
        for base in BASES {
            for depth in [0.001, 0.008, 0.015] {
                let felt = |z: f64| z * base.stretch(z);
                let h = 1e-8;
                let slope = (felt(depth + h) - felt(depth - h)) / (2.0 * h);
                let expected = slope / base.stretch(depth);
                // The central difference errs by rounding, some 1e-8 of the slope.
                assert!((base.steepening(depth) / expected - 1.0).abs() < 1e-6);
            }
        }
    }
}
