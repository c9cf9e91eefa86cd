//! The few typed numbers whose mix-up would be silent, and one error for every range.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Standard gravity [m/s²].
pub const GRAVITY: f64 = 9.80665;

/// The whole number nearest to `x`, halves to even, for `|x|` below 2^51; unlike `round` it is no call and stays in vector
/// registers.
#[inline]
pub(crate) fn nearest_whole(x: f64) -> f64 {
    /// A sum with it has no room for a fraction.
    const NO_FRACTION: f64 = 1.5 * (1_u64 << 52) as f64;
    (x + NO_FRACTION) - NO_FRACTION
}

/// Bytes in hexadecimal digits, two each.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A number outside the range in which its quantity has a meaning.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{quantity} [{unit}] must {}, got {value}", self.rule())]
pub struct RangeError {
    /// What the number is, in the field's words.
    pub quantity: &'static str,
    /// Its unit; `-` where it has none.
    pub unit: &'static str,
    /// The range allowed, and a way out where there is one: `in [0, 1]`, `above 0 and finite`,
    /// or `divide ...` for a number that has to divide another.
    pub range: String,
    /// The number given.
    pub value: f64,
}

impl RangeError {
    fn rule(&self) -> String {
        let verb = if self.range.starts_with("divide ") {
            ""
        } else {
            "be "
        };
        format!("{verb}{}", self.range)
    }

    /// Passes `value` on when it lies in `[low, high]`.
    ///
    /// # Errors
    /// `RangeError` when it does not, or is not a number.
    pub fn check(
        quantity: &'static str,
        unit: &'static str,
        value: f64,
        [low, high]: [f64; 2],
    ) -> Result<f64, Self> {
        if value >= low && value <= high {
            return Ok(value);
        }
        let range = match (low == f64::NEG_INFINITY, high == f64::INFINITY) {
            _ if [low, high] == [f64::MIN, f64::MAX] => "finite".to_owned(),
            (false, true) => format!("{low} or more"),
            (true, false) => format!("{high} or less"),
            _ => format!("in [{low}, {high}]"),
        };
        Err(Self {
            quantity,
            unit,
            range,
            value,
        })
    }

    /// Passes `value` on when it is finite and above zero.
    ///
    /// # Errors
    /// `RangeError` when it is not.
    pub fn positive(quantity: &'static str, unit: &'static str, value: f64) -> Result<f64, Self> {
        if value > 0.0 && value.is_finite() {
            return Ok(value);
        }
        Err(Self {
            quantity,
            unit,
            range: "above 0 and finite".to_owned(),
            value,
        })
    }
}

/// Slip ratio `s` [-]: `1 - v/(r ω)` when driving, `r ω/v - 1` when braking, `r` the rim radius.
///
/// 1 spins in place, 0 rolls, -1 slides with a locked wheel.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "f64", into = "f64")]
pub struct SlipRatio(f64);

impl SlipRatio {
    /// # Errors
    /// `RangeError` outside [-1, 1].
    pub fn new(value: f64) -> Result<Self, RangeError> {
        RangeError::check("slip ratio", "-", value, [-1.0, 1.0]).map(Self)
    }

    /// Slip of a rim of `radius` \[m\] that turns at `wheel_speed` [rad/s] and moves at
    /// `forward_speed` [m/s]. A wheel at rest has none; directions that disagree read ±1.
    pub fn from_motion(radius: f64, wheel_speed: f64, forward_speed: f64) -> Self {
        let rim_speed = radius * wheel_speed;
        let faster = rim_speed.abs().max(forward_speed.abs());
        if faster == 0.0 {
            return Self(0.0);
        }
        let direction = if rim_speed.abs() >= forward_speed.abs() {
            rim_speed
        } else {
            forward_speed
        };
        Self(((rim_speed - forward_speed) / (faster * direction.signum())).clamp(-1.0, 1.0))
    }

    /// Wheel speed [rad/s] that gives this slip at `forward_speed` [m/s] on a rim of `radius` \[m\]; `None` at
    /// s = 1, where it is not determined by the forward speed.
    pub fn wheel_speed(self, radius: f64, forward_speed: f64) -> Option<f64> {
        match self.0 {
            s if s >= 1.0 => None,
            s if s >= 0.0 => Some(forward_speed / (radius * (1.0 - s))),
            s => Some(forward_speed * (1.0 + s) / radius),
        }
    }

