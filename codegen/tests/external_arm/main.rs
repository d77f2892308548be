//! An arm that is not a model of the project, identified by the command line: with a load in its hand, in currents, and with
//! chosen terms of friction.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

mod doubts;
mod held;
mod offsets;
mod said;
mod tilted;
mod units;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::model::Model;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;
use serde_json::Value;

const ARM: &str = r#"
name = "arm"
gravity = [0, 0, -9.81]

[[joints]]
name = "turn"
axis = [0, 0, 1]
drive = { gear_ratio = 80, rotor_inertia = 6e-5, motor_constant = 0.05 }

[[joints]]
name = "lift"
axis = [0, 1, 0]
origin = { xyz = [0, 0, 0.3] }
drive = { gear_ratio = 100, rotor_inertia = 6e-5, motor_constant = 0.05 }

[[joints]]
name = "reach"
axis = [0, 1, 0]
origin = { xyz = [0.5, 0, 0] }
drive = { gear_ratio = 60, rotor_inertia = 3e-5, motor_constant = 0.05 }

[[bodies]]
link = "turn"
mass = 6
inertia = [0.03, 0.03, 0.03]

[[bodies]]
link = "lift"
mass = 5
center_of_mass = [0.25, 0, 0]
inertia = [0.02, 0.15, 0.15]

[[bodies]]
link = "reach"
mass = 2.5
center_of_mass = [0.2, 0, 0]
inertia = [0.01, 0.06, 0.06]
"#;

/// The load.
const LOADED: &str = r#"
extends = "arm.toml"

[[bodies]]
name = "bucket"
link = "reach"
mass = 1.3
center_of_mass = [0.4, 0.05, 0.02]
inertia = [0.004, 0.005, 0.006]
"#;

const GEARS: [f64; 3] = [80.0, 100.0, 60.0];
/// Viscous and Coulomb friction of each joint.
const FRICTION: [[f64; 2]; 3] = [[3.0, 4.0], [5.0, 6.0], [2.0, 3.0]];

/// How a log is recorded.
#[derive(Clone, Copy)]
struct Recorded {
    /// Constants of the motors where it holds currents.
    constants: Option<[f64; 3]>,
    /// Factors of times, positions and efforts, as another unit has them.
    factors: [f64; 3],
    /// How much later than positions efforts come [s].
    delay: f64,
    /// Friction of the first joint in addition to its viscous and Coulomb friction.
    turn: fn(f64) -> f64,
    /// Position of the last joint if it rests.
    resting: Option<f64>,
    /// Zero errors of the sensors of efforts.
    offsets: [f64; 3],
    /// Seed of the noise.
    seed: u64,
}

const RIGHT: Recorded = Recorded {
    constants: None,
    factors: [1.0; 3],
    delay: 0.0,
    turn: |_| 0.0,
    resting: None,
    offsets: [0.0; 3],
    seed: 7,
};

struct Arm(tempfile::TempDir);

