//! Where a wheel's arc meets the soil and how normal stress is spread over it.
//!
//! Angles are measured at the axle from straight down, positive ahead.

use crate::soil::pressure_sinkage::PressureSinkage;
use crate::soil::real::Real;
use crate::soil::{Soil, StressConvention};
use std::f64::consts::FRAC_PI_2;

/// Entry, peak and exit of the contact \[rad\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactAngles<T = f64> {
    /// Entry angle `θ_1 = arccos(1 - z/r)`.
    pub entry: T,
    /// Angle of maximum stress `θ_m = (c_1 + c_2 s) θ_1`, kept within the contact.
    pub peak: T,
    /// Exit angle `θ_2 = c_3 θ_1`.
    pub exit: T,
}

impl<T: Real> ContactAngles<T> {
    /// The contact of a wheel of `radius` \[m\] at `sinkage` \[m\] and `slip` [-] (Section 5.1).
    ///
    /// A wheel above the soil has an empty contact at 0; one deeper than its axle is cut off there.
    pub fn new(soil: &Soil<T>, radius: f64, sinkage: T, slip: T) -> Self {
        Self::from_entry(soil, entry_angle(T::constant(radius), sinkage), slip)
    }

    /// The angles of a contact that begins at `entry` \[rad\], at `slip` [-].
    pub fn from_entry(soil: &Soil<T>, entry: T, slip: T) -> Self {
        let exit = entry * soil.exit_angle;
        let peak = (soil.stress_angle + soil.stress_angle_slip * slip) * entry;
        Self {
            entry,
            peak: peak.within([exit, entry]),
            exit,
        }
    }
}

impl ContactAngles {
    /// Between a wheel let down at rest (0), which presses alike ahead and behind
    /// (`θ_m = 0`, `θ_2 = -θ_1`), and one whose soil flow is that of steady rolling (1).
    pub fn developed(self, share: f64) -> Self {
        let Self { entry, peak, exit } = self;
        Self {
            entry,
            peak: share * peak,
            exit: share * exit - (1.0 - share) * entry,
        }
    }
}

/// Angle \[rad\] at which a circle of `radius` \[m\] whose lowest point lies `sinkage` \[m\] deep enters
/// the soil; in [0, π/2].
///
/// `2 arcsin √(z/2r)` equals `arccos(1 - z/r)` and keeps its digits at small sinkage.
pub fn entry_angle<T: Real>(radius: T, sinkage: T) -> T {
    let part = (sinkage / radius).within([0.0, 1.0].map(T::constant));
    ((part * 0.5).sqrt().asin() * 2.0).smaller(T::constant(FRAC_PI_2))
}

/// Depth that stands for the soil's resistance at each angle: `σ(θ) = k_s z_e(θ)ᴺ`.
///
/// Wong-Reece: the local depth ahead of the peak, behind it the depth at the angle mirrored
/// through the peak; at most one cosine a call, no power. Triangular: `z·tri(θ)^(1/N)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectiveDepth<T = f64> {
    /// Stress distribution over the contact.
    pub convention: StressConvention,
    /// The contact.
    pub angles: ContactAngles<T>,
    /// Radius of the wheel's surface \[m\].
    pub radius: f64,
    /// Depth of its lowest point \[m\].
    pub sinkage: T,
    /// Sinkage exponent `N` [-].
    pub exponent: T,
    cos_entry: T,
}

impl<T: Real> EffectiveDepth<T> {
    /// The depths under a wheel of `radius` \[m\] at `sinkage` \[m\] and `slip` [-].
    pub fn new(soil: &Soil<T>, radius: f64, sinkage: T, slip: T) -> Self {
        let angles = ContactAngles::new(soil, radius, sinkage, slip);
        Self::over(angles, soil, radius, slip)
    }

    /// The same over angles found otherwise: on uneven ground, or by a wheel that only begins to
    /// roll.
    pub fn over(angles: ContactAngles<T>, soil: &Soil<T>, radius: f64, slip: T) -> Self {
        let cos_entry = angles.entry.cos();
        Self {
            convention: soil.convention,
            angles,
            radius,
            sinkage: (-cos_entry + 1.0) * radius,
            exponent: soil.exponent(slip),
            cos_entry,
        }
    }

    /// The depth \[m\] at `angle` \[rad\]; 0 outside the contact.
    pub fn at(&self, angle: T) -> T {
        match self.convention {
            StressConvention::WongReece => self.mirrored_depth(angle),
            StressConvention::Triangular => {
                let part = self.triangle(angle);
                if part > 0.0 {
                    self.sinkage * part.pow(T::constant(1.0) / self.exponent)
                } else {
                    T::constant(0.0)
                }
            }
        }
    }

