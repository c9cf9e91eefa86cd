//! The wheel: rim, lugs, mass. A smooth wheel is a wheel with no lugs.
//!
//! Lugs are straight plates, parallel to the axle, that end at the radius `r + l`. Their end has round edges; with its
//! default, one arc over the thickness, it rolls on flat ground within 1 % as the edge without thickness of the paper's
//! Eq. (5) and (10).

pub mod flaws;
pub mod lug_outline;

use crate::quantity::RangeError;
use flaws::Flaws;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Equally spaced lugs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lugs {
    /// Number of lugs `n_l` [-], at most 64.
    pub count: u32,
    /// Height `l` \[m\] from the rim to the edge.
    pub height: f64,
    /// Thickness \[m\] along the rim.
    pub thickness: f64,
    /// Radius \[m\] of the edges of its end; half the thickness, an end that is all round, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edge_radius: Option<f64>,
}

/// Least radius [m] of an edge: that of a cut sheet.
const SHARPEST: f64 = 5.0e-5;

impl Lugs {
    /// Radius \[m\] of the edges of its end.
    pub fn edge_radius(&self) -> f64 {
        self.edge_radius.unwrap_or(0.5 * self.thickness)
    }
}

/// A rigid wheel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "WheelTable")]
#[schemars(!try_from, deny_unknown_fields)]
pub struct Wheel {
    /// Rim radius `r` \[m\].
    pub radius: f64,
    /// Width `b` \[m\] along the axle.
    pub width: f64,
    /// Mass \[kg\] of all that turns with the wheel.
    pub mass: f64,
    /// Moment of inertia [kg·m²] about the axle.
    pub inertia: f64,
    /// Friction coefficient [-] between lug or rim and stone.
    pub friction: f64,
    /// The lugs; none on a smooth wheel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lugs: Option<Lugs>,
    /// Departures from the drawing.
    #[serde(skip_serializing_if = "Flaws::is_none")]
    #[schemars(default)]
    pub flaws: Flaws,
}

/// A `[wheel]` table before its checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WheelTable {
    radius: f64,
    width: f64,
    mass: f64,
    inertia: f64,
    friction: f64,
    lugs: Option<Lugs>,
    #[serde(default)]
    flaws: Flaws,
}

impl WheelTable {
    /// The wheel, its values unchecked; no lugs, no `Lugs`.
    pub(crate) fn into_wheel(self) -> Wheel {
        Wheel {
            radius: self.radius,
            width: self.width,
            mass: self.mass,
            inertia: self.inertia,
            friction: self.friction,
            lugs: self.lugs.filter(|lugs| lugs.count > 0),
            flaws: self.flaws,
        }
    }
}

impl TryFrom<WheelTable> for Wheel {
    type Error = RangeError;
    fn try_from(table: WheelTable) -> Result<Self, RangeError> {
        table.into_wheel().checked()
    }
}

impl Wheel {
    /// The paper's single wheel: 140 mm radius, 150 mm width, 28 lugs of 15 mm (Section 3.2).
    ///
    /// Mass and inertia are those of a 5 mm aluminium drum of these dimensions with its hub and
    /// gear head: the paper gives neither.
    pub fn single_wheel() -> Self {
        let lugs = Some(Lugs {
            count: 28,
            height: 0.015,
            thickness: 0.003,
            edge_radius: None,
        });
        Self {
            radius: 0.14,
            width: 0.15,
            mass: 4.0,
            inertia: 0.05,
            friction: 0.6,
            lugs,
            flaws: Flaws::default(),
        }
    }

    /// The paper's rover wheel: 155 mm radius, 150 mm width, 24 lugs of 10 mm (Section 6.1).
    pub fn rover() -> Self {
        let lugs = Some(Lugs {
            count: 24,
            height: 0.010,
            thickness: 0.003,
            edge_radius: None,
        });
        Self {
            radius: 0.155,
            width: 0.15,
            mass: 4.0,
            inertia: 0.06,
            friction: 0.6,
            lugs,
            flaws: Flaws::default(),
        }
    }

    /// # Errors
    /// `RangeError` for a size that is not positive, more than 64 lugs, or lugs that overlap.
    pub fn checked(self) -> Result<Self, RangeError> {
        RangeError::check("wheel radius", "m", self.radius, [0.01, 2.0])?;
        RangeError::positive("wheel width", "m", self.width)?;
        RangeError::positive("wheel mass", "kg", self.mass)?;
        RangeError::positive("wheel inertia", "kg·m²", self.inertia)?;
        RangeError::check("wheel friction", "-", self.friction, [0.0, 2.0])?;
        self.flaws.check(self.radius)?;
        let Some(lugs) = self.lugs else {
            return Ok(self);
        };
        let Lugs {
            count,
            height,
            thickness,
            ..
        } = lugs;
        RangeError::check("lug count", "-", f64::from(count), [0.0, 64.0])?;
        RangeError::positive("lug height", "m", height)?;
        RangeError::check("lug height", "m", height, [0.0, self.radius])?;
        RangeError::positive("lug thickness", "m", thickness)?;
        let thickest = [SHARPEST.min(0.5 * thickness), 0.5 * thickness];
        RangeError::check("edge radius of a lug", "m", lugs.edge_radius(), thickest)?;
        let pitch = TAU * self.radius / f64::from(count);
        if thickness >= pitch {
            return Err(RangeError {
                quantity: "lug thickness",
                unit: "m",
                range: format!(
                    "below the lug pitch {pitch:.4} m, or the lugs overlap; use fewer or thinner lugs"
                ),
                value: thickness,
            });
        }
        Ok(self)
    }

