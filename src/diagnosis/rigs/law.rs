//! Randomised laws: effects that act otherwise than the catalogue states.
//!
//! A real effect seldom follows the law of the catalogue. Two departures stand for the many that may be: from condition to
//! condition the size differs by a random amount, as if it depended on load, speed or slip otherwise; and in the course of
//! a run the change of every sample is multiplied by a slow random wave, as if the effect came and went,
//!
//! ```text
//! y = x + exp(a cos(2π k t / T + φ)) (x' − x)
//! ```
//!
//! with the samples `x` without the effect, `x'` with it, and a run of length `T`. The second needs one motion, so it is
//! for effects of the sensors. The other forms of the catalogue are no such laws: they are for trials.

use crate::trace::Trace;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Standard deviation of the change of size from condition to condition.
const BY_CONDITION: f64 = 0.2;
/// Conditions for which a change is drawn; further ones begin again.
const CONDITIONS: usize = 16;
/// Largest amplitude `a` [-], and waves `k` in a run.
const AMPLITUDE: f64 = 1.0;
const WAVES: [f64; 2] = [0.25, 3.0];

/// One such law.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    by_condition: [f64; CONDITIONS],
    amplitude: f64,
    waves: f64,
    phase: f64,
}

impl Law {
    /// A random one.
    pub fn draw(rng: &mut impl Rng) -> Self {
        Self {
            by_condition: std::array::from_fn(|_| {
                let drawn: f64 = StandardNormal.sample(rng);
                BY_CONDITION * drawn
            }),
            amplitude: AMPLITUDE * rng.random::<f64>(),
            waves: rng.random_range(WAVES[0]..WAVES[1]),
            phase: TAU * rng.random::<f64>(),
        }
    }

    /// Size [-] in a condition of an effect of this size.
    pub fn size(&self, size: f64, condition: usize) -> f64 {
        size + self.by_condition[condition % CONDITIONS]
    }

    /// Multiplies how `trace` differs from `without` by the wave.
    pub fn modulate(&self, trace: &mut Trace, without: &Trace) {
        for channel in &mut trace.channels {
            let Some(ideal) = without.channel(&channel.name) else {
                continue;
            };
            let count = channel.samples.len() as f64;
            let pairs = channel.samples.iter_mut().zip(&ideal.samples);
            for (place, (sample, ideal)) in pairs.enumerate() {
                // What is equal stays, bit by bit.
                if sample != ideal {
                    let turn = TAU * self.waves * place as f64 / count + self.phase;
                    let factor = libm::exp(self.amplitude * libm::cos(turn));
                    *sample = ideal + factor * (*sample - ideal);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use crate::trace::Channel;

    fn trace(value: f64) -> Trace {
        Trace {
            channels: vec![Channel {
                name: "normal_force".to_owned(),
                unit: "N".to_owned(),
                sample_rate: 10.0,
                start: 0.0,
                samples: vec![value; 50],
            }],
            ..Trace::default()
        }
    }

    #[test]
    fn a_change_grows_and_shrinks_and_keeps_its_sign_and_what_is_equal_stays() {
        let law = Law::draw(&mut Seed(1).rng("law", 0));
        let mut modulated = trace(3.0);
        law.modulate(&mut modulated, &trace(2.0));
        let samples = &modulated.channels[0].samples;
        let largest = libm::exp(AMPLITUDE);
        assert!(samples.iter().all(|x| *x > 2.0 && *x <= 2.0 + largest));
        assert!(samples.iter().any(|x| (x - samples[0]).abs() > 0.01));
        let mut equal = trace(2.0);
        law.modulate(&mut equal, &trace(2.0));
        assert_eq!(equal, trace(2.0));
    }
}
