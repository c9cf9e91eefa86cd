//! The motion of the wheel: an iterator of [`WheelState`].

pub mod rig;
pub mod stone_bed;
pub mod world;

/// Loads on the wheel in the plane of travel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Loads {
    /// Normal force `F_N` [N], upward.
    pub normal_force: f64,
    /// Drawbar pull `F_DP` [N], above 0 where the ground pulls the wheel forward.
    pub drawbar_pull: f64,
    /// Torque [N·m] about the axle, above 0 where the motor drives forward against the ground.
    pub driving_torque: f64,
}

/// Everything a sensor could see at one instant.
///
/// `x` runs forward along the track, `y` away from it; the wheel angle grows when driving forward.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelState {
    /// Time [s].
    pub time: f64,
    /// Position of the axle along the track [m].
    pub position: f64,
    /// Height of the axle above the track's datum [m].
    pub height: f64,
    /// Angle turned since the start [rad].
    pub wheel_angle: f64,
    /// Speed along the track [m/s].
    pub forward_speed: f64,
    /// Speed away from the track [m/s].
    pub vertical_speed: f64,
    /// Speed of rotation [rad/s].
    pub wheel_speed: f64,
    /// Acceleration along the track [m/s²].
    pub forward_acceleration: f64,
    /// Acceleration away from the track [m/s²]; gravity is not in it.
    pub vertical_acceleration: f64,
    /// Loads of the ground on the wheel.
    pub ground: Loads,
    /// Loads that pass from the wheel to its axle, as a transducer there feels them (tared):
    /// the ground's, less the wheel's inertia.
    pub hub: Loads,
    /// Depth of the rim's lowest point below the undisturbed surface [m].
    pub sinkage: f64,
    /// Whether the ground under the axle is soil that lugs can enter.
    pub on_soil: bool,
    /// Bit `i` is set while lug `i` carries more than 1 % of the commanded load.
    pub lugs_touching: u64,
    /// Bit `i` is set while the edge of lug `i` lies more than 1 mm below the undisturbed soil.
    pub lugs_entered: u64,
}
