//! Derivatives of the closed forms by the terrain's parameters, for whoever inverts them.
//!
//! Moduli, cohesion and `K` enter by their logarithms, the friction angle by radians. `θ_m` moves
//! with `c_1` and `c_2` as if it could leave the contact: where it is clamped, the derivative is
//! that towards the inside.

use super::{ArcCoefficients, Rim, RimContact, sinc, stressed};
use crate::soil::Soil;
use crate::soil::contact::ContactAngles;
use crate::soil::wheel_load::WheelLoad;

/// Derivatives of the loads (Eq. 62-64), each in the loads' units per unit of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadGradient {
    /// By `c_1`.
    pub stress_angle: WheelLoad,
    /// By `c_2`.
    pub stress_angle_slip: WheelLoad,
    /// By `ln k_s`.
    pub log_sinkage_modulus: WheelLoad,
    /// By `n_0`.
    pub sinkage_exponent: WheelLoad,
    /// By `n_1`.
    pub sinkage_exponent_slip: WheelLoad,
    /// By `ln c`; 0 where `c` is.
    pub log_cohesion: WheelLoad,
    /// By `φ` [rad].
    pub friction_angle: WheelLoad,
    /// By `ln K`; 0 where `K` is.
    pub log_shear_modulus: WheelLoad,
}

impl RimContact {
    /// Derivatives of [`loads`](Self::loads).
    pub fn load_gradient(&self, soil: &Soil) -> LoadGradient {
        let Rim { radius, width } = self.rim;
        let arc = ArcCoefficients::from(self.angles);
        let [normal, e, tan_phi] = [
            self.pressure(soil),
            self.mobilised(soil),
            soil.tan_friction_angle(),
        ];
        let strength = soil.shear().strength(normal);
        let by_stress = |stress| stressed(arc, stress, radius) * (radius * width);
        let by_pressure = by_stress([normal, normal * tan_phi * e]);
        let by_peak = (stressed(by_peak(self.angles), [normal, strength * e], radius)
            + stressed(arc, [0.0, strength * self.mobilised_by_peak(soil)], radius))
            * (radius * width);
        let log_sinkage = libm::log(self.sinkage);
        LoadGradient {
            stress_angle: by_peak * self.angles.entry,
            stress_angle_slip: by_peak * (self.slip * self.angles.entry),
            log_sinkage_modulus: by_pressure,
            sinkage_exponent: by_pressure * log_sinkage,
            sinkage_exponent_slip: by_pressure * (log_sinkage * self.slip.abs()),
            log_cohesion: by_stress([0.0, soil.cohesion * e]),
            friction_angle: by_stress([0.0, normal * (1.0 + tan_phi * tan_phi) * e]),
            log_shear_modulus: by_stress([0.0, strength * self.mobilised_by_modulus(soil)]),
        }
    }

    /// Derivative of the pull that goes with `[normal force, rim force]` [N] (Eq. 73) by `θ_m`
    /// [N/rad].
    pub fn pull_by_peak(&self, [normal_force, rim_force]: [f64; 2]) -> f64 {
        let ArcCoefficients { a, b, c } = self.angles.into();
        let by = by_peak(self.angles);
        let ratio = b / a;
        let ratio_by = (by.b - ratio * by.a) / a;
        // (a² + b²)/(a c) = a (1 + (b/a)²)/c
        let rim_part = (by.a * (1.0 + ratio * ratio) + 2.0 * a * ratio * ratio_by) / c;
        rim_part * rim_force - ratio_by * normal_force
    }

    /// Derivatives of the torque that goes with a `normal_force` [N] (Eq. 75) by
    /// `[ln c, φ [rad], ln K]` [N·m].
    pub fn torque_gradient(&self, soil: &Soil, normal_force: f64) -> [f64; 3] {
        let Rim { radius, width } = self.rim;
        let ArcCoefficients { a, b, c } = self.angles.into();
        let [e, tan_phi] = [self.mobilised(soil), soil.tan_friction_angle()];
        let ratio = b / a;
        let shared = 1.0 + ratio * e * tan_phi;
        let strength = width * soil.cohesion + normal_force * tan_phi / (radius * a);
        let lever = radius * radius * c;
        let by_tan = lever * e * (normal_force / (radius * a) * shared - strength * ratio * e)
            / (shared * shared);
        let by_mobilised = lever * strength / (shared * shared);
        [
            lever * e * width * soil.cohesion / shared,
            by_tan * (1.0 + tan_phi * tan_phi),
            by_mobilised * self.mobilised_by_modulus(soil),
        ]
    }

