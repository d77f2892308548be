//! Friction that jumps: exact in the value, derivative zero; and smooth where that is asked for.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::path::PathBuf;

use gelenk_codegen::pipeline::GenerateOptions;
use gelenk_codegen::read::ReadOptions;
use gelenk_tests::Robot;

const DESCRIPTION: &str = r#"
gravity = [0, 0, 0]

[[joints]]
name = "slide"
type = "prismatic"
drive = "ideal"
friction = { viscous = 3, coulomb = 2 }

[[joints]]
name = "turn"
drive = "ideal"
friction = { coulomb = { positive = 0.5, negative = -0.3 } }
spring = "-0.7*sign(v)"

[[bodies]]
link = "slide"
mass = 4

[[bodies]]
link = "turn"
mass = 1
inertia = 0.5
"#;

const COULOMB: f64 = 2.0;
const VISCOUS: f64 = 3.0;

fn robot(generate: &str, smooth_sign: Option<f64>) -> Robot {
    let folder = tempfile::tempdir().expect("a folder");
    let path: PathBuf = folder.path().join("robot.toml");
    std::fs::write(&path, format!("{DESCRIPTION}{generate}")).expect("a file");
    let options = GenerateOptions {
        reading: ReadOptions { smooth_sign, ..ReadOptions::default() },
        ..GenerateOptions::default()
    };
    Robot::derive(&path, &options)
}

#[test]
fn sign_is_exact_and_its_derivative_zero() {
    let robot = robot("", None);
    for (rate, torques) in [(0.1, [2.3, 0.5]), (0.0, [0.0, 0.0]), (-0.1, [-2.3, -0.3])] {
        let v = [rate, rate];
        let found = robot.first("friction_torques", &[&v]);
        for (found, expected) in found.iter().zip(torques) {
            assert!((found - expected).abs() < 1e-14, "{rate}: {found}");
        }
        let zero = [0.0, 0.0];
        let inverse = robot.call("inverse_dynamics_derivatives", &[&zero, &v, &zero]);
        // Nothing else depends on these velocities.
        assert_eq!(inverse[2], [VISCOUS, 0.0, 0.0, 0.0]);
        let linear = robot.call("linearize", &[&zero, &v, &zero]);
        assert!((linear[1][0] + VISCOUS / 5.0).abs() < 1e-14);
        assert_eq!(linear[1][1..], [0.0, 0.0, 0.0]);
        // The affine remainder carries the value: at u = 0 the braked accelerations.
        let springs = robot.first("spring_forces", &[&zero, &v]);
        let accelerations = robot.first("forward_dynamics", &[&zero, &v, &zero]);
        assert!((accelerations[0] + torques[0] / 5.0).abs() < 1e-14);
        assert!((accelerations[1] - (springs[1] - torques[1]) / 0.5).abs() < 1e-14);
        assert!((linear[3][0] - (accelerations[0] + VISCOUS / 5.0 * rate)).abs() < 1e-14);
    }
    let notes = &robot.function("linearize").notes;
    assert!(notes.iter().any(|note| note.contains("derivative is set to zero")));
}

#[test]
fn smooth_sign_is_a_tanh_with_its_derivative() {
    let slope: f64 = 40.0;
    let by_option = robot("", Some(slope));
    let by_description = robot("[generate]\nsmooth_sign = 40\n", None);
    let overridden = robot("[generate]\nsmooth_sign = 7\n", Some(slope));
    let zero = [0.0, 0.0];
    for robot in [by_option, by_description, overridden] {
        for rate in [0.03, 0.0, -0.01, -2.0] {
            let v = [rate, rate];
            let smooth = (slope * rate).tanh();
            let edge = slope * (1.0 - smooth * smooth);
            let friction = robot.first("friction_torques", &[&v]);
            let springs = robot.first("spring_forces", &[&zero, &v]);
            let slopes = robot.call("inverse_dynamics_derivatives", &[&zero, &v, &zero]).swap_remove(2);
            let close = |found: f64, expected: f64| {
                assert!((found - expected).abs() < 1e-13, "at {rate}: {found}, {expected}");
            };
            close(friction[0], VISCOUS * rate + COULOMB * smooth);
            // The mean of both sides times the odd part, and half their difference times the even one.
            close(friction[1], 0.4 * smooth + 0.1 * smooth * smooth);
            close(springs[1], -0.7 * smooth);
            close(slopes[0], VISCOUS + COULOMB * edge);
            close(slopes[3], (0.4 + 0.2 * smooth + 0.7) * edge);
        }
        let notes = &robot.function("linearize").notes;
        assert!(!notes.iter().any(|note| note.contains("derivative is set to zero")));
    }
}

