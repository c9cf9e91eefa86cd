//! Effects of sensors: the motion is the ideal one, what is read of it is not.

use super::{Bound, Effect, EffectError, Prior, Seat, Seated, Setup, Signature, Source, Stage};
use crate::sensors::transducer::Transducer;

/// The effects of sensors.
pub(super) const EFFECTS: &[Effect] = &[SENSOR_TILT, GAIN_ERROR];

/// The analogue channel that an effect sits on.
fn transducer<'a>(setup: &'a mut Setup, seated: Seated) -> Result<&'a mut Transducer, EffectError> {
    let sensors = &mut setup.sensors;
    match seated.channel {
        "acceleration_y" => Ok(&mut sensors.accelerometer.acceleration_y),
        "normal_force" => Ok(&mut sensors.force_torque.normal_force),
        "drawbar_pull" => Ok(&mut sensors.force_torque.drawbar_pull),
        "driving_torque" => Ok(&mut sensors.force_torque.driving_torque),
        "forward_speed" => Ok(&mut sensors.encoder.forward_speed),
        _ => Err(EffectError::Needs {
            effect: seated.effect,
            what: "an analogue channel",
        }),
    }
}

const SENSOR_TILT: Effect = Effect {
    name: "sensor_tilt",
    title: "accelerometer leans toward the direction of travel",
    edits: "sensors.accelerometer.tilt_deg",
    stage: Stage::Sensors,
    seats: &[Seat {
        channel: "",
        unit: "°",
        neutral: 0.0,
        range: [-45.0, 45.0],
        levels: [1.0, 3.0, 10.0],
        prior: Prior::Normal { mean: 0.0, sd: 3.0 },
    }],
    signature: Signature {
        channels: &["acceleration_y"],
        bound: Bound::Condition,
        dependence: "mean g (cos - 1), the same at every slip, speed and load",
    },
    confusers: &["bias_drift"],
    source: Source::Guess("set up by eye: a few degrees"),
    law: |setup, tilt, _| {
        setup.sensors.accelerometer.tilt_deg += tilt;
        Ok(())
    },
    other_form: None,
};

const GAIN_ERROR: Effect = Effect {
    name: "gain_error",
    title: "a channel's sensitivity is off",
    edits: "gain of the channel",
    stage: Stage::Sensors,
    seats: &[gain_of("drawbar_pull"), gain_of("normal_force")],
    signature: Signature {
        channels: &["drawbar_pull"],
        bound: Bound::Condition,
        dependence: "in proportion to the reading",
    },
    confusers: &["force_crosstalk"],
    source: Source::Guess("calibrations of strain gauges differ by some percent"),
    law: |setup, error, seated| {
        transducer(setup, seated)?.gain *= 1.0 + error;
        Ok(())
    },
    other_form: None,
};

const fn gain_of(channel: &'static str) -> Seat {
    Seat {
        channel,
        unit: "-",
        neutral: 0.0,
        range: [-0.5, 0.5],
        levels: [0.01, 0.03, 0.1],
        prior: Prior::Normal {
            mean: 0.0,
            sd: 0.03,
        },
    }
}