impl Arm {
    fn new() -> Self {
        let arm = Self(tempfile::tempdir().unwrap());
        fs::write(arm.at("arm.toml"), ARM).unwrap();
        fs::write(arm.at("loaded.toml"), LOADED).unwrap();
        arm
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn model(&self, name: &str) -> Model {
        read::read(&self.at(name), &ReadOptions::default()).unwrap().model
    }

    /// A log of 20 s at 100 Hz with noise; `constants` are those of the motors where it holds currents.
    fn record(&self, description: &str, log: &str, constants: Option<[f64; 3]>) {
        self.record_as(description, log, Recorded { constants, ..RIGHT });
    }

    /// The same, recorded as somebody else would.
    fn record_as(&self, description: &str, log: &str, how: Recorded) {
        let Recorded { constants, factors, delay, turn, resting, offsets, seed } = how;
        let motion = |t: f64| {
            let [mut y, mut v, mut a] = motion(t);
            if let Some(position) = resting {
                (y[2], v[2], a[2]) = (position, 0.0, 0.0);
            }
            [y, v, a]
        };
        let robot = InterpretedRobot::new(&self.model(description)).unwrap();
        let kind = if constants.is_some() { "current" } else { "effort" };
        let mut text = "t,q_turn,q_lift,q_reach".to_owned();
        ["turn", "lift", "reach"].iter().for_each(|name| write!(text, ",{kind}_{name}").unwrap());
        text.push('\n');
        let mut noise = seed;
        let mut draw = || {
            noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (noise >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for i in 0..2000 {
            let t = 0.01 * f64::from(i);
            let [now, ..] = motion(t);
            let [y, v, a] = motion(t - delay);
            let mut forces = [0.0; 3];
            robot.rigid_forces(&y, &v, &a, &mut forces);
            let [q0, q1, q2] = now.map(|q| factors[1] * q);
            write!(text, "{},{q0},{q1},{q2}", factors[0] * t).unwrap();
            for joint in 0..3 {
                let friction = FRICTION[joint][0] * v[joint] + FRICTION[joint][1] * (50.0 * v[joint]).tanh();
                let friction = if joint == 0 { friction + turn(v[0]) } else { friction };
                let effort = forces[joint] + friction + offsets[joint] + 0.2 * draw();
                let unit = constants.map_or(1.0, |constants| GEARS[joint] * constants[joint]);
                write!(text, ",{}", factors[2] * effort / unit).unwrap();
            }
            text.push('\n');
        }
        fs::write(self.at(log), text).unwrap();
    }

    /// Error message of a command that fails.
    fn refuses(&self, arguments: &[&str]) -> String {
        let done = self.run(arguments);
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(!done.status.success(), "{said}{}", String::from_utf8_lossy(&done.stdout));
        assert!(!self.at("refused.toml").exists());
        said
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
        command.arg("identify").args(arguments).current_dir(self.0.path()).output().unwrap()
    }

    /// JSON output of the command.
    fn identify(&self, arguments: &[&str]) -> Value {
        let done = self.run(&[&["arm.toml", "--format", "json"], arguments].concat());
        let said = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{said}");
        serde_json::from_slice(&done.stdout).unwrap()
    }
}

fn motion(t: f64) -> [[f64; 3]; 3] {
    let waves = [[0.9, 1.1, 0.3, 3.1], [0.7, 1.4, 0.25, 3.7], [0.9, 1.9, 0.3, 4.9]];
    let at = |shape: &dyn Fn(f64, f64) -> f64| {
        std::array::from_fn(|k| {
            let [a, w, b, x] = waves[k];
            a * shape(w, w * t + k as f64) + b * shape(x, x * t)
        })
    };
    [at(&|_, x| x.sin()), at(&|w, x| w * x.cos()), at(&|w, x| -w * w * x.sin())]
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Mass and first moments of a link, all of its bodies together.
fn moments(model: &Model, link: &str) -> [f64; 4] {
    let robot = InterpretedRobot::new(model).unwrap();
    let place = robot.parameter_names().iter().position(|name| *name == format!("m_{link}")).unwrap();
    std::array::from_fn(|k| robot.parameters()[place + k])
}

#[test]
fn a_load_is_found_from_logs_without_and_with_it() {
    let arm = Arm::new();
    arm.record("arm.toml", "without.csv", None);
    arm.record("loaded.toml", "with.csv", None);
    let found = arm.identify(&["without.csv", "--payload", "with.csv", "--output", "found.toml"]);
    assert_eq!(found["link"], "reach");
    assert!((number(&found["mass"]["value"]) / 1.3 - 1.0).abs() < 0.02, "{}", found["mass"]);
    let centre = &found["center_of_mass"];
    for (k, truth) in [0.4, 0.05, 0.02].into_iter().enumerate() {
        assert!((number(&centre[k]["value"]) - truth).abs() < 0.02, "{centre}");
    }
    // The description that is written carries it.
    let [written, truth] = ["found.toml", "loaded.toml"].map(|name| moments(&arm.model(name), "reach"));
    for (written, truth) in written.iter().zip(truth) {
        assert!((written - truth).abs() < 0.03, "{written} {truth}");
    }
    assert!(fs::read_to_string(arm.at("found.toml")).unwrap().contains("name = \"payload\""));
    // Once more next to it: no body is replaced.
    let again = ["found.toml", "without.csv", "--payload", "with.csv", "--output", "again.toml"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    let done = command.arg("identify").args(again).current_dir(arm.0.path()).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(fs::read_to_string(arm.at("again.toml")).unwrap().contains("name = \"payload_2\""));
}

#[test]
fn a_link_that_carries_no_load_is_refused() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    let refused = |path: &Path| {
        let options = ["identify", "arm.toml", "log.csv", "--payload", "log.csv", "--payload-on", "hand"];
        let done =
            Command::new(env!("CARGO_BIN_EXE_gelenk")).args(options).current_dir(path).output().unwrap();
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    };
    let (code, said) = refused(arm.0.path());
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("moving links are `turn`, `lift`, `reach`"), "{said}");
}

/// The description's constants are 0.05 throughout.
#[test]
fn described_motor_constants_stay() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", Some([0.05; 3]));
    let found = arm.identify(&["log.csv", "--output", "found.toml"]);
    let [described, written] = ["arm.toml", "found.toml"]
        .map(|name| InterpretedRobot::new(&arm.model(name)).unwrap().input_matrix());
    assert_eq!(described, written);
    for (joint, [viscous, _]) in FRICTION.into_iter().enumerate() {
        let joint = &found["joints"][joint];
        assert!(joint["motor_constant"].is_null());
        let terms = joint["friction_terms"].as_array().unwrap();
        // The friction is tanh(50 v), which the Stribeck law has and the terms have not.
        let of_speed = terms.iter().find(|term| term["term"] == "v" || term["term"] == "a1").unwrap();
        assert!((number(&of_speed["coefficient"]) / viscous - 1.0).abs() < 0.05, "{joint}");
    }
}

#[test]
fn motor_constants_that_are_not_described_are_found() {
    let truth = [0.06, 0.04, 0.055];
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", Some(truth));
    fs::write(arm.at("arm.toml"), ARM.replace(", motor_constant = 0.05", "")).unwrap();
    let found = arm.identify(&["log.csv", "--output", "found.toml"]);
    let written = InterpretedRobot::new(&arm.model("found.toml")).unwrap().input_matrix();
    for (joint, truth) in truth.into_iter().enumerate() {
        let constant = &found["joints"][joint]["motor_constant"];
        let [low, high] = [0, 1].map(|end| number(&constant["interval"][end]));
        assert!((number(&constant["value"]) / truth - 1.0).abs() < 0.1, "{joint}: {constant}");
        assert!(low < truth && truth < high && high < 2.0 * low, "{joint}: {constant}");
        assert!((written[4 * joint] / GEARS[joint] - number(&constant["value"])).abs() < 1e-6, "{written:?}");
    }
}

#[test]
fn friction_is_chosen_from_the_terms_that_are_named() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    for (terms, allowed) in [("viscous,tanh(50*v)", &["*v", "*tanh(50*v)"][..]), ("viscous", &["*v"])] {
        let found = arm.identify(&["log.csv", "--friction", terms, "--output", "found.toml"]);
        for joint in 0..3 {
            let law = found["joints"][joint]["friction"].as_str().unwrap();
            let terms: Vec<&str> = law.split(" + ").collect();
            assert_eq!(terms.len(), allowed.len(), "{law}");
            assert!(terms.iter().zip(allowed).all(|(term, end)| term.ends_with(end)), "{law}");
        }
    }
}

/// The friction is that of terms of the library; each method says its name in the file.
#[test]
fn terms_are_chosen_by_the_method_that_is_named() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    let methods = [
        ("subset", "the best subset of terms was chosen by "),
        ("stls", "sequentially thresholded least squares (threshold 0.1, "),
        ("lasso", "LASSO chose the terms by cross-validation with "),
        ("all", "least squares fitted all terms"),
    ];
    for (method, words) in methods {
        let found = arm.identify(&["log.csv", "--method", method, "--output", "found.toml"]);
        let file = fs::read_to_string(arm.at("found.toml")).unwrap();
        assert!(file.contains(words) && file.contains(&format!("--method {method}")), "{method}: {file}");
        let viscous = found["joints"][0]["friction"].as_str().unwrap();
        assert!(viscous.contains("*v"), "{method}: {viscous}");
        let front = found["joints"][0]["friction_pareto"].as_array().map(Vec::as_slice).unwrap_or_default();
        let chosen: Vec<usize> = (0..front.len()).filter(|&i| front[i]["chosen"] == true).collect();
        assert_eq!(chosen.len(), usize::from(method != "all"), "{method}: {front:?}");
        // The best set of each size, or those of a falling threshold or penalty: more terms come with each row.
        let sizes = front.iter().map(|row| row["terms"].as_array().unwrap().len());
        assert!(sizes.is_sorted() && (method == "all" || front.len() > 2), "{method}: {front:?}");
    }
    let stls = ["arm.toml", "log.csv", "--method", "stls", "--threshold", "0.5", "--output", "found.toml"];
    let table = String::from_utf8(arm.run(&stls).stdout).unwrap();
    assert!(table.contains("rms error on held-out data") && table.contains("  *  v"), "{table}");
    assert!(
        fs::read_to_string(arm.at("found.toml")).unwrap().contains("--threshold 0.5"),
        "the command is in the file"
    );
    let refused = arm.refuses(&["arm.toml", "log.csv", "--method", "lasso", "--threshold", "0.5"]);
    assert!(refused.contains("only --method stls has a threshold"), "{refused}");
    let refused = arm.refuses(&["arm.toml", "log.csv", "--friction", "stribeck", "--method", "lasso"]);
    assert!(refused.contains("no method chooses them"), "{refused}");
}

