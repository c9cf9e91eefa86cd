//! What lugs add to a rim in soil: a larger shear surface, pressure under their edges, and the push
//! of soil on lugs that no rim confines.
//!
//! Soil between lugs moves with the wheel. It shears off its surroundings along a saw-tooth: from
//! each lug's edge up to the rim along the passive wedge, which rises at `45° - φ/2` from the
//! edge's track. [`shear_radius`] is the mean of that surface. Each edge, of thickness `t`, bears
//! on soil one lug height deeper than the rim; averaged over the wheel's rotation the edges are a
//! wheel of radius `r + l` that covers the part `n_l t/(2π(r + l))` of its arc. Their pressure
//! follows `k_s` of the whole wheel, not `k_c/t`: a blade is far narrower than the plates that
//! `k_c` is measured with. Between lugs the wedges meet, so a passive push on every lug would
//! count the saw-tooth's shear twice; only a lug outside the rim's contact faces a free surface, and
//! is pushed ([`LugFace`]), the more the farther it is out, all of it one lug height beyond the rim's contact.
//!
//! # Reference
//! Passive wedge and pressure: Rankine (1857). Lugs as bearing and pushing blades: Bekker (1969),
//! *Introduction to Terrain-Vehicle Systems*. A shear radius `r + λ l` of chosen `λ` is usual for
//! lugged rover wheels; the saw-tooth predicts `λ`. Checked against measured pull, sinkage and
//! torque of a smooth and a lugged wheel in `tests/ding2011.rs`.

use crate::quantity::GRAVITY;
use crate::soil::Soil;
use crate::soil::contact::ContactAngles;
use crate::soil::real::Real;
use crate::wheel::{Lugs, Wheel};
use std::f64::consts::TAU;

/// Mean radius `r_s` \[m\] of the surface along which soil shears off a wheel.
///
/// ```text
/// r_s = r + λ l,  λ = L/(2p)      where the wedge is shorter than the pitch, L <= p
///                 λ = 1 - p/(2L)  otherwise
/// ```
///
/// `L = l cot(45° - φ/2)` is the wedge's length, `p = 2πr/n_l` the pitch at the rim. A layer of
/// soil that clings to the wheel ([`crate::soil::departures`]) adds its thickness.
pub fn shear_radius<T: Real>(wheel: &Wheel, soil: &Soil<T>) -> T {
    carried_layer(wheel, soil) + wheel.radius + soil.departures.clinging_layer
}

/// Mean thickness `λ l` \[m\] of the soil between lugs that moves with the wheel; 0 without lugs.
pub fn carried_layer<T: Real>(wheel: &Wheel, soil: &Soil<T>) -> T {
    let Some(Lugs { count, height, .. }) = wheel.lugs else {
        return T::constant(0.0);
    };
    let wedge = soil.passive_pressure_coefficient().sqrt() * height;
    let pitch = TAU * wheel.radius / f64::from(count);
    let fill = if wedge <= pitch {
        wedge * 0.5 / pitch
    } else {
        -(T::constant(0.5 * pitch) / wedge) + 1.0
    };
    fill * height
}

/// Part [-] of the arc of `radius` [m] that lugs cover.
pub(crate) fn covered(wheel: &Wheel, radius: f64) -> f64 {
    wheel.lugs.map_or(0.0, |lugs| {
        f64::from(lugs.count) * lugs.thickness / (TAU * radius)
    })
}

/// Part [-] of the passive push that acts on a lug at `angle` [rad] of a wheel whose rim has the contact `rim`: none in
/// it, all of it one lug height beyond its ends.
pub(crate) fn unconfined<T: Real>(wheel: &Wheel, angle: T, rim: ContactAngles<T>) -> T {
    let beyond = (rim.exit - angle).larger(angle - rim.entry);
    (beyond * wheel.radius / wheel.lug_height()).within([0.0, 1.0].map(T::constant))
}

/// Push of soil on a lug, fully mobilised.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LugPush<T = f64> {
    /// Force \[N\] along the wheel's circumference.
    pub force: T,
    /// Its moment about the axle [N·m].
    pub moment: T,
}