    /// The number.
    pub fn get(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for SlipRatio {
    type Error = RangeError;
    fn try_from(value: f64) -> Result<Self, RangeError> {
        Self::new(value)
    }
}

impl From<SlipRatio> for f64 {
    fn from(slip: SlipRatio) -> f64 {
        slip.0
    }
}

/// Rate of sampling or of stepping \[Hz\], a whole number.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(try_from = "f64", into = "f64")]
pub struct SampleRate(u32);

impl SampleRate {
    /// 128 kHz, at which the paper samples its accelerometer.
    pub const REFERENCE: Self = Self(128_000);

    /// 2 kHz, the default rate of stored samples.
    pub const OUTPUT: Self = Self(2_000);

    /// # Errors
    /// `RangeError` below 1 Hz, above 1 MHz, or when not whole.
    pub fn new(hertz: f64) -> Result<Self, RangeError> {
        if hertz.fract() != 0.0 || !(1.0..=1.0e6).contains(&hertz) {
            return Err(RangeError {
                quantity: "rate",
                unit: "Hz",
                range: "a whole number in [1, 1000000]".to_owned(),
                value: hertz,
            });
        }
        Ok(Self(hertz as u32))
    }

    /// The rate \[Hz\].
    pub fn hertz(self) -> f64 {
        f64::from(self.0)
    }

    /// The rate \[Hz\] as a whole number.
    pub fn whole(self) -> u32 {
        self.0
    }

    /// Time between samples \[s\].
    pub fn period(self) -> f64 {
        1.0 / self.hertz()
    }
}

impl TryFrom<f64> for SampleRate {
    type Error = RangeError;
    fn try_from(value: f64) -> Result<Self, RangeError> {
        Self::new(value)
    }
}

impl From<SampleRate> for f64 {
    fn from(rate: SampleRate) -> f64 {
        rate.hertz()
    }
}

/// Where all randomness of a run comes from.
///
/// Every stage draws from its own stream, named by `(seed, stage, run)`: a new stage shifts
/// no other run's draws, and run 17 is the same alone, in a study, or on another thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seed(pub u64);

impl Seed {
    /// The stream of one `stage` of one `run`.
    pub fn rng(self, stage: &str, run: u64) -> ChaCha8Rng {
        let mut hash = Sha256::new();
        hash.update(self.0.to_le_bytes());
        hash.update(run.to_le_bytes());
        hash.update(stage.as_bytes());
        ChaCha8Rng::from_seed(hash.finalize().into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slip_and_wheel_speed_are_inverse_driving_braking_and_reversing() {
        for forward_speed in [0.01, -0.01] {
            for s in [-0.9, -0.2, 0.0, 0.3, 0.95] {
                let slip = SlipRatio::new(s).unwrap();
                let wheel_speed = slip.wheel_speed(0.14, forward_speed).unwrap();
                let back = SlipRatio::from_motion(0.14, wheel_speed, forward_speed).get();
                assert!((back - s).abs() < 1e-12, "{s} came back as {back}");
            }
        }
        assert_eq!(SlipRatio::new(1.0).unwrap().wheel_speed(0.14, 0.01), None);
        assert_eq!(SlipRatio::from_motion(0.14, 0.1, 0.0).get(), 1.0);
        assert_eq!(SlipRatio::from_motion(0.14, 0.0, 0.01).get(), -1.0);
    }

    #[test]
    fn a_slip_outside_its_range_states_the_range() {
        let message = SlipRatio::new(1.3).unwrap_err().to_string();
        assert_eq!(message, "slip ratio [-] must be in [-1, 1], got 1.3");
    }

    #[test]
    fn a_rate_that_must_divide_another_has_a_message_without_be() {
        let error = RangeError {
            quantity: "output rate",
            unit: "Hz",
            range: "divide the sensor rate 128000 Hz".to_owned(),
            value: 40_000.0,
        };
        assert_eq!(
            error.to_string(),
            "output rate [Hz] must divide the sensor rate 128000 Hz, got 40000"
        );
    }

    #[test]
    fn streams_differ_by_stage_and_run_and_repeat() {
        use rand::RngExt;
        let draw = |stage, run| Seed(7).rng(stage, run).random::<u64>();
        assert_eq!(draw("terrain", 17), draw("terrain", 17));
        assert_ne!(draw("terrain", 17), draw("terrain", 18));
        assert_ne!(draw("terrain", 17), draw("sensors", 17));
    }
}