/// TVDiff instead of the filter's derivatives alone: the same law within a few percent, and the command says so.
#[test]
fn positions_are_differentiated_by_total_variation_on_request() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    let [filter, tvdiff] = ["filter", "tvdiff"]
        .map(|name| arm.identify(&["log.csv", "--derivative", name, "--output", &format!("{name}.toml")]));
    for joint in 0..3 {
        let r_squared = |found: &Value| found["joints"][joint]["r_squared_held_out"].as_f64().unwrap();
        assert!(
            r_squared(&tvdiff) > r_squared(&filter) - 2e-3,
            "{} {}",
            r_squared(&filter),
            r_squared(&tvdiff)
        );
    }
    assert_ne!(filter["inertial_parameters"], tvdiff["inertial_parameters"]);
    assert!(fs::read_to_string(arm.at("tvdiff.toml")).unwrap().contains("--derivative tvdiff"));
    assert!(!fs::read_to_string(arm.at("filter.toml")).unwrap().contains("--derivative"));
}

/// The first joint has Stribeck's friction, the others viscous and Coulomb friction alone.
#[test]
fn stribeck_friction_is_taken_where_the_data_show_it() {
    let arm = Arm::new();
    let stribeck = |v: f64| 5.0 * (-v.abs() / 0.15).exp() * (150.0 * v).tanh();
    arm.record_as("arm.toml", "log.csv", Recorded { turn: stribeck, ..RIGHT });
    // It is chosen, and asked for.
    let found = arm.identify(&["log.csv", "--output", "found.toml"]);
    assert!(found["joints"][0]["friction"].as_str().unwrap().contains("exp("), "{}", found["joints"][0]);
    let found = arm.identify(&["log.csv", "--friction", "stribeck", "--output", "found.toml"]);
    assert!(found["joints"][0]["friction"].as_str().unwrap().contains("exp("), "{}", found["joints"][0]);
    let warnings = found["warnings"].as_array().unwrap();
    for (joint, name) in [(1, "lift"), (2, "reach")] {
        assert!(!found["joints"][joint]["friction"].to_string().contains("exp("), "{found:#}");
        let refusal = format!("joint {name}: no friction law is written: ");
        let said = warnings.iter().filter_map(Value::as_str).find(|words| words.contains(&refusal));
        assert!(said.unwrap().contains("the data show no Stribeck law"), "{warnings:?}");
    }
}

