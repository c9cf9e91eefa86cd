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
//! A lug is its edge: flanks meet no bricks. It presses dust out from under itself until single
//! grains are left, so dust bears nothing here; it makes the ground slippery.

use super::contact::{Edge, Mobility, Reach, WheelGeometry};
use super::motion::{WheelMotion, Wrench};
use crate::soil::power::power;
use crate::terrain::HardContact;
use crate::terrain::profile::{Profile, Surface};
use crate::wheel::Wheel;
use libm::{expm1, sqrt};

/// Tangential over normal stiffness of a contact (Mindlin 1949, ν = 0.3).
const MINDLIN: f64 = 0.82;

/// A stretch of hard ground and the contacts on it.
pub(super) struct HardGround {
    profile: Profile,
    contact: HardContact,
    friction: f64,
    range: [f64; 2],
    /// Stretch of the tangential spring at every lug's edge [m].
    stretch: [f64; 64],
    rim_stretch: f64,
    /// Highest ground near the wheel and where that was looked up [m].
    ceiling: [f64; 2],
}

/// A step of the wheel in contact.
struct Step<'m> {
    motion: &'m WheelMotion,
    mobility: Mobility,
    /// Its length [s].
    dt: f64,
}

impl Step<'_> {
    /// The damping [N·s/m] that a contact at `point` may have along `direction`: what stops the approach within the
    /// step. More would return it and make the contact oscillate at the rate of the steps, where these are coarse for the
    /// little that moves at the end of a long lever.
    fn damped(&self, damping: f64, point: &Edge, direction: [f64; 2]) -> f64 {
        let most = self.dt * self.mobility.at(point.arm, direction);
        if damping * most > 1.0 {
            1.0 / most
        } else {
            damping
        }
    }
}

/// Slope at which hard ground dives under its neighbours [-]: 15°.
pub(super) const RAMP: f64 = 0.268;

/// How far it reaches below them along the track [m]: 54 mm deep, below any sunken lug.
pub(super) const RAMP_LENGTH: f64 = 0.2;

/// How far the wheel may roll before the highest ground near it is looked up again [m].
const LOOK_UP: f64 = 0.005;

/// Friction coefficient [-] of smooth metal on a bed of grains: tan 18.4°, sand on a plate.
const FRICTION_ON_GRAINS: f64 = 0.33;

/// Thickness [m] of dust that covers 63 % of the ground below it: a grain of fine sand. A guess.
const COVERING: f64 = 1.0e-4;

/// Friction coefficient [-] of a wheel with this `friction` on clean stone under `dust` [m].
///
/// ```text
/// μ = μ_0 - (μ_0 - μ_g) (1 - e^(-h/h_0))
/// ```
///
/// Where grains lie between wheel and stone they roll and slide; the thicker the dust, the less
/// stone is bare. `μ_g = 0.33`, `h_0 = 0.1 mm`. A wheel more slippery than grains stays as it is.
fn friction_on_dust(friction: f64, dust: f64) -> f64 {
    let covered = -expm1(-dust / COVERING);
    friction - (friction - FRICTION_ON_GRAINS).max(0.0) * covered
}

impl HardGround {
    /// Ground on `range` [m] under `wheel`.
    pub fn new(profile: Profile, contact: HardContact, wheel: &Wheel, range: [f64; 2]) -> Self {
        let friction = friction_on_dust(wheel.friction, contact.dust);
        let (stretch, ceiling) = ([0.0; 64], [f64::NAN, f64::NAN]);
        Self {
            profile,
            contact,
            friction,
            range,
            stretch,
            rim_stretch: 0.0,
            ceiling,
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
        let step = Step {
            motion,
            mobility: wheel.mobility,
            dt,
        };
        let mut reach = Reach::default();
        for edge in wheel.lowest_edges(motion) {
            if edge.y >= ceiling || !self.reaches(edge.x) {
                self.stretch[edge.lug] = 0.0;
                continue;
            }
            let mut stretch = self.stretch[edge.lug];
            let wrench = self.press(&edge, &step, &mut stretch);
            self.stretch[edge.lug] = stretch;
            if wrench.force() > wheel.touch_force {
                reach.touching |= 1 << edge.lug;
            }
            reach.wrench += wrench;
        }
        if motion.y - wheel.radius < ceiling {
            reach.wrench += self.push_rim(wheel, &step);
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
        let ceiling = highest + 0.15 * self.profile.steepest_step(x - span, x + span);
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
    fn press(&self, point: &Edge, step: &Step<'_>, stretch: &mut f64) -> Wrench {
        let motion = step.motion;
        let surface = self.surface(point.x);
        let scale = 1.0 / sqrt(1.0 + surface.slope * surface.slope);
        let indentation = (surface.height - point.y) * scale;
        if indentation <= 0.0 {
            *stretch = 0.0;
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
        let elastic = reference_load * power(indentation / reference_indentation, exponent);
        let damping = |along| step.damped(dissipation * elastic, point, along);
        let normal = (elastic + damping([-surface.slope * scale, scale]) * rate).max(0.0);
        let tangential = Tangential {
            stiffness: MINDLIN * exponent * reference_load / reference_indentation,
            damping: MINDLIN * damping([scale, surface.slope * scale]),
            limit: self.friction * normal,
        };
        let friction = tangential.friction(sliding, step.dt, stretch);
        let fx = (friction - normal * surface.slope) * scale;
        let fy = (normal + friction * surface.slope) * scale;
        Wrench {
            fx,
            fy,
            torque: ry * fx - rx * fy,
        }
    }

    /// The rim against every summit that reaches into it.
    fn push_rim(&mut self, wheel: &WheelGeometry, step: &Step<'_>) -> Wrench {
        let motion = step.motion;
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
                    radius: r,
                });
            }
        }
        // All summits stretch the rim's one spring alike; the most loaded one tells how far.
        let before = self.rim_stretch;
        let (mut sum, mut most) = (Wrench::default(), 0.0);
        self.rim_stretch = 0.0;
        for point in &points {
            let mut stretch = before;
            let wrench = self.press(point, step, &mut stretch);
            if wrench.force() > most {
                most = wrench.force();
                self.rim_stretch = stretch;
            }
            sum += wrench;
        }
        sum
    }
}

