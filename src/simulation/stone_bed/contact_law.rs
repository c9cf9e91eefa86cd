//! What two touching spheres do to each other.
//!
//! ```text
//! F_n = ⁴⁄₃ E* √(R* δ³) - c_n v_n ≥ 0,   c_n = 2 √(5/6) β √(S_n m*),   S_n = 2 E* √(R* δ)
//! F_t = -k_t ξ - c_t v_t,   |F_t| ≤ μ F_n,   k_t = 0.82 S_n,   c_t = 2 √(5/6) β √(k_t m*)
//! ```
//!
//! Hertz's force over the overlap δ; Tsuji's damping (Powder Technology 71, 1992), by which two spheres part at the same share `e` of
//! the speed at which they met, whatever it was. As spheres do not pull on each other here, they part a little before the overlap
//! is gone, and `e(β)` is found by integrating the impact (`-ln e / √(π² + ln² e)`, Tsuji's β, gives 0.25 for 0.1); Mindlin's tangential stiffness, at ν 0.25, on the slip ξ since they met, up to Coulomb's
//! limit. Spheres carry no rolling moment: clumps interlock instead.

use nalgebra::Vector3;

/// Tangential over normal stiffness [-]: `2 (1 - ν) / (2 - ν)` at a Poisson's ratio of 0.25, less 4 % for the spread of rock.
const MINDLIN: f64 = 0.82;

/// The law of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLaw {
    /// Effective modulus `E*` [Pa].
    modulus: f64,
    /// `2 √(5/6) β` [-].
    damping: f64,
    /// Friction coefficient [-].
    friction: f64,
}

/// Two spheres that touch.
#[derive(Debug, Clone, Copy)]
pub struct Touch {
    /// Unit vector towards the first.
    pub normal: Vector3<f64>,
    /// Overlap `δ` [m].
    pub overlap: f64,
    /// Effective radius `R*` [m].
    pub radius: f64,
    /// Effective mass `m*` [kg].
    pub mass: f64,
    /// Velocity [m/s] of the first against the second where they touch.
    pub velocity: Vector3<f64>,
}

impl ContactLaw {
    /// Contacts of effective `modulus` [Pa], coefficients of restitution and of friction [-].
    pub fn new(modulus: f64, restitution: f64, friction: f64) -> Self {
        Self {
            modulus,
            damping: 2.0 * libm::sqrt(5.0 / 6.0) * damping_ratio(restitution),
            friction,
        }
    }

    /// The same with another coefficient of friction [-].
    pub fn with_friction(self, friction: f64) -> Self {
        Self { friction, ..self }
    }

    /// Damping ratio `β` [-].
    pub fn damping_ratio(&self) -> f64 {
        self.damping / (2.0 * libm::sqrt(5.0 / 6.0))
    }

    /// Stiffness [N/m] of a contact of effective `radius` [m] under `load` [N].
    pub fn stiffness(&self, radius: f64, load: f64) -> f64 {
        libm::cbrt(6.0 * self.modulus * self.modulus * radius * load)
    }

    /// Force [N] on the first of two spheres, which have slipped by `slip` [m], over a step of `dt` [s].
    // A call passes its vectors through memory, which takes longer than the sums.
    #[inline(always)]
    pub fn force(&self, touch: &Touch, slip: &mut Vector3<f64>, dt: f64) -> Vector3<f64> {
        let Touch {
            normal,
            overlap,
            radius,
            mass,
            velocity,
        } = touch;
        let stiffness = 2.0 * self.modulus * (radius * overlap).sqrt();
        let tangential = MINDLIN * stiffness;
        let damping = self.damping * (stiffness * mass).sqrt();
        let parting = velocity.dot(normal);
        let push = (stiffness * overlap / 1.5 - damping * parting).max(0.0);
        let sliding = velocity - normal * parting;
        // What of the slip has turned out of the plane of contact is dropped.
        *slip += sliding * dt;
        *slip -= normal * slip.dot(normal);
        let drag = *slip * -tangential - sliding * (damping * MINDLIN.sqrt());
        let limit = self.friction * push;
        let size = drag.norm_squared();
        if size <= limit * limit {
            return drag + normal * push;
        }
        let farthest = limit / tangential;
        let length = slip.norm();
        if length > farthest {
            *slip *= farthest / length;
        }
        drag * (limit / size.sqrt()) + normal * push
    }
}

