//! Derived functions against values that nobody here computed: Pinocchio's and the published PowerCube
//! model's.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fmt::Write as _;
use std::path::Path;

use gelenk_codegen::functions::form::Form;
use gelenk_codegen::pipeline::GenerateOptions;
use gelenk_codegen::read::ReadOptions;
use gelenk_tests::{Robot, reference, relative_error, robot_of_others, workspace};
use serde_json::Value;

/// All numbers below a value, in order: matrices rows first.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().expect("a number")],
    }
}

fn samples(reference: &Value) -> &[Value] {
    reference["samples"].as_array().expect("samples")
}

/// One robot of the reference: its URDF as it is, the listed joints held, a frame at the last joint.
fn reference_robot(name: &str, urdf: &Path, reference: &Value) -> Robot {
    let text = std::fs::read_to_string(urdf).expect("the URDF of the reference");
    let joint = reference["frame"].as_str().expect("frame");
    let mut description =
        format!("name = \"{name}\"\nurdf = {:?}\nignore_mimic = true\n", urdf.display().to_string());
    for locked in reference["locked"].as_array().expect("locked") {
        let _ = write!(description, "[[joints]]\nname = {locked}\nheld = 0\n");
    }
    let _ = write!(description, "[[frames]]\nname = \"last\"\nlink = {:?}\n", child_link(&text, joint));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("robot.toml");
    std::fs::write(&path, description).expect("a file");
    let options = GenerateOptions { reading: without_friction(), ..GenerateOptions::default() };
    Robot::derive(&path, &options)
}

fn without_friction() -> ReadOptions {
    ReadOptions { no_friction: true, ..ReadOptions::default() }
}

