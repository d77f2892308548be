//! The crates as they would be published: what their manifests say, and that no file is missing.
//! `new_crate.rs`, `build_script.rs` and `identified_loop.rs` compile them and run the result.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fs;
use std::path::{Path, PathBuf};

use gelenk_tests::packages::{manifests, published};
use gelenk_tests::workspace;

/// The fields that a registry shows, or that tell a user whether the crate is one for them.
#[test]
fn manifests_say_what_a_registry_shows() {
    let texts = ["description", "license", "repository", "documentation", "readme", "rust_version"];
    for package in manifests() {
        let name = package["name"].as_str().expect("a name");
        for key in texts {
            let text = package[key].as_str().unwrap_or_default();
            assert!(!text.is_empty(), "{name} has no {key}");
        }
        assert_eq!(package["version"], env!("CARGO_PKG_VERSION"), "{name}");
        let documentation = format!("https://docs.rs/{name}");
        assert_eq!(package["documentation"], documentation, "{name}");
        // crates.io takes five at most.
        for key in ["keywords", "categories"] {
            let count = package[key].as_array().map_or(0, Vec::len);
            assert!((1..=5).contains(&count), "{name} has {count} {key}");
        }
    }
}

/// Robots, tests and the sample stay here; a crate that is forgotten in either list is found.
#[test]
fn the_crates_that_are_published() {
    let names: Vec<&String> = published().keys().collect();
    let expected = [
        "gelenk-adaptation",
        "gelenk-codegen",
        "gelenk-dynamics",
        "gelenk-files",
        "gelenk-findings",
        "gelenk-formula",
        "gelenk-identification",
        "gelenk-kernels",
        "gelenk-report",
        "gelenk-runtime",
    ];
    assert_eq!(names, expected);
}

/// Both licences ask that their text accompanies every copy.
#[test]
fn packages_hold_the_licences() {
    for (name, folder) in published() {
        for file in ["LICENSE-MIT", "LICENSE-APACHE", "README.md"] {
            let packed = fs::read(folder.join(file)).unwrap_or_else(|_| panic!("{name}: {file}"));
            let here = fs::read(workspace().join(file)).expect("the file");
            assert!(packed == here, "{name}: {file} differs");
        }
    }
}

/// Packing compiles nothing here, so a file that a crate includes from elsewhere in the repository would be
/// missed.
#[test]
fn packages_hold_every_file_that_they_include() {
    let mut count = 0;
    for (name, folder) in published() {
        for source in sources(&folder.join("src")) {
            let text = fs::read_to_string(&source).expect("a source");
            for included in included(&text) {
                count += 1;
                let path = source.parent().expect("a folder").join(included);
                assert!(path.is_file(), "{name}: {} includes {included}", source.display());
            }
        }
    }
    // The guides, the templates of `gelenk new`, the style sheet, the texts of the kernels.
    assert!(count > 40, "only {count} inclusions were found");
}

/// The literals in `include_str!("…")`, `include!("…")` and `include_bytes!("…")`.
fn included(text: &str) -> impl Iterator<Item = &str> {
    let call = |rest: &'_ str| -> Option<usize> { rest.find("(\"").filter(|&at| at < 7) };
    let after = text.split("include").skip(1);
    after.filter_map(move |rest| {
        let start = call(rest)? + 2;
        let macro_name = &rest[..start - 2];
        let literal = rest[start..].split('"').next()?;
        matches!(macro_name, "!" | "_str!" | "_bytes!").then_some(literal)
    })
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let inside = |path: PathBuf| match path.is_dir() {
        true => sources(&path),
        false => vec![path],
    };
    let is_source = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "rs");
    paths.flat_map(inside).filter(is_source).collect()
}
