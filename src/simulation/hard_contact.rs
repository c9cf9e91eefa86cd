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
//! A lug is a plate with round edges: its end and its flanks meet the ground where the two come closest
//! ([`super::nearest`]), along their common normal. It presses dust out from under itself until single grains are left, so
//! dust bears nothing here; it makes the ground slippery.

use super::contact::{Mobility, Part, Reach, WheelGeometry};
use super::motion::{WheelMotion, Wrench};
use super::nearest::{GapAlong, NEAR, Nearest, NearestPlaces, minima};
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
    nearest: NearestPlaces,
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
    /// The damping [N·s/m] that a contact at `arm` [m] from the rim's centre may have along `direction`: what stops the approach within the
    /// step. More would return it and make the contact oscillate at the rate of the steps, where these are coarse for the
    /// little that moves at the end of a long lever.
    fn damped(&self, damping: f64, arm: [f64; 2], direction: [f64; 2]) -> f64 {
        let most = self.dt * self.mobility.at(arm, direction);
        if damping * most > 1.0 {
            1.0 / most
        } else {
            damping
        }
    }
}

/// Ground in contact with the wheel.
struct Touch {
    /// From the rim's centre [m].
    arm: [f64; 2],
    /// The ground's slope [-].
    slope: f64,
    /// How deep the two lie in one another [m].
    indentation: f64,
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
        Self {
            profile,
            contact,
            friction,
            range,
            nearest: NearestPlaces::default(),
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
        if self.nearest.are_due(wheel, motion) {
            self.search(wheel, motion);
        }
        let step = Step {
            motion,
            mobility: wheel.mobility,
            dt,
        };
        let mut reach = Reach::default();
        let mut places = std::mem::take(&mut self.nearest.places);
        for place in &mut places {
            let wrench = self.press_at(place, wheel, &step);
            if let Part::Lug(lug) = place.part
                && wrench.force() > wheel.touch_force
            {
                reach.touching |= 1 << lug;
            }
            reach.wrench += wrench;
        }
        self.nearest.places = places;
        reach
    }

