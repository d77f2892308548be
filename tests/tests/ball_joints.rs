//! A ball joint behind a hinge about the ball's own x axis, against values of Pinocchio (analytic derivatives, complex steps) and
//! MuJoCo.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use gelenk_codegen::functions::form::Form;
use gelenk_codegen::pipeline::GenerateOptions;
use gelenk_tests::{Robot, relative_error, workspace};
use serde_json::Value;

/// Functions with the keys of their arguments, and of their results in the values.
const FUNCTIONS: [(&str, &[&str], &[&str]); 8] = [
    ("mass_matrix", &["y"], &["mass_matrix"]),
    ("inverse_dynamics", &["y", "v", "a"], &["inverse_dynamics"]),
    ("forward_dynamics", &["y", "v", "u"], &["forward_dynamics_derivatives/a"]),
    (
        "inverse_dynamics_derivatives",
        &["y", "v", "a"],
        &[
            "inverse_dynamics_derivatives/b_u",
            "inverse_dynamics_derivatives/d_dy",
            "inverse_dynamics_derivatives/d_dv",
        ],
    ),
    (
        "forward_dynamics_derivatives",
        &["y", "v", "u"],
        &[
            "forward_dynamics_derivatives/a",
            "forward_dynamics_derivatives/d_dy",
            "forward_dynamics_derivatives/d_dv",
            "forward_dynamics_derivatives/M_inverse",
        ],
    ),
    ("frame_FRAME_pose", &["y"], &["frame_FRAME_pose/p", "frame_FRAME_pose/R"]),
    ("frame_FRAME_jacobian", &["y"], &["frame_FRAME_jacobian"]),
    ("frame_FRAME_jacobian_rate_times_velocity", &["y", "v"], &["frame_FRAME_jacobian_rate_times_velocity"]),
];

/// All numbers below a value, rows first; none where there is no value.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        other => other.as_f64().into_iter().collect(),
    }
}

fn robot(file: &str, form: Form) -> Robot {
    let path = workspace().join("tests/reference").join(file);
    Robot::derive(&path, &GenerateOptions { form, ..GenerateOptions::default() })
}

#[test]
fn balls_behind_parallel_hinges_agree_with_pinocchio() {
    let path = workspace().join("tests/reference/ball_joints.json");
    let text = std::fs::read_to_string(&path).expect("the values");
    let cases: Vec<Value> = serde_json::from_str(&text).expect("JSON");
    assert_eq!(cases.len(), 3);
    for form in [Form::Straight, Form::Arrays] {
        for case in &cases {
            let file = case["robot"].as_str().expect("a file");
            check(&robot(file, form), case);
        }
    }
}

fn check(robot: &Robot, case: &Value) {
    let frame = robot.model.frames[0].identifier.as_str();
    for (function, arguments, results) in FUNCTIONS {
        let function = function.replace("FRAME", frame);
        let arguments: Vec<Vec<f64>> = arguments.iter().map(|key| numbers(&case[*key])).collect();
        let arguments: Vec<&[f64]> = arguments.iter().map(Vec::as_slice).collect();
        let found = robot.call(&function, &arguments);
        assert_eq!(found.len(), results.len(), "{function}");
        for (found, key) in found.iter().zip(results) {
            let pointer = format!("/{}", key.replace("FRAME", frame));
            let expected = numbers(case.pointer(&pointer).expect("a value"));
            let error = relative_error(found, &expected);
            assert!(error <= 1e-12, "{} {key}: relative error {error:e}", robot.model.name);
        }
    }
}

/// The site of MuJoCo, whose values have six digits.
#[test]
fn a_ball_of_mujoco_is_where_mujoco_has_it() {
    let robot = robot("ball_behind_hinge.xml", Form::Straight);
    let turned = [0.5, 0.1, 0.2, 0.3, 0.927_361_849_549_570_3];
    for (y, expected) in
        [([0.5, 0.0, 0.0, 0.0, 1.0], [0.0, -0.623253, 1.140857]), (turned, [0.430945, -0.632768, 1.021710])]
    {
        let place = robot.first("frame_tip_pose", &[&y]);
        for (found, expected) in place.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{place:?}");
        }
    }
}
