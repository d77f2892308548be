//! The reader reads every key of the tables, with the types of their rows.

use super::{FREE, Key, Keys, ROBOT, Value};
use crate::diagnostic::Diagnostic;
use crate::read::from_toml;
use crate::read::options::ReadOptions;
use std::collections::BTreeSet;

/// A table and the text around it.
struct Place {
    keys: &'static Keys,
    before: String,
    after: String,
}

/// Places of all tables, each once.
fn places() -> Vec<Place> {
    let mut places = vec![Place { keys: &ROBOT, before: String::new(), after: String::new() }];
    let mut seen = BTreeSet::from([ROBOT.name]);
    let mut next = 0;
    while let Some(outer) = places.get(next) {
        let mut found = Vec::new();
        for row in outer.keys.rows() {
            for (keys, [open, close]) in
                tables(&row.value).into_iter().filter(|(keys, _)| seen.insert(keys.name))
            {
                let first = outer.keys.rows().next().map(|first| first.name);
                let is_context = |other: &&Key| other.is_needed || Some(other.name) == first;
                let others = outer.keys.rows().filter(|other| other.name != row.name);
                let needed = entries(others.filter(is_context));
                let separator = if outer.keys.name == ROBOT.name { "\n" } else { ", " };
                let needed = needed.iter().map(|entry| format!("{entry}{separator}")).collect::<String>();
                let before = format!("{}{needed}{} = {open}{{ ", outer.before, row.name);
                found.push(Place { keys, before, after: format!(" }}{close}{}", outer.after) });
            }
        }
        places.extend(found);
        next += 1;
    }
    places
}

/// The tables in a value, with the brackets around them.
fn tables(value: &'static Value) -> Vec<(&'static Keys, [String; 2])> {
    let within = |entry: &'static Value, before: &str, after: &str| -> Vec<(&'static Keys, [String; 2])> {
        let around = |(keys, [open, close]): (&'static Keys, [String; 2])| {
            (keys, [format!("{before}{open}"), format!("{close}{after}")])
        };
        tables(entry).into_iter().map(around).collect()
    };
    match value {
        Value::Table(keys) => vec![(*keys, [String::new(), String::new()])],
        Value::Formula => vec![(&FREE, [String::new(), String::new()])],
        Value::List(entry, None) => within(entry, "[", "]"),
        Value::Names(entry) => within(entry, "{ m = ", " }"),
        Value::ByPart(entry) => within(entry, "", ""),
        Value::Either(values) => values.iter().flat_map(|each| within(each, "", "")).collect(),
        _ => Vec::new(),
    }
}

fn entries<'k>(rows: impl Iterator<Item = &'k Key>) -> Vec<String> {
    rows.map(|row| format!("{} = {}", row.name, row.example)).collect()
}

/// Messages of the reader about these entries at a place.
fn said(place: &Place, entries: &[String]) -> Vec<Diagnostic> {
    let separator = if place.keys.name == ROBOT.name { "\n" } else { ", " };
    let text = format!("{}{}{}", place.before, entries.join(separator), place.after);
    let mut load = |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
    let read = from_toml(&text, "robot.toml", &ReadOptions::default(), &mut load);
    let said = read.map_or_else(|wrong| wrong, |(_, notes)| notes).into_entries();
    assert!(said.iter().all(|entry| entry.code != "toml-syntax"), "{text}: {said:?}");
    said
}

/// No key takes a date, so the reader does not read a key about which it reports nothing.
#[test]
fn every_key_is_read() {
    let mut count = 0;
    for place in places() {
        for row in place.keys.rows() {
            let date = format!("{} = 1979-05-27", row.name);
            let among = |is_context: &dyn Fn(&Key) -> bool| {
                let others = place.keys.rows().filter(|other| other.name != row.name && is_context(other));
                let said = said(&place, &[entries(others), vec![date.clone()]].concat());
                said.iter().any(|entry| {
                    entry.code == "wrong-type" && entry.message.starts_with(&format!("`{}` ", row.name))
                })
            };
            let is_read =
                among(&|other| other.is_needed) || among(&|other| !["urdf", "extends"].contains(&other.name));
            assert!(is_read, "`{}` of {} is not read", row.name, place.keys.what);
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}

#[test]
fn every_example_has_the_type_of_its_key() {
    let of_values = ["unknown-key", "wrong-type", "wrong-length", "not-positive", "unknown-value"];
    for place in places() {
        for row in place.keys.rows() {
            let entries =
                entries(place.keys.rows().filter(|other| other.is_needed || other.name == row.name));
            for entry in said(&place, &entries) {
                let is_of_value = of_values.contains(&entry.code);
                assert!(!is_of_value, "`{}` of {}: {entry}", row.name, place.keys.what);
            }
        }
    }
}

#[test]
fn an_unknown_key_is_an_error_in_every_table() {
    for place in places() {
        let said = said(&place, &["no_such_key = 1".to_owned()]);
        let is_reported = said.iter().any(|entry| entry.code == "unknown-key" && entry.remedy.is_some());
        assert!(is_reported, "{}", place.keys.what);
    }
}
