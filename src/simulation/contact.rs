//! The wheel as the ground meets it: its lowest lugs and its rim, and what the ground answers.

use super::motion::{WheelMotion, Wrench};
use super::outline::{Form, Outline, OwnLug, Placed};
use crate::wheel::Wheel;
use crate::wheel::flaws::Flaws;
use crate::wheel::lug_outline::LugOutline;
use libm::{cos, sin};
use std::sync::Arc;

/// A part of the wheel that may touch the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Part {
    /// The lug of this number.
    Lug(usize),
    /// The rim.
    Rim,
}

/// The middle of a lug's end: where the lug meets soil.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    /// Lug it belongs to.
    pub lug: usize,
    /// Along the track [m].
    pub x: f64,
    /// Above the datum [m].
    pub y: f64,
    /// From the rim's centre [m].
    pub arm: [f64; 2],
    /// How far that is [m].
    pub radius: f64,
}

/// The ground's answer to one step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Reach {
    /// Load on the wheel.
    pub wrench: Wrench,
    /// Lugs that carry more than 1 % of the load.
    pub touching: u64,
    /// Lugs whose edge lies more than 1 mm below the undisturbed soil.
    pub entered: u64,
}

impl std::ops::AddAssign for Reach {
    fn add_assign(&mut self, other: Self) {
        self.wrench += other.wrench;
        self.touching |= other.touching;
        self.entered |= other.entered;
    }
}

/// How much a force moves the wheel: reciprocals of what moves, 0 where a drive imposes the motion.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mobility {
    /// Along the track [1/kg].
    pub along: f64,
    /// Away from the track [1/kg].
    pub vertical: f64,
    /// About the axle [1/(kg·m²)].
    pub turning: f64,
}

impl Mobility {
    /// That of the wheel's point at `arm` [m] from the axle in `direction`, a unit vector [1/kg].
    pub fn at(&self, arm: [f64; 2], direction: [f64; 2]) -> f64 {
        let lever = arm[0] * direction[1] - arm[1] * direction[0];
        self.along * direction[0] * direction[0]
            + self.vertical * direction[1] * direction[1]
            + self.turning * lever * lever
    }
}

/// Geometry of the wheel, with what every step needs worked out once.
pub(super) struct WheelGeometry {
    /// Rim radius [m].
    pub radius: f64,
    /// Radius to the lugs' edges [m].
    pub tip_radius: f64,
    /// Radius to the point farthest out [m]: the corners of wide lugs lie beyond their tips.
    pub reach: f64,
    /// Width [m].
    pub width: f64,
    /// Force [N] above which a lug counts as touching.
    pub touch_force: f64,
    /// How much a force moves it.
    pub mobility: Mobility,
    /// Angle between lugs [rad]; 0 on a smooth wheel.
    lug_angle: f64,
    /// Cosine and sine of every lug's place on the rim.
    lugs: Vec<[f64; 2]>,
    /// Radius to every lug's edge [m].
    tips: Vec<f64>,
    /// Half a lug's thickness, and the radius of its edges [m].
    half_thickness: f64,
    edge_radius: f64,
    /// Outline of the lugs where they are no plates.
    own_lugs: Option<Arc<dyn LugOutline>>,
    flaws: Flaws,
    /// Lugs on either side of the lowest that may touch.
    spread: i64,
}

/// Lugs within this angle [rad] of straight down may touch the ground.
const REACH: f64 = 0.9;

impl WheelGeometry {
    pub fn new(wheel: &Wheel, load: f64) -> Self {
        let lug_angle = wheel.lug_angle().unwrap_or(0.0);
        let lugs: Vec<[f64; 2]> = (0..wheel.lug_count())
            .map(|i| f64::from(i) * lug_angle)
            .map(|place| [cos(place), sin(place)])
            .collect();
        let most = (lugs.len() as i64 - 1) / 2;
        let spread = if lugs.is_empty() {
            0
        } else {
            ((REACH / lug_angle).ceil() as i64).min(most)
        };
        Self {
            radius: wheel.radius,
            tip_radius: wheel.tip_radius(),
            reach: wheel.tip_radius(),
            width: wheel.width,
            touch_force: 0.01 * load,
            mobility: Mobility::default(),
            lug_angle,
            lugs,
            tips: (0..wheel.lug_count())
                .map(|lug| wheel.radius + wheel.height_of_lug(lug))
                .collect(),
            half_thickness: wheel.lugs.map_or(0.0, |lugs| 0.5 * lugs.thickness),
            edge_radius: wheel.lugs.map_or(0.0, |lugs| lugs.edge_radius()),
            own_lugs: None,
            flaws: wheel.flaws,
            spread,
        }
    }

