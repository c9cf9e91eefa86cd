//! Granular ground: a row of soil columns under the rim, and the lugs that cut into it.
//!
//! # Columns under the rim
//! Every column remembers how deep it was pressed. Plain columns would put the greatest stress
//! under the axle; measured stress peaks ahead of it, at `θ_m = (c_1 + c_2 s) θ_1`, and ends at
//! `θ_2 = c_3 θ_1`. So a column's depth counts in full ahead of `θ_m` and is scaled behind it by
//! the ratio of the depth that carries the stress there to the depth of the rim there
//! ([`crate::soil::wheel_load`]): a smooth wheel in steady rolling then reproduces the integral
//! of the stress convention the soil names, while ruts, passes and vibration act through each
//! column's own memory. The alternative, to integrate the convention over the wheel's present
//! sinkage, has no memory; plain columns have memory and no slip-sinkage.
//!
//! A wheel that is let down presses the soil alike ahead and behind (`θ_m = 0`, `θ_2 = -θ_1`);
//! the flow that moves the stress forward develops over half a contact length of rolling.
//!
//! Pressure falls steeply (unloading stiffness) when the wheel lifts off what it has pressed,
//! and grows along the virgin curve when it goes deeper. Shear follows Janosi-Hanamoto with the
//! column's own shear displacement, so that starts, stops and changes of slip are remembered.
//!
//! # Lugs
//! Soil between the lugs moves with the wheel. It shears along a surface from each lug's edge up
//! to the rim ([`crate::soil::wheel_load::shear_radius`]), which sets shear displacement, area
//! and torque arm. The edge of each lug presses the soil below it over the lug's thickness, with
//! the rim's modulus: a blade lies far below the widths `k_c` was measured with. A lug behind or
//! ahead of the rim's contact pushes the soil before it with passive pressure. The cut closes
//! behind the lug; its print remains where the rim has already left, and relaxes to the angle of
//! repose. What lugs throw backward is not moved: `N = n_0 + n_1 s` stands for that loss.
//!
//! # Cost
//! The stress field changes with the wheel's advance, not with its vibration. Above
//! [`FULL_RATE`] it is worked out every few steps and follows the wheel's height in between by
//! its own stiffness.

use super::contact::{Edge, Reach, WheelGeometry};
use super::GRAVITY;
use super::world::{WheelMotion, Wrench};
use crate::quantity::SlipRatio;
use crate::soil::Soil;
use crate::soil::wheel_load::{ContactArc, shear_radius};
use crate::terrain::profile::Profile;
use crate::wheel::Wheel;
use libm::{asin, exp, pow, sqrt, tan};
use std::collections::VecDeque;

/// Width of a column [m].
const COLUMN: f64 = 1.0e-3;

/// The stress field is worked out at least this often [Hz].
pub(super) const FULL_RATE: f64 = 16_000.0;

/// Loose slopes are relaxed this often [s].
const RELAX_EVERY: f64 = 0.02;

/// Slower than this the wheel stands [m/s]: a hundredth of the slowest rover.
const STANDING: f64 = 3.0e-5;

/// Columns made at once.
const BLOCK: i64 = 128;

/// A lug has entered when its edge lies deeper than this below the undisturbed soil [m].
const ENTERED: f64 = 1.0e-3;

/// One millimetre of track.
#[derive(Debug, Clone, Copy)]
struct Column {
    /// Undisturbed height [m].
    virgin: f64,
    /// Height when the wheel arrived [m].
    arrival: f64,
    /// Lowest level it was pressed to [m].
    pressed: f64,
    /// Shear displacement [m], positive backward.
    shear: f64,
    /// Whether the wheel is on it.
    loaded: bool,
}

/// What a lug's edge remembers of its stay in the soil.
#[derive(Debug, Clone, Copy)]
struct Bite {
    /// Lowest level pressed [m].
    pressed: f64,
    /// Shear displacement [m].
    shear: f64,
}

const NO_BITE: Bite = Bite { pressed: f64::INFINITY, shear: 0.0 };

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

/// A stretch of soil.
pub(super) struct SoilTrack {
    soil: Soil,
    profile: Profile,
    range: [f64; 2],
    shear_radius: f64,
    lug_area: f64,
    lug_height: f64,
    passive: f64,
    first: i64,
    columns: VecDeque<Column>,
    bites: [Bite; 64],
    /// Columns under the wheel at the last look.
    under: [i64; 2],
    /// Direction of travel, +1 or -1, and how far the rim has rolled that way [m].
    direction: f64,
    rolled: f64,
    field: Field,
    since_field: f64,
    since_relaxed: f64,
}