/// The link that a joint of a URDF moves.
fn child_link(urdf: &str, joint: &str) -> String {
    let from =
        urdf.find(&format!("<joint name=\"{joint}\"")).or_else(|| urdf.find(&format!("name=\"{joint}\"")));
    let rest = &urdf[from.expect("the joint")..];
    let child = &rest[rest.find("<child").expect("a child")..];
    let name = &child[child.find("link=\"").expect("a link") + 6..];
    name[..name.find('"').expect("a quote")].to_owned()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn negative(a: &[f64]) -> Vec<f64> {
    a.iter().map(|a| -a).collect()
}

fn check(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let error = relative_error(found, expected);

    assert!(error <= tolerance, "{what}: relative error {error:e}");
}

/// Jacobians of inverse and forward dynamics, and the linearization that follows from them.
fn derivatives_agree(robot: &Robot, sample: &Value) {
    const TOLERANCE: f64 = 1e-9;
    let get = |key: &str| numbers(&sample[key]);
    let (y, v, a, tau) = (get("y"), get("v"), get("a"), get("tau"));
    let inverse = robot.call("inverse_dynamics_derivatives_and_mass_matrix", &[&y, &v, &a]);
    for (found, key) in inverse.iter().zip(["id", "did_dy", "did_dv", "M"]) {
        check(key, found, &get(key), TOLERANCE);
    }
    let inverse = robot.call("inverse_dynamics_derivatives", &[&y, &v, &a]);
    for (found, key) in inverse.iter().zip(["id", "did_dy", "did_dv"]) {
        check(key, found, &get(key), TOLERANCE);
    }
    let forward = robot.call("forward_dynamics_derivatives", &[&y, &v, &tau]);
    for (found, key) in forward.iter().zip(["fd", "dfd_dy", "dfd_dv", "dfd_dtau"]) {
        check(key, found, &get(key), TOLERANCE);
    }
    // The drives are ideal: u are the joint forces.
    let linear = robot.call("linearize", &[&y, &v, &tau]);
    for (found, key) in linear.iter().zip(["dfd_dy", "dfd_dv", "dfd_dtau"]) {
        check(key, found, &get(key), TOLERANCE);
    }
    let products = [(&linear[0], &y), (&linear[1], &v), (&linear[2], &tau), (&linear[3], &vec![])];
    let mut total = products[3].0.clone();
    for (matrix, x) in &products[..3] {
        total = sum(&total, &matrix_times(matrix, x));
    }
    // Sums of products as large as the accelerations' derivatives times the state.
    check("A x + B u + c", &total, &get("fd"), 1e-8);
}

fn agrees_with_pinocchio(name: &str, urdf: &Path) {
    let reference = reference(&format!("{name}.json"));
    let robot = reference_robot(name, urdf, &reference);
    const TOLERANCE: f64 = 1e-9;
    for sample in samples(&reference) {
        let get = |key: &str| numbers(&sample[key]);
        let (y, v, a, tau) = (get("y"), get("v"), get("a"), get("tau"));
        let (c, g) = (get("c"), get("g"));
        check("M", &robot.first("mass_matrix", &[&y]), &get("M"), TOLERANCE);
        check("c", &robot.first("coriolis_forces", &[&y, &v]), &c, TOLERANCE);
        check("g", &robot.first("gravity_forces", &[&y]), &negative(&g), TOLERANCE);
        check("q", &robot.first("applied_forces", &[&y, &v]), &negative(&g), TOLERANCE);
        check("nle", &robot.first("bias_forces", &[&y, &v]), &sum(&c, &g), TOLERANCE);
        check("id", &robot.first("inverse_dynamics", &[&y, &v, &a]), &get("id"), TOLERANCE);
        check("fd", &robot.first("forward_dynamics", &[&y, &v, &tau]), &get("fd"), TOLERANCE);
        check("kinetic", &robot.first("kinetic_energy", &[&y, &v]), &get("kinetic"), TOLERANCE);
        check("potential", &robot.first("potential_energy", &[&y]), &get("potential"), TOLERANCE);
        let all = robot.call("equations_of_motion", &[&y, &v]);
        check("M of all", &all[0], &get("M"), TOLERANCE);
        check("k of all", &all[1], &c, TOLERANCE);
        check("q of all", &all[2], &negative(&g), TOLERANCE);
        derivatives_agree(&robot, sample);
        if sample.get("regressor").is_some() {
            let regressor = robot.first("inertial_regressor", &[&y, &v, &a]);
            check("W", &regressor, &get("regressor"), TOLERANCE);
        }
        let pose = robot.call("frame_last_pose", &[&y]);
        check("p", &pose[0], &get("p"), TOLERANCE);
        check("R", &pose[1], &get("R"), TOLERANCE);
        check("J", &robot.first("frame_last_jacobian", &[&y]), &get("J"), TOLERANCE);
    }
}

#[test]
#[cfg_attr(not(robots_of_others), ignore = "no URDF: python3 tests/reference/robots.py")]
fn double_pendulum_agrees_with_pinocchio() {
    agrees_with_pinocchio("double_pendulum", &robot_of_others("double_pendulum"));
}

#[test]
fn ur5_agrees_with_pinocchio() {
    agrees_with_pinocchio("ur5", &workspace().join("models/urdf/ur5.urdf"));
}

#[test]
fn panda_agrees_with_pinocchio() {
    agrees_with_pinocchio("panda", &workspace().join("models/urdf/panda.urdf"));
}

#[test]
#[cfg_attr(not(robots_of_others), ignore = "no URDF: python3 tests/reference/robots.py")]
fn baxter_agrees_with_pinocchio() {
    agrees_with_pinocchio("baxter", &robot_of_others("baxter"));
}

#[test]
fn powercube_agrees_with_its_published_model() {
    let reference = reference("powercube/dynamics.json");
    let robot = model("powercube");
    const TOLERANCE: f64 = 1e-12;
    for sample in samples(&reference) {
        let get = |key: &str| numbers(&sample[key]);
        let (y, v, u) = (get("y"), get("v"), get("u"));
        let all = robot.call("equations_of_motion", &[&y, &v]);
        check("M", &all[0], &get("M"), TOLERANCE);
        check("k", &all[1], &get("k"), TOLERANCE);
        check("q", &all[2], &get("q"), TOLERANCE);
        check("B", &robot.first("input_matrix", &[]), &get("B"), TOLERANCE);
        let acceleration = robot.first("forward_dynamics", &[&y, &v, &u]);
        check("ẋ", &[v.clone(), acceleration].concat(), &get("xdot"), TOLERANCE);
    }
}

fn model(name: &str) -> Robot {
    Robot::whole(&workspace().join("models").join(format!("{name}.toml")))
}

/// Puma 560 at qn (robotics-toolbox-python, tests/test_DHRobot.py, four decimals).
#[test]
fn puma560_agrees_with_its_published_tables() {
    use std::f64::consts::{FRAC_PI_4, PI};
    let robot = model("puma560");
    let y = [0.0, FRAC_PI_4, PI, 0.0, FRAC_PI_4, 0.0];
    let still = [0.0; 6];
    let close = |found: &[f64], expected: &[f64], tolerance: f64| {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() <= tolerance, "{found:?} is not {expected:?}");
        }
    };
    let rounding = 6e-5;
    let gravity = robot.first("gravity_forces", &[&y]);
    close(&negative(&gravity), &[0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0], rounding);
    let upper = [
        (0, vec![3.6594, -0.4044, 0.1006, -0.0025, 0.0, 0.0]),
        (1, vec![4.4137, 0.3509, 0.0, 0.0024, 0.0]),
        (2, vec![0.9378, 0.0, 0.0015, 0.0]),
        (3, vec![0.1925, 0.0, 0.0]),
        (4, vec![0.1713, 0.0]),
        (5, vec![0.1941]),
    ];
    let mass = robot.first("mass_matrix", &[&y]);
    for (row, entries) in upper {
        close(&mass[7 * row..6 * row + 6], &entries, rounding);
    }
    let bias = robot.first("coriolis_forces", &[&y, &[1.0, 2.0, 3.0, 1.0, 2.0, 3.0]]);
    let velocities = [1.0, 2.0, 3.0, 1.0, 2.0, 3.0];
    let product = |row: [f64; 6]| row.iter().zip(&velocities).map(|(c, v)| c * v).sum::<f64>();
    let expected = [
        product([-0.1735, -2.0494, -0.1178, -0.0002, -0.0045, 0.0001]),
        product([0.6274, 1.1572, 1.9287, -0.0015, -0.0003, 0.0]),
        product([-0.3608, -0.7734, -0.0018, -0.0009, -0.0064, 0.0]),
    ];
    // Six entries of four decimals each, times velocities of up to 3.
    close(&bias[..3], &expected, 6e-4);
    let ones = [1.0; 6];
    let inverse = |v: &[f64; 6], a: &[f64; 6]| robot.first("inverse_dynamics", &[&y, v, a]);
    close(&inverse(&still, &ones), &[3.35311, 36.0025, 7.42596, 0.190043, 0.203441, 0.194133], 6e-5);
    close(&inverse(&ones, &ones), &[32.4952, 60.867, 17.7436, 1.45452, 1.29911, 0.713781], 6e-5);
    let inertial = sum(&robot.first("coriolis_forces", &[&y, &still]), &matrix_times(&mass, &velocities));
    close(&inertial, &[3.15, 9.4805, 3.6189, 0.1901, 0.3519, 0.5823], 6e-5);
}

