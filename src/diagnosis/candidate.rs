//! Effects that may be the cause, and how large they may be.

use super::arm::Arm;
use super::bank::is_possible;
use super::condition::Case;
use crate::effects::{Application, Effect, EffectError, Seat, Stage, catalogue};

/// An effect on a seat.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    /// The effect.
    pub effect: &'static Effect,
    /// Where it sits.
    pub seat: &'static Seat,
}

impl Candidate {
    /// Name of the effect with its channel, as in files.
    pub fn name(&self) -> String {
        match self.seat.channel {
            "" => self.effect.name.to_owned(),
            channel => format!("{}.{channel}", self.effect.name),
        }
    }

    /// Whether the wheel moves otherwise, or only what sensors read of it is other.
    pub fn changes_motion(&self) -> bool {
        self.effect.stage == Stage::Physics
    }

    /// Magnitude of a size: the low level at 0, the high level at 1, geometric between levels of one sign; within the
    /// seat's range.
    pub fn magnitude(&self, size: f64) -> f64 {
        let [low, _, high] = self.seat.levels;
        let magnitude = if low * high > 0.0 {
            low * libm::pow(high / low, size)
        } else {
            low + size * (high - low)
        };
        let [least, largest] = self.seat.range;
        magnitude.clamp(least, largest)
    }

    /// How many times farther from neutral the high level is than the low one; with a neutral value at infinity, in the
    /// reciprocal.
    pub fn growth(&self) -> f64 {
        let [low, _, high] = self.seat.levels;
        let neutral = self.seat.neutral;
        if neutral.is_finite() {
            ((high - neutral) / (low - neutral)).abs()
        } else {
            (low / high).abs()
        }
    }

    /// The effect at a size.
    ///
    /// # Errors
    /// Those of [`Application::new`].
    pub fn application(&self, size: f64) -> Result<Application, EffectError> {
        Application::new(&self.name(), self.magnitude(size))
    }
}

/// Every effect on every seat that the cases can have at all its levels, and whose channel was measured, but for those of
/// the scenario.
pub fn candidates(cases: &[Case]) -> Vec<Candidate> {
    let seats = catalogue().flat_map(|effect| {
        let seats = effect.seats.iter();
        seats.map(move |seat| Candidate { effect, seat })
    });
    seats
        .filter(|candidate| is_open(candidate, cases))
        .filter(|candidate| {
            let arms = candidate.seat.levels.iter().map(|level| {
                let effect = Application::new(&candidate.name(), *level).ok()?;
                Some(Arm::as_shipped().with_effect(effect))
            });
            arms.collect::<Option<Vec<Arm>>>().is_some_and(|arms| {
                let mut everywhere = cases.iter();
                everywhere.all(|case| arms.iter().all(|arm| is_possible(arm, case)))
            })
        })
        .collect()
}

fn is_open(candidate: &Candidate, cases: &[Case]) -> bool {
    let channel = candidate.seat.channel;
    let is_of_scenario = |case: &Case| {
        let mut known = case.scenario.effects.iter();
        known.any(|known| known.name() == candidate.name())
    };
    let is_measured = channel.is_empty() || cases.iter().any(|case| case.has(channel));
    is_measured && !cases.iter().any(is_of_scenario)
}

impl Candidate {
    /// Whether it is none of these, effects with or without their channel.
    pub fn is_none_of(&self, names: &[String]) -> bool {
        let own = [self.effect.name.to_owned(), self.name()];
        !names.iter().any(|name| own.contains(name))
    }
}
