//! The command `gelenk schema`, which prints the JSON Schema of descriptions for editors.

use std::collections::BTreeSet;
use std::process::ExitCode;

use serde_json::{Map, Value as Json, json};
use toml::de::{DeTable, DeValue};

use super::failure::Failure;
use super::print;
use crate::read::toml::keys::{FREE, Key, Keys, ROBOT, Value, parts};

/// File name of the schema, to which descriptions refer.
pub(super) const FILE: &str = "gelenk.schema.json";

/// Prints the JSON Schema of descriptions.
pub(super) fn schema() -> Result<ExitCode, Failure> {
    print::json(&of_descriptions())
}

/// The JSON Schema of descriptions.
pub(super) fn of_descriptions() -> Json {
    let mut definitions = Map::new();
    let top = table(&ROBOT, &mut definitions);
    let mut schema = Map::new();
    schema.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    schema.insert("title".to_owned(), json!("Robot description of gelenk"));
    schema.extend(top.as_object().cloned().unwrap_or_default());
    schema.insert("$defs".to_owned(), Json::Object(definitions));
    Json::Object(schema)
}

/// Keywords for the keys of a table. The type is added by the value that refers to the table, because the
/// value may have other types, too.
fn table(keys: &'static Keys, definitions: &mut Map<String, Json>) -> Json {
    let needed: Vec<&str> = keys.rows().filter(|row| row.is_needed).map(|row| row.name).collect();
    let properties: Map<String, Json> =
        keys.rows().map(|row| (row.name.to_owned(), property(row, definitions))).collect();
    json!({ "properties": properties, "required": needed, "additionalProperties": false })
}

/// A reference to the definition of a table. The definition is added if it is missing.
fn reference(keys: &'static Keys, definitions: &mut Map<String, Json>) -> Json {
    if !definitions.contains_key(keys.name) {
        let table = table(keys, definitions);
        definitions.insert(keys.name.to_owned(), table);
    }
    json!({ "allOf": [{ "$ref": format!("#/$defs/{}", keys.name) }] })
}

fn property(row: &'static Key, definitions: &mut Map<String, Json>) -> Json {
    let mut property = Map::new();
    property.insert("description".to_owned(), json!(row.description()));
    property.insert("examples".to_owned(), example(row));
    property.extend(value(&row.value, definitions));
    Json::Object(property)
}

/// The schema of a key's value. The alternatives have different types, and a keyword only concerns values of
/// its type, so the keywords of all alternatives are combined. `anyOf` would hide which key is wrong. If two
/// alternatives are tables, they become one table with the keys of both; the program itself reports keys that
/// exclude each other.
fn value(value: &'static Value, definitions: &mut Map<String, Json>) -> Map<String, Json> {
    let (mut types, mut tables) = (BTreeSet::<&str>::new(), Vec::new());
    let (mut schema, mut of_parts) = (Map::new(), Map::new());
    let mut waiting = vec![value];
    while let Some(next) = waiting.pop() {
        types.extend(types_of(next));
        tables.extend(match next {
            Value::Formula => Some(&FREE),
            Value::Table(keys) => Some(*keys),
            _ => None,
        });
        match next {
            Value::Either(values) => waiting.extend(*values),
            Value::ByPart(entry) => {
                waiting.push(entry);
                let entry = Json::Object(self::value(entry, definitions));
                of_parts = parts().into_iter().map(|part| (part.to_owned(), entry.clone())).collect();
            }
            _ => {}
        }
        schema.extend(keywords(next, definitions).as_object().cloned().unwrap_or_default());
    }
    schema.insert("type".to_owned(), if types.len() == 1 { json!(types.first()) } else { json!(types) });
    let tables = match tables[..] {
        [] if of_parts.is_empty() => json!({}),
        [keys] if of_parts.is_empty() => reference(keys, definitions),
        _ => {
            for keys in &tables {
                let _ = reference(keys, definitions);
            }
            let rows = tables.into_iter().flat_map(Keys::rows);
            let keys = rows.map(|row| (row.name.to_owned(), property(row, definitions)));
            let keys: Map<String, Json> = keys.collect::<Vec<_>>().into_iter().chain(of_parts).collect();
            json!({ "properties": keys, "additionalProperties": false })
        }
    };
    schema.extend(tables.as_object().cloned().unwrap_or_default());
    schema
}

fn types_of(value: &Value) -> &'static [&'static str] {
    match value {
        Value::Text | Value::Name | Value::Law | Value::Words(_) => &["string"],
        Value::Flag => &["boolean"],
        Value::Number | Value::Positive => &["number", "string"],
        Value::Formula => &["number", "string", "object"],
        Value::List(..) | Value::Pair(_) => &["array"],
        Value::Table(_) | Value::Names(_) | Value::ByPart(_) => &["object"],
        Value::Either(_) => &[],
    }
}

/// Schema keywords for the types of a value, without the keys of tables.
fn keywords(value: &'static Value, definitions: &mut Map<String, Json>) -> Json {
    let mut of = |entry| self::value(entry, definitions);
    match value {
        Value::Name => json!({ "minLength": 1 }),
        Value::Positive => json!({ "exclusiveMinimum": 0 }),
        Value::Words(words) => json!({ "pattern": format!("^({})$", words.join("|")) }),
        Value::List(entry, None) => json!({ "items": of(entry) }),
        Value::List(entry, Some(count)) => {
            json!({ "items": of(entry), "minItems": count, "maxItems": count })
        }
        Value::Pair([first, second]) => {
            json!({ "prefixItems": [of(first), of(second)], "minItems": 2, "maxItems": 2 })
        }
        Value::Names(entry) => json!({ "additionalProperties": of(entry) }),
        _ => json!({}),
    }
}

/// The example of a key as a list of one value. A test ensures that each example can be parsed.
fn example(row: &Key) -> Json {
    let text = format!("example = {}", row.example);
    let (table, _) = DeTable::parse_recoverable(&text);
    table.get_ref().get("example").map(|value| json_of(value.get_ref())).into_iter().collect()
}

fn json_of(value: &DeValue<'_>) -> Json {
    match value {
        DeValue::String(text) => json!(text.as_ref()),
        DeValue::Boolean(flag) => json!(flag),
        DeValue::Array(entries) => entries.iter().map(|entry| json_of(entry.get_ref())).collect(),
        DeValue::Table(table) => {
            let entry =
                |(key, value): (&toml::Spanned<toml::de::DeString<'_>>, &toml::Spanned<DeValue<'_>>)| {
                    (key.get_ref().to_string(), json_of(value.get_ref()))
                };
            let mut entries: Vec<_> = table.iter().collect();
            entries.sort_by_key(|(key, _)| key.span().start);
            Json::Object(entries.into_iter().map(entry).collect())
        }
        DeValue::Integer(number) => serde_json::from_str(number.as_str()).unwrap_or_default(),
        DeValue::Float(number) => serde_json::from_str(number.as_str()).unwrap_or_default(),
        DeValue::Datetime(_) => Json::Null,
    }
}
