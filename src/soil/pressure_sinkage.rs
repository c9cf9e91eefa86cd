//! Normal pressure against sinkage: Bekker's power law on loading, a stiff line on unloading.

use crate::soil::Soil;
use crate::soil::hard_base::HardBase;
use crate::soil::power::power;
use crate::soil::real::Real;

/// `p = k_s zᴺ` of one soil under one width at one slip, and what the soil has beyond that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureSinkage<T = f64> {
    /// Sinkage modulus `k_s` [N·m⁻⁽ᴺ⁺²⁾].
    pub modulus: T,
    /// Sinkage exponent `N` [-].
    pub exponent: T,
    /// Stiffness on unloading and reloading [Pa/m].
    pub unloading_stiffness: f64,
    /// Depth \[m\] by which the soil was pressed before; 0 on fresh soil.
    pub precompression: f64,
    /// Sinkage \[m\] over which soil pressed before takes its former pressure up again.
    pub rebound: T,
    /// The hard base below it, if any.
    pub base: HardBase,
}

impl<T: Real> Soil<T> {
    /// The pressure-sinkage law under a wheel or plate of `width` \[m\] at `slip` [-].
    pub fn pressure_sinkage(&self, width: f64, slip: T) -> PressureSinkage<T> {
        let departures = &self.departures;
        let exponent = self.exponent(slip);
        let fresh = PressureSinkage {
            modulus: self.sinkage_modulus(width) * departures.modulus_factor()
                / departures.depth_factor(slip).pow(exponent),
            exponent,
            unloading_stiffness: self.unloading_stiffness,
            precompression: 0.0,
            rebound: T::constant(0.0),
            base: departures.hard_base(),
        };
        let precompression = departures.precompression;
        PressureSinkage {
            precompression,
            rebound: fresh.pressure(T::constant(precompression)) / self.unloading_stiffness,
            ..fresh
        }
    }
}

impl<T: Real> PressureSinkage<T> {
    /// Normal pressure \[Pa\] at `sinkage` \[m\], the soil being loaded for the first time.
    ///
    /// ```text
    /// p(z) = k_s · zᴺ
    /// ```
    ///
    /// A surface above the soil carries no pressure. Soil pressed by `z_p` before resists as it
    /// did then, `p = k_s (z + z_p)ᴺ`, once it has been pressed by what it had sprung back since;
    /// a hard base makes the depth felt deeper ([`crate::soil::hard_base`]).
    ///
    /// # Reference
    /// Bekker (1969), *Introduction to Terrain-Vehicle Systems*; Wong (2008), *Theory of Ground
    /// Vehicles*, 4th ed., on repetitive loading.
    pub fn pressure(&self, sinkage: T) -> T {
        self.pressure_of(sinkage, sinkage)
    }

    /// Normal pressure \[Pa\] of soil pressed to `depth` \[m\], of which `counted` \[m\] stand for the
    /// stress there ([`crate::soil::contact::EffectiveDepth`]).
    pub fn pressure_of(&self, counted: T, depth: T) -> T {
        if counted <= 0.0 {
            return T::constant(0.0);
        }
        self.modulus * self.felt(counted, depth).pow(self.exponent)
    }

    /// Whether the soil is deep and fresh, so that all that counts is the depth that counts.
    pub fn is_ideal(&self) -> bool {
        self.precompression == 0.0 && self.base == HardBase::default()
    }

    /// Depth [m] of deep and fresh soil that resists as this soil does.
    fn felt(&self, counted: T, depth: T) -> T {
        if self.is_ideal() {
            return counted;
        }
        let former = self.taken_up(depth) * self.precompression;
        (counted + former) * self.base.stretch(depth)
    }

    /// Share [-] of the former pressure that soil pressed to `depth` [m] has taken up again.
    fn taken_up(&self, depth: T) -> T {
        if depth >= self.rebound {
            T::constant(1.0)
        } else {
            depth / self.rebound
        }
    }
}

impl PressureSinkage {
    /// The law of soil that answers `factor` [-] times as hard, as at another penetration rate.
    pub fn at_rate(self, factor: f64) -> Self {
        Self {
            modulus: self.modulus * factor,
            ..self
        }
    }

    /// The same within 1e-12 of it, several times faster: for a motion, which takes a pressure for every millimetre of
    /// contact, and not for derivatives by differences.
    pub(crate) fn pressure_of_column(&self, counted: f64, depth: f64) -> f64 {
        if counted <= 0.0 {
            return 0.0;
        }
        self.modulus * power(self.felt(counted, depth), self.exponent)
    }

    /// Slope `dp/dz = N p/z` [Pa/m] of the loading curve at `sinkage` \[m\], 0 above the soil.
    ///
    /// On soil pressed before or over a base: that times [`PressureSinkage::growth`].
    pub fn stiffness(&self, sinkage: f64) -> f64 {
        if sinkage <= 0.0 {
            return 0.0;
        }
        self.exponent * self.pressure(sinkage) / sinkage * self.growth(sinkage, sinkage)
    }

    /// Growth of the depth felt over that of `counted`, each by its own size [-], at `depth` \[m\]:
    /// `(dζ/ζ)/(dz/z)`, 1 on deep and fresh soil.
    pub fn growth(&self, counted: f64, depth: f64) -> f64 {
        let taken_up = self.taken_up(depth);
        let rise = if taken_up < 1.0 {
            self.precompression / self.rebound
        } else {
            0.0
        };
        let former = self.precompression * taken_up;
        counted * (1.0 + rise) / (counted + former) + self.base.steepening(depth) - 1.0
    }