fn matrix_times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix.chunks(x.len()).map(|row| row.iter().zip(x).map(|(m, x)| m * x).sum()).collect()
}

#[test]
fn every_model_is_there() {
    let folder = workspace().join("models");
    for name in
        ["powercube", "powercube_six_axis", "powercube_alpha", "puma560", "double_pendulum", "cart_pole"]
    {
        assert!(Path::exists(&folder.join(format!("{name}.toml"))), "{name}");
    }
}

/// The Panda's second finger follows the first one: `<mimic>` of its URDF.
#[test]
fn coupled_fingers_agree_with_pinocchio() {
    let reference = reference("mechanisms/panda_mimic.json");
    let urdf = workspace().join("models/urdf/panda.urdf");
    let in_form = |form| {
        let options = GenerateOptions { reading: without_friction(), form, ..GenerateOptions::default() };
        Robot::derive(&urdf, &options)
    };
    let (robot, looped) = (in_form(Form::Straight), in_form(Form::Arrays));
    let derivatives = "inverse_dynamics_derivatives_and_mass_matrix";
    assert!(looped.function(derivatives).arrays.is_some());
    assert_eq!(robot.model.coordinates.len(), 8);
    for sample in samples(&reference) {
        let get = |key: &str| numbers(&sample[key]);
        let (y, v, a, tau) = (get("y"), get("v"), get("a"), get("tau"));
        const TOLERANCE: f64 = 1e-11;
        check("M", &robot.first("mass_matrix", &[&y]), &get("M"), TOLERANCE);
        check("nle", &robot.first("bias_forces", &[&y, &v]), &get("nle"), TOLERANCE);
        check("g", &robot.first("gravity_forces", &[&y]), &negative(&get("g")), TOLERANCE);
        check("id", &robot.first("inverse_dynamics", &[&y, &v, &a]), &get("id"), TOLERANCE);
        check("fd", &robot.first("forward_dynamics", &[&y, &v, &tau]), &get("fd"), TOLERANCE);
        for robot in [&robot, &looped] {
            let inverse = robot.call(derivatives, &[&y, &v, &a]);
            for (found, key) in inverse.iter().zip(["id", "did_dy", "did_dv", "M"]) {
                check(key, found, &get(key), 1e-10);
            }
        }
        let forward = looped.call("forward_dynamics_derivatives", &[&y, &v, &tau]);
        check("fd", &forward[0], &get("fd"), 1e-10);
    }
}

