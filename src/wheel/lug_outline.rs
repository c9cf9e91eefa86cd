//! Lugs of a user's own form in place of plates with round edges.

use super::Wheel;
use crate::quantity::RangeError;
use std::fmt::Debug;

/// Step \[m\] of a direction by central differences.
const STEP: f64 = 1.0e-7;

/// Points across a lug at which its height is looked for, and how far \[m\] it may differ from the wheel's.
const SAMPLES: u32 = 200;
const HEIGHT: f64 = 1.0e-4;

/// The outline of a lug in the plane of the wheel, alike for all lugs.
///
/// Hard ground and stones meet it where they come closest. It stands on the rim, which remains a circle, and ends at the
/// height of the wheel's [`Lugs`](super::Lugs); wear shortens it towards the rim. Soil does not see it: there a lug
/// remains the plate of the wheel's height and thickness, whose edge and face bear by the soil's own equations.
pub trait LugOutline: Debug + Send + Sync {
    /// Distance \[m\] of a point from the outline, below 0 inside. The point lies `height` \[m\] above the rim along the
    /// lug's radius, and `across` \[m\] from that radius, positive ahead while the lug points straight down. Outside it
    /// is the Euclidean distance: stones are held against it.
    fn distance(&self, height: f64, across: f64) -> f64;

    /// Half the greatest extent \[m\] across the radius.
    fn half_width(&self) -> f64;
}

/// Unit vector, along the radius and across it, in which the distance grows fastest.
pub(crate) fn direction(outline: &dyn LugOutline, height: f64, across: f64) -> [f64; 2] {
    let at = |up: f64, aside: f64| outline.distance(height + up, across + aside);
    let slope = [
        at(STEP, 0.0) - at(-STEP, 0.0),
        at(0.0, STEP) - at(0.0, -STEP),
    ];
    let size = libm::hypot(slope[0], slope[1]);
    if size > 0.0 {
        slope.map(|part| part / size)
    } else {
        [1.0, 0.0]
    }
}

/// Checks that an outline ends where the lugs of a wheel do.
///
/// # Errors
/// `RangeError` where there are no lugs, the outline has no extent, reaches farther than to the next lug, or is not as high.
pub(crate) fn check(outline: &dyn LugOutline, wheel: &Wheel) -> Result<(), RangeError> {
    let most = 0.5 * wheel.lug_angle().unwrap_or(0.0) * wheel.tip_radius();
    let half_width = outline.half_width();
    RangeError::check(
        "half width of a lug outline",
        "m",
        half_width,
        [f64::MIN_POSITIVE, most],
    )?;
    let tip = wheel.lug_height();
    let places = (0..=SAMPLES).map(|place| 2.0 * f64::from(place) / f64::from(SAMPLES) - 1.0);
    let above = places.map(|place| outline.distance(tip, place * half_width));
    let least = above.fold(f64::INFINITY, f64::min);
    let allowed = HEIGHT + half_width / f64::from(SAMPLES);
    RangeError::check(
        "distance of a lug outline from the lugs' height",
        "m",
        least,
        [-allowed, allowed],
    )?;
    Ok(())
}
