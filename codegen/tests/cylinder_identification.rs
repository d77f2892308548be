//! An excavator that is identified from the forces of its cylinders.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;
use nalgebra::{Matrix4, Vector4};
use tempfile::TempDir;

/// True parameters of the excavator of `models/`: the bucket is full, the boom has more friction.
const BODIES: &str = r#"
[[bodies]]
link = "bucket"
mass = 95
center_of_mass = [0.32, 0, 0.1]
inertia = [2.2, 3.1, 3.4]

[[bodies]]
link = "stick"
mass = 52
center_of_mass = [0.4, 0, 0.06]
inertia = [0.6, 6, 6]
"#;

/// Viscous friction of the joints in truth [N m s].
const VISCOUS: [f64; 4] = [260.0, 90.0, 30.0, 22.0];

fn excavator() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/excavator.toml").canonicalize().unwrap()
}

fn robot(path: &Path) -> InterpretedRobot {
    let loaded = read::read(path, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}"));
    InterpretedRobot::new(&loaded.model).unwrap_or_else(|problems| panic!("{problems}"))
}

/// y, ẏ and ÿ of a motion within the limits.
fn motion(t: f64, pace: f64) -> [[f64; 4]; 3] {
    let centres = [0.0, -0.3, 1.4, 0.8];
    let sizes = [0.6, 0.35, 0.5, 0.7];
    let mut motion = [[0.0; 4]; 3];
    for joint in 0..4 {
        motion[0][joint] = centres[joint];
        for (k, share) in [(1.0, 0.6), (2.3, 0.25), (3.7, 0.15)] {
            let w = pace * (0.5 + 0.13 * joint as f64) * k;
            let (size, phase) = (sizes[joint] * share, 1.7 * joint as f64 + k);
            let (sin, cos) = (w * t + phase).sin_cos();
            motion[0][joint] += size * sin;
            motion[1][joint] += size * w * cos;
            motion[2][joint] -= size * w * w * sin;
        }
    }
    motion
}

/// Forces at the joints in truth.
fn forces(truth: &InterpretedRobot, [y, v, a]: &[[f64; 4]; 3]) -> Vector4<f64> {
    let mut forces = [0.0; 4];
    truth.rigid_forces(y, v, a, &mut forces);
    Vector4::from_fn(|joint, _| forces[joint] + VISCOUS[joint] * v[joint])
}

/// The inputs that have these forces at the joints.
fn inputs(truth: &InterpretedRobot, y: &[f64; 4], forces: Vector4<f64>) -> Vector4<f64> {
    let column = |input: usize| {
        let mut column = [0.0; 4];
        truth.input_forces(y, &[0, 1, 2, 3].map(|k| f64::from(u8::from(k == input))), &mut column);
        Vector4::from(column)
    };
    let matrix = Matrix4::from_columns(&[0, 1, 2, 3].map(column));
    matrix.try_inverse().unwrap() * forces
}

/// 200 Hz; encoders of 1e-5 rad, forces to 1 N.
fn log(truth: &InterpretedRobot) -> String {
    let mut text = String::from("time,swing,boom,stick,bucket,u1,u2,u3,u4\n");
    for sample in 0..8000 {
        let t = 0.005 * f64::from(sample);
        let motion = motion(t, 1.0);
        let u = inputs(truth, &motion[0], forces(truth, &motion));
        write!(text, "{t:.3}").unwrap();
        motion[0].iter().for_each(|y| write!(text, ",{y:.5}").unwrap());
        u.iter().for_each(|u| write!(text, ",{u:.0}").unwrap());
        text.push('\n');
    }
    text
}

