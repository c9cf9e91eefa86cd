//! Every key of a scenario: unit, range, default, meaning.
//!
//! Nothing of it is written a second time, where it would drift from the code. Names, defaults and meanings are those
//! of the structs that read a file, through their [`schema`](super::schema). Units and ranges come from the checks of
//! values: each key of a ready scenario is set to a number that is none, and the refusal states them. The tests compare
//! the keys with those that the parser expects, and the defaults with scenarios that leave the key out.

mod part;
mod refusal;

use super::schema::derived;
use crate::effects;
use part::Part;
use refusal::Refusals;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A table of a scenario.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Table {
    /// Dotted path; empty for the keys above all tables. `N` counts the entries of a list from 0.
    pub path: String,
    /// What it describes.
    pub meaning: String,
    /// Its keys; those of tables in it aside.
    pub keys: Vec<Key>,
}

/// A key of a scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Key {
    /// Dotted path, as `--set` takes it.
    pub path: String,
    /// Unit of the number; `-` where it has none. `None` where it is no number.
    pub unit: Option<String>,
    /// Values that it can have. A range that depends on other keys is that in a ready scenario.
    pub range: Option<String>,
    /// Whether its table is refused without it.
    pub required: bool,
    /// Value where it is left out, as TOML; `None` where the meaning states the default.
    pub default: Option<String>,
    /// What it is.
    pub meaning: String,
}

/// The tables of a scenario, each before those in it.
pub fn tables() -> Vec<Table> {
    let schema = derived();
    let mut walk = Walk {
        root: &schema,
        refusals: Refusals::new(),
        above: Vec::new(),
        tables: Vec::new(),
    };
    walk.table("", Part::of(&schema, &schema));
    walk.tables
}

/// Unit of a key as `--set` takes it, or of the magnitude of an effect (`effect.NAME`); `-` where the number has none,
/// `None` where there is no such key or its values are no numbers.
pub fn unit_of(key: &str) -> Option<String> {
    if let Some(name) = key.strip_prefix("effect.")
        && let Ok((_, seat)) = effects::seated(name)
    {
        return Some(seat.unit.to_owned());
    }
    let is_count = |part: &&str| part.parse::<usize>().is_ok();
    let parts = key.split('.');
    let parts: Vec<&str> = parts
        .map(|it| if is_count(&it) { "N" } else { it })
        .collect();
    let path = parts.join(".");
    UNITS.get(&path)?.clone()
}

/// Units by path; the tables take milliseconds to derive, and a report asks for units by the hundred.
static UNITS: LazyLock<BTreeMap<String, Option<String>>> = LazyLock::new(|| {
    let keys = tables().into_iter().flat_map(|table| table.keys);
    keys.map(|key| (key.path, key.unit)).collect()
});

/// The way through the schema.
struct Walk<'s> {
    root: &'s Value,
    refusals: Refusals,
    /// Definitions of the tables around this place: a list may hold what it is part of.
    above: Vec<&'s str>,
    tables: Vec<Table>,
}

impl<'s> Walk<'s> {
    /// Adds a table and those in it.
    fn table(&mut self, path: &str, part: Part<'s>) {
        self.above.extend(part.name);
        let variants = part.variants(self.root);
        if variants.is_empty() {
            self.add(path, part);
        }
        for (name, variant) in variants {
            self.inner(&joined(path, name), variant);
        }
        if part.name.is_some() {
            self.above.pop();
        }
    }

    /// Adds the table that is no choice between others.
    fn add(&mut self, path: &str, part: Part<'s>) {
        let required = part.required();
        let (inner, own): (Vec<_>, Vec<_>) = part
            .properties()
            .map(|(name, property)| (name, Part::of(self.root, property)))
            .partition(|(_, found)| found.is_table() || found.entries(self.root).is_some());
        let keys = own
            .into_iter()
            .map(|(name, found)| self.key(path, name, found, &required));
        let table = Table {
            path: path.to_owned(),
            meaning: part.meaning(),
            keys: keys.collect(),
        };
        self.tables.push(table);
        for (name, found) in inner {
            self.inner(&joined(path, name), found);
        }
    }

