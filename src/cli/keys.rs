//! `keys`: every key of a scenario.

use super::output::Output;
use crate::scenario::keys::{Key, Table, tables};
use crate::scenario::schema::json_schema;
use clap::Args;
use serde::Serialize;
use std::fmt;

/// List every key of a scenario: unit, default, range, meaning
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Keys {
    /// Only keys that begin with this, or if none does, that contain it
    prefix: Option<String>,
    /// Print the JSON schema of scenario files, for editors
    #[arg(long, conflicts_with = "prefix")]
    json_schema: bool,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel keys wheel
  lugwheel keys slip
  lugwheel keys --json-schema > scenario.schema.json

A key is set in a scenario file or with --set KEY=VALUE. N counts the entries of a list from 0. A range that
depends on other keys is that in a ready scenario. With a first line `#:schema ./scenario.schema.json`
editors with a TOML language server (taplo, Even Better TOML) complete and check the keys.";

/// Most keys in a suggestion.
const SUGGESTED: usize = 3;

/// No key has the letters.
#[derive(Debug, thiserror::Error)]
#[error("no key of a scenario has `{asked}` in it; did you mean {}?", .near.join(", "))]
pub struct NoKey {
    asked: String,
    near: Vec<String>,
}

impl Keys {
    /// Prints the keys, or the schema.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        if self.json_schema {
            return output.print(&Schema(json_schema()));
        }
        let tables = tables();
        let Some(prefix) = &self.prefix else {
            return output.print(&Listed(tables));
        };
        let starting = chosen(&tables, |key| key.path.starts_with(prefix));
        let found = if starting.is_empty() {
            chosen(&tables, |key| key.path.contains(prefix))
        } else {
            starting
        };
        if found.is_empty() {
            let near = nearest(&tables, prefix);
            let asked = prefix.clone();
            return Err(NoKey { asked, near }.into());
        }
        output.print(&Listed(found))
    }
}

/// The tables with keys that are wanted, and those keys.
fn chosen(tables: &[Table], is_wanted: impl Fn(&Key) -> bool) -> Vec<Table> {
    let mut tables = tables.to_vec();
    for table in &mut tables {
        table.keys.retain(&is_wanted);
    }
    tables.retain(|table| !table.keys.is_empty());
    tables
}

/// The keys most like the one asked for, as a whole and in their last word.
fn nearest(tables: &[Table], asked: &str) -> Vec<String> {
    let asked = asked.to_lowercase();
    let last = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
    let likeness = |key: &Key| {
        let path = &key.path;
        strsim::jaro_winkler(path, &asked) + strsim::jaro_winkler(&last(path), &last(&asked))
    };
    let mut keys: Vec<&Key> = tables.iter().flat_map(|table| &table.keys).collect();
    keys.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
    let names = keys.into_iter().map(|key| key.path.clone());
    names.take(SUGGESTED).collect()
}

#[derive(Serialize)]
struct Schema(serde_json::Value);

impl fmt::Display for Schema {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:#}", self.0)
    }
}

#[derive(Serialize)]
struct Listed(Vec<Table>);

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, table) in self.0.iter().enumerate() {
            if place > 0 {
                writeln!(f)?;
            }
            let name = match table.path.as_str() {
                "" => String::new(),
                path => format!("[{path}] "),
            };
            writeln!(f, "{name}{}", table.meaning)?;
            let width = table.keys.iter().map(|key| key.path.chars().count()).max();
            for key in &table.keys {
                write_key(f, key, width.unwrap_or(0))?;
            }
        }
        Ok(())
    }
}

/// A line of path, unit, default, range and meaning.
fn write_key(f: &mut fmt::Formatter<'_>, key: &Key, width: usize) -> fmt::Result {
    let Key { path, meaning, .. } = key;
    let unit = key.unit.as_deref().unwrap_or_default();
    let default = match &key.default {
        Some(default) => default,
        None if key.required => "required",
        None => "",
    };
    let range = key.range.as_deref().unwrap_or_default();
    writeln!(
        f,
        "  {path:<width$}  {unit:<9} {default:<9} {range:<22} {meaning}"
    )
}
