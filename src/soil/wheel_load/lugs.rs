//! Loads on the lugs of a wheel in steady rolling: on their edges and on their faces.

use super::{Contact, Rolling, Shearing, WheelLoad, integral};
use crate::soil::Soil;
use crate::soil::carried_soil::CarriedSoil;
use crate::soil::closed_form::Rim;
use crate::soil::contact::{ContactAngles, entry_angle};
use crate::soil::lug_action::{LugFace, covered, shear_radius, unconfined};
use crate::soil::real::Real;
use crate::soil::shear::ShearDisplacement;
use crate::wheel::Wheel;
use std::f64::consts::TAU;

/// Lugs in the soil, which they have dug.
pub(super) struct LugLoads<'a, T> {
    wheel: &'a Wheel,
    soil: &'a Soil<T>,
    slip: T,
    carried: CarriedSoil<T>,
    /// Shear radius [m].
    sheared_at: T,
    /// Depth [m] below the axle of the ground ahead, from which nothing was taken yet.
    ahead: T,
    /// The same behind, where the rim's lowest point has pressed it and the soil carried lies on it again.
    behind: T,
    /// The edges' contact with the ground that lies under the rim.
    edges: Contact<T>,
}

impl<'a, T: Real> LugLoads<'a, T> {
    /// Lugs of `wheel`, whose rim has sunk by `sinkage` [m], `dug` [m] of it by carrying soil away.
    pub fn new(
        wheel: &'a Wheel,
        soil: &'a Soil<T>,
        [sinkage, dug]: [T; 2],
        rolling: Rolling<T>,
    ) -> Self {
        let rim = Rim {
            radius: wheel.tip_radius(),
            ..Rim::from(wheel)
        };
        let tip = T::constant(rim.radius);
        let depth = sinkage + wheel.lug_height();
        let below = Contact::on_dug_ground(rim, tip, soil, [depth - dug, dug], rolling);
        let ahead = -sinkage + wheel.radius;
        Self {
            wheel,
            soil,
            slip: rolling.slip,
            carried: CarriedSoil::new(wheel, soil, rolling),
            sheared_at: shear_radius(wheel, soil),
            ahead,
            behind: ahead + (sinkage - dug).larger(T::constant(0.0)),
            // An edge shears soil by its own displacement since it met the ground ahead.
            edges: Contact {
                displacement: ShearDisplacement::new(tip, entry_angle(tip, depth), rolling.travel),
                shearing: Shearing::There,
                ..below
            },
        }
    }

    /// Loads on the edges of a wheel whose rim has the contact `rim`.
    ///
    /// Ground under the rim is dug by the whole depth, ground ahead of it the less the farther it is.
    pub fn of_edges(&self, panels: u32, rim: ContactAngles<T>) -> WheelLoad<T> {
        let ContactAngles { peak, exit, .. } = self.edges.normal.depth.angles;
        let meets = entry_angle(
            T::constant(self.edges.rim.radius),
            -self.ahead + self.edges.rim.radius,
        );
        let full = rim.entry.larger(peak).smaller(meets);
        let under = self.edges.integrate([exit, peak], panels)
            + integral([peak, full], |angle| self.edges.load_per_angle(angle));
        // Nodes drawn to where edges meet the ground, as in `Contact::integrate`.
        let ahead = integral([0.0, 1.0].map(T::constant), |u| {
            let angle = meets - (meets - full) * u * u;
            self.edge_ahead(angle) * ((meets - full) * 2.0 * u)
        });
        (under + ahead) * T::constant(covered(self.wheel, self.edges.rim.radius))
    }

    /// Load per angle on edges at `angle` [rad], ahead of the rim's contact.
    fn edge_ahead(&self, angle: T) -> WheelLoad<T> {
        let dug = self.dug_at(angle.sin(), self.ahead);
        let sinkage = -(self.ahead + dug) + self.edges.rim.radius;
        let normal = self
            .edges
            .normal
            .at_sinkage(self.soil, [sinkage, dug], self.slip);
        Contact {
            normal,
            ..self.edges
        }
        .load_per_angle(angle)
    }

    /// Depth dug [m] below an edge at an angle of this sine, where ground that nothing was taken from lies so far below
    /// the axle [m].
    fn dug_at(&self, sin: T, ground: T) -> T {
        let across = sin * self.edges.rim.radius / self.sheared_at;
        let cos = (-(across * across) + 1.0).larger(T::constant(1e-6)).sqrt();
        self.carried.dug(self.sheared_at * cos - ground, cos)
    }

    /// Loads on the faces that pass through soil outside the contact `rim`, integrated over the angle [rad] at which a
    /// lug stands.
    pub fn of_faces(&self, rim: ContactAngles<T>) -> WheelLoad<T> {
        let tip = self.edges.rim.radius;
        let leaves = |below: T| (below / tip).within([-1.0, 1.0].map(T::constant)).acos();
        let confined = self.wheel.lug_height() / self.wheel.radius;
        let ContactAngles { entry, exit, .. } = rim;
        let of_one = self.of_face(
            rim,
            [exit, exit - confined, -leaves(self.behind)],
            self.behind,
        ) + self.of_face(
            rim,
            [entry, entry + confined, leaves(self.ahead)],
            self.ahead,
        );
        of_one * T::constant(f64::from(self.wheel.lug_count()) / TAU)
    }

    /// From the end of the rim's contact over the place where nothing confines the soil any more to where lugs leave it,
    /// all [rad], with ground that nothing was taken from so far below the axle [m].
    fn of_face(
        &self,
        rim: ContactAngles<T>,
        [end, free, leaves]: [T; 3],
        ground: T,
    ) -> WheelLoad<T> {
        let outward = if leaves < 0.0 { -1.0 } else { 1.0 };
        let within = |angle: T| (angle * outward).smaller(leaves * outward) * outward;
        let [end, free] = [within(end), within(free)];
        let face = LugFace::new(self.wheel, self.soil);
        let load = |angle: T| {
            let (sin, cos) = angle.sin_cos();
            let surface = ground + self.dug_at(sin, ground);
            let push = face.push(cos * self.edges.rim.radius - surface);
            let sheared = self.edges.displacement.at(angle);
            let part = self.edges.shear.mobilised(sheared) * unconfined(self.wheel, angle, rim);
            WheelLoad {
                normal_force: push.force * sin,
                drawbar_pull: push.force * cos,
                driving_torque: push.moment,
            } * part
        };
        (integral([end, free], load) + integral([free, leaves], load)) * T::constant(outward)
    }
}
