//! The schema of scenario files, for editors.
//!
//! [`schemars`] derives it from the structs that read a file: names, types, defaults and, from the doc comments,
//! descriptions. TOML has no `null`: a key is left out in its stead, so that the schema does not mention it.

use super::Scenario;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value};

/// The JSON schema (draft 7) of scenario files.
pub fn json_schema() -> Value {
    let mut schema = derived();
    clean(&mut schema);
    schema
}

/// The schema as it is derived, where `null` stands for what is left out and for infinite numbers.
pub(super) fn derived() -> Value {
    let generator = SchemaSettings::draft07().into_generator();
    generator.into_root_schema_for::<Scenario>().to_value()
}

/// Takes out what TOML has not, and what the doc comments have for rustdoc only.
fn clean(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            clean_object(map);
            map.values_mut().for_each(clean);
        }
        Value::Array(values) => values.iter_mut().for_each(clean),
        _ => {}
    }
}

fn clean_object(map: &mut Map<String, Value>) {
    if let Some(Value::Array(types)) = map.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            map.insert("type".to_owned(), only);
        }
    }
    if let Some(Value::Array(choices)) = map.get_mut("anyOf") {
        choices.retain(|choice| choice.get("type") != Some(&"null".into()));
    }
    // JSON has no infinity; the keys of a table have their own defaults.
    if matches!(map.get("default"), Some(Value::Null | Value::Object(_))) {
        map.remove("default");
    }
    // Of numbers in memory, as `double`.
    map.remove("format");
    if let Some(Value::String(description)) = map.get_mut("description") {
        *description = plain(description);
    }
}

/// A doc comment in one line, links replaced by their words and escaped brackets by plain ones.
pub(super) fn plain(comment: &str) -> String {
    let words: Vec<&str> = comment.split_whitespace().collect();
    let mut rest = &words.join(" ")[..];
    let mut text = String::new();
    while let Some(start) = rest.find("[`") {
        let (before, link) = rest.split_at(start);
        let Some((name, after)) = link[2..].split_once("`]") else {
            break;
        };
        text.push_str(&format!("{before}`{name}`"));
        // The target of a link that has one.
        let target = after.strip_prefix('(').and_then(|it| it.split_once(')'));
        rest = target.map_or(after, |(_, after)| after);
    }
    text.push_str(rest);
    text.replace("\\[", "[").replace("\\]", "]")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_a_doc_comment_become_words() {
        let comment = "One, unless\n[`passes`](Self::passes) is set; see [`Scenario::window`] [s].";
        assert_eq!(
            plain(comment),
            "One, unless `passes` is set; see `Scenario::window` [s]."
        );
    }

    #[test]
    fn the_schema_has_no_null_and_describes_each_key() {
        let schema = json_schema();
        let text = schema.to_string();
        assert!(!text.contains("null"), "{schema:#}");
        let load = &schema["definitions"]["SingleWheel"]["properties"]["load"];
        assert_eq!(load["type"], "number");
        assert!(
            load["description"]
                .as_str()
                .unwrap()
                .starts_with("Vertical load")
        );
    }
}
