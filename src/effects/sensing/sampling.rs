//! What a converter and its clock do to a channel: range, steps, instants.

use super::channels::{amount, transducer};
use crate::effects::{Bound, Effect, OtherForm, Prior, Seat, Signature, Source, Stage};

pub(super) const CLIPPING: Effect = Effect {
    name: "clipping",
    title: "saturation of a channel",
    edits: "range of the channel",
    stage: Stage::Sensors,
    seats: &[
        rail("m/s²", [20.0, 2.0, 0.5]).on("acceleration_y"),
        rail("N", [150.0, 120.0, 105.0]).on("normal_force"),
        rail("N", [60.0, 40.0, 20.0]).on("drawbar_pull"),
        rail("N·m", [10.0, 7.0, 5.0]).on("driving_torque"),
    ],
    signature: Signature {
        channels: &["acceleration_y", "normal_force"],
        bound: Bound::Condition,
        dependence: "samples pile up at one value; crest and kurtosis fall; more with speed, on hard \
                     ground and gravel",
    },
    confusers: &["low_pass", "gain_error"],
    source: Source::Guess(
        "sensors of ±1 to 8 g (ADXL350) never clip here: 2 and 0.5 m/s² stand for an amplifier set too \
         high; forces, for a sensor chosen for its load",
    ),
    law: |setup, range, seated| {
        let channel = transducer(setup, seated)?;
        channel.range = channel.range.min(range);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "soft, R tanh(x/R)",
        not_on: &[],
        law: |setup, range, seated| {
            let channel = transducer(setup, seated)?;
            channel.soft_range = channel.soft_range.min(range);
            Ok(())
        },
    }),
};

const fn rail(unit: &'static str, levels: [f64; 3]) -> Seat {
    let [_, typical, high] = levels;
    let prior = Prior::log_normal(typical, 3.0);
    Seat {
        neutral: f64::INFINITY,
        ..Seat::new(unit, [high / 100.0, f64::INFINITY], levels, prior)
    }
}

pub(super) const QUANTIZATION: Effect = Effect {
    name: "quantization",
    title: "coarse quantisation of a channel",
    edits: "resolution of the channel; sensors.vision.sinkage_resolution",
    stage: Stage::Sensors,
    seats: &[
        amount("m/s²", [0.001, 0.02, 0.08]).on("acceleration_y"),
        amount("N", [0.02, 0.1, 0.5]).on("normal_force"),
        amount("N", [0.02, 0.1, 0.5]).on("drawbar_pull"),
        amount("N·m", [0.001, 0.01, 0.05]).on("driving_torque"),
        amount("m", [1.0e-5, 1.0e-4, 5.0e-4]).on("sinkage"),
    ],
    signature: Signature {
        channels: &["acceleration_y", "sinkage"],
        bound: Bound::Condition,
        dependence: "equal steps; small motion reads as none, so it shows most in sand and at low speed",
    },
    confusers: &["added_noise", "rail_friction", "clipping"],
    source: Source::Cited(
        "data sheets: 1.95 mg (0.019 m/s²) a step of the ADXL350, 3.9 mg of the ADXL345; the sinkage of \
         cmu-single-wheel stands still in 14 of 27 runs (tests/data); torque a guess",
    ),
    law: |setup, step, seated| {
        let resolution = match seated.channel {
            "sinkage" => &mut setup.sensors.vision.sinkage_resolution,
            _ => &mut transducer(setup, seated)?.resolution,
        };
        *resolution = resolution.max(step);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "what is left over a step is dropped toward zero: a dead band twice as wide",
        not_on: &["sinkage"],
        law: |setup, step, seated| {
            let channel = transducer(setup, seated)?;
            channel.truncation = channel.truncation.max(step);
            Ok(())
        },
    }),
};

pub(super) const CLOCK_ERROR: Effect = Effect {
    name: "clock_error",
    title: "rate error of the sampling clock",
    edits: "sensors.clock_error",
    stage: Stage::Sensors,
    seats: &[Seat::new(
        "-",
        [-0.05, 0.05],
        [5.0e-5, 1.0e-3, 1.0e-2],
        Prior::normal(3.0e-3),
    )],
    signature: Signature {
        channels: &["acceleration_y", "wheel_angle"],
        bound: Bound::Frequency,
        dependence: "all frequencies off by one factor, resonances and lug passes alike",
    },
    confusers: &["encoder_scale", "channel_delay"],
    source: Source::Cited(
        "NI 9234: 50 ppm; Keithley KPCI-3140: 100 ppm; 0.1 to 1 % for oscillators inside sensors is a \
         guess",
    ),
    law: |setup, error, _| {
        setup.sensors.clock_error += error;
        Ok(())
    },
    other_form: None,
};

