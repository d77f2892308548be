//! Every robot of models/ loads without complaints.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
use gelenk_codegen::model::{ReadOptions, read};
use std::path::{Path, PathBuf};

fn models() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_model_loads() {
    let files = models();
    assert!(files.len() >= 6, "{files:?}");
    for file in files {
        let loaded = read(&file, &ReadOptions::default()).unwrap_or_else(|wrong| panic!("{wrong}"));
        println!(
            "{}: n = {}",
            loaded.model.name,
            loaded.model.coordinates.len()
        );
        println!("{}\n", loaded.notes);
        assert_eq!(
            file.file_stem().unwrap().to_str().unwrap(),
            loaded.model.name
        );
    }
}