/// Drives that report torques ahead of positions are as usual as those that report them late.
#[test]
fn efforts_that_come_early_are_moved() {
    let arm = Arm::new();
    for delay in [-0.05, 0.05] {
        arm.record_as("arm.toml", "log.csv", Recorded { delay, ..RIGHT });
        let found = arm.identify(&["log.csv", "--output", "found.toml"]);
        for joint in found["joints"].as_array().unwrap() {
            assert!(number(&joint["r_squared_held_out"]) > 0.998, "{delay}: {joint:#}");
        }
    }
    arm.record_as("arm.toml", "log.csv", Recorded { delay: -0.05, ..RIGHT });
    let done = arm.run(&["arm.toml", "log.csv", "--output", "found.toml"]);
    assert!(
        String::from_utf8(done.stdout).unwrap().contains("ms before the positions. This delay is removed")
    );
    // If it is stated wrong, the remedy is named.
    let said = arm.identify(&["log.csv", "--delay", "0", "--output", "found.toml"]);
    let findings = said["findings"].as_array().unwrap();
    let late = findings.iter().find(|finding| finding["code"] == "other-delay").unwrap();
    assert!(late["help"].as_str().unwrap().contains("give the whole delay with --delay SECONDS"), "{late:#}");
    let seconds = number(&late["values"][0]["value"]);
    // To first order: inertia and friction take up a part of it.
    assert!((-0.05..-0.02).contains(&seconds), "{late:#}");
}
