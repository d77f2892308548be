//! The page of a robot draws what acts between frames: cylinders and springs are lines between them.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::path::Path;
use std::process::Command;

use gelenk_codegen::model::Model;
use gelenk_codegen::read::{self, ReadOptions};
use serde_json::Value;

fn description(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name)
}

/// The robot as the page's script reads it, and the page.
fn drawn(name: &str) -> (Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    let output =
        program.arg("report").arg(description(name)).arg("--output").arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    let parts = page.split("<script class=\"data\" type=\"application/json\">").skip(1);
    let data = parts.map(|part| &part[..part.find("</script>").unwrap()]);
    let found =
        data.filter_map(|text| serde_json::from_str::<Value>(text).ok()).find(|data| data["rods"].is_array());
    (found.unwrap_or_else(|| panic!("{name} has no drawing")), page)
}

fn read(name: &str) -> Model {
    read::read(&description(name), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).model
}

/// A frame as the end of a line: the joint that carries its link, null for the base, and its place there.
fn end(model: &Model, frame: &str) -> Value {
    let frame = model.frames.iter().find(|known| known.name == frame).unwrap();
    let point = frame.pose.translation.each_ref().map(|x| x.value(&[]).unwrap());
    serde_json::json!({ "joint": frame.link.checked_sub(1), "point": point })
}

#[test]
fn cylinders_of_an_excavator_are_lines_between_their_frames() {
    let (model, (robot, page)) = (read("excavator.toml"), drawn("excavator.toml"));
    let rods = robot["rods"].as_array().unwrap();
    assert_eq!(rods.len(), 3, "a cylinder that damps is drawn once: {rods:?}");
    for (rod, name) in rods.iter().zip(["boom", "stick", "bucket"]) {
        let ends = ["foot", "rod"].map(|which| end(&model, &format!("{name}_cylinder_{which}")));
        assert_eq!(rod["ends"], Value::from(ends.to_vec()), "{name}");
        assert_eq!(rod["input"], true, "{name}");
    }
    // The script draws whatever stands there.
    assert!(page.contains("for (const rod of robot.rods)"), "no line is drawn");
}

#[test]
fn a_gas_spring_is_a_line_and_no_input() {
    let (model, (robot, _)) = (read("balanced_arm.toml"), drawn("balanced_arm.toml"));
    let ends = ["spring_foot", "spring_head"].map(|name| end(&model, name));
    assert_eq!(robot["rods"], serde_json::json!([{ "ends": ends, "input": false }]));
    let (robot, _) = drawn("palletizer.toml");
    assert_eq!(robot["rods"], serde_json::json!([]));
}
