//! Fixed hard ground: Hunt-Crossley contact and friction at lug edges and rim.
//!
//! The normal force is `F_0 (δ/δ_0)ⁿ (1 + d δ̇)`, never a pull. Friction is elastic up to the
//! Coulomb limit: a tangential spring (Mindlin's stiffness ratio 2(1-ν)/(2-ν), ν = 0.3) whose
//! stretch stops growing where it would pull harder than `μ F`. The alternative, a friction
//! coefficient that fades in with sliding speed, lets a standing wheel creep, needs a speed
//! scale that no ground has, and turns unstable at cheaper rates than 128 kHz; the spring has
//! neither fault and holds the static friction that hard ground shows at zero slip.
//!
//! Where a stretch ends, its surface dives at [`RAMP`] under what comes next, as slate dips under
//! drifted sand: a wheel that arrives sunk in soil climbs it, and meets no wall.
//!
//! A lug is its edge: flanks meet no bricks.
//!
//! Dust on the ground, if any, acts beside the stone ([`dust`]).

mod dust;

use super::contact::{Edge, Reach, WheelGeometry};
use super::world::{WheelMotion, Wrench};
use crate::terrain::HardContact;
use crate::terrain::profile::{Profile, Surface};
use crate::wheel::Wheel;
use dust::DustFilm;
use libm::{pow, sqrt};

/// Tangential over normal stiffness of a contact (Mindlin 1949, ν = 0.3).
const MINDLIN: f64 = 0.82;

/// A stretch of hard ground and the contacts on it.
pub(super) struct HardGround {
    profile: Profile,
    contact: HardContact,
    friction: f64,
    range: [f64; 2],
    lug_film: Option<DustFilm>,
    rim_film: Option<DustFilm>,
    /// At every lug's edge.
    touches: [Touch; 64],
    rim_stretch: f64,
    /// Highest ground near the wheel and where that was looked up [m].
    ceiling: [f64; 2],
}

/// What a point of the wheel remembers of its stay on the ground.
#[derive(Debug, Clone, Copy, Default)]
struct Touch {
    /// Stretch of the tangential spring [m].
    stretch: f64,
    /// Depth to which dust is crushed [m].
    crushed: f64,
}

/// Slope at which hard ground dives under its neighbours [-]: 15°.
pub(super) const RAMP: f64 = 0.268;

/// How far it reaches below them along the track [m]: 54 mm deep, below any sunken lug.
pub(super) const RAMP_LENGTH: f64 = 0.2;

/// How far the wheel may roll before the highest ground near it is looked up again [m].
const LOOK_UP: f64 = 0.005;

impl HardGround {
    /// Ground on `range` [m] under `wheel`.
    pub fn new(profile: Profile, contact: HardContact, wheel: &Wheel, range: [f64; 2]) -> Self {
        Self {
            profile,
            contact,
            friction: wheel.friction,
            range,
            lug_film: DustFilm::under_lug(contact.dust, wheel),
            rim_film: DustFilm::under_rim(contact.dust, wheel),
            touches: [Touch::default(); 64],
            rim_stretch: 0.0,
            ceiling: [f64::NAN, f64::NAN],
        }
    }

    /// Height [m] of the undisturbed ground at `x` [m], its dust included.
    pub fn undisturbed(&mut self, x: f64) -> f64 {
        self.profile.extend(x, x);
        self.profile.at(x).height + self.contact.dust
    }

    /// The ground's profile.
    pub fn profile(&mut self) -> &mut Profile {
        &mut self.profile
    }

    /// Load of the ground on the wheel over one step of `dt` [s].
    pub fn push(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, dt: f64) -> Reach {
        let ceiling = self.ceiling(wheel, motion.x);
        let mut reach = Reach::default();
        for edge in wheel.lowest_edges(motion) {
            if edge.y >= ceiling || !self.reaches(edge.x) {
                self.touches[edge.lug] = Touch::default();
                continue;
            }
            let mut touch = self.touches[edge.lug];
            let wrench = self.press(&edge, motion, dt, self.lug_film.as_ref(), &mut touch);
            self.touches[edge.lug] = touch;
            if wrench.force() > wheel.touch_force {
                reach.touching |= 1 << edge.lug;
            }
            reach.wrench += wrench;
        }
        if motion.y - wheel.radius < ceiling {
            reach.wrench += self.push_rim(wheel, motion, dt);
        } else {
            self.rim_stretch = 0.0;
        }
        reach
    }

    /// Highest ground that wheel could touch.
    fn ceiling(&mut self, wheel: &WheelGeometry, x: f64) -> f64 {
        let [looked_up_at, ceiling] = self.ceiling;
        if (x - looked_up_at).abs() <= LOOK_UP {
            return ceiling;
        }
        let span = wheel.tip_radius + 2.0 * LOOK_UP;
        self.profile.extend(x - span, x + span);
        let highest = self.profile.highest(x - span, x + span);
        // Between nodes the cubic overshoots a step between neighbours by less than 15 % of it.
        let ceiling =
            highest + 0.15 * self.profile.steepest_step(x - span, x + span) + self.contact.dust;
        self.ceiling = [x, ceiling];
        ceiling
    }

