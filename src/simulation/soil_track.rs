//! Granular ground: a row of soil columns under the rim, and the lugs that cut into it.
//!
//! # Columns under the rim
//! Every column remembers how deep it was pressed. Plain columns would put the greatest stress
//! under the axle; measured stress peaks ahead of it, at `θ_m = (c_1 + c_2 s) θ_1`, and ends at
//! `θ_2 = c_3 θ_1`. So a column's depth counts in full ahead of `θ_m` and is scaled behind it, by
//! [`EffectiveDepth::share`]: a smooth wheel in steady rolling then reproduces the integral of
//! the stress convention the soil names, while ruts, passes and vibration act through each
//! column's own memory. Where a lug stands the rim bears nothing: that soil bears the lug's edge. Averaged over the phase of the lugs
//! the loads are those of [`crate::soil::wheel_load`] (`output/reference/columns_and_quadrature.txt`). The alternative, to integrate the convention over the wheel's present
//! sinkage, has no memory; plain columns have memory and no slip-sinkage.
//!
//! Slip changes sinkage and stress through soil that has flowed: `N = n_0 + n_1 s` and `θ_m = (c_1 + c_2 s) θ_1` are of
//! steady rolling. So the slip in them follows the momentary one over half a contact length of rolling, the way over
//! which the wheel replaces the soil that it stands on; shear displacement, which has its own length `K`, is worked out
//! from the momentary speeds. With the momentary slip in the exponent a speed loop that hunts by 5 % at 2.3 Hz shakes
//! the axle 24 times louder than the lugs.
//!
//! A wheel that is let down presses the soil alike ahead and behind; the flow that moves the
//! stress forward develops over half a contact length of rolling, and again after a reversal.
//! Pressure falls steeply (unloading stiffness) when the wheel lifts off what it has pressed, and
//! grows along the virgin curve when it goes deeper.
//!
//! # Cost
//! The stress field changes with the wheel's advance, not with its vibration. It is worked out anew after [`ADVANCE`]
//! of rolling or [`HEAVE`] of vertical motion, at most [`FULL_RATE`] times a second, and follows the wheel's height in
//! between by its own stiffness. At 14 mm/s and slip 0.1 loads and vibration below 1 kHz are those of an evaluation every
//! 1/4000 s (pull within 0.01 %, levels within 3 % in every band); after 20 µm instead its steps reach 400 Hz, and to
//! extrapolate the field with the advance moves them to lower bands.

#[cfg(test)]
mod against_quadrature;
mod columns;
mod front_heap;
mod lug_bite;
mod rim_shear;
mod transport;

use super::contact::{Reach, WheelGeometry};
use super::motion::{WheelMotion, Wrench};
use super::stone_outline::StoneOutline;
use crate::quantity::SlipRatio;
use crate::soil::contact::{ContactAngles, EffectiveDepth};
use crate::soil::law::SoilLaw;
use crate::soil::lug_action::shear_radius;
use crate::soil::penetration_rate::penetration_rate;
use crate::soil::pressure_sinkage::PressureSinkage;
use crate::soil::shear::Shear;
use crate::soil::{Soil, StressConvention};
use crate::terrain::profile::Profile;
use crate::wheel::Wheel;
use columns::{COLUMN, Columns};
use front_heap::FrontHeap;
use libm::{asin, exp};
use lug_bite::LugBites;
use rim_shear::RimShear;
use std::ops::Range;
use std::sync::Arc;
use transport::Transport;

/// The stress field is worked out at most this often [Hz].
pub(super) const FULL_RATE: f64 = 4_000.0;

/// Slower than this [m/s] always as often: a wheel that stops swings on the soil by micrometres, and a field that follows
/// late would drive it.
const SLOW: f64 = 1.0e-3;

/// Rolling [m] after which it is worked out anew.
const ADVANCE: f64 = 1.0e-5;

/// Vertical motion [m] after which it is worked out anew.
const HEAVE: f64 = 1.0e-5;

/// A wheel that rolls back by more than this has reversed [m]: soil is sheared the other way over a fraction of `K`.
const REVERSAL: f64 = 1.0e-3;

/// Slower than this the wheel stands [m/s]: a hundredth of the slowest rover.
const STANDING: f64 = 3.0e-5;

