//! Friction on the shafts of motors that move two joints.

use std::fs;

use gelenk_codegen::model::Model;

use super::described::{Described, Wrist, differences, motion, sines};

/// True parameters of the arm of `models/`, with friction on its motors' shafts; friction of the bearings is
/// as described.
const TRUTH: &str = r#"
name = "truth"
extends = "arm.toml"

[[joints]]
name = "elbow"
friction = { viscous = 5, coulomb = { value = 3, slope = 50 } }

[[drives]]
name = "left_motor"
on = { wrist_pitch = 1, wrist_roll = 1 }
gear_ratio = 80
rotor_inertia = 1e-5
carrier = "elbow"
axis = [0, 0, 1]
friction = { terms = [["v", 6e-5], ["abs(v)", 1.5e-5], ["tanh(0.25*v)", 0.012]] }

[[drives]]
name = "right_motor"
on = { wrist_pitch = 1, wrist_roll = -1 }
gear_ratio = 80
rotor_inertia = 1e-5
carrier = "elbow"
axis = [0, 0, 1]
friction = { viscous = 4e-5, coulomb = { value = 0.018, slope = 0.25 } }

[[bodies]]
name = "wrist_roll"
mass = 1.4
center_of_mass = [0.02, 0.01, 0.1]
inertia = [0.004, 0.003, 0.002]
"#;

/// Drives of the wrist.
const MOTORS: [&str; 2] = ["left_motor", "right_motor"];

/// A motion that is not in the log.
fn other_motion(t: f64) -> [Vec<f64>; 3] {
    sines([[0.6, 0.9, 0.3, 2.7], [0.7, 1.9, 0.2, 4.3], [0.8, 1.7, 0.4, 4.9], [0.9, 1.6, 0.3, 5.9]], t)
}

/// Rms of the differences between the motors' torques of two robots along a motion that is not in the log.
fn errors(found: &Described, truth: &Described) -> Vec<f64> {
    let mut sums = vec![0.0; 4];
    for step in 0..2000 {
        let moved = other_motion(0.01 * f64::from(step));
        for ((sum, a), b) in sums.iter_mut().zip(found.inputs(&moved)).zip(truth.inputs(&moved)) {
            *sum += (a - b).powi(2) / 2000.0;
        }
    }
    sums.into_iter().map(f64::sqrt).collect()
}

fn has_friction(model: &Model, drive: &str) -> bool {
    model.drives.iter().any(|described| described.name == drive && !described.friction.is_empty())
}

#[test]
fn friction_on_the_shafts_of_a_differential_is_found() {
    let wrist = Wrist::new(TRUTH);
    let text = wrist.identify("found.toml", &["--report", "page"]);
    println!("{text}");
    assert!(text.contains("joint or shaft") && text.contains("\n  left_motor "), "{text}");
    assert!(
        text.contains(
            "note[friction-of-joint]: joint wrist_pitch: the factor 0.2 of its friction term v becomes 0.20"
        ),
        "{text}"
    );
    let [arm, truth, found] = ["arm.toml", "truth.toml", "found.toml"].map(|name| wrist.robot(name));
    let [before, after] = [&arm, &found].map(|robot| differences(robot, &truth));
    println!("forces are off by {before:?}, identified by {after:?}");
    // The slope of the Coulomb terms is one of the library's: near standstill the law is another one.
    for (joint, (before, after)) in before.iter().zip(&after).enumerate() {
        assert!(*after < 0.05 * before, "joint {joint}: {after} of {before}");
    }
    for name in MOTORS {
        for v in [-250.0, -60.0, 60.0, 250.0] {
            let [true_, found] = [&truth, &found].map(|robot| robot.shaft_friction(name, v));
            println!("{name} at {v}: true {true_}, found {found}");
            assert!((found - true_).abs() < 0.05 * true_.abs(), "{name} at {v}: {found} for {true_}");
        }
    }
    let page = fs::read_to_string(wrist.at("page/index.html")).unwrap();
    assert!(page.contains("left_motor") && page.contains("joint or shaft"));
}

