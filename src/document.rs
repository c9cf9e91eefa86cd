//! A TOML text with the position of every key: to report the line of a fault, and to edit a value in place.
//!
//! Scenarios, studies and campaigns of measured runs are such texts; a [`Fault`] in one of them shows the
//! line concerned.

use crate::quantity::RangeError;
use serde::de::DeserializeOwned;
use std::cmp::Reverse;
use std::fmt;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer};

/// A fault with its byte range in the text.
#[derive(Debug)]
pub(crate) struct Misfit {
    pub(crate) place: Range<usize>,
    pub(crate) message: String,
}

impl From<toml::de::Error> for Misfit {
    fn from(error: toml::de::Error) -> Self {
        let place = error.span().unwrap_or(0..0);
        let message = in_plain_words(error.message());
        Self { place, message }
    }
}

/// A fault in the text of a scenario, study or campaign, and its place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub struct Fault {
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// What is wrong, and the way out.
    pub message: String,
    excerpt: String,
    width: usize,
}

impl Fault {
    pub(crate) fn new(file: &str, text: &str, Misfit { place, message }: Misfit) -> Self {
        let before = text.get(..place.start).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let excerpt = text[line_start..].lines().next().unwrap_or_default();
        let column = before[line_start..].chars().count() + 1;
        let marked = text.get(place).unwrap_or_default();
        let width = marked.lines().next().unwrap_or_default().chars().count();
        Self {
            file: file.to_owned(),
            line: before.matches('\n').count() + 1,
            column,
            message,
            excerpt: excerpt.to_owned(),
            width: width.max(1),
        }
    }

    /// This fault with the keys of a scenario that resemble an unknown one.
    pub(crate) fn with_hint(mut self, keys: &[String]) -> Self {
        let keys = keys.join("`, `");
        self.message = format!("{}; keys like it in this scenario: `{keys}`", self.message);
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file, line, column, ..
        } = self;
        let number = line.to_string();
        let gutter = " ".repeat(number.len());
        let indent: String = self
            .excerpt
            .chars()
            .take(column - 1)
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        let caret = "^".repeat(self.width);
        writeln!(f, "{file}:{line}:{column}: {}", self.message)?;
        writeln!(f, "{gutter} |")?;
        writeln!(f, "{number} | {}", self.excerpt)?;
        write!(f, "{gutter} | {indent}{caret}")
    }
}

/// A parsed text.
pub(crate) struct Document<'t> {
    text: &'t str,
    root: Spanned<DeValue<'t>>,
}

impl<'t> Document<'t> {
    /// # Errors
    /// `Misfit` where the text is not TOML.
    pub(crate) fn parse(text: &'t str) -> Result<Self, Misfit> {
        let table = DeTable::parse(text)?.into_inner();
        let root = Spanned::new(0..0, DeValue::Table(table));
        Ok(Self { text, root })
    }

    /// # Errors
    /// `Misfit` for unknown or missing keys, and for values of the wrong type.
    pub(crate) fn read<T: DeserializeOwned>(&self) -> Result<T, Misfit> {
        let table = self.root.get_ref().as_table().cloned().unwrap_or_default();
        let document = Deserializer::from(Spanned::new(0..0, table));
        Ok(T::deserialize(document)?)
    }

