//! The paper's kinematic models of a rolling wheel's vibration (Section 2, Eq. 5-49), corrected
//! where they are misprinted, and the vibration on flat hard ground that all others are measured
//! against.
//!
//! They know the wheel's outline, the ground's height and nothing of forces: the wheel is rigid,
//! rolls without slipping and never leaves the ground. Its lugs are edges without thickness. The simulated ones are
//! plates: one of 3 mm whose end is all round lifts the axle by 1 % less than by (10), one with sharp edges by 16 % less,
//! for it reaches `(r + l - e) cos φ + (t/2 - e) |sin φ| + e` below the axle.
//!
//! Angles count as everywhere: the wheel angle grows when driving forward, lug 0 points straight
//! down at 0, and `φ`, the angle of a lug from straight down, is positive ahead, so that `φ`
//! falls as the wheel angle grows. The paper's `θ - ω t` is the wheel angle's negative.
//!
//! Heights `h` are those of the rim's lowest point above the reference surface, in every equation;
//! the axle lies `r` above. The printed equations mix the two.
//!
//! [`flat_ground`] is the reference terrain, [`mod@reference`] what an accelerometer feels on it.
//! [`outline`] lets a wheel down on any ground and [`rolling`] rolls it on (ALCT and SLCT);
//! [`soft_ground`] has lugs in soil (LEIS). [`simplified`] reduces all three to the reference with two
//! factors, [`harmonics`] the reference to its series, [`bounds`] the limits of the first.
//!
//! Against the rigid-body simulation of a wheel under 100 N, the axle's height on hard ground, flat
//! or rough, differs by the 11 µm by which that ground gives way, and its velocity jumps agree within
//! 1 %, early by the time that closing those 11 µm takes (3 ms at 10 mm/s).

pub mod bounds;
pub mod flat_ground;
pub mod harmonics;
pub mod outline;
pub mod reference;
pub mod rolling;
pub mod simplified;
pub mod soft_ground;

/// The wheel of the tests whose rim comes down between its lugs.
#[cfg(test)]
fn olig() -> crate::wheel::Wheel {
    crate::wheel::Wheel {
        lugs: Some(crate::wheel::Lugs {
            count: 6,
            height: 0.005,
            thickness: 0.003,
            edge_radius: None,
        }),
        ..crate::wheel::Wheel::single_wheel()
    }
}
