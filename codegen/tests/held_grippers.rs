//! Joints that are held by patterns: those that follow them rest too, and M is that of the free robot without their rows.
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use gelenk_codegen::diagnostic::Diagnostics;
use gelenk_codegen::formula::Hold;
use gelenk_codegen::model::Model;
use gelenk_codegen::read::{ReadOptions, from_toml, from_urdf};
use gelenk_codegen::verify::mass_and_bias;

/// Links on a chain of joints: name, parent, xyz, rpy, axis, what they follow.
type Row = (&'static str, &'static str, &'static str, &'static str, &'static str, &'static str);

/// An arm like a UR5e, and a gripper like Robotiq's 2F-85, whose six joints follow one.
const ROWS: [Row; 12] = [
    ("shoulder_pan", "base", "0 0 0.1625", "0 0 0", "0 0 1", ""),
    ("shoulder_lift", "shoulder_pan", "0 0 0", "1.570796 0 0", "0 0 1", ""),
    ("elbow", "shoulder_lift", "-0.425 0 0", "0 0 0", "0 0 1", ""),
    ("wrist_1", "elbow", "-0.3922 0 0.1333", "0 0 0", "0 0 1", ""),
    ("wrist_2", "wrist_1", "0 -0.0997 0", "1.570796 0 0", "0 0 1", ""),
    ("wrist_3", "wrist_2", "0 0.0996 0", "1.570796 3.141593 3.141593", "0 0 1", ""),
    ("finger", "wrist_3", "0.03 0 0.055", "0 0 0", "0 -1 0", ""),
    ("right_outer_knuckle", "wrist_3", "-0.03 0 0.055", "0 0 0", "0 1 0", "joint=\"finger\""),
    ("left_inner_knuckle", "wrist_3", "0.013 0 0.061", "0 0 0", "0 -1 0", "joint=\"finger\" offset=\"0.02\""),
    ("right_inner_knuckle", "wrist_3", "-0.013 0 0.061", "0 0 0", "0 1 0", "joint=\"finger\""),
    (
        "left_inner_finger",
        "finger",
        "0.03 0 0.04",
        "0 0 0",
        "0 1 0",
        "joint=\"left_inner_knuckle\" multiplier=\"-1\"",
    ),
    (
        "right_inner_finger",
        "right_outer_knuckle",
        "-0.03 0 0.04",
        "0 0 0",
        "0 -1 0",
        "joint=\"finger\" multiplier=\"-1\"",
    ),
];

fn urdf() -> String {
    let mut text = "<robot name=\"ur\"><link name=\"base\"/>".to_owned();
    for (index, (name, parent, xyz, rpy, axis, follows)) in ROWS.into_iter().enumerate() {
        let size = if index < 6 { 3.0 - 0.4 * index as f64 } else { 0.05 };
        let mimic = if follows.is_empty() { String::new() } else { format!("<mimic {follows}/>") };
        let inertia = 0.01 * size;
        text.push_str(&format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0.01 0.02 0.03\"/><mass value=\"{size}\"/>\
             <inertia ixx=\"{inertia}\" iyy=\"{inertia}\" izz=\"{inertia}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
             <joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{name}\"/>\
             <origin xyz=\"{xyz}\" rpy=\"{rpy}\"/><axis xyz=\"{axis}\"/><limit lower=\"-3\" upper=\"3\" effort=\"9\" velocity=\"3\"/>{mimic}</joint>"
        ));
    }
    text + "</robot>"
}

fn held(text: &str) -> Result<Model, Diagnostics> {
    let mut load = |_: &str| Ok(("ur.urdf".to_owned(), urdf()));
    from_toml(&format!("urdf = \"ur.urdf\"\n{text}"), "ur.toml", &ReadOptions::default(), &mut load)
        .map(|(model, _)| model)
}

#[test]
fn held_joints_and_their_followers_leave_the_rows_of_the_arm() {
    const FINGER: f64 = 0.4;
    let options = ReadOptions { ignore_mimic: true, ..ReadOptions::default() };
    let (free, _) = from_urdf(&urdf(), "ur.urdf", &options).unwrap();
    let arm = [0.3, -1.1, 0.9, 0.2, -0.7, 1.3];
    let speed = [1.0, -2.0, 0.5, 0.7, 1.1, -0.4];
    // ratio · position + offset, joint by joint.
    let gripper = [FINGER, FINGER, FINGER + 0.02, FINGER, -(FINGER + 0.02), -FINGER];
    let names: Vec<&str> = free.joints().map(|joint| joint.name.as_str()).collect();
    let place = |index: usize| names.iter().position(|name| *name == ROWS[index].0).unwrap();
    let (mut y, mut v) = ([0.0; 12], [0.0; 12]);
    for index in 0..12 {
        y[place(index)] = if index < 6 { arm[index] } else { gripper[index - 6] };
        v[place(index)] = if index < 6 { speed[index] } else { 0.0 };
    }
    let [mass, bias] = mass_and_bias(&free, &y, &v);
    let asked = ReadOptions { hold: vec![Hold::parse("*finger*=0.4").unwrap()], ..ReadOptions::default() };
    let by_option = from_urdf(&urdf(), "ur.urdf", &asked).unwrap().0;
    let by_key = held("held = { \"*finger*\" = 0.4 }").unwrap();
    let by_joint = held("[[joints]]\nname = \"finger\"\nheld = 0.4\n").unwrap();
    for model in [by_option, by_key, by_joint] {
        assert_eq!(model.coordinates.len(), 6);
        let order: Vec<usize> =
            model.joints().map(|joint| ROWS.iter().position(|row| row.0 == joint.name).unwrap()).collect();
        let own = |values: [f64; 6]| order.iter().map(|&index| values[index]).collect::<Vec<_>>();
        let [held_mass, held_bias] = mass_and_bias(&model, &own(arm), &own(speed));
        for (row, &one) in order.iter().enumerate() {
            assert!((held_bias[row] - bias[place(one)]).abs() < 1e-12);
            for (column, &other) in order.iter().enumerate() {
                let expected = mass[place(one) * 12 + place(other)];
                assert!((held_mass[row * 6 + column] - expected).abs() < 1e-13, "{row} {column}");
            }
        }
    }
}

/// A later entry counts, a pattern that finds nothing is an error, and so is a follower of a joint that moves.
#[test]
fn patterns_name_joints_at_rest() {
    let code = |text: &str| {
        let problems = held(text).unwrap_err();
        problems.entries().iter().map(|entry| entry.code).next().unwrap()
    };
    assert_eq!(code("held = { thumb = 0 }"), "unknown-joint");
    assert_eq!(code("held = { left_inner_finger = 0 }"), "follows-moving");
    assert_eq!(code("held = 0"), "wrong-type");
    let listed =
        "coordinates = [\"elbow\", \"finger\"]\nheld = { finger = 0, \"wrist_*\" = 0, \"shoulder_*\" = 0 }";
    assert_eq!(held(listed).unwrap().coordinates.len(), 1);
}
