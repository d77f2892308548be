//! The page of all rules of findings, from the comments above them.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Sections of the comment above a rule, in this order.
const PARTS: [&str; 4] = ["Sees", "Matters", "Example", "Fixture"];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

/// Rows of the table by the codes of the rules in a source.
fn rules(text: &str, place: &str, rows: &mut BTreeMap<String, String>) {
    let lines: Vec<&str> = text.lines().collect();
    for (number, line) in lines.iter().enumerate() {
        let Some((_, rule)) = line.split_once(": Rule = Rule::") else { continue };
        let (level, code) = rule.split_once("(\"").expect("a level and a code");
        let code = code.trim_end_matches("\");");
        let part = |(k, name): (usize, &&str)| -> String {
            let line = lines[number - PARTS.len() + k];
            let said = line.strip_prefix(&format!("/// {name}: "));
            said.unwrap_or_else(|| panic!("{place}: `{code}` has no line `/// {name}: …`")).to_owned()
        };
        let parts: Vec<String> = PARTS.iter().enumerate().map(part).collect();
        let row = format!("| `{code}` | {level} | {} |", parts.join(" | "));
        assert!(rows.insert(code.to_owned(), row).is_none(), "{place}: `{code}` is there twice");
    }
}

/// All tests that fixtures may name, and the snapshots of findings.
fn fixtures(root: &Path) -> String {
    let mut files = Vec::new();
    for folder in ["runtime/identification/src", "runtime/tests", "codegen/tests"] {
        sources(&root.join(folder), &mut files);
    }
    let snapshots = fs::read_dir(root.join("codegen/tests/snapshots/findings")).expect("snapshots");
    files.extend(snapshots.map(|entry| entry.expect("an entry").path()));
    files.iter().map(|file| fs::read_to_string(file).expect("a text")).collect()
}

/// `GELENK_UPDATE=findings` writes the page.
#[test]
fn the_page_of_findings_is_that_of_the_rules() {
    let root = gelenk_tests::workspace();
    let mut files = Vec::new();
    for folder in ["runtime/identification/src", "codegen/src/cli/identify"] {
        sources(&root.join(folder), &mut files);
    }
    let mut rows = BTreeMap::new();
    for file in &files {
        rules(&fs::read_to_string(file).expect("a source"), &file.display().to_string(), &mut rows);
    }
    let mut page = String::from(
        "# Findings of `gelenk identify`\n\nEach line of its output that begins with `error[CODE]`, `warning[CODE]` or `note[CODE]` is a \
         finding. This page is made from the comments of the rules, by the test `findings` of the package `tests`.\n\n\
         | code | level | sees | matters | example | fixture |\n|---|---|---|---|---|---|\n",
    );
    rows.values().for_each(|row| writeln!(page, "{row}").expect("a text"));
    let text: String = fixtures(&root);
    for row in rows.values() {
        let fixture = row.rsplit(" | ").next().expect("a fixture");
        let named: Vec<&str> = fixture.split('`').skip(1).step_by(2).collect();
        assert!(!named.is_empty(), "{row}");
        let is_there = |name: &&str| match name.strip_suffix(".rs") {
            Some(_) => {
                ["", "runtime/identification/src"].iter().any(|folder| root.join(folder).join(name).is_file())
            }
            None => text.contains(&format!("fn {name}(")) || text.contains(&format!("\n== {name}, exit ")),
        };
        assert!(named.iter().all(is_there), "its fixture is not there: {row}");
    }
    let path = root.join("codegen/docs/findings.md");
    if std::env::var_os("GELENK_UPDATE").is_some_and(|value| value == "findings") {
        fs::write(&path, &page).expect("the page");
    }
    let written = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        written == page,
        "codegen/docs/findings.md is not fresh: run this test with GELENK_UPDATE=findings"
    );
}
