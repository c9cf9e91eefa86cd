//! Symbols, indices and exponents in texts: `F_{DP}` is an italic F with DP below the line, `T_{}` an
//! italic T, `10^{-3}` a power.

use super::{escape, pixels};
use std::fmt::Write;

/// Height [-] of an index or exponent by that of the text.
const SMALL: f64 = 0.72;
/// Depth [-] of an index below the line, and height of an exponent above it, by the height of the text.
const DROP: f64 = 0.22;
const RISE: f64 = 0.36;

/// A part of a text.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part<'a> {
    letters: &'a str,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Plain,
    /// The letter before an index.
    Symbol,
    Index,
    Exponent,
}

impl Kind {
    /// Height [-] by that of the text.
    fn size(self) -> f64 {
        match self {
            Self::Plain | Self::Symbol => 1.0,
            Self::Index | Self::Exponent => SMALL,
        }
    }

    /// Depth [-] below the line by the height of the text.
    fn depth(self) -> f64 {
        match self {
            Self::Plain | Self::Symbol => 0.0,
            Self::Index => DROP,
            Self::Exponent => -RISE,
        }
    }
}

fn parts(text: &str) -> Vec<Part<'_>> {
    let mut parts = Vec::new();
    let mut add = |letters, kind| parts.push(Part { letters, kind });
    let mut rest = text;
    while let Some(mark) = Mark::next(rest) {
        if mark.kind == Kind::Index {
            let last = mark.before.char_indices().next_back();
            let (plain, symbol) = mark.before.split_at(last.map_or(0, |(at, _)| at));
            add(plain, Kind::Plain);
            add(symbol, Kind::Symbol);
        } else {
            add(mark.before, Kind::Plain);
        }
        add(mark.letters, mark.kind);
        rest = mark.after;
    }
    add(rest, Kind::Plain);
    parts.retain(|part| !part.letters.is_empty());
    parts
}

/// An index or exponent in a text.
struct Mark<'a> {
    before: &'a str,
    kind: Kind,
    letters: &'a str,
    after: &'a str,
}

impl<'a> Mark<'a> {
    /// The first of a text.
    fn next(text: &'a str) -> Option<Self> {
        let index = text.find("_{").map(|at| (at, Kind::Index));
        let exponent = text.find("^{").map(|at| (at, Kind::Exponent));
        let marks = index.into_iter().chain(exponent);
        let (at, kind) = marks.min_by_key(|(at, _)| *at)?;
        let (letters, after) = text[at + 2..].split_once('}')?;
        Some(Self {
            before: &text[..at],
            kind,
            letters,
            after,
        })
    }
}

/// The letters of the text and how large [-] they are.
pub(super) fn letters(text: &str) -> impl Iterator<Item = (char, f64)> {
    let parts = parts(text).into_iter();
    parts.flat_map(|part| part.letters.chars().map(move |it| (it, part.kind.size())))
}

/// The text as the content of an SVG text of this `size` [px].
pub(super) fn typeset(text: &str, size: f64) -> String {
    let mut set = String::new();
    let mut depth = 0.0;
    for Part { letters, kind } in parts(text) {
        let letters = escape(letters);
        let mut attributes = match kind {
            Kind::Plain => String::new(),
            Kind::Symbol => r#" font-style="italic""#.to_owned(),
            Kind::Index | Kind::Exponent => format!(r#" font-size="{}""#, pixels(SMALL * size)),
        };
        if kind.depth() != depth {
            let shift = pixels((kind.depth() - depth) * size);
            attributes.push_str(&format!(r#" dy="{shift}""#));
        }
        depth = kind.depth();
        let _ = if attributes.is_empty() {
            write!(set, "{letters}")
        } else {
            write!(set, "<tspan{attributes}>{letters}</tspan>")
        };
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_index_stands_below_the_line_and_what_follows_on_it() {
        let set = typeset("pull F_{DP} < F_{N}", 10.0);
        let italic = r#"<tspan font-style="italic""#;
        let expected = format!(
            "pull {italic}>F</tspan><tspan font-size=\"7.2\" dy=\"2.2\">DP</tspan>\
             <tspan dy=\"-2.2\"> &lt; </tspan>{italic}>F</tspan>\
             <tspan font-size=\"7.2\" dy=\"2.2\">N</tspan>"
        );
        assert_eq!(set, expected);
    }

    #[test]
    fn a_power_stands_above_the_line_and_an_empty_index_makes_a_symbol() {
        assert_eq!(
            typeset("10^{−3} N", 10.0),
            "10<tspan font-size=\"7.2\" dy=\"-3.6\">−3</tspan><tspan dy=\"3.6\"> N</tspan>"
        );
        let italic = r#"torque <tspan font-style="italic">T</tspan> [N]"#;
        assert_eq!(typeset("torque T_{} [N]", 10.0), italic);
    }

    #[test]
    fn names_of_files_and_half_an_index_are_no_symbols() {
        for plain in ["run_000003", "F_{N", "}_{", "", "_"] {
            assert_eq!(typeset(plain, 10.0), plain);
        }
        assert_eq!(typeset("_{x}", 10.0).matches("italic").count(), 0);
    }
}
