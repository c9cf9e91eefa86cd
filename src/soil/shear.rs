//! Shear stress against shear displacement: Mohr-Coulomb strength, Janosi-Hanamoto mobilisation.

use crate::soil::Soil;
use crate::soil::real::Real;

/// Shear strength of a soil and how displacement mobilises it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear<T = f64> {
    /// Cohesion `c` \[Pa\].
    pub cohesion: T,
    /// Tangent of the internal friction angle `tan φ` [-].
    pub tan_friction_angle: T,
    /// Shear deformation modulus `K` \[m\]; 0 on ground that does not deform in shear.
    pub modulus: T,
}

impl<T: Real> Soil<T> {
    /// The soil's shear law.
    pub fn shear(&self) -> Shear<T> {
        Shear {
            cohesion: self.cohesion,
            tan_friction_angle: self.tan_friction_angle(),
            modulus: self.shear_modulus,
        }
    }

    /// Coefficient of passive earth pressure `K_p = tan²(45° + φ/2)` [-] (Rankine 1857).
    pub fn passive_pressure_coefficient(&self) -> T {
        let root = (self.friction_angle_deg / 2.0 + 45.0).radians().tan();
        root * root
    }
}

impl<T: Real> Shear<T> {
    /// Shear strength `c + σ tan φ` \[Pa\] under `normal_stress` \[Pa\] (Mohr-Coulomb).
    pub fn strength(&self, normal_stress: T) -> T {
        self.cohesion + normal_stress * self.tan_friction_angle
    }

    /// Part of the strength that `displacement` \[m\] mobilises, in [-1, 1] and of its sign [-].
    ///
    /// ```text
    /// E = 1 - exp(-j/K)
    /// ```
    ///
    /// Odd in `j`: a braked wheel shears the soil forward. `K = 0` mobilises all of it at once, at
    /// `j = 0` too (Eq. 66 divides by zero there; corrected).
    ///
    /// # Reference
    /// Janosi and Hanamoto (1961), 1st Int. Conf. on Terrain-Vehicle Systems; Eq. (66).
    pub fn mobilised(&self, displacement: T) -> T {
        let magnitude = if self.modulus > 0.0 {
            -(-displacement.magnitude() / self.modulus).exp_m1()
        } else {
            T::constant(1.0)
        };
        if displacement < 0.0 {
            -magnitude
        } else {
            magnitude
        }
    }

    /// Shear stress \[Pa\] under `normal_stress` \[Pa\] after `displacement` \[m\], of its sign.
    pub fn stress(&self, normal_stress: T, displacement: T) -> T {
        self.strength(normal_stress) * self.mobilised(displacement)
    }
}

/// Travel of the axle per length of rim turned, `v/(r ω)` [-], at the rim's `slip` [-].
///
/// `1 - s` driving and `1/(1 + s)` braking: the same motion in the two definitions of slip.
/// A locked wheel (`s = -1`) has a very large one rather than none.
pub fn speed_ratio<T: Real>(slip: T) -> T {
    const LOCKED: f64 = 1e-9;
    if slip >= 0.0 {
        -slip + 1.0
    } else {
        T::constant(1.0) / (slip + 1.0).larger(T::constant(LOCKED))
    }
}

/// Shear displacement along the contact of a wheel in steady rolling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearDisplacement<T = f64> {
    /// Radius `r_s` \[m\] of the surface on which the soil shears.
    pub shear_radius: T,
    /// Angle [rad] at which that surface enters the soil.
    entry_angle: T,
    sin_entry: T,
    /// Travel of the axle per angle turned `v/ω` [m]: the rim radius times [`speed_ratio`].
    travel: T,
}

impl<T: Real> ShearDisplacement<T> {
    /// A surface at `shear_radius` \[m\] that enters the soil at `entry_angle` \[rad\], with the
    /// `travel` \[m\] of the axle per angle turned.
    pub fn new(shear_radius: T, entry_angle: T, travel: T) -> Self {
        Self {
            shear_radius,
            entry_angle,
            sin_entry: entry_angle.sin(),
            travel,
        }
    }

