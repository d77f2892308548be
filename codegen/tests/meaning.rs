//! Meaning of descriptions: friction, springs, drives, bases, mimic joints, angles.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "a second opinion on values")]

use gelenk_codegen::diagnostic::{Diagnostic, Diagnostics};
use gelenk_codegen::functions::selection::derive_functions;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::model::{
    Definiteness, FollowedCoordinate, Input, Joint, JointKind, Model, Motion, RotorCoupling,
};
use gelenk_codegen::program::interpret::interpret;
use gelenk_codegen::read::{ReadOptions, from_mjcf, from_toml, from_urdf, read};

fn load(text: &str) -> (Model, Diagnostics) {
    let base = &mut |file: &str| match file {
        "gripper.urdf" => Ok((file.to_owned(), GRIPPER.to_owned())),
        _ => Err(Diagnostic::error("file-unreadable", file).into()),
    };
    from_toml(text, "robot.toml", &ReadOptions::default(), base).unwrap_or_else(|wrong| panic!("{wrong}"))
}

fn one_joint(lines: &str) -> Model {
    load(&format!("[[joints]]\nname = \"j\"\n{lines}\n[[bodies]]\nlink = \"j\"\nmass = 1\ninertia = 1\n")).0
}

fn joint(model: &Model, coordinate: usize) -> &Joint {
    model.links[model.coordinates[coordinate]].joint.as_ref().unwrap()
}

fn friction(model: &Model, v: f64) -> f64 {
    let value = |formula: &gelenk_codegen::formula::Formula| formula.evaluate(&[], 0.0, v);
    joint(model, 0).friction.iter().map(|term| value(&term.coefficient) * value(&term.basis)).sum()
}

#[test]
fn friction_laws() {
    let law = |text: &str| one_joint(&format!("friction = {text}"));
    let viscous = law("{ viscous = 2 }");
    assert_eq!([friction(&viscous, 1.5), friction(&viscous, -1.5)], [3.0, -3.0]);
    let coulomb = law("{ coulomb = 0.5, viscous = 1 }");
    assert_eq!(
        [friction(&coulomb, 2.0), friction(&coulomb, 0.0), friction(&coulomb, -2.0)],
        [2.5, 0.0, -2.5]
    );
    let uneven = law("{ coulomb = { positive = 0.4, negative = -0.3 } }");
    for (v, expected) in [(1e-9, 0.4), (0.0, 0.0), (-1e-9, -0.3)] {
        assert!((friction(&uneven, v) - expected).abs() < 1e-16);
    }
    let smooth = law("{ coulomb = { positive = 0.4, negative = -0.3, slope = 50 } }");
    assert!((friction(&smooth, 1.0) - 0.4).abs() < 1e-15 && (friction(&smooth, -1.0) + 0.3).abs() < 1e-15);
    assert_eq!(friction(&smooth, 0.0), 0.0);
    let stribeck = law("{ stribeck = { a1 = 0.1, a2 = 0.3, a3 = 20, a4 = 0.2, a5 = 4 } }");
    for v in [-0.7_f64, 0.02, 0.3] {
        let expected = 0.1 * v + 0.3 * (20.0 * v).tanh() + 0.2 * (-4.0 * v.abs()).exp() * (60.0 * v).tanh();
        assert!((friction(&stribeck, v) - expected).abs() < 1e-15);
    }
}

#[test]
fn springs_pull_back() {
    let model = one_joint("spring = [{ stiffness = 10, rest = 0.5, damping = 2 }, \"-y\"]");
    let force: f64 = joint(&model, 0).springs.iter().map(|spring| spring.evaluate(&[], 0.7, 0.3)).sum();
    assert!((force - (-10.0 * (0.7 - 0.5) - 2.0 * 0.3 - 0.7)).abs() < 1e-15);
}

