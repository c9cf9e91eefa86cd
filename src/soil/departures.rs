//! Deviations from the ideal soil, which is deep, undisturbed, rate-independent and without heaps.
//!
//! Each number is a deviation from that, 0 on ideal soil, where it changes no bit of a run. Some have two
//! alternative laws, so that an effect found with one can be tested against the other.
//!
//! The laws of one place, of the soil's moduli and depths, hold in the quadrature of
//! [`crate::soil::wheel_load`] too; rate and heap need a motion, and are the simulator's alone.
//!
//! | departure | law | where |
//! |---|---|---|
//! | slip digs | `z → z/(1 + w(g(s) - 1))` | [`Departures::depth_factor`] |
//! | former passes | `k_s → k_s (1 + m (1 - e^(-p/p_0)))` | [`Departures::modulus_factor`] |
//! | small wheel | `k_s → k_s (D/D_0)ᵐ` below `D_0` | [`Departures::diameter_factor`] |
//! | precompression | virgin curve from `z_p` on | [`crate::soil::pressure_sinkage`] |
//! | hard base, two forms | `z → z/(1 - z/H)`, `z → -H ln(1 - z/H)` | [`crate::soil::hard_base`] |
//! | penetration rate, two forms | `p ∝ żᵐ`, `p ∝ 1 + κ ln(1 + ż/ż_0)` | [`crate::soil::penetration_rate`] |
//! | heap, two forms | passive pressure on a heap, or on the sunken face | [`crate::soil::bulldozing`] |
//! | clinging layer | `r_s → r_s + h` | [`crate::soil::lug_action::shear_radius`] |

use crate::quantity::RangeError;
use crate::soil::real::Real;
use libm::expm1;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Departures of a soil from the ideal; all 0 on ideal soil.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Departures {
    /// Weight `w` [-] of Lyasko's slip-sinkage term, beside `n_1`; 1 is the full term.
    #[serde(skip_serializing_if = "is_zero")]
    pub slip_digging: f64,
    /// Gain `m` [-] of the soil's moduli where many wheels have passed; the number of passes is one, or
    /// [`earlier_passes`](Self::earlier_passes).
    #[serde(skip_serializing_if = "is_zero")]
    pub compaction: f64,
    /// Number [-] of wheels that passed before the last one; the surface is that of their rut.
    #[serde(skip_serializing_if = "is_zero")]
    pub earlier_passes: f64,
    /// Depth `z_p` \[m\] of an earlier precompression, below the surface before it.
    #[serde(skip_serializing_if = "is_zero")]
    pub precompression: f64,
    /// Inverse depth `1/H` [1/m] of a rigid base: `z` is replaced by `z/(1 - z/H)`.
    #[serde(skip_serializing_if = "is_zero")]
    pub base_nearness: f64,
    /// Inverse depth `1/H` [1/m] of a rigid base: `z` is replaced by `-H ln(1 - z/H)`, which acts later and more
    /// abruptly.
    #[serde(skip_serializing_if = "is_zero")]
    pub sudden_base_nearness: f64,
    /// Exponent `m` [-] of pressure over penetration rate.
    #[serde(skip_serializing_if = "is_zero")]
    pub rate_exponent: f64,
    /// Share `κ` [-] by which pressure grows with the logarithm of the penetration rate.
    #[serde(skip_serializing_if = "is_zero")]
    pub rate_logarithm: f64,
    /// Share `χ` [-] of the soil in its way that the wheel pushes ahead as a heap.
    #[serde(skip_serializing_if = "is_zero")]
    pub heap: f64,
    /// Multiple `B` [-] of the passive pressure on a wall of the wheel's width and sinkage.
    #[serde(skip_serializing_if = "is_zero")]
    pub front_pressure: f64,
    /// Thickness \[m\] of a layer of soil that clings to the wheel and shears at its outside.
    #[serde(skip_serializing_if = "is_zero")]
    pub clinging_layer: f64,
    /// Exponent `m` [-] of pressure over the diameter of a small wheel; above 0 a smaller one sinks deeper.
    #[serde(skip_serializing_if = "is_zero")]
    pub diameter_exponent: f64,
}

/// Number of passes `p_0` [-] that bring 63 % of the gain: the first does most. A guess.
const LASTING_PASSES: f64 = 1.5;

/// Wheel diameter `D_0` [m] above which plate tests are representative.
const LARGE_DIAMETER: f64 = 0.5;

impl Departures {
    /// Ideal soil.
    pub const NONE: Self = Self {
        slip_digging: 0.0,
        compaction: 0.0,
        earlier_passes: 0.0,
        precompression: 0.0,
        base_nearness: 0.0,
        sudden_base_nearness: 0.0,
        rate_exponent: 0.0,
        rate_logarithm: 0.0,
        heap: 0.0,
        front_pressure: 0.0,
        clinging_layer: 0.0,
        diameter_exponent: 0.0,
    };

    /// Whether the soil is ideal.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// How many times as deep as in ideal soil a pressure presses this soil at `slip` [-].
    ///
    /// ```text
    /// f = 1 + w (g(s) - 1),  g(s) = (1 + s)/(1 - s/2)
    /// ```
    ///
    /// A slipping wheel digs: its depth at slip `s` is `g(s)` times that at 0. 1 on ideal soil.
    ///
    /// # Reference
    /// Lyasko (2010), J. Terramechanics 47(1):21-31.
    pub fn depth_factor<T: Real>(&self, slip: T) -> T {
        let slip = slip.magnitude();
        ((slip + 1.0) / (-slip * 0.5 + 1.0) - 1.0) * self.slip_digging + 1.0
    }

