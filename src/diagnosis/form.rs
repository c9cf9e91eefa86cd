//! How far an effect may be from the catalogue's law.
//!
//! No rig's effect has quite the form of the catalogue. It may have that law, one as like it as equivalent
//! effects' signatures are (by a cosine of 0.95 numbers are off by a third of the change), or another one that
//! moves the same domains of the same channels and hardly the same numbers. Each form is fitted by itself: what a
//! fit says of held-out conditions tells which it is, and the score of an effect is that of its forms together.
//! Half of the error goes with what the law changes, half over all of a domain of a channel, for another law may
//! move what this one leaves.
//!
//! It is an error, but not one of chance. Where a resonance is better damped than the catalogue says,
//! the rest is some pattern of the same numbers, and of sixty other effects one is much like it. What a
//! second effect adds beside a first is therefore weighed as if all of the first one's error of form
//! lay along the second's signature, in each domain of each channel by itself: a second effect has to show
//! elsewhere, or by more than that. The two may stay apart in one channel where both are large.

use super::emulator::Emulated;
use super::product::{add, scaled};

/// Cosine [-] of the catalogue's law and the true one, of each form.
pub(super) const OWN: f64 = 1.0;
pub(super) const NEAR: f64 = 0.95;
pub(super) const OTHER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Forms of one effect alone and of two, and how probable each is: a law from a textbook may be a rig's, and
/// is more often one like it than another.
pub(super) const ALONE: [(f64, f64); 3] = [(OWN, 0.6), (NEAR, 0.25), (OTHER, 0.15)];
pub(super) const PAIRED: [(f64, f64); 2] = [(OWN, 0.7), (NEAR, 0.3)];

/// Variance of each number by the error of form of these effects, of these strengths, whose law and true
/// one have a cosine of `alike`; of no pattern.
pub(super) fn scattered(emulated: &Emulated, effects: &[(usize, f64)], alike: f64) -> Vec<f64> {
    let mut variance = vec![0.0; emulated.cells.len()];
    for square in squares(emulated, effects) {
        let (sums, counts) = by_part(emulated, &square);
        add(&mut variance, 0.5 * share(alike), &square);
        for (variance, part) in variance.iter_mut().zip(&emulated.parts) {
            *variance += 0.5 * share(alike) * sums[*part] / counts[*part];
        }
    }
    variance
}

/// The same where within a domain of a channel all of it may have one pattern.
pub(super) fn aligned(emulated: &Emulated, effects: &[(usize, f64)], alike: f64) -> Vec<f64> {
    let mut variance = vec![0.0; emulated.cells.len()];
    for square in squares(emulated, effects) {
        let (sums, _) = by_part(emulated, &square);
        for (variance, part) in variance.iter_mut().zip(&emulated.parts) {
            *variance += share(alike) * sums[*part];
        }
    }
    variance
}

/// Sums over each domain of each channel, and how many numbers it has.
fn by_part(emulated: &Emulated, numbers: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut sums = vec![0.0; numbers.len()];
    let mut counts = sums.clone();
    for (part, number) in emulated.parts.iter().zip(numbers) {
        sums[*part] += number;
        counts[*part] += 1.0;
    }
    (sums, counts)
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
