//! `gelenk schema`, and the tables of models/README.md, which are made from it.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;

use super::gelenk;

fn schema() -> Value {
    serde_json::from_slice(&gelenk(Path::new("."), &["schema"]).stdout).unwrap()
}

/// A value as TOML in one line.
fn toml(value: &Value) -> String {
    match value {
        Value::Array(entries) => format!("[{}]", entries.iter().map(toml).collect::<Vec<_>>().join(", ")),
        Value::Object(entries) => {
            let is_bare = |key: &str| key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
            let key = |key: &str| if is_bare(key) { key.to_owned() } else { format!("{key:?}") };
            let entries = entries.iter().map(|(name, value)| format!("{} = {}", key(name), toml(value)));
            format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

/// The rows of a table: key, example, meaning.
fn rows(table: &Value) -> String {
    let mut text = "| key | example | meaning |\n|---|---|---|\n".to_owned();
    for (name, property) in table["properties"].as_object().unwrap() {
        let example = toml(&property["examples"][0]).replace('|', "\\|");
        let meaning = property["description"].as_str().unwrap().replace('|', "\\|");
        writeln!(text, "| `{name}` | `{example}` | {meaning} |").unwrap();
    }
    text
}

/// `GELENK_UPDATE=keys` writes the tables.
#[test]
fn the_tables_of_the_page_are_those_of_the_schema() {
    let schema = schema();
    let mut tables = schema["$defs"].as_object().unwrap().clone();
    tables.insert("robot".to_owned(), schema.clone());
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/README.md");
    let page = fs::read_to_string(&file).unwrap();
    let mut fresh = page.clone();
    assert_eq!(page.matches("<!-- keys: ").count(), tables.len());
    for (name, table) in &tables {
        let (start, end) = (format!("<!-- keys: {name} -->\n"), "<!-- end of keys -->\n");
        let (before, rest) =
            fresh.split_once(&start).unwrap_or_else(|| panic!("no place for the keys of {name}"));
        let (_, after) = rest.split_once(end).unwrap();
        fresh = format!("{before}{start}{}{end}{after}", rows(table));
    }
    if std::env::var_os("GELENK_UPDATE").is_some_and(|value| value == "keys") {
        fs::write(&file, &fresh).unwrap();
    }
    let written = fs::read_to_string(&file).unwrap();
    assert!(written == fresh, "models/README.md is not fresh: run this test with GELENK_UPDATE=keys");
}
