//! Soil laws that a user brings in place of Bekker's and of Janosi and Hanamoto's.

use std::fmt::Debug;

/// Step of a derivative by central differences, as a part of the sinkage [-].
const STEP: f64 = 1.0e-4;

/// How a soil bears and shears: what a [`Soil`](super::Soil) says of pressure over sinkage and of mobilised strength,
/// stated otherwise.
///
/// Rim, lug edges and stones bear by it ([`Terrain::with_soil_law`](crate::terrain::Terrain::with_soil_law)). All else
/// remains the scenario's soil: Mohr-Coulomb strength, stress angles, unloading stiffness, damping, and the passive
/// pressure on lug faces and before the wheel. Departures that act on the pressure (rate, former pressing, hard base) do
/// not act on a law.
pub trait SoilLaw: Debug + Send + Sync {
    /// Normal pressure \[Pa\] on soil pressed for the first time to `sinkage` \[m\], above 0, by a wheel or plate of
    /// `width` \[m\] at `slip` [-]; from 0 on it grows with sinkage.
    fn pressure(&self, sinkage: f64, width: f64, slip: f64) -> f64;

    /// Part [-] of the Mohr-Coulomb strength that a shear `displacement` \[m\] mobilises, odd in it.
    fn mobilised(&self, displacement: f64) -> f64;

    /// Slope `dp/dz` [Pa/m] of the pressure; by central differences unless stated.
    fn stiffness(&self, sinkage: f64, width: f64, slip: f64) -> f64 {
        let [low, high] = [1.0 - STEP, 1.0 + STEP].map(|part| part * sinkage);
        (self.pressure(high, width, slip) - self.pressure(low, width, slip)) / (high - low)
    }
}