#[test]
fn laws_of_joints_predict_such_a_wrist_worse() {
    let wrist = Wrist::new(TRUTH);
    wrist.identify("shafts.toml", &[]);
    let text = wrist.identify("joints.toml", &["--friction-on", "joints"]);
    assert!(!text.contains("left_motor ") && text.contains("wrist_pitch"), "{text}");
    let [truth, shafts, joints] = ["truth.toml", "shafts.toml", "joints.toml"].map(|name| wrist.robot(name));
    assert!(has_friction(&shafts.1, "left_motor") && !has_friction(&joints.1, "left_motor"));
    let [shafts, joints] = [shafts, joints].map(|robot| errors(&robot, &truth));
    println!("torques of a new motion are off by {shafts:?}, with friction on joints by {joints:?}");
    for motor in 2..4 {
        assert!(shafts[motor] < 0.2 * joints[motor], "{shafts:?} {joints:?}");
    }
}

#[test]
fn a_shaft_that_never_turns_is_named_and_stays_as_described() {
    // The hand pitches as it rolls back: the left motor stands still.
    let wrist = Wrist::moved("differential_wrist", TRUTH, |t| {
        let mut moved = motion(t);
        moved.iter_mut().for_each(|entries| entries[3] = -entries[2]);
        moved
    });
    let text = wrist.identify("found.toml", &["--accept-poor"]);
    println!("{text}");
    assert!(text.contains("warning[does-not-move]: the shaft of left_motor: "), "{text}");
    let found = wrist.robot("found.toml");
    assert!(!has_friction(&found.1, "left_motor") && has_friction(&found.1, "right_motor"));
}

/// True parameters of the arm of six joints: friction of joint 5 is that of its own motor, and motor 6 brakes
/// both joints.
const COUPLED_WRIST: &str = r#"
name = "truth"
extends = "arm.toml"

[[joints]]
name = "joint_5"
friction = { viscous = 2.4, coulomb = { value = 3.6, slope = 40 } }

[[drives]]
name = "motor_6"
on = { joint_5 = 1, joint_6 = 1 }
gear_ratio = 32
rotor_inertia = 1e-5
coupling = "diagonal"
friction = { viscous = 4e-4, coulomb = { value = 0.014, slope = 2 } }
"#;

#[test]
fn a_motor_that_turns_with_a_driven_joint_has_its_own_friction() {
    let wrist = Wrist::moved("tx40_like", COUPLED_WRIST, |t| {
        let slow = [[0.8, 1.1, 0.3, 3.1], [0.5, 1.2, 0.2, 3.9], [0.6, 1.9, 0.2, 5.3]];
        let fast = [[0.9, 1.6, 0.4, 4.7], [0.8, 2.1, 0.3, 5.9], [1.1, 1.4, 0.4, 6.7]];
        sines([slow[0], slow[1], slow[2], fast[0], fast[1], fast[2]], t)
    });
    let text = wrist.identify("found.toml", &[]);
    println!("{text}");
    assert!(
        text.contains("\n  motor_6 ") && text.contains("\n  joint_5 ") && !text.contains("\n  joint_6 "),
        "{text}"
    );
    let [truth, found] = ["truth.toml", "found.toml"].map(|name| wrist.robot(name));
    for v in [-2.0, -0.7, 0.7, 2.0] {
        let [true_, found] = [&truth, &found].map(|robot| robot.joint_friction("joint_5", v));
        assert!((found - true_).abs() < 0.05 * true_.abs(), "joint_5 at {v}: {found} for {true_}");
    }
    for v in [-150.0, -30.0, 30.0, 150.0] {
        let [true_, found] = [&truth, &found].map(|robot| robot.shaft_friction("motor_6", v));
        println!("motor_6 at {v}: true {true_}, found {found}");
        assert!((found - true_).abs() < 0.05 * true_.abs(), "motor_6 at {v}: {found} for {true_}");
    }
}