    /// Looks for all places where the wheel is near.
    fn search(&mut self, wheel: &WheelGeometry, motion: &WheelMotion) {
        let ceiling = self.ceiling(wheel, motion.x) + NEAR;
        let mut found = Vec::new();
        for part in wheel.lowest_parts(motion) {
            let placed = wheel.placed(part, motion);
            let Some([low, high]) = placed.below(ceiling) else {
                continue;
            };
            let margin = 2.0 * self.profile.spacing();
            let nodes = self.profile.nodes(low - margin, high + margin);
            let gap = |x: f64| placed.gap([x, self.surface(x).height]).distance;
            let gaps: Vec<[f64; 2]> = nodes
                .filter(|[x, _]| self.reaches(*x))
                .map(|[x, _]| [x, gap(x)])
                .collect();
            found.extend(minima(part, &placed, &gaps, |x| self.surface(x)));
        }
        self.nearest.renew(found, motion);
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

    /// Load on the wheel where it is nearest to the ground, the place followed to there.
    ///
    /// The contact lies where the gap is least now, not where it was a step ago: a wheel at 0.5 m/s whose load acts a step
    /// behind gains 0.1 % of its energy a metre.
    fn press_at(&self, place: &mut Nearest, wheel: &WheelGeometry, step: &Step<'_>) -> Wrench {
        let surface = self.surface(place.x);
        let placed = wheel.placed(place.part, step.motion);
        let GapAlong { gap, slope } = GapAlong::at(&placed, place.x, &surface);
        let way = place.follow(slope);
        let touch = Touch {
            arm: [
                place.x - step.motion.x,
                surface.height + surface.slope * way - step.motion.y,
            ],
            slope: surface.slope,
            indentation: -(gap + 0.5 * slope * way),
        };
        self.press(&touch, step, &mut place.stretch)
    }

    /// Normal force and friction at one point of the wheel.
    fn press(&self, touch: &Touch, step: &Step<'_>, stretch: &mut f64) -> Wrench {
        let (motion, slope) = (step.motion, touch.slope);
        if touch.indentation <= 0.0 {
            *stretch = 0.0;
            return Wrench::default();
        }
        let scale = 1.0 / sqrt(1.0 + slope * slope);
        let [rx, ry] = touch.arm;
        let (vx, vy) = (motion.vx + motion.omega * ry, motion.vy - motion.omega * rx);
        let rate = -(vy - slope * vx) * scale;
        let sliding = (vx + slope * vy) * scale;
        let HardContact {
            reference_load,
            reference_indentation,
            exponent,
            dissipation,
            dust: _,
        } = self.contact;
        let elastic = reference_load * power(touch.indentation / reference_indentation, exponent);
        let damping = |along| step.damped(dissipation * elastic, touch.arm, along);
        let normal = (elastic + damping([-slope * scale, scale]) * rate).max(0.0);
        let tangential = Tangential {
            stiffness: MINDLIN * exponent * reference_load / reference_indentation,
            damping: MINDLIN * damping([scale, slope * scale]),
            limit: self.friction * normal,
        };
        let friction = tangential.friction(sliding, step.dt, stretch);
        let fx = (friction - normal * slope) * scale;
        let fy = (normal + friction * slope) * scale;
        Wrench {
            fx,
            fy,
            torque: ry * fx - rx * fy,
        }
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
    use crate::wheel::Lugs;

    #[test]
    fn dust_takes_friction_from_that_of_stone_to_that_of_grains() {
        assert_eq!(friction_on_dust(0.6, 0.0), 0.6);
        // 63 % of the way at the covering thickness, all of it at ten.
        let part = (0.6 - friction_on_dust(0.6, COVERING)) / (0.6 - FRICTION_ON_GRAINS);
        assert!((part - (1.0 - (-1.0f64).exp())).abs() < 1e-12);
        assert!((friction_on_dust(0.6, 0.001) - FRICTION_ON_GRAINS).abs() < 1e-4);
        assert_eq!(friction_on_dust(0.2, 0.001), 0.2);
    }

    const STONE: HardContact = HardContact {
        reference_load: 94.0,
        reference_indentation: 1.0e-5,
        exponent: 1.11,
        dissipation: 100.0,
        dust: 0.0,
    };

    /// Ground with `joints`, and the middle [m] of one of them.
    fn jointed(joints: &Joints) -> (Profile, f64) {
        let mut profile = Profile::new(&(*joints).into(), 2.5e-4, Seed(5), 0);
        profile.extend(0.0, 1.0);
        let low = (0..200_000).map(|i| 0.1 + f64::from(i) * 1.0e-6);
        let mut low = low.skip_while(|x| profile.at(*x).height > -0.5 * joints.depth);
        let first = low.next().unwrap();
        let last = low
            .take_while(|x| profile.at(*x).height <= -0.5 * joints.depth)
            .last();
        let middle = 0.5 * (first + last.unwrap());
        (profile, middle)
    }

    /// Pull [N] at every step while a wheel that does not turn, under `load` [N], is drawn at 5 mm/s until the lug that it
    /// stands on has left its joint.
    fn drawn_out_of_a_joint(wheel: &Wheel, joints: &Joints, load: f64) -> Vec<f64> {
        let (mass, speed, dt) = (12.0, 0.005, 1.0 / 128_000.0);
        let (profile, middle) = jointed(joints);
        let mut motion = WheelMotion {
            x: middle,
            y: wheel.tip_radius() - joints.depth,
            cos: 1.0,
            vx: speed,
            ..WheelMotion::default()
        };
        let mut ground = HardGround::new(profile, STONE, wheel, [-9.0, 9.0]);
        let geometry = WheelGeometry::new(wheel, load);
        let mut pulls = Vec::new();
        while motion.y < wheel.tip_radius() - 2.0e-5 {
            let wrench = ground.push(&geometry, &motion, dt).wrench;
            motion.vy += (wrench.fy - load) / mass * dt;
            motion.y += motion.vy * dt;
            motion.x += speed * dt;
            pulls.push(-wrench.fx);
            assert!(pulls.len() < 1_000_000, "the lug never leaves the joint");
        }
        pulls
    }

    #[test]
    fn a_lug_drawn_out_of_a_joint_lets_go_at_the_pull_of_a_wedge_of_45_degrees() {
        let wheel = Wheel::single_wheel();
        let (load, friction) = (100.0, wheel.friction);
        // An end of 1.5 mm on the bottom meets an edge of 5.33 mm where both are 45° steep: their centres are the sum of the
        // radii apart, and the sum less the depth in height.
        let radius = Joints::LEVEL.edge_radius() - 0.0015;
        let joints = Joints {
            edge_radius: Some(radius),
            ..Joints::LEVEL
        };
        let pulls = drawn_out_of_a_joint(&wheel, &joints, load);
        // W (1 + μ)/(1 - μ), by means over 10 ms.
        let means = pulls
            .chunks(1280)
            .map(|part| part.iter().sum::<f64>() / part.len() as f64);
        let peak = means.fold(0.0, f64::max);
        let expected = load * (1.0 + friction) / (1.0 - friction);
        assert!((peak / expected - 1.0).abs() < 0.1, "{peak} for {expected}");
        let largest = pulls.iter().fold(0.0, |most: f64, pull| most.max(*pull));
        assert!(largest < 1.5 * expected, "{largest}");
    }

    #[test]
    fn a_lug_too_thick_for_a_joint_stands_on_both_its_edges() {
        let mut wheel = Wheel::single_wheel();
        let thickness = 0.02;
        wheel.lugs = wheel.lugs.map(|lugs| Lugs { thickness, ..lugs });
        let (profile, middle) = jointed(&Joints::LEVEL);
        let geometry = WheelGeometry::new(&wheel, 100.0);
        // An arc of 10 mm between two of 6.83 mm: their centres are 7.33 mm aside and the sum of the radii apart.
        let (own, edge) = (0.5 * thickness, Joints::LEVEL.edge_radius());
        let aside = 0.5 * Joints::LEVEL.width
            + sqrt((2.0 * edge - Joints::LEVEL.depth) * Joints::LEVEL.depth);
        let up = sqrt((own + edge) * (own + edge) - aside * aside);
        let centre = up - edge;
        let touching = |below: f64| {
            let motion = WheelMotion {
                x: middle,
                y: centre - below + wheel.tip_radius() - own,
                cos: 1.0,
                ..WheelMotion::default()
            };
            let mut ground = HardGround::new(profile.clone(), STONE, &wheel, [-9.0, 9.0]);
            let reach = ground.push(&geometry, &motion, 1.0e-5);
            (ground.nearest.places.len(), reach.wrench)
        };
        let (places, free) = touching(-2.0e-6);
        assert!(places == 2 && free.force() == 0.0, "{places} {free:?}");
        let (_, pressed) = touching(1.0e-5);
        // Each edge bears by its own indentation, 10 µm times the cosine of the normal.
        let cosine = up / (own + edge);
        let each = 94.0 * libm::pow(cosine, 1.11);
        assert!(
            (pressed.fy / (2.0 * each * cosine) - 1.0).abs() < 0.05,
            "{pressed:?} {each}"
        );
        assert!(pressed.fx.abs() < 0.05 * pressed.fy);
    }
}