/// The stress field's load and how it follows the wheel until it is worked out again.
#[derive(Debug, Clone, Copy, Default)]
struct Field {
    reach: Reach,
    height: f64,
    vertical_speed: f64,
    /// Stiffness [N/m] against going deeper and against lifting.
    stiffness: [f64; 2],
    /// Damping [N·s/m].
    damping: f64,
}

/// Which way the wheel faces and how far its soil flow has developed.
#[derive(Debug, Clone, Copy)]
struct Facing {
    /// Direction of travel, +1 or -1.
    direction: f64,
    /// Way rolled since the let-down or the last reversal [m].
    rolled: f64,
    /// Way rolled against that direction since it last rolled along it [m].
    back: f64,
    /// Slip [-] over that way, the last half of a contact length counting most; `None` before it has rolled.
    slip: Option<f64>,
}

/// What every point of one evaluation of the field shares; speeds and angles face the travel.
struct Contact {
    soil: Soil,
    slip: f64,
    direction: f64,
    /// How far the flow of a rolling wheel has developed, from 0 at rest to 1.
    developed: f64,
    depth: EffectiveDepth,
    law: PressureSinkage,
    shear: Shear,
    /// What bears and shears in place of these two, and the wheel's width [m] for it.
    own: Option<Arc<dyn SoilLaw>>,
    width: f64,
    /// Wheel speed [rad/s] and forward speed [m/s].
    wheel_speed: f64,
    forward_speed: f64,
    /// Speed at which the wheel rises [m/s].
    rise: f64,
    elapsed: f64,
}

/// A stretch of soil.
pub(super) struct SoilTrack {
    /// As the wheel meets it, and as stones do.
    soil: Soil,
    under_stones: Soil,
    own: Option<Arc<dyn SoilLaw>>,
    columns: Columns,
    shear_radius: f64,
    rim_shear: RimShear,
    bites: LugBites,
    transport: Transport,
    heap: FrontHeap,
    /// Part [-] of every column under the rim that no lug stands in.
    clear: Vec<f64>,
    facing: Facing,
    field: Field,
    /// Time [s] and way rolled [m] since the field was worked out.
    since_field: f64,
    way: f64,
}

impl SoilTrack {
    /// Soil on `range` [m] whose undisturbed surface is `profile`.
    pub fn new(profile: Profile, soil: Soil, wheel: &Wheel, range: [f64; 2]) -> Self {
        let under_stones = soil;
        let soil = soil.under_wheel_of(2.0 * wheel.radius);
        Self {
            soil,
            under_stones,
            own: None,
            columns: Columns::new(profile, &soil, range),
            shear_radius: shear_radius(wheel, &soil),
            rim_shear: RimShear::new(),
            bites: LugBites::new(wheel, &soil),
            transport: Transport::new(wheel, &soil),
            heap: FrontHeap::default(),
            clear: Vec::new(),
            facing: Facing {
                direction: 1.0,
                rolled: 0.0,
                back: 0.0,
                slip: None,
            },
            field: Field::default(),
            since_field: f64::INFINITY,
            way: 0.0,
        }
    }

    /// The same soil that bears and shears by this law, where there is one.
    pub fn under_law(self, own: Option<Arc<dyn SoilLaw>>) -> Self {
        Self { own, ..self }
    }

    /// Undisturbed height at `x` [m].
    pub fn undisturbed(&mut self, x: f64) -> f64 {
        self.columns.undisturbed(x)
    }

    /// The surface as it is now between two places: position and height [m].
    pub fn surface(&mut self, low: f64, high: f64) -> Vec<[f64; 2]> {
        self.columns.surface(low, high)
    }

    /// Takes out the soil where a stone is put in.
    pub fn dig_out(&mut self, stone: &StoneOutline) {
        let [low, high] = stone.extent();
        self.columns.reach(low, high);
        for index in self.columns.indices(low, high) {
            self.columns
                .dig_out(index, stone.underside(index as f64 * COLUMN));
        }
    }

    /// Forgets where stones lay.
    pub fn uncover(&mut self) {
        self.columns.uncover();
    }

    /// Notes that a stone lies here: soil does not slide below it.
    pub fn cover(&mut self, stone: &StoneOutline) {
        let [low, high] = stone.extent();
        self.columns.reach(low, high);
        for index in self.columns.indices(low, high) {
            self.columns.cover(index);
        }
    }