/// Root mean squares of the errors of the forces at the joints in another motion, relative to these.
fn errors(found: &InterpretedRobot, viscous: [f64; 4], truth: &InterpretedRobot) -> Vector4<f64> {
    let (mut errors, mut sizes) = (Vector4::zeros(), Vector4::zeros());
    for k in 0..300 {
        let motion = motion(77.0 + 0.1 * f64::from(k), 1.3);
        let expected = forces(truth, &motion);
        let mut rigid = [0.0; 4];
        found.rigid_forces(&motion[0], &motion[1], &motion[2], &mut rigid);
        let predicted = Vector4::from_fn(|j, _| rigid[j] + viscous[j] * motion[1][j]);
        errors += (predicted - expected).map(|x| x * x);
        sizes += expected.map(|x| x * x);
    }
    errors.component_div(&sizes).map(f64::sqrt)
}

struct Excavator {
    folder: TempDir,
    truth: InterpretedRobot,
}

impl Excavator {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let truth = folder.path().join("truth.toml");
        let head = format!("name = \"truth\"\nextends = \"{}\"\n", excavator().display());
        fs::write(&truth, format!("{head}{BODIES}")).unwrap();
        let truth = robot(&truth);
        fs::write(folder.path().join("log.csv"), log(&truth)).unwrap();
        Self { folder, truth }
    }

    /// Output of `gelenk identify`.
    fn identify(&self, arguments: &[&str]) -> Vec<u8> {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
        command.current_dir(self.folder.path()).arg("identify").arg(excavator()).args(arguments);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    }

    /// Compares forces in another motion with those of the identified description.
    fn assert_found(&self, name: &str) {
        let described = errors(&robot(&excavator()), [300.0, 60.0, 40.0, 15.0], &self.truth);
        // The friction is judged by its factors: the rigid robot has none.
        let found = errors(&robot(&self.folder.path().join(name)), VISCOUS, &self.truth);
        println!("described {described:?}, found {found:?}");
        assert!(described.iter().skip(1).all(|error| *error > 0.2), "{described:?}");
        assert!(found.iter().all(|error| *error < 0.02), "{found:?}");
    }
}

/// How the log's columns are read.
const COLUMNS: [&str; 4] = ["--effort", "input", "--columns", "position=2..5,input=6..9"];

#[test]
fn an_excavator_is_identified_from_the_forces_of_its_cylinders() {
    let excavator = Excavator::new();
    let output = ["log.csv", "--output", "found.toml", "--format", "json"];
    let printed = excavator.identify(&[&output[..], &COLUMNS].concat());
    excavator.assert_found("found.toml");
    let result: serde_json::Value = serde_json::from_slice(&printed).unwrap();
    for joint in result["joints"].as_array().unwrap() {
        assert!(joint["r_squared_held_out"].as_f64().unwrap() > 0.99, "{joint}");
    }
}

#[test]
fn its_log_reduces_to_moments() {
    let excavator = Excavator::new();
    let output = ["--reduce", "log.csv", "--output", "log.moments"];
    excavator.identify(&[&output[..], &COLUMNS].concat());
    excavator.identify(&["--merge", "log.moments", "--output", "merged.toml"]);
    excavator.assert_found("merged.toml");
}

/// The planned motion in rows of the file: y, ẏ and ÿ.
fn planned(file: &Path) -> Vec<[[f64; 4]; 3]> {
    let text = fs::read_to_string(file).unwrap();
    let rows = text.lines().skip(1).map(|line| {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        std::array::from_fn(|k| std::array::from_fn(|joint| numbers[1 + 4 * k + joint]))
    });
    rows.collect()
}

/// Runs the program in a folder of its own; whether it succeeded, and what it said.
fn plan(description: &Path, more: &[&str]) -> (TempDir, bool, String) {
    let folder = tempfile::tempdir().unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    let output = program
        .current_dir(folder.path())
        .args(["identify", "--plan"])
        .arg(description)
        .args(["--harmonics", "3"])
        .args(more)
        .output()
        .unwrap();
    let said = [output.stderr, output.stdout].concat();
    (folder, output.status.success(), String::from_utf8(said).unwrap())
}