/// Helical, cylindrical, universal and planar joints, joints that follow screws, rotors in general directions:
/// `tests/reference/make_joints.py` made the values.
fn joints_agree_with_pinocchio(name: &str) {
    const TOLERANCE: f64 = 1e-11;
    const OF_JACOBIANS: f64 = 1e-10;
    let folder = workspace().join("tests/reference");
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).expect("committed values");
    let reference: Value = serde_json::from_str(&text).expect("JSON");
    let robot = Robot::whole(&folder.join(format!("{name}.toml")));
    let wrenches = Robot::of_model(robot.model.clone(), &["joint_wrenches"]);
    let looped = Robot::in_form(robot.model.clone(), &LOOPS, Form::Arrays);
    for name in LOOPS {
        assert!(looped.function(name).arrays.is_some(), "{name}");
    }
    let names: Vec<&str> = robot.model.joints().map(|joint| joint.name.as_str()).collect();
    assert_eq!(reference["joints"], serde_json::json!(names));
    for sample in samples(&reference) {
        let get = |key: &str| numbers(&sample[key]);
        let (y, v, a) = (get("y"), get("v"), get("a"));
        check("M", &robot.first("mass_matrix", &[&y]), &get("M"), TOLERANCE);
        check("nle", &robot.first("bias_forces", &[&y, &v]), &get("nle"), TOLERANCE);
        check("g", &robot.first("gravity_forces", &[&y]), &negative(&get("g")), TOLERANCE);
        check("id", &robot.first("inverse_dynamics", &[&y, &v, &a]), &get("id"), TOLERANCE);
        check("T", &robot.first("kinetic_energy", &[&y, &v]), &get("kinetic"), TOLERANCE);
        let found = wrenches.first("joint_wrenches", &[&y, &v, &a]);
        check("reactions", &found, &get("reactions"), TOLERANCE);
        let inverse = robot.call("inverse_dynamics_derivatives_and_mass_matrix", &[&y, &v, &a]);
        for (found, key) in inverse.iter().zip(["id", "did_dy", "did_dv", "M"]) {
            check(key, found, &get(key), OF_JACOBIANS);
        }
        let pose = robot.call("frame_last_pose", &[&y]);
        check("p", &pose[0], &get("p"), TOLERANCE);
        check("R", &pose[1], &get("R"), TOLERANCE);
        check("J", &robot.first("frame_last_jacobian", &[&y]), &get("J"), TOLERANCE);
        forward_agrees(&robot, sample);
        let inverse = looped.call("inverse_dynamics_derivatives_and_mass_matrix", &[&y, &v, &a]);
        for (found, key) in inverse.iter().zip(["id", "did_dy", "did_dv", "M"]) {
            check(key, found, &get(key), OF_JACOBIANS);
        }
        forward_derivatives_agree(&looped, sample);
    }
}

