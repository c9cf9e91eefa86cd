//! How far an effect may be from the catalogue's law.
//!
//! No rig's effect has quite the form of the catalogue. Two signatures as alike as equivalent effects' are
//! held to be one effect's: by a cosine of 0.95, numbers that are off by a third of the change each.
//!
//! That is an error, but not one of chance. Where a resonance is better damped than the catalogue says,
//! the rest is some pattern of the same numbers, and of sixty other effects one is much like it. What a
//! second effect adds beside a first is therefore weighed as if all of the first one's error of form
//! lay along the second's signature, in each domain of each channel by itself: a second effect has to show
//! elsewhere, or by more than that. The two may stay apart in one channel where both are large.

use super::emulator::Emulated;
use super::product::{add, scaled};

/// Variance of each number by the error of form of these effects, of these strengths, whose law and true
/// one have a cosine of `alike`; of no pattern.
pub(super) fn scattered(emulated: &Emulated, effects: &[(usize, f64)], alike: f64) -> Vec<f64> {
    let mut variance = vec![0.0; emulated.cells.len()];
    for square in squares(emulated, effects) {
        add(&mut variance, share(alike), &square);
    }
    variance
}

/// The same where within a domain of a channel all of it may have one pattern.
pub(super) fn aligned(emulated: &Emulated, effects: &[(usize, f64)], alike: f64) -> Vec<f64> {
    let mut variance = vec![0.0; emulated.cells.len()];
    for square in squares(emulated, effects) {
        let mut sums = vec![0.0; square.len()];
        for (part, square) in emulated.parts.iter().zip(&square) {
            sums[*part] += square;
        }
        for (variance, part) in variance.iter_mut().zip(&emulated.parts) {
            *variance += share(alike) * sums[*part];
        }
    }
    variance
}

/// Each number's squared change, effect by effect.
fn squares(emulated: &Emulated, effects: &[(usize, f64)]) -> impl Iterator<Item = Vec<f64>> {
    effects.iter().map(|&(effect, strength)| {
        let change = emulated.shapes[effect].at(strength);
        scaled(&change, &change)
    })
}

/// Square of the error over that of the change [-].
fn share(alike: f64) -> f64 {
    1.0 / (alike * alike) - 1.0
}
