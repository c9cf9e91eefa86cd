//! One way in which a scenario may be wrong: parameters off their values, effects left out.
//!
//! As text: `soil_cohesion~0.13 slip_sinkage=0.8 low_pass.normal_force=150.0:other`, parameters with
//! their offsets first, then effects with their magnitudes; `as_shipped` where there is nothing.

use super::condition::Case;
use super::parameter::{Offsets, Parameter};
use crate::effects::{Application, EffectError, Form};
use crate::scenario::{OutOfRange, Scenario};
use crate::wheel::Lugs;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// How an arm without departures reads.
const AS_SHIPPED: &str = "as_shipped";

/// How an effect's other form ends.
const OTHER: &str = ":other";

/// Departures from a scenario.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arm {
    offsets: Offsets,
    /// By name, each once, none neutral.
    effects: Vec<Application>,
}

/// A text that is no arm.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArmError {
    /// No parameter has that name.
    #[error("there is no parameter `{0}`")]
    NoParameter(String),
    /// An offset is no finite number.
    #[error("`{0}` is no offset; write parameter~number, for example soil_cohesion~0.1")]
    NoOffset(String),
    /// An effect is not as it should be.
    #[error(transparent)]
    Effect(#[from] EffectError),
}

impl Arm {
    /// The scenario as it is.
    pub fn as_shipped() -> Self {
        Self::default()
    }

    /// Parameters off their values, and no effect.
    pub fn of_offsets(offsets: Offsets) -> Self {
        Self {
            offsets,
            effects: Vec::new(),
        }
    }

    /// This arm with one more effect, or another magnitude of one that it has. At its neutral
    /// magnitude an effect changes nothing and is left out.
    pub fn with_effect(mut self, effect: Application) -> Self {
        let name = effect.name();
        self.effects.retain(|known| known.name() != name);
        if effect.magnitude() != effect.seat().neutral {
            self.effects.push(effect);
            self.effects.sort_by_key(Application::name);
        }
        self
    }

    /// Parameters off their values.
    pub fn offsets(&self) -> &Offsets {
        &self.offsets
    }

    /// The effects, by name.
    pub fn effects(&self) -> &[Application] {
        &self.effects
    }

    /// The scenario of a case with these departures.
    ///
    /// # Errors
    /// `OutOfRange` where a parameter leaves its physical range.
    pub fn scenario(&self, case: &Case) -> Result<Scenario, OutOfRange> {
        self.of(&case.scenario, case.attributes.lug_count)
    }

    /// A scenario with these departures; an effect that the scenario has gets the arm's magnitude.
    ///
    /// Lugs that an effect puts on a smooth wheel are as many as the measured wheel has, where it
    /// is known to have any.
    ///
    /// # Errors
    /// `OutOfRange` where a parameter leaves its physical range.
    pub fn of(
        &self,
        scenario: &Scenario,
        measured_lugs: Option<u32>,
    ) -> Result<Scenario, OutOfRange> {
        let mut scenario = scenario.clone();
        self.offsets.apply(&mut scenario);
        scenario.check()?;
        let named = |name: String| move |known: &Application| known.name() == name;
        for effect in &self.effects {
            if let Some(lugs) = new_lugs(effect, &scenario, measured_lugs) {
                scenario.wheel.lugs = Some(lugs);
            } else if let Some(at) = scenario.effects.iter().position(named(effect.name())) {
                scenario.effects[at] = *effect;
            } else {
                scenario.effects.push(*effect);
            }
        }
        Ok(scenario)
    }
}

/// Lugs of the measured wheel's number where the effect would put its own on a smooth wheel.
fn new_lugs(effect: &Application, scenario: &Scenario, count: Option<u32>) -> Option<Lugs> {
    let is_it = effect.effect().name == "lug_action" && effect.form() == Form::Own;
    let count = count.filter(|count| *count > 0)?;
    if !is_it || scenario.wheel.lugs.is_some() {
        return None;
    }
    let mut lugged = scenario.clone();
    lugged.effects = vec![*effect];
    let lugs = lugged.experiment().ok()?.wheel.lugs?;
    Some(Lugs { count, ..lugs })
}