#[test]
fn drives_of_moving_and_held_joints() {
    let model = one_joint("drive = { gear_ratio = -50, motor_constant = { free = 0.05, unit = \"N m/A\" } }");
    let drive = &model.drives[0];
    assert_eq!((drive.coordinate(), drive.carrier, drive.axis), (Some(0), 0, [0.0, 0.0, 1.0]));
    assert!(matches!(drive.input, Input::Current(_)));
    assert_eq!(drive.coupling, RotorCoupling::Body);
    assert_eq!((model.parameters[0].name.as_str(), model.parameters[0].default), ("j_motor_constant", 0.05));
    let text = "[[joints]]\nname = \"a1\"\n[[joints]]\nname = \"b1\"\nheld = \"pi/2\"\n\
                origin = { rpy = [\"pi/2\", 0, 0] }\ndrive = { rotor_inertia = 1 }\n\
                [[bodies]]\nlink = \"b1\"\nmass = 1\ninertia = 1\n";
    let (model, _) = load(text);
    assert_eq!(model.coordinates, [1]);
    assert_eq!(model.links[2].joint.as_ref().unwrap().motion, Motion::Held(std::f64::consts::FRAC_PI_2));
    let drive = &model.drives[0];
    assert_eq!((drive.coordinate(), drive.carrier, drive.axis), (None, 1, [0.0, -1.0, 0.0]));
}

const GRIPPER: &str = r#"<robot name="gripper">
  <link name="palm"/>
  <link name="left"><inertial><mass value="1"/><origin xyz="0 0 0.1" rpy="1.5708 0 0"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1.5" iyz="0" izz="2"/></inertial></link>
  <link name="right"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="tip"/>
  <joint name="b_left" type="prismatic"><parent link="palm"/><child link="left"/><axis xyz="0 2 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.2"/><dynamics damping="0.3" friction="0.1"/></joint>
  <joint name="a_right" type="prismatic"><parent link="palm"/><child link="right"/><axis xyz="0 1 0"/><mimic joint="b_left"/></joint>
  <joint name="tip_joint" type="fixed"><parent link="left"/><child link="tip"/></joint>
  <transmission name="t"><actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>
  <link_state/>
</robot>"#;

#[test]
fn urdf_as_it_is() {
    let (mimic, _) = from_urdf(GRIPPER, "gripper.urdf", &ReadOptions::default()).unwrap();
    assert_eq!((mimic.coordinates.len(), mimic.drives.len()), (1, 1));
    assert_eq!(mimic.followers[0].follows, [FollowedCoordinate::itself(0)]);
    let options = ReadOptions { ignore_mimic: true, ..ReadOptions::default() };
    let (model, notes) = from_urdf(GRIPPER, "gripper.urdf", &options).unwrap();
    assert_eq!([joint(&model, 0).name.as_str(), joint(&model, 1).name.as_str()], ["a_right", "b_left"]);
    assert_eq!(joint(&model, 1).axis, [0.0, 1.0, 0.0]);
    assert_eq!(joint(&model, 1).friction.len(), 2);
    assert_eq!(joint(&model, 1).limits.position, Some([0.0, 0.04]));
    assert_eq!(model.frames.iter().map(|frame| frame.name.as_str()).collect::<Vec<_>>(), ["tip"]);
    assert_eq!(model.drives.len(), 2);
    insta::assert_snapshot!(notes.to_string());
}

#[test]
fn a_base_is_extended() {
    let text = "urdf = \"gripper.urdf\"\n[[joints]]\nname = \"a_right\"\nheld = 0.01\n\
                [[joints]]\nname = \"b_left\"\ndrive = { gear_ratio = 3 }\nlimits = { velocity = 0.5 }\n\
                [[joints]]\nname = \"wrist\"\nparent = \"tip\"\naxis = [1, 0, 0]\n\
                [[bodies]]\nname = \"left\"\nmass = { free = 2 }\n\
                [[bodies]]\nlink = \"wrist\"\nmass = 1\ninertia = 1\n";
    let (model, _) = load(text);
    assert_eq!(model.name, "robot");
    assert_eq!([joint(&model, 0).name.as_str(), joint(&model, 1).name.as_str()], ["b_left", "wrist"]);
    let limits = joint(&model, 0).limits;
    assert_eq!((limits.position, limits.velocity, limits.effort), (Some([0.0, 0.04]), Some(0.5), Some(10.0)));
    assert_eq!(model.drives.len(), 1, "a new joint has no drive unless it says so");
    let left = model.links.iter().find(|link| link.name == "left").unwrap();
    assert_eq!(left.bodies[0].mass.evaluate(&[2.0], 0.0, 0.0), 2.0);
    assert_eq!(left.bodies[0].center_of_mass[2].as_number(), Some(0.1));
}

