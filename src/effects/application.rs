//! An effect at a magnitude.

use super::{Effect, EffectError, Seat, Seated, Setup, seated};
use crate::quantity::RangeError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// Which law an effect follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// The catalogue's own.
    #[default]
    Own,
    /// The catalogue's other form, for trials that must not recognise the own one.
    Other,
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Own => "own",
            Self::Other => "other",
        })
    }
}

/// An effect at a magnitude, on a channel where it may sit on several.
#[derive(Debug, Clone, Copy)]
pub struct Application {
    effect: &'static Effect,
    seat: &'static Seat,
    magnitude: f64,
    form: Form,
}

impl Application {
    /// The effect `name`, or `name.channel`, at `magnitude` in the seat's unit.
    ///
    /// # Errors
    /// `Unknown` with the names like it; `NoSeat` with the channels it sits on; `Range` with the
    /// range and unit of the magnitude.
    pub fn new(name: &str, magnitude: f64) -> Result<Self, EffectError> {
        let (effect, seat) = seated(name)?;
        if magnitude != seat.neutral {
            RangeError::check(effect.name, seat.unit, magnitude, seat.range)?;
        }
        Ok(Self {
            effect,
            seat,
            magnitude,
            form: Form::Own,
        })
    }

    /// The same in another form.
    ///
    /// # Errors
    /// `OneForm` where the catalogue has no other form on this channel.
    pub fn in_form(self, form: Form) -> Result<Self, EffectError> {
        let other = self.effect.other_form.as_ref();
        let has_other = other.is_some_and(|other| !other.not_on.contains(&self.seat.channel));
        if form == Form::Other && !has_other {
            return Err(EffectError::OneForm {
                effect: self.name(),
            });
        }
        Ok(Self { form, ..self })
    }

    /// The effect.
    pub fn effect(&self) -> &'static Effect {
        self.effect
    }

    /// Where it sits.
    pub fn seat(&self) -> &'static Seat {
        self.seat
    }

    /// Its magnitude in the seat's unit.
    pub fn magnitude(&self) -> f64 {
        self.magnitude
    }

    /// The law it follows.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Its name as in files: `effect`, or `effect.channel` where it has a choice.
    pub fn name(&self) -> String {
        match self.seat.channel {
            "" => self.effect.name.to_owned(),
            channel => format!("{}.{channel}", self.effect.name),
        }
    }

    /// Edits the setup.
    ///
    /// # Errors
    /// `NotOn` and `Needs` where the experiment has nothing for it to edit.
    pub fn apply(&self, setup: &mut Setup) -> Result<(), EffectError> {
        let law = match (self.form, &self.effect.other_form) {
            (Form::Other, Some(other)) => other.law,
            _ => self.effect.law,
        };
        let seated = Seated {
            effect: self.effect.name,
            channel: self.seat.channel,
        };
        law(setup, self.magnitude, seated)
    }
}

impl PartialEq for Application {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.magnitude == other.magnitude && self.form == other.form
    }
}

/// `name=magnitude`.
impl fmt::Display for Application {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={:?}", self.name(), self.magnitude)
    }
}

/// Reads `name=magnitude`.
impl FromStr for Application {
    type Err = EffectError;
    fn from_str(text: &str) -> Result<Self, EffectError> {
        let malformed = || EffectError::Malformed {
            text: text.to_owned(),
        };
        let (name, magnitude) = text.split_once('=').ok_or_else(malformed)?;
        let magnitude = magnitude.trim().parse().map_err(|_| malformed())?;
        Self::new(name.trim(), magnitude)
    }
}

/// Written as a `[[effect]]` of a scenario.
impl Serialize for Application {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        ApplicationTable {
            name: self.name(),
            magnitude: self.magnitude,
            form: self.form,
        }
        .serialize(serializer)
    }
}

/// A departure from the ideal rig.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ApplicationTable {
    /// Name of the effect, with its channel where it has one; see `lugwheel effects`.
    name: String,
    /// Magnitude in the effect's unit.
    magnitude: f64,
    /// Which law it follows.
    #[serde(default, skip_serializing_if = "is_own")]
    #[schemars(!skip_serializing_if)]
    form: Form,
}

fn is_own(form: &Form) -> bool {
    *form == Form::Own
}

impl ApplicationTable {
    /// # Errors
    /// Those of [`Application::new`] and [`Application::in_form`], with the key to blame.
    pub(crate) fn read(&self) -> Result<Application, (&'static str, EffectError)> {
        let key = |error: &EffectError| match error {
            EffectError::Range(_) => "magnitude",
            _ => "name",
        };
        Application::new(&self.name, self.magnitude)
            .map_err(|error| (key(&error), error))?
            .in_form(self.form)
            .map_err(|error| ("form", error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        text.parse::<Application>().unwrap_err().to_string()
    }

    #[test]
    fn an_application_comes_back_from_its_own_words() {
        for text in ["gain_error.drawbar_pull=0.05", "clock_error=-0.001"] {
            let application: Application = text.parse().unwrap();
            assert_eq!(application.to_string(), text);
        }
    }

    #[test]
    fn an_effect_that_may_sit_on_several_channels_has_one_where_none_is_named() {
        let application: Application = "gain_error=0.05".parse().unwrap();
        assert_eq!(application.name(), "gain_error.drawbar_pull");
    }

    #[test]
    fn a_rejected_effect_has_a_remedy() {
        let error = message("gain_eror=0.05");
        assert!(error.contains("did you mean `gain_error`"), "{error}");
        let error = message("gain_error.sinkages=0.05");
        assert!(error.contains("it sits on `drawbar_pull`, "), "{error}");
        let error = message("clock_error.sinkage=0.01");
        assert!(error.contains("it sits on no channel"), "{error}");
        let error = message("gain_error=5");
        assert_eq!(error, "gain_error [-] must be in [-0.5, 0.5], got 5");
        assert!(message("gain_error").contains("write name=magnitude"));
    }
}
