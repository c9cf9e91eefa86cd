//! temporary
use super::{Soil, StressConvention};
use crate::wheel::Wheel;
use libm::{cos, pow, tan};

/// Where the wheel meets the soil and where the stress peaks.
#[derive(Debug, Clone, Copy)]
pub struct ContactArc {
    pub entry_angle: f64,
    pub stress_angle: f64,
    pub exit_angle: f64,
    convention: StressConvention,
    coefficients: [f64; 2],
    cos_entry: f64,
}

impl ContactArc {
    pub fn new(soil: &Soil, entry_angle: f64, slip: f64) -> Self {
        let peak = (soil.stress_angle + soil.stress_angle_slip * slip).clamp(soil.exit_angle, 0.99);
        Self::build(soil.convention, [peak, soil.exit_angle], entry_angle)
    }
    fn build(convention: StressConvention, coefficients: [f64; 2], entry_angle: f64) -> Self {
        Self {
            entry_angle,
            stress_angle: coefficients[0] * entry_angle,
            exit_angle: coefficients[1] * entry_angle,
            convention,
            coefficients,
            cos_entry: cos(entry_angle),
        }
    }
    /// Between a wheel at rest (0), which presses alike ahead and behind, and a rolling one (1).
    pub fn developed(&self, share: f64) -> Self {
        let [peak, exit] = self.coefficients;
        Self::build(self.convention, [share * peak, share * exit - (1.0 - share)], self.entry_angle)
    }
    pub fn with_entry(&self, entry_angle: f64) -> Self {
        Self::build(self.convention, self.coefficients, entry_angle)
    }
    pub fn is_triangular(&self) -> bool {
        self.convention == StressConvention::Triangular
    }
    pub fn triangle(&self, angle: f64) -> f64 {
        if angle >= self.stress_angle {
            ((self.entry_angle - angle) / (self.entry_angle - self.stress_angle)).clamp(0.0, 1.0)
        } else {
            ((angle - self.exit_angle) / (self.stress_angle - self.exit_angle)).clamp(0.0, 1.0)
        }
    }
    pub fn depth_ratio(&self, angle: f64, exponent: f64) -> f64 {
        let own = cos(angle) - self.cos_entry;
        match self.convention {
            _ if angle <= self.exit_angle => 0.0,
            _ if own <= 0.0 => 1.0,
            StressConvention::WongReece if angle >= self.stress_angle => 1.0,
            StressConvention::WongReece => {
                let share = (angle - self.exit_angle) / (self.stress_angle - self.exit_angle);
                (cos(self.entry_angle - share * (self.entry_angle - self.stress_angle)) - self.cos_entry) / own
            }
            StressConvention::Triangular => {
                (1.0 - self.cos_entry) * pow(self.triangle(angle), 1.0 / exponent) / own
            }
        }
    }
}

pub fn shear_radius(wheel: &Wheel, soil: &Soil) -> f64 {
    let Some(lugs) = wheel.lugs else { return wheel.radius };
    let wedge = lugs.height / tan(std::f64::consts::FRAC_PI_4 - 0.5 * soil.friction_angle_deg.to_radians());
    let pitch = std::f64::consts::TAU * wheel.radius / f64::from(lugs.count);
    let share = if wedge <= pitch { 0.5 * wedge / pitch } else { 1.0 - 0.5 * pitch / wedge };
    wheel.radius + share * lugs.height
}
