//! The paper's kinematic models of a rolling wheel's vibration (Section 2, Eq. 5-49), corrected
//! where they are misprinted, and the vibration on flat hard ground that all others are measured
//! against.
//!
//! They know the wheel's outline, the ground's height and nothing of forces: the wheel is rigid,
//! rolls without slipping and never leaves the ground.
//!
//! Angles count as everywhere: the wheel angle grows when driving forward, lug 0 points straight
//! down at 0, and `φ`, the angle of a lug from straight down, is positive ahead, so that `φ`
//! falls as the wheel angle grows. The paper's `θ - ω t` is the wheel angle's negative.
//!
//! Heights `h` are those of the rim's lowest point above the reference surface, in every equation;
//! the axle lies `r` above. The printed equations mix the two.

pub mod bounds;
pub mod flat_ground;
pub mod harmonics;
pub mod outline;
pub mod reference;
pub mod rolling;
pub mod simplified;
pub mod soft_ground;
