//! The page of all rules of findings and lints, from the comments above them.

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

/// Sections of the page with the folders of their rules.
const SECTIONS: [(&str, &[&str]); 2] = [
    (
        "Logs and fits (`gelenk identify`)",
        &["runtime/identification/src", "codegen/src/identify", "codegen/src/cli/identify"],
    ),
    ("Probable mistakes in descriptions", &["codegen/src/lint"]),
];

/// Most rules whose fixture does not hold their code: its test knows the finding by its words.
const BY_WORDS: usize = 22;

/// Texts of what a fixture may name: files by their paths, tests by their functions, snapshots of findings by their headings.
fn fixtures(root: &Path) -> BTreeMap<String, String> {
    let mut files = Vec::new();
    for folder in ["runtime/identification/src", "runtime/tests", "codegen/tests"] {
        sources(&root.join(folder), &mut files);
    }
    let mut all = BTreeMap::new();
    for file in files {
        let text = fs::read_to_string(&file).expect("a text");
        let name = file.strip_prefix(root).expect("a file of the workspace").display().to_string();
        let is_of_tests = name.contains("tests");
        let own = text.split_once("#[cfg(test)]").map_or("", |(_, tests)| tests);
        let tests = if is_of_tests { &text } else { own };
        for part in tests.split("\nfn ").chain(tests.split("\n    fn ")).skip(1) {
            if let Some((function, rest)) = part.split_once('(') {
                let body = rest.split("\n}\n").next().unwrap_or_default();
                all.entry(function.to_owned()).or_insert_with(|| body.to_owned());
            }
        }
        all.insert(name.trim_start_matches("runtime/identification/src/").to_owned(), tests.to_owned());
    }
    for folder in ["bad", "foreign"] {
        let folder = format!("codegen/tests/snapshots/{folder}");
        for entry in fs::read_dir(root.join(&folder)).expect("snapshots") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            all.insert(format!("{folder}/{name}"), fs::read_to_string(&path).expect("a text"));
        }
    }
    for entry in fs::read_dir(root.join("codegen/tests/snapshots/findings")).expect("snapshots") {
        let text = fs::read_to_string(entry.expect("an entry").path()).expect("a text");
        for section in text.split("\n== ").skip(1) {
            let name = section.split(", exit ").next().unwrap_or_default();
            all.insert(name.to_owned(), section.to_owned());
        }
    }
    all
}

/// `GELENK_UPDATE=findings` writes the page.
#[test]
fn the_page_of_findings_is_that_of_the_rules() {
    let root = gelenk_tests::workspace();
    let mut page = String::from(
        "# Findings\n\nEach line of output that begins with `error[CODE]`, `warning[CODE]` or `note[CODE]` is a finding. This page is \
         made from the comments of the rules, by the test `findings` of the package `tests`.\n",
    );
    let mut rows = BTreeMap::new();
    for (heading, folders) in SECTIONS {
        let mut files = Vec::new();
        folders.iter().for_each(|folder| sources(&root.join(folder), &mut files));
        let mut own = BTreeMap::new();
        for file in &files {
            rules(&fs::read_to_string(file).expect("a source"), &file.display().to_string(), &mut own);
        }
        let head = "| code | level | sees | matters | example | fixture |\n|---|---|---|---|---|---|\n";
        write!(page, "\n## {heading}\n\n{head}").expect("a text");
        own.values().for_each(|row| writeln!(page, "{row}").expect("a text"));
        for (code, row) in own {
            assert!(rows.insert(code, row).is_none(), "a code of two sections");
        }
    }
    let fixtures = fixtures(&root);
    let mut by_words = Vec::new();
    for (code, row) in &rows {
        let fixture = row.rsplit(" | ").next().expect("a fixture");
        let named: Vec<&str> = fixture.split('`').skip(1).step_by(2).collect();
        let texts: Vec<&String> = named.iter().filter_map(|name| fixtures.get(*name)).collect();
        assert!(!named.is_empty() && texts.len() == named.len(), "its fixture is not there: {row}");
        let is_snapshot = texts.iter().any(|text| text.contains(", exit "));
        if !texts.iter().any(|text| text.contains(code)) {
            assert!(!is_snapshot, "the snapshot does not hold it: {row}");
            by_words.push(code);
        }
    }
    assert!(by_words.len() <= BY_WORDS, "more than {BY_WORDS} fixtures do not hold their code: {by_words:?}");
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
