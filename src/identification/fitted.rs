//! Loads by the fitted model.

use super::estimate::Estimate;
use super::model::Model;
use super::point::Point;
use super::row::{Setting, SteadyLoad};
use crate::soil::wheel_load::WheelLoad;

impl Estimate {
    /// Loads [N, N·m] by Eq. (62)-(64) at a `slip` [-] and `sinkage` \[m\] of the rim, with the setting of the
    /// fit. Where the class sets the sinkage, the argument is ignored.
    pub fn loads_at(&self, setting: &Setting, slip: f64, sinkage: f64) -> WheelLoad {
        let model = Model {
            class: self.class,
            setting: *setting,
        };
        let measured = SteadyLoad::at(slip, sinkage);
        let on_cylinder = setting.on_cylinder(&measured, self.class);
        let at = self.terrain.coordinates();
        model.loads(&Point::of(&at, &on_cylinder))
    }
}