#[test]
fn snapping_makes_rotations_exact() {
    let options = |snap_angles| ReadOptions { snap_angles, ignore_mimic: true, ..ReadOptions::default() };
    let inertia = |options: &ReadOptions| {
        let (model, _) = from_urdf(GRIPPER, "gripper.urdf", options).unwrap();
        let left = model.links.iter().find(|link| link.name == "left").unwrap();
        left.bodies[0].inertia.clone().map(|entry| entry.as_number().unwrap())
    };
    assert_eq!(inertia(&options(Some(1e-4))), [1.0, 0.0, 0.0, 2.0, 0.0, 1.5]);
    assert_ne!(inertia(&options(None))[4], 0.0);
}

#[test]
fn unreadable_files() {
    let missing = read("no/such/file.toml".as_ref(), &ReadOptions::default()).unwrap_err();
    assert!(
        missing.to_string().starts_with("error[file-unreadable]: cannot read no/such/file.toml"),
        "{missing}"
    );
    let folder = std::env::temp_dir().join(format!("gelenk-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("latin1.toml");
    std::fs::write(&file, b"name = \"x\"\n# caf\xe9\n").unwrap();
    let latin = read(&file, &ReadOptions::default()).unwrap_err();
    let at = latin.entries()[0].location().cloned().unwrap();
    assert_eq!((latin.entries()[0].code, at.line, at.column), ("not-utf-8", 2, 6));
    assert!(read(&folder, &ReadOptions::default()).is_err());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn friction_that_drives_at_some_speeds_is_noted_with_them() {
    let text = r#"
[[joints]]
name = "axis"
limits = { velocity = 4 }
friction = { viscous = -3, coulomb = 5 }
[[bodies]]
link = "axis"
mass = 1
inertia = 1
"#;
    let (_, notes) = load(text);
    let notes = notes.to_string();
    let expected = "the friction of joint `axis` accelerates the joint at velocities from -4 to -1.86 rad/s and from 1.86 to 4 rad/s";
    assert!(notes.contains(expected), "{notes}");
    let (_, notes) = load(&text.replace("-3", "3"));
    assert!(notes.is_empty(), "{notes}");
}

/// A wrist behind a differential, with two fingers.
const WRIST: &str = r#"
[[joints]]
name = "pitch"
axis = [0, 1, 0]
[[joints]]
name = "roll"
[[joints]]
name = "finger"
type = "prismatic"
axis = [0, 1, 0]
drive = "ideal"
[[joints]]
name = "other_finger"
parent = "roll"
type = "prismatic"
axis = [0, 1, 0]
follows = { finger = -1 }
[[drives]]
name = "left"
on = { pitch = 1, roll = 1 }
[[drives]]
name = "right"
on = { pitch = 2, roll = -2 }
[[bodies]]
link = "pitch"
mass = 0.5
inertia = 4e-4
[[bodies]]
link = "roll"
mass = 0.4
inertia = 3e-4
[[bodies]]
link = "finger"
mass = 0.05
[[bodies]]
link = "other_finger"
mass = 0.05
"#;

#[test]
fn drives_that_act_alike_are_noted() {
    let notes = |from, to| load(&WRIST.replace(from, to)).1;
    assert!(notes("", "").is_empty());
    let alike = notes("roll = -2", "roll = 2").to_string();
    assert!(alike.contains("note[drives-alike]: drives `left`, `right` act alike"), "{alike}");
    let three = notes("name = \"roll\"", "name = \"roll\"\ndrive = { gear_ratio = 3 }").to_string();
    assert!(
        three.contains("note[drives-alike]: 4 drives move the joints in only 3 independent ways"),
        "{three}"
    );
}

/// A limit that reaches no controller is worse than none.
#[test]
fn an_effort_without_a_drive_is_told() {
    let said = |drive: &str, limits: &str| {
        let body = "[[bodies]]\nlink = \"j\"\nmass = 1\ninertia = 1\n";
        let (_, notes) = load(&format!("[[joints]]\nname = \"j\"\n{drive}\nlimits = {{ {limits} }}\n{body}"));
        notes.entries().iter().filter(|note| note.code == "effort-without-drive").count()
    };
    for limits in ["effort = 40", "peak_effort = 60"] {
        assert_eq!(said("", limits), 1);
        assert_eq!([said("drive = \"ideal\"", limits), said("drive = \"none\"", limits)], [0, 0]);
    }
    assert_eq!(said("", "velocity = 2"), 0);
    // The effort of a joint that a drive moves from elsewhere bounds this drive's input.
    let (_, notes) = load(
        "[[joints]]\nname = \"j\"\nlimits = { effort = 40 }\n[[drives]]\nname = \"m\"\non = { j = 1 }\n\
         [[bodies]]\nlink = \"j\"\nmass = 1\ninertia = 1\n",
    );
    assert!(notes.entries().iter().all(|note| note.code != "effort-without-drive"), "{notes}");
}

#[test]
fn a_rotor_that_is_nowhere_needs_no_carrier() {
    let left = |keys: &str| {
        WRIST.replace("on = { pitch = 1, roll = 1 }", &format!("on = {{ pitch = 1, roll = 1 }}\n{keys}"))
    };
    let mounting = "rotor_inertia = 1e-6\ncarrier = \"base\"\naxis = [0, 1, 0]\n";
    let unused = load(&left(&format!("{mounting}coupling = \"diagonal\""))).1.to_string();
    for key in ["carrier", "axis"] {
        let words = format!("warning[unused-key]: `{key}` has no effect with `coupling = \"diagonal\"`");
        assert!(unused.contains(&words), "{unused}");
    }
    assert!(load(&left(mounting)).1.is_empty());
}

#[test]
fn a_joint_that_undoes_the_motion_below_it_is_noted() {
    let (_, notes) = load(&WRIST.replace("parent = \"roll\"\n", ""));
    let notes = notes.to_string();
    assert!(
        notes.contains("note[follower-stands-still]: joint `other_finger` cancels the motion of `finger`"),
        "{notes}"
    );
    // A parallelogram keeps its platform level: an arm is between the axes.
    let level = "[[joints]]\nname = \"boom\"\n[[joints]]\nname = \"level\"\norigin = { xyz = [1, 0, 0] }\n\
                 follows = { boom = -1 }\n[[bodies]]\nlink = \"level\"\nmass = 1\ninertia = 1\n";
    assert!(load(level).1.is_empty());
    let on_the_axis = load(&level.replace("[1, 0, 0]", "[0, 0, 1]")).1.to_string();
    assert!(on_the_axis.contains("note[follower-stands-still]"), "{on_the_axis}");
}

/// A planar joint of a URDF, and a TOML file that says more about its parts.
const CART: &str = r#"<robot name="cart">
  <link name="floor"/>
  <link name="cart"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="base" type="planar"><parent link="floor"/><child link="cart"/><origin xyz="0 0 1"/><axis xyz="0 0 -1"/></joint>
</robot>"#;

#[test]
fn a_planar_joint_of_a_urdf_is_a_chain() {
    let (model, _) = from_urdf(CART, "cart.urdf", &ReadOptions::default()).unwrap();
    let names: Vec<&str> = model.joints().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["base_x", "base_y", "base_theta"]);
    let axes: Vec<[f64; 3]> = model.joints().map(|joint| joint.axis).collect();
    assert_eq!(axes, [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
    let links: Vec<&str> = model.links.iter().map(|link| link.name.as_str()).collect();
    assert_eq!(links, ["floor", "base_x", "base_y", "cart"]);
    assert_eq!(joint(&model, 0).origin.translation[2].as_number(), Some(1.0));
    assert_eq!(joint(&model, 2).origin.translation[2].as_number(), Some(0.0));
    assert_eq!(model.inputs().count(), 3, "drives of a URDF are ideal");
}

#[test]
fn parts_of_joints_are_told_one_by_one() {
    let text = "[[joints]]\nname = \"quill\"\ntype = \"cylindrical\"\naxis = [0, 1, 0]\n\
                limits = { slide = { position = [-1, 0] } }\ndrive = \"ideal\"\nfriction = { turn = { viscous = { free = 0.1 } } }\n\
                [[joints]]\nname = \"gimbal\"\ntype = \"universal\"\nchild = \"plate\"\nheld = { y = 0.2 }\n\
                [[bodies]]\nlink = \"quill\"\nmass = 1\ninertia = 1\n[[bodies]]\nlink = \"plate\"\nmass = 1\ninertia = 1\n";
    let (model, _) = load(text);
    let names: Vec<&str> = model.joints().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["quill_turn", "quill_slide", "gimbal_x"]);
    assert_eq!(joint(&model, 1).limits.position, Some([-1.0, 0.0]));
    assert_eq!(joint(&model, 0).limits.position, None);
    assert_eq!(model.parameters[0].name, "quill_turn_viscous");
    assert_eq!(model.inputs().map(|input| input.name()).collect::<Vec<_>>(), ["quill_turn", "quill_slide"]);
    let plate = model.links.last().unwrap();
    assert_eq!((plate.name.as_str(), plate.joint.as_ref().unwrap().motion), ("plate", Motion::Held(0.2)));
}

#[test]
fn a_helical_joint_is_an_angle() {
    let text = "[[joints]]\nname = \"lift\"\ntype = \"helical\"\npitch = \"-0.02/(2*pi)\"\nlimits = { position = [-50, 50] \
                }\ndrive = \"ideal\"\n[[bodies]]\nlink = \"lift\"\nmass = 1\n";
    let (model, notes) = load(text);
    assert_eq!(joint(&model, 0).kind, JointKind::Helical { pitch: -0.02 / std::f64::consts::TAU });
    assert_eq!(
        (joint(&model, 0).kind.unit(), model.input_unit(model.inputs().next().unwrap())),
        ("rad", "N m")
    );
    assert_eq!(model.definiteness(), Definiteness::Positive, "a point mass resists the slide of its screw");
    assert!(!notes.to_string().contains("degrees"), "screws turn often: {notes}");
}

/// A shaft that turns −50 times as fast brakes with −50 times its own friction.
#[test]
fn friction_of_a_shaft_counts_at_its_joint_through_the_gear() {
    let text = "[[joints]]\nname = \"lift\"\nfriction = { viscous = 2 }\n\
                drive = { gear_ratio = -50, friction = { viscous = 1e-3, terms = [[\"tanh(0.3*v)\", 0.02], [\"cos(y)*v\", 1e-4]] } }\n\
                [[bodies]]\nlink = \"lift\"\nmass = 1\ninertia = 1\n";
    let (model, _) = load(text);
    let at = |y: f64, v: f64| -> f64 {
        let terms = joint(&model, 0).friction.iter();
        terms.map(|term| term.coefficient.evaluate(&[], y, v) * term.basis.evaluate(&[], y, v)).sum()
    };
    for (y, v) in [(0.3_f64, 0.2_f64), (-1.0, -0.05)] {
        let (angle, speed) = (-50.0 * y, -50.0 * v);
        let shaft = 1e-3 * speed + 0.02 * (0.3 * speed).tanh() + 1e-4 * angle.cos() * speed;
        let expected = 2.0 * v - 50.0 * shaft;
        assert!((at(y, v) - expected).abs() < 1e-12 && at(y, v) * v > 0.0, "{} {expected}", at(y, v));
    }
}

/// MuJoCo 4.0 has 0.3 · 0.05²/2 + 0.001 too.
#[test]
fn rotors_need_no_actuator() {
    let text = r#"<mujoco><compiler angle="radian"/><worldbody><body name="knob">
        <joint name="j" axis="0 0 1" armature="0.001" damping="1"/><geom type="cylinder" size="0.05 0.018" mass="0.3"/>
        </body></worldbody></mujoco>"#;
    let mut load = |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
    let (model, _) = from_mjcf(text, "knob.xml", &ReadOptions::default(), &mut load).unwrap();
    let functions = derive_functions(&model, &["mass_matrix".to_owned()], MOST_OPERATIONS).unwrap();
    let mass = interpret(&functions[0].program, &[&[0.3]], &[]).unwrap();
    assert!((mass[0][0] - 0.001375).abs() < 1e-15, "{mass:?}");
}

/// Parts of an MJCF that a model cannot hold are reported by name.
#[test]
fn an_mjcf_loses_nothing_in_silence() {
    let text = r#"<mujoco><option><flag frictionloss="disable" gravity="disable"/></option><worldbody><body>
        <joint name="lift" type="slide" actuatorfrcrange="-2 5"/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let mut load = |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
    let read = from_mjcf(text, "lift.xml", &ReadOptions::default(), &mut load);
    let (model, notes) = read.unwrap_or_else(|wrong| panic!("{wrong}"));
    assert_eq!(joint(&model, 0).limits.effort, Some(2.0));
    let notes = notes.to_string();
    for said in ["omitted if they exclude 0: `lift`", "were ignored: `frictionloss`"] {
        assert!(notes.contains(said), "{notes}");
    }
}