/// Constants of one evaluation of the stress field.
struct Contact {
    arc: ContactArc,
    /// How far the flow of a rolling wheel has developed, from 0 at rest to 1.
    developed: f64,
    exponent: f64,
    modulus: f64,
    tan_friction: f64,
    slip_speed: [f64; 2],
}

impl SoilTrack {
    /// Soil on `range` [m] whose undisturbed surface is `profile`.
    pub fn new(profile: Profile, soil: Soil, wheel: &Wheel, range: [f64; 2]) -> Self {
        let tan_friction = soil.tan_friction_angle();
        let half = tan(std::f64::consts::FRAC_PI_4 + 0.5 * libm::atan(tan_friction));
        Self {
            soil,
            profile,
            range,
            shear_radius: shear_radius(wheel, &soil),
            lug_area: wheel.lugs.map_or(0.0, |lugs| lugs.thickness * wheel.width),
            lug_height: wheel.lug_height(),
            passive: half,
            first: 0,
            columns: VecDeque::new(),
            bites: [NO_BITE; 64],
            under: [0, 0],
            direction: 1.0,
            rolled: 0.0,
            field: Field::default(),
            since_field: f64::INFINITY,
            since_relaxed: 0.0,
        }
    }

    /// The undisturbed surface.
    pub fn profile(&mut self) -> &mut Profile {
        &mut self.profile
    }

    /// The surface as it is now: position and height [m].
    pub fn surface(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let place = |i: usize| (self.first + i as i64) as f64 * COLUMN;
        self.columns.iter().enumerate().map(move |(i, column)| [place(i), column.pressed.min(column.arrival)])
    }

    /// Load of the soil on the wheel over one step of `dt` [s].
    pub fn push(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, dt: f64) -> Reach {
        self.since_field += dt;
        if self.since_field >= (1.0 - 1.0e-9) / FULL_RATE || dt >= 1.0 / FULL_RATE {
            let elapsed = if self.since_field.is_finite() { self.since_field } else { dt };
            self.since_field = 0.0;
            self.field = self.stress_field(wheel, motion, elapsed);
        }
        self.field.at(motion)
    }

    /// Works the whole stress field out; `elapsed` [s] since the last time.
    fn stress_field(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, elapsed: f64) -> Field {
        self.face(wheel, motion, elapsed);
        let span = wheel.tip_radius + 10.0 * COLUMN;
        self.extend(motion.x - span, motion.x + span);
        self.leave_behind(wheel, motion);
        let contact = self.contact(wheel, motion);
        let mut field = Field { height: motion.y, vertical_speed: motion.vy, ..Field::default() };
        self.push_rim(wheel, motion, &contact, elapsed, &mut field);
        self.push_lugs(wheel, motion, &contact, elapsed, &mut field);
        self.since_relaxed += elapsed;
        if self.since_relaxed >= RELAX_EVERY {
            self.since_relaxed = 0.0;
            self.relax(motion, span);
        }
        field
    }

    /// Takes the direction of travel from the motion; a standing wheel keeps its own.
    fn face(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, elapsed: f64) {
        let rim_speed = wheel.radius * motion.omega;
        if motion.vx.abs().max(rim_speed.abs()) < STANDING {
            return;
        }
        let direction = if motion.vx.abs() >= STANDING { motion.vx.signum() } else { rim_speed.signum() };
        if direction != self.direction {
            self.direction = direction;
            self.rolled = 0.0;
        }
        self.rolled += rim_speed.abs().max(motion.vx.abs()) * elapsed;
    }

    fn extend(&mut self, low: f64, high: f64) {
        let wanted = [(low / COLUMN).floor() as i64, (high / COLUMN).ceil() as i64 + 1];
        if self.columns.is_empty() {
            self.first = wanted[0];
        } else if self.first <= wanted[0] && self.first + (self.columns.len() as i64) >= wanted[1] {
            return;
        }
        let from = wanted[0] as f64 * COLUMN - BLOCK as f64 * COLUMN;
        self.profile.extend(from, wanted[1] as f64 * COLUMN + BLOCK as f64 * COLUMN);
        while self.first > wanted[0] {
            for _ in 0..BLOCK {
                self.first -= 1;
                let column = self.fresh(self.first);
                self.columns.push_front(column);
            }
        }
        while self.first + (self.columns.len() as i64) < wanted[1] {
            for _ in 0..BLOCK {
                let column = self.fresh(self.first + self.columns.len() as i64);
                self.columns.push_back(column);
            }
        }
    }

