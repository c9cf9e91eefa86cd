//! Outlines of the wheel's parts in its plane, and how far the ground is from them.
//!
//! An outline is everything within a radius of a core: a lug's core is the middle of its plate, so that its edges are
//! round; the rim's core is its centre. A lug of a user's own form is the distance from it.

use crate::wheel::lug_outline::{LugOutline, direction};
use libm::sqrt;

/// All points within `radius` of a core, a rectangle along an axis through the rim's centre.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outline {
    /// Nearest and farthest point of the core from the rim's centre [m].
    pub core: [f64; 2],
    /// Half the core's thickness across the axis [m].
    pub half: f64,
    /// Radius [m].
    pub radius: f64,
}

/// A lug of a user's own form.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnLug<'w> {
    pub outline: &'w dyn LugOutline,
    /// From where its height counts, from the rim's centre [m]: the rim, or deeper by what is worn off.
    pub root: f64,
    /// Rectangle around it.
    pub bounds: Outline,
}

/// Form of a part of the wheel.
#[derive(Debug, Clone, Copy)]
pub(super) enum Form<'w> {
    /// A plate or a disc.
    Round(Outline),
    /// A user's own.
    Own(OwnLug<'w>),
}

/// A part in its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<'w> {
    pub form: Form<'w>,
    /// The rim's centre [m].
    pub centre: [f64; 2],
    /// Unit vector along the axis, away from the rim's centre.
    pub axis: [f64; 2],
}

/// Distance of a point from an outline.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap {
    /// How far it is outside [m]; below 0 inside.
    pub distance: f64,
    /// Direction in which that grows fastest, a unit vector.
    pub normal: [f64; 2],
}

impl Outline {
    /// Distance of a point `along` [m] the axis from the rim's centre and `across` [m] it; the normal in these directions.
    #[inline]
    fn gap(&self, along: f64, across: f64) -> Gap {
        let Self { core, half, radius } = *self;
        let (beyond, short) = (along - core[1], core[0] - along);
        let (out, outward) = if beyond > short {
            (beyond, 1.0)
        } else {
            (short, -1.0)
        };
        let (aside, sideward) = (across.abs() - half, across.signum());
        let (from_core, normal) = if out > 0.0 && aside > 0.0 {
            let distance = sqrt(out * out + aside * aside);
            (
                distance,
                [outward * out / distance, sideward * aside / distance],
            )
        } else if out > aside {
            (out, [outward, 0.0])
        } else {
            (aside, [0.0, sideward])
        };
        Gap {
            distance: from_core - radius,
            normal,
        }
    }
}

impl OwnLug<'_> {
    /// Distance of a point at this `height` [m] and `across` [m] the axis.
    fn gap(&self, height: f64, across: f64) -> Gap {
        Gap {
            distance: self.outline.distance(height, across),
            normal: direction(self.outline, height, across),
        }
    }
}

impl Placed<'_> {
    /// Distance of the point `[x, y]` [m].
    #[inline]
    pub fn gap(&self, [x, y]: [f64; 2]) -> Gap {
        let [ax, ay] = self.axis;
        let (dx, dy) = (x - self.centre[0], y - self.centre[1]);
        let (along, across) = (dx * ax + dy * ay, dy * ax - dx * ay);
        let Gap {
            distance,
            normal: [u, v],
        } = match self.form {
            Form::Round(outline) => outline.gap(along, across),
            Form::Own(lug) => lug.gap(along - lug.root, across),
        };
        Gap {
            distance,
            normal: [u * ax - v * ay, u * ay + v * ax],
        }
    }

    /// Places along the track [m] between which it reaches below `height` [m], if it does.
    pub fn below(&self, height: f64) -> Option<[f64; 2]> {
        let (Form::Round(bounds) | Form::Own(OwnLug { bounds, .. })) = self.form;
        let Outline { core, half, radius } = bounds;
        let ends = core.map(|way| [0, 1].map(|i| self.centre[i] + way * self.axis[i]));
        let reach = half + radius;
        let above = (ends[0][1].min(ends[1][1]) - height).max(0.0);
        let aside = sqrt((reach * reach - above * above).max(0.0));
        let [low, high] = [ends[0][0].min(ends[1][0]), ends[0][0].max(ends[1][0])];
        (above < reach).then_some([low - aside, high + aside])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lug that leans forward by `angle` [rad] from straight down.
    fn lug(angle: f64) -> Placed<'static> {
        Placed {
            form: Form::Round(Outline {
                core: [0.14, 0.1545],
                half: 0.001,
                radius: 0.0005,
            }),
            centre: [0.3, 0.15],
            axis: [libm::sin(angle), -libm::cos(angle)],
        }
    }

    #[test]
    fn a_lug_straight_down_is_a_plate_with_round_edges() {
        let lug = lug(0.0);
        // Below its tip, beside its flank, and off the middle of an edge's arc.
        let below = lug.gap([0.3, -0.006]);
        assert!((below.distance - 0.001).abs() < 1e-15);
        assert_eq!(below.normal, [0.0, -1.0]);
        let beside = lug.gap([0.302, 0.0]);
        assert!((beside.distance - 0.0005).abs() < 1e-15);
        assert_eq!(beside.normal, [1.0, 0.0]);
        let corner = lug.gap([0.301 + 0.001, -0.0045 - 0.001]);
        assert!((corner.distance - (0.001 * 2.0_f64.sqrt() - 0.0005)).abs() < 1e-15);
        assert!((corner.normal[0] + corner.normal[1]).abs() < 1e-12);
        // Inside, the way out is the shortest.
        assert!((lug.gap([0.3012, 0.0]).distance + 0.0003).abs() < 1e-15);
    }

    #[test]
    fn the_normal_is_the_gradient_of_the_distance() {
        let h = 1.0e-7;
        for angle in [-0.4, 0.0, 0.3] {
            let lug = lug(angle);
            for [x, y] in [[0.31, -0.01], [0.29, 0.0], [0.3, 0.1], [0.27, -0.003]] {
                let Gap { normal, .. } = lug.gap([x, y]);
                let along = |dx: f64, dy: f64| {
                    (lug.gap([x + dx, y + dy]).distance - lug.gap([x - dx, y - dy]).distance)
                        / (2.0 * h)
                };
                let numeric = [along(h, 0.0), along(0.0, h)];
                assert!((normal[0] - numeric[0]).abs() + (normal[1] - numeric[1]).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_disc_reaches_below_a_height_over_its_chord() {
        let rim = Placed {
            form: Form::Round(Outline {
                core: [0.0, 0.0],
                half: 0.0,
                radius: 0.14,
            }),
            centre: [0.0, 0.13],
            axis: [0.0, -1.0],
        };
        let [low, high] = rim.below(0.0).unwrap();
        let chord = (0.14_f64.powi(2) - 0.13_f64.powi(2)).sqrt();
        assert!((high - chord).abs() < 1e-12 && (low + chord).abs() < 1e-12);
        assert!(rim.below(-0.02).is_none());
        assert!((rim.gap([0.0, 0.0]).distance + 0.01).abs() < 1e-15);
    }
}
