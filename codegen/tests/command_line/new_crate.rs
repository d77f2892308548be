//! New crates: their robots, and what is refused.

use super::{gelenk, shown};
use std::fs;

const GRIPPER: &str = r#"<robot name="gripper">
  <link name="base"/>
  <link name="left"><inertial><mass value="0.1"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
  <link name="right"><inertial><mass value="0.1"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
  <joint name="left &quot;finger&quot;" type="prismatic"><parent link="base"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="20" velocity="0.2"/></joint>
  <joint name="right finger" type="prismatic"><parent link="base"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" effort="20" velocity="0.2"/>MIMIC</joint>
</robot>
"#;

/// The description of the new crate builds on a copy of the URDF, can be generated, and stays so with its
/// hints made true.
#[test]
fn a_new_crate_has_the_robot_of_a_urdf() {
    let mimic = r#"<mimic joint="left &quot;finger&quot;"/>"#;
    let friction = r#"<dynamics damping="1" friction="0.5"/>"#;
    for (name, mimic) in [("two", ""), ("coupled", mimic), ("dry", friction)] {
        let folder = tempfile::tempdir().unwrap();
        let urdf = GRIPPER.replace("MIMIC", mimic);
        fs::write(folder.path().join("gripper.urdf"), &urdf).unwrap();
        let made = gelenk(folder.path(), &["new", name, "--urdf", "gripper.urdf"]);
        assert_eq!(made.status.code(), Some(0), "{}", shown(&made));

        let home = folder.path().join(name);
        assert_eq!(fs::read_to_string(home.join("robot.urdf")).unwrap(), urdf);
        let build = fs::read_to_string(home.join("build.rs")).unwrap();
        assert_eq!(build.contains("\n        .control_model(50.0)"), name == "dry");
        let text = fs::read_to_string(home.join("robot.toml")).unwrap();
        assert_eq!(text.contains("<mimic>"), name == "coupled");
        let done = ["[[joints]]", "name = ", "friction = ", "drive = "]
            .iter()
            .fold(text.clone(), |text, key| text.replace(&format!("\n# {key}"), &format!("\n{key}")));
        assert_eq!(done.matches("\ndrive = ").count(), if name == "coupled" { 1 } else { 2 });
        for description in [text.clone(), done] {
            fs::write(home.join("robot.toml"), description).unwrap();
            let generated = gelenk(&home, &["generate", "robot.toml"]);
            assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
            assert!(home.join("robot.rs").is_file());
        }
    }
}

const HINGES: &str = r#"<mujoco><worldbody><body name="upper" pos="0 0 1">
  <joint name="shoulder" axis="0 1 0" damping="0.1"/><geom type="capsule" fromto="0 0 0 0 0 -.5" size=".05"/>
  <body name="lower" pos="0 0 -.5"><joint name="el&quot;bow" axis="0 1 0"/><geom size=".05"/></body></body></worldbody>
  <include file="parts/motors.xml"/></mujoco>"#;
const MOTORS: &str =
    r#"<mujocoinclude><actuator><motor joint="shoulder" gear="50"/></actuator></mujocoinclude>"#;

/// The files lie in their places in the new crate, which has the robot and stays so with its hints made true.
#[test]
fn a_new_crate_has_the_robot_of_an_mjcf() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("parts")).unwrap();
    fs::write(folder.path().join("arm.xml"), HINGES).unwrap();
    fs::write(folder.path().join("parts/motors.xml"), MOTORS).unwrap();
    for (name, option) in [("one", "--mjcf"), ("other", "--urdf")] {
        let made = gelenk(folder.path(), &["new", name, option, "arm.xml"]);
        assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
        let home = folder.path().join(name);
        assert_eq!(fs::read_to_string(home.join("robot.xml")).unwrap(), HINGES);
        assert_eq!(fs::read_to_string(home.join("parts/motors.xml")).unwrap(), MOTORS);
        let text = fs::read_to_string(home.join("robot.toml")).unwrap();
        assert!(text.contains("\nextends = \"robot.xml\"\n") && !text.contains("drive"), "{text}");
        let done = ["[[joints]]", "name = ", "friction = "]
            .iter()
            .fold(text.clone(), |text, key| text.replace(&format!("\n# {key}"), &format!("\n{key}")));
        assert_eq!(done.matches("\nfriction = ").count(), 2);
        for (description, viscous) in [(text, "v[0] * 0.1"), (done, "v[0] * 0.4")] {
            fs::write(home.join("robot.toml"), description).unwrap();
            let generated = gelenk(&home, &["generate", "robot.toml", "--functions", "friction_torques"]);
            assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
            let module = fs::read_to_string(home.join("robot.rs")).unwrap();
            assert!(module.contains(viscous), "{module}");
        }
    }
}