    /// `dE/d ln K = -(j/K) exp(-|j|/K)` [-].
    fn mobilised_by_modulus(&self, soil: &Soil) -> f64 {
        if soil.shear_modulus == 0.0 {
            return 0.0;
        }
        let part = self.shear_displacement() / soil.shear_modulus;
        -part * libm::exp(-part.abs())
    }

    /// `dE/dθ_m = exp(-|j|/K)/K · dj/dθ_m` [1/rad], `dj/dθ_m = -r_s + (v/ω) cos θ_m`.
    fn mobilised_by_peak(&self, soil: &Soil) -> f64 {
        if soil.shear_modulus == 0.0 {
            return 0.0;
        }
        let displacement = self.displacement();
        let slope = displacement.travel * libm::cos(self.angles.peak) - displacement.shear_radius;
        let part = self.shear_displacement() / soil.shear_modulus;
        slope * libm::exp(-part.abs()) / soil.shear_modulus
    }
}

/// Derivatives of `A`, `B`, `C` (Eq. 65) by `θ_m` [1/rad].
fn by_peak(ContactAngles { entry, peak, exit }: ContactAngles) -> ArcCoefficients {
    // Each half: ±sin(m) sinc(h), ∓cos(m) sinc(h) with m the middle and h half the width of the
    // rear (peak + exit, peak - exit) and the front (entry + peak, entry - peak).
    let half = |middle: f64, width: f64, side: f64| {
        let (sin, cos) = (libm::sin(middle), libm::cos(middle));
        let (value, slope) = (sinc(width), sinc_slope(width));
        [
            0.5 * (cos * value - side * sin * slope),
            0.5 * (sin * value + side * cos * slope),
        ]
    };
    let front = half(0.5 * (entry + peak), 0.5 * (entry - peak), 1.0);
    let rear = half(0.5 * (peak + exit), 0.5 * (peak - exit), -1.0);
    ArcCoefficients {
        a: front[0] - rear[0],
        b: front[1] - rear[1],
        c: 0.0,
    }
}