    /// With lugs of this form.
    pub fn with_lugs(self, outline: Option<Arc<dyn LugOutline>>) -> Self {
        let half_width = outline.as_ref().map_or(0.0, |it| it.half_width());
        Self {
            reach: libm::hypot(self.tip_radius, half_width),
            own_lugs: outline,
            ..self
        }
    }

    /// Where the rim's centre stands from the axle [m].
    pub fn rim_centre(&self, motion: &WheelMotion) -> [f64; 2] {
        self.flaws.rim_centre(motion.cos, motion.sin)
    }

    /// The lowest lugs, foremost last when driving forward. One that is worn down to the rim is none.
    fn lowest_lugs(&self, motion: &WheelMotion) -> impl Iterator<Item = usize> + use<'_> {
        let count = self.lugs.len() as i64;
        let lowest = if count > 0 {
            (motion.angle / self.lug_angle).round() as i64
        } else {
            0
        };
        let steps = if count > 0 {
            -self.spread..self.spread + 1
        } else {
            0..0
        };
        let lugs = steps.map(move |step| (lowest + step).rem_euclid(count) as usize);
        lugs.filter(|lug| self.tips[*lug] > self.radius)
    }

    /// Edges of the lowest lugs; `motion` is that of the rim's centre.
    pub fn lowest_edges(&self, motion: &WheelMotion) -> impl Iterator<Item = Edge> + use<'_> {
        let motion = *motion;
        self.lowest_lugs(&motion).map(move |lug| {
            let radius = self.tips[lug];
            let [ahead, up] = self.axis(lug, &motion).map(|part| radius * part);
            Edge {
                lug,
                x: motion.x + ahead,
                y: motion.y + up,
                arm: [ahead, up],
                radius,
            }
        })
    }

    /// Parts of the wheel that may touch the ground.
    pub fn lowest_parts(&self, motion: &WheelMotion) -> impl Iterator<Item = Part> + use<'_> {
        self.lowest_lugs(motion)
            .map(Part::Lug)
            .chain(std::iter::once(Part::Rim))
    }

    /// A part in its place; `motion` is that of the rim's centre.
    #[inline]
    pub fn placed(&self, part: Part, motion: &WheelMotion) -> Placed<'_> {
        let (form, axis) = match part {
            Part::Lug(lug) => (self.lug_form(lug), self.axis(lug, motion)),
            Part::Rim => (Form::Round(self.rim_outline()), [0.0, -1.0]),
        };
        Placed {
            form,
            centre: [motion.x, motion.y],
            axis,
        }
    }

    fn lug_form(&self, lug: usize) -> Form<'_> {
        match &self.own_lugs {
            None => Form::Round(self.lug_outline(lug)),
            Some(outline) => Form::Own(self.own_lug(&**outline, lug)),
        }
    }

    fn own_lug<'w>(&self, outline: &'w dyn LugOutline, lug: usize) -> OwnLug<'w> {
        let (half, tip) = (outline.half_width(), self.tips[lug]);
        // At its sides the rim lies deeper than in the middle.
        let side = libm::sqrt(self.radius * self.radius - half * half);
        OwnLug {
            outline,
            root: tip - outline.height(),
            bounds: Outline {
                core: [side, tip],
                half,
                radius: 0.0,
            },
        }
    }

    /// A plate from the rim to its edge. One that is worn to less than the radius of its edges ends in their arc.
    fn lug_outline(&self, lug: usize) -> Outline {
        Outline {
            core: [
                self.radius - self.edge_radius,
                self.tips[lug] - self.edge_radius,
            ],
            half: self.half_thickness - self.edge_radius,
            radius: self.edge_radius,
        }
    }

    fn rim_outline(&self) -> Outline {
        Outline {
            core: [0.0, 0.0],
            half: 0.0,
            radius: self.radius,
        }
    }

    /// Unit vector from the rim's centre to a lug: its angle from straight down, positive ahead, is its place on the rim
    /// less the angle turned.
    #[inline]
    fn axis(&self, lug: usize, WheelMotion { cos, sin, .. }: &WheelMotion) -> [f64; 2] {
        let [cos_place, sin_place] = self.lugs[lug];
        [
            sin_place * cos - cos_place * sin,
            -(cos_place * cos + sin_place * sin),
        ]
    }
}
