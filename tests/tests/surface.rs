//! The size of the identification crate's surface: modules at its root, and public items.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fs;
use std::path::Path;

/// Most modules at the root of the crate.
const MODULES: usize = 19;
/// Most public functions, types, traits and constants of the crate.
const ITEMS: usize = 150;

fn is_public_item(line: &str) -> bool {
    const KINDS: [&str; 7] = ["fn ", "struct ", "enum ", "trait ", "const ", "type ", "static "];
    let item = line.trim_start().strip_prefix("pub ");
    item.is_some_and(|item| KINDS.iter().any(|kind| item.starts_with(kind)))
}

fn public_items(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let items = entries.map(|path| {
        if path.is_dir() {
            public_items(&path)
        } else if path.extension().is_some_and(|end| end == "rs") {
            let text = fs::read_to_string(&path).expect("a source");
            text.lines().filter(|line| is_public_item(line)).count()
        } else {
            0
        }
    });
    items.sum()
}

#[test]
fn identification_has_few_modules_and_public_items() {
    let source = gelenk_tests::workspace().join("runtime/identification/src");
    let root = fs::read_to_string(source.join("lib.rs")).expect("the root");
    let modules = root.lines().filter(|line| line.trim_start_matches("pub ").starts_with("mod ")).count();
    let items = public_items(&source);
    println!("{modules} modules, {items} public items");
    assert!((1..=MODULES).contains(&modules), "{modules} modules, at most {MODULES}");
    assert!((1..=ITEMS).contains(&items), "{items} public items, at most {ITEMS}");
}
