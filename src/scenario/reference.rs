//! What the features of a scenario's runs are taken over where there is no reference run.

use super::Scenario;
use crate::features::Settings;
use crate::features::reference::{Reference, ReferenceError};
use crate::sensors::Sensors;

impl Scenario {
    /// The computed reference, passed through the scenario's sensors where these change anything.
    ///
    /// # Errors
    /// [`ReferenceError`] for a motion or sensors that cannot be.
    pub fn computed_reference(&self, settings: Settings) -> Result<Reference, ReferenceError> {
        let Self { wheel, sensors, .. } = self;
        let ideal = Sensors {
            rate: sensors.rate,
            output_rate: sensors.output_rate,
            raw: sensors.raw,
            ..Sensors::default()
        };
        let wheel_speed = self.rig.drive().full_wheel_speed(wheel.radius)?;
        if *sensors == ideal || wheel_speed == 0.0 {
            return Ok(Reference::computed());
        }
        Reference::through_sensors(wheel, sensors, &[wheel_speed], settings)
    }
}