    /// The value of a dotted key; a number picks from an array.
    pub(crate) fn value(&self, path: &str) -> Option<&Spanned<DeValue<'t>>> {
        let (value, missing) = self.deepest(path);
        missing.is_empty().then_some(value)
    }

    /// Position of the value of a dotted key, or of the innermost table that would contain it.
    pub(crate) fn place(&self, path: &str) -> Range<usize> {
        self.deepest(path).0.span()
    }

    /// Where below `path` the value of a range error stands: the number with that value whose
    /// key shares the most words with the quantity; the table at `path` if there is none.
    pub(crate) fn place_of(&self, path: &str, error: &RangeError) -> Range<usize> {
        let (within, _) = self.deepest(path);
        let mut candidates = Vec::new();
        for_each_leaf("", within, &mut |key, value| {
            let shared = shared_words(last_key(key), error.quantity);
            if shared > 0 && number(value.get_ref()).is_some_and(|found| same(found, error.value)) {
                candidates.push((shared, Reverse(value.span().start), value.span().end));
            }
        });
        candidates
            .into_iter()
            .max()
            .map_or(within.span(), |(_, Reverse(start), end)| start..end)
    }

    /// Whether the table that would contain a dotted key exists.
    pub(crate) fn has_table_of(&self, path: &str) -> bool {
        path.rsplit_once('.')
            .is_none_or(|(table, _)| self.value(table).is_some())
    }

    /// Whether a key in some table has this name.
    pub(crate) fn has_key_ending_in(&self, name: &str) -> bool {
        let mut is_there = false;
        for_each_leaf("", &self.root, &mut |key, _| {
            is_there |= last_key(key) == name
        });
        is_there
    }

    /// Every dotted key with a value, for a message that lists those similar to `wanted`.
    pub(crate) fn keys_like(&self, wanted: &str) -> Vec<String> {
        let mut keys = Vec::new();
        for_each_leaf("", &self.root, &mut |key, _| keys.push(key.to_owned()));
        keys.sort_by_key(|key| {
            let same_end = last_key(key) == last_key(wanted);
            (!same_end, strsim::levenshtein(key, wanted))
        });
        keys.truncate(3);
        keys
    }

    /// The text with the value of a dotted key replaced, or the key added; nothing else changes.
    ///
    /// # Errors
    /// A message where the key holds a whole table with a header of its own.
    pub(crate) fn with_value(&self, path: &str, value: &str) -> Result<String, String> {
        match self.value(path) {
            Some(old) if self.has_header(old) => Err(format!(
                "`{path}` is a table; set the keys in it one by one"
            )),
            Some(old) => Ok(self.spliced(old.span(), value)),
            None => Ok(self.with_new(path, value)),
        }
    }

    fn with_new(&self, path: &str, value: &str) -> String {
        let mut table = path;
        while let Some((parent, _)) = table.rsplit_once('.') {
            table = parent;
            let Some(holder) = self.value(table) else {
                continue;
            };
            let key = &path[table.len() + 1..];
            let Range { start, end } = holder.span();
            match self.text.get(start..end).unwrap_or_default() {
                inline if inline.starts_with('{') => {
                    return self.spliced(start + 1..start + 1, &format!(" {key} = {value},"));
                }
                header if names(header, table) => {
                    return self.with_line_after(end, &format!("{key} = {value}"));
                }
                header if header.starts_with('[') => {
                    return format!("{}\n[{table}]\n{key} = {value}\n", self.text);
                }
                _ => {}
            }
        }
        let line = format!("{path} = {value}");
        let last = self
            .value("version")
            .map_or(0, |version| version.span().end);
        self.with_line_after(last, &line)
    }

    fn with_line_after(&self, byte: usize, line: &str) -> String {
        match self.text[byte..].find('\n') {
            Some(rest) => {
                let at = byte + rest + 1;
                self.spliced(at..at, &format!("{line}\n"))
            }
            None => format!("{}\n{line}\n", self.text),
        }
    }

    fn spliced(&self, place: Range<usize>, new: &str) -> String {
        let Self { text, .. } = self;
        format!("{}{new}{}", &text[..place.start], &text[place.end..])
    }

    fn has_header(&self, value: &Spanned<DeValue<'t>>) -> bool {
        let source = self.text.get(value.span()).unwrap_or_default();
        match value.get_ref() {
            DeValue::Table(_) => !source.starts_with('{'),
            DeValue::Array(_) => !source.starts_with('[') || source.starts_with("[["),
            _ => false,
        }
    }

    /// The innermost value along a path, and the remaining keys of the path.
    fn deepest<'p>(&self, path: &'p str) -> (&Spanned<DeValue<'t>>, Vec<&'p str>) {
        let mut keys = path.split('.').peekable();
        let mut value = &self.root;
        while let Some(inner) = keys.peek().and_then(|key| child(value.get_ref(), key)) {
            value = inner;
            keys.next();
        }
        (value, keys.collect())
    }
}

/// Rejects another version of a `kind` of file before its keys are checked, which may differ.
///
/// # Errors
/// `Misfit` where the version is missing or is not `version`.
pub(crate) fn check_version(document: &Document, kind: &str, version: i64) -> Result<(), Misfit> {
    let message = match document.value("version").map(|value| value.get_ref()) {
        Some(DeValue::Integer(found)) if found.as_str() == version.to_string() => return Ok(()),
        Some(DeValue::Integer(found)) => format!("{kind} version must be {version}, got {found}"),
        Some(_) => format!("{kind} version must be the number {version}"),
        None => format!("missing `version`; write `version = {version}` in the first line"),
    };
    Err(Misfit {
        place: document.place("version"),
        message,
    })
}

fn child<'v, 't>(value: &'v DeValue<'t>, key: &str) -> Option<&'v Spanned<DeValue<'t>>> {
    match value {
        DeValue::Array(array) => array.get(key.parse::<usize>().ok()?),
        DeValue::Table(table) => table.get(key),
        _ => None,
    }
}

fn for_each_leaf<'v, 't>(
    path: &str,
    value: &'v Spanned<DeValue<'t>>,
    visit: &mut impl FnMut(&str, &'v Spanned<DeValue<'t>>),
) {
    let join = |key: &str| match path {
        "" => key.to_owned(),
        path => format!("{path}.{key}"),
    };
    match value.get_ref() {
        DeValue::Table(table) => {
            for (key, inner) in table {
                for_each_leaf(&join(key.get_ref()), inner, visit);
            }
        }
        DeValue::Array(array) => {
            for (index, inner) in array.iter().enumerate() {
                for_each_leaf(&join(&index.to_string()), inner, visit);
            }
        }
        _ => visit(path, value),
    }
}