    fn fresh(&self, index: i64) -> Column {
        let virgin = self.profile.at(index as f64 * COLUMN).height;
        Column { virgin, arrival: virgin, pressed: virgin, shear: 0.0, loaded: false }
    }

    fn column(&mut self, index: i64) -> &mut Column {
        &mut self.columns[(index - self.first) as usize]
    }

    /// Columns in `[low, high]` [m] that belong to this stretch.
    fn indices(&self, low: f64, high: f64) -> [i64; 2] {
        let low = (low.max(self.range[0]) / COLUMN).ceil() as i64;
        let high = (high.min(self.range[1]) / COLUMN).floor() as i64 + 1;
        [low, high.max(low)]
    }

    /// Columns the rim has left forget their shear and meet the next pass as they are now.
    fn leave_behind(&mut self, wheel: &WheelGeometry, motion: &WheelMotion) {
        let under = self.indices(motion.x - wheel.radius, motion.x + wheel.radius);
        let gone = [self.under[0]..under[0].min(self.under[1]), under[1].max(self.under[0])..self.under[1]];
        for index in gone.into_iter().flatten() {
            if index >= self.first && index < self.first + self.columns.len() as i64 {
                let column = self.column(index);
                *column = Column { arrival: column.pressed.min(column.arrival), shear: 0.0, loaded: false, ..*column };
            }
        }
        self.under = under;
    }

    /// The contact arc and the soil's constants at this slip.
    fn contact(&mut self, wheel: &WheelGeometry, motion: &WheelMotion) -> Contact {
        let slip = SlipRatio::from_motion(wheel.radius, motion.omega, motion.vx).get();
        let entry_angle = self.entry_angle(wheel.radius, motion);
        let contact_length = wheel.radius * entry_angle.max(0.05);
        let developed = 1.0 - exp(-2.0 * self.rolled / contact_length);
        Contact {
            arc: ContactArc::new(&self.soil, entry_angle, slip).developed(developed),
            developed,
            exponent: self.soil.exponent(slip),
            modulus: self.soil.sinkage_modulus(wheel.width),
            tan_friction: self.soil.tan_friction_angle(),
            slip_speed: [motion.omega * self.direction, motion.vx * self.direction],
        }
    }

    /// Angle [rad] ahead of straight down at which the rim meets the soil it has come upon.
    fn entry_angle(&mut self, radius: f64, motion: &WheelMotion) -> f64 {
        let reach = (radius * 0.95 / COLUMN) as i64;
        let middle = (motion.x / COLUMN).round() as i64;
        let mut ahead: Option<[f64; 2]> = None;
        for step in (-reach..=reach).rev() {
            let index = middle + step * self.direction as i64;
            let u = (index as f64 * COLUMN - motion.x) * self.direction;
            if u.abs() >= radius || !self.contains(index) {
                continue;
            }
            let rim = motion.y - sqrt(radius * radius - u * u);
            let depth = self.column(index).arrival - rim;
            if depth > 0.0 {
                let entry = match ahead {
                    Some([u_ahead, depth_ahead]) => u + (u_ahead - u) * depth / (depth - depth_ahead),
                    None => u,
                };
                return asin((entry / radius).clamp(-1.0, 1.0));
            }
            ahead = Some([u, depth]);
        }
        0.0
    }

    fn contains(&self, index: i64) -> bool {
        let x = index as f64 * COLUMN;
        x >= self.range[0] && x < self.range[1]
    }