/// The excavator with a bucket whose limits contain the dead centre of its cylinder, which is longest at 1.63 rad.
fn past_the_dead_centre(folder: &Path) -> PathBuf {
    let text = fs::read_to_string(excavator()).unwrap();
    let (limits, wide) = ("position = [-0.4, 1.3], velocity = 1.8", "position = [-0.4, 2.2], velocity = 1.8");
    assert!(text.contains(limits));
    let file = folder.join("wide.toml");
    fs::write(&file, text.replace(limits, wide)).unwrap();
    file
}

#[test]
fn a_plan_keeps_the_limits_of_cylinders() {
    let truth = robot(&excavator());
    let own = tempfile::tempdir().unwrap();
    let (folder, succeeded, said) = plan(&past_the_dead_centre(own.path()), &["--format", "json"]);
    assert!(succeeded, "{said}");
    let warning = "`bucket_cylinder` has a dead centre within the limits of joint `bucket`, at 1.63 rad";
    assert!(said.contains(warning), "{said}");
    let words = "bucket_cylinder has a dead centre within the limits of joint bucket. Therefore the plan moves this joint only \
                 from -0.27 to ";
    assert!(said.contains(words), "{said}");
    let found: serde_json::Value = serde_json::from_str(&said[said.find("{\n").unwrap()..]).unwrap();
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
    for [y, v, a] in planned(&folder.path().join("plan.csv")) {
        let mut forces = [0.0; 4];
        truth.rigid_forces(&y, &v, &a, &mut forces);
        let inputs = inputs(&truth, &y, Vector4::from(forces));
        for (range, u) in range.iter_mut().zip(inputs.iter()) {
            *range = [range[0].min(*u), range[1].max(*u)];
        }
    }
    for (input, range) in found["inputs"].as_array().unwrap().iter().zip(range) {
        let number = |key: &str, end: usize| input[key][end].as_f64().unwrap_or(f64::INFINITY);
        for (end, reached) in range.into_iter().enumerate() {
            // The file has more rows than the search has instants.
            let size = range[1] - range[0];
            assert!((number("range", end) - reached).abs() < 0.02 * size, "{input} {range:?}");
            assert!(reached.abs() <= 0.71 * number("limits", end).abs(), "{input} {range:?}");
        }
    }
    // No motion is slow enough for a boom that its cylinder cannot hold.
    let text =
        fs::read_to_string(excavator()).unwrap().replace("limits = [-60e3, 35e3]", "limits = [-6e2, 35e2]");
    let weak = folder.path().join("weak.toml");
    fs::write(&weak, text).unwrap();
    let (_, succeeded, said) = plan(&weak, &[]);
    let words = "holding the robot still at the middle of its position limits needs more effort than the plan may use, at input \
                 boom_cylinder.";
    assert!(!succeeded && said.contains(words), "{said}");
}

/// Cylinders cannot lead a joint through their dead centre, and a path is not better than a motion.
#[test]
fn a_way_to_the_motion_through_a_dead_centre_is_told() {
    let words =
        "the path from the start posture needs more effort than the plan may use, at input bucket_cylinder";
    let own = tempfile::tempdir().unwrap();
    let wide = past_the_dead_centre(own.path());
    let (_, succeeded, said) = plan(&wide, &["--start", "swing=0, boom=0.5, stick=1, bucket=2.1"]);
    assert!(succeeded && said.contains(words), "{said}");
}