/// Whether `header` is `[path]` or the `[[path]]` of an entry of it.
fn names(header: &str, path: &str) -> bool {
    let written: String = header.chars().filter(|c| !c.is_whitespace()).collect();
    let entry = path.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
    written == format!("[{path}]") || written == format!("[[{entry}]]")
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(integer) => integer.as_str().parse().ok(),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}

fn same(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

fn last_key(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

fn shared_words(key: &str, quantity: &str) -> usize {
    key.split('_')
        .filter(|word| {
            quantity
                .split(|c: char| !c.is_alphanumeric())
                .any(|other| other == *word)
        })
        .count()
}

/// The parser's message; an unknown key also gets the known key closest to it.
fn in_plain_words(message: &str) -> String {
    if message.starts_with("wanted exactly 1 element") {
        return "this table names one kind of thing: keep one key in it".to_owned();
    }
    if message.contains("`$__toml_private_datetime`") {
        return "a date is no value here; write a date in quotes".to_owned();
    }
    let Some((unknown, known)) = unknown_and_known(message) else {
        return message.to_owned();
    };
    let distance = |known: &&str| strsim::levenshtein(known, unknown);
    match known.into_iter().min_by_key(distance) {
        Some(known) if distance(&known) <= unknown.chars().count() / 2 => {
            format!("{message}; did you mean `{known}`?")
        }
        _ => message.to_owned(),
    }
}

/// The unknown name of a parser's message, and the names that it lists as known.
fn unknown_and_known(message: &str) -> Option<(&str, Vec<&str>)> {
    // Of the table of an enum.
    if let Some(rest) = message.strip_prefix("unexpected keys in table: ") {
        let (unknown, known) = rest.split_once(", available keys: ")?;
        return Some((unknown.split(", ").next()?, known.split(", ").collect()));
    }
    let rest = message.strip_prefix("unknown ")?;
    let mut quoted = rest.split('`').skip(1).step_by(2);
    Some((quoted.next()?, quoted.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "version = 1 # first\n[rig.single_wheel] # the bed\nslip = 0.1 # -\nload = 0.1\n\
                        [wheel]\nlugs = { count = 28, height = 0.015 }\n[[effect]]\nname = \"slope\"\n";

    fn set(path: &str, value: &str) -> String {
        Document::parse(TEXT)
            .unwrap()
            .with_value(path, value)
            .unwrap()
    }

    #[test]
    fn a_key_is_replaced_where_it_stands_and_its_comment_stays() {
        let edited = TEXT.replace("slip = 0.1 # -", "slip = 0.3 # -");
        assert_eq!(set("rig.single_wheel.slip", "0.3"), edited);
        assert_eq!(set("wheel.lugs.count", "24"), TEXT.replace("28", "24"));
        assert_eq!(
            set("effect.0.name", "\"dust\""),
            TEXT.replace("slope", "dust")
        );
    }

    #[test]
    fn a_new_key_joins_its_table_in_every_spelling_of_a_table() {
        for path in [
            "duration",
            "rig.single_wheel.stop_at",
            "rig.rover_leg.load",
            "wheel.lugs.thickness",
            "wheel.rim.material",
            "effect.0.magnitude",
            "sensors.output_rate",
        ] {
            let edited = set(path, "7");
            let document = Document::parse(&edited).unwrap_or_else(|e| panic!("{edited}{e:?}"));
            let found = document
                .value(path)
                .and_then(|value| number(value.get_ref()));
            assert_eq!(found, Some(7.0), "{path} in\n{edited}");
            assert!(edited.starts_with("version = 1 # first\n"), "{edited}");
        }
    }

    #[test]
    fn a_table_with_a_header_is_not_a_value() {
        let document = Document::parse(TEXT).unwrap();
        for path in ["wheel", "rig", "rig.single_wheel", "effect", "effect.0"] {
            assert!(document.with_value(path, "1").is_err(), "{path}");
        }
        assert!(document.with_value("wheel.lugs", "{ count = 1 }").is_ok());
    }

    #[test]
    fn of_equal_values_the_one_named_like_the_quantity_is_meant() {
        let error = |quantity| RangeError {
            quantity,
            unit: "-",
            range: String::new(),
            value: 0.1,
        };
        let document = Document::parse(TEXT).unwrap();
        let start = |quantity| document.place_of("rig", &error(quantity)).start;
        assert_eq!(start("slip ratio"), TEXT.find("0.1 # -").unwrap());
        assert_eq!(start("load"), TEXT.find("0.1\n").unwrap());
    }

    #[test]
    fn an_unknown_key_is_reported_with_its_nearest_neighbour() {
        let message = in_plain_words("unknown field `slop`, expected one of `load`, `slip`");
        assert!(message.ends_with("did you mean `slip`?"), "{message}");
        let message = in_plain_words("unknown field `moon`, expected `slip`");
        assert!(message.ends_with("expected `slip`"), "{message}");
        let message =
            in_plain_words("unexpected keys in table: sooil, available keys: soil, roughness");
        assert!(message.ends_with("did you mean `soil`?"), "{message}");
    }
}
