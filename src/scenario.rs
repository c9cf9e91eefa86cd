//! One experiment as a file: read, checked, edited.
//!
//! A file is a TOML text that starts with `version = 1`. Unknown keys are refused, every value is
//! checked against its physical range, and an error points at the line that holds it:
//!
//! ```
//! use lugwheel::scenario::Scenario;
//!
//! let text = "version = 1\nduration = -3.0 # s\n";
//! let error = Scenario::from_toml(text, "short.toml").unwrap_err();
//! assert!(error.to_string().starts_with("short.toml:1:1: missing field `terrain`"));
//! ```

pub(crate) mod caught;
pub mod experiment;
pub mod extensions;
pub mod keys;
pub mod ready;
pub mod recording;
mod reference;
pub mod schema;

use crate::document::{Document, Fault, Misfit, check_version};
use crate::effects::{Application, ApplicationTable, full_name};
use crate::quantity::GRAVITY;
use crate::quantity::{RangeError, SampleRate};
use crate::sensors::Sensors;
use crate::simulation::rig::{Rig, RigError, RigTable};
use crate::terrain::TerrainSpec;
use crate::trace::truth::PAPER_WINDOW;
use crate::wheel::{Wheel, WheelTable};
use ready::ReadyDocument;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use toml::de::DeValue;

/// The version of scenario files that this program reads and writes.
const VERSION: i64 = 1;
/// Longest way [m] of a run: beyond it a speed is more likely a wrong unit.
const LONGEST_WAY: f64 = 100.0;
/// Longest way into a run [s] that is not recorded.
const LONGEST_LEAD_IN: f64 = 1.0e4;
/// Most steps of a run: about an hour of computing.
const MOST_STEPS: f64 = 1.0e9;
/// Slowest steps [Hz] at which contact with the ground is still resolved.
const SLOWEST: f64 = 4_000.0;

/// One experiment.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Scenario {
    /// Version of the format: 1.
    version: i64,
    /// Duration of the run \[s\].
    pub duration: f64,
    /// Time \[s\] the wheel drives before the record begins: until it has sunk in and runs steadily.
    #[serde(skip_serializing_if = "is_zero")]
    #[schemars(default)]
    pub lead_in: f64,
    /// Integration rate \[Hz\]: time steps of the simulation per second, at least 4000 and a divisor of the sensor
    /// rate; the terrain's own rate if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub physics_rate: Option<SampleRate>,
    /// Length \[s\] of the windows in which the run is labelled; if absent 15 s, or the whole of a shorter run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window: Option<f64>,
    /// The ground.
    pub terrain: TerrainSpec,
    /// The wheel.
    pub wheel: Wheel,
    /// What holds, loads and drives the wheel.
    pub rig: Rig,
    /// How the run is measured.
    #[schemars(default)]
    pub sensors: Sensors,
    /// Departures from what stands above; see [`Scenario::experiment`].
    #[serde(rename = "effect", skip_serializing_if = "Vec::is_empty")]
    #[schemars(default, with = "Vec<ApplicationTable>")]
    pub effects: Vec<Application>,
    #[serde(skip)]
    source: Source,
}

/// Where a scenario comes from.
#[derive(Debug, Clone)]
struct Source {
    file: String,
    text: String,
}

/// A scenario file before its checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScenarioTable {
    version: i64,
    duration: f64,
    #[serde(default)]
    lead_in: f64,
    physics_rate: Option<SampleRate>,
    window: Option<f64>,
    terrain: TerrainSpec,
    wheel: WheelTable,
    rig: RigTable,
    #[serde(default)]
    sensors: Sensors,
    #[serde(default)]
    effect: Vec<ApplicationTable>,
}

