//! `gelenk check` in a workspace of its own: fresh, then every way of being stale.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn gelenk(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gelenk")).args(arguments).current_dir(folder).output().unwrap()
}

/// A folder with two robots of models/ and their modules.
fn workspace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("models")).unwrap();
    fs::create_dir_all(folder.path().join("generated/src")).unwrap();
    for name in ["cart_pole.toml", "double_pendulum.toml"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        fs::copy(from.join(name), folder.path().join("models").join(name)).unwrap();
    }
    let output = gelenk(folder.path(), &["generate"]);
    assert!(output.status.success(), "{output:?}");
    folder
}

/// Exit code and all that was printed.
fn check(folder: &Path) -> (i32, String) {
    let output = gelenk(folder, &["check"]);
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap(), String::from_utf8(text).unwrap())
}

fn module(folder: &Path, name: &str) -> PathBuf {
    folder.join("generated/src").join(name)
}

#[test]
fn what_was_just_generated_is_fresh() {
    let folder = workspace();
    assert_eq!(check(folder.path()), (0, "fresh\n".to_owned()));
    // From a folder below as well.
    assert_eq!(check(&folder.path().join("models")).0, 0);
}

#[test]
fn one_changed_byte_is_stale() {
    let folder = workspace();
    for name in ["cart_pole.rs", "lib.rs"] {
        let path = module(folder.path(), name);
        let fresh = fs::read(&path).unwrap();
        for place in [0, fresh.len() / 2, fresh.len() - 1] {
            let mut bytes = fresh.clone();
            bytes[place] ^= 1;
            fs::write(&path, bytes).unwrap();
            let (code, text) = check(folder.path());
            assert_eq!(code, 1);
            assert_eq!(text, format!("stale: generated/src/{name}\nrun: gelenk generate\n"));
        }
        fs::write(&path, fresh).unwrap();
    }
    assert_eq!(check(folder.path()).0, 0);
}

#[test]
fn missing_and_left_over_modules_are_stale() {
    let folder = workspace();
    fs::remove_file(module(folder.path(), "cart_pole.rs")).unwrap();
    assert_eq!(check(folder.path()).0, 1);
    assert!(gelenk(folder.path(), &["generate"]).status.success());
    assert_eq!(check(folder.path()).0, 0);
    fs::remove_file(folder.path().join("models/cart_pole.toml")).unwrap();
    let (code, text) = check(folder.path());
    assert_eq!(code, 1);
    assert!(text.contains("cart_pole.rs"), "{text}");
}

#[test]
fn a_changed_description_is_stale_and_checking_writes_nothing() {
    let folder = workspace();
    let path = folder.path().join("models/cart_pole.toml");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("mass = 1.0", "mass = 1.5")).unwrap();
    let before = fs::read(module(folder.path(), "cart_pole.rs")).unwrap();
    assert_eq!(check(folder.path()).0, 1);
    let after = fs::read(module(folder.path(), "cart_pole.rs")).unwrap();
    assert_eq!(before, after);
}
