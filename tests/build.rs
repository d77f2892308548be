//! Lists the functions of all robots for the tests that call all of them, and tells them by `cfg(robots_of_others)` whether
//! `tests/reference/robots.py` has fetched the URDFs of others.

#![allow(clippy::expect_used, reason = "a build script of tests: what is missing ends it")]

use std::path::Path;
use std::{env, fs};

#[path = "src/table.rs"]
#[allow(dead_code, reason = "the tests need all of it")]
mod table;

fn main() {
    robots_of_others();
    let folder = Path::new("../generated/src");
    // The build script of gelenk-test-robots writes the modules that have all functions.
    let whole = env::var_os("DEP_GELENK_TEST_ROBOTS_FOLDER").expect("the folder of gelenk-test-robots");
    println!("cargo::rerun-if-changed=../generated/src");
    println!("cargo::rerun-if-changed=src/table.rs");
    let entries = fs::read_dir(folder).expect("generated/src");
    let mut names: Vec<String> = entries
        .filter_map(|entry| {
            let path = entry.expect("an entry").path();
            let name = path.file_stem()?.to_str()?.to_owned();
            (path.extension()? == "rs" && name != "lib").then_some(name)
        })
        .collect();
    names.sort();
    let mut text = String::from("/// Every function of every robot.\n");
    text.push_str("pub const ROBOTS: &[Robot] = &[\n");
    for name in &names {
        let file = format!("{name}.rs");
        let source = fs::read_to_string(Path::new(&whole).join(&file));
        let source = source.or_else(|_| fs::read_to_string(folder.join(file))).expect("a module");
        text.push_str(&table::entry(name, &format!("gelenk_test_robots::{name}"), &source));
    }
    text.push_str("];\n");
    let out = env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR");
    fs::write(Path::new(&out).join("table.rs"), text).expect("the table");
}

fn robots_of_others() {
    // The folder `robots` may be missing: Cargo would run a script that watches it at each build.
    println!("cargo::rerun-if-changed=reference");
    println!("cargo::rustc-check-cfg=cfg(robots_of_others)");
    let list = fs::read_to_string("reference/robots.txt").expect("robots.txt");
    let mut names =
        list.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split(' ').next());
    if names.all(|name| Path::new("reference/robots").join(format!("{name}.urdf")).exists()) {
        println!("cargo::rustc-cfg=robots_of_others");
    }
}