    /// Depth \[m\] to which the rim has pressed the ground at `angle` \[rad\]: its own ahead of
    /// straight down, the deepest behind.
    pub fn pressed(&self, angle: T) -> T {
        if angle < 0.0 {
            return self.sinkage;
        }
        self.local_depth(angle)
    }

    /// Height [-] of the triangle that is 1 at the peak and 0 at entry and exit.
    pub fn triangle(&self, angle: T) -> T {
        let ContactAngles { entry, peak, exit } = self.angles;
        if angle <= exit || angle >= entry {
            T::constant(0.0)
        } else if angle >= peak {
            (entry - angle) / (entry - peak)
        } else {
            (angle - exit) / (peak - exit)
        }
    }

    /// `r (cos θ - cos θ_1)` ahead of the peak; behind it the same at
    /// `θ_1 - (θ - θ_2)(θ_1 - θ_m)/(θ_m - θ_2)`.
    fn mirrored_depth(&self, angle: T) -> T {
        let ContactAngles { entry, peak, exit } = self.angles;
        if angle <= exit || angle >= entry {
            return T::constant(0.0);
        }
        let front = if angle >= peak {
            angle
        } else {
            entry - (angle - exit) * (entry - peak) / (peak - exit)
        };
        self.local_depth(front)
    }

    /// `r (cos θ - cos θ_1)`, 0 outside the soil.
    fn local_depth(&self, angle: T) -> T {
        let depth = (angle.cos() - self.cos_entry) * self.radius;
        depth.larger(T::constant(0.0))
    }
}

impl EffectiveDepth {
    /// Effective depth at `angle` over the depth to which ground there has been pressed in steady
    /// rolling [-]: by how much to scale the depth of ground that remembers its own.
    ///
    /// That depth is the rim's own, `r (cos θ - cos θ_1)`, and `spring_back` \[m\] more where the
    /// ground has risen since.
    pub fn share(&self, angle: f64, spring_back: f64) -> f64 {
        let pressed = self.radius * (libm::cos(angle) - self.cos_entry) + spring_back;
        let ahead_of_peak =
            self.convention == StressConvention::WongReece && angle >= self.angles.peak;
        if angle <= self.angles.exit {
            0.0
        } else if pressed <= 0.0 || (ahead_of_peak && spring_back == 0.0) {
            1.0
        } else {
            self.at(angle) / pressed
        }
    }
}

/// Normal stress over the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalStress<T = f64> {
    /// Depths that stand for it.
    pub depth: EffectiveDepth<T>,
    /// Pressure against those depths.
    pub law: PressureSinkage<T>,
    /// Maximum stress `σ_m` \[Pa\].
    pub peak: T,
    /// Depth [m] to which the ground was dug before it was pressed: so much nearer is a hard base.
    dug: T,
}

impl<T: Real> NormalStress<T> {
    /// The stress under a wheel of `radius` and `width` \[m\] at `sinkage` \[m\] and `slip` [-].
    ///
    /// `σ_m` is `k_s zᴺ` in the triangular convention and `k_s rᴺ (cos θ_m - cos θ_1)ᴺ` in
    /// Wong-Reece's.
    pub fn new(soil: &Soil<T>, rim: [f64; 2], sinkage: T, slip: T) -> Self {
        Self::on_dug_ground(soil, rim, [sinkage, T::constant(0.0)], slip)
    }

    /// The same at `sinkage` [m] into ground of which `dug` [m] were taken off.
    pub(crate) fn on_dug_ground(
        soil: &Soil<T>,
        [radius, width]: [f64; 2],
        [sinkage, dug]: [T; 2],
        slip: T,
    ) -> Self {
        let law = soil.pressure_sinkage(width, slip);
        Self::by(law, soil, radius, [sinkage, dug], slip)
    }

    /// The same at another sinkage, with the same law of pressure.
    pub(crate) fn at_sinkage(&self, soil: &Soil<T>, depths: [T; 2], slip: T) -> Self {
        Self::by(self.law, soil, self.depth.radius, depths, slip)
    }

    fn by(
        law: PressureSinkage<T>,
        soil: &Soil<T>,
        radius: f64,
        [sinkage, dug]: [T; 2],
        slip: T,
    ) -> Self {
        let depth = EffectiveDepth::new(soil, radius, sinkage, slip);
        let peak_depth = match soil.convention {
            StressConvention::WongReece => (depth.angles.peak.cos() - depth.cos_entry) * radius,
            StressConvention::Triangular => depth.sinkage,
        };
        Self {
            depth,
            law,
            peak: law.pressure_of(peak_depth, peak_depth + dug),
            dug,
        }
    }