/// A model without inputs is rejected for a simulation, and a file outside the folder cannot be copied into
/// the crate.
#[test]
fn a_new_crate_is_not_made_of_an_mjcf_that_it_cannot_move_or_hold() {
    let folder = tempfile::tempdir().unwrap();
    let still = HINGES.replace(r#"<include file="parts/motors.xml"/>"#, "");
    let free = still.replace(r#"<joint name="shoulder" axis="0 1 0" damping="0.1"/>"#, "<freejoint/>");
    let outside = HINGES.replace("parts/", "../");
    fs::create_dir(folder.path().join("robots")).unwrap();
    let taken = HINGES.replace("parts/motors.xml", "build.rs");
    fs::write(folder.path().join("motors.xml"), MOTORS).unwrap();
    fs::write(folder.path().join("robots/build.rs"), MOTORS).unwrap();
    for (text, message) in [
        (
            still,
            "has no motor at `shoulder`, `el\"bow`, but the program of a new project needs a motor for at least one joint",
        ),
        (
            free,
            "has no motor at `el\"bow`, but the program of a new project needs a motor for each joint of a robot with a floating base",
        ),
        (outside, "whose relative path does not fit into the new project"),
        (taken, "the MJCF includes build.rs, but a file of the project has the same name"),
    ] {
        fs::write(folder.path().join("robots/arm.xml"), text).unwrap();
        let refused = gelenk(folder.path(), &["new", "arm", "--mjcf", "robots/arm.xml"]);
        assert_eq!(refused.status.code(), Some(2), "{}", shown(&refused));
        assert!(shown(&refused).contains(message), "{}", shown(&refused));
        assert!(!folder.path().join("arm").exists());
    }
}

/// A message reports a missing `--base floating`, and the crate is written.
#[test]
fn a_new_crate_of_a_legged_robot_on_a_fixed_base_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("legs.urdf"), GRIPPER.replace("MIMIC", "").replace("finger", "leg"))
        .unwrap();
    let made = gelenk(folder.path(), &["new", "still", "--urdf", "legs.urdf"]);
    assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    assert!(shown(&made).contains("note[legs-on-fixed-base]"), "{}", shown(&made));
    fs::write(folder.path().join("fingers.urdf"), GRIPPER.replace("MIMIC", "")).unwrap();
    let made = gelenk(folder.path(), &["new", "hand", "--urdf", "fingers.urdf"]);
    assert!(made.stderr.is_empty(), "{}", shown(&made));
}

