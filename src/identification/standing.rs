//! Origin of a parameter's value.

use serde::Serialize;
use std::fmt;

/// How a parameter got its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// Identified by the data.
    Identified,
    /// Not identifiable: the value serves only for predictions together with the others.
    NotIdentifiable,
    /// The class sets it (Table 4).
    SetByClass,
    /// It was [known](super::Known) before.
    Given,
}

impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Identified => "identified",
            Self::NotIdentifiable => "not identifiable",
            Self::SetByClass => "set by class",
            Self::Given => "given",
        })
    }
}
