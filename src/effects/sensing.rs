//! Effects of sensors: the motion is the ideal one, what is read of it is not.

mod channels;
mod forces;
mod sampling;

use super::Effect;

/// The effects of sensors.
pub(super) const EFFECTS: &[Effect] = &[
    forces::SENSOR_TILT,
    channels::LOW_PASS,
    channels::MOUNTING_RESONANCE,
    channels::LOOSE_MOUNT,
    channels::GAIN_ERROR,
    channels::NONLINEARITY,
    channels::BIAS_DRIFT,
    forces::FORCE_CROSSTALK,
    sampling::CLIPPING,
    sampling::QUANTIZATION,
    channels::ADDED_NOISE,
    channels::MAINS_HUM,
    sampling::CLOCK_ERROR,
    sampling::CHANNEL_DELAY,
    sampling::ANGLE_ZERO,
    sampling::ALIASING,
];