/// The law of a gear whose teeth mesh more or less tightly.
fn toothed(rate_of: &str) -> Robot {
    let folder = tempfile::tempdir().expect("a folder");
    let path: PathBuf = folder.path().join("robot.toml");
    let description = format!(
        "gravity = [0, 0, 0]\n[[joints]]\nname = \"gear\"\nlimits = {{ position = [-1, 2] }}\nfriction = {rate_of}\n\
         [[joints]]\nname = \"slide\"\ntype = \"prismatic\"\nfriction = \"2*v\"\n\
         [[bodies]]\nlink = \"gear\"\ninertia = 0.5\nmass = 0\n[[bodies]]\nlink = \"slide\"\nmass = 3\n"
    );
    std::fs::write(&path, description).expect("a file");
    Robot::derive(&path, &GenerateOptions::default())
}

/// A law of the position was once generated as that at y = 0.
#[test]
fn friction_depends_on_the_position_where_its_law_does() {
    let robot = toothed("\"0.3*(1+0.9*sin(y))*tanh(20*v)\"");
    let slide = |v: f64| 2.0 * v;
    for (y, v) in [(0.0_f64, 0.1_f64), (1.3, 0.02), (-0.8, -0.4), (1.9, 3.0)] {
        let (positions, velocities, still) = ([y, 0.7], [v, -0.5], [0.0; 2]);
        let (tight, smooth) = (0.3 * (1.0 + 0.9 * y.sin()), (20.0 * v).tanh());
        let (by_y, by_v) = (0.27 * y.cos() * smooth, 20.0 * tight * (1.0 - smooth * smooth));
        let close = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-14, "({y}, {v}): {found}, {expected}");
        };
        let friction = robot.first("friction_torques", &[&positions, &velocities]);
        close(friction[0], tight * smooth);
        close(friction[1], slide(-0.5));
        let regressor = robot.first("friction_regressor", &[&positions, &velocities]);
        let parameters = robot.first("friction_parameters", &[]);
        assert_eq!(parameters, [0.3, 2.0]);
        close(regressor[0] * parameters[0], friction[0]);
        close(regressor[3] * parameters[1], friction[1]);
        let inverse = robot.call("inverse_dynamics_derivatives", &[&positions, &velocities, &still]);
        let forces = robot.first("inverse_dynamics", &[&positions, &velocities, &still]);
        let bias = robot.first("bias_forces", &[&positions, &velocities]);
        close(forces[0] - bias[0], friction[0]);
        close(inverse[1][0], by_y);
        close(inverse[2][0], by_v);
    }
}

#[test]
fn friction_of_the_velocity_alone_takes_the_velocity_alone() {
    let robot = toothed("\"0.3*tanh(20*v)\"");
    for name in ["friction_torques", "friction_regressor"] {
        let inputs = &robot.function(name).program.inputs;
        assert_eq!(inputs.len(), 1, "{name}");
        assert_eq!(inputs[0].name, "v", "{name}");
    }
}

