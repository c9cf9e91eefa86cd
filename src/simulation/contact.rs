//! The wheel as the ground meets it: edges of its lowest lugs, and what the ground answers.

use super::motion::{WheelMotion, Wrench};
use crate::wheel::Wheel;
use crate::wheel::flaws::Flaws;
use libm::{cos, sin};

/// One point of the wheel that may touch the ground.
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
            width: wheel.width,
            touch_force: 0.01 * load,
            mobility: Mobility::default(),
            lug_angle,
            lugs,
            tips: (0..wheel.lug_count())
                .map(|lug| wheel.radius + wheel.height_of_lug(lug))
                .collect(),
            flaws: wheel.flaws,
            spread,
        }
    }

    /// Where the rim's centre stands from the axle [m].
    pub fn rim_centre(&self, motion: &WheelMotion) -> [f64; 2] {
        self.flaws.rim_centre(motion.cos, motion.sin)
    }

    /// Edges of the lowest lugs, foremost last when driving forward; `motion` is that of the rim's
    /// centre. A lug that is worn down to the rim has none.
    pub fn lowest_edges(&self, motion: &WheelMotion) -> impl Iterator<Item = Edge> + '_ {
        let count = self.lugs.len() as i64;
        let lowest = if count > 0 {
            (motion.angle / self.lug_angle).round() as i64
        } else {
            0
        };
        let WheelMotion { x, y, cos, sin, .. } = *motion;
        let steps = if count > 0 {
            -self.spread..self.spread + 1
        } else {
            0..0
        };
        let lugs = steps.map(move |step| (lowest + step).rem_euclid(count) as usize);
        lugs.filter(|lug| self.tips[*lug] > self.radius)
            .map(move |lug| {
                let radius = self.tips[lug];
                let [cos_place, sin_place] = self.lugs[lug];
                // Angle from straight down, positive ahead: place on the rim less the angle turned.
                let ahead = radius * (sin_place * cos - cos_place * sin);
                let down = radius * (cos_place * cos + sin_place * sin);
                Edge {
                    lug,
                    x: x + ahead,
                    y: y - down,
                    arm: [ahead, -down],
                    radius,
                }
            })
    }
}