/// Derivative of `sin x/x`.
fn sinc_slope(x: f64) -> f64 {
    // Below this x the next term of the series is under 1e-11 of the first, and so is the error
    // that cancellation leaves above it.
    if x.abs() < 3e-3 {
        let square = x * x;
        -x / 3.0 * (1.0 - square / 10.0 + square * square / 280.0)
    } else {
        (libm::cos(x) - libm::sin(x) / x) / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soil::closed_form::driving_torque;
    use crate::soil::table_6;
    use crate::wheel::Wheel;

    /// Contacts well inside the soil and its limits: no clamp, `j` of one sign.
    fn contacts() -> impl Iterator<Item = (Soil, [f64; 2])> {
        let points = [
            [0.006, 0.2],
            [0.03, 0.5],
            [0.02, 0.05],
            [0.01, -0.3],
            [1e-5, 0.3],
        ];
        let soils = [table_6::sand(), table_6::gravel(), table_6::hard()];
        soils.into_iter().flat_map(move |soil| {
            let soil = Soil {
                exit_angle: -0.1,
                ..soil
            };
            points.map(|point| (soil, point))
        })
    }

    fn contact(soil: &Soil, [sinkage, slip]: [f64; 2]) -> RimContact {
        RimContact::new(Rim::from(&Wheel::rover()), soil, sinkage, slip)
    }

    /// Central difference of `f` over soils whose parameter is moved by `step` times -1 and 1.
    fn difference(f: impl Fn(f64) -> f64) -> f64 {
        // Rounding over step and third derivative times step² balance near 1e-5.
        (f(1e-5) - f(-1e-5)) / 2e-5
    }

    /// 1e-7 of the load that the derivative belongs to.
    fn assert_same(derivative: f64, difference: f64, load: f64, what: &str) {
        let error = (derivative - difference).abs() / load.abs().max(derivative.abs());
        assert!(error < 1e-7, "{what}: {derivative}, not {difference}");
    }

    type Moved = fn(Soil, f64) -> Soil;
    type Slope = fn(&LoadGradient) -> WheelLoad;

    #[test]
    fn the_gradient_of_the_loads_is_their_difference_quotient() {
        let moved: [(&str, Moved, Slope); 8] = [
            (
                "c1",
                |s, d| Soil {
                    stress_angle: s.stress_angle + d,
                    ..s
                },
                |g| g.stress_angle,
            ),
            (
                "c2",
                |s, d| Soil {
                    stress_angle_slip: s.stress_angle_slip + d,
                    ..s
                },
                |g| g.stress_angle_slip,
            ),
            (
                "k_s",
                |s, d| Soil {
                    frictional_modulus: s.frictional_modulus * d.exp(),
                    ..s
                },
                |g| g.log_sinkage_modulus,
            ),
            (
                "n0",
                |s, d| Soil {
                    sinkage_exponent: s.sinkage_exponent + d,
                    ..s
                },
                |g| g.sinkage_exponent,
            ),
            (
                "n1",
                |s, d| Soil {
                    sinkage_exponent_slip: s.sinkage_exponent_slip + d,
                    ..s
                },
                |g| g.sinkage_exponent_slip,
            ),
            (
                "c",
                |s, d| Soil {
                    cohesion: s.cohesion * d.exp(),
                    ..s
                },
                |g| g.log_cohesion,
            ),
            (
                "phi",
                |s, d| Soil {
                    friction_angle_deg: s.friction_angle_deg + d.to_degrees(),
                    ..s
                },
                |g| g.friction_angle,
            ),
            (
                "K",
                |s, d| Soil {
                    shear_modulus: s.shear_modulus * d.exp(),
                    ..s
                },
                |g| g.log_shear_modulus,
            ),
        ];
        for (soil, point) in contacts() {
            let here = contact(&soil, point);
            let (load, gradient) = (here.loads(&soil), here.load_gradient(&soil));
            for (name, moved, derivative) in moved {
                let at = |d| {
                    let soil = moved(soil, d);
                    contact(&soil, point).loads(&soil)
                };
                let derivative = derivative(&gradient);
                let what = format!("{name} at {point:?}");
                let normal = difference(|d| at(d).normal_force);
                assert_same(derivative.normal_force, normal, load.normal_force, &what);
                let pull = difference(|d| at(d).drawbar_pull);
                assert_same(derivative.drawbar_pull, pull, load.normal_force, &what);
                let torque = difference(|d| at(d).driving_torque);
                assert_same(
                    derivative.driving_torque,
                    torque,
                    load.driving_torque,
                    &what,
                );
            }
        }
    }

    #[test]
    fn the_gradients_of_equations_73_and_75_are_their_difference_quotients() {
        for (soil, point) in contacts() {
            let here = contact(&soil, point);
            let load = here.loads(&soil);
            let rim_force = load.driving_torque / here.rim.radius;
            let pull = difference(|d| {
                let ContactAngles { entry, peak, exit } = here.angles;
                let peak = peak + d * entry;
                let arc = ArcCoefficients::from(ContactAngles { entry, peak, exit });
                arc.drawbar_pull(load.normal_force, rim_force)
            });
            let by_peak = here.pull_by_peak([load.normal_force, rim_force]) * here.angles.entry;
            assert_same(by_peak, pull, load.normal_force, "Eq. 73 by the peak");
            let torque = |soil: Soil| {
                let given = [load.normal_force, here.mobilised(&soil)];
                driving_torque(here.rim, &soil, here.angles.into(), given)
            };
            let by = here.torque_gradient(&soil, load.normal_force);
            let moved: [Moved; 3] = [
                |s, d| Soil {
                    cohesion: s.cohesion * d.exp(),
                    ..s
                },
                |s, d| Soil {
                    friction_angle_deg: s.friction_angle_deg + d.to_degrees(),
                    ..s
                },
                |s, d| Soil {
                    shear_modulus: s.shear_modulus * d.exp(),
                    ..s
                },
            ];
            for (derivative, moved) in by.into_iter().zip(moved) {
                let expected = difference(|d| torque(moved(soil, d)));
                assert_same(derivative, expected, load.driving_torque, "Eq. 75");
            }
        }
    }

    #[test]
    fn the_slope_of_sinc_joins_its_series_without_a_step() {
        let [below, above] = [2.999_999e-3, 3.000_001e-3].map(|x| sinc_slope(x) / x);
        assert!((below - above).abs() < 1e-9, "{below}, {above}");
    }
}
