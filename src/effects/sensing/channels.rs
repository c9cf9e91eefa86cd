//! What an analogue channel does to a quantity: gain, bias, bandwidth, noise.

use crate::effects::{
    Bound, Effect, EffectError, OtherForm, Prior, Seat, Seated, Setup, Signature, Source, Stage,
};
use crate::sensors::transducer::Transducer;

/// Time [s] over which a drift is stated.
const WARMING: f64 = 10.0;

/// Bandwidth [Hz] of the stated noise: that of a channel at 2 kHz.
const NOISE_BAND: f64 = 1.0e3;

/// The analogue channel that an effect sits on.
pub(super) fn transducer<'a>(
    setup: &'a mut Setup,
    seated: Seated,
) -> Result<&'a mut Transducer, EffectError> {
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

pub(super) const LOW_PASS: Effect = Effect {
    name: "low_pass",
    title: "lower bandwidth of a channel than stated",
    edits: "bandwidth of the channel",
    stage: Stage::Sensors,
    seats: &[
        CORNER.on("acceleration_y"),
        CORNER.on("normal_force"),
        CORNER.on("drawbar_pull"),
        CORNER.on("driving_torque"),
    ],
    signature: Signature {
        channels: &["acceleration_y"],
        bound: Bound::Frequency,
        dependence: "nothing above the corner, at every speed; rms, crest and features fall where \
                     impacts are loud, means and low orders stay",
    },
    confusers: &["dust_cover", "gain_error", "channel_delay"],
    source: Source::Cited(
        "data sheets: 360 to 440 Hz (Motorola XMMA1000P); libfranka's default for forces is 100 Hz",
    ),
    law: |setup, corner, seated| {
        let channel = transducer(setup, seated)?;
        channel.bandwidth = channel.bandwidth.min(corner);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "of first order instead of second",
        not_on: &[],
        law: |setup, corner, seated| {
            let channel = transducer(setup, seated)?;
            channel.single_pole = channel.single_pole.min(corner);
            Ok(())
        },
    }),
};

const CORNER: Seat = Seat {
    neutral: f64::INFINITY,
    ..Seat::new(
        "Hz",
        [1.0, f64::INFINITY],
        [500.0, 150.0, 40.0],
        Prior::log_normal(200.0, 2.5),
    )
};

pub(super) const MOUNTING_RESONANCE: Effect = Effect {
    name: "mounting_resonance",
    title: "mounting resonance of the accelerometer",
    edits: "sensors.accelerometer.mounting_frequency",
    stage: Stage::Sensors,
    seats: &[Seat {
        neutral: f64::INFINITY,
        ..Seat::new(
            "Hz",
            [10.0, f64::INFINITY],
            [900.0, 450.0, 180.0],
            Prior::log_normal(700.0, 2.2),
        )
    }],
    signature: Signature {
        channels: &["acceleration_y"],
        bound: Bound::Frequency,
        dependence: "a peak at the resonance after every impact, in the acceleration alone",
    },
    confusers: &["rig_resonance", "mains_hum", "aliasing"],
    source: Source::Guess(
        "a stud or magnet resonates above 2 kHz, where nothing shows; below 1 kHz it is a bracket or a \
         circuit board",
    ),
    law: |setup, frequency, _| {
        let sensor = &mut setup.sensors.accelerometer;
        sensor.mounting_frequency = sensor.mounting_frequency.min(frequency);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "glued: damping ratio 0.15 instead of 0.05",
        not_on: &[],
        law: |setup, frequency, _| {
            let sensor = &mut setup.sensors.accelerometer;
            if frequency < sensor.mounting_frequency {
                sensor.mounting_frequency = frequency;
                sensor.mounting_damping = 0.15;
            }
            Ok(())
        },
    }),
};

pub(super) const LOOSE_MOUNT: Effect = Effect {
    name: "loose_mount",
    title: "accelerometer that clatters on its mount",
    edits: "sensors.accelerometer.loose_mount.preload",
    stage: Stage::Sensors,
    seats: &[Seat {
        neutral: f64::INFINITY,
        ..Seat::new(
            "m/s²",
            [0.01, f64::INFINITY],
            [0.8, 0.3, 0.1],
            Prior::log_normal(0.3, 3.0),
        )
    }],
    signature: Signature {
        channels: &["acceleration_y"],
        bound: Bound::Condition,
        dependence: "shocks of some 0.1 ms wherever the axle falls faster than the preload lets the sensor follow: on \
                     hard ground and gravel, more with speed; nothing in sand or on the lifted wheel, and nothing at these \
                     speeds where its whole weight holds it",
    },
    confusers: &["mounting_resonance", "clipping", "aliasing"],
    source: Source::Guess(
        "a sensor that its weight alone holds, with a cable that carries 92, 97 or 99 % of it",
    ),
    law: |setup, preload, _| {
        let mount = &mut setup.sensors.accelerometer.loose_mount;
        mount.preload = mount.preload.min(preload);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "on a soft pad: it lands in 1 ms and does not rebound",
        not_on: &[],
        law: |setup, preload, _| {
            let mount = &mut setup.sensors.accelerometer.loose_mount;
            if preload < mount.preload {
                mount.preload = preload;
                mount.restitution = 0.0;
                mount.contact_time = 1.0e-3;
            }
            Ok(())
        },
    }),
};

