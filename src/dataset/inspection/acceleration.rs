//! What the vertical acceleration contradicts: gravity, its unit, its zero.
//!
//! A wheel that neither takes off nor falls has a mean vertical acceleration of nil. Gravity left in makes
//! it `+g`; taken off a sensor that points downward or that had none left, `−g`; taken off with the
//! wrong sign, `±2 g`; each in the unit in which the log has it.

use super::doubts::Doubts;
use super::subject::{SIGMAS, Steady, Subject};
use super::{Severity, number};
use crate::quantity::GRAVITY;
use crate::statistics::upper_median;
use crate::trace::Channel;

/// How far a mean may lie off gravity [-]: gain and tilt of a cheap sensor.
const NEAR: f64 = 0.05;

/// Units of an uncorrected gravity: the reading of `g` in the channel, taken as m/s², and its name.
const UNITS: [(f64, &str); 5] = [
    (GRAVITY, ""),
    (1.0, "in units of g, with "),
    (GRAVITY * GRAVITY, "converted from g twice, with "),
    (1.0e2 * GRAVITY, "in cm/s^2, with "),
    (1.0e3 * GRAVITY, "in mm/s^2 or milli-g, with "),
];

/// Change of vertical speed [m/s] that no wheel of a rover makes: a mean acceleration that integrates to more
/// is an offset.
const FASTEST: f64 = 0.2;

/// Length [s] of the blocks in which the acceleration is integrated: several lug passes.
const BLOCK: f64 = 1.0;

/// Doubts the mean and the size of the acceleration.
pub(super) fn check(subject: &Subject<'_>, doubts: &mut Doubts) {
    let Some(steady) = subject.steady("acceleration_y") else {
        return;
    };
    let acceleration = subject.trace.channel("acceleration_y");
    let seconds = acceleration.map_or(BLOCK, |channel| {
        channel.steady().len() as f64 / channel.sample_rate
    });
    let seen = format!("mean is {} m/s^2", number(steady.mean));
    let cos = libm::cos(subject.trace.attributes.slope_deg.to_radians());
    if let Some(guess) = gravity(steady.mean, cos) {
        doubts.channel("acceleration_y", Severity::Error, &seen, &guess);
    } else if let Some(drift) = drift(steady, cos, seconds) {
        let seen = format!("{seen}, which makes {drift}");
        let guess = "an offset; subtract it on import";
        doubts.channel("acceleration_y", Severity::Warning, &seen, guess);
    }
    if let Some(acceleration) = acceleration {
        check_size(subject, acceleration, doubts);
    }
}

/// How gravity came into a `mean` [m/s²], if it did, on a track whose slope has this `cos`.
fn gravity(mean: f64, cos: f64) -> Option<String> {
    let near = |value: f64| (mean / value - 1.0).abs() < NEAR;
    UNITS.iter().find_map(|(unit_of_g, unit)| {
        let doubt = |gravity: &str| {
            let question = if unit.is_empty() { "" } else { "?" };
            format!("{unit}{gravity}{question}")
        };
        let is_left_in = near(*unit_of_g) || near(cos * unit_of_g);
        if is_left_in && unit.is_empty() {
            Some("gravity is still in it; subtract it on import".to_owned())
        } else if is_left_in {
            Some(doubt("gravity in it"))
        } else if near(-unit_of_g) {
            Some(doubt(
                "gravity taken off twice, or left in by a sensor that points downward",
            ))
        } else if near(2.0 * unit_of_g) || near(-2.0 * unit_of_g) {
            Some(doubt("gravity taken off with the wrong sign"))
        } else {
            None
        }
    })
}

/// The vertical speed that the mean acceleration comes to in so many `seconds`, where that carries the wheel away.
///
/// A sensor that was tared on the level reads `-g (1 - cos)` on a slope. Samples that are too seldom for the vibration have a
/// mean by chance.
fn drift(steady: Steady, cos: f64, seconds: f64) -> Option<String> {
    let by_slope = GRAVITY * (1.0 - cos);
    let mean = steady.mean - steady.mean.clamp(-by_slope, 0.0);
    let gained = mean * seconds;
    (gained.abs() > FASTEST && mean.abs() > SIGMAS * steady.sd).then(|| {
        format!(
            "{} m/s of vertical speed in {} s",
            number(gained),
            number(seconds)
        )
    })
}

/// Doubts an acceleration that integrates to speeds which a wheel cannot have.
///
/// A wheel that falls by its own radius reaches `√(2 g r)`; in half of the blocks of its record none does.
fn check_size(subject: &Subject<'_>, acceleration: &Channel, doubts: &mut Doubts) {
    let radius = subject.trace.attributes.wheel_radius;
    let most = (2.0 * GRAVITY * radius).sqrt();
    let length = (BLOCK * acceleration.sample_rate) as usize;
    if !most.is_finite() || length < 20 || doubts.has_any(&["acceleration_y"]) {
        return;
    }
    let blocks = acceleration.samples.chunks_exact(length);
    let period = 1.0 / acceleration.sample_rate;
    if let Some(swing) = upper_median(blocks.filter_map(|block| swing(block, period)))
        && swing > most
    {
        let seen = format!(
            "integrates to {} m/s of vertical speed within {BLOCK} s, and a fall by the wheel's radius makes {}",
            number(swing),
            number(most)
        );
        let guess = "in mm/s^2 or milli-g?";
        doubts.channel("acceleration_y", Severity::Error, &seen, guess);
    }
}

/// Largest less least speed [m/s] that `samples` [m/s²] less their mean integrate to.
fn swing(samples: &[f64], period: f64) -> Option<f64> {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    let (mut speed, mut low, mut high) = (0.0, 0.0_f64, 0.0_f64);
    for sample in samples {
        speed += (sample - mean) * period;
        low = low.min(speed);
        high = high.max(speed);
    }
    (high - low).is_finite().then_some(high - low)
}
