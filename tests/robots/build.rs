//! Generates all functions of the robots whose descriptions choose some.

#![allow(clippy::expect_used, reason = "a build script of tests: what is missing ends it")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use gelenk_codegen::Builder;
use gelenk_codegen::read::{ReadOptions, read};

/// The module with all functions of a Go2 has 134 000 lines.
const TOO_LARGE: &str = "go2";

fn main() {
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR"));
    // It has a line for each description, so that a new one changes it.
    println!("cargo::rerun-if-changed=../../generated/src/lib.rs");
    println!("cargo::metadata=folder={}", folder.display());
    let mut whole = Builder::new().functions(["all"]).hide_notes();
    let mut root = String::new();
    for (name, path) in descriptions(Path::new("../../models")) {
        println!("cargo::rerun-if-changed={}", path.display());
        if chooses_functions(&path) && name != TOO_LARGE {
            whole = whole.description(path);
            let _ = writeln!(
                root,
                "/// All functions of `{name}`.\n#[allow(clippy::all)]\npub mod {name} {{\n    include!(concat!(env!(\"OUT_DIR\"), \"/{name}.rs\"));\n}}"
            );
        } else {
            let _ = writeln!(root, "pub use gelenk_generated::{name};");
        }
    }
    whole.generate();
    fs::write(folder.join("robots.rs"), root).expect("robots.rs");
}

fn descriptions(folder: &Path) -> Vec<(String, PathBuf)> {
    let paths = fs::read_dir(folder).expect("models/").map(|entry| entry.expect("an entry").path());
    let paths = paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    let name = |path: &PathBuf| path.file_stem().and_then(|name| name.to_str()).expect("a name").to_owned();
    let mut named: Vec<_> = paths.map(|path| (name(&path), path)).collect();
    named.sort();
    named
}

fn chooses_functions(description: &Path) -> bool {
    let loaded = read(description, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}"));
    let functions = loaded.model.options.functions;
    !functions.is_empty() && functions != ["all"]
}
