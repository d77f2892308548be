//! Torque–speed lines of motors, from the description to the constants of modules, tables and exported files.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;

/// Two joints: the first has a motor in amperes behind a gear that turns it around, both are moved by another motor.
const ROBOT: &str = r#"
name = "two_joints"

[[joints]]
name = "shoulder"
axis = [0, 1, 0]
drive = { gear_ratio = -100, motor_constant = 0.5, stall_torque = 0.6, no_load_speed = 300 }

[[joints]]
name = "elbow"
axis = [0, 1, 0]
origin = { xyz = [0, 0, 0.3] }

[[drives]]
name = "both"
on = { shoulder = 1, elbow = -0.5 }
gear_ratio = 40
coupling = "diagonal"
stall_torque = 1.5
no_load_speed = 200

[[drives]]
name = "elbow"
on = { elbow = 2 }
gear_ratio = 10
coupling = "diagonal"

[[bodies]]
link = "shoulder"
mass = 1
inertia = 0.1

[[bodies]]
link = "elbow"
mass = 1
inertia = 0.1

[generate]
functions = ["mass_matrix"]
"#;

/// Runs the program in a folder with the robot, and returns what it printed.
fn run(folder: &Path, arguments: &[&str]) -> String {
    let mut program = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    let output = program.current_dir(folder).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    [said, String::from_utf8_lossy(&output.stdout).into_owned()].concat()
}

fn folder(description: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_owned();
    fs::write(path.join("robot.toml"), description).unwrap();
    (folder, path)
}

/// Words without their line breaks.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn without_lines() -> String {
    let lines = ROBOT.lines().filter(|line| !line.starts_with("stall_") && !line.starts_with("no_load_"));
    let text: String = lines.map(|line| [line, "\n"].concat()).collect();
    text.replace(", stall_torque = 0.6, no_load_speed = 300", "")
}

/// The slope at the first joint's input: 0.6/300 N m s/rad · (−100) over 0.5 N m/A; at the motor of both 1.5/200 · 40 times the
/// weights.
#[test]
fn a_module_has_them_in_the_units_of_its_inputs() {
    let (_kept, path) = folder(ROBOT);
    run(&path, &["generate", "robot.toml", "-o", "robot.rs"]);
    let module = flat(&fs::read_to_string(path.join("robot.rs")).unwrap());
    let slopes = "TORQUE_SPEED_SLOPES: [[f64; N]; 3] = [[-0.4, 0.0], [0.3, -0.15], [0.0, 0.0]];";
    assert!(module.contains(slopes), "{module}");
    assert!(module.contains("TORQUE_SPEED_LIMITS: [f64; M] = [1.2, 1.5, f64::INFINITY];"), "{module}");
    run(&path, &["generate", "robot.toml", "--language", "c"]);
    let header = flat(&fs::read_to_string(path.join("two_joints.h")).unwrap());
    assert!(header.contains("TORQUE_SPEED_LIMITS"), "{header}");
}

#[test]
fn a_module_without_them_has_no_such_constants() {
    let (_kept, path) = folder(&without_lines());
    run(&path, &["generate", "robot.toml", "-o", "robot.rs"]);
    let module = fs::read_to_string(path.join("robot.rs")).unwrap();
    assert!(!module.contains("TORQUE_SPEED"), "{module}");
    let said = run(&path, &["inspect", "model", "robot.toml"]);
    assert!(!said.contains("stall torque"), "{said}");
}

