//! The paper's closed forms (Eq. 62-69, 73-75): stresses triangular over the rim's arc.
//!
//! They use rim geometry throughout; fitted to a lugged wheel, as Table 6 is, their parameters
//! already contain what its lugs do.

use crate::soil::Soil;
use crate::soil::contact::ContactAngles;
use crate::soil::real::Real;
use crate::soil::rolling::WheelLoad;
use crate::soil::shear::{ShearDisplacement, speed_ratio};
use crate::wheel::Wheel;

/// The cylinder that meets the soil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rim {
    /// Radius `r` \[m\].
    pub radius: f64,
    /// Width `b` \[m\].
    pub width: f64,
}

impl From<&Wheel> for Rim {
    fn from(wheel: &Wheel) -> Self {
        Self {
            radius: wheel.radius,
            width: wheel.width,
        }
    }
}

/// `A`, `B`, `C` [-] of Eq. (65).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArcCoefficients<T = f64> {
    /// Part of the peak stress, times `r b`, that stands upright: `∫ tri cos θ dθ`.
    pub a: T,
    /// Part that lies along the track: `∫ tri sin θ dθ`.
    pub b: T,
    /// Mean over the arc, `∫ tri dθ = (θ_1 - θ_2)/2`.
    pub c: T,
}

impl<T: Real> From<ContactAngles<T>> for ArcCoefficients<T> {
    /// Eq. (65), written with `sin x/x` so that `θ_m → θ_1`, `θ_m → θ_2` and `z → 0` need no
    /// special case.
    fn from(ContactAngles { entry, peak, exit }: ContactAngles<T>) -> Self {
        let (rear, front) = ((peak + exit) * 0.5, (entry + peak) * 0.5);
        let (rear_sinc, front_sinc) = (sinc((peak - exit) * 0.5), sinc((entry - peak) * 0.5));
        Self {
            a: front.sin() * front_sinc - rear.sin() * rear_sinc,
            b: rear.cos() * rear_sinc - front.cos() * front_sinc,
            c: (entry - exit) * 0.5,
        }
    }
}

/// `sin x/x`.
fn sinc<T: Real>(x: T) -> T {
    // Below this x, 1 - x²/6 is exact in double precision.
    if x.magnitude() < 1e-4 {
        -(x * x / 6.0) + 1.0
    } else {
        x.sin() / x
    }
}

impl<T: Real> ArcCoefficients<T> {
    /// Pull per load `μ = F_DP/F_N` [-] where the ground neither coheres nor deforms in shear
    /// (Eq. 68); towards `tan φ` as the contact shrinks.
    pub fn pull_per_load(&self, tan_friction_angle: T) -> T {
        (self.a * tan_friction_angle - self.b) / (self.a + self.b * tan_friction_angle)
    }

    /// Torque per pull and radius `λ_c = M_R/(r F_DP)` [-] on such ground (Eq. 69).
    pub fn torque_per_pull(&self, tan_friction_angle: T) -> T {
        self.c * tan_friction_angle / (self.a * tan_friction_angle - self.b)
    }

    /// Drawbar pull \[N\] that goes with a `normal_force` \[N\] and the tangential force at the rim
    /// `M_R/r` \[N\], whatever the soil's strength (Eq. 73).
    pub fn drawbar_pull(&self, normal_force: T, rim_force: T) -> T {
        let Self { a, b, c } = *self;
        (a * a + b * b) / (a * c) * rim_force - b / a * normal_force
    }

    /// Tangential force at the rim `M_R/r` \[N\] that goes with a `normal_force` and a
    /// `drawbar_pull` \[N\], whatever the soil's strength (Eq. 73 solved for it).
    pub fn rim_force(&self, normal_force: T, drawbar_pull: T) -> T {
        let Self { a, b, c } = *self;
        (a * drawbar_pull + b * normal_force) * c / (a * a + b * b)
    }

    /// Normal force \[N\] from the pressure force `r b k_s zᴺ` \[N\] and the tangential force at the
    /// rim `M_R/r` \[N\] (Eq. 74).
    pub fn normal_force(&self, pressure_force: T, rim_force: T) -> T {
        self.a * pressure_force + self.b / self.c * rim_force
    }
}

/// Part of the shear strength mobilised at the peak, `E` [-] (Eq. 66), in [-1, 1].
///
/// The paper leaves `j(θ_m)` open: it is Wong and Reece's with the rim as shear surface. `K = 0`
/// gives `E = 1` driving and -1 braking.
pub fn mobilised<T: Real>(rim: Rim, soil: &Soil<T>, sinkage: T, slip: T) -> T {
    RimContact::new(rim, soil, sinkage, slip).mobilised(soil)
}