/// The new description states the free base, and its comments offer drives for all joints but the base's own.
#[test]
fn a_new_crate_has_a_robot_that_floats() {
    let folder = tempfile::tempdir().unwrap();
    let massless = GRIPPER.replace("MIMIC", "");
    fs::write(folder.path().join("massless.urdf"), &massless).unwrap();
    let refused = gelenk(folder.path(), &["new", "none", "--urdf", "massless.urdf", "--base", "floating"]);
    assert_eq!(refused.status.code(), Some(1), "{}", shown(&refused));
    let body = r#"<link name="base"><inertial><mass value="2"/><inertia ixx="1e-2" ixy="0" ixz="0" iyy="1e-2" iyz="0" izz="1e-2"/></inertial></link>"#;
    let urdf = massless.replace(r#"<link name="base"/>"#, body);
    fs::write(folder.path().join("gripper.urdf"), urdf).unwrap();
    for (name, language) in [("rust", None), ("c", Some("--c")), ("python", Some("--python"))] {
        let mut arguments = vec!["new", name, "--urdf", "gripper.urdf", "--base", "floating"];
        arguments.extend(language);
        let made = gelenk(folder.path(), &arguments);
        assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
        let text = fs::read_to_string(folder.path().join(name).join("robot.toml")).unwrap();
        assert!(text.contains("\nbase = { type = \"floating\" }\n"), "{text}");
        assert_eq!(text.matches("\n# drive = ").count(), 2, "{text}");
    }
    let main = fs::read_to_string(folder.path().join("rust/src/main.rs")).unwrap();
    assert!(main.contains("LtvMpc"), "{main}");
    let home = folder.path().join("rust");
    let generated = gelenk(&home, &["generate", "robot.toml"]);
    assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
    // A body alone has no drives, and B without entries makes no warning.
    fs::write(folder.path().join("body.urdf"), format!("<robot name=\"r\">{body}</robot>")).unwrap();
    let made = gelenk(folder.path(), &["new", "alone", "--urdf", "body.urdf", "--base", "floating"]);
    assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    let home = folder.path().join("alone");
    let text = fs::read_to_string(home.join("robot.toml")).unwrap();
    assert!(!text.contains("describes no drives"), "{text}");
    let generated = gelenk(&home, &["generate", "robot.toml"]);
    assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
    assert!(fs::read_to_string(home.join("robot.rs")).unwrap().contains("let _ = b_x;"));
    // Without a URDF it is a quadrotor.
    let made = gelenk(folder.path(), &["new", "drone", "--base", "floating"]);
    assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    let generated = gelenk(&folder.path().join("drone"), &["generate", "robot.toml"]);
    assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
}

#[test]
fn a_new_crate_is_not_made_of_a_file_that_is_no_urdf() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("broken.urdf"), "<robot name=\"r\"><link/></robot>").unwrap();
    fs::write(folder.path().join("arm.toml"), include_str!("../../src/cli/template/robot/arm.toml")).unwrap();
    for (file, code, message) in [
        ("none.urdf", 1, "none.urdf"),
        ("broken.urdf", 1, "name"),
        ("arm.toml", 2, "arm.toml is neither URDF nor MJCF"),
    ] {
        let refused = gelenk(folder.path(), &["new", "arm", "--urdf", file]);
        assert_eq!(refused.status.code(), Some(code), "{}", shown(&refused));
        assert!(shown(&refused).contains(message), "{}", shown(&refused));
        assert!(!folder.path().join("arm").exists());
    }
}

#[test]
fn a_new_crate_is_made_once_and_only_under_a_good_name() {
    let folder = tempfile::tempdir().unwrap();
    let made = gelenk(folder.path(), &["new", "my-arm", "--format", "json"]);
    assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    let said: serde_json::Value = serde_json::from_slice(&made.stdout).unwrap();
    assert_eq!(said["package"], "my-arm");
    for file in said["files"].as_array().unwrap() {
        assert!(folder.path().join("my-arm").join(file.as_str().unwrap()).is_file(), "{file}");
    }
    for (arguments, code, message) in [
        (vec!["new", "my-arm"], 1, "my-arm exists already"),
        (vec!["new", "2nd"], 2, "must begin with a letter"),
        (vec!["new", "a b"], 2, "letters from a to z"),
        (vec!["new", "fn"], 2, "a Rust keyword"),
        (vec!["new", ".."], 2, "does not end in a crate name"),
        (vec!["new", "other", "--git", "git@host:a/b"], 2, "ssh://git@host/a/b"),
        (vec!["new", "other", "--version", "newest"], 2, "is not a version"),
        (vec!["new", "my-arm/robot.toml/arm"], 1, "choose a folder with write permission"),
        (vec!["new", "other", "--checkout", "."], 1, "no checkout of gelenk"),
        (vec!["new", "other", "--git", "x", "--version", "1"], 2, "cannot be used with"),
    ] {
        let refused = gelenk(folder.path(), &arguments);
        assert_eq!(refused.status.code(), Some(code), "{}", shown(&refused));
        let stderr = String::from_utf8_lossy(&refused.stderr);
        assert!(stderr.contains(message), "{stderr}");
    }
    // Nothing is left behind by what was refused.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    let made = gelenk(folder.path(), &["new", "elsewhere", "--git", "https://example.org/gelenk.git"]);
    assert_eq!(made.status.code(), Some(0));
    let manifest = fs::read_to_string(folder.path().join("elsewhere/Cargo.toml")).unwrap();
    assert_eq!(manifest.matches("git = \"https://example.org/gelenk.git\"").count(), 2);
}