    /// Adds the table that a key holds, or that each entry of its list is.
    fn inner(&mut self, path: &str, part: Part<'s>) {
        let (path, part) = match part.entries(self.root) {
            Some(entry) => (joined(path, "N"), entry),
            None => (path.to_owned(), part),
        };
        if part.name.is_some_and(|name| self.above.contains(&name)) {
            self.tables.push(Table {
                path,
                meaning: part.meaning(),
                keys: Vec::new(),
            });
            return;
        }
        self.table(&path, part);
    }

    fn key(&self, table: &str, name: &str, part: Part<'s>, required: &[&str]) -> Key {
        let is_required = required.contains(&name);
        let refusal = part
            .number()
            .and_then(|number| self.refusals.of(table, name, number, required));
        let (of_check, range) = refusal.map_or((None, None), |it| (Some(it.unit), Some(it.range)));
        let (meaning, of_comment) = match part.number() {
            Some(_) => without_unit(&part.meaning()),
            None => (part.meaning(), None),
        };
        Key {
            path: joined(table, name),
            unit: unit(of_comment, of_check),
            range: range.or_else(|| part.choices()),
            required: is_required,
            default: part.default(is_required),
            meaning,
        }
    }
}

fn joined(path: &str, name: &str) -> String {
    match path {
        "" => name.to_owned(),
        path => format!("{path}.{name}"),
    }
}

/// A meaning without the first unit in brackets, and that unit.
fn without_unit(meaning: &str) -> (String, Option<String>) {
    let found = meaning.split_once(" [").and_then(|(before, rest)| {
        let (unit, after) = rest.split_once(']')?;
        let is_unit = !unit.contains([' ', ',']);
        is_unit.then(|| (format!("{before}{after}"), Some(unit.to_owned())))
    });
    found.unwrap_or_else(|| (meaning.to_owned(), None))
}

/// The unit that a doc comment states, `unit` in it being that of the checked quantity.
fn unit(of_comment: Option<String>, of_check: Option<String>) -> Option<String> {
    match (of_comment, of_check) {
        (Some(stated), Some(checked)) if stated != "unit" && checked.contains(['/', ' ']) => {
            Some(stated.replace("unit", &format!("({checked})")))
        }
        (Some(stated), Some(checked)) => Some(stated.replace("unit", &checked)),
        (stated, checked) => stated.or(checked),
    }
}

#[cfg(test)]
mod tests {
    use super::refusal::{counted, with};
    use super::*;
    use crate::scenario::Scenario;
    use std::collections::BTreeSet;

    fn key(path: &str) -> Key {
        let tables = tables();
        let mut keys = tables.into_iter().flat_map(|table| table.keys);
        keys.find(|key| key.path == path)
            .unwrap_or_else(|| panic!("no {path}"))
    }

    #[test]
    fn a_key_an_entry_of_a_list_and_an_effect_have_their_units() {
        let unit = |key: &str| unit_of(key).unwrap_or_default();
        assert_eq!(unit("rig.single_wheel.load"), "N");
        assert_eq!(unit("rig.single_wheel.slip"), "-");
        assert_eq!(unit("effect.sensor_tilt"), "°");
        assert_eq!(unit_of("terrain.reference"), None);
    }

    /// Names of the required keys of a table.
    fn required(table: &Table) -> Vec<&str> {
        let required = table.keys.iter().filter(|key| key.required);
        required.map(|key| last(&key.path)).collect()
    }

    fn last(path: &str) -> &str {
        path.rsplit('.').next().unwrap()
    }

    /// Names of what stands directly in a table: keys and tables.
    fn names_in(table: &str, tables: &[Table]) -> BTreeSet<String> {
        let keys = tables
            .iter()
            .flat_map(|table| &table.keys)
            .map(|key| &key.path);
        let paths = keys.chain(tables.iter().map(|table| &table.path));
        let inner = paths.filter_map(|path| match table {
            "" => Some(path.as_str()),
            table => path.strip_prefix(table)?.strip_prefix('.'),
        });
        let names = inner.map(|path| path.split('.').next().unwrap().to_owned());
        names
            .filter(|name| !name.is_empty() && name != "N")
            .collect()
    }

