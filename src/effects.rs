//! Named deviations from the ideal experiment: each edits it by a magnitude with a neutral value.
//!
//! A simulator omits things: an eccentric axle, friction of a guide, moist sand, a tilted sensor. An
//! [`Effect`] names one of them, with what it edits, its magnitude in practice and its signature, and applies
//! it to a [`Setup`]. The simulation does not depend on effects: its parameters have ideal values, which an
//! effect changes. At its neutral value an effect changes no bit of a run.
//!
//! In a scenario file:
//!
//! ```toml
//! [[effect]]
//! name = "gain_error.drawbar_pull"   # on a channel, where an effect may sit on several
//! magnitude = 0.05                   # in the unit of the catalogue
//! ```
//!
//! [`catalogue`] lists them all.

mod application;
mod ground;
mod prior;
mod rig;
mod sensing;
mod soil;
mod wheel_and_drive;

pub(crate) use application::ApplicationTable;
pub use application::{Application, Form};
pub use prior::Prior;

use crate::quantity::RangeError;
use crate::sensors::Sensors;
use crate::simulation::rig::Rig;
use crate::terrain::TerrainSpec;
use crate::wheel::Wheel;
use serde::Serialize;

/// What an effect may edit: an experiment before it is built.
#[derive(Debug)]
pub struct Setup<'a> {
    /// The ground specified.
    pub terrain: &'a mut TerrainSpec,
    /// The wheel.
    pub wheel: &'a mut Wheel,
    /// Rig, load and drive.
    pub rig: &'a mut Rig,
    /// How it is measured.
    pub sensors: &'a mut Sensors,
}

/// A named departure from the ideal.
#[derive(Debug, Serialize)]
pub struct Effect {
    /// Its name, as in files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// What it edits: keys of a scenario, or a description.
    pub edits: &'static str,
    /// What it needs to be simulated again.
    pub stage: Stage,
    /// Where it may sit; the first is meant where none is named.
    pub seats: &'static [Seat],
    /// How it shows.
    pub signature: Signature,
    /// Names of the effects that show alike.
    pub confusers: &'static [&'static str],
    /// Whence levels and prior come.
    pub source: Source,
    /// How it acts.
    #[serde(skip)]
    pub law: Law,
    /// How it may act otherwise, at magnitudes of the same scale.
    pub other_form: Option<OtherForm>,
}

/// Edits a setup by a magnitude in the seat's unit, on the seat's channel.
///
/// # Errors
/// `EffectError::NotOn` and `EffectError::Needs` where the experiment has nothing to edit.
pub type Law = fn(&mut Setup, f64, Seated) -> Result<(), EffectError>;

/// The effect that a law belongs to, and the channel it sits on (empty where it sits on none).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seated {
    /// Name of the effect.
    pub effect: &'static str,
    /// Name of the channel.
    pub channel: &'static str,
}

/// Another way for an effect to act, for trials that must not recognise the own one.
#[derive(Debug, Serialize)]
pub struct OtherForm {
    /// What is different.
    pub description: &'static str,
    /// Channels on which it has no meaning.
    pub not_on: &'static [&'static str],
    /// How it acts.
    #[serde(skip)]
    pub law: Law,
}

/// A place of an effect: the channel it sits on, if it can sit on several, and its magnitudes there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Seat {
    /// Name of the channel; empty where there is no choice.
    pub channel: &'static str,
    /// Unit of the magnitude; `-` where it has none.
    pub unit: &'static str,
    /// Magnitude that changes nothing.
    pub neutral: f64,
    /// Least and largest magnitude.
    pub range: [f64; 2],
    /// Low, typical and high magnitude in practice.
    pub levels: [f64; 3],
    /// What is known of the magnitude before any measurement.
    pub prior: Prior,
}

/// Which part of an experiment has to run again when a magnitude changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The sensors only: the same motion can be measured again.
    Sensors,
    /// Ground, wheel or rig: the motion changes.
    Physics,
}

/// How an effect shows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Signature {
    /// The channels in which it shows most.
    pub channels: &'static [&'static str],
    /// What it is bound to.
    pub bound: Bound,
    /// How it depends on slip, speed, load or history.
    pub dependence: &'static str,
}

/// What a signature is bound to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// To the wheel's angle: orders of its turn.
    WheelAngle,
    /// To frequencies in hertz, whatever the speed.
    Frequency,
    /// To time or way since the start, or to former runs.
    History,
    /// To the operating condition: it changes levels and curves.
    Condition,
}