    /// Force [N] along and away from the track and moment [N·m] of the soil on a stone, which has
    /// sheared the soil below it by `stretch` [m].
    pub fn bear(&mut self, stone: &StoneOutline, stretch: &mut f64, dt: f64) -> [f64; 3] {
        let (law, shear) = (
            self.under_stones.pressure_sinkage(stone.depth, 0.0),
            self.under_stones.shear(),
        );
        let [low, high] = stone.extent();
        self.columns.reach(low, high);
        let (mut force, mut moment, mut area) = (0.0, 0.0, 0.0);
        let mut lowest = f64::INFINITY;
        for index in self.columns.indices(low, high) {
            let x = index as f64 * COLUMN;
            let level = stone.underside(x);
            lowest = lowest.min(level);
            let pressed = self.columns.press(index, level);
            let arm = x - stone.centre[0];
            let rise = stone.velocity[1] + stone.spin * arm;
            let depth = pressed.virgin - pressed.lowest;
            let loading = match &self.own {
                None => law.pressure(depth),
                Some(own) if depth > 0.0 => own.pressure(depth, stone.depth, 0.0),
                Some(_) => 0.0,
            };
            let elastic = loading - law.unloading_at(depth) * (level - pressed.lowest);
            if elastic <= 0.0 {
                continue;
            }
            let column = stone.depth * COLUMN;
            let push = column * (elastic - self.soil.damping * rise).max(0.0);
            force += push;
            moment += arm * push;
            area += column;
        }
        if area == 0.0 {
            *stretch = 0.0;
            return [0.0; 3];
        }
        let limit = shear.cohesion * area + force * shear.tan_friction_angle;
        // The underside slides, not the centre: a stone that rolls on sand does not shear it.
        let below = lowest - stone.centre[1];
        let sliding = stone.velocity[0] - stone.spin * below;
        let deepest = self.soil.shear_modulus.max(1.0e-4);
        *stretch = (*stretch + sliding * dt).clamp(-deepest, deepest);
        let damping = (self.soil.damping * area * sliding).clamp(-limit, limit);
        let along = (-limit * *stretch / deepest - damping).clamp(-limit, limit);
        [along, force, moment - along * below]
    }

    /// Load of the soil on the wheel over one step of `dt` [s].
    pub fn push(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, dt: f64) -> Reach {
        let rolling = rolling_speed(wheel, motion);
        self.since_field += dt;
        self.way += rolling * dt;
        if self.is_due(rolling, motion.y) {
            let first = !self.since_field.is_finite();
            let elapsed = if first { dt } else { self.since_field };
            self.field = self.stress_field(wheel, motion, elapsed);
            (self.since_field, self.way) = (0.0, 0.0);
        }
        self.field.at(motion)
    }

    /// Whether the field has to be worked out anew for a wheel that rolls at this speed [m/s] at this `height` [m].
    fn is_due(&self, rolling: f64, height: f64) -> bool {
        const EARLY: f64 = 1.0 - 1.0e-9;
        let moved = self.way >= ADVANCE || (height - self.field.height).abs() >= HEAVE;
        let slow = rolling < SLOW;
        self.since_field >= EARLY / FULL_RATE && (moved || slow)
    }

    /// Works the whole stress field out; `elapsed` [s] since the last time.
    fn stress_field(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, elapsed: f64) -> Field {
        if self.facing.turn(wheel, motion, elapsed) {
            self.rim_shear.turn_around();
            self.bites.turn_around();
        }
        self.columns.follow(wheel, motion.x, elapsed);
        let contact = self.contact(wheel, motion, elapsed);
        let mut field = Field {
            height: motion.y,
            vertical_speed: motion.vy,
            ..Field::default()
        };
        let under = self.under_rim(wheel, motion, &contact);
        self.clear_rim(wheel, motion, under.clone());
        self.push_rim(wheel, motion, &contact, under.clone(), &mut field);
        self.bites
            .push(wheel, motion, &contact, &mut self.columns, &mut field);
        self.heap.push(wheel, &contact, &mut field);
        self.transport
            .carry(wheel, motion, &contact, under, &mut self.columns);
        field
    }

