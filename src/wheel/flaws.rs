//! What a real wheel has and a drawn one has not.

use crate::quantity::RangeError;
use libm::cos;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The lug that is shorter than the others: it reaches the ground early in a run.
const SHORT_LUG: u32 = 2;

/// Departures of a wheel from its drawing; the default has none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Flaws {
    /// Distance \[m\] of the rim's centre from the axle, on the side of lug 0.
    pub eccentricity: f64,
    /// Amplitude \[m\] of the rim's radius twice a turn, largest at lug 0.
    pub ovality: f64,
    /// Height missing at lug 2, as part of a lug [-].
    pub short_lug: f64,
    /// Number of neighbouring lugs that share what is missing [-].
    pub short_lugs: u32,
    /// Mean part [-] of the lugs' height that is worn, none at lug 0 and twice the mean opposite.
    pub uneven_wear: f64,
}

impl Default for Flaws {
    fn default() -> Self {
        Self {
            eccentricity: 0.0,
            ovality: 0.0,
            short_lug: 0.0,
            short_lugs: 1,
            uneven_wear: 0.0,
        }
    }
}

impl Flaws {
    /// Whether the wheel is as drawn.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// # Errors
    /// `RangeError` for a centre or radius that is off by more than a tenth of `radius` [m], and for
    /// parts of a lug outside [0, 1].
    pub(super) fn check(&self, radius: f64) -> Result<(), RangeError> {
        let off = radius / 10.0;
        RangeError::check("wheel eccentricity", "m", self.eccentricity, [-off, off])?;
        RangeError::check("wheel ovality", "m", self.ovality, [-off, off])?;
        RangeError::check("short lug", "-", self.short_lug, [0.0, 1.0])?;
        let lugs = f64::from(self.short_lugs);
        RangeError::check("number of short lugs", "-", lugs, [1.0, 64.0])?;
        RangeError::check("uneven lug wear", "-", self.uneven_wear, [0.0, 0.5])?;
        Ok(())
    }

    /// Height left of a lug over its height when new [-], `place` [rad] being its angle on the rim.
    pub(super) fn height_left(&self, lug: u32, place: f64) -> f64 {
        let short = (SHORT_LUG..SHORT_LUG + self.short_lugs).contains(&lug);
        let missing = if short {
            self.short_lug / f64::from(self.short_lugs)
        } else {
            0.0
        };
        (1.0 - missing) * (1.0 - self.uneven_wear * (1.0 - cos(place)))
    }

    /// Where the wheel's mass is centred from the axle \[m\], the wheel having turned by an angle of this cosine and sine: at
    /// the centre of a rim that is round.
    pub fn mass_centre(&self, cos: f64, sin: f64) -> [f64; 2] {
        [-self.eccentricity * sin, -self.eccentricity * cos]
    }

    /// Where the rim's centre stands from the axle \[m\], the wheel having turned by an angle of this
    /// cosine and sine.
    ///
    /// ```text
    /// x = -e sin θ - 2 o sin 2θ,  y = -e cos θ - o cos 2θ
    /// ```
    ///
    /// An oval rim rolls as a round one whose centre stands where its support is: `h` its support
    /// function, the contact lies `h` below and `h'` beside the axle.
    pub fn rim_centre(&self, cos: f64, sin: f64) -> [f64; 2] {
        let (twice_cos, twice_sin) = (2.0 * cos * cos - 1.0, 2.0 * sin * cos);
        let [x, y] = self.mass_centre(cos, sin);
        let o = self.ovality;
        [x - 2.0 * o * twice_sin, y - o * twice_cos]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rims_centre_goes_round_the_axle_once_a_turn_and_its_oval_twice() {
        let round = Flaws {
            eccentricity: 1.0e-3,
            ..Flaws::default()
        };
        let oval = Flaws {
            ovality: 1.0e-3,
            ..Flaws::default()
        };
        let height = |flaws: &Flaws, angle: f64| {
            let [_, y] = flaws.rim_centre(angle.cos(), angle.sin());
            (y * 1.0e6).round()
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        let heights = |flaws: &Flaws| [0.0, 1.0, 2.0, 3.0].map(|n| height(flaws, n * quarter));
        assert_eq!(
            heights(&round),
            [-1000.0, 0.0, 1000.0, 0.0].map(|y: f64| y + 0.0)
        );
        assert_eq!(heights(&oval), [-1000.0, 1000.0, -1000.0, 1000.0]);
    }

    #[test]
    fn a_short_lug_is_one_lug_or_its_loss_is_shared_and_uneven_wear_keeps_its_mean() {
        let left = |flaws: Flaws| {
            (0..28).map(move |lug| {
                flaws.height_left(lug, f64::from(lug) * std::f64::consts::TAU / 28.0)
            })
        };
        for lugs in [1, 2] {
            let flaws = Flaws {
                short_lug: 0.4,
                short_lugs: lugs,
                ..Flaws::default()
            };
            assert_eq!(left(flaws).filter(|h| *h < 1.0).count(), lugs as usize);
            assert!((left(flaws).sum::<f64>() - 27.6).abs() < 1e-12);
        }
        let worn = Flaws {
            uneven_wear: 0.2,
            ..Flaws::default()
        };
        assert!((left(worn).sum::<f64>() / 28.0 - 0.8).abs() < 1e-12);
    }
}
