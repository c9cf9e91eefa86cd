//! Lugs in soil: they cut, bear, shear and push.
//!
//! Soil between the lugs moves with the wheel. It shears along a surface from each lug's edge up
//! to the rim ([`crate::soil::lug_action`]), which sets the rim's shear displacement, area and
//! torque arm. What acts at the lugs themselves is here. The edge presses the soil below it over
//! the lug's thickness, with the rim's modulus: a blade lies far below the widths `k_c` was
//! measured with. Its depth counts along the arc as the rim's does. A lug outside the rim's
//! contact, where nothing confines the soil before it, pushes it with passive pressure. The cut
//! closes behind the lug; its print remains where the rim has already left, and relaxes to the
//! angle of repose. What lugs carry backward is moved by [`super::transport`].

use super::columns::{Columns, Surface};
use super::{Contact, Field, Pressed};
use crate::simulation::contact::{Edge, WheelGeometry};
use crate::simulation::motion::{WheelMotion, Wrench};
use crate::soil::Soil;
use crate::soil::contact::{ContactAngles, EffectiveDepth, entry_angle};
use crate::soil::lug_action::{LugFace, unconfined};
use crate::wheel::Wheel;
use libm::asin;

/// A lug has entered when its edge lies deeper than this below the undisturbed soil [m].
const ENTERED: f64 = 1.0e-3;

/// What a lug's edge remembers of its stay in the soil.
#[derive(Debug, Clone, Copy)]
struct Bite {
    /// Lowest level pressed [m], with what it will spring back.
    lowest: f64,
    /// Lowest level of the edge itself [m].
    reached: f64,
    /// Shear displacement [m].
    shear: f64,
}

const NO_BITE: Bite = Bite {
    lowest: f64::INFINITY,
    reached: f64::INFINITY,
    shear: 0.0,
};

/// All lugs' bites.
pub(super) struct LugBites {
    wheel: Wheel,
    soil: Soil,
    face: LugFace,
    /// Area of one lug's edge [m²].
    area: f64,
    bites: [Bite; 64],
}

impl LugBites {
    pub fn new(wheel: &Wheel, soil: &Soil) -> Self {
        let area = wheel.lugs.map_or(0.0, |lugs| lugs.thickness * wheel.width);
        Self {
            wheel: *wheel,
            soil: *soil,
            face: LugFace::new(wheel, soil),
            area,
            bites: [NO_BITE; 64],
        }
    }

    /// Thickness of a lug [m].
    pub fn thickness(&self) -> f64 {
        self.wheel.lugs.map_or(0.0, |lugs| lugs.thickness)
    }

    /// Counts shear displacement in the other direction of travel.
    pub fn turn_around(&mut self) {
        self.bites
            .iter_mut()
            .for_each(|bite| bite.shear = -bite.shear);
    }

    /// Load of the soil on every lug in it.
    pub fn push(
        &mut self,
        wheel: &WheelGeometry,
        motion: &WheelMotion,
        contact: &Contact,
        columns: &mut Columns,
        field: &mut Field,
    ) {
        for edge in wheel.lowest_edges(motion) {
            let Some(index) = columns.index_at(edge.x) else {
                self.bites[edge.lug] = NO_BITE;
                continue;
            };
            let ground = columns.surface_at(index);
            let Surface {
                virgin,
                height,
                dug,
            } = ground;
            if edge.y >= height {
                let bite = std::mem::replace(&mut self.bites[edge.lug], NO_BITE);
                if bite.lowest.is_finite() {
                    // What lies on a base does not spring back, and no print reaches into it.
                    let base = contact.law.base.pressed(virgin + dug - bite.reached);
                    let bottom = bite.lowest + base * (bite.reached - bite.lowest);
                    columns.print(index, bottom.max(height - self.wheel.lug_height()));
                }
                continue;
            }
            if virgin - edge.y > ENTERED {
                field.reach.entered |= 1 << edge.lug;
            }
            let wrench = self.push_lug(motion, contact, &edge, ground, field);
            if wrench.force() > wheel.touch_force {
                field.reach.touching |= 1 << edge.lug;
            }
            field.reach.wrench += wrench;
        }
    }

    /// One lug's edge pressed into the soil, and its face against the soil behind it.
    fn push_lug(
        &mut self,
        motion: &WheelMotion,
        contact: &Contact,
        edge: &Edge,
        Surface {
            virgin,
            height,
            dug,
        }: Surface,
        field: &mut Field,
    ) -> Wrench {
        let (radius, d) = (edge.radius, contact.direction);
        let (sine, cosine) = (edge.arm[0] * d / radius, -edge.arm[1] / radius);
        let angle = asin(sine.clamp(-1.0, 1.0));
        let bite = &mut self.bites[edge.lug];
        bite.reached = bite.reached.min(edge.y);
        let spring_back = if angle < 0.0 {
            let springing = 1.0 - contact.law.base.pressed(virgin + dug - bite.reached);
            contact.developed * springing * radius * (1.0 - cosine)
        } else {
            0.0
        };
        let level = edge.y - spring_back;
        bite.lowest = bite.lowest.min(level);
        bite.shear +=
            (radius * contact.wheel_speed - contact.forward_speed * cosine) * contact.elapsed;
        let (pressed, mobilised) = (
            Pressed {
                virgin,
                lowest: bite.lowest,
                reached: bite.reached - dug,
            },
            contact.mobilised(bite.shear),
        );
        let entry = entry_angle(radius, virgin - (motion.y - radius));
        let angles =
            ContactAngles::from_entry(&self.soil, entry, contact.slip).developed(contact.developed);
        let share = EffectiveDepth::over(angles, &self.soil, radius, contact.slip)
            .share(angle, spring_back);
        let (mut along, mut radial) = (0.0, 0.0);
        if let Some(bearing) = contact.bearing(pressed, level, angle, share) {
            along += self.area * contact.shear.strength(bearing.pressure) * mobilised;
            radial += self.area * bearing.pressure;
            field.stiffen(self.area, &bearing, &self.soil);
        }
        let mut moment = along * radius;
        let part = mobilised * unconfined(&self.wheel, angle, contact.depth.angles);
        if part != 0.0 {
            let push = self.face.push(height - edge.y);
            along += push.force * part;
            moment += push.moment * part;
        }
        Wrench {
            fx: d * (along * cosine - radial * sine),
            fy: along * sine + radial * cosine,
            torque: -d * moment,
        }
    }
}
