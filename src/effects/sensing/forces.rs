//! Misaligned force sensors: tilted ones, and crosstalk of axes.

use crate::effects::{Bound, Effect, Prior, Seat, Signature, Source, Stage};
use crate::sensors::force_torque::ForceTorque;

/// Rows and columns of the force sensor's matrix.
const NORMAL: usize = 0;
const PULL: usize = 1;
const TORQUE: usize = 2;

const TILTED: Seat = Seat::new("°", [-45.0, 45.0], [0.3, 1.0, 3.0], Prior::normal(1.0));

pub(super) const SENSOR_TILT: Effect = Effect {
    name: "sensor_tilt",
    title: "sensor tilt in the direction of travel",
    edits: "sensors.accelerometer.tilt_deg; of the force sensor (drawbar_pull): \
            sensors.force_torque.crosstalk",
    stage: Stage::Sensors,
    seats: &[TILTED.on("drawbar_pull"), TILTED.on("acceleration_y")],
    signature: Signature {
        channels: &["drawbar_pull", "acceleration_y"],
        bound: Bound::Condition,
        dependence: "pull off by W sin t, 1.7 % of the load a degree, at every slip, sinkage untouched; \
                     acceleration off by g (cos t - 1) and by sin t of the forward one",
    },
    confusers: &["slope", "force_crosstalk", "bias_drift"],
    source: Source::Cited(
        "data sheets: axis alignment 0.1° (ADXL350) to 3° (Motorola XMMA1000P), holes within 1°",
    ),
    law: |setup, tilt, seated| {
        let sensors = &mut setup.sensors;
        match seated.channel {
            "acceleration_y" => sensors.accelerometer.tilt_deg += tilt,
            _ => turn(&mut sensors.force_torque, tilt.to_radians()),
        }
        Ok(())
    },
    other_form: None,
};

pub(super) const FORCE_CROSSTALK: Effect = Effect {
    name: "force_crosstalk",
    title: "force-sensor crosstalk",
    edits: "sensors.force_torque.crosstalk",
    stage: Stage::Sensors,
    seats: &[
        CROSSED.on("drawbar_pull"),
        CROSSED.on("normal_force"),
        Seat::new(
            "m",
            [-0.05, 0.05],
            [0.001, 0.003, 0.006],
            Prior::normal(0.003),
        )
        .on("driving_torque"),
    ],
    signature: Signature {
        channels: &["drawbar_pull", "normal_force", "driving_torque"],
        bound: Bound::Condition,
        dependence: "the channel copies part of the pattern of the normal force (on normal_force: of the \
                     pull), in phase, in proportion to load",
    },
    confusers: &["sensor_tilt", "slope", "load_drift", "gain_error"],
    source: Source::Cited(
        "me-systeme.com, accuracy of force-torque sensors: about 1 % of the other axes' rated load, in \
         proportion to it",
    ),
    law: |setup, share, seated| {
        let matrix = &mut setup.sensors.force_torque.crosstalk;
        match seated.channel {
            "normal_force" => matrix[NORMAL][PULL] += share,
            "driving_torque" => matrix[TORQUE][NORMAL] += share,
            _ => matrix[PULL][NORMAL] += share,
        }
        Ok(())
    },
    other_form: None,
};

const CROSSED: Seat = Seat::new("-", [-0.2, 0.2], [0.005, 0.015, 0.04], Prior::normal(0.015));

/// Turns the sensor by an angle [rad]: its pull axis then measures part of the normal force.
fn turn(sensor: &mut ForceTorque, angle: f64) {
    let (sin, cos) = libm::sincos(angle);
    sensor.crosstalk = sensor.crosstalk.map(|[normal, pull, torque]| {
        [normal * cos + pull * sin, pull * cos - normal * sin, torque]
    });
}
