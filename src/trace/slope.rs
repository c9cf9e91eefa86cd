//! Loads of the contact from what force sensors read on a slope.

use super::RunAttributes;
use crate::quantity::GRAVITY;

/// A track of slope `β`, uphill above 0, and sensors that were tared on the level.
///
/// ```text
/// N = N_read - m g (1 - cos β),    F_DP = F_read + m g sin β,    N = W cos β where only W is known
/// ```
///
/// `m` is the mass on the wheel's side of the sensors. On the level its weight is part of the tare; on a slope a
/// part of that tare presses on the track no more, and the weight has a part along the track. Torque does
/// not change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Part of a vertical load [-] that is normal to the track.
    cos: f64,
    /// Normal force [N] that the sensors read in excess of the contact's.
    normal_excess: f64,
    /// Pull [N] that the sensors read short of the contact's.
    pull_shortage: f64,
}

impl Slope {
    /// The slope of a run; `None` where it is not level and does not state the wheel's mass.
    pub fn of(run: &RunAttributes) -> Option<Self> {
        let mass = match (run.slope_deg, run.wheel_mass) {
            (0.0, _) => 0.0,
            (_, mass) => mass?,
        };
        let (sin, cos) = libm::sincos(run.slope_deg.to_radians());
        Some(Self {
            cos,
            normal_excess: mass * GRAVITY * (1.0 - cos),
            pull_shortage: mass * GRAVITY * sin,
        })
    }

    /// Normal force \[N\] of the contact where the sensors read `normal_force` \[N\].
    pub fn normal_force(&self, normal_force: f64) -> f64 {
        normal_force - self.normal_excess
    }

    /// Drawbar pull \[N\] of the contact where the sensors read `drawbar_pull` \[N\].
    pub fn drawbar_pull(&self, drawbar_pull: f64) -> f64 {
        drawbar_pull + self.pull_shortage
    }

    /// What the contact has where the sensors of `channel` read `reading`: a pull or a normal force less the weight's part.
    pub fn contact(&self, channel: &str, reading: f64) -> f64 {
        match channel {
            "drawbar_pull" => self.drawbar_pull(reading),
            "normal_force" => self.normal_force(reading),
            _ => reading,
        }
    }

    /// Normal force \[N\] of the contact under a vertical load \[N\].
    pub fn carried(&self, load: f64) -> f64 {
        load * self.cos
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(slope_deg: f64, wheel_mass: Option<f64>) -> RunAttributes {
        RunAttributes {
            slope_deg,
            wheel_mass,
            ..RunAttributes::default()
        }
    }

    #[test]
    fn on_the_level_sensors_read_the_contact_whatever_the_wheel_weighs() {
        for mass in [None, Some(4.0)] {
            let level = Slope::of(&run(0.0, mass)).unwrap();
            assert_eq!(level.normal_force(100.0), 100.0);
            assert_eq!(level.drawbar_pull(20.0), 20.0);
            assert_eq!(level.carried(100.0), 100.0);
        }
    }

    #[test]
    fn uphill_and_downhill_the_wheels_own_weight_is_taken_off_the_readings() {
        // 4 kg on 20°: 39.23 N, of which 2.37 N press no more and 13.42 N pull back.
        let uphill = Slope::of(&run(20.0, Some(4.0))).unwrap();
        assert!((uphill.normal_force(96.34) - 93.97).abs() < 0.01);
        assert!((uphill.drawbar_pull(10.0) - 23.42).abs() < 0.01);
        assert!((uphill.carried(100.0) - 93.97).abs() < 0.01);
        let downhill = Slope::of(&run(-20.0, Some(4.0))).unwrap();
        assert!((downhill.drawbar_pull(10.0) + 3.42).abs() < 0.01);
        assert_eq!(downhill.normal_force(96.34), uphill.normal_force(96.34));
    }

    #[test]
    fn on_a_slope_a_wheel_of_unknown_mass_has_unknown_forces() {
        assert_eq!(Slope::of(&run(-5.0, None)), None);
    }
}
