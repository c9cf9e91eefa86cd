//! Soil that resists the more, the faster it is pressed.
//!
//! Air, water and grains that have to move out of the way make pressure grow with the rate at
//! which a surface penetrates. A rim that enters at `θ_1` presses each place from 0 to `z` while
//! it travels `r sin θ_1`, at the mean rate `ż = |v| tan(θ_1/2)`. Vibration is not counted in: its
//! losses are the soil's damping.
//!
//! # Reference
//! Power law: Grahn (1991), J. Terramechanics 28(4):339-347, `p = k zⁿ żᵐ`. Logarithm: the usual
//! law of rate effects in penetrometry.

use crate::soil::departures::Departures;
use libm::{log1p, pow, tan};

/// Rate `ż_0` [m/s] at which the soil's moduli hold: that of a rim of 140 mm, 10 mm deep, at
/// 20 mm/s.
pub const REFERENCE_RATE: f64 = 4.0e-3;

/// Share of it below which pressing counts as quasi-static [-].
const QUASI_STATIC: f64 = 0.01;

/// Mean rate [m/s] at which a rim that enters at `entry` \[rad\] and travels at `forward_speed`
/// [m/s] presses the soil.
pub fn penetration_rate(forward_speed: f64, entry: f64) -> f64 {
    forward_speed.abs() * tan(0.5 * entry)
}

impl Departures {
    /// Pressure at a penetration `rate` [m/s] over that at [`REFERENCE_RATE`], or over the
    /// quasi-static one in the logarithmic form [-].
    ///
    /// ```text
    /// (ż/ż_0)ᵐ (1 + κ ln(1 + ż/ż_0))
    /// ```
    ///
    /// Below a hundredth of the reference rate the first part falls no further. 1 on ideal soil.
    pub fn rate_factor(&self, rate: f64) -> f64 {
        let ratio = rate / REFERENCE_RATE;
        pow(ratio.max(QUASI_STATIC), self.rate_exponent)
            * (1.0 + self.rate_logarithm * log1p(ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::contact::entry_angle;

    #[test]
    fn twice_the_rate_multiplies_pressure_by_two_to_the_exponent() {
        let soil = Departures {
            rate_exponent: 0.1,
            ..Departures::NONE
        };
        let ratio = soil.rate_factor(8.0e-3) / soil.rate_factor(4.0e-3);
        assert!((ratio - pow(2.0, 0.1)).abs() < 1e-14);
        assert_eq!(soil.rate_factor(REFERENCE_RATE), 1.0);
        assert_eq!(soil.rate_factor(0.0), soil.rate_factor(1.0e-5));
    }

    #[test]
    fn ten_times_a_fast_rate_adds_the_same_share_of_pressure_each_time() {
        let soil = Departures {
            rate_logarithm: 0.05,
            ..Departures::NONE
        };
        let gain = |rate: f64| soil.rate_factor(10.0 * rate) - soil.rate_factor(rate);
        let expected = 0.05 * 10f64.ln();
        // The 1 under the logarithm is a 25th and a 250th of the rate.
        assert!((gain(0.1) / expected - 1.0).abs() < 0.02);
        assert!((gain(1.0) / expected - 1.0).abs() < 0.002);
        assert_eq!(soil.rate_factor(0.0), 1.0);
    }

    #[test]
    fn ideal_soil_is_rate_independent() {
        for rate in [0.0, 1e-9, 1e-3, 10.0] {
            assert_eq!(Departures::NONE.rate_factor(rate), 1.0);
        }
    }

    #[test]
    fn the_mean_penetration_rate_is_sinkage_over_the_time_of_passing() {
        let (radius, sinkage, speed) = (0.14, 0.01, 0.02);
        let entry = entry_angle(radius, sinkage);
        let passing = radius * entry.sin() / speed;
        let rate = penetration_rate(speed, entry);
        assert!((rate / (sinkage / passing) - 1.0).abs() < 1e-12);
        assert_eq!(rate, penetration_rate(-speed, entry));
    }
}