#[test]
fn a_drive_by_itself_on_one_joint_is_written_where_it_stands() {
    let truth = r#"
        name = "truth"
        extends = "arm.toml"
        [[joints]]
        name = "wrist_roll"
        friction = { viscous = 0.4 }
    "#;
    let wrist = Wrist::new(truth);
    let arm = fs::read_to_string(wrist.at("arm.toml")).unwrap();
    let on = "on = { wrist_pitch = 1, wrist_roll = -1 }";
    assert!(arm.contains(on));
    // The shaft's friction is 6400 times as large at the joint: the law that is found there holds it.
    let friction = "on = { wrist_roll = 1 }\nfriction = { viscous = 2e-5 }";
    fs::write(wrist.at("arm.toml"), arm.replace(on, friction)).unwrap();
    wrist.record();
    wrist.identify("found.toml", &[]);
    let [truth, found] = ["truth.toml", "found.toml"].map(|name| wrist.robot(name));
    let [true_, found] = [&truth, &found].map(|robot| robot.joint_friction("wrist_roll", 1.0));
    println!("{true_} {found}");
    assert!(true_ > 0.5 && (found - true_).abs() < 0.05 * true_, "{found} for {true_}");
}

#[test]
fn a_plan_keeps_the_torques_of_such_motors() {
    let wrist = Wrist::new(TRUTH);
    // Motors that a plan by the limits of the joints alone would ask for too much.
    let weak = format!("name = \"weak\"\nextends = \"arm.toml\"\n{}", weak_drives());
    fs::write(wrist.at("weak.toml"), weak).unwrap();
    let plan = |description: &str| {
        let text = wrist.gelenk(&[description, "--plan", "--output", "plan.csv", "--format", "json"]);
        let json = text.lines().filter(|line| !line.starts_with("gelenk:")).collect::<String>();
        let plan: serde_json::Value = serde_json::from_str(&json).unwrap();
        [0, 1].map(|shaft| plan["shafts"][shaft]["largest_torque"].as_f64().unwrap())
    };
    let [strong, weak] = ["arm.toml", "weak.toml"].map(plan);
    println!("{strong:?} {weak:?}");
    let usable = 0.7 * WEAK;
    assert!(strong.iter().any(|torque| *torque > usable) && weak.iter().all(|torque| *torque <= usable));
}

/// Torque of the weak motors [N·m].
const WEAK: f64 = 0.012;

fn weak_drives() -> String {
    let drive = |(name, sign): (&str, &str)| {
        format!(
            "\n[[drives]]\nname = \"{name}\"\non = {{ wrist_pitch = 1, wrist_roll = {sign}1 }}\ngear_ratio = 80\n\
             rotor_inertia = 1e-5\ncarrier = \"elbow\"\naxis = [0, 0, 1]\ntorque = {WEAK}\n"
        )
    };
    MOTORS.into_iter().zip(["", "-"]).map(drive).collect()
}

#[test]
fn moments_of_such_a_wrist_know_its_shafts() {
    let wrist = Wrist::new(TRUTH);
    let reduce = |output: &str, options: &[&str]| {
        let command = ["arm.toml", "log.csv", "--effort", "input", "--reduce", "--output", output];
        wrist.gelenk(&[&command[..], options].concat())
    };
    reduce("log.moments", &[]);
    let text = wrist.gelenk(&["arm.toml", "log.moments", "--merge", "--output", "merged.toml"]);
    println!("{text}");
    let [truth, merged] = ["truth.toml", "merged.toml"].map(|name| wrist.robot(name));
    for name in MOTORS {
        for v in [-250.0, -60.0, 60.0, 250.0] {
            let [true_, found] = [&truth, &merged].map(|robot| robot.shaft_friction(name, v));
            assert!((found - true_).abs() < 0.05 * true_.abs(), "{name} at {v}: {found} for {true_}");
        }
    }
    reduce("joints.moments", &["--friction-on", "joints"]);
    let refused = wrist.refused(&["arm.toml", "joints.moments", "--merge", "--output", "no.toml"]);
    assert!(refused.contains("another description"), "{refused}");
}