    /// The contact at this slip, from where the rim enters the soil it has come upon.
    fn contact(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, elapsed: f64) -> Contact {
        let (soil, direction) = (self.soil, self.facing.direction);
        let entry = self.columns.entry_angle(wheel.radius, motion, direction);
        let contact_length = wheel.radius * entry.max(0.05);
        let developed = 1.0 - exp(-2.0 * self.facing.rolled / contact_length);
        // Slip weakens soil as the flow develops, not at the first jerk, and soil that has flowed stays so when the
        // wheel stops.
        let way = rolling_speed(wheel, motion) * elapsed;
        let slip = if standing(wheel, motion) {
            self.facing.slip.unwrap_or(0.0)
        } else {
            let momentary = SlipRatio::from_motion(wheel.radius, motion.omega, motion.vx).get();
            self.facing
                .slip_over(momentary, way / (0.5 * contact_length))
        };
        let slip = developed * slip;
        let angles = ContactAngles::from_entry(&soil, entry, slip).developed(developed);
        Contact {
            soil,
            slip,
            direction,
            developed,
            depth: EffectiveDepth::over(angles, &soil, wheel.radius, slip),
            law: soil.pressure_sinkage(wheel.width, slip).at_rate(
                soil.departures
                    .rate_factor(penetration_rate(motion.vx, entry)),
            ),
            shear: soil.shear(),
            own: self.own.clone(),
            width: wheel.width,
            wheel_speed: motion.omega * direction,
            forward_speed: motion.vx * direction,
            rise: motion.vy,
            elapsed,
        }
    }

    /// Works out which part of every column under the rim no lug stands in: soil under a lug bears its edge.
    fn clear_rim(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, under: Range<i64>) {
        self.clear.clear();
        self.clear.resize((under.end - under.start) as usize, 1.0);
        for edge in wheel.lowest_edges(motion) {
            let [sine, cosine] = [edge.arm[0] / edge.radius, -edge.arm[1] / edge.radius];
            let middle = motion.x + wheel.radius * sine;
            let half = 0.5 * self.bites.thickness() * cosine;
            let [from, to] = [middle - half, middle + half].map(|x| x / COLUMN);
            let columns = from.round() as i64..=to.round() as i64;
            for index in columns.filter(|index| under.contains(index)) {
                let [left, right] = [index as f64 - 0.5, index as f64 + 0.5];
                let stands = (to.min(right) - from.max(left)).max(0.0);
                self.clear[(index - under.start) as usize] -= stands;
            }
        }
    }

    /// The columns that the rim may bear on.
    fn under_rim(
        &self,
        wheel: &WheelGeometry,
        motion: &WheelMotion,
        contact: &Contact,
    ) -> Range<i64> {
        let ContactAngles { entry, exit, .. } = contact.depth.angles;
        let [behind, front] = [exit, entry].map(|angle| wheel.radius * libm::sin(angle));
        let [low, high] = if contact.direction > 0.0 {
            [behind, front]
        } else {
            [-front, -behind]
        };
        self.columns
            .indices(motion.x + low - COLUMN, motion.x + high + COLUMN)
    }

