//! Zero of the wheel angle and lag between the loggers, estimated from the lug strikes.
//!
//! A window with pulses synchronous with the lugs has an offset
//!
//! ```text
//! o = θ_0 + ω τ      modulo the lug angle α
//! ```
//!
//! with `θ_0` the reading where a lug points straight down, `ω` the wheel speed and `τ` the delay of the
//! acceleration relative to the angle. Windows of one speed identify only `o`; several speeds separate the
//! two by weighted linear regression.

use crate::features::pulses::Pulses;
use crate::features::rhythm::Rhythm;
use serde::Serialize;

/// The offset of one window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LugOffset {
    /// Wheel angle where a lug points straight down, its lag included \[rad\]; within half a lug angle
    /// of 0.
    pub offset_rad: f64,
    /// Standard error \[rad\].
    pub error_rad: f64,
    /// Mean wheel speed [rad/s].
    pub wheel_speed_rad_s: f64,
    /// Lug angle \[rad\], by which it repeats.
    pub lug_angle_rad: f64,
}

/// The zero of the wheel angle of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Alignment {
    /// Wheel angle where a lug points straight down \[rad\]; the lag's share included where
    /// `lag_s` is not known.
    pub zero_rad: f64,
    /// Its 95 % interval \[rad\].
    pub zero_ci95: [f64; 2],
    /// How late the acceleration is logged against the angle \[s\]; `None` at one speed.
    pub lag_s: Option<f64>,
    /// Its 95 % interval \[s\].
    pub lag_ci95: Option<[f64; 2]>,
    /// Windows it is from.
    pub windows: usize,
}

/// Greatest standard error of `ω τ` over the lug angle [-] at which the lag is separated from the zero.
const PARTED: f64 = 0.1;
/// Two-sided 95 % quantile of the normal distribution.
const Z: f64 = 1.96;

impl LugOffset {
    pub(super) fn of(rhythm: &Rhythm, pulses: &Pulses) -> Self {
        Self {
            offset_rad: rhythm.offset,
            error_rad: rhythm.offset_error,
            wheel_speed_rad_s: pulses.wheel_speed,
            lug_angle_rad: pulses.lug_angle(),
        }
    }
}

impl Alignment {
    /// Estimate from the windows of a run; `None` where no window has synchronous pulses.
    pub fn of(offsets: &[LugOffset]) -> Option<Self> {
        let first = offsets.first()?;
        let period = first.lug_angle_rad;
        // The offset nearest to the first one: they repeat by the lug angle.
        let near = |offset: f64| offset - period * ((offset - first.offset_rad) / period).round();
        let sum = |f: &dyn Fn(&LugOffset) -> f64| {
            let weighted = offsets.iter().map(|o| f(o) / (o.error_rad * o.error_rad));
            weighted.sum::<f64>()
        };
        let weight = sum(&|_| 1.0);
        let speed = sum(&|o| o.wheel_speed_rad_s) / weight;
        let offset = sum(&|o| near(o.offset_rad)) / weight;
        let spread = sum(&|o| (o.wheel_speed_rad_s - speed).powi(2));
        let lag_error = 1.0 / libm::sqrt(spread);
        let interval = |value: f64, error: f64| [value - Z * error, value + Z * error];
        let parted = lag_error * speed.abs() < PARTED * period;
        let product = sum(&|o| (o.wheel_speed_rad_s - speed) * (near(o.offset_rad) - offset));
        let lag = parted.then(|| product / spread);
        let zero = offset - lag.unwrap_or(0.0) * speed;
        let zero = zero - period * (zero / period).round();
        let lag_share = if parted { lag_error * speed } else { 0.0 };
        let zero_error = libm::sqrt(1.0 / weight + lag_share * lag_share);
        Some(Self {
            zero_rad: zero,
            zero_ci95: interval(zero, zero_error),
            lag_s: lag,
            lag_ci95: lag.map(|lag| interval(lag, lag_error)),
            windows: offsets.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offset(offset_rad: f64, wheel_speed_rad_s: f64) -> LugOffset {
        LugOffset {
            offset_rad,
            error_rad: 0.002,
            wheel_speed_rad_s,
            lug_angle_rad: 0.224,
        }
    }

    #[test]
    fn several_speeds_part_the_zero_from_the_lag() {
        let wrapped = |o: f64| o - 0.224 * (o / 0.224).round();
        let offsets = [0.08, 0.16, 0.24].map(|speed| offset(wrapped(0.09 + 0.3 * speed), speed));
        let found = Alignment::of(&offsets).unwrap();
        assert!((found.zero_rad - 0.09).abs() < 1e-9, "{found:?}");
        assert!((found.lag_s.unwrap() - 0.3).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn one_speed_gives_their_sum_and_no_lag() {
        let found = Alignment::of(&[offset(0.05, 0.1), offset(0.05, 0.1)]).unwrap();
        assert_eq!((found.lag_s, found.windows), (None, 2));
        assert!((found.zero_rad - 0.05).abs() < 1e-9);
        assert_eq!(Alignment::of(&[]), None);
    }
}
