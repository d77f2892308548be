//! `gelenk inspect model` and the page of a robot show forces other than those of joints: drives on several joints, friction of their
//! shafts, joints that follow, forces at frames.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

/// Two joints that two motors move together and that have no friction themselves, and a third that follows both.
const WRIST: &str = r#"
name = "wrist"

[[joints]]
name = "a"
axis = [0, 1, 0]

[[joints]]
name = "b"
axis = [0, 1, 0]
origin = { xyz = [0, 0, 0.3] }

[[joints]]
name = "c"
axis = [0, 0, 1]
follows = { a = 1, b = -0.5 }
friction = { viscous = 0.75 }
limits = { position = [-1, 1.5] }

[[drives]]
name = "m1"
on = { a = 1, b = 1 }
gear_ratio = 4
speed = 90
friction = { viscous = 2 }

[[drives]]
name = "m2"
on = { a = 1, b = -1 }
friction = { terms = [["tanh(50*v)", 3]] }

[[bodies]]
link = "a"
mass = 1
inertia = 0.1

[[bodies]]
link = "b"
mass = 1
center_of_mass = [0, 0, 0.2]
inertia = 0.1

[[bodies]]
link = "c"
mass = 0.1
inertia = 0.01
"#;

fn gelenk(folder: &Path, arguments: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO_BIN_EXE_gelenk")).current_dir(folder).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn folder(description: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), description).unwrap();
    folder
}

fn json_of(folder: &Path, description: &str) -> Value {
    let said = gelenk(folder, &["inspect", "model", description, "--format", "json"]);
    serde_json::from_str(&said[said.find('{').unwrap()..]).unwrap()
}

#[test]
fn inspect_shows_the_weights_of_drives_on_several_joints() {
    let folder = folder(WRIST);
    let said = flat(&gelenk(folder.path(), &["inspect", "model", "robot.toml"]));
    assert!(said.contains("u1 m1 y1 + y2 4 ") && said.contains("u2 m2 y1 - y2 1 "), "{said}");
    assert!(said.contains("y1 - 0.5 y2"), "the joint that follows: {said}");
    let found = json_of(folder.path(), "robot.toml");
    let drive = &found["drives"][1];
    assert_eq!([&drive["drive"], &drive["joint"]], ["m2", "y1 - y2"]);
    assert_eq!(drive["gear_ratio"], 1.0);
    assert!(found["frame_forces"].is_null());
}

#[test]
fn inspect_shows_forces_at_frames() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let said = flat(&gelenk(&models, &["inspect", "model", "balanced_arm.toml"]));
    assert!(said.contains("gas_spring spring_foot – spring_head pulls with "), "{said}");
    assert!(said.contains("contact tool an argument, in the axes of the base"), "{said}");
    let cylinder = "boom_cylinder_foot – boom_cylinder_rod pulls with u -60000 35000 N";
    let said = flat(&gelenk(&models, &["inspect", "model", "excavator.toml"]));
    assert!(said.contains(cylinder), "{said}");
    let found = json_of(&models, "excavator.toml");
    let boom = json!({
        "index": "u2", "name": "boom_cylinder", "place": "boom_cylinder_foot – boom_cylinder_rod",
        "force": "pulls with u", "lowest_input": -60e3, "highest_input": 35e3, "unit": "N",
    });
    let forces = found["frame_forces"].as_array().unwrap();
    assert_eq!(forces.iter().find(|force| force["index"] == "u2"), Some(&boom));
    let found = json_of(&models, "quadrotor.toml");
    assert_eq!(found["frame_forces"].as_array().unwrap().len(), 4);
    assert_eq!(found["frame_forces"][0]["force"].as_str().unwrap().split(',').count(), 6);
}

/// Springs of a joint that follows are over its own position, which the page says; one number stands for it in both sections.
#[test]
fn the_page_has_the_springs_of_joints_that_follow() {
    let sprung = WRIST.replace("friction = { viscous = 0.75 }", "spring = { stiffness = 12, damping = 0.5 }");
    let folder = folder(&sprung);
    gelenk(folder.path(), &["report", "robot.toml", "--output", "page"]);
    let read = |name: &str| fs::read_to_string(folder.path().join("page").join(name)).unwrap();
    let table = read("springs-following.csv");
    assert!(table.contains("$z_{1}$,c,a joint that follows,"), "{table}");
    assert!(read("friction-following.csv").contains("$z_{2}$,m1,"), "{}", read("friction-following.csv"));
    let report = read("report.json");
    assert!(report.contains("s_{z,1} = ") && report.contains("12"), "{report}");
}

#[test]
fn the_page_has_the_friction_of_shafts_and_of_joints_that_follow() {
    let folder = folder(WRIST);
    gelenk(folder.path(), &["report", "robot.toml", "--output", "page"]);
    let read = |name: &str| fs::read_to_string(folder.path().join("page").join(name)).unwrap();
    let table: Vec<String> = read("friction-following.csv").lines().map(str::to_owned).collect();
    let expected = [
        "index,name,kind,position",
        "$z_{1}$,c,a joint that follows,\"$y_{1} - 0.5\\,y_{2}$\"",
        "$z_{2}$,m1,a motor's shaft,\"$4\\,y_{1} + 4\\,y_{2}$\"",
        "$z_{3}$,m2,a motor's shaft,$y_{1} - y_{2}$",
    ];
    let unquoted = |line: &str| line.replace('"', "");
    assert_eq!(table.iter().map(|line| unquoted(line)).collect::<Vec<_>>(), expected.map(unquoted).to_vec());
    let limits = unquoted(&read("dependent-limits.csv"));
    assert!(limits.contains("\nc,$y_{1} - 0.5\\,y_{2}$,-1.0,1.5,\n"), "{limits}");
    assert!(limits.contains("\nm1,$4\\,y_{1} + 4\\,y_{2}$,,,90.0\n"), "{limits}");
    // What the shafts and the follower do at 1 rad/s: 4 · 2 · 4 + 3 + 0.75, and 4 · 2 · 4 + 3 + 0.5² · 0.75.
    let curves = read("friction-curves.csv");
    for (joint, expected) in [("a", 35.75), ("b", 35.1875)] {
        let last = curves.lines().rfind(|line| line.starts_with(&format!("1,{joint},1.0,"))).unwrap();
        let found: f64 = last.rsplit(',').next().unwrap().parse().unwrap();
        assert!((found - expected).abs() < 1e-6, "{joint}: {last}");
    }
    let report = read("report.json");
    assert!(report.contains(r"2.0 \\, \\dot{z}_{2}") || report.contains(r"2 \\, \\dot{z}_{2}"), "{report}");
}