    /// Pressure and shear of every column under the rim.
    fn push_rim(
        &mut self,
        wheel: &WheelGeometry,
        motion: &WheelMotion,
        contact: &Contact,
        under: Range<i64>,
        field: &mut Field,
    ) {
        let (r, d) = (wheel.radius, contact.direction);
        let ContactAngles { peak, exit, .. } = contact.depth.angles;
        self.rim_shear
            .advance(contact, motion.angle, r, self.shear_radius);
        let at_peak = match contact.depth.convention {
            StressConvention::Triangular => Some(self.rim_shear.at(peak, motion.angle, d)),
            StressConvention::WongReece => None,
        };
        let springing = contact.developed * (1.0 - contact.law.base.pressed(contact.depth.sinkage));
        let behind = r * libm::sin(exit);
        for (index, clear) in under.zip(&self.clear) {
            let u = (index as f64 * COLUMN - motion.x) * d;
            if u.abs() >= r {
                continue;
            }
            // What lies behind the exit is not pressed again: soil that lugs leave there is loose.
            let share = ((u - behind) / COLUMN + 0.5).clamp(0.0, 1.0);
            if share == 0.0 {
                self.columns.set_loaded(index, false);
                continue;
            }
            let down = (r * r - u * u).sqrt();
            let angle = asin(u / r);
            // Behind straight down the ground springs back along the rim as far as θ_2; a base
            // does not.
            let spring_back = if u < 0.0 { springing * (r - down) } else { 0.0 };
            let level = motion.y - down - spring_back;
            let pressed = self.columns.press(index, level);
            let Some(bearing) = contact.bearing(
                pressed,
                level,
                angle,
                contact.depth.share(angle, spring_back),
            ) else {
                self.columns.set_loaded(index, false);
                continue;
            };
            self.columns.set_loaded(index, true);
            let here = || self.rim_shear.at(angle, motion.angle, d);
            let stress = contact.shear_stress(bearing.pressure, angle, at_peak, here);
            // The arc of the shear surface is longer than the rim's.
            let shear = stress * self.shear_radius / r;
            let area = wheel.width * COLUMN * share * clear;
            let tangent = u / down;
            field.reach.wrench += Wrench {
                fx: d * area * (shear - bearing.pressure * tangent),
                fy: area * (bearing.pressure + shear * tangent),
                torque: -d * area * shear * self.shear_radius * r / down,
            };
            field.stiffen(area, &bearing, &contact.soil);
        }
    }
}

/// Pressure at one place and how it changes with depth.
struct Bearing {
    /// Normal stress [Pa].
    pressure: f64,
    /// Its growth when pressed deeper [Pa/m].
    loading: f64,
    /// Its fall when let up [Pa/m].
    unloading: f64,
}

/// Where soil was pressed to.
#[derive(Debug, Clone, Copy)]
struct Pressed {
    /// Undisturbed height [m].
    virgin: f64,
    /// Lowest level it was pressed to [m], with what it will spring back.
    lowest: f64,
    /// Lowest level that the wheel itself has reached there [m]: so near is a hard base.
    reached: f64,
}

impl Contact {
    /// Part [-] of the strength that a shear `displacement` [m] mobilises.
    fn mobilised(&self, displacement: f64) -> f64 {
        match &self.own {
            None => self.shear.mobilised(displacement),
            Some(own) => own.mobilised(displacement),
        }
    }

    /// Shear stress [Pa] at an `angle` [rad] under a normal `pressure` [Pa]: mobilised by the displacement
    /// [m] `at_peak` everywhere (triangular stress), or by the one `here` (Wong and Reece).
    fn shear_stress(
        &self,
        pressure: f64,
        angle: f64,
        at_peak: Option<f64>,
        here: impl FnOnce() -> f64,
    ) -> f64 {
        match at_peak {
            None => self.shear.strength(pressure) * self.mobilised(here()),
            Some(displacement) => {
                let cohesion = self.shear.cohesion * self.depth.triangle(angle);
                (cohesion + pressure * self.shear.tan_friction_angle) * self.mobilised(displacement)
            }
        }
    }

    /// Pressure of soil pressed to `pressed` under a wheel now at `level` [m], of whose depth
    /// `share` counts; `None` where they have parted.
    fn bearing(&self, pressed: Pressed, level: f64, angle: f64, share: f64) -> Option<Bearing> {
        let depth = pressed.virgin - pressed.reached;
        let share = share + (1.0 - share) * self.law.base.pressed(depth);
        let counted = (pressed.virgin - pressed.lowest) * share;
        if counted <= 0.0 || angle > std::f64::consts::FRAC_PI_2 {
            return None;
        }
        let virgin = match &self.own {
            None => self.law.pressure_of_column(counted, depth),
            Some(own) => own.pressure(counted, self.width, self.slip),
        };
        let unloading = self.law.unloading_at(depth);
        let gap = level - pressed.lowest;
        let elastic = virgin - unloading * gap;
        if elastic <= 0.0 {
            return None;
        }
        let loading = match &self.own {
            _ if gap > 0.0 => unloading,
            None => {
                self.law.exponent * virgin / counted.max(1.0e-6) * self.law.growth(counted, depth)
            }
            Some(own) => own.stiffness(counted, self.width, self.slip),
        };
        let pressure = (elastic - self.soil.damping * self.rise).max(0.0);
        Some(Bearing {
            pressure,
            loading,
            unloading,
        })
    }
}