#[test]
fn a_joint_that_no_cylinder_moves_is_named_with_the_remedy() {
    let text = fs::read_to_string(excavator()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("loose.toml");
    fs::write(&file, text.replace("input = \"bucket_cylinder\"\nlimits = [-35e3, 22e3]\n", "")).unwrap();
    let (_, succeeded, said) = plan(&file, &[]);
    let words = "joint bucket: no motion can be planned, because neither a drive nor an input at a frame moves this joint. \
                 Describe the force that moves it";
    assert!(!succeeded && said.contains(words), "{said}");
}

/// Two geared motors that share a wrist, and a cylinder: columns of B of sizes 80 and 0.2, with a propeller besides that only
/// pushes.
const WRIST: &str = r#"
name = "wrist"
joints = [
    { name = "boom", axis = [0, -1, 0], limits = { position = [0.1, 1.3], velocity = 0.8 } },
    { name = "pitch", axis = [0, 1, 0], origin = { xyz = [1.2, 0, 0] }, limits = { position = [-1.5, 1.5], velocity = 4 } },
    { name = "roll", axis = [1, 0, 0], limits = { position = [-3, 3], velocity = 6 } },
]
drives = [
    { name = "left", on = { pitch = 1, roll = 1 }, gear_ratio = 80 },
    { name = "right", on = { pitch = 1, roll = -1 }, gear_ratio = 80 },
]
bodies = [
    { link = "boom", mass = 20, center_of_mass = [0.6, 0, 0], inertia = [0.1, 2.4, 2.4] },
    { link = "pitch", mass = 0.8, center_of_mass = [0.02, 0, 0], inertia = 8e-4 },
    { link = "roll", mass = 0.7, center_of_mass = [0.08, 0, 0], inertia = [5e-4, 1e-3, 1e-3] },
]
frames = [
    { name = "foot", link = "base", origin = { xyz = [0.1, 0, -0.6] } },
    { name = "rod", link = "boom", origin = { xyz = [0.7, 0, 0] } },
    { name = "tip", link = "roll", origin = { xyz = [0.2, 0, 0] } },
]
forces = [{ between = ["foot", "rod"], input = "cylinder", limits = [-8e3, 8e3] }]
"#;

#[test]
fn shared_motors_beside_a_cylinder_and_a_propeller_are_planned() {
    let folder = tempfile::tempdir().unwrap();
    let fan =
        "inputs = [{ name = \"fan\", frame = \"tip\", wrench = [0, 1, 0, 0, 0, 0], limits = [0, 20] }]\n";
    for (name, text) in [("wrist.toml", WRIST.to_owned()), ("fan.toml", format!("{WRIST}{fan}"))] {
        let file = folder.path().join(name);
        fs::write(&file, text).unwrap();
        let (_, succeeded, said) = plan(&file, &["--format", "json"]);
        assert!(succeeded, "{name}: {said}");
        let found: serde_json::Value = serde_json::from_str(&said[said.find("{\n").unwrap()..]).unwrap();
        for input in found["inputs"].as_array().unwrap() {
            let [low, high] = [0, 1].map(|end| input["limits"][end].as_f64());
            let [least, most] = [0, 1].map(|end| input["range"][end].as_f64().unwrap());
            assert!(low.is_none_or(|low| least >= low - 1e-4), "{name}: {input}");
            assert!(high.is_none_or(|high| most <= high + 1e-4), "{name}: {input}");
        }
    }
}

/// Motors of a robot with a cylinder keep their torque–speed lines, and are named as motors where they cannot.
#[test]
fn motors_beside_a_cylinder_keep_their_lines() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wrist.toml");
    let line = |torque: f64| {
        WRIST.replace(
            "gear_ratio = 80",
            &format!("gear_ratio = 80, stall_torque = {torque}, no_load_speed = 500"),
        )
    };
    fs::write(&file, line(1e-3)).unwrap();
    let (_, succeeded, said) = plan(&file, &[]);
    let words = "holding the robot still at the middle of its position limits needs more effort than the plan may use, at motor left.";
    assert!(!succeeded && said.contains(words), "{said}");
    fs::write(&file, line(0.02)).unwrap();
    let (_, succeeded, said) = plan(&file, &["--format", "json"]);
    assert!(succeeded, "{said}");
    let found: serde_json::Value = serde_json::from_str(&said[said.find("{\n").unwrap()..]).unwrap();
    for input in found["inputs"].as_array().unwrap().iter().filter(|input| input["name"] != "cylinder") {
        let [least, most] = [0, 1].map(|end| input["range"][end].as_f64().unwrap());
        // A motor that brakes has twice its torque at rest at most.
        assert!(least.abs().max(most.abs()) <= 0.7 * 0.04, "{input}");
    }
}