/// Pairs i, j for which friction at i changes by more than a slope makes of it where velocity j changes its sign.
fn measured_jumps(robot: &Robot) -> Vec<[usize; 2]> {
    let n = robot.model.coordinates.len();
    let friction = |j: usize, speed: f64| {
        let v: Vec<f64> = (0..n).map(|k| if k == j { speed } else { 0.0 }).collect();
        let y = vec![0.3; n];
        robot.first("friction_torques", &robot.friction_arguments("friction_torques", &y, &v))
    };
    let jumps = |j: usize| {
        let (before, after) = (friction(j, -1e-12), friction(j, 1e-12));
        (0..n).filter(move |&i| (after[i] - before[i]).abs() > 1e-6)
    };
    let mut pairs: Vec<[usize; 2]> = (0..n).flat_map(|j| jumps(j).map(move |i| [i, j])).collect();
    pairs.sort_unstable();
    pairs
}

/// A wrist whose two drives share two joints, and a joint that follows the third.
fn coupled(first: &str, shaft: &str, follower: &str) -> Robot {
    let joint = |name: &str, parent: &str, lines: &str| {
        format!(
            "[[joints]]\nname = \"{name}\"\n{parent}axis = [0, 1, 0]\norigin = {{ xyz = [0.1, 0, 0] }}\n{lines}\n"
        )
    };
    let drive = |name: &str, sign: i32, lines: &str| {
        let acts = format!("on = {{ pitch = 1, roll = {sign} }}\ncarrier = \"waist\"\naxis = [0, 0, 1]");
        format!("[[drives]]\nname = \"{name}\"\n{acts}\ngear_ratio = 10\nrotor_inertia = 1e-4\n{lines}\n")
    };
    let text = [
        joint("waist", "", &format!("drive = \"ideal\"\n{first}")),
        joint("pitch", "parent = \"waist\"\n", ""),
        joint("roll", "parent = \"pitch\"\n", ""),
        joint("finger", "parent = \"roll\"\n", &format!("follows = {{ waist = -2 }}\n{follower}")),
        drive("left", 1, shaft),
        drive("right", -1, ""),
        ["waist", "pitch", "roll", "finger"]
            .map(|link| format!("[[bodies]]\nlink = \"{link}\"\nmass = 1\ninertia = 0.1\n"))
            .concat(),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("coupled.toml");
    std::fs::write(&path, text.concat()).expect("a file");
    Robot::derive(&path, &GenerateOptions::default())
}

#[test]
fn jumps_are_known_from_the_laws() {
    let shared = vec![[1, 1], [1, 2], [2, 1], [2, 2]];
    let cases = [
        ("friction = { coulomb = 2 }", "", "", vec![[0, 0]]),
        ("", "", "friction = { coulomb = 2 }", vec![[0, 0]]),
        ("", "friction = { coulomb = 0.1, viscous = 1 }", "", shared),
        ("friction = { coulomb = { value = 2, slope = 100 } }", "friction = { viscous = 0.1 }", "", vec![]),
        ("friction = { terms = [[\"sign(v)*pow(v, 2)\", 3], [\"abs(v)*sign(v)\", 1]] }", "", "", vec![]),
        ("friction = { terms = [[\"sign(2*v)*exp(-abs(v))\", 3]] }", "", "", vec![[0, 0]]),
        ("friction = { terms = [[\"sign(v)*(2+cos(y))\", 3]] }", "", "", vec![[0, 0]]),
        ("friction = { coulomb = { positive = 0.5, negative = -0.3 } }", "", "", vec![[0, 0]]),
    ];
    for (first, shaft, follower, expected) in cases {
        let robot = coupled(first, shaft, follower);
        assert_eq!(robot.model.friction_jumps(), expected, "{first}{shaft}{follower}");
        assert_eq!(measured_jumps(&robot), expected, "{first}{shaft}{follower}");
    }
}

#[test]
fn a_jump_whose_height_is_a_free_parameter_is_one_whatever_its_value() {
    let robot = coupled("friction = { coulomb = { free = 0, name = \"level\" } }", "", "");
    assert_eq!(robot.model.friction_jumps(), [[0, 0]]);
}
