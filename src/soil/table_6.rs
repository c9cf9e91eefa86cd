//! The terrains of Table 6, which the paper identified under its rover's lugged wheels.
//!
//! Rim geometry and triangular stress; they hold what the lugs do. What the table does not list is
//! that of a dry sand, `c_3` is 0.

use super::departures::Departures;
use super::{Soil, StressConvention};

/// T1, hard terrain (HT).
pub fn hard() -> Soil {
    Soil {
        frictional_modulus: 3.9999e8,
        sinkage_exponent: 0.6104,
        sinkage_exponent_slip: 0.0,
        cohesion: 0.0,
        friction_angle_deg: 33.34,
        shear_modulus: 0.0,
        stress_angle: 0.8069,
        stress_angle_slip: 0.0,
        ..sand()
    }
}

/// T2, gravel terrain (GT).
pub fn gravel() -> Soil {
    Soil {
        frictional_modulus: 4.0053e8,
        sinkage_exponent: 0.5680,
        sinkage_exponent_slip: 0.054,
        cohesion: 0.0,
        friction_angle_deg: 32.17,
        shear_modulus: 0.0006,
        stress_angle: 0.0,
        stress_angle_slip: 0.0,
        ..sand()
    }
}

/// T3, sandy terrain (ST): `c` in Pa, where kPa is printed (corrected).
pub fn sand() -> Soil {
    Soil {
        convention: StressConvention::Triangular,
        cohesive_modulus: 0.0,
        frictional_modulus: 2.4904e6,
        sinkage_exponent: 0.8169,
        sinkage_exponent_slip: 1.296,
        cohesion: 308.6,
        friction_angle_deg: 29.67,
        shear_modulus: 0.0066,
        stress_angle: 0.4424,
        stress_angle_slip: -0.6379,
        exit_angle: 0.0,
        unloading_stiffness: 2.0e8,
        damping: 0.0,
        bulk_density: 1600.0,
        repose_angle_deg: 30.0,
        departures: Departures::NONE,
    }
}