/// Functions with loops over joints.
const LOOPS: [&str; 3] =
    ["inverse_dynamics_derivatives_and_mass_matrix", "forward_dynamics_derivatives", "linearize"];

/// Forward dynamics under inputs, its derivatives by the state, and what `linearize` makes of them.
fn forward_agrees(robot: &Robot, sample: &Value) {
    let get = |key: &str| numbers(&sample[key]);
    let (y, v, u) = (get("y"), get("v"), get("u"));
    check("fd", &robot.first("forward_dynamics", &[&y, &v, &u]), &get("fd"), 1e-11);
    forward_derivatives_agree(robot, sample);
}

fn forward_derivatives_agree(robot: &Robot, sample: &Value) {
    let get = |key: &str| numbers(&sample[key]);
    let (y, v, u) = (get("y"), get("v"), get("u"));
    let derivatives = robot.call("forward_dynamics_derivatives", &[&y, &v, &u]);
    for (found, key) in derivatives.iter().zip(["fd", "dfd_dy", "dfd_dv"]) {
        check(key, found, &get(key), 1e-10);
    }
    let affine = robot.call("linearize", &[&y, &v, &u]);
    check("A_y", &affine[0], &get("dfd_dy"), 1e-10);
    check("A_v", &affine[1], &get("dfd_dv"), 1e-10);
}

#[test]
fn every_type_of_joint_agrees_with_pinocchio() {
    joints_agree_with_pinocchio("joints");
}

#[test]
fn coupled_screws_agree_with_pinocchio() {
    joints_agree_with_pinocchio("coupled_joints");
}

/// A robot next to this test, with the values that a script of `tests/reference` made of it.
fn committed(name: &str) -> (Robot, Value) {
    let folder = workspace().join("tests/reference");
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).expect("committed values");
    let robot = Robot::whole(&folder.join(format!("{name}.toml")));
    (robot, serde_json::from_str(&text).expect("JSON"))
}

/// `tests/reference/make_springs.py` made the values.
#[test]
fn springs_between_points_agree_with_drake() {
    const TOLERANCE: f64 = 1e-10;
    let (robot, reference) = committed("springs");
    for sample in samples(&reference) {
        let get = |key: &str| numbers(&sample[key]);
        let (y, v, a, u) = (get("y"), get("v"), get("a"), get("u"));
        check("springs", &robot.first("spring_forces", &[&y, &v]), &get("springs"), TOLERANCE);
        check("id", &robot.first("inverse_dynamics", &[&y, &v, &a]), &get("id"), TOLERANCE);
        check("fd", &robot.first("forward_dynamics", &[&y, &v, &u]), &get("fd"), TOLERANCE);
        check("V", &robot.first("potential_energy", &[&y]), &get("V"), TOLERANCE);
    }
}

/// The parallelogram by `follows` is the one whose loops Pinocchio's proximal solver closes:
/// `tests/reference/make_palletizer.py` made the values.
#[test]
fn the_palletizer_agrees_with_closed_loops() {
    let (robot, reference) = committed("palletizer");
    for sample in samples(&reference) {
        let get = |key: &str| numbers(&sample[key]);
        let found = robot.first("forward_dynamics", &[&get("y"), &get("v"), &get("u")]);
        check("fd", &found, &get("fd"), 1e-9);
    }
}