    /// Pressure and shear of every column under the rim.
    fn push_rim(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, contact: &Contact, elapsed: f64, field: &mut Field) {
        let Contact { arc, developed, exponent, modulus, tan_friction, slip_speed } = contact;
        let (r, d) = (wheel.radius, self.direction);
        let behind = r * libm::sin(arc.exit_angle);
        let front = r * libm::sin(arc.entry_angle);
        let (low, high) = if d > 0.0 { (behind, front) } else { (-front, -behind) };
        let [from, to] = self.indices(motion.x + low - COLUMN, motion.x + high + COLUMN);
        let soil = self.soil;
        let shear_scale = self.shear_radius / r;
        let triangular_shear = self.triangular_shear(motion, contact, r);
        for index in from..to {
            let u = (index as f64 * COLUMN - motion.x) * d;
            if u.abs() >= r {
                continue;
            }
            let share = ((u - behind) / COLUMN + 0.5).clamp(0.0, 1.0);
            let down = sqrt(r * r - u * u);
            let (sine, cosine) = (u / r, down / r);
            let angle = asin(sine);
            // Behind straight down the ground springs back along the rim as far as θ_2.
            let spring_back = if u < 0.0 { developed * (r - down) } else { 0.0 };
            let level = motion.y - down - spring_back;
            let column = self.column(index);
            if level < column.arrival {
                column.pressed = column.pressed.min(level);
            }
            let depth = column.virgin - column.pressed;
            let gap = level - column.pressed;
            if depth <= 0.0 || share == 0.0 {
                continue;
            }
            let counted = depth * arc.depth_ratio(angle, *exponent);
            let virgin = modulus * pow(counted, *exponent);
            let elastic = virgin - soil.unloading_stiffness * gap;
            if elastic <= 0.0 {
                column.loaded = false;
                column.shear = 0.0;
                continue;
            }
            column.loaded = true;
            let pressure = (elastic - soil.damping * motion.vy).max(0.0);
            let sliding = self.shear_radius * slip_speed[0] - slip_speed[1] * cosine;
            let column = self.column(index);
            column.shear += sliding * elapsed;
            let shear = match triangular_shear {
                Some(mobilised) => mobilised * (soil.cohesion * arc.triangle(angle) + pressure * tan_friction),
                None => (soil.cohesion + pressure * tan_friction) * mobilised(column.shear, soil.shear_modulus),
            };
            let shear = shear * shear_scale;
            let area = wheel.width * COLUMN * share;
            let tangent = sine / cosine;
            let fx = d * area * (shear - pressure * tangent);
            let fy = area * (pressure + shear * tangent);
            let torque = -d * area * shear * self.shear_radius / cosine;
            field.reach.wrench += Wrench { fx, fy, torque };
            let loading = exponent * virgin / counted.max(1.0e-6);
            field.stiffness[0] += area * if gap > 0.0 { soil.unloading_stiffness } else { loading };
            field.stiffness[1] += area * soil.unloading_stiffness;
            field.damping += area * soil.damping;
        }
    }

    /// Share of the shear strength mobilised over the whole arc, where the convention has one.
    fn triangular_shear(&mut self, motion: &WheelMotion, contact: &Contact, radius: f64) -> Option<f64> {
        if !contact.arc.is_triangular() {
            return None;
        }
        let u = radius * libm::sin(contact.arc.stress_angle);
        let index = ((motion.x + u * self.direction) / COLUMN).round() as i64;
        let shear = if self.contains(index) { self.column(index).shear } else { 0.0 };
        Some(mobilised(shear, self.soil.shear_modulus))
    }

    /// Bearing and push of every lug in the soil.
    fn push_lugs(&mut self, wheel: &WheelGeometry, motion: &WheelMotion, contact: &Contact, elapsed: f64, field: &mut Field) {
        if self.lug_area == 0.0 {
            return;
        }
        for edge in wheel.lowest_edges(motion) {
            let index = (edge.x / COLUMN).round() as i64;
            if !self.contains(index) {
                self.bites[edge.lug] = NO_BITE;
                continue;
            }
            let (virgin, arrival) = (self.column(index).virgin, self.column(index).arrival);
            if edge.y >= arrival {
                self.leave_print(edge.lug, index);
                continue;
            }
            if virgin - edge.y > ENTERED {
                field.reach.entered |= 1 << edge.lug;
            }
            let wrench = self.push_lug(wheel, motion, contact, &edge, virgin, elapsed, field);
            if sqrt(wrench.fx * wrench.fx + wrench.fy * wrench.fy) > wheel.touch_force {
                field.reach.touching |= 1 << edge.lug;
            }
            field.reach.wrench += wrench;
        }
    }
}