    /// Normal stress \[Pa\] at `angle` \[rad\]; 0 outside the contact.
    ///
    /// # Reference
    /// Wong and Reece (1967), J. Terramechanics 4(1):81-98; Eq. (62)-(65) for the triangles.
    pub fn at(&self, angle: T) -> T {
        match self.depth.convention {
            StressConvention::WongReece if self.law.is_ideal() => {
                self.law.pressure(self.depth.at(angle))
            }
            StressConvention::WongReece => self
                .law
                .pressure_of(self.depth.at(angle), self.depth.pressed(angle) + self.dug),
            StressConvention::Triangular => self.peak * self.depth.triangle(angle),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::table_6;

    const CONVENTIONS: [StressConvention; 2] =
        [StressConvention::WongReece, StressConvention::Triangular];

    fn stress(convention: StressConvention, slip: f64) -> NormalStress {
        let soil = Soil {
            convention,
            exit_angle: -0.2,
            ..table_6::sand()
        };
        NormalStress::new(&soil, [0.155, 0.15], 0.012, slip)
    }

    #[test]
    fn entry_angle_is_arccos_of_one_minus_z_over_r() {
        assert!((entry_angle(0.14, 0.02) - (1.0f64 - 0.02 / 0.14).acos()).abs() < 1e-14);
        assert_eq!(entry_angle(0.14, -0.01), 0.0);
        assert_eq!(entry_angle(0.14, 0.3), FRAC_PI_2);
        // θ_1 → √(2z/r) at small sinkage, where arccos has lost half its digits.
        let tiny = entry_angle(0.14, 1e-15);
        assert!((tiny / (2e-15f64 / 0.14).sqrt() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn normal_stress_vanishes_at_entry_and_exit_and_peaks_between() {
        for convention in CONVENTIONS {
            for slip in [-0.3, 0.0, 0.5] {
                let stress = stress(convention, slip);
                let ContactAngles { entry, peak, exit } = stress.depth.angles;
                assert!(exit < peak && peak < entry);
                assert_eq!(stress.at(entry), 0.0);
                assert_eq!(stress.at(exit), 0.0);
                assert!((stress.at(peak) / stress.peak - 1.0).abs() < 1e-12);
                for part in 1..100 {
                    let angle = exit + (entry - exit) * f64::from(part) / 100.0;
                    assert!(stress.at(angle) <= stress.peak * (1.0 + 1e-12));
                }
            }
        }
    }

    #[test]
    fn normal_stress_is_the_pressure_at_the_effective_depth() {
        for convention in CONVENTIONS {
            let stress = stress(convention, 0.2);
            for angle in [-0.05, 0.0, 0.1, 0.2, 0.35] {
                let by_depth = stress.law.pressure(stress.depth.at(angle));
                assert!((stress.at(angle) - by_depth).abs() <= 1e-12 * stress.peak);
            }
        }
    }

    #[test]
    fn normal_stress_has_no_jump_anywhere() {
        for convention in CONVENTIONS {
            let stress = stress(convention, 0.2);
            let steps = 200_000;
            let angle = |i: i32| -0.5 + f64::from(i) / f64::from(steps);
            // At this step the steepest part of z^0.97 at entry climbs less than 1e-4 of the peak.
            for i in 0..steps {
                let rise = (stress.at(angle(i + 1)) - stress.at(angle(i))).abs();
                assert!(rise < 1e-3 * stress.peak, "{convention:?} at {}", angle(i));
            }
        }
    }

    #[test]
    fn wong_reece_depth_ahead_of_the_peak_is_the_local_depth() {
        let depth = stress(StressConvention::WongReece, 0.0).depth;
        let angle = 0.3_f64;
        let local = 0.155 * angle.cos() - (0.155 - 0.012);
        assert!(angle > depth.angles.peak);
        assert!((depth.at(angle) - local).abs() < 1e-15);
    }

    #[test]
    fn a_peak_driven_past_the_exit_stays_at_the_exit() {
        // The ST row has c_1 + c_2 s < 0 beyond s = 0.69 while c_3 = 0.
        let angles = ContactAngles::new(&table_6::sand(), 0.155, 0.02, 0.9);
        assert_eq!(angles.peak, angles.exit);
        let stress = NormalStress::new(&table_6::sand(), [0.155, 0.15], 0.02, 0.9);
        assert!(stress.at(1e-9).is_finite() && stress.at(1e-9) > 0.99 * stress.peak);
    }
}
