//! What is read now and then: the wheel's counter at the output rate, the camera frame by frame.

use super::encoder::Latch;
use super::sampling::Instants;
use super::vision::Camera;
use super::{Observed, Sensors, channel};
use crate::simulation::WheelState;
use crate::trace::Channel;

/// Counter and camera at work on one run.
pub(super) struct SlowChannels {
    latch: Latch,
    camera: Camera,
    output_rate: f64,
    frame_rate: f64,
    slip_baseline: f64,
}

impl SlowChannels {
    pub(super) fn new(sensors: &Sensors, observed: &Observed) -> Self {
        let Observed {
            wheel_radius,
            seed,
            run,
            ..
        } = *observed;
        let physics_rate = observed.physics_rate.hertz();
        let (counter, vision) = (sensors.encoder.wheel_angle, sensors.vision);
        let instants = |rate: f64, delay: f64| {
            let steps = physics_rate / rate * (1.0 + sensors.clock_error);
            Instants::new(steps, delay * physics_rate)
        };
        let output_rate = sensors.output_rate.hertz();
        Self {
            latch: Latch::new(
                counter,
                instants(output_rate, counter.delay),
                seed.rng("sensors.wheel_angle", run),
            ),
            camera: Camera::new(
                vision,
                wheel_radius,
                instants(vision.frame_rate, vision.delay),
                |stage| seed.rng(stage, run),
            ),
            output_rate,
            frame_rate: vision.frame_rate,
            slip_baseline: vision.baseline(),
        }
    }

    /// Samples the state of this step.
    pub(super) fn push(&mut self, step: u64, state: &WheelState) {
        self.latch.push(step, state.wheel_angle);
        self.camera.push(step, state);
    }

    /// Wheel angle, as many samples as `count`, sinkage and slip, after `start` [s].
    pub(super) fn finish(self, start: f64, count: usize) -> [Channel; 3] {
        let Camera {
            sinkage,
            slip_ratio,
            ..
        } = self.camera;
        let angles = self.latch.finish(count);
        let slip_start = start + self.slip_baseline;
        [
            channel("wheel_angle", "rad", self.output_rate, start, angles),
            channel("sinkage", "m", self.frame_rate, start, sinkage),
            channel("slip_ratio", "1", self.frame_rate, slip_start, slip_ratio),
        ]
    }
}