pub(super) const GAIN_ERROR: Effect = Effect {
    name: "gain_error",
    title: "gain error of a channel",
    edits: "gain of the channel",
    stage: Stage::Sensors,
    seats: &[
        GAIN.on("drawbar_pull"),
        GAIN.on("normal_force"),
        GAIN.on("driving_torque"),
        GAIN.on("acceleration_y"),
        GAIN.on("forward_speed"),
        GAIN.on("sinkage"),
    ],
    signature: Signature {
        channels: &["drawbar_pull", "normal_force", "driving_torque"],
        bound: Bound::Condition,
        dependence: "one channel, mean and all orders, in proportion to its reading",
    },
    confusers: &[
        "nonlinearity",
        "lug_action",
        "lug_wear",
        "load_drift",
        "apparent_cohesion",
    ],
    source: Source::Cited(
        "data sheets: 7 to 7.5 % uncalibrated (ADXL350, XMMA1000P); 1 % calibrated (mmf.de)",
    ),
    law: |setup, error, seated| {
        match seated.channel {
            "sinkage" => setup.sensors.vision.sinkage_gain *= 1.0 + error,
            _ => transducer(setup, seated)?.gain *= 1.0 + error,
        }
        Ok(())
    },
    other_form: None,
};

const GAIN: Seat = Seat::new("-", [-0.5, 0.5], [0.01, 0.03, 0.08], Prior::normal(0.03));

pub(super) const NONLINEARITY: Effect = Effect {
    name: "nonlinearity",
    title: "nonlinearity of a channel",
    edits: "curvature of the channel",
    stage: Stage::Sensors,
    seats: &[
        BEND.on("drawbar_pull"),
        BEND.on("normal_force"),
        BEND.on("driving_torque"),
        BEND.on("acceleration_y"),
    ],
    signature: Signature {
        channels: &["drawbar_pull", "normal_force", "driving_torque"],
        bound: Bound::Condition,
        dependence: "right at zero, off by the magnitude at the channel's usual reading and by twice that at \
                     twice the reading: peaks more than the mean, and more at high loads",
    },
    confusers: &["gain_error", "clipping"],
    source: Source::Cited(
        "data sheet of the ADXL350: 0.5 % of full scale; forces alike, a guess, for a sensor used over all of \
         its range or over a tenth of it",
    ),
    law: |setup, error, seated| {
        let typical = typical(setup, seated);
        transducer(setup, seated)?.curvature += error / typical;
        Ok(())
    },
    other_form: None,
};

const BEND: Seat = Seat::new("-", [-0.5, 0.5], [0.002, 0.005, 0.03], Prior::normal(0.01));

/// Typical reading of a channel, in its unit.
fn typical(setup: &Setup, seated: Seated) -> f64 {
    let load = setup.rig.load();
    match seated.channel {
        "normal_force" => load,
        "drawbar_pull" => 0.3 * load,
        "driving_torque" => 0.4 * load * setup.wheel.radius,
        _ => 0.5,
    }
}

pub(super) const BIAS_DRIFT: Effect = Effect {
    name: "bias_drift",
    title: "zero drift of a channel since taring",
    edits: "bias of the channel",
    stage: Stage::Sensors,
    seats: &[
        offset("N", [0.15, 0.6, 2.0]).on("drawbar_pull"),
        offset("N", [0.15, 0.6, 2.0]).on("normal_force"),
        offset("N·m", [0.005, 0.015, 0.04]).on("driving_torque"),
        offset("m/s²", [0.01, 0.05, 0.3]).on("acceleration_y"),
    ],
    signature: Signature {
        channels: &["drawbar_pull", "normal_force", "driving_torque"],
        bound: Bound::History,
        dependence: "the mean, at every load, slip and speed and in the lifted wheel; differs from day \
                     to day",
    },
    confusers: &["slope", "sensor_tilt", "bulldozing", "multipass"],
    source: Source::Cited(
        "zero recordings of cmu-single-wheel over four months (tests/data): sd 0.6 to 1.0 N and 5 to \
         14 mN·m; acceleration: 0.2 to 0.5 mg/K (ADXL350, ADXL313)",
    ),
    law: |setup, offset, seated| {
        transducer(setup, seated)?.bias += offset;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "grows during the run, from zero to the magnitude in ten seconds",
        not_on: &[],
        law: |setup, offset, seated| {
            transducer(setup, seated)?.drift += offset / WARMING;
            Ok(())
        },
    }),
};

