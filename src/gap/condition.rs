//! Which runs were made alike.

use crate::trace::RunAttributes;
use serde::{Serialize, Serializer};
use std::fmt;

/// The condition of a run: terrain, wheel, load, speed and slip, as far as known for all runs compared, as
/// text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Condition(String);

impl Condition {
    /// All runs of a campaign together.
    pub fn campaign() -> Self {
        Self("all runs".to_owned())
    }

    /// Whether it is all runs together.
    pub fn is_campaign(&self) -> bool {
        *self == Self::campaign()
    }

    /// Its text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Condition {
    /// The condition of this text.
    fn from(text: &str) -> Self {
        Self(text.to_owned())
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Serialize for Condition {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// One property of a run as text; none where it is not known.
type Property = fn(&RunAttributes) -> Option<String>;

/// What makes a condition, in the order of its text.
const PROPERTIES: [Property; 9] = [
    |run| run.terrain.map(|label| label.as_str().to_owned()),
    |run| known(run.slip_ratio, "slip", ""),
    |run| {
        if run.is_lifted() {
            Some("lifted".to_owned())
        } else {
            known(run.load, "", " N")
        }
    },
    |run| known(1.0e3 * run.speed, "", " mm/s"),
    |run| known(1.0e3 * run.wheel_radius, "r", " mm"),
    |run| known(1.0e3 * run.wheel_width, "b", " mm"),
    |run| run.lug_count.map(|count| format!("{count} lugs")),
    |run| known(1.0e3 * run.lug_height, "l", " mm"),
    |run| known(run.slope_deg, "slope", "°"),
];
/// Index from which properties are in the text only if runs differ in them: wheel and slope.
const WHEEL: usize = 4;

/// A number to three digits, as commands are given.
fn known(value: f64, symbol: &str, unit: &str) -> Option<String> {
    if !value.is_finite() {
        return None;
    }
    let digits = match value.abs() {
        0.0 => 0,
        size => (2.0 - libm::floor(libm::log10(size))).clamp(0.0, 4.0) as usize,
    };
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    let space = if symbol.is_empty() { "" } else { " " };
    let text = if text == "-0" { "0" } else { text };
    Some(format!("{symbol}{space}{text}{unit}"))
}

/// The condition of each run. A property counts that every run has.
pub(crate) fn conditions(runs: &[&RunAttributes]) -> Vec<Condition> {
    let mut texts = vec![Vec::new(); runs.len()];
    for (place, property) in PROPERTIES.iter().enumerate() {
        let values: Option<Vec<String>> = runs.iter().map(|run| property(run)).collect();
        let Some(values) = values else {
            continue;
        };
        let differ = values.iter().any(|value| *value != values[0]);
        if place < WHEEL || differ {
            for (text, value) in texts.iter_mut().zip(values) {
                text.push(value);
            }
        }
    }
    texts
        .into_iter()
        .map(|text| Condition(text.join(", ")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::class::TerrainLabel;

    fn run(slip: f64, load: f64, terrain: Option<TerrainLabel>) -> RunAttributes {
        RunAttributes {
            wheel_radius: 0.14,
            wheel_width: 0.15,
            lug_count: Some(28),
            lug_height: 0.015,
            load,
            speed: 0.014,
            slip_ratio: slip,
            terrain,
            ..RunAttributes::default()
        }
    }

    #[test]
    fn a_condition_is_of_commanded_values_and_rounding_makes_no_new_one() {
        let sand = Some(TerrainLabel::Sand);
        let runs = [run(0.1, 100.0, sand), run(0.1 + 1e-9, 100.0 - 1e-7, sand)];
        let found = conditions(&runs.each_ref());
        assert_eq!(found[0].as_str(), "ST, slip 0.1, 100 N, 14 mm/s");
        assert_eq!(found[0], found[1]);
    }

    #[test]
    fn under_no_load_a_wheel_is_lifted() {
        let lifted = run(0.1, 0.0, None);
        assert_eq!(
            conditions(&[&lifted])[0].as_str(),
            "slip 0.1, lifted, 14 mm/s"
        );
    }

    #[test]
    fn a_property_unknown_for_one_run_is_ignored_and_the_wheel_is_stated_where_there_are_two() {
        let mut runs = [
            run(0.1, 100.0, Some(TerrainLabel::Sand)),
            run(-0.05, f64::NAN, None),
        ];
        runs[1].lug_count = Some(0);
        let found = conditions(&runs.each_ref());
        assert_eq!(found[0].as_str(), "slip 0.1, 14 mm/s, 28 lugs");
        assert_eq!(found[1].as_str(), "slip -0.05, 14 mm/s, 0 lugs");
    }
}
