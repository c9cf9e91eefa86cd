//! A part of the schema of scenario files, its references followed.

use crate::scenario::schema::plain;
use serde_json::Value;

/// A number as the schema has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Real,
    Whole,
}

/// A key in the schema.
#[derive(Clone, Copy)]
pub(super) struct Part<'s> {
    schema: &'s Value,
    /// The definition that the key refers to.
    pub(super) name: Option<&'s str>,
    comment: &'s str,
    default: Option<&'s Value>,
    /// Whether it stands for nothing where it is left out.
    is_optional: bool,
}

impl<'s> Part<'s> {
    /// The `part` of a schema.
    pub(super) fn of(root: &'s Value, part: &'s Value) -> Self {
        let wrapped = ["allOf", "anyOf"]
            .into_iter()
            .find_map(|word| part[word].as_array());
        // The other choice of an optional key is null.
        let target = match wrapped {
            Some(choices) => &choices[0]["$ref"],
            None => &part["$ref"],
        };
        let name = target.as_str().and_then(|target| target.rsplit('/').next());
        let schema = name.map_or(part, |name| &root["definitions"][name]);
        let comment = part["description"].as_str();
        Self {
            schema,
            name,
            comment: comment
                .or(schema["description"].as_str())
                .unwrap_or_default(),
            default: part.get("default"),
            is_optional: part["anyOf"].is_array() || part["type"].is_array(),
        }
    }

    /// This part, with the comment of what it is a choice of where it has none.
    fn or_comment(self, comment: &'s str) -> Self {
        match self.comment {
            "" => Self { comment, ..self },
            _ => self,
        }
    }

    /// What it is, in a line.
    pub(super) fn meaning(&self) -> String {
        plain(self.comment)
    }

    /// The keys of the table, by name.
    pub(super) fn properties(&self) -> impl Iterator<Item = (&'s str, &'s Value)> + use<'s> {
        let properties = self.schema["properties"].as_object().into_iter().flatten();
        properties.map(|(name, property)| (name.as_str(), property))
    }

    /// Names of the keys that the table is refused without.
    pub(super) fn required(&self) -> Vec<&'s str> {
        let required = self.schema["required"].as_array().into_iter().flatten();
        required.filter_map(Value::as_str).collect()
    }

    /// The keys of which exactly one is given, each a table or a list of tables.
    pub(super) fn variants(&self, root: &'s Value) -> Vec<(&'s str, Self)> {
        let one_of = self.schema["oneOf"].as_array().into_iter().flatten();
        let variant = |choice: &'s Value| {
            let (name, inner) = choice["properties"].as_object()?.iter().next()?;
            let comment = choice["description"].as_str().unwrap_or_default();
            Some((name.as_str(), Self::of(root, inner).or_comment(comment)))
        };
        one_of.filter_map(variant).collect()
    }

    pub(super) fn is_table(&self) -> bool {
        let mut one_of = self.schema["oneOf"].as_array().into_iter().flatten();
        self.schema["properties"].is_object()
            || one_of.any(|choice| choice["properties"].is_object())
    }

    /// The entries of a list of tables.
    pub(super) fn entries(&self, root: &'s Value) -> Option<Self> {
        let entry = self
            .schema
            .get("items")
            .map(|entry| Self::of(root, entry))?;
        entry.is_table().then_some(entry)
    }

    /// The number that the key holds.
    pub(super) fn number(&self) -> Option<Number> {
        if self.has_type("number") {
            Some(Number::Real)
        } else if self.has_type("integer") {
            Some(Number::Whole)
        } else {
            None
        }
    }

    /// The values of a key that is no number, where they are few.
    pub(super) fn choices(&self) -> Option<String> {
        if self.has_type("boolean") {
            return Some("true or false".to_owned());
        }
        let listed = |schema: &'s Value| {
            let several = schema["enum"].as_array().into_iter().flatten();
            several.chain(schema.get("const"))
        };
        let one_of = self.schema["oneOf"].as_array().into_iter().flatten();
        let choices = listed(self.schema).chain(one_of.flat_map(listed));
        let choices: Vec<String> = choices.map(Value::to_string).collect();
        (!choices.is_empty()).then(|| choices.join(" or "))
    }

    /// The value where the key is left out, as TOML.
    pub(super) fn default(&self, is_required: bool) -> Option<String> {
        match self.default {
            // JSON has no infinity.
            Some(Value::Null) => Some("inf".to_owned()),
            Some(default) => Some(default.to_string()),
            None if is_required || self.is_optional => None,
            // What is neutral is not written into files, and so not into the schema.
            None => self.has_type("number").then(|| "0.0".to_owned()),
        }
    }

    /// Whether it is of this type, or may be left out.
    fn has_type(&self, name: &str) -> bool {
        match &self.schema["type"] {
            Value::Array(types) => types.iter().any(|it| it == name),
            only => only == name,
        }
    }
}
