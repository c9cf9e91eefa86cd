//! Steady rolling of a wheel, and the loads of the soil on it.

use crate::soil::real::Real;
use crate::soil::shear::speed_ratio;
use std::ops::{Add, Mul};

/// Loads of the soil on a wheel in steady rolling.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelLoad<T = f64> {
    /// Normal force `F_N` \[N\], upward.
    pub normal_force: T,
    /// Drawbar pull `F_DP` \[N\], above 0 where the soil pulls the wheel forward.
    pub drawbar_pull: T,
    /// Torque `M_R` [N·m] about the axle, above 0 where the motor drives forward against the soil.
    pub driving_torque: T,
}

impl<T: Real> WheelLoad<T> {
    /// No loads.
    pub(super) fn none() -> Self {
        let zero = T::constant(0.0);
        Self {
            normal_force: zero,
            drawbar_pull: zero,
            driving_torque: zero,
        }
    }
}

impl<T: Real> Add for WheelLoad<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            normal_force: self.normal_force + other.normal_force,
            drawbar_pull: self.drawbar_pull + other.drawbar_pull,
            driving_torque: self.driving_torque + other.driving_torque,
        }
    }
}

impl<T: Real> Mul<T> for WheelLoad<T> {
    type Output = Self;
    fn mul(self, part: T) -> Self {
        Self {
            normal_force: self.normal_force * part,
            drawbar_pull: self.drawbar_pull * part,
            driving_torque: self.driving_torque * part,
        }
    }
}

/// Steady rolling: slip and travel of the axle, both by the rim's radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rolling<T = f64> {
    /// Slip ratio `s` [-] of the rim.
    pub slip: T,
    /// Travel of the axle per angle turned `v/ω` \[m\].
    pub travel: T,
}

impl<T: Real> Rolling<T> {
    /// A rim of `radius` \[m\] that rolls with `slip` [-].
    pub fn new(radius: f64, slip: T) -> Self {
        Self {
            slip,
            travel: speed_ratio(slip) * radius,
        }
    }
}

impl Rolling {
    /// The same motion as a slip ratio [-] by another `radius` \[m\], for example the lugs' edges'
    /// or the shear surface's.
    pub fn slip_at(&self, radius: f64) -> f64 {
        let ratio = self.travel / radius;
        if ratio <= 1.0 {
            1.0 - ratio
        } else {
            1.0 / ratio - 1.0
        }
    }
}
