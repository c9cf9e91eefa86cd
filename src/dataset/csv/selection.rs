//! Selection of the rows of a table.
//!
//! ```toml
//! rows = { trial = 3, ground = ["ST", "SGT"], slip = { min = 0.0, max = 0.6 }, day = { not = "3-2-21" } }
//! ```
//!
//! A row is selected if all conditions are met. Ranges include both ends; a row without a number there is in
//! no range and differs from every number.

use super::sheet::{Header, Row};
use serde::Deserialize;
use std::cmp::Ordering;
use std::fmt;

/// A condition on the cells of a column.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "a number, a text, a list of them, { min, max } or { not = ... }"
)]
pub(super) enum Picked {
    One(Wanted),
    Any(Vec<Wanted>),
    Within(Within),
    Not(Not),
}

/// A permitted value of a cell.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub(super) enum Wanted {
    Number(f64),
    Text(String),
}

/// A range, of which one end may be open.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Within {
    min: Option<f64>,
    max: Option<f64>,
}

/// An excluded value of a cell.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Not {
    not: OneOrMore,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
enum OneOrMore {
    One(Wanted),
    More(Vec<Wanted>),
}

impl Picked {
    /// Refuses a range or list that nothing can lie in.
    pub(super) fn check(&self) -> Result<(), String> {
        match self {
            Self::Any(list) if list.is_empty() => {
                Err("an empty list picks no row; name a value".to_owned())
            }
            Self::Within(Within {
                min: None,
                max: None,
            }) => Err("a range needs min or max".to_owned()),
            Self::Within(Within {
                min: Some(min),
                max: Some(max),
            }) if min.partial_cmp(max).is_none_or(Ordering::is_gt) => {
                Err(format!("min = {min} lies above max = {max}"))
            }
            _ => Ok(()),
        }
    }

    /// Whether the cell in `column` meets the condition.
    ///
    /// # Errors
    /// Where a range is applied to a cell with a text that is no number.
    pub(super) fn holds(&self, header: &Header, row: &Row, column: usize) -> Result<bool, String> {
        let is = |wanted: &Wanted| wanted.is(header, row, column);
        Ok(match self {
            Self::One(wanted) => is(wanted),
            Self::Any(list) => list.iter().any(is),
            Self::Not(Not {
                not: OneOrMore::One(unwanted),
            }) => !is(unwanted),
            Self::Not(Not {
                not: OneOrMore::More(unwanted),
            }) => !unwanted.iter().any(is),
            Self::Within(Within { min, max }) => {
                let number = header.number(row, column)?;
                number >= min.unwrap_or(f64::NEG_INFINITY) && number <= max.unwrap_or(f64::INFINITY)
            }
        })
    }
}

impl Wanted {
    fn is(&self, header: &Header, row: &Row, column: usize) -> bool {
        match self {
            Self::Text(text) => header.text(row, column) == *text,
            Self::Number(number) => header.is_number(row, column, *number),
        }
    }
}

impl fmt::Display for Picked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(wanted) => write!(f, "= {wanted}"),
            Self::Any(list) => write!(f, "in {}", listed(list)),
            Self::Not(Not {
                not: OneOrMore::One(unwanted),
            }) => write!(f, "other than {unwanted}"),
            Self::Not(Not {
                not: OneOrMore::More(unwanted),
            }) => {
                write!(f, "outside {}", listed(unwanted))
            }
            Self::Within(Within { min, max }) => {
                let end = |end: &Option<f64>| end.map_or(String::new(), |end| end.to_string());
                write!(f, "in [{}, {}]", end(min), end(max))
            }
        }
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => write!(f, "{text:?}"),
        }
    }
}

fn listed(list: &[Wanted]) -> String {
    let list: Vec<String> = list.iter().map(Wanted::to_string).collect();
    format!("[{}]", list.join(", "))
}