    /// Shear displacement `j` \[m\] at `angle` \[rad\] from straight down, positive ahead.
    ///
    /// ```text
    /// j(θ) = r_s (θ_1 - θ) - (v/ω) (sin θ_1 - sin θ)
    ///      = r_s [(θ_1 - θ) - (1 - s) (sin θ_1 - sin θ)]   driving, s at r_s
    /// ```
    ///
    /// It follows a point of the wheel from its entry, `dj = (r_s - (v/ω) cos θ) ω dt` with
    /// `dθ = -ω dt`. A point of the ground under a slipping wheel stays longer: what it feels
    /// grows as `dj = (r_s ω - v cos θ) dt` with `dθ = -v dt/(r_s cos θ)`, more by about
    /// `1/(1 - s)`.
    ///
    /// # Reference
    /// Wong and Reece (1967), J. Terramechanics 4(1):81-98.
    pub fn at(&self, angle: T) -> T {
        let chord = self.sin_entry - angle.sin();
        self.shear_radius * (self.entry_angle - angle) - self.travel * chord
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::SlipRatio;

    fn sand() -> Shear {
        Shear {
            cohesion: 250.0,
            tan_friction_angle: 0.6224,
            modulus: 0.0114,
        }
    }

    #[test]
    fn janosi_hanamoto_reaches_63_percent_of_mohr_coulomb_at_j_equal_k() {
        let part = sand().stress(5000.0, 0.0114) / sand().strength(5000.0);
        assert!((part - (1.0 - (-1f64).exp())).abs() < 1e-14);
        assert_eq!(sand().strength(5000.0), 250.0 + 0.6224 * 5000.0);
    }

    #[test]
    fn shear_stress_is_odd_in_displacement() {
        for j in [1e-6, 0.003, 0.1] {
            assert_eq!(sand().stress(5000.0, -j), -sand().stress(5000.0, j));
        }
    }

    #[test]
    fn ground_that_does_not_deform_in_shear_mobilises_all_its_strength_at_once() {
        let stone = Shear {
            modulus: 0.0,
            ..sand()
        };
        assert_eq!(stone.mobilised(0.0), 1.0);
        assert_eq!(stone.mobilised(1e-12), 1.0);
        assert_eq!(stone.mobilised(-1e-12), -1.0);
    }

    #[test]
    fn speed_ratio_is_forward_speed_over_rim_speed_driving_and_braking() {
        let (radius, wheel_speed) = (0.14, 0.1);
        for forward_speed in [0.002, 0.0139, 0.0141, 0.5] {
            let slip = SlipRatio::from_motion(radius, wheel_speed, forward_speed).get();
            let expected = forward_speed / (radius * wheel_speed);
            assert!((speed_ratio(slip) / expected - 1.0).abs() < 1e-12);
        }
        assert!(speed_ratio(-1.0).is_finite());
    }

    #[test]
    fn shear_displacement_is_the_path_integral_of_the_slip_velocity() {
        for slip in [-0.5, -0.1, 0.0, 0.2, 1.0] {
            let (shear_radius, rim_radius, entry_angle) = (0.15, 0.14, 0.4);
            let travel = rim_radius * speed_ratio(slip);
            let displacement = ShearDisplacement::new(shear_radius, entry_angle, travel);
            assert_eq!(displacement.at(entry_angle), 0.0);
            // Midpoint rule with 1000 steps: relative error below 1e-7.
            let (angle, steps) = (-0.1, 1000);
            let step = (entry_angle - angle) / f64::from(steps);
            let path: f64 = (0..steps)
                .map(|i| entry_angle - (f64::from(i) + 0.5) * step)
                .map(|theta| (shear_radius - travel * theta.cos()) * step)
                .sum();
            assert!((path - displacement.at(angle)).abs() < 1e-8, "slip {slip}");
        }
    }

    #[test]
    fn braking_shears_forward_and_driving_backward() {
        let at_bottom = |slip: f64| {
            let displacement = ShearDisplacement::new(0.14, 0.3, 0.14 * speed_ratio(slip));
            displacement.at(0.0)
        };
        assert!(at_bottom(0.2) > 0.0 && at_bottom(0.0) > 0.0);
        assert!(at_bottom(-0.2) < 0.0 && at_bottom(-1.0) < 0.0);
    }
}
