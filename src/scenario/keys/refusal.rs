//! Messages of the checks of a scenario for invalid values.

use super::joined;
use super::part::Number;
use crate::document::Document;
use crate::scenario::{read, ready};

/// The ready scenarios, to be spoilt.
pub(super) struct Refusals {
    scenarios: Vec<Ready>,
}

struct Ready {
    text: &'static str,
    document: Document<'static>,
}

/// A refusal of a number.
pub(super) struct Refusal {
    pub(super) unit: String,
    pub(super) range: String,
}

impl Number {
    /// Values that most ranges leave out.
    fn outside(self) -> &'static [&'static str] {
        match self {
            Self::Real => &["nan"],
            Self::Whole => &["4294967295", "0"],
        }
    }
}

impl Refusals {
    pub(super) fn new() -> Self {
        let parsed = ready::scenarios().iter().map(|scenario| Ready {
            text: scenario.text,
            document: Document::parse(scenario.text).expect("ready scenarios are TOML"),
        });
        Self {
            scenarios: parsed.collect(),
        }
    }

    /// How a number outside its range is refused under the key `name` of a table.
    pub(super) fn of(
        &self,
        table: &str,
        name: &str,
        number: Number,
        required: &[&str],
    ) -> Option<Refusal> {
        let required: Vec<&str> = required
            .iter()
            .copied()
            .filter(|key| *key != name)
            .collect();
        let text = self.text(table, &required)?;
        let path = joined(&counted(table), name);
        let mut refusals = number.outside().iter();
        refusals.find_map(|value| refusal(&with(&text, &path, value)?))
    }

    /// The text of the scenario that has the most of a table. Where it has none, the `required` keys are 0.
    pub(super) fn text(&self, table: &str, required: &[&str]) -> Option<String> {
        let table = counted(table);
        let by_depth = self.scenarios.iter().rev();
        let scenario = by_depth.max_by_key(|scenario| scenario.depth(&table))?;
        let is_new = !table.is_empty() && scenario.document.value(&table).is_none();
        let mut missing = required.iter().filter(|_| is_new);
        missing.try_fold(scenario.text.to_owned(), |text, key| {
            with(&text, &joined(&table, key), "0.0")
        })
    }
}

impl Ready {
    /// How many keys of the path it has.
    fn depth(&self, path: &str) -> usize {
        let ends = path
            .match_indices('.')
            .map(|(end, _)| end)
            .chain([path.len()]);
        ends.take_while(|end| self.document.value(&path[..*end]).is_some())
            .count()
    }
}

/// The path to the first entry of each list.
pub(super) fn counted(path: &str) -> String {
    path.replace(".N", ".0")
}

pub(super) fn with(text: &str, path: &str, value: &str) -> Option<String> {
    Document::parse(text).ok()?.with_value(path, value).ok()
}

/// The refusal of a text as `quantity [unit] must be range, got value`.
fn refusal(text: &str) -> Option<Refusal> {
    let message = read(text, "").err()?.message;
    let (quantity, rest) = message.split_once("] must ")?;
    let (_, unit) = quantity.rsplit_once('[')?;
    let (range, _) = rest.rsplit_once(", got ")?;
    Some(Refusal {
        unit: unit.to_owned(),
        range: range.strip_prefix("be ").unwrap_or(range).to_owned(),
    })
}