/// Loads on a rim at `sinkage` \[m\] and `slip` [-] (Eq. 62-64).
///
/// ```text
/// F_N  = r b (A + B E tan φ) k_s zᴺ + r b c B E
/// F_DP = r b (A E tan φ - B) k_s zᴺ + r b c A E
/// M_R  = r² b C E (c + k_s zᴺ tan φ)
/// ```
pub fn loads<T: Real>(rim: Rim, soil: &Soil<T>, sinkage: T, slip: T) -> WheelLoad<T> {
    RimContact::new(rim, soil, sinkage, slip).loads(soil)
}

/// A rim in the soil, whose angles may be given otherwise than by [`ContactAngles::new`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimContact<T = f64> {
    /// The rim.
    pub rim: Rim,
    /// Its contact with the soil.
    pub angles: ContactAngles<T>,
    /// Sinkage `z` \[m\].
    pub sinkage: T,
    /// Slip ratio `s` [-] by the rim's radius.
    pub slip: T,
}

impl<T: Real> RimContact<T> {
    /// The contact at `sinkage` \[m\] and `slip` [-].
    pub fn new(rim: Rim, soil: &Soil<T>, sinkage: T, slip: T) -> Self {
        Self {
            rim,
            angles: ContactAngles::new(soil, rim.radius, sinkage, slip),
            sinkage,
            slip,
        }
    }

    /// Part of the shear strength mobilised at the peak, `E` [-] (Eq. 66); see [`mobilised`].
    ///
    /// `K = 0` leaves of `j` its direction only, which is that within the contact even where the
    /// peak lies beyond its front.
    pub fn mobilised(&self, soil: &Soil<T>) -> T {
        let ContactAngles { entry, peak, .. } = self.angles;
        let shear = soil.shear();
        let angle = if shear.modulus > 0.0 {
            peak
        } else {
            peak.smaller(entry)
        };
        shear.mobilised(self.displacement().at(angle))
    }

    /// Loads on the rim (Eq. 62-64); see [`loads`].
    pub fn loads(&self, soil: &Soil<T>) -> WheelLoad<T> {
        let Rim { radius, width } = self.rim;
        let normal = self.pressure(soil);
        let shear = soil.shear().strength(normal) * self.mobilised(soil);
        stressed(self.angles.into(), [normal, shear], radius) * T::constant(radius * width)
    }

    /// Pressure `σ_m = k_s zᴺ` \[Pa\] at the peak.
    pub fn pressure(&self, soil: &Soil<T>) -> T {
        let law = soil.pressure_sinkage(self.rim.width, self.slip);
        law.pressure(self.sinkage)
    }

    fn displacement(&self) -> ShearDisplacement<T> {
        let radius = self.rim.radius;
        ShearDisplacement::new(
            T::constant(radius),
            self.angles.entry,
            speed_ratio(self.slip) * radius,
        )
    }
}

/// Loads per `r b` [N/m², the torque N/m] of triangles of normal and shear stress with peaks
/// `[σ_m, τ_m]` [Pa] on a rim of `radius` [m].
fn stressed<T: Real>(
    arc: ArcCoefficients<T>,
    [normal, shear]: [T; 2],
    radius: f64,
) -> WheelLoad<T> {
    let ArcCoefficients { a, b, c } = arc;
    WheelLoad {
        normal_force: a * normal + b * shear,
        drawbar_pull: a * shear - b * normal,
        driving_torque: c * radius * shear,
    }
}