    /// The keys that the parser names in its refusal of an unknown one.
    fn expected(message: &str) -> BTreeSet<String> {
        let line = message.lines().next().unwrap();
        if let Some((_, keys)) = line.split_once("available keys: ") {
            return keys.split(", ").map(str::to_owned).collect();
        }
        let (_, keys) = line
            .split_once(", expected ")
            .unwrap_or_else(|| panic!("{line}"));
        let keys = keys.split("; did you mean").next().unwrap();
        keys.split('`')
            .skip(1)
            .step_by(2)
            .map(str::to_owned)
            .collect()
    }

    #[test]
    fn a_table_has_the_keys_that_the_parser_expects_and_no_other() {
        let (tables, refusals) = (tables(), Refusals::new());
        for table in &tables {
            let listed = names_in(&table.path, &tables);
            // Of an effect the parser is asked by a scenario that has one; a sequence in a sequence is listed above.
            if table.path == "effect.N" || listed.is_empty() {
                continue;
            }
            let text = refusals.text(&table.path, &required(table)).unwrap();
            let unknown = joined(&counted(&table.path), "no_such_key");
            let message = Scenario::from_toml(&with(&text, &unknown, "1").unwrap(), "")
                .unwrap_err()
                .to_string();
            assert_eq!(listed, expected(&message), "{}", table.path);
        }
    }

    /// A scenario's text without a key.
    fn without(text: &str, path: &str) -> String {
        let mut root: toml::Value = toml::from_str(text).unwrap();
        let (parents, name) = path.rsplit_once('.').unwrap_or(("", path));
        let mut table = &mut root;
        for parent in parents.split('.').filter(|parent| !parent.is_empty()) {
            let inner = match parent.parse::<usize>() {
                Ok(place) => table.get_mut(place),
                Err(_) => table.get_mut(parent),
            };
            let Some(inner) = inner else {
                return text.to_owned();
            };
            table = inner;
        }
        table.as_table_mut().unwrap().remove(name);
        toml::to_string(&root).unwrap()
    }

    #[test]
    fn a_scenario_without_a_key_is_refused_or_has_its_default() {
        let (tables, refusals) = (tables(), Refusals::new());
        let mut compared = 0;
        for table in tables.iter().filter(|table| table.path != "effect.N") {
            let text = refusals.text(&table.path, &required(table)).unwrap();
            for key in &table.keys {
                let path = counted(&key.path);
                let left_out = Scenario::from_toml(&without(&text, &path), "");
                // Without its slip a rig needs a wheel speed.
                if key.required || last(&path) == "slip" {
                    let message = left_out.unwrap_err().to_string();
                    assert!(message.contains("missing"), "{path}: {message}");
                } else if let Some(default) = &key.default {
                    let given =
                        Scenario::from_toml(&with(&text, &path, default).unwrap(), "").unwrap();
                    assert_eq!(left_out.unwrap().to_toml(), given.to_toml(), "{path}");
                    compared += 1;
                } else {
                    left_out.unwrap_or_else(|error| panic!("{path}: {error}"));
                }
            }
        }
        assert!(compared > 100, "{compared}");
    }

    #[test]
    fn units_and_ranges_are_those_of_the_checks() {
        let slip = key("rig.single_wheel.slip");
        assert_eq!(
            (slip.unit.as_deref(), slip.range.as_deref()),
            (Some("-"), Some("in [-1, 1]"))
        );
        let height = key("terrain.hard.ledge.height");
        assert_eq!(
            (height.unit.as_deref(), height.range.as_deref()),
            (Some("m"), Some("in [0, 0.5]"))
        );
        let noise = key("sensors.force_torque.drawbar_pull.noise_density");
        assert_eq!(
            (noise.unit.as_deref(), noise.default.as_deref()),
            (Some("N/√Hz"), Some("0.0"))
        );
        let bandwidth = key("sensors.force_torque.drawbar_pull.bandwidth");
        assert_eq!(bandwidth.default.as_deref(), Some("inf"));
        let count = key("wheel.lugs.count");
        assert_eq!(
            (count.range.as_deref(), count.required),
            (Some("in [0, 64]"), true)
        );
        let convention = key("terrain.sand.soil.convention");
        assert_eq!(
            convention.range.as_deref(),
            Some("\"wong_reece\" or \"triangular\"")
        );
    }
}