#[test]
fn inspect_and_report_show_them() {
    let (_kept, path) = folder(ROBOT);
    let said = flat(&run(&path, &["inspect", "model", "robot.toml"]));
    let columns = "stall torque of the motor [N m] no-load speed of the motor [rad/s]";
    assert!(said.contains(columns) && said.contains(" 0.6 300 ") && said.contains(" 1.5 200 "), "{said}");
    let json = run(&path, &["inspect", "model", "robot.toml", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&json[json.find('{').unwrap()..]).unwrap();
    let drives = json["drives"].as_array().unwrap();
    let both = drives.iter().find(|drive| drive["drive"] == "both").unwrap();
    assert_eq!(both["no-load_speed_of_the_motor"], 200.0);
    run(&path, &["report", "robot.toml", "--output", "page"]);
    let page = fs::read_to_string(path.join("page/index.html")).unwrap();
    assert!(page.contains("stall torque") && page.contains("no-load speed"), "no columns");
}

/// No format has them, and it is said at whose cost.
#[test]
fn exported_files_say_that_they_are_left_out() {
    let (_kept, path) = folder(ROBOT);
    let said = flat(&run(&path, &["export", "robot.toml", "--mjcf", "--output", "robot.xml"]));
    assert!(
        said.contains("has no torque–speed lines of motors. They are omitted at: `shoulder`, `both`"),
        "{said}"
    );
    let said = flat(&run(&path, &["export", "robot.toml", "--urdf", "--output", "robot.urdf"]));
    assert!(said.contains("has no torque–speed lines of motors. They are omitted at: `shoulder`"), "{said}");
}

/// Plans a motion, and returns the largest |u + C ẏ| of each motor along it, and its largest |u|. B is that of `ROBOT`.
fn planned(description: &str) -> [[f64; 2]; 2] {
    let (_kept, path) = folder(description);
    let line = "identify --plan robot.toml --harmonics 3 --seconds 6 --rate 20 --acceleration 8";
    run(&path, &line.split(' ').collect::<Vec<_>>());
    let file = read::read(&path.join("robot.toml"), &ReadOptions::default()).unwrap();
    let robot = InterpretedRobot::new(&file.model).unwrap();
    let rows = fs::read_to_string(path.join("plan.csv")).unwrap();
    let mut largest = [[0.0_f64; 2]; 2];
    for row in rows.lines().skip(1) {
        let x: Vec<f64> = row.split(',').map(|x| x.parse().unwrap()).collect();
        let (y, v, a) = (&x[1..3], &x[3..5], &x[5..7]);
        let mut forces = [0.0; 2];
        robot.rigid_forces(y, v, a, &mut forces);
        // τ₁ = −50 u₁ + 40 u₂, τ₂ = −20 u₂.
        let second = -forces[1] / 20.0;
        let inputs = [(40.0 * second - forces[0]) / 50.0, second];
        let taken = [-0.4 * v[0], 0.3 * v[0] - 0.15 * v[1]];
        for motor in 0..2 {
            largest[0][motor] = largest[0][motor].max((inputs[motor] + taken[motor]).abs());
            largest[1][motor] = largest[1][motor].max(inputs[motor].abs());
        }
    }
    largest
}

/// Two links of much inertia on the motors of `ROBOT`.
fn inert(description: &str) -> String {
    let two = description
        .replace("mass = 1\ninertia = 0.1", "mass = 2\ncenter_of_mass = [0, 0, 0.05]\ninertia = 0.8");
    let third =
        "[[drives]]\nname = \"elbow\"\non = { elbow = 2 }\ngear_ratio = 10\ncoupling = \"diagonal\"\n";
    assert!(two.contains(third));
    two.replace(third, "").replace("axis = [0, 1, 0]", "axis = [0, 1, 0]\nlimits = { velocity = 3 }")
}

#[test]
fn a_planned_motion_keeps_them() {
    let [lines, _] = planned(&inert(&without_lines()));
    assert!(lines[0] > 1.2 || lines[1] > 1.5, "the motion needs no line: {lines:?}");
    let [lines, _] = planned(&inert(ROBOT));
    assert!(lines[0] <= 1.2 && lines[1] <= 1.5, "{lines:?}");
}

/// An arm that turns about a vertical axis and tilts.
fn slow_arm(effort: f64, tilt: &str) -> String {
    format!(
        "[[joints]]\nname = \"swing\"\nlimits = {{ position = [-2, 2], velocity = 3, effort = {effort} }}\ndrive = \"ideal\"\n\
         [[joints]]\nname = \"tilt\"\naxis = [0, 1, 0]\nlimits = {{ position = {tilt}, velocity = 3, effort = 8 }}\n\
         drive = \"ideal\"\n[[bodies]]\nlink = \"swing\"\nmass = 20\ninertia = 6\n[[bodies]]\nlink = \"tilt\"\nmass = 3\n\
         center_of_mass = [0, 0, 0.5]\ninertia = 0.3\n"
    )
}

/// The limits of the joints allow accelerations of which their efforts bear a quarter.
#[test]
fn a_plan_is_as_small_as_the_efforts_ask() {
    let line = "identify --plan robot.toml --harmonics 3 --seconds 10".split(' ').collect::<Vec<_>>();
    let (_kept, path) = folder(&slow_arm(5.0, "[-0.3, 0.3]"));
    let said = run(&path, &line);
    assert!(said.contains("this motion has only "), "{said}");
    let refused = |effort: f64, tilt: &str| {
        let (_kept, path) = folder(&slow_arm(effort, tilt));
        let output =
            Command::new(env!("CARGO_BIN_EXE_gelenk")).current_dir(&path).args(&line).output().unwrap();
        assert!(!output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let falling = refused(5.0, "[0.5, 2]");
    let words = "holding the robot still at the middle of its position limits needs more effort than the plan may use, at tilt";
    assert!(falling.contains(words), "{falling}");
    let weak = refused(0.1, "[-0.3, 0.3]");
    let words = "no motion within the limits determines all parameters";
    assert!(weak.contains(words) && weak.contains("motions): swing. Raise"), "{weak}");
}

/// The torque of a motor is kept where its joint has no `effort`, as that of a motor on two joints is.
#[test]
fn a_planned_motion_keeps_the_torques_of_motors() {
    let [_, free] = planned(&inert(&without_lines()));
    let limited = without_lines().replace("motor_constant = 0.5", "motor_constant = 0.5, torque = 0.3");
    let [_, kept] = planned(&inert(&limited));
    // In amperes; seven tenths are used, at the instants of the search.
    assert!(free[0] > 0.6 && kept[0] <= 0.7 * 0.6 * 1.01, "{free:?} {kept:?}");
}