impl SoilTrack {
    /// One lug's edge pressed into the soil, and its face against the soil behind it.
    #[expect(clippy::too_many_arguments, reason = "to be split")]
    fn push_lug(
        &mut self,
        wheel: &WheelGeometry,
        motion: &WheelMotion,
        contact: &Contact,
        edge: &Edge,
        virgin: f64,
        elapsed: f64,
        field: &mut Field,
    ) -> Wrench {
        let (radius, d, soil) = (wheel.tip_radius, self.direction, self.soil);
        let (sine, cosine) = (edge.arm[0] * d / radius, -edge.arm[1] / radius);
        let angle = asin(sine.clamp(-1.0, 1.0));
        let entry = libm::acos(((motion.y - virgin) / radius).clamp(-1.0, 1.0));
        let arc = contact.arc.with_entry(entry);
        let spring_back = if angle < 0.0 { contact.developed * radius * (1.0 - cosine) } else { 0.0 };
        let level = edge.y - spring_back;
        let bite = &mut self.bites[edge.lug];
        bite.pressed = bite.pressed.min(level);
        let sliding = radius * contact.slip_speed[0] - contact.slip_speed[1] * cosine;
        bite.shear += sliding * elapsed;
        let (depth, gap, shear) = (virgin - bite.pressed, level - bite.pressed, bite.shear);
        let counted = depth.max(0.0) * arc.depth_ratio(angle, contact.exponent);
        let elastic = contact.modulus * pow(counted, contact.exponent);
        let pressure = if counted > 0.0 {
            (elastic - soil.unloading_stiffness * gap - soil.damping * motion.vy).max(0.0)
        } else {
            0.0
        };
        let share = mobilised(shear, soil.shear_modulus);
        let strength = if pressure > 0.0 { soil.cohesion + pressure * contact.tan_friction } else { 0.0 };
        let ahead_or_behind = angle > contact.arc.entry_angle || angle < contact.arc.exit_angle;
        let push = if ahead_or_behind { self.passive_push(wheel.width, virgin - edge.y) } else { 0.0 };
        let along = self.lug_area * strength * share + push * share;
        let radial = self.lug_area * pressure;
        if pressure > 0.0 {
            let loading = contact.exponent * elastic / counted.max(1.0e-6);
            field.stiffness[0] += self.lug_area * if gap > 0.0 { soil.unloading_stiffness } else { loading };
            field.stiffness[1] += self.lug_area * soil.unloading_stiffness;
            field.damping += self.lug_area * soil.damping;
        }
        Wrench {
            fx: d * (along * cosine - radial * sine),
            fy: along * sine + radial * cosine,
            torque: -d * along * radius,
        }
    }

    /// Passive (Rankine) resistance [N] of loose soil against a lug `depth` [m] deep in it.
    fn passive_push(&self, width: f64, depth: f64) -> f64 {
        let depth = depth.clamp(0.0, self.lug_height);
        let coefficient = self.passive * self.passive;
        let weight = 0.5 * self.soil.bulk_density * GRAVITY * depth * depth * coefficient;
        width * (weight + 2.0 * self.soil.cohesion * depth * self.passive)
    }

    /// A lug that leaves the soil leaves its print where no rim lies above it.
    fn leave_print(&mut self, lug: usize, index: i64) {
        let bite = std::mem::replace(&mut self.bites[lug], NO_BITE);
        let deepest = self.lug_height;
        let column = self.column(index);
        if bite.pressed.is_finite() && !column.loaded {
            column.pressed = column.pressed.min(bite.pressed.max(column.pressed - deepest));
        }
    }

    /// Slopes beyond the angle of repose slide, soil for soil, where the wheel is not.
    fn relax(&mut self, motion: &WheelMotion, span: f64) {
        let steepest = COLUMN * tan(self.soil.repose_angle_deg.to_radians());
        let [from, to] = self.indices(motion.x - 1.5 * span, motion.x + 1.5 * span);
        let from = from.max(self.first);
        let to = to.min(self.first + self.columns.len() as i64) - 1;
        for index in from..to {
            let (left, right) = (*self.column(index), *self.column(index + 1));
            if left.loaded || right.loaded {
                continue;
            }
            let step = right.pressed - left.pressed;
            let slide = 0.5 * (step.abs() - steepest).max(0.0) * step.signum();
            if slide != 0.0 {
                self.column(index).settle(slide);
                self.column(index + 1).settle(-slide);
            }
        }
    }
}

impl Column {
    /// Takes up or gives away soil of this height [m].
    fn settle(&mut self, height: f64) {
        self.pressed += height;
        self.arrival += height;
        self.virgin = self.virgin.max(self.pressed);
    }
}

impl Field {
    /// The load at a height that has changed a little since the field was worked out.
    fn at(&self, motion: &WheelMotion) -> Reach {
        let deeper = self.height - motion.y;
        let stiffness = if deeper > 0.0 { self.stiffness[0] } else { self.stiffness[1] };
        let change = stiffness * deeper - self.damping * (motion.vy - self.vertical_speed);
        let mut reach = self.reach;
        reach.wrench.fy = (reach.wrench.fy + change).max(0.0);
        reach
    }
}

/// Share of the shear strength mobilised at a shear displacement [m], with its sign.
fn mobilised(shear: f64, modulus: f64) -> f64 {
    if modulus == 0.0 {
        return if shear == 0.0 { 0.0 } else { shear.signum() };
    }
    shear.signum() * (1.0 - exp(-shear.abs() / modulus))
}