/// Whence the figures of an effect come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Published or measured figures.
    Cited(&'static str),
    /// No published value: the reasoning behind the guess.
    Guess(&'static str),
}

/// Why an effect cannot be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EffectError {
    /// No effect has that name.
    #[error("there is no effect `{name}`; did you mean {}?", quoted(near))]
    Unknown {
        /// The name given.
        name: String,
        /// Names like it, nearest first.
        near: Vec<&'static str>,
    },
    /// The effect does not sit on that channel.
    #[error(
        "the effect `{effect}` does not sit on `{channel}`; it sits on {}",
        quoted(channels)
    )]
    NoSeat {
        /// The effect.
        effect: &'static str,
        /// The channel given.
        channel: String,
        /// The channels it may sit on; none where it has no choice.
        channels: Vec<&'static str>,
    },
    /// The magnitude lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The effect makes no sense on that ground.
    #[error("the effect `{effect}` does not exist on {ground}")]
    NotOn {
        /// The effect.
        effect: &'static str,
        /// The ground.
        ground: &'static str,
    },
    /// The experiment lacks what the effect edits.
    #[error("the effect `{effect}` needs {what}")]
    Needs {
        /// The effect.
        effect: &'static str,
        /// What is missing.
        what: &'static str,
    },
    /// The effect acts in one way only.
    #[error("the effect `{effect}` has one form only; omit `form`")]
    OneForm {
        /// The effect, with its channel.
        effect: String,
    },
    /// A text is no `name=magnitude`.
    #[error(
        "`{text}` is no effect; write name=magnitude, for example gain_error.drawbar_pull=0.05"
    )]
    Malformed {
        /// The text.
        text: String,
    },
}

fn quoted(names: &[&str]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match names.as_slice() {
        [] => "no channel, so name none".to_owned(),
        names => names.join(", "),
    }
}

/// Every effect, by subject.
pub fn catalogue() -> impl Iterator<Item = &'static Effect> {
    [
        soil::EFFECTS,
        ground::EFFECTS,
        wheel_and_drive::EFFECTS,
        rig::EFFECTS,
        sensing::EFFECTS,
    ]
    .into_iter()
    .flatten()
}

/// Names of all effects but these, without channels.
pub fn names_but(these: &[&str]) -> Vec<String> {
    let others = catalogue().map(|effect| effect.name);
    let others = others.filter(|name| !these.contains(name));
    others.map(str::to_owned).collect()
}

/// The effect of that name, without a channel.
///
/// # Errors
/// `EffectError::Unknown` with the names like it.
pub fn find(name: &str) -> Result<&'static Effect, EffectError> {
    catalogue()
        .find(|effect| effect.name == name)
        .ok_or_else(|| EffectError::Unknown {
            name: name.to_owned(),
            near: names_like(name),
        })
}

/// The effect of a name, with the channel or without, and where it sits.
///
/// # Errors
/// Those of [`find`] and [`Effect::seat`].
pub fn seated(name: &str) -> Result<(&'static Effect, &'static Seat), EffectError> {
    let (stem, channel) = split(name);
    let effect = find(stem)?;
    Ok((effect, effect.seat(channel)?))
}

/// Where the effect of a name sits, with the channel or without.
///
/// # Errors
/// Those of [`seated`].
pub(crate) fn seat_of(name: &str) -> Result<&'static Seat, EffectError> {
    seated(name).map(|(_, seat)| seat)
}

/// The name of an effect with the channel that it sits on where none is named; as it is where no
/// effect has it.
pub(crate) fn full_name(name: &str) -> String {
    let (stem, _) = split(name);
    match seat_of(name) {
        Ok(seat) if !seat.channel.is_empty() => format!("{stem}.{}", seat.channel),
        _ => name.to_owned(),
    }
}

/// The effect's name and the channel's.
fn split(name: &str) -> (&str, Option<&str>) {
    match name.split_once('.') {
        Some((name, channel)) => (name, Some(channel)),
        None => (name, None),
    }
}

/// The three names most like this one.
fn names_like(name: &str) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = catalogue().map(|effect| effect.name).collect();
    let name = name.to_lowercase();
    let likeness = |known: &str| strsim::jaro_winkler(&name, known);
    names.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
    names.truncate(3);
    names
}

impl Seat {
    /// A seat without a choice of channel.
    const fn new(unit: &'static str, range: [f64; 2], levels: [f64; 3], prior: Prior) -> Self {
        Self {
            channel: "",
            unit,
            neutral: 0.0,
            range,
            levels,
            prior,
        }
    }

    /// The same on a channel.
    const fn on(self, channel: &'static str) -> Self {
        Self { channel, ..self }
    }
}

impl Effect {
    /// Where it sits on `channel`; on its first seat where none is named.
    ///
    /// # Errors
    /// `EffectError::NoSeat` with the channels it may sit on.
    pub fn seat(&self, channel: Option<&str>) -> Result<&'static Seat, EffectError> {
        let Some(channel) = channel else {
            return Ok(&self.seats[0]);
        };
        let choices = || self.seats.iter().filter(|seat| !seat.channel.is_empty());
        choices()
            .find(|seat| seat.channel == channel)
            .ok_or_else(|| EffectError::NoSeat {
                effect: self.name,
                channel: channel.to_owned(),
                channels: choices().map(|seat| seat.channel).collect(),
            })
    }
}
