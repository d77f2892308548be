//! A base at an angle that the description does not have.

use std::fs;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_identification::robot::Robot;
use serde_json::Value;

use super::Arm;

const TILTED: &str = "extends = \"arm.toml\"\ngravity = [0, 1.36, -9.715]\n";

fn doubt(found: &Value) -> Option<&str> {
    let warnings = found["warnings"].as_array().unwrap().iter().filter_map(Value::as_str);
    warnings.into_iter().find(|warning| warning.contains("`gravity` is wrong"))
}

#[test]
fn a_base_at_an_angle_is_a_warning_with_the_gravity_that_a_description_needs() {
    let arm = Arm::new();
    fs::write(arm.at("tilted.toml"), TILTED).unwrap();
    arm.record("tilted.toml", "log.csv", None);
    let found = arm.identify(&["log.csv", "--output", "found.toml"]);
    let said = doubt(&found).unwrap_or_else(|| panic!("{}", found["warnings"]));
    println!("{said}");
    assert!(said.contains("axis [1, ") && said.contains("set `gravity = ["), "{said}");
    let angle = said.split("gravity ").nth(1).unwrap().split('°').next().unwrap().parse::<f64>().unwrap();
    // atan(1.36 / 9.715)
    assert!((angle - 7.97).abs() < 0.2, "{angle}");
    // With what the warning says there is no doubt left; neither is where the base is level.
    let gravity = said.split("set `").nth(1).unwrap().split('`').next().unwrap();
    fs::write(arm.at("arm.toml"), super::ARM.replace("gravity = [0, 0, -9.81]", gravity)).unwrap();
    let again = arm.identify(&["log.csv", "--output", "found.toml"]);
    assert!(doubt(&again).is_none(), "{}", again["warnings"]);
    let level = Arm::new();
    level.record("arm.toml", "log.csv", None);
    let found = level.identify(&["log.csv", "--output", "found.toml"]);
    assert!(doubt(&found).is_none(), "{}", found["warnings"]);
}

#[test]
fn the_regressor_at_rest_under_another_gravity_is_that_of_a_description_with_it() {
    let arm = Arm::new();
    fs::write(arm.at("tilted.toml"), TILTED).unwrap();
    let [level, tilted] =
        ["arm.toml", "tilted.toml"].map(|name| InterpretedRobot::new(&arm.model(name)).unwrap());
    let (y, zero) = ([0.3, -0.7, 1.1], [0.0; 3]);
    let mut expected = vec![0.0; 3 * level.parameters().len()];
    let mut found = expected.clone();
    tilted.inertial_regressor(&y, &zero, &zero, &mut expected);
    level.regressor_at_rest(&y, tilted.gravity().unwrap(), &mut found);
    assert!(expected.iter().any(|w| w.abs() > 1.0));
    assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
}
