//! What a campaign file may say, before any of it is checked.

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// A campaign file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CampaignTable {
    #[serde(rename = "version")]
    _version: i64,
    /// Time series, a file a run.
    #[serde(default, rename = "run")]
    pub(super) runs: Vec<SourceTable>,
    /// Steady means, a row a run.
    pub(super) table: Option<SourceTable>,
}

/// A CSV file, and what was done when it was measured.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SourceTable {
    pub(super) file: PathBuf,
    pub(super) delimiter: Option<char>,
    #[serde(default)]
    pub(super) rows: BTreeMap<String, Given>,
    pub(super) columns: BTreeMap<String, Given>,
    pub(super) sample_rate_hz: Option<f64>,
    pub(super) id: Option<Given>,
    #[serde(default)]
    pub(super) wheel: WheelTable,
    pub(super) load_n: Option<Given>,
    pub(super) speed_m_s: Option<Given>,
    pub(super) slip_ratio: Option<Given>,
    pub(super) rim_speed_m_s: Option<Given>,
    pub(super) terrain: Option<Given>,
    pub(super) class: Option<Given>,
    pub(super) repeat: Option<Given>,
    pub(super) day: Option<Given>,
    pub(super) notes: Option<Given>,
}

/// A measured wheel.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WheelTable {
    pub(super) radius_m: Option<Given>,
    pub(super) width_m: Option<Given>,
    pub(super) lug_count: Option<Given>,
    pub(super) lug_height_m: Option<Given>,
}

/// A value, or the column that holds it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Given {
    Number(f64),
    Text(String),
    Column(ColumnTable),
}

/// A standard deviation for all rows, or the column that holds each row's.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "sd is a number or the name of a column")]
pub(super) enum Spread {
    Constant(f64),
    Column(String),
}

/// A column of a CSV file, and what to make of its numbers.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ColumnTable {
    pub(super) column: String,
    pub(super) unit: Option<String>,
    pub(super) scale: Option<f64>,
    pub(super) subtract: Option<f64>,
    pub(super) sd: Option<Spread>,
    pub(super) n: Option<String>,
}

impl<'de> Deserialize<'de> for Given {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(GivenVisitor)
    }
}

struct GivenVisitor;

impl<'de> Visitor<'de> for GivenVisitor {
    type Value = Given;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a text or { column = \"...\" }")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Given, E> {
        Ok(Given::Number(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Given, E> {
        Ok(Given::Number(value as f64))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Given, E> {
        Ok(Given::Text(value.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Given, A::Error> {
        ColumnTable::deserialize(MapAccessDeserializer::new(map)).map(Given::Column)
    }
}