pub(super) const CHANNEL_DELAY: Effect = Effect {
    name: "channel_delay",
    title: "delay of a channel relative to the others",
    edits: "delay of the channel; sensors.encoder.wheel_angle.delay; sensors.vision.delay",
    stage: Stage::Sensors,
    seats: &[
        LAG.on("normal_force"),
        LAG.on("drawbar_pull"),
        LAG.on("driving_torque"),
        LAG.on("acceleration_y"),
        LAG.on("wheel_angle"),
        LAG.on("sinkage"),
    ],
    signature: Signature {
        channels: &["normal_force", "acceleration_y"],
        bound: Bound::Frequency,
        dependence: "phase to other channels in proportion to frequency; each channel alone looks right",
    },
    confusers: &["low_pass", "rail_friction", "clock_error"],
    source: Source::Cited(
        "odom_predictor (ETH Zurich): time shifts of -0.1 to 0.1 s; strain-gauge chains started by one \
         trigger lag by less than 1 ms",
    ),
    law: |setup, delay, seated| {
        let sensors = &mut setup.sensors;
        let lag = match seated.channel {
            "wheel_angle" => &mut sensors.encoder.wheel_angle.delay,
            "sinkage" => &mut sensors.vision.delay,
            _ => &mut transducer(setup, seated)?.delay,
        };
        *lag += delay;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "readings arrive in bursts, each held for twice the delay",
        not_on: &["wheel_angle", "sinkage"],
        law: |setup, delay, seated| {
            let channel = transducer(setup, seated)?;
            channel.hold = channel.hold.max(2.0 * delay);
            Ok(())
        },
    }),
};

pub(super) const ANGLE_ZERO: Effect = Effect {
    name: "angle_zero",
    title: "wrong zero of the wheel angle",
    edits: "sensors.encoder.wheel_angle.bias",
    stage: Stage::Sensors,
    seats: &[Seat::new(
        "°",
        [-180.0, 180.0],
        [0.3, 1.0, 3.0],
        Prior::normal(1.5),
    )],
    signature: Signature {
        channels: &["driving_torque", "drawbar_pull", "acceleration_y"],
        bound: Bound::WheelAngle,
        dependence: "the phase of every order of the wheel turns by its order times the angle, so a lug pass of 28 lugs \
                     by 28° a degree, at every speed alike; levels and frequencies stay",
    },
    confusers: &["channel_delay"],
    source: Source::Guess(
        "a lug set upright by eye is within half a lug's thickness, 1.5 mm at a radius of 155 mm or 0.6°; by a mark on \
         the rim within some degrees",
    ),
    law: |setup, degrees, _| {
        setup.sensors.encoder.wheel_angle.bias += degrees.to_radians();
        Ok(())
    },
    other_form: None,
};

const LAG: Seat = Seat::new(
    "s",
    [0.0, 1.0],
    [0.001, 0.01, 0.06],
    Prior::log_normal(0.008, 3.3),
);

pub(super) const ALIASING: Effect = Effect {
    name: "aliasing",
    title: "aliasing by decimation without a filter",
    edits: "sensors.alias_leak",
    stage: Stage::Sensors,
    seats: &[Seat::new(
        "-",
        [0.0, 1.0],
        [0.05, 0.3, 1.0],
        Prior::half_normal(0.5),
    )],
    signature: Signature {
        channels: &["acceleration_y"],
        bound: Bound::Frequency,
        dependence: "what lies above the output's Nyquist frequency folds back: louder with speed, most \
                     on hard ground; lines that fall as speed grows",
    },
    confusers: &["added_noise", "gain_error", "mounting_resonance"],
    source: Source::Cited(
        "ATI F/T DAQ manual: \"the transducer electronics do not filter the outputs\" (all of it); Rion \
         VM-83: 0.3 % behind a filter of fifth order",
    ),
    law: |setup, share, _| {
        let leak = &mut setup.sensors.alias_leak;
        *leak = (*leak + share).min(1.0);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "a mean over the samples dropped in place of a filter",
        not_on: &[],
        law: |setup, share, _| {
            let mean = &mut setup.sensors.alias_mean;
            *mean = (*mean + share).min(1.0);
            Ok(())
        },
    }),
};