/// Whether the wheel neither rolls nor slides.
fn standing(wheel: &WheelGeometry, motion: &WheelMotion) -> bool {
    rolling_speed(wheel, motion) < STANDING
}

/// Speed [m/s] of the rim or of the axle, whichever is faster.
fn rolling_speed(wheel: &WheelGeometry, motion: &WheelMotion) -> f64 {
    motion.vx.abs().max((wheel.radius * motion.omega).abs())
}

impl Facing {
    /// Takes the direction of travel from the motion; a standing wheel, and one that swings back by less than
    /// [`REVERSAL`], keeps its own. Whether it has turned around.
    fn turn(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, elapsed: f64) -> bool {
        let rim_speed = wheel.radius * motion.omega;
        if standing(wheel, motion) {
            return false;
        }
        let direction = if motion.vx.abs() >= STANDING {
            motion.vx.signum()
        } else {
            rim_speed.signum()
        };
        let way = rolling_speed(wheel, motion) * elapsed;
        if direction == self.direction {
            self.back = 0.0;
            self.rolled += way;
            return false;
        }
        self.back += way;
        // Before it has rolled at all it may set out either way.
        let turns = self.back > REVERSAL || self.rolled == 0.0;
        if turns {
            *self = Self {
                direction,
                rolled: self.back,
                back: 0.0,
                slip: None,
            };
        }
        turns
    }

    /// The slip [-] that soil has flowed with, after a way of so many half contact lengths at the `momentary` one.
    fn slip_over(&mut self, momentary: f64, way: f64) -> f64 {
        let before = self.slip.unwrap_or(momentary);
        let slip = momentary + (before - momentary) * exp(-way);
        self.slip = Some(slip);
        slip
    }
}

impl Field {
    /// Counts a loaded area [m²] in.
    fn stiffen(&mut self, area: f64, bearing: &Bearing, soil: &Soil) {
        self.stiffness[0] += area * bearing.loading;
        self.stiffness[1] += area * bearing.unloading;
        self.damping += area * soil.damping;
    }

