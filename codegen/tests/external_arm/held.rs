//! Logs that leave out a joint at rest, and the line of columns that is printed.

use super::{Arm, RIGHT, Recorded, number};
use gelenk_codegen::identify::InterpretedRobot;
use gelenk_identification::robot::Robot;
use std::fs;

const POSITION: f64 = 0.4;

/// A log in which `reach` rests, and the same log without its columns.
fn arm(constants: Option<[f64; 3]>) -> Arm {
    let arm = Arm::new();
    arm.record_as("arm.toml", "full.csv", Recorded { resting: Some(POSITION), constants, ..RIGHT });
    let text = fs::read_to_string(arm.at("full.csv")).unwrap();
    let keep = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        [0, 1, 2, 4, 5].map(|column| fields[column]).join(",") + "\n"
    };
    fs::write(arm.at("less.csv"), text.lines().map(keep).collect::<String>()).unwrap();
    arm
}

#[test]
fn a_joint_that_is_held_leaves_the_laws_of_the_others() {
    for (constants, effort) in [(None, "joint"), (Some([0.05; 3]), "current")] {
        let arm = arm(constants);
        let full = arm.identify(&["full.csv", "--effort", effort, "--output", "full.toml"]);
        let held = ["less.csv", "--effort", effort, "--hold", "rea*=0.4", "--output", "held.toml"];
        let held = arm.identify(&held);
        for joint in 0..2 {
            let [full, held] = [&full, &held].map(|found| &found["joints"][joint]);
            assert!(held["friction"].as_str().unwrap().contains("tanh("), "{held:#}");
            let [a, b] = [full, held].map(|joint| number(&joint["r_squared_held_out"]));
            assert!((a - b).abs() < 2e-3, "{a} {b}");
            let coefficients = |law: &serde_json::Value| -> Vec<f64> {
                let terms = law["friction"].as_str().unwrap().split(" + ");
                terms.map(|term| term.split('*').next().unwrap().parse().unwrap()).collect()
            };
            let (full, held) = (coefficients(full), coefficients(held));
            assert_eq!(full.len(), held.len());
            for (full, held) in full.iter().zip(&held) {
                assert!((held / full - 1.0).abs() < 0.03, "{effort}: {held} {full}");
            }
        }
        assert_eq!(held["joints"][2]["friction"], "–", "{:#}", held["joints"][2]);
        // Whoever holds a joint knows that it has no effort.
        let warnings = held["warnings"].to_string();
        assert!(!warnings.contains("joint reach"), "{warnings}");
        // The description keeps the joint and its drive.
        let written = arm.model("held.toml");
        let [described, found] =
            [&arm.model("arm.toml"), &written].map(|model| InterpretedRobot::new(model).unwrap());
        assert_eq!(found.joint_names(), ["turn", "lift", "reach"]);
        assert_eq!(found.input_matrix()[8], described.input_matrix()[8]);
        let text = fs::read_to_string(arm.at("held.toml")).unwrap();
        assert!(text.contains("hold=rea*=0.4"), "{text}");
        let reach = text.split("[[joints]]").find(|table| table.contains("name = \"reach\"")).unwrap();
        assert!(reach.contains("gear_ratio = 60.0, rotor_inertia = 3e-5"), "{reach}");
        assert!(!reach.contains("friction"), "{reach}");
    }
}

#[test]
fn joints_that_cannot_be_held_are_refused() {
    let arm = arm(None);
    let said = arm.refuses(&["arm.toml", "less.csv", "--output", "refused.toml"]);
    assert!(
        said.contains("the log has no column for the position of `reach`") && said.contains("--hold reach=0"),
        "{said}"
    );
    let said = arm.refuses(&["arm.toml", "less.csv", "--hold", "hand", "--output", "refused.toml"]);
    assert!(
        said.contains(
            "--hold `hand`: no joint matches this name or pattern. The joints are turn, lift, reach"
        ),
        "{said}"
    );
    let said = arm.refuses(&["arm.toml", "full.csv", "--hold", "reach", "--output", "refused.toml"]);
    assert!(
        said.contains("joint `reach` is held by an option, but the log has its column `q_reach`"),
        "{said}"
    );
}

/// The line that is printed can be given back.
#[test]
fn columns_are_printed_as_a_line() {
    let arm = arm(None);
    let asked = |more: &[&str]| {
        let done = arm.run(&[&["arm.toml", "less.csv", "--columns", "?"], more].concat());
        (done.status.code(), String::from_utf8(done.stdout).unwrap(), String::from_utf8(done.stderr).unwrap())
    };
    let (code, line, _) = asked(&["--hold", "reach=0.4"]);
    assert_eq!(code, Some(0), "{line}");
    let expected = "time=t,position=q_{name}[rad],torque=effort_{name}[Nm],hold=reach=0.4";
    assert_eq!(line, format!("--columns '{expected}'\n"));
    let found = arm.identify(&["less.csv", "--columns", expected, "--output", "found.toml"]);
    let same = arm.identify(&["less.csv", "--hold", "reach=0.4", "--output", "same.toml"]);
    assert_eq!(found["joints"], same["joints"]);
    let (code, line, said) = asked(&[]);
    assert_eq!(code, Some(1), "{line}");
    assert!(line.starts_with("--columns 'time=t,position=?,torque=?'\n    1  t\n    2  q_turn\n"), "{line}");
    assert!(said.contains("the log has no column for the position of `reach`"), "{said}");
}
