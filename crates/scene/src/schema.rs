//! The scene reference as a JSON Schema, with which editors complete keys and check values.

use lennard_core::options::Allowed;
use lennard_literature::units::dimension_of;
use serde_json::{Map, Value, json};

use crate::reference::{self, Form, KeyDoc, TableDoc};

/// The draft that editors of TOML files know.
const DRAFT: &str = "http://json-schema.org/draft-07/schema#";

/// The JSON Schema of a scene file: what [`mod@reference`] says, for editors.
///
/// A schema is weaker than the program. It knows tables, keys, types, names and ranges. It does not know which keys exclude
/// each other, and a key of one method passes beside another method.
#[must_use]
pub fn schema() -> Value {
    let mut root = object_of("");
    let properties = &mut root["properties"];
    for table in reference::tables() {
        if matches!(table.form, Form::Once | Form::Many) {
            properties[table.table] = table_of(table);
        }
    }
    root["$schema"] = json!(DRAFT);
    root["title"] = json!("A scene of lennard");
    root
}

/// A table, or a list of them where the heading has two brackets.
fn table_of(table: &TableDoc) -> Value {
    let mut object = object_of(table.table);
    object["description"] = json!(table.meaning);
    if table.form == Form::Many { json!({ "type": "array", "items": object }) } else { object }
}

/// An object with the keys of one table. Keys of the same name that belong to several methods share one entry.
fn object_of(table: &str) -> Value {
    let mut properties = Map::new();
    let keys: Vec<&KeyDoc> = of_table(table).collect();
    for doc in &keys {
        let same: Vec<&KeyDoc> = keys.iter().filter(|d| d.key == doc.key).copied().collect();
        properties.entry(doc.key).or_insert_with(|| property(table, &same));
    }
    // A key of one method is not needed by the others.
    let needed: Vec<&str> = keys
        .iter()
        .filter(|doc| doc.method.is_none() && doc.default == "needed" && !has_alternative(doc))
        .map(|doc| doc.key)
        .collect();
    let mut object = json!({
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    if !needed.is_empty() {
        object["required"] = json!(needed);
    }
    object
}

fn of_table(table: &str) -> impl Iterator<Item = &'static KeyDoc> {
    reference::keys().iter().filter(move |doc| doc.table == table)
}

/// Particles may also come as molecules or from a file.
fn has_alternative(doc: &KeyDoc) -> bool {
    (doc.table, doc.key) == ("system", "n_atoms")
}

/// One key: what any of the methods allows that have it.
fn property(table: &str, docs: &[&KeyDoc]) -> Value {
    let nested = match table {
        "" => docs[0].key.to_owned(),
        _ => format!("{table}.{}", docs[0].key),
    };
    let mut variants: Vec<Value> = docs.iter().filter_map(|doc| values(doc.allowed)).collect();
    variants.dedup();
    if let Some(inner) = reference::tables().iter().find(|t| t.table == nested) {
        if variants.is_empty() {
            variants.push(json!({ "type": "string", "enum": short_forms(inner.table) }));
        }
        variants.push(object_of(inner.table));
    }
    if docs.iter().any(|doc| dimension_of(doc.unit).is_some()) {
        let numbers = variants.iter_mut().filter(|variant| variant["type"] == "number");
        numbers.for_each(with_unit);
    }
    let mut out = match variants.len() {
        0 => json!({}),
        1 => variants.remove(0),
        _ => json!({ "anyOf": variants }),
    };
    let words: Vec<String> = docs.iter().map(|doc| description(doc)).collect();
    out["description"] = json!(words.join("\n"));
    if let [doc] = docs
        && let Ok(value) = serde_json::from_str::<Value>(plain(&doc.default))
    {
        out["default"] = value;
    }
    out
}

/// What may stand in place of a table with a `kind`: "none", or the name of a method.
fn short_forms(table: &str) -> Vec<&'static str> {
    let kinds = of_table(table).find_map(|doc| match doc.allowed {
        Allowed::Names(names) if doc.key == "kind" => Some(names()),
        _ => None,
    });
    std::iter::once("none").chain(kinds.unwrap_or_default()).collect()
}

/// A number may have a unit: it is a text then, and the range does not hold for it.
fn with_unit(variant: &mut Value) {
    variant["type"] = json!(["number", "string"]);
    variant["pattern"] = json!("^[-+.0-9].*[^-+.0-9]");
}

/// Type and range of a value; `None` where words alone describe it.
fn values(allowed: Allowed) -> Option<Value> {
    Some(match allowed {
        Allowed::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Allowed::NotNegative => json!({ "type": "number", "minimum": 0 }),
        Allowed::Between(from, to) | Allowed::BetweenElse(from, to, _) => {
            json!({ "type": "number", "minimum": from, "maximum": to })
        }
        Allowed::ZeroOrBetween(_, to) => json!({ "type": "number", "minimum": 0, "maximum": to }),
        Allowed::Whole(from, to) => json!({ "type": "integer", "minimum": from, "maximum": to }),
        Allowed::Flag => json!({ "type": "boolean" }),
        Allowed::Names(names) => json!({ "type": "string", "enum": names() }),
        Allowed::Words(_) => return None,
    })
}

/// A default without the backticks around it, where it is one piece of code and no sentence.
fn plain(default: &str) -> &str {
    let code = default.strip_prefix('`').and_then(|rest| rest.strip_suffix('`'));
    code.filter(|code| !code.contains('`')).unwrap_or(default)
}

/// Meaning, unit, values and default of a key in words.
fn description(doc: &KeyDoc) -> String {
    let unit = match doc.unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let method = doc.method.map_or(String::new(), |m| format!(" Only with `{m}`."));
    format!(
        "{}{unit} Allowed: {}. Default: {}.{method}",
        doc.meaning,
        doc.allowed.text(),
        plain(&doc.default)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_reference_is_in_the_schema() {
        let schema = schema();
        for doc in reference::keys() {
            let mut at = &schema;
            for part in doc.table.split('.').filter(|p| !p.is_empty()) {
                at = &at["properties"][part];
                if let Some(variants) = at["anyOf"].as_array() {
                    at = variants.last().unwrap();
                }
                if at["type"] == "array" {
                    at = &at["items"];
                }
            }
            let key = &at["properties"][doc.key];
            assert!(key.is_object(), "{}.{}", doc.table, doc.key);
            assert!(key["description"].as_str().unwrap().contains(doc.meaning), "{key}");
        }
    }

    #[test]
    fn names_ranges_and_needed_keys_are_told() {
        let schema = schema();
        let cutoff = &schema["properties"]["truncation"]["properties"]["r_cut"];
        assert_eq!(cutoff["default"], 2.5);
        assert_eq!(cutoff["minimum"], 0.1);
        let stage = &schema["properties"]["stage"]["items"];
        assert_eq!(stage["required"], json!(["name", "steps"]));
        let bath = &stage["properties"]["thermostat"]["anyOf"];
        assert!(bath[0]["enum"].as_array().unwrap().contains(&json!("bussi")));
        assert_eq!(bath[1]["required"], json!(["kind"]));
        let wall = &schema["properties"]["wall"]["items"];
        assert_eq!(wall["required"], json!(["kind"]));
    }
}