impl Scenario {
    /// Reads a scenario from its text; `file` is its name in messages.
    ///
    /// # Errors
    /// `ScenarioError::Invalid` points at the line of the first fault: text that is not TOML,
    /// unknown or missing keys, and values outside their range.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ScenarioError> {
        read(text, file).map_err(|misfit| Fault::new(file, text, misfit).into())
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    /// `ScenarioError::Unreadable` where there is no such text file; else as
    /// [`Scenario::from_toml`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ScenarioError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| ScenarioError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        Self::from_toml(&text, &path.display().to_string())
    }

    /// A scenario that is part of the program.
    ///
    /// # Errors
    /// As [`Scenario::from_toml`]; never for one of [`ready::scenarios`].
    pub fn ready(document: &ReadyDocument) -> Result<Self, ScenarioError> {
        Self::from_toml(document.text, &format!("{}.toml", document.name))
    }

    /// This scenario with one key set, as in `rig.single_wheel.slip=0.3`; the rest of its text
    /// stays as written. A value that is not TOML is taken for a string. The key of an effect is
    /// its name, as in `effect.gain_error.drawbar_pull=0.05`.
    ///
    /// # Errors
    /// `ScenarioError::Assignment` where the text is no `key=value` or the key is a whole table;
    /// `ScenarioError::Invalid` where the edited scenario is no scenario, with the keys that
    /// resemble an unknown one.
    pub fn with(&self, assignment: &str) -> Result<Self, ScenarioError> {
        self.with_all(&[assignment])
    }

    /// This scenario with several keys set together: only the outcome of all has to be sound.
    ///
    /// # Errors
    /// Those of [`Scenario::with`].
    pub fn with_all(&self, assignments: &[impl AsRef<str>]) -> Result<Self, ScenarioError> {
        let mut text = self.source.text.clone();
        for assignment in assignments {
            text = assigned(&text, assignment.as_ref())?;
        }
        let list: Vec<&str> = assignments.iter().map(AsRef::as_ref).collect();
        let file = match list.as_slice() {
            [] => self.source.file.clone(),
            list => format!("{} with {}", self.source.file, list.join(", ")),
        };
        Self::from_toml(&text, &file).map_err(|error| self.with_hint(error, &list))
    }

    /// This scenario with one more effect, or with another magnitude of one that it has.
    ///
    /// # Errors
    /// `ScenarioError::Invalid` where this scenario has nothing for the effect to edit.
    pub fn with_effect(&self, effect: &Application) -> Result<Self, ScenarioError> {
        let scenario = self.with(&format!("effect.{effect}"))?;
        let known = |known: &Application| known.name() == effect.name();
        match scenario.effects.iter().position(known) {
            Some(index) if scenario.effects[index].form() != effect.form() => {
                scenario.with(&format!("effect.{index}.form={}", effect.form()))
            }
            _ => Ok(scenario),
        }
    }

    /// Adds to a fault the keys of this scenario that resemble an unknown one.
    fn with_hint(&self, error: ScenarioError, assignments: &[&str]) -> ScenarioError {
        let (ScenarioError::Invalid(fault), Ok(document)) =
            (&error, Document::parse(&self.source.text))
        else {
            return error;
        };
        let keys = assignments.iter().filter_map(|text| split_assignment(text));
        let mut keys = keys
            .map(|(key, _)| key)
            .filter(|key| effect_name(key).is_none());
        let is_short = |key: &str| {
            let is_unknown = fault.message.starts_with(&format!("unknown field `{key}`"));
            is_unknown && document.has_key_ending_in(key)
        };
        match keys.find(|key| !document.has_table_of(key) || is_short(key)) {
            Some(key) => fault.clone().with_hint(&document.keys_like(key)).into(),
            None => error,
        }
    }

    /// The text this scenario was read from, with every key set by [`Scenario::with`].
    ///
    /// Fields changed in memory are not in it: [`Scenario::to_toml`] has those.
    pub fn text(&self) -> &str {
        &self.source.text
    }

    /// This scenario as a file, without comments.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a scenario holds tables, numbers and names only")
    }

    /// Steps per second of the simulation \[Hz\]: the scenario's, or the terrain's default.
    pub fn physics_rate(&self) -> SampleRate {
        self.physics_rate
            .unwrap_or_else(|| default_physics_rate(&self.terrain))
    }

    /// Length \[s\] of the windows in which the run is labelled: the scenario's, or
    /// 15 s, or the whole of a shorter run.
    pub fn window(&self) -> f64 {
        self.window.unwrap_or(PAPER_WINDOW.min(self.duration))
    }

    /// Time \[s\] the wheel drives: the lead-in and the record.
    pub fn driven(&self) -> f64 {
        self.lead_in + self.duration
    }

    /// Checks every value, alone and against the others.
    ///
    /// # Errors
    /// `OutOfRange` names the first value that has no meaning, and where it stands.
    pub fn check(&self) -> Result<(), OutOfRange> {
        let at = |path: &str| {
            let path = path.to_owned();
            move |error| OutOfRange { path, error }
        };
        RangeError::positive("duration", "s", self.duration).map_err(at("duration"))?;
        self.check_samples().map_err(at("duration"))?;
        RangeError::check("lead-in", "s", self.lead_in, [0.0, LONGEST_LEAD_IN])
            .map_err(at("lead_in"))?;
        RangeError::positive("window", "s", self.window()).map_err(at("window"))?;
        self.check_terrain()?;
        self.wheel.checked().map_err(at("wheel"))?;
        self.rig.check().map_err(at(self.rig.path()))?;
        self.sensors.check().map_err(at("sensors"))?;
        self.check_window().map_err(at("window"))?;
        self.check_physics_rate().map_err(at("physics_rate"))?;
        self.check_steps().map_err(at("duration"))?;
        self.rig
            .check_rate(&self.wheel, self.physics_rate())
            .map_err(at(self.rig.path()))?;
        self.check_mass().map_err(at(self.rig.path()))?;
        let drive = self.rig.path();
        self.check_way()
            .map_err(at(&format!("{drive}.forward_speed")))?;
        self.check_turned_way()
            .map_err(at(&match self.rig.drive().slip {
                Some(_) => format!("{drive}.slip"),
                None => format!("{drive}.wheel_speed"),
            }))
    }

    fn check_terrain(&self) -> Result<(), OutOfRange> {
        if let TerrainSpec::Sequence(sections) = &self.terrain {
            for (index, section) in sections.iter().enumerate() {
                let path = format!("terrain.sequence.{index}");
                section
                    .check()
                    .map_err(|error| OutOfRange { path, error })?;
            }
        }
        let path = match self.terrain {
            TerrainSpec::Sequence(_) => "terrain.sequence".to_owned(),
            _ => "terrain".to_owned(),
        };
        self.terrain
            .check()
            .map_err(|error| OutOfRange { path, error })
    }

    fn check_window(&self) -> Result<(), RangeError> {
        let Self { duration, .. } = *self;
        limit("window", "s", self.window(), duration, "the run's duration")
    }

    fn check_physics_rate(&self) -> Result<(), RangeError> {
        let (sensors, physics) = (self.sensors.rate.whole(), self.physics_rate().whole());
        RangeError::check(
            "physics rate",
            "Hz",
            f64::from(physics),
            [SLOWEST, f64::INFINITY],
        )?;
        if sensors.is_multiple_of(physics) {
            return Ok(());
        }
        let divides = |rate: &u32| sensors.is_multiple_of(*rate);
        let slower = (1..physics.min(sensors)).rev().find(divides);
        let faster = (physics..=sensors).find(divides);
        let choices: Vec<String> = slower.iter().chain(&faster).map(u32::to_string).collect();
        let choices = choices.join(" or ");
        Err(RangeError {
            quantity: "physics rate",
            unit: "Hz",
            range: format!("a divisor of the sensors' {sensors} Hz, for example {choices}"),
            value: f64::from(physics),
        })
    }

    fn check_steps(&self) -> Result<(), RangeError> {
        let rate = self.physics_rate().hertz();
        let reason = format!("{MOST_STEPS} steps at {rate} Hz; lower it or the physics rate");
        limit(
            "lead-in + duration",
            "s",
            self.driven(),
            MOST_STEPS / rate,
            &reason,
        )
    }

    /// A record has two samples.
    fn check_samples(&self) -> Result<(), RangeError> {
        let rate = self.sensors.output_rate.hertz();
        let least = 2.0 / rate;
        if self.duration >= least {
            return Ok(());
        }
        Err(RangeError {
            quantity: "duration",
            unit: "s",
            range: format!("{least} or more (two samples at {rate} Hz)"),
            value: self.duration,
        })
    }

    /// A leg carries more than its wheel weighs.
    fn check_leg(&self, load: f64) -> Result<(), RangeError> {
        let weight = self.wheel.mass * GRAVITY;
        if load > weight {
            return Ok(());
        }
        Err(RangeError {
            quantity: "vertical load",
            unit: "N",
            range: format!("above the wheel's own weight of {weight:.1} N"),
            value: load,
        })
    }

    fn check_mass(&self) -> Result<(), RangeError> {
        let rig = match self.rig {
            Rig::SingleWheel(rig) => rig,
            Rig::RoverLeg(leg) => return self.check_leg(leg.load),
        };
        if rig.moving_mass >= self.wheel.mass {
            return Ok(());
        }
        Err(RangeError {
            quantity: "moving mass",
            unit: "kg",
            range: format!(
                "the wheel's {} kg or more, as it moves too",
                self.wheel.mass
            ),
            value: rig.moving_mass,
        })
    }

    fn check_way(&self) -> Result<(), RangeError> {
        let fastest = LONGEST_WAY / self.driven();
        let speed = self.rig.drive().forward_speed;
        let reason = format!("{LONGEST_WAY} m in {} s; speeds are in m/s", self.driven());
        limit("forward speed", "m/s", speed, fastest, &reason)
    }

    fn check_turned_way(&self) -> Result<(), RangeError> {
        let Wheel { radius, .. } = self.wheel;
        let fastest = LONGEST_WAY / self.driven() / radius;
        let speed = self.rig.drive().full_wheel_speed(radius)?;
        let reason = format!("{LONGEST_WAY} m of rim in {} s", self.driven());
        limit("wheel speed", "rad/s", speed, fastest, &reason)
    }
}