/// The face of a lug against soil with a free surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LugFace<T = f64> {
    /// Lug height [m].
    height: f64,
    /// Radius [m] of the lugs' edges.
    tip: f64,
    /// `½ γ b` [N/m²].
    unit_weight: f64,
    /// `2 c b` [N/m].
    cohesion: T,
    /// `K_p` [-].
    passive: T,
    /// `√K_p` [-].
    root: T,
}

impl<T: Real> LugFace<T> {
    /// A lug of `wheel` in `soil`.
    pub fn new(wheel: &Wheel, soil: &Soil<T>) -> Self {
        let passive = soil.passive_pressure_coefficient();
        Self {
            height: wheel.lug_height(),
            tip: wheel.tip_radius(),
            unit_weight: wheel.width * 0.5 * (soil.bulk_density * GRAVITY),
            cohesion: soil.cohesion * (wheel.width * 2.0),
            passive,
            root: passive.sqrt(),
        }
    }

    /// Passive push where the lug reaches `depth` \[m\] into the soil.
    ///
    /// ```text
    /// F = b (½ γ d² K_p + 2 c d √K_p)
    /// ```
    ///
    /// The first part acts a third, the second half a depth above the edge (Rankine).
    pub fn push(&self, depth: T) -> LugPush<T> {
        let depth = depth.within([0.0, self.height].map(T::constant));
        let weight = depth * self.unit_weight * depth * self.passive;
        let cohesion = self.cohesion * depth * self.root;
        LugPush {
            force: weight + cohesion,
            moment: weight * (-(depth / 3.0) + self.tip) + cohesion * (-(depth / 2.0) + self.tip),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::table_6;

    fn wheel(count: u32) -> Wheel {
        let lugs = Some(Lugs {
            count,
            height: 0.010,
            thickness: 0.001,
            edge_radius: None,
        });
        Wheel {
            lugs,
            ..Wheel::rover()
        }
    }

    #[test]
    fn shear_radius_grows_from_rim_to_edge_with_the_number_of_lugs() {
        let soil = table_6::sand();
        let smooth = Wheel {
            lugs: None,
            ..Wheel::rover()
        };
        let mut last = shear_radius(&smooth, &soil);
        assert_eq!(last, 0.155);
        for count in 1..=64 {
            let radius = shear_radius(&wheel(count), &soil);
            assert!(radius > last && radius < 0.165, "{count} lugs: {radius}");
            last = radius;
        }
    }

    #[test]
    fn shear_radius_is_the_mean_of_the_saw_tooth_in_both_branches() {
        let soil = table_6::sand();
        let slope = (45.0 - soil.friction_angle_deg / 2.0).to_radians().tan();
        for count in [12, 60] {
            let pitch = TAU * 0.155 / f64::from(count);
            let steps = 10_000;
            let height = |i: i32| {
                let along = pitch * (f64::from(i) + 0.5) / f64::from(steps);
                (0.010 - along * slope).max(0.0)
            };
            let mean = (0..steps).map(height).sum::<f64>() / f64::from(steps);
            let radius = shear_radius(&wheel(count), &soil);
            // Midpoint rule over a kink: error below pitch·slope/steps.
            assert!((radius - 0.155 - mean).abs() < 1e-7, "{count} lugs");
        }
    }

    #[test]
    fn the_push_on_a_lug_is_rankines() {
        let soil = Soil {
            friction_angle_deg: 30.0,
            cohesion: 0.0,
            bulk_density: 1000.0,
            ..table_6::sand()
        };
        // K_p = 3 at 30°.
        let push = LugFace::new(&wheel(24), &soil).push(0.01);
        let expected = 0.15 * 0.5 * 9806.65 * 1e-4 * 3.0;
        assert!((push.force / expected - 1.0).abs() < 1e-12);
        assert!((push.moment / push.force - (0.165 - 0.01 / 3.0)).abs() < 1e-12);
        assert_eq!(
            LugFace::new(&wheel(24), &soil).push(-0.01),
            LugPush::default()
        );
    }
}