/// Driving torque [N·m] from the normal force \[N\] and the mobilised part `E` [-] (Eq. 75).
pub fn driving_torque<T: Real>(
    rim: Rim,
    soil: &Soil<T>,
    arc: ArcCoefficients<T>,
    [normal_force, mobilised]: [T; 2],
) -> T {
    let Rim { radius, width } = rim;
    let ArcCoefficients { a, b, c } = arc;
    let tan_phi = soil.tan_friction_angle();
    let strength = soil.cohesion * width + normal_force * tan_phi / (a * radius);
    c * (radius * radius) * mobilised * strength / (b * mobilised * tan_phi / a + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::table_6;

    fn rover_rim() -> Rim {
        Rim::from(&Wheel::rover())
    }

    fn arc(soil: &Soil, sinkage: f64, slip: f64) -> ArcCoefficients {
        ContactAngles::new(soil, rover_rim().radius, sinkage, slip).into()
    }

    fn assert_near(value: f64, expected: f64, tolerance: f64) {
        assert!(
            (value - expected).abs() < tolerance,
            "{value}, not {expected}"
        );
    }

    #[test]
    fn the_sand_row_of_table_6_gives_the_check_values_at_6_and_20_mm() {
        // Half a unit of the last digit printed.
        let shallow = loads(rover_rim(), &table_6::sand(), 0.006, 0.2);
        assert_near(shallow.normal_force, 34.04, 0.005);
        assert_near(shallow.drawbar_pull, 8.085, 0.0005);
        assert_near(shallow.driving_torque, 1.8908, 0.00005);
        let deep = loads(rover_rim(), &table_6::sand(), 0.020, 0.2);
        assert_near(deep.normal_force, 238.7, 0.05);
        assert_near(deep.drawbar_pull, 58.93, 0.005);
        assert_near(deep.driving_torque, 17.26, 0.005);
    }

    #[test]
    fn the_hard_row_of_table_6_carries_47_newtons_at_a_hundredth_of_a_millimetre() {
        let soil = table_6::hard();
        let released = loads(rover_rim(), &soil, 1e-5, 0.1);
        assert_near(released.normal_force, 47.07, 0.005);
        // θ_1 = 0.65°: the pull is within 1 % of friction.
        let tan_phi = soil.tan_friction_angle();
        assert_near(released.drawbar_pull / released.normal_force, tan_phi, 0.01);
        let symmetric = Soil {
            exit_angle: -1.0,
            ..soil
        };
        let held = loads(rover_rim(), &symmetric, 1e-5, 0.1);
        assert_near(held.normal_force, 93.90, 0.005);
    }

    #[test]
    fn the_gravel_row_peaks_at_the_exit_and_takes_the_limit_of_equation_65() {
        let soil = table_6::gravel();
        let angles = ContactAngles::new(&soil, 0.155, 1e-5, 0.3);
        assert_eq!(angles.peak, angles.exit);
        let ArcCoefficients { a, b, .. } = angles.into();
        let theta = angles.entry;
        assert_near(a, (1.0 - theta.cos()) / theta, 1e-12);
        assert_near(b, 1.0 - theta.sin() / theta, 1e-12);
        assert!(loads(rover_rim(), &soil, 1e-5, 0.3).normal_force > 0.0);
    }

    #[test]
    fn equation_65_as_printed_is_the_same_away_from_its_limits() {
        let (entry, peak, exit) = (0.5f64, 0.2f64, -0.1f64);
        let arc = ArcCoefficients::from(ContactAngles { entry, peak, exit });
        let a =
            (peak.cos() - exit.cos()) / (peak - exit) + (peak.cos() - entry.cos()) / (entry - peak);
        let b =
            (peak.sin() - exit.sin()) / (peak - exit) + (peak.sin() - entry.sin()) / (entry - peak);
        assert_near(arc.a, a, 1e-14);
        assert_near(arc.b, b, 1e-14);
    }

    #[test]
    fn loads_vanish_with_sinkage_and_are_never_undefined() {
        for soil in [table_6::hard(), table_6::gravel(), table_6::sand()] {
            for slip in [-1.0, 0.0, 1.0] {
                assert_eq!(loads(rover_rim(), &soil, 0.0, slip), WheelLoad::default());
                assert_eq!(loads(rover_rim(), &soil, -0.01, slip), WheelLoad::default());
                let tiny = loads(rover_rim(), &soil, 1e-12, slip);
                assert!(tiny.normal_force.is_finite() && tiny.normal_force > 0.0);
            }
        }
    }

    #[test]
    fn pull_and_torque_ratios_are_those_of_the_loads_on_hard_ground() {
        let soil = table_6::hard();
        let load = loads(rover_rim(), &soil, 1e-5, 0.1);
        let (arc, tan_phi) = (arc(&soil, 1e-5, 0.1), soil.tan_friction_angle());
        let pull = load.drawbar_pull / load.normal_force;
        assert_near(arc.pull_per_load(tan_phi), pull, 1e-12);
        let torque = load.driving_torque / (0.155 * load.drawbar_pull);
        assert_near(arc.torque_per_pull(tan_phi), torque, 1e-10);
    }

    #[test]
    fn the_decoupled_equations_73_to_75_return_the_loads_of_62_to_64() {
        let soil = table_6::sand();
        for (sinkage, slip) in [(0.006, 0.2), (0.015, 0.0), (0.01, 0.6), (0.01, -0.3)] {
            let rim = rover_rim();
            let load = loads(rim, &soil, sinkage, slip);
            let arc = arc(&soil, sinkage, slip);
            let rim_force = load.driving_torque / rim.radius;
            let pressure = soil.pressure_sinkage(rim.width, slip).pressure(sinkage);
            let pressure_force = rim.radius * rim.width * pressure;
            let e = mobilised(rim, &soil, sinkage, slip);
            let pull = arc.drawbar_pull(load.normal_force, rim_force);
            assert_near(pull, load.drawbar_pull, 1e-10);
            let normal = arc.normal_force(pressure_force, rim_force);
            assert_near(normal, load.normal_force, 1e-10);
            let torque = driving_torque(rim, &soil, arc, [load.normal_force, e]);
            assert_near(torque, load.driving_torque, 1e-10);
        }
    }
}