    /// Stiffness [Pa/m] on unloading and reloading of soil pressed to `depth` \[m\]: a base below
    /// stiffens it as it does the loading curve.
    pub fn unloading_at(&self, depth: f64) -> f64 {
        self.unloading_stiffness * self.base.stretch(depth) * self.base.steepening(depth)
    }

    /// Sinkage \[m\] at which the loading curve of deep and fresh soil reaches `pressure` \[Pa\].
    pub fn sinkage(&self, pressure: f64) -> f64 {
        if pressure <= 0.0 {
            return 0.0;
        }
        libm::pow(pressure / self.modulus, 1.0 / self.exponent)
    }

    /// Normal pressure \[Pa\] at `sinkage` \[m\] of soil that was pressed down to `deepest` \[m\] before.
    ///
    /// ```text
    /// p(z) = max(0, p(z_d) - k_u (z_d - z))   for z < z_d
    /// ```
    ///
    /// The loading curve beyond `deepest`. Where the stiffness given is softer than the loading
    /// curve at `z_d`, `max(1, N) p(z_d)/z_d` takes its place: no cycle then returns more work
    /// than it took.
    ///
    /// # Reference
    /// Wong (2008), *Theory of Ground Vehicles*, 4th ed., on repetitive loading.
    pub fn reloading_pressure(&self, sinkage: f64, deepest: f64) -> f64 {
        if sinkage >= deepest {
            return self.pressure(sinkage);
        }
        let peak = self.pressure(deepest);
        if peak == 0.0 {
            return 0.0;
        }
        let steepest_loading =
            self.exponent.max(1.0) * peak / deepest * self.growth(deepest, deepest);
        let stiffness = self.unloading_at(deepest).max(steepest_loading);
        (peak - stiffness * (deepest - sinkage)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(exponent: f64, unloading_stiffness: f64) -> PressureSinkage {
        PressureSinkage {
            modulus: 2.0e6,
            exponent,
            unloading_stiffness,
            precompression: 0.0,
            rebound: 0.0,
            base: HardBase::default(),
        }
    }

    #[test]
    fn doubling_the_sinkage_multiplies_pressure_by_two_to_the_exponent() {
        for n in [0.5, 0.8169, 1.0, 1.5] {
            let ratio = law(n, 1e8).pressure(0.02) / law(n, 1e8).pressure(0.01);
            assert!((ratio - 2f64.powf(n)).abs() < 1e-12);
        }
        assert_eq!(law(0.8, 1e8).pressure(-0.001), 0.0);
    }

    #[test]
    fn stiffness_is_the_derivative_and_sinkage_the_inverse_of_pressure() {
        for n in [0.5, 1.0, 1.5] {
            let law = law(n, 1e8);
            let (z, h) = (0.012, 1e-7);
            // A central difference of step h errs by h²·p'''/6, some 1e-10 of the slope here.
            let slope = (law.pressure(z + h) - law.pressure(z - h)) / (2.0 * h);
            assert!((slope / law.stiffness(z) - 1.0).abs() < 1e-8);
            assert!((law.sinkage(law.pressure(z)) / z - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn reloading_meets_the_loading_curve_at_the_deepest_point_and_continues_it() {
        let law = law(1.1, 1e8);
        assert_eq!(law.reloading_pressure(0.01, 0.01), law.pressure(0.01));
        assert_eq!(law.reloading_pressure(0.02, 0.01), law.pressure(0.02));
        let step = law.pressure(0.01) - law.reloading_pressure(0.01 - 1e-6, 0.01);
        assert!(
            (step - 100.0).abs() < 1e-6,
            "1e8 Pa/m over 1e-6 m, got {step}"
        );
        assert_eq!(law.reloading_pressure(0.0, 0.01), 0.0);
    }

    #[test]
    fn soil_pressed_before_has_its_former_pressure_back_after_what_it_sprung_back() {
        let law = law(1.1, 1e8);
        let former = 0.004;
        let rebound = law.pressure(former) / law.unloading_stiffness;
        let pressed = PressureSinkage {
            precompression: former,
            rebound,
            ..law
        };
        let taken_up = pressed.pressure(rebound) / law.pressure(former + rebound);
        assert!((taken_up - 1.0).abs() < 1e-12);
        assert!((pressed.pressure(0.01) / law.pressure(0.014) - 1.0).abs() < 1e-12);
        // Half of the way, near half of the pressure: the line bends as z^1.1.
        let half = pressed.pressure(0.5 * rebound) / pressed.pressure(rebound);
        assert!((half - 0.5f64.powf(1.1)).abs() < 1e-3, "{half}");
    }

    #[test]
    fn stiffness_is_the_derivative_over_a_base_and_on_soil_pressed_before() {
        let law = PressureSinkage {
            precompression: 0.004,
            rebound: 1.0e-4,
            base: HardBase {
                nearness: 40.0,
                sudden: 20.0,
            },
            ..law(0.9, 1e8)
        };
        for z in [5e-5, 0.002, 0.012] {
            let h = 1e-8;
            let slope = (law.pressure(z + h) - law.pressure(z - h)) / (2.0 * h);
            // Rounding of the difference: some 1e-8 of it.
            assert!((slope / law.stiffness(z) - 1.0).abs() < 1e-6, "{z}");
        }
    }

    #[test]
    fn no_unloading_line_lies_above_the_loading_curve_however_soft_it_was_asked() {
        for n in [0.5, 0.8, 1.0, 1.5] {
            let law = law(n, 1.0);
            for z in [0.0, 0.001, 0.005, 0.0099] {
                assert!(law.reloading_pressure(z, 0.01) <= law.pressure(z) * (1.0 + 1e-12));
            }
        }
    }
}