const fn offset(unit: &'static str, levels: [f64; 3]) -> Seat {
    let [_, typical, high] = levels;
    let prior = Prior::normal(typical);
    Seat::new(unit, [-100.0 * high, 100.0 * high], levels, prior)
}

pub(super) const ADDED_NOISE: Effect = Effect {
    name: "added_noise",
    title: "higher noise of a channel than stated",
    edits: "noise density of the channel; sensors.vision.sinkage_noise",
    stage: Stage::Sensors,
    seats: &[
        amount("m/s²", [0.005, 0.03, 0.13]).on("acceleration_y"),
        amount("N", [0.05, 0.15, 0.5]).on("normal_force"),
        amount("N", [0.05, 0.15, 0.5]).on("drawbar_pull"),
        amount("N·m", [5.0e-4, 3.0e-3, 1.0e-2]).on("driving_torque"),
        amount("m", [2.0e-4, 5.0e-4, 2.0e-3]).on("sinkage"),
    ],
    signature: Signature {
        channels: &["acceleration_y"],
        bound: Bound::Frequency,
        dependence: "a flat floor of that rms over 1 kHz (of that sd a frame in sinkage), the same at \
                     rest and in the lifted wheel",
    },
    confusers: &["quantization", "aliasing", "mains_hum"],
    source: Source::Cited(
        "ADXL355: 0.6 mg rms on the bench; ADXL313: 150 to 250 µg/√Hz; ADXL345: 290 to 430; \
         cmu-single-wheel (tests/data): 0.05 to 0.16 N, 0.5 to 3.1 mN·m; sinkage a guess",
    ),
    law: |setup, rms, seated| {
        if seated.channel == "sinkage" {
            let noise = &mut setup.sensors.vision.sinkage_noise;
            *noise = libm::hypot(*noise, rms);
            return Ok(());
        }
        let channel = transducer(setup, seated)?;
        channel.noise_density = libm::hypot(channel.noise_density, rms / libm::sqrt(NOISE_BAND));
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "slow noise of the same rms, below some 20 Hz",
        not_on: &["sinkage"],
        law: |setup, rms, seated| {
            let channel = transducer(setup, seated)?;
            channel.rumble = libm::hypot(channel.rumble, rms);
            Ok(())
        },
    }),
};

pub(super) const MAINS_HUM: Effect = Effect {
    name: "mains_hum",
    title: "mains hum in a channel",
    edits: "hum of the channel",
    stage: Stage::Sensors,
    seats: &[
        amount("m/s²", [0.003, 0.02, 0.1]).on("acceleration_y"),
        amount("N", [0.02, 0.1, 0.5]).on("normal_force"),
        amount("N", [0.02, 0.1, 0.5]).on("drawbar_pull"),
        amount("N·m", [0.002, 0.01, 0.05]).on("driving_torque"),
    ],
    signature: Signature {
        channels: &["acceleration_y", "normal_force"],
        bound: Bound::Frequency,
        dependence: "a line at 50 Hz of constant amplitude in every run, at rest too, in no phase with \
                     the wheel",
    },
    confusers: &["rig_resonance", "motor_cogging", "mounting_resonance"],
    source: Source::Guess(
        "hum in amplifiers of strain gauges is well known (Vishay TN-501), its size a matter of wiring",
    ),
    law: |setup, amplitude, seated| {
        transducer(setup, seated)?.hum += amplitude;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "distorted by a rectifier: half of it at 100 Hz",
        not_on: &[],
        law: |setup, amplitude, seated| {
            let channel = transducer(setup, seated)?;
            channel.hum += amplitude;
            channel.ripple += 0.5 * amplitude;
            Ok(())
        },
    }),
};

/// A seat whose magnitude is an amount from 0 up.
pub(super) const fn amount(unit: &'static str, levels: [f64; 3]) -> Seat {
    let [_, typical, high] = levels;
    let prior = Prior::log_normal(typical, 2.7);
    Seat::new(unit, [0.0, 100.0 * high], levels, prior)
}
