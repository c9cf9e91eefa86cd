//! Normal pressure against sinkage: Bekker's power law on loading, a stiff line on unloading.

use crate::soil::Soil;

/// `p = k_s zᴺ` of one soil under one width at one slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureSinkage {
    /// Sinkage modulus `k_s` [N·m⁻⁽ᴺ⁺²⁾].
    pub modulus: f64,
    /// Sinkage exponent `N` [-].
    pub exponent: f64,
    /// Stiffness on unloading and reloading [Pa/m].
    pub unloading_stiffness: f64,
}

impl Soil {
    /// The pressure-sinkage law under a wheel or plate of `width` [m] at `slip` [-].
    pub fn pressure_sinkage(&self, width: f64, slip: f64) -> PressureSinkage {
        PressureSinkage {
            modulus: self.sinkage_modulus(width),
            exponent: self.exponent(slip),
            unloading_stiffness: self.unloading_stiffness,
        }
    }
}

impl PressureSinkage {
    /// Normal pressure [Pa] at `sinkage` [m], the soil being loaded for the first time.
    ///
    /// ```text
    /// p(z) = k_s · zᴺ
    /// ```
    ///
    /// A surface above the soil carries no pressure.
    ///
    /// # Reference
    /// Bekker (1969), *Introduction to Terrain-Vehicle Systems*.
    pub fn pressure(&self, sinkage: f64) -> f64 {
        if sinkage <= 0.0 {
            return 0.0;
        }
        self.modulus * libm::pow(sinkage, self.exponent)
    }

    /// Slope `dp/dz = N p/z` [Pa/m] of the loading curve at `sinkage` [m], 0 above the soil.
    pub fn stiffness(&self, sinkage: f64) -> f64 {
        if sinkage <= 0.0 {
            return 0.0;
        }
        self.exponent * self.pressure(sinkage) / sinkage
    }

    /// Sinkage [m] at which the loading curve reaches `pressure` [Pa].
    pub fn sinkage(&self, pressure: f64) -> f64 {
        if pressure <= 0.0 {
            return 0.0;
        }
        libm::pow(pressure / self.modulus, 1.0 / self.exponent)
    }

    /// Normal pressure [Pa] at `sinkage` [m] of soil that was pressed down to `deepest` [m] before.
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
        let steepest_loading = self.exponent.max(1.0) * peak / deepest;
        let stiffness = self.unloading_stiffness.max(steepest_loading);
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
    fn no_unloading_line_lies_above_the_loading_curve_however_soft_it_was_asked() {
        for n in [0.5, 0.8, 1.0, 1.5] {
            let law = law(n, 1.0);
            for z in [0.0, 0.001, 0.005, 0.0099] {
                assert!(law.reloading_pressure(z, 0.01) <= law.pressure(z) * (1.0 + 1e-12));
            }
        }
    }
}
