//! Schema of a campaign file, before validation.

use super::selection::Picked;
use super::sheet::Layout;
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
    /// Time series, one file or several a run.
    #[serde(default, rename = "run")]
    pub(super) runs: Vec<SourceTable>,
    /// Steady means, a row a run.
    pub(super) table: Option<SourceTable>,
}

/// A table of text, and what was done when it was measured.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SourceTable {
    #[serde(default)]
    pub(super) file: PathBuf,
    pub(super) delimiter: Option<char>,
    pub(super) decimal: Option<char>,
    pub(super) encoding: Option<String>,
    #[serde(default)]
    pub(super) skip_lines: u64,
    pub(super) header_rows: Option<usize>,
    #[serde(default)]
    pub(super) names: Vec<String>,
    #[serde(default)]
    pub(super) rows: BTreeMap<String, Picked>,
    #[serde(default)]
    pub(super) columns: BTreeMap<String, Given>,
    pub(super) sample_rate_hz: Option<f64>,
    pub(super) resample_hz: Option<f64>,
    pub(super) longest_gap_s: Option<f64>,
    pub(super) offset_s: Option<f64>,
    /// Several files of one run, in place of the one above.
    #[serde(default)]
    pub(super) source: Vec<SourceTable>,
    pub(super) id: Option<Given>,
    #[serde(default)]
    pub(super) wheel: WheelTable,
    pub(super) plate_diameter_m: Option<Given>,
    pub(super) plate_length_m: Option<Given>,
    pub(super) plate_width_m: Option<Given>,
    pub(super) slope_deg: Option<Given>,
    pub(super) load_n: Option<Given>,
    pub(super) speed_m_s: Option<Given>,
    pub(super) slip_ratio: Option<Given>,
    pub(super) rim_speed_m_s: Option<Given>,
    pub(super) slip_radius: Option<SlipRadius>,
    pub(super) slip_zero: Option<SlipZero>,
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
    pub(super) lug_thickness_m: Option<Given>,
    pub(super) mass_kg: Option<Given>,
}

impl SourceTable {
    /// How the file is written.
    pub(super) fn layout(&self) -> Layout<'_> {
        Layout {
            delimiter: self.delimiter,
            decimal: self.decimal,
            encoding: self.encoding.as_deref(),
            skip_lines: self.skip_lines,
            header_rows: self.header_rows,
            names: &self.names,
        }
    }

    /// The first key given that describes a run and not one of its files.
    pub(super) fn key_of_run(&self) -> Option<&'static str> {
        let given = [
            ("id", &self.id),
            ("wheel.radius_m", &self.wheel.radius_m),
            ("wheel.width_m", &self.wheel.width_m),
            ("wheel.lug_count", &self.wheel.lug_count),
            ("wheel.lug_height_m", &self.wheel.lug_height_m),
            ("wheel.lug_thickness_m", &self.wheel.lug_thickness_m),
            ("load_n", &self.load_n),
            ("speed_m_s", &self.speed_m_s),
            ("slip_ratio", &self.slip_ratio),
            ("rim_speed_m_s", &self.rim_speed_m_s),
            ("terrain", &self.terrain),
            ("class", &self.class),
            ("repeat", &self.repeat),
            ("day", &self.day),
            ("notes", &self.notes),
        ];
        let given = given.into_iter().find(|(_, value)| value.is_some());
        let given = given.map(|(key, _)| key);
        let slip_radius = self.slip_radius.map(|_| "slip_radius");
        let slip_zero = self.slip_zero.map(|_| "slip_zero");
        let nested = (!self.source.is_empty()).then_some("source");
        given.or(slip_radius).or(slip_zero).or(nested)
    }

    /// The first key given that describes a file and not a run of several.
    pub(super) fn key_of_file(&self) -> Option<&'static str> {
        let given = [
            ("file", self.file.as_os_str().is_empty()),
            ("columns", self.columns.is_empty()),
            ("rows", self.rows.is_empty()),
            ("names", self.names.is_empty()),
            ("delimiter", self.delimiter.is_none()),
            ("decimal", self.decimal.is_none()),
            ("encoding", self.encoding.is_none()),
            ("skip_lines", self.skip_lines == 0),
            ("header_rows", self.header_rows.is_none()),
            ("sample_rate_hz", self.sample_rate_hz.is_none()),
            ("resample_hz", self.resample_hz.is_none()),
            ("longest_gap_s", self.longest_gap_s.is_none()),
            ("offset_s", self.offset_s.is_none()),
        ];
        let given = given.into_iter().find(|(_, is_missing)| !is_missing);
        given.map(|(key, _)| key)
    }
}

/// A value, or the column that contains it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Given {
    Number(f64),
    Text(String),
    Column(ColumnTable),
}

/// A standard deviation for all rows, or a column with that of each row.
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
    /// A column of times that is added to this one.
    pub(super) add: Option<Box<Given>>,
    /// How a time stamp is written, as `strftime` has it.
    pub(super) format: Option<String>,
    /// Count after which a clock starts again from 0.
    pub(super) wraps_at: Option<f64>,
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

/// The radius by which slip is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum SlipRadius {
    /// The rim's.
    #[default]
    Rim,
    /// That of the lugs' tips.
    Tips,
    /// The mean radius at which soil shears off the lugs, for a friction angle of 30°.
    Shear,
}

/// What happens at slip 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum SlipZero {
    /// The wheel travels by its radius per turn.
    #[default]
    Speed,
    /// The torque is nothing.
    Torque,
}