    /// The load at a height that has changed a little since the field was worked out.
    fn at(&self, motion: &WheelMotion) -> Reach {
        let deeper = self.height - motion.y;
        let stiffness = if deeper > 0.0 {
            self.stiffness[0]
        } else {
            self.stiffness[1]
        };
        let change = stiffness * deeper - self.damping * (motion.vy - self.vertical_speed);
        let mut reach = self.reach;
        reach.wrench.fy = (reach.wrench.fy + change).max(0.0);
        reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use crate::soil::departures::Departures;
    use crate::wheel::Lugs;

    const DT: f64 = 1.0 / FULL_RATE;

    pub(super) fn sand() -> Soil {
        Soil {
            convention: StressConvention::WongReece,
            cohesive_modulus: 15.6e3,
            frictional_modulus: 2407.4e3,
            sinkage_exponent: 0.909,
            sinkage_exponent_slip: 0.577,
            cohesion: 250.0,
            friction_angle_deg: 31.9,
            shear_modulus: 0.0114,
            stress_angle: 0.4,
            stress_angle_slip: 0.3,
            exit_angle: -0.2,
            unloading_stiffness: 2.0e7,
            damping: 3.0e4,
            bulk_density: 1600.0,
            repose_angle_deg: 32.0,
            departures: Departures::NONE,
        }
    }

    /// A wheel led over the soil by hand.
    struct Led {
        track: SoilTrack,
        wheel: WheelGeometry,
        motion: WheelMotion,
    }

    impl Led {
        fn new(wheel: Wheel) -> Self {
            Self::on(sand(), wheel)
        }

        fn on(soil: Soil, wheel: Wheel) -> Self {
            let flat = Profile::new(&crate::terrain::Relief::default(), 1.0e-3, Seed(0), 0);
            let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
            let motion = WheelMotion {
                cos: 1.0,
                ..WheelMotion::default()
            };
            Self {
                track: SoilTrack::new(flat, soil, &wheel, everywhere),
                wheel: WheelGeometry::new(&wheel, 100.0),
                motion,
            }
        }

        /// Stands at a sinkage [m] and returns the load [N].
        fn stand(&mut self, sinkage: f64) -> f64 {
            self.motion.y = self.wheel.radius - sinkage;
            self.track.push(&self.wheel, &self.motion, DT).wrench.fy
        }

        /// Rolls to `x` [m] at 50 mm/s and a sinkage [m]; returns the mean load [N] of the last
        /// half of the way.
        fn roll(&mut self, x: f64, sinkage: f64) -> f64 {
            let way = x - self.motion.x;
            let steps = (way.abs() / 0.05 * FULL_RATE) as usize;
            self.motion.vx = 0.05 * way.signum();
            self.motion.omega = self.motion.vx / self.wheel.radius;
            self.motion.y = self.wheel.radius - sinkage;
            let mut sum = 0.0;
            for step in 0..steps {
                let load = self.step();
                sum += if 2 * step >= steps { load } else { 0.0 };
            }
            2.0 * sum / steps as f64
        }
    }

    impl Led {
        /// Rolls forward to `x` [m] at a rim slip [-], 50 mm/s and a sinkage [m].
        fn slip(&mut self, x: f64, sinkage: f64, slip: f64) {
            self.motion.vx = 0.05;
            self.motion.omega = self.motion.vx / (self.wheel.radius * (1.0 - slip));
            self.motion.y = self.wheel.radius - sinkage;
            while self.motion.x < x {
                self.step();
            }
        }

        /// Turns in place by so much [rad] at a sinkage [m].
        fn spin(&mut self, sinkage: f64, angle: f64) {
            self.motion.omega = 0.4;
            self.motion.y = self.wheel.radius - sinkage;
            while self.motion.angle < angle {
                self.step();
            }
        }

        fn step(&mut self) -> f64 {
            self.motion.x += self.motion.vx * DT;
            self.motion.angle += self.motion.omega * DT;
            self.motion.cos = libm::cos(self.motion.angle);
            self.motion.sin = libm::sin(self.motion.angle);
            self.track.push(&self.wheel, &self.motion, DT).wrench.fy
        }
    }

    fn smooth() -> Wheel {
        Wheel {
            lugs: None,
            ..Wheel::single_wheel()
        }
    }

    #[test]
    fn soil_unloads_steeply_and_bears_again_what_it_bore() {
        let mut led = Led::new(smooth());
        let pressed = led.stand(0.006);
        let lifted = led.stand(0.006 - 6.0e-4);
        assert!(lifted < 0.6 * pressed, "{lifted} of {pressed}");
        assert_eq!(led.stand(0.006 - 2.0e-3), 0.0);
        let again = led.stand(0.006);
        assert!((again / pressed - 1.0).abs() < 1e-9, "{again} of {pressed}");
        let mut virgin = Led::new(smooth());
        let (deeper, at_once) = (led.stand(0.009), virgin.stand(0.009));
        assert!(
            (deeper / at_once - 1.0).abs() < 1e-9,
            "{deeper} of {at_once}"
        );
    }

    #[test]
    fn a_second_pass_in_the_rut_finds_it_pressed() {
        let mut led = Led::new(smooth());
        let first = led.roll(0.3, 0.008);
        led.roll(0.0, 0.008);
        let second = led.roll(0.3, 0.008);
        assert!(second < 0.2 * first, "{second} of {first}");
        let fresh = Led::new(smooth()).roll(0.3, 0.010);
        let deeper = led.roll(0.0, 0.010);
        // Two millimetres into the rut, contact is short but stress is that of the whole depth.
        assert!(deeper > 0.3 * fresh, "{deeper} of {fresh}");
    }

    #[test]
    fn the_rut_lies_at_the_depth_of_the_rim() {
        let mut led = Led::new(smooth());
        led.roll(0.4, 0.008);
        let rut = led.track.surface(0.1, 0.2);
        assert!(rut.len() > 90);
        assert!(
            rut.iter()
                .all(|[_, height]| (height + 0.008).abs() < 1.0e-4)
        );
    }

    #[test]
    fn prints_of_lugs_relax_to_the_angle_of_repose() {
        let lugs = Some(Lugs {
            count: 12,
            height: 0.015,
            thickness: 0.003,
            edge_radius: None,
        });
        let mut led = Led::new(Wheel { lugs, ..smooth() });
        led.roll(0.5, 0.004);
        let track = led.track.surface(0.05, 0.25);
        let deepest = track.iter().map(|[_, height]| *height).fold(0.0, f64::min);
        assert!(deepest < -0.0045, "no print below the rim: {deepest}");
        let steepest = track
            .windows(2)
            .map(|pair| (pair[1][1] - pair[0][1]).abs() / COLUMN)
            .fold(0.0, f64::max);
        // The last slides are a hundredth of the slope.
        assert!(steepest < 1.02 * 32.0_f64.to_radians().tan(), "{steepest}");
    }

    #[test]
    fn slopes_slide_without_losing_soil() {
        let mut led = Led::new(smooth());
        led.stand(0.010);
        let volume =
            |led: &mut Led| -> f64 { led.track.surface(-0.3, 0.3).iter().map(|[_, h]| h).sum() };
        let before = volume(&mut led);
        // Held above the ground while the edges of its print slide.
        for _ in 0..(2.0 * FULL_RATE) as usize {
            led.stand(-0.03);
        }
        let after = volume(&mut led);
        assert!((after - before).abs() < 1.0e-9, "{before} to {after}");
    }

    fn lugged(count: u32) -> Wheel {
        let lugs = Some(Lugs {
            count,
            height: 0.015,
            thickness: 0.003,
            edge_radius: None,
        });
        Wheel { lugs, ..smooth() }
    }

    /// Highest and lowest ground [m] between two places, less the undisturbed.
    fn highest_and_lowest(led: &mut Led, low: f64, high: f64) -> [f64; 2] {
        let heights = led.track.surface(low, high).into_iter().map(|[_, h]| h);
        heights.fold([f64::NEG_INFINITY, f64::INFINITY], |[most, least], h| {
            [most.max(h), least.min(h)]
        })
    }

    #[test]
    fn lugs_dig_below_the_wheel_and_fill_the_rut_behind_it_again() {
        let wheel = lugged(28);
        let carried = crate::soil::lug_action::carried_layer(&wheel, &sand());
        let mut led = Led::new(wheel);
        let (sinkage, slip) = (0.025, 0.5);
        led.slip(0.6, sinkage, slip);
        // By the balance of mass: κ = ω r_h/v - 1 at slip 0.5.
        let dug = carried * ((0.14 + 0.5 * carried) / (0.5 * 0.14) - 1.0);
        let [_, under] = highest_and_lowest(&mut led, 0.59, 0.61);
        assert!((under + sinkage).abs() < 1.0e-3, "{under}");
        let rut = led.track.surface(0.25, 0.45);
        let mean = rut.iter().map(|[_, height]| height).sum::<f64>() / rut.len() as f64;
        // Every lug leaves a print of one column, which takes 15 mm² out of 15.7 mm of track: 1 mm.
        let error = mean + sinkage - dug;
        assert!((-1.5e-3..0.1e-3).contains(&error), "{error} of {dug}");
    }

    #[test]
    fn a_wheel_that_spins_in_place_digs_itself_a_hole_and_heaps_its_soil_behind_it() {
        let mut led = Led::new(lugged(28));
        led.spin(0.010, 3.0);
        let [heap, _] = highest_and_lowest(&mut led, -0.2, 0.0);
        let [_, hole] = highest_and_lowest(&mut led, 0.0, 0.1);
        assert!(heap > 0.002, "{heap}");
        assert!(hole < -0.012, "{hole}");
        let surface = led.track.surface(-0.3, -0.11);
        let steepest = surface
            .windows(2)
            .map(|pair| (pair[1][1] - pair[0][1]).abs() / COLUMN)
            .fold(0.0, f64::max);
        assert!(steepest < 1.05 * 32.0_f64.to_radians().tan(), "{steepest}");
    }

    #[test]
    fn a_small_wheel_is_borne_by_the_pressure_at_its_diameter() {
        let departures = Departures {
            diameter_exponent: 0.5,
            ..Departures::NONE
        };
        let soil = Soil {
            departures,
            ..sand()
        };
        let load = |soil: Soil| Led::on(soil, smooth()).stand(0.008);
        // A wheel of 0.28 m: (0.28/0.5)^0.5 by hand.
        assert!((load(soil) / load(sand()) - 0.748_331).abs() < 1e-6);
    }
}
