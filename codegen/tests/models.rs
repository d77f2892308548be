//! Every robot of models/ and every example of models/README.md loads.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use gelenk_codegen::model::Model;
use gelenk_codegen::read::{ReadOptions, from_toml, read};
use std::fmt::Write;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn models() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    files
}

fn joint_names(model: &Model) -> Vec<&str> {
    let joint = |link: &usize| model.links[*link].joint.as_ref().unwrap().name.as_str();
    model.coordinates.iter().map(joint).collect()
}

/// Coordinates, inputs, frames and notes of all robots, as a snapshot.
#[test]
fn every_model_loads() {
    let mut text = String::new();
    for file in models() {
        let loaded = read(&file, &ReadOptions::default()).unwrap_or_else(|wrong| panic!("{wrong}"));
        let model = &loaded.model;
        assert_eq!(file.file_stem().unwrap().to_str().unwrap(), model.name);
        let inputs: Vec<&str> = model.inputs().map(|input| input.name()).collect();
        let frames: Vec<&str> = model.frames.iter().map(|frame| frame.name.as_str()).collect();
        let parameters: Vec<&str> =
            model.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        writeln!(text, "# {}, {} links", model.name, model.links.len()).unwrap();
        writeln!(text, "coordinates {:?}\ninputs {inputs:?}", joint_names(model)).unwrap();
        writeln!(text, "frames {frames:?}\nparameters {parameters:?}").unwrap();
        let notes = loaded.notes.entries().iter().map(|note| format!("{}: {}\n", note.code, note.message));
        writeln!(text, "{}", notes.collect::<String>()).unwrap();
    }
    insta::assert_snapshot!(text);
}

#[test]
fn every_example_of_the_readme_loads() {
    let readme = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let examples: Vec<&str> =
        readme.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert_eq!(examples.len(), 8);
    for (index, example) in examples.iter().enumerate() {
        let mut load =
            |file: &str| Ok((file.to_owned(), std::fs::read_to_string(folder().join(file)).unwrap()));
        let name = format!("example_{}.toml", index + 1);
        let outcome = from_toml(example, &name, &ReadOptions::default(), &mut load);
        let (_, notes) = outcome.unwrap_or_else(|wrong| panic!("{wrong}"));
        assert!(
            notes.entries().iter().all(|note| note.location().unwrap().file.ends_with("urdf")),
            "{notes}"
        );
    }
}

#[test]
fn every_file_that_was_read_is_listed() {
    let loaded = read(&folder().join("ur5.toml"), &ReadOptions::default()).unwrap();
    let names: Vec<&str> =
        loaded.files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["ur5.toml", "ur5.urdf"]);
}

#[test]
fn friction_can_be_left_out() {
    let options = ReadOptions { no_friction: true, ..ReadOptions::default() };
    for file in models() {
        let model = read(&file, &options).unwrap_or_else(|wrong| panic!("{wrong}")).model;
        assert!(
            model.links.iter().filter_map(|link| link.joint.as_ref()).all(|joint| joint.friction.is_empty())
        );
    }
}
