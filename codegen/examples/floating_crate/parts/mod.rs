//! Feet and propellers of a robot with a floating base.

mod legs;
mod propellers;

use gelenk_codegen::model::{Joint, Model};
use gelenk_codegen::read::{ReadOptions, read};
use std::fs;
use std::path::Path;

/// Adds feet, or else propellers, to the crate in a folder, and says which.
///
/// - `feet`: links that are the feet; empty for those that the rule finds
///
/// # Errors
/// If the robot has neither, or its files cannot be read or written.
pub fn add(folder: &Path, feet: &[String]) -> Result<String, String> {
    let description = folder.join("robot.toml");
    let loaded = read(&description, &ReadOptions::default()).map_err(|problems| problems.to_string())?;
    let model = &loaded.model;
    if model.quaternion_joints.is_empty() {
        return Err("the base is fixed\n  = help: make the crate with --base floating".to_owned());
    }
    let feet = legs::feet(model, feet)?;
    if !feet.is_empty() {
        append(&description, &legs::description(&feet))?;
        let program = legs::program(feet.len());
        fs::write(folder.join("src/main.rs"), program).map_err(|error| error.to_string())?;
        return Ok(format!("{} feet: the program lets the robot stand on them", feet.len()));
    }
    let joints = joints(model);
    let blocks = match joints.is_empty() {
        true => propellers::of_fixed_links(model),
        false => propellers::description(model, &joints),
    };
    if blocks.is_empty() {
        return Err("the robot has neither legs nor joints that may carry propellers".to_owned());
    }
    append(&description, &blocks)?;
    Ok("robot.toml has commented propellers: remove the signs # to use them".to_owned())
}

fn append(file: &Path, text: &str) -> Result<(), String> {
    let read = fs::read_to_string(file).map_err(|error| error.to_string())?;
    fs::write(file, read + text).map_err(|error| error.to_string())
}

/// Joints with one position, with their links.
fn joints(model: &Model) -> Vec<(&Joint, usize)> {
    let moves = model.coordinates.iter().enumerate();
    let plain = moves.filter(|(coordinate, _)| model.position_of(*coordinate).is_some());
    plain.filter_map(|(_, &link)| Some((model.links[link].joint.as_ref()?, link))).collect()
}

/// A string of TOML; one of JSON is such a string.
fn toml_text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