/// What resists sliding at a contact.
struct Tangential {
    /// Stiffness [N/m] up to the limit.
    stiffness: f64,
    /// The same loss as along the normal [N·s/m], kept under the limit.
    damping: f64,
    /// Coulomb's limit [N].
    limit: f64,
}

impl Tangential {
    /// Friction [N] along the ground against `sliding` [m/s] over `dt` [s], from the `stretch` [m] of the spring.
    fn friction(&self, sliding: f64, dt: f64, stretch: &mut f64) -> f64 {
        let farthest = self.limit / self.stiffness;
        *stretch = (*stretch + sliding * dt).clamp(-farthest, farthest);
        let force = -self.stiffness * *stretch - self.damping * sliding;
        force.clamp(-self.limit, self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use crate::terrain::Joints;

    #[test]
    fn dust_takes_friction_from_that_of_stone_to_that_of_grains() {
        assert_eq!(friction_on_dust(0.6, 0.0), 0.6);
        // 63 % of the way at the covering thickness, all of it at ten.
        let part = (0.6 - friction_on_dust(0.6, COVERING)) / (0.6 - FRICTION_ON_GRAINS);
        assert!((part - (1.0 - (-1.0f64).exp())).abs() < 1e-12);
        assert!((friction_on_dust(0.6, 0.001) - FRICTION_ON_GRAINS).abs() < 1e-4);
        assert_eq!(friction_on_dust(0.2, 0.001), 0.2);
    }

    /// Pull [N] at every step while a lug's edge under `load` [N] is drawn at 5 mm/s out of a joint
    /// over the bevel ahead, with how far up that bevel it is (0 to 1).
    fn drawn_out_of_a_joint(joints: &Joints, load: f64) -> Vec<[f64; 2]> {
        let (mass, speed, dt) = (12.0, 0.005, 1.0 / 128_000.0);
        let contact = HardContact {
            reference_load: 94.0,
            reference_indentation: 1.0e-5,
            exponent: 1.11,
            dissipation: 100.0,
            dust: 0.0,
        };
        let mut profile = Profile::new(None, Some(joints), 2.5e-4, Seed(5), 0);
        profile.extend(0.0, 1.0);
        let bottom = (0..4000).map(|i| 0.1 + f64::from(i) * 1.0e-4);
        let mut bottom = bottom.filter(|x| profile.at(*x).height <= -joints.depth);
        let mut motion = WheelMotion {
            x: bottom.next().unwrap() + 0.25 * joints.width,
            y: -joints.depth,
            vx: speed,
            ..WheelMotion::default()
        };
        let ground = HardGround::new(profile, contact, &Wheel::single_wheel(), [-9.0, 9.0]);
        let (mut stretch, mut pulls) = (0.0, Vec::new());
        while motion.y < -1.0e-5 {
            let edge = Edge {
                lug: 0,
                x: motion.x,
                y: motion.y,
                arm: [0.0, 0.0],
                radius: 0.0,
            };
            let step = Step {
                motion: &motion,
                mobility: Mobility::default(),
                dt,
            };
            let wrench = ground.press(&edge, &step, &mut stretch);
            motion.vy += (wrench.fy - load) / mass * dt;
            motion.y += motion.vy * dt;
            motion.x += speed * dt;
            pulls.push([1.0 + motion.y / joints.depth, -wrench.fx]);
            assert!(pulls.len() < 1_000_000, "the edge never leaves the joint");
        }
        pulls
    }

    #[test]
    fn a_lug_drawn_out_of_a_bevelled_joint_lets_go_at_the_pull_of_a_wedge() {
        let joints = Joints {
            spacing: 0.2,
            width: 0.005,
            depth: 0.002,
            step: 0.0,
        };
        let (load, friction) = (100.0, Wheel::single_wheel().friction);
        let pulls = drawn_out_of_a_joint(&joints, load);
        let on_flank = pulls.iter().filter(|[up, _]| (0.3..0.7).contains(up));
        let (sum, count) = on_flank.fold((0.0, 0.0), |(s, n), [_, pull]| (s + pull, n + 1.0));
        // At 45°: W (1 + μ)/(1 - μ).
        let expected = load * (1.0 + friction) / (1.0 - friction);
        assert!(
            (sum / count / expected - 1.0).abs() < 0.1,
            "{}",
            sum / count
        );
        let peak = pulls
            .iter()
            .fold(0.0, |most: f64, [_, pull]| most.max(*pull));
        assert!(peak < 10.0 * load, "{peak}");
    }
}
