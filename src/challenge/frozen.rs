//! Magnitudes of effects, frozen before any score: `scenarios/challenge/magnitudes.toml`.

use super::truth::effect_of;
use crate::document::Document;
use crate::scenario::ready;
use serde::Deserialize;

/// The magnitudes of an effect on one of its seats.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Frozen {
    /// Name, with its channel where it has one.
    pub(super) name: String,
    /// Unit of the magnitudes.
    pub(super) unit: String,
    /// Low, typical and high.
    pub(super) levels: [f64; 3],
    /// Whence they come.
    #[serde(rename = "source")]
    _source: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    #[serde(rename = "version")]
    _version: i64,
    magnitude: Vec<Frozen>,
}

impl Frozen {
    /// The name without the channel.
    pub(super) fn effect(&self) -> &str {
        effect_of(&self.name)
    }
}

/// The table.
pub(super) fn frozen() -> Vec<Frozen> {
    let table = ready::challenge("magnitudes").expect("it is part of the program");
    let document = Document::parse(table.text);
    let table: Table = document
        .and_then(|document| document.read())
        .expect("the committed table is part of the program");
    table.magnitude
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Effect, Seat, Source, catalogue};

    fn entry(effect: &Effect, seat: &Seat) -> Frozen {
        let source = match effect.source {
            Source::Cited(source) => format!("cited: {source}"),
            Source::Guess(source) => format!("guess: {source}"),
        };
        let name = [effect.name, seat.channel].join(".");
        Frozen {
            name: name.trim_end_matches('.').to_owned(),
            unit: seat.unit.to_owned(),
            levels: seat.levels,
            _source: source,
        }
    }

    fn written(entries: &[Frozen]) -> String {
        let write = |it: &Frozen| {
            let Frozen {
                name,
                unit,
                levels,
                _source,
            } = it;
            format!(
                "\n[[magnitude]]\nname = {name:?}\nunit = {unit:?}\nlevels = {levels:?}\nsource = {_source:?}\n"
            )
        };
        entries.iter().map(write).collect()
    }

    #[test]
    fn the_frozen_magnitudes_are_the_catalogue_s_levels_of_every_seat() {
        let seats = catalogue().flat_map(|it| it.seats.iter().map(move |seat| entry(it, seat)));
        let now: Vec<Frozen> = seats.collect();
        assert!(
            frozen() == now,
            "a level that moves after a score makes the score worthless; the catalogue has\n{}",
            written(&now)
        );
    }
}
