//! Lugs of a user's own form in place of plates with round edges.

use super::Wheel;
use crate::quantity::RangeError;
use std::fmt::Debug;

/// Step \[m\] of a direction by central differences.
const STEP: f64 = 1.0e-7;

/// Places along and across a lug at which its outline is checked, and how far \[m\] it may be beside its stated extent.
const SAMPLES: u32 = 100;
const ASIDE: f64 = 1.0e-4;

/// How far \[m\] corners may reach beyond the circle through the middles of the lugs' ends.
const BEYOND_TIPS: f64 = 1.0e-3;

/// The outline of a lug in the plane of the wheel, alike for all lugs.
///
/// Hard ground and stones meet it where they come closest. It stands on the rim, which remains a circle; wear sinks it into
/// the rim with the form of its end kept. Soil does not see it: there a lug remains the plate of the wheel's height and
/// thickness, whose edge and face bear by the soil's own equations.
pub trait LugOutline: Debug + Send + Sync {
    /// Distance \[m\] of a point from the outline, below 0 inside. The point lies `height` \[m\] above the rim along the
    /// lug's radius, and `across` \[m\] from that radius, positive ahead while the lug points straight down. It is the
    /// Euclidean distance outside, and inside as deep as contacts indent.
    fn distance(&self, height: f64, across: f64) -> f64;

    /// Greatest height \[m\] above the rim.
    fn height(&self) -> f64;

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

/// Checks that an outline has the extent that it states, and stands on a wheel.
///
/// # Errors
/// `RangeError` for a wheel without lugs, an outline lower than the wheel's lugs, wider than the space for one, or with
/// distances that do not belong to the stated extent.
pub(crate) fn check(outline: &dyn LugOutline, wheel: &Wheel) -> Result<(), RangeError> {
    let Some(pitch) = wheel.lug_angle() else {
        return Err(RangeError {
            quantity: "number of lugs with an outline of their own",
            unit: "-",
            range: "1 or more".to_owned(),
            value: 0.0,
        });
    };
    let (height, half_width, tip) = (outline.height(), outline.half_width(), wheel.tip_radius());
    RangeError::positive("half width of a lug outline", "m", half_width)?;
    let most = libm::sqrt(BEYOND_TIPS * (2.0 * tip + BEYOND_TIPS)).min(0.5 * pitch * tip);
    RangeError::check("half width of a lug outline", "m", half_width, [0.0, most])?;
    let heights = [wheel.lug_height() - ASIDE, wheel.radius];
    RangeError::check("height of a lug outline", "m", height, heights)?;
    check_extent(outline)
}

fn check_extent(outline: &dyn LugOutline) -> Result<(), RangeError> {
    let (height, half_width) = (outline.height(), outline.half_width());
    let shares = || (0..=SAMPLES).map(|place| f64::from(place) / f64::from(SAMPLES));
    let across = || shares().map(|share| (2.0 * share - 1.0) * half_width);
    let distances = shares().flat_map(|up| across().map(move |x| outline.distance(up * height, x)));
    if let Some(value) = distances.into_iter().find(|it| !it.is_finite()) {
        return Err(not_of_extent(value, "finite"));
    }
    let above = across().map(|x| outline.distance(height + ASIDE, x));
    let ahead = shares().map(|up| outline.distance(up * height, half_width + ASIDE));
    let behind = shares().map(|up| outline.distance(up * height, -half_width - ASIDE));
    if let Some(value) = above.chain(ahead).chain(behind).find(|it| *it <= 0.0) {
        return Err(not_of_extent(
            value,
            "above 0 beyond its height and half width",
        ));
    }
    let least = across()
        .map(|x| outline.distance(height, x))
        .fold(f64::INFINITY, f64::min);
    if least > ASIDE + half_width / f64::from(SAMPLES) {
        return Err(not_of_extent(least, "0 somewhere at its height"));
    }
    Ok(())
}

fn not_of_extent(value: f64, range: &str) -> RangeError {
    RangeError {
        quantity: "distance from a lug outline",
        unit: "m",
        range: range.to_owned(),
        value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half disc on the rim that states another extent.
    #[derive(Debug)]
    struct Bar {
        radius: f64,
        height: f64,
        half_width: f64,
    }

    impl LugOutline for Bar {
        fn distance(&self, height: f64, across: f64) -> f64 {
            libm::hypot(height, across) - self.radius
        }

        fn height(&self) -> f64 {
            self.height
        }

        fn half_width(&self) -> f64 {
            self.half_width
        }
    }

    fn refusal(radius: f64, height: f64, half_width: f64) -> Option<String> {
        let bar = Bar {
            radius,
            height,
            half_width,
        };
        let refused = check(&bar, &Wheel::single_wheel()).err();
        refused.map(|error| error.to_string())
    }

    #[test]
    fn an_outline_is_as_high_and_wide_as_it_states_and_fits_the_lugs() {
        assert_eq!(refusal(0.015, 0.015, 0.015), None);
        let says = |found: Option<String>, words: &str| {
            let found = found.expect("it is refused");
            assert!(found.contains(words), "{found}");
        };
        says(refusal(0.016, 0.015, 0.016), "above 0 beyond");
        says(refusal(0.016, 0.016, 0.015), "above 0 beyond");
        says(refusal(0.010, 0.015, 0.010), "0 somewhere at its height");
        says(refusal(0.010, 0.010, 0.010), "height of a lug outline");
        says(refusal(0.020, 0.020, 0.020), "half width of a lug outline");
        says(refusal(f64::NAN, 0.015, 0.015), "finite");
        let bar = Bar {
            radius: 0.015,
            height: 0.015,
            half_width: 0.015,
        };
        let smooth = Wheel {
            lugs: None,
            ..Wheel::single_wheel()
        };
        let refused = check(&bar, &smooth).unwrap_err().to_string();
        says(Some(refused), "number of lugs");
    }

    #[test]
    fn the_direction_is_that_in_which_the_distance_grows() {
        let bar = Bar {
            radius: 0.01,
            height: 0.01,
            half_width: 0.01,
        };
        let [up, ahead] = direction(&bar, 0.006, 0.008);
        assert!((up - 0.6).abs() < 1.0e-6 && (ahead - 0.8).abs() < 1.0e-6);
    }
}