    /// Number of lugs `n_l` [-].
    pub fn lug_count(&self) -> u32 {
        self.lugs.map_or(0, |lugs| lugs.count)
    }

    /// Height of the lugs `l` \[m\], 0 on a smooth wheel.
    pub fn lug_height(&self) -> f64 {
        self.lugs.map_or(0.0, |lugs| lugs.height)
    }

    /// Height \[m\] of one lug, with its flaws.
    pub fn height_of_lug(&self, lug: u32) -> f64 {
        let place = f64::from(lug) * self.lug_angle().unwrap_or(0.0);
        self.lug_height() * self.flaws.height_left(lug, place)
    }

    /// Angle between neighbouring lugs `α` \[rad\], `None` on a smooth wheel.
    pub fn lug_angle(&self) -> Option<f64> {
        self.lugs.map(|lugs| TAU / f64::from(lugs.count))
    }

    /// Radius to the lugs' edges `r + l` \[m\].
    pub fn tip_radius(&self) -> f64 {
        self.radius + self.lug_height()
    }

    /// A wheel known only by its outline, as in a file of measured runs: rim radius and width \[m\], number of
    /// lugs and their height \[m\]. All other properties are NaN.
    pub fn of_outline(radius: f64, width: f64, lug_count: u32, lug_height: f64) -> Self {
        Self {
            radius,
            width,
            mass: f64::NAN,
            inertia: f64::NAN,
            friction: f64::NAN,
            lugs: (lug_count > 0).then_some(Lugs {
                count: lug_count,
                height: lug_height,
                thickness: f64::NAN,
                edge_radius: None,
            }),
            flaws: Flaws::default(),
        }
    }

    /// Whether the lugs prevent the rim from touching flat hard ground: `(r + l) cos(α/2) >= r`.
    ///
    /// Otherwise the wheel is olig-lugged (Section 2.2).
    pub fn is_multi_lugged(&self) -> bool {
        self.lug_angle()
            .is_some_and(|alpha| self.tip_radius() * libm::cos(alpha / 2.0) >= self.radius)
    }

    /// Angle \[rad\] of a lug from straight down, positive ahead, in (-π, π].
    ///
    /// At wheel angle 0 lug 0 points straight down; a wheel that drives forward carries the
    /// lugs below the axle backward.
    pub fn lug_position(&self, lug: u32, wheel_angle: f64) -> f64 {
        let Some(alpha) = self.lug_angle() else {
            return 0.0;
        };
        let angle = (f64::from(lug) * alpha - wheel_angle) / TAU;
        (angle - (angle + 0.5).ceil() + 1.0) * TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_papers_wheels_are_multi_lugged_and_six_short_lugs_are_olig() {
        assert!(Wheel::single_wheel().is_multi_lugged());
        assert!(Wheel::rover().is_multi_lugged());
        let lugs = Some(Lugs {
            count: 6,
            height: 0.005,
            thickness: 0.003,
            edge_radius: None,
        });
        assert!(
            !Wheel {
                lugs,
                ..Wheel::single_wheel()
            }
            .is_multi_lugged()
        );
    }

    #[test]
    fn lugs_that_overlap_are_refused_with_the_pitch() {
        let lugs = Some(Lugs {
            count: 40,
            height: 0.01,
            thickness: 0.03,
            edge_radius: None,
        });
        let message = Wheel {
            lugs,
            ..Wheel::single_wheel()
        }
        .checked()
        .unwrap_err()
        .to_string();
        assert!(
            message.contains("below the lug pitch 0.0220 m"),
            "{message}"
        );
    }

    #[test]
    fn a_wheel_that_drives_forward_carries_its_lowest_lug_backward() {
        let wheel = Wheel::single_wheel();
        assert_eq!(wheel.lug_position(0, 0.0), 0.0);
        assert!((wheel.lug_position(0, 0.1) + 0.1).abs() < 1e-12);
        for angle in [-9.0, -3.2, 0.0, 3.15, 100.0] {
            for lug in 0..28 {
                let position = wheel.lug_position(lug, angle);
                assert!(position > -PI - 1e-9 && position <= PI + 1e-9, "{position}");
            }
        }
    }
}
