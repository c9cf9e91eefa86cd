//! `effects`: the catalogue.

use super::output::Output;
use crate::effects::{Bound, Effect, Seat, Source, Stage, catalogue, seated};
use clap::Args;
use serde::Serialize;
use std::fmt;

/// List the effects that a simulation can be given
///
/// Each is a named departure from the ideal experiment: parameters changed, practical magnitudes, affected
/// channels. With a name: the full description of that one.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Effects {
    /// One effect, with or without an affected channel
    name: Option<String>,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel effects
  lugwheel effects rail_friction
  lugwheel simulate single_wheel_st --effect rail_friction=2 --effect gain_error.drawbar_pull=0.05

In a scenario file an effect is a table [[effect]] with `name` and `magnitude`; in a study its key is
effect.NAME. In JSON, null stands for an infinite magnitude.";

impl Effects {
    /// Prints the catalogue, or one entry.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        match &self.name {
            Some(name) => output.print(&Entry(seated(name)?.0)),
            None => output.print(&Catalogue(catalogue().collect())),
        }
    }
}

/// All effects, a line each.
#[derive(Serialize)]
struct Catalogue(Vec<&'static Effect>);

impl fmt::Display for Catalogue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = [
            "name",
            "unit",
            "neutral",
            "low, typical, high",
            "varies with",
            "source",
        ];
        let [name, unit, neutral, levels, bound, source] = head;
        writeln!(
            f,
            "{name:<20}{unit:>6}{neutral:>9}  {levels:<22}{bound:<13}{source:<7}what it is"
        )?;
        for effect in &self.0 {
            let Seat { unit, neutral, .. } = effect.seats[0];
            let levels = levels_of(&effect.seats[0]);
            let (name, title) = (effect.name, effect.title);
            let bound = match effect.signature.bound {
                Bound::WheelAngle => "angle",
                Bound::Frequency => "hertz",
                Bound::History => "history",
                Bound::Condition => "condition",
            };
            let source = match effect.source {
                Source::Cited(_) => "cited",
                Source::Guess(_) => "guess",
            };
            writeln!(
                f,
                "{name:<20}{unit:>6}{neutral:>9}  {levels:<22}{bound:<13}{source:<7}{title}"
            )?;
        }
        writeln!(
            f,
            "\nLevels are those of the first channel an effect may sit on; `lugwheel effects NAME` has \
             the others,\nwhat it edits, its signature, its source and priors."
        )
    }
}

/// One effect, all of it.
#[derive(Serialize)]
struct Entry(&'static Effect);

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Effect {
            name,
            title,
            edits,
            stage,
            seats,
            signature,
            confusers,
            source,
            other_form,
            ..
        } = self.0;
        writeln!(f, "{name}: {title}\n")?;
        let mut line = |word: &str, text: &str| writeln!(f, "{word:<18}{text}");
        line("edits", edits)?;
        line(
            "stage",
            match stage {
                Stage::Sensors => "sensors: the motion stays",
                Stage::Physics => "physics: the motion changes",
            },
        )?;
        line("channels affected", &signature.channels.join(", "))?;
        line(
            "varies with",
            match signature.bound {
                Bound::WheelAngle => "wheel angle",
                Bound::Frequency => "frequency in hertz",
                Bound::History => "time, distance or previous runs",
                Bound::Condition => "slip, speed and load",
            },
        )?;
        line("how", signature.dependence)?;
        line("similar effects", &confusers.join(", "))?;
        let other = other_form.as_ref();
        line(
            "other form",
            other.map_or("none", |other| other.description),
        )?;
        match source {
            Source::Cited(source) => line("source", source)?,
            Source::Guess(reason) => line("source", &format!("a guess: {reason}"))?,
        }
        writeln!(f)?;
        for seat in *seats {
            let place = match seat.channel {
                "" => (*name).to_owned(),
                channel => format!("{name}.{channel}"),
            };
            let (unit, neutral, [low, high]) = (seat.unit, seat.neutral, seat.range);
            writeln!(
                f,
                "{place:<32}{:<22} [{unit}], neutral {neutral}, from {low} to {high}; prior {}",
                levels_of(seat),
                seat.prior
            )?;
        }
        Ok(())
    }
}

fn levels_of(seat: &Seat) -> String {
    seat.levels.map(shown).join(", ")
}

/// A magnitude as it would be written.
fn shown(level: f64) -> String {
    if level != 0.0 && level.abs() < 1.0e-3 {
        format!("{level:e}")
    } else {
        level.to_string()
    }
}