    /// How many times as hard as fresh soil this soil is [-].
    ///
    /// ```text
    /// 1 + m (1 - e^(-p/p_0)),  p_0 = 1.5
    /// ```
    ///
    /// `p` wheels passed before, one and the [earlier ones](Self::earlier_passes); the first changed
    /// most. 1 on ideal soil.
    ///
    /// # Reference
    /// Holm (1969), J. Terramechanics 6(3):47-71, on passes of wheels; the form and `p_0` are a
    /// guess.
    pub fn modulus_factor(&self) -> f64 {
        1.0 - self.compaction * expm1(-(1.0 + self.earlier_passes) / LASTING_PASSES)
    }

    /// How many times as hard the soil is under a wheel of `diameter` \[m\] as under a flat plate of its width [-].
    ///
    /// ```text
    /// (D/D_0)ᵐ below D_0 = 0.5 m, else 1
    /// ```
    ///
    /// The arc of a small wheel leaves soil more ways to flow than a plate does.
    ///
    /// # Reference
    /// `p = k zⁿ Dᵐ` of rigid wheels smaller than some 0.5 m: Meirion-Griffith and Spenko (2011), J. Terramechanics
    /// 48(2):149-155.
    pub fn diameter_factor(&self, diameter: f64) -> f64 {
        libm::pow((diameter / LARGE_DIAMETER).min(1.0), self.diameter_exponent)
    }

    /// # Errors
    /// `RangeError` for a departure outside its physical range.
    pub fn check(&self) -> Result<(), RangeError> {
        let checks = [
            ("slip digging", "-", self.slip_digging, 10.0),
            ("compaction", "-", self.compaction, 100.0),
            ("earlier passes", "-", self.earlier_passes, 1000.0),
            ("precompression", "m", self.precompression, 0.5),
            ("nearness of the hard base", "1/m", self.base_nearness, 1e4),
            (
                "sudden nearness of the hard base",
                "1/m",
                self.sudden_base_nearness,
                1e4,
            ),
            ("penetration-rate exponent", "-", self.rate_exponent, 1.0),
            ("penetration-rate logarithm", "-", self.rate_logarithm, 1.0),
            ("heap share", "-", self.heap, 1.0),
            ("front pressure", "-", self.front_pressure, 10.0),
            ("clinging layer", "m", self.clinging_layer, 0.1),
        ];
        RangeError::check(
            "diameter exponent",
            "-",
            self.diameter_exponent,
            [-3.0, 3.0],
        )?;
        checks
            .into_iter()
            .try_for_each(|(quantity, unit, value, most)| {
                RangeError::check(quantity, unit, value, [0.0, most]).map(drop)
            })
    }
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::{Soil, table_6};

    fn depth(departures: Departures, slip: f64) -> f64 {
        let soil = Soil {
            departures,
            sinkage_exponent_slip: 0.0,
            ..table_6::sand()
        };
        soil.pressure_sinkage(0.15, slip).sinkage(5.0e3)
    }

    #[test]
    fn ideal_soil_is_the_soil_without_departures_bit_for_bit() {
        let none = Departures::NONE;
        for slip in [-0.5, 0.0, 0.1, 0.9] {
            assert_eq!(none.depth_factor(slip), 1.0);
            let (soil, slip_law) = (table_6::sand(), table_6::sand().exponent(slip));
            let law = soil.pressure_sinkage(0.15, slip);
            assert_eq!(law.modulus, soil.sinkage_modulus(0.15));
            for z in [1e-6, 0.003, 0.02] {
                assert_eq!(law.pressure(z), law.modulus * libm::pow(z, slip_law));
            }
        }
    }

    #[test]
    fn a_wheel_that_digs_as_lyasko_says_sinks_by_g_of_slip() {
        let digging = Departures {
            slip_digging: 1.0,
            ..Departures::NONE
        };
        let deeper = |slip| depth(digging, slip) / depth(Departures::NONE, slip);
        assert!((deeper(0.0) - 1.0).abs() < 1e-12);
        assert!((deeper(0.4) - 1.75).abs() < 1e-12);
        assert!((deeper(-0.4) - 1.75).abs() < 1e-12);
    }

    #[test]
    fn the_first_former_pass_hardens_soil_more_than_any_later_one() {
        let hardness = |earlier_passes| {
            let departures = Departures {
                compaction: 0.5,
                earlier_passes,
                ..Departures::NONE
            };
            departures.modulus_factor()
        };
        let gains: Vec<f64> = (0..6)
            .map(|p| hardness(f64::from(p)) - hardness(f64::from(p - 1)))
            .collect();
        assert_eq!(hardness(-1.0), 1.0);
        assert!(gains.windows(2).all(|pair| pair[1] < 0.6 * pair[0]));
        assert!((hardness(100.0) - 1.5).abs() < 1e-12);
    }

    #[test]
    fn a_wheel_of_half_the_diameter_is_borne_by_half_the_pressure_at_the_exponent_1() {
        let soil = Soil {
            departures: Departures {
                diameter_exponent: 1.0,
                ..Departures::NONE
            },
            ..table_6::sand()
        };
        let modulus = |diameter| soil.under_wheel_of(diameter).sinkage_modulus(0.15);
        assert!((modulus(0.1) / modulus(0.2) - 0.5).abs() < 1e-12);
        assert_eq!(modulus(0.5), modulus(2.0));
        // The option is used up: a soil under a wheel is of plates again.
        let twice = soil.under_wheel_of(0.2).under_wheel_of(0.2);
        assert_eq!(twice, soil.under_wheel_of(0.2));
    }
}