impl fmt::Display for Arm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let offsets = self.offsets.iter();
        let offsets = offsets.map(|(name, offset)| format!("{name}~{offset:?}"));
        let effects = self.effects.iter().map(|effect| match effect.form() {
            Form::Own => effect.to_string(),
            Form::Other => format!("{effect}{OTHER}"),
        });
        let words: Vec<String> = offsets.chain(effects).collect();
        if words.is_empty() {
            f.write_str(AS_SHIPPED)
        } else {
            f.write_str(&words.join(" "))
        }
    }
}

impl FromStr for Arm {
    type Err = ArmError;

    fn from_str(text: &str) -> Result<Self, ArmError> {
        let mut arm = Self::default();
        for word in text.split_whitespace().filter(|word| *word != AS_SHIPPED) {
            if let Some((name, offset)) = word.split_once('~') {
                let parameter =
                    Parameter::find(name).ok_or_else(|| ArmError::NoParameter(name.to_owned()))?;
                let offset = offset
                    .parse()
                    .ok()
                    .filter(|offset: &f64| offset.is_finite());
                let offset = offset.ok_or_else(|| ArmError::NoOffset(word.to_owned()))?;
                arm.offsets = arm.offsets.with(parameter, offset);
                continue;
            }
            let (word, form) = match word.strip_suffix(OTHER) {
                Some(word) => (word, Form::Other),
                None => (word, Form::Own),
            };
            let effect: Application = word.parse()?;
            arm = arm.with_effect(effect.in_form(form)?);
        }
        Ok(arm)
    }
}

impl Serialize for Arm {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::parameter::PARAMETERS;
    use crate::effects::catalogue;
    use proptest::collection::vec;
    use proptest::prelude::*;
    use proptest::sample::select;

    /// An effect on any seat, between its levels, in any form it has.
    fn any_effect() -> impl Strategy<Value = Application> {
        let effects: Vec<_> = catalogue().collect();
        let parts = (select(effects), 0_usize..8, 0.0..1.0_f64, any::<bool>());
        parts.prop_map(|(effect, seat, share, other)| {
            let seat = &effect.seats[seat % effect.seats.len()];
            let [low, _, high] = seat.levels;
            let name = [effect.name, seat.channel].join(".");
            let magnitude = low + share * (high - low);
            let own = Application::new(name.trim_end_matches('.'), magnitude).unwrap();
            if other {
                own.in_form(Form::Other).unwrap_or(own)
            } else {
                own
            }
        })
    }

    fn any_arm() -> impl Strategy<Value = Arm> {
        let offsets = vec((0..PARAMETERS.len(), -1.0..1.0_f64), 0..4);
        (offsets, vec(any_effect(), 0..4)).prop_map(|(offsets, effects)| {
            let offsets = offsets
                .into_iter()
                .fold(Offsets::default(), |offsets, (at, offset)| {
                    offsets.with(&PARAMETERS[at], offset)
                });
            let arm = Arm::of_offsets(offsets);
            effects.into_iter().fold(arm, Arm::with_effect)
        })
    }

    proptest! {
        #[test]
        fn every_arm_comes_back_from_its_own_words(arm in any_arm()) {
            prop_assert_eq!(arm.to_string().parse(), Ok(arm));
        }
    }

    #[test]
    fn an_arm_does_not_depend_on_the_order_of_its_words() {
        let read = |text: &str| text.parse::<Arm>().unwrap();
        let arm = read("low_pass.normal_force=150.0:other soil_cohesion~0.13 slip_sinkage=0.8");
        let text = "soil_cohesion~0.13 low_pass.normal_force=150.0:other slip_sinkage=0.8";
        assert_eq!(arm.to_string(), text);
        assert_eq!(arm, read(text));
    }

    #[test]
    fn nothing_and_what_changes_nothing_is_the_scenario_as_shipped() {
        for text in [
            "",
            "as_shipped",
            "soil_cohesion~0",
            "clock_error=0",
            "low_pass=inf",
        ] {
            let arm: Arm = text.parse().unwrap();
            assert_eq!(arm, Arm::as_shipped(), "{text}");
            assert_eq!(arm.to_string(), AS_SHIPPED);
        }
    }

    #[test]
    fn a_text_that_is_no_arm_says_why() {
        let message = |text: &str| text.parse::<Arm>().unwrap_err().to_string();
        assert_eq!(message("soil_moon~1"), "there is no parameter `soil_moon`");
        assert!(message("soil_cohesion~x").starts_with("`soil_cohesion~x` is no offset"));
        assert!(message("slip_sink=1").contains("did you mean `slip_sinkage`"));
    }
}