impl ScenarioTable {
    fn into_scenario(self, document: &Document, source: Source) -> Result<Scenario, Misfit> {
        let path = self.rig.path();
        let rig = self.rig.into_rig().map_err(|error| Misfit {
            place: document.place(&match error {
                RigError::TwoWheelSpeeds => format!("{path}.wheel_speed"),
                _ => path.to_owned(),
            }),
            message: error.to_string(),
        })?;
        let effects = read_effects(&self.effect, document)?;
        Ok(Scenario {
            version: self.version,
            duration: self.duration,
            lead_in: self.lead_in,
            physics_rate: self.physics_rate,
            window: self.window,
            terrain: self.terrain,
            wheel: self.wheel.into_wheel(),
            rig,
            sensors: self.sensors,
            effects,
            source,
        })
    }
}

/// The effects of a scenario, each given once.
fn read_effects(
    tables: &[ApplicationTable],
    document: &Document,
) -> Result<Vec<Application>, Misfit> {
    let mut effects: Vec<Application> = Vec::new();
    for (index, table) in tables.iter().enumerate() {
        let misfit = |key: &str, message: String| Misfit {
            place: document.place(&format!("effect.{index}.{key}")),
            message,
        };
        let effect = table
            .read()
            .map_err(|(key, error)| misfit(key, error.to_string()))?;
        let name = effect.name();
        if effects.iter().any(|known| known.name() == name) {
            let message = format!("the effect `{name}` is given twice; keep one of them");
            return Err(misfit("name", message));
        }
        effects.push(effect);
    }
    Ok(effects)
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn read(text: &str, file: &str) -> Result<Scenario, Misfit> {
    let document = Document::parse(text)?;
    check_version(&document, "scenario", VERSION)?;
    let table: ScenarioTable = document.read()?;
    let source = Source {
        file: file.to_owned(),
        text: text.to_owned(),
    };
    let scenario = table.into_scenario(&document, source)?;
    scenario
        .check()
        .map_err(|OutOfRange { path, error }| Misfit {
            place: document.place_of(&path, &error),
            message: error.to_string(),
        })?;
    scenario.experiment().map_err(|fault| Misfit {
        place: document.place(&format!("effect.{}.name", fault.index)),
        message: fault.error.to_string(),
    })?;
    Ok(scenario)
}

/// Rate [Hz] at which features and force statistics of a terrain no longer change.
fn default_physics_rate(terrain: &TerrainSpec) -> SampleRate {
    SampleRate::new(default_hertz(terrain)).expect("the table holds whole rates")
}

fn default_hertz(terrain: &TerrainSpec) -> f64 {
    match terrain {
        TerrainSpec::Reference { .. } | TerrainSpec::Hard { .. } | TerrainSpec::Sand { .. } => {
            16_000.0
        }
        TerrainSpec::Gravel { .. }
        | TerrainSpec::GravelOnHard { .. }
        | TerrainSpec::GravelInSand { .. } => 8_000.0,
        TerrainSpec::Sequence(sections) => sections
            .iter()
            .map(|section| default_hertz(&section.ground))
            .fold(8_000.0, f64::max),
    }
}

/// Refuses a magnitude above `most`, with the source of that limit.
fn limit(
    quantity: &'static str,
    unit: &'static str,
    value: f64,
    most: f64,
    reason: &str,
) -> Result<(), RangeError> {
    if value.abs() <= most {
        return Ok(());
    }
    let rounded = (most * 1.0e4).floor() / 1.0e4;
    Err(RangeError {
        quantity,
        unit,
        range: format!("{rounded} or less ({reason})"),
        value,
    })
}

/// A scenario's text with one `key=value` set.
fn assigned(text: &str, assignment: &str) -> Result<String, ScenarioError> {
    let refuse = |reason: String| ScenarioError::Assignment {
        assignment: assignment.to_owned(),
        reason,
    };
    let Some((key, value)) = split_assignment(assignment) else {
        let example = "write key=value, for example rig.single_wheel.slip=0.3";
        return Err(refuse(example.to_owned()));
    };
    let document = Document::parse(text).map_err(|old| refuse(old.message))?;
    if let Some(reason) = has_unit(&document, text, [key, value]) {
        return Err(refuse(reason));
    }
    let value = as_toml(value);
    match effect_name(key) {
        Some(name) => with_magnitude(&document, text, name, &value),
        None => document.with_value(key, &value),
    }
    .map_err(refuse)
}

/// Why the value of an assignment is a number with a unit, where the scenario has a number alone.
fn has_unit(document: &Document, text: &str, [key, value]: [&str; 2]) -> Option<String> {
    let known = document.value(key)?;
    let is_number = matches!(known.get_ref(), DeValue::Integer(_) | DeValue::Float(_));
    let end = value.rfind(|c: char| c.is_ascii_digit() || c == '.')? + 1;
    let (number, unit) = (&value[..end], value[end..].trim());
    let number: f64 = number.replace('_', "").parse().ok()?;
    if !is_number || unit.is_empty() {
        return None;
    }
    // A scenario's lines end in a comment of unit and source.
    let line = text[known.span().end..].lines().next()?;
    let comment = line.split_once('#').map(|(_, comment)| comment.trim());
    let own = comment.and_then(|comment| comment.split(',').next());
    let here = match own {
        Some("-") => "a ratio".to_owned(),
        Some(own) if !own.is_empty() => format!("in {own}"),
        _ => "in SI units".to_owned(),
    };
    let in_own = match (own, unit) {
        (_, "%") => Some(number / 100.0),
        (Some(own), unit) if own == unit => Some(number),
        _ => None,
    };
    let example = match in_own {
        Some(number) => format!("{key}={number}"),
        None => format!("convert {value} first"),
    };
    Some(format!(
        "it is a number without its unit, here {here}: {example}"
    ))
}

/// The effect that a key of an assignment names; none where the key counts effects or is another.
fn effect_name(key: &str) -> Option<&str> {
    let name = key.strip_prefix("effect.")?;
    (!name.starts_with(|c: char| c.is_ascii_digit())).then_some(name)
}

/// A scenario's text with the magnitude of an effect set, or the effect added at its end.
fn with_magnitude(
    document: &Document,
    text: &str,
    name: &str,
    value: &str,
) -> Result<String, String> {
    let is_it = |index: usize| match document.value(&format!("effect.{index}.name")) {
        Some(found) => Some(found.get_ref().as_str().map(full_name) == Some(full_name(name))),
        None => document.value(&format!("effect.{index}")).map(|_| false),
    };
    match (0..).map_while(is_it).position(|is_it| is_it) {
        Some(index) => document.with_value(&format!("effect.{index}.magnitude"), value),
        None => Ok(format!(
            "{}\n\n[[effect]]\nname = \"{name}\"\nmagnitude = {value}\n",
            text.trim_end()
        )),
    }
}

fn split_assignment(assignment: &str) -> Option<(&str, &str)> {
    let (key, value) = assignment.split_once('=')?;
    let (key, value) = (key.trim(), value.trim());
    let is_bare = |part: &str| {
        let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        !part.is_empty() && part.chars().all(bare)
    };
    (key.split('.').all(is_bare) && !value.is_empty()).then_some((key, value))
}

fn as_toml(value: &str) -> String {
    match DeValue::parse(value) {
        Ok(_) => value.to_owned(),
        Err(_) => toml::Value::String(value.to_owned()).to_string(),
    }
}

/// A value of a scenario that has no meaning.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct OutOfRange {
    /// Dotted key of the value, or of the table that holds it.
    pub path: String,
    /// What is wrong with it.
    pub error: RangeError,
}

/// Why a file or an assignment is no scenario.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("cannot read scenario {}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The text is no scenario.
    #[error(transparent)]
    Invalid(#[from] Fault),
    /// A `key=value` cannot be applied.
    #[error("cannot set `{assignment}`: {reason}")]
    Assignment {
        /// The `key=value` as given.
        assignment: String,
        /// The reason, with a way out.
        reason: String,
    },
}