    /// Height [m] and slope [-] at `x` [m].
    fn surface(&self, x: f64) -> Surface {
        let mut surface = self.profile.at(x);
        let [before, after] = [self.range[0] - x, x - self.range[1]];
        if before > 0.0 {
            surface.height -= RAMP * before;
            surface.slope += RAMP;
        } else if after > 0.0 {
            surface.height -= RAMP * after;
            surface.slope -= RAMP;
        }
        surface
    }

    /// Whether there is ground at `x` [m].
    fn reaches(&self, x: f64) -> bool {
        x >= self.range[0] - RAMP_LENGTH && x < self.range[1] + RAMP_LENGTH
    }

    /// Normal force and friction at one point of the wheel.
    fn press(
        &self,
        point: &Edge,
        motion: &WheelMotion,
        dt: f64,
        film: Option<&DustFilm>,
        touch: &mut Touch,
    ) -> Wrench {
        let surface = self.surface(point.x);
        let scale = 1.0 / sqrt(1.0 + surface.slope * surface.slope);
        let indentation = (surface.height - point.y) * scale;
        let on_dust = film.map_or(0.0, |film| film.push(indentation, &mut touch.crushed));
        if indentation <= 0.0 && on_dust == 0.0 {
            touch.stretch = 0.0;
            return Wrench::default();
        }
        let [rx, ry] = point.arm;
        let (vx, vy) = (motion.vx + motion.omega * ry, motion.vy - motion.omega * rx);
        let rate = -(vy - surface.slope * vx) * scale;
        let sliding = (vx + surface.slope * vy) * scale;
        let HardContact {
            reference_load,
            reference_indentation,
            exponent,
            dissipation,
            dust: _,
        } = self.contact;
        let on_stone = reference_load * pow(indentation.max(0.0) / reference_indentation, exponent);
        let elastic = on_stone + on_dust;
        let normal = elastic * (1.0 + dissipation * rate).max(0.0);
        let stiffness = MINDLIN * exponent * reference_load / reference_indentation;
        let slippery = (self.friction - dust::FRICTION).max(0.0) * on_dust / elastic;
        let limit = (self.friction - slippery) * normal;
        let viscous = dissipation * normal * MINDLIN * sliding;
        touch.stretch = (touch.stretch + sliding * dt).clamp(-limit / stiffness, limit / stiffness);
        // The same loss as along the normal, kept under the limit.
        let friction = (-stiffness * touch.stretch - viscous).clamp(-limit, limit);
        let fx = (friction - normal * surface.slope) * scale;
        let fy = (normal + friction * surface.slope) * scale;
        Wrench {
            fx,
            fy,
            torque: ry * fx - rx * fy,
        }
    }

    /// The rim against every summit that reaches into it.
    fn push_rim(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, dt: f64) -> Wrench {
        let mut points: Vec<Edge> = Vec::new();
        let r = wheel.radius;
        let half = sqrt(
            (r * r - {
                let above = (motion.y - self.ceiling[1]).max(0.0);
                above * above
            })
            .max(0.0),
        );
        let depth = |x: f64| {
            let u = x - motion.x;
            self.surface(x).height - (motion.y - sqrt((r * r - u * u).max(0.0)))
        };
        let near: Vec<[f64; 2]> = self
            .profile
            .nodes(
                motion.x - half - 2.0 * self.profile.spacing(),
                motion.x + half + 2.0 * self.profile.spacing(),
            )
            .filter(|[x, _]| self.reaches(*x))
            .map(|[x, _]| [x - motion.x, depth(x)])
            .collect();
        for three in near.windows(3) {
            let [[_, before], [u, here], [_, after]] = [three[0], three[1], three[2]];
            if here > before && here >= after {
                let bend = before - 2.0 * here + after;
                let shift = if bend < 0.0 {
                    0.5 * (before - after) / bend
                } else {
                    0.0
                };
                let u = (u + shift * self.profile.spacing()).clamp(-r, r);
                let down = sqrt(r * r - u * u);
                points.push(Edge {
                    lug: 0,
                    x: motion.x + u,
                    y: motion.y - down,
                    arm: [u, -down],
                });
            }
        }
        // All summits stretch the rim's one spring alike; the most loaded one tells how far.
        let before = self.rim_stretch;
        let (mut sum, mut most) = (Wrench::default(), 0.0);
        self.rim_stretch = 0.0;
        for point in &points {
            // A rolling rim meets fresh dust.
            let mut touch = Touch {
                stretch: before,
                crushed: 0.0,
            };
            let wrench = self.press(point, motion, dt, self.rim_film.as_ref(), &mut touch);
            if wrench.force() > most {
                most = wrench.force();
                self.rim_stretch = touch.stretch;
            }
            sum += wrench;
        }
        sum
    }
}