/// The damping ratio `β` [-] of a `restitution` [-], by bisection.
fn damping_ratio(restitution: f64) -> f64 {
    let [mut low, mut high] = [0.0, 4.0];
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if restitution_of(middle) > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The restitution [-] of a damping `ratio` β [-]: of an impact in units of mass, speed and stiffness,
/// `x'' = -max(x^(3/2) + √5 β x^(1/4) x', 0)`, by the midpoint rule.
fn restitution_of(ratio: f64) -> f64 {
    const STEP: f64 = 0.005;
    let push = |x: f64, v: f64| {
        let root = x.max(0.0).sqrt();
        (root * x + libm::sqrt(5.0) * ratio * root.sqrt() * v).max(0.0)
    };
    let (mut x, mut v) = (0.0, 1.0);
    loop {
        let (half_x, half_v) = (x + 0.5 * STEP * v, v - 0.5 * STEP * push(x, v));
        let force = push(half_x, half_v);
        if v < 0.0 && force == 0.0 {
            return -v;
        }
        x += STEP * half_v;
        v -= STEP * force;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Speed [m/s] of a sphere of 35 mm that falls on another, fixed one at 1 m/s, as it leaves; and how long [s] it touched.
    fn bounce(law: &ContactLaw, rate: f64) -> [f64; 2] {
        let (mass, radius, dt) = (0.059, 0.0175, 1.0 / rate);
        let (mut gap, mut speed, mut steps) = (1.0e-9, -1.0, 0);
        let mut slip = Vector3::zeros();
        loop {
            gap += speed * dt;
            if gap > 0.0 {
                return [speed, f64::from(steps) * dt];
            }
            steps += 1;
            let touch = Touch {
                normal: Vector3::y(),
                overlap: -gap,
                radius,
                mass,
                velocity: Vector3::y() * speed,
            };
            speed += law.force(&touch, &mut slip, dt).y / mass * dt;
        }
    }

    #[test]
    fn a_dropped_sphere_rebounds_by_its_restitution() {
        for restitution in [0.1, 0.2, 0.4, 0.7] {
            let law = ContactLaw::new(1.0e9, restitution, 0.6);
            let [speed, _] = bounce(&law, 1.0e6);
            assert!((speed - restitution).abs() < 0.01, "{restitution}: {speed}");
            // And at the rate of a bed's steps.
            let [coarse, _] = bounce(&law, 40.0e3);
            assert!(
                (coarse - restitution).abs() < 0.05,
                "{restitution}: {coarse}"
            );
        }
    }

    #[test]
    fn an_undamped_impact_lasts_as_long_as_hertz_found() {
        let law = ContactLaw::new(1.0e9, 1.0, 0.0);
        let [speed, duration] = bounce(&law, 1.0e7);
        // Johnson, Contact Mechanics, (11.24): 2.87 (m*² / (R* E*² v))^(1/5).
        let expected = 2.868 * libm::pow(0.059 * 0.059 / (0.0175 * 1.0e18), 0.2);
        assert!((speed - 1.0).abs() < 1e-3);
        assert!(
            (duration / expected - 1.0).abs() < 0.01,
            "{duration} {expected}"
        );
    }

    #[test]
    fn friction_holds_up_to_its_limit_and_slides_at_it() {
        let law = ContactLaw::new(1.0e9, 0.2, 0.5);
        let mut slip = Vector3::zeros();
        let touch = Touch {
            normal: Vector3::y(),
            overlap: 1.0e-5,
            radius: 0.01,
            mass: 0.05,
            velocity: Vector3::x() * 1.0e-3,
        };
        let forces: Vec<Vector3<f64>> = (0..4000)
            .map(|_| law.force(&touch, &mut slip, 1.0e-5))
            .collect();
        let push = forces[0].y;
        assert!(-forces[10].x < 0.1 * push);
        let last = forces[3999];
        assert!((last.x + 0.5 * push).abs() < 1e-9 * push, "{last}");
        // At the limit the spring keeps the slip that bears it.
        let farthest = 0.5 * push / (MINDLIN * 2.0 * 1.0e9 * (0.01f64 * 1.0e-5).sqrt());
        assert!((slip.norm() - farthest).abs() < 1e-3 * farthest);
    }

    #[test]
    fn stiffness_is_the_slope_of_hertz_force() {
        let law = ContactLaw::new(1.0e9, 1.0, 0.0);
        let (radius, overlap) = (0.01, 2.0e-5);
        let load = |overlap: f64| 4.0 / 3.0 * 1.0e9 * (radius * overlap * overlap * overlap).sqrt();
        let slope = (load(overlap + 1e-9) - load(overlap - 1e-9)) / 2e-9;
        let stiffness = law.stiffness(radius, load(overlap));
        assert!(
            (stiffness / slope - 1.0).abs() < 1e-4,
            "{stiffness} {slope}"
        );
    }
}
