//! Places where ground and wheel come closest.
//!
//! Ground is a height over the track. Where its distance from an outline has a minimum along the track, the two touch or
//! are about to, and their normals agree: a lug that stands in a joint has two such places, one on either flank. Two
//! other ways lose. A point at the lug's tip with the ground's normal has no flanks and no thickness, and falls into joints
//! that no lug fits. Polygons on a polyline, as an engine's narrow phase takes them, have corners, each of which knocks in
//! passing though there is none in the ground.
//!
//! All minima are looked for after [`SEARCHED`] of motion and followed between two searches, a Newton step each step of the wheel.

use super::contact::{Part, WheelGeometry};
use super::motion::WheelMotion;
use super::outline::Placed;
use crate::terrain::profile::Surface;

/// Way [m] of the wheel after which the nearest places are looked for again.
const SEARCHED: f64 = 2.0e-5;

/// Gap [m] below which a place counts as near: ten times as far as the wheel moves before the next search.
pub(super) const NEAR: f64 = 2.0e-4;

/// Halvings of an interval between nodes: a place is found within some 10 nm.
const HALVINGS: u32 = 16;

/// Distance [m] over which the gap's curvature is taken.
const PROBE: f64 = 1.0e-5;

/// Least curvature [1/m] of a gap: that of a plate lying on flat ground is 0.
const LEAST_CURVATURE: f64 = 1.0;

/// Way [m] over which a place is the one that was there at the last search.
const SAME: f64 = 5.0e-4;

/// A place where ground and a part of the wheel come closest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    /// Part of the wheel.
    pub part: Part,
    /// Along the track [m].
    pub x: f64,
    /// Stretch of the tangential spring there [m].
    pub stretch: f64,
    /// Second derivative of the gap along the track [1/m].
    curvature: f64,
}

/// All such places, and where the wheel was when they were looked for.
#[derive(Debug, Default)]
pub(super) struct NearestPlaces {
    pub places: Vec<Nearest>,
    searched_at: Option<WheelMotion>,
}

/// The gap [m] at a place, and its derivative along the track.
#[derive(Debug, Clone, Copy)]
pub(super) struct GapAlong {
    pub gap: f64,
    pub slope: f64,
}

impl GapAlong {
    /// Between `part` and ground that has this `surface` at `x` [m].
    #[inline]
    pub fn at(part: &Placed, x: f64, surface: &Surface) -> Self {
        let gap = part.gap([x, surface.height]);
        Self {
            gap: gap.distance,
            slope: gap.normal[0] + gap.normal[1] * surface.slope,
        }
    }
}

impl Nearest {
    /// Follows the minimum by a Newton step, from where the gap has this `slope` [-]; the way [m] there.
    #[inline]
    pub fn follow(&mut self, slope: f64) -> f64 {
        let way = -(slope / self.curvature).clamp(-SEARCHED, SEARCHED);
        self.x += way;
        way
    }
}

impl NearestPlaces {
    /// Whether the wheel has moved too far since the last search.
    pub fn are_due(&self, wheel: &WheelGeometry, motion: &WheelMotion) -> bool {
        self.searched_at.is_none_or(|at| {
            let way = (motion.x - at.x).abs() + (motion.y - at.y).abs();
            way + wheel.tip_radius * (motion.angle - at.angle).abs() > SEARCHED
        })
    }

    /// Replaces the places by `found`, now that the wheel is at `motion`; those that were there before keep their stretch.
    pub fn renew(&mut self, mut found: Vec<Nearest>, motion: &WheelMotion) {
        for place in &mut found {
            let way = |old: &&Nearest| (old.x - place.x).abs();
            let before = self.places.iter().filter(|old| old.part == place.part);
            let closest = before.min_by(|a, b| way(a).total_cmp(&way(b)));
            if let Some(old) = closest.filter(|old| way(old) < SAME) {
                place.stretch = old.stretch;
            }
        }
        self.places = found;
        self.searched_at = Some(*motion);
    }
}

/// Where ground of this `surface` is [`NEAR`] a part of the wheel, from its gaps [m] at nodes along the track [m].
pub(super) fn minima<'a>(
    part: Part,
    placed: &'a Placed,
    gaps: &'a [[f64; 2]],
    surface: impl Fn(f64) -> Surface + 'a,
) -> impl Iterator<Item = Nearest> + 'a {
    let slope = move |x: f64| GapAlong::at(placed, x, &surface(x)).slope;
    let lowest = gaps.windows(3).filter(|three| {
        three[1][1] < three[0][1] && three[1][1] <= three[2][1] && three[1][1] < NEAR
    });
    lowest.map(move |three| {
        let [mut low, mut high] = [three[0][0], three[2][0]];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if slope(middle) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        let x = 0.5 * (low + high);
        let curvature = (slope(x + PROBE) - slope(x - PROBE)) / (2.0 * PROBE);
        Nearest {
            part,
            x,
            stretch: 0.0,
            curvature: curvature.max(LEAST_CURVATURE),
        }
    })
}
