//! Contents of published URDFs and how the reader treats them.

#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use super::common::rustc;
use gelenk_codegen::diagnostic::{Diagnostic, Diagnostics, Severity};
use gelenk_codegen::model::Model;
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};
use gelenk_codegen::read::{ReadOptions, from_urdf};

fn read(text: &str) -> Result<(Model, Diagnostics), Diagnostics> {
    from_urdf(text, "r.urdf", &ReadOptions::default())
}

/// The diagnostics of a URDF that is accepted.
fn notes(text: &str) -> Vec<Diagnostic> {
    let (_, notes) = read(text).unwrap_or_else(|wrong| panic!("{wrong}"));
    notes.into_entries()
}

fn codes(entries: &[Diagnostic]) -> Vec<&str> {
    entries.iter().map(|entry| entry.code).collect()
}

/// The module of a URDF.
fn try_module(text: &str, functions: &[&str]) -> Result<Generated, Diagnostics> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.urdf");
    std::fs::write(&path, text).unwrap();
    let options = GenerateOptions {
        functions: functions.iter().map(|&name| name.to_owned()).collect(),
        ..GenerateOptions::default()
    };
    generate(&path, &options)
}

fn module(text: &str, functions: &[&str]) -> Generated {
    try_module(text, functions).unwrap_or_else(|wrong| panic!("{wrong}"))
}

const REAL: &str = "<inertial><mass value=\"1\"/><origin xyz=\"0 0 0.1\"/>\
    <inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";

/// A chain of continuous joints with these names; the last link carries a frame of each of these names.
fn chain(joints: &[&str], frames: &[&str]) -> String {
    let xml = |name: &str| name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let mut text = "<robot name=\"r\"><link name=\"base\"/>".to_owned();
    let mut parent = "base".to_owned();
    for joint in joints {
        let link = format!("{}.link", xml(joint));
        text += &format!("<link name=\"{link}\">{REAL}</link>");
        text += &format!(
            "<joint name=\"{}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"{link}\"/></joint>",
            xml(joint)
        );
        parent = link;
    }
    for (index, frame) in frames.iter().enumerate() {
        text += &format!("<link name=\"{}\"/>", xml(frame));
        text += &format!(
            "<joint name=\"fixed {index}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{}\"/></joint>",
            xml(frame)
        );
    }
    text + "</robot>"
}

/// The texts of a constant, as rustc reads them.
fn texts(source: &str, constant: &str) -> Vec<String> {
    let file = syn::parse_file(source).unwrap();
    let value = file.items.into_iter().find_map(|item| match item {
        syn::Item::Const(item) if item.ident == constant => Some(*item.expr),
        _ => None,
    });
    let Some(syn::Expr::Array(array)) = value else { panic!("{constant} is an array") };
    let text = |entry: syn::Expr| match entry {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => text.value(),
        _ => panic!("{constant} holds texts"),
    };
    array.elems.into_iter().map(text).collect()
}

/// A ROS JointState and a CAN table are matched by these names. Each of them was changed to an identifier, or
/// refused.
const STRANGE: [&str; 14] = [
    "LFinger12",
    "joint_0.0",
    "Elbow-1",
    "elbow_1",
    "elbow_1_2",
    "y",
    "M",
    "type",
    "腕",
    "??",
    " padded, \"quoted\" \\ ' {} ",
    "*/ \u{202e} #[x] //",
    "Ångström",
    "β",
];

#[test]
fn names_are_those_of_the_description_to_the_letter() {
    let frames = ["Tool-0", "tool_0", "先"];
    let functions = ["mass_matrix", "frames", "inertial_parameters"];
    let robot = module(&chain(&STRANGE, &frames), &functions);
    let source = &robot.source.text;
    assert_eq!(texts(source, "JOINT_NAMES"), STRANGE);
    assert_eq!(texts(source, "INPUT_NAMES"), STRANGE);
    let mut found = texts(source, "FRAME_NAMES");
    found.sort();
    assert_eq!(found, ["Tool-0", "tool_0", "先"]);
    for name in ["frame_tool_0_pose", "frame_tool_0_2_pose", "frame_u5148_pose"] {
        assert!(source.contains(&format!("pub fn {name}(")), "{name}");
    }
    let parameters = texts(source, "INERTIAL_PARAMETER_NAMES");
    assert!(parameters.contains(&"m_joint_0.0".to_owned()), "{parameters:?}");
    assert!(
        source.contains("/// - `y: [N]`: coordinates: `LFinger12`, `joint_0.0`, `Elbow-1`"),
        "documentation names joints as described"
    );
    let folder = tempfile::tempdir().unwrap();
    let strict = ["--crate-type", "lib", "-D", "warnings"];
    rustc(folder.path(), "strange", source, &strict).unwrap();
}

#[test]
fn frames_whose_functions_have_other_names_are_noted() {
    let robot = module(&chain(&["Joint 1"], &["Tool-0", "tool_0", "flange"]), &["frames"]);
    let notes: Vec<&str> = robot
        .notes
        .entries()
        .iter()
        .filter(|note| note.code == "name-mapped")
        .map(|note| note.message.as_str())
        .collect();
    let expected = "the generated code uses these identifiers: \"Tool-0\" → `frame_tool_0_…`, \"tool_0\" → `frame_tool_0_2_…`";
    assert_eq!(notes, [expected]);
}

/// A base with a body, a turning arm with one, and what is fixed to them.
fn arm(base: &str, arm: &str, more: &str) -> String {
    format!(
        "<robot name=\"r\"><link name=\"base\">{base}</link><link name=\"arm\">{arm}</link>\
         <joint name=\"Turn\" type=\"continuous\"><parent link=\"base\"/><child link=\"arm\"/></joint>{more}</robot>"
    )
}

fn inertial(mass: f64, center: &str, inertia: [f64; 6]) -> String {
    let [xx, xy, xz, yy, yz, zz] = inertia;
    format!(
        "<inertial><origin xyz=\"{center}\"/><mass value=\"{mass:e}\"/><inertia ixx=\"{xx:e}\" ixy=\"{xy:e}\" \
         ixz=\"{xz:e}\" iyy=\"{yy:e}\" iyz=\"{yz:e}\" izz=\"{zz:e}\"/></inertial>"
    )
}

/// The numbers are those of iCub's head and right hip, and of ANYmal C's camera.
#[test]
fn rounding_is_no_fault() {
    let bodies = [
        inertial(1.33687, "0.0185 -0.1108 6.8e-18", [0.0, 0.0, 2.40741e-35, 0.0, 0.0, 0.0]),
        inertial(0.526, "0 0 0.03045", [-5.42101e-20, 0.0, 0.0, -5.42101e-20, 0.0, 0.0]),
        inertial(0.1, "0 0 0.1", [3e-6, 0.0, 0.0, 3e-6, 0.0, -1e-22]),
    ];
    for body in bodies {
        assert!(codes(&notes(&arm("", &body, ""))).is_empty(), "{body}");
    }
}

/// B1 and HyQ carry a dummy of six equal entries on their base.
#[test]
fn bodies_that_never_move_are_not_checked() {
    let dummy = inertial(1e-6, "0 0 0", [1e-6; 6]);
    let (real, fixed) = (
        REAL,
        "<link name=\"plate\">{}</link><joint name=\"f\" type=\"fixed\">\
        <parent link=\"base\"/><child link=\"plate\"/></joint>",
    );
    assert!(codes(&notes(&arm(&dummy, real, ""))).is_empty());
    let plate = fixed.replace("{}", &inertial(1.0, "0 0 0", [-1.0; 6]));
    assert!(codes(&notes(&arm("", real, &plate))).is_empty());
    let foot = plate.replace("parent link=\"base\"", "parent link=\"arm\"");
    assert!(codes(&notes(&arm("", real, &foot))).contains(&"unphysical-bodies"));
}

#[test]
fn published_bodies_are_taken_with_one_warning() {
    let triangle = inertial(1.0, "0 0 0.1", [1e-4, 0.0, 0.0, 2e-4, 0.0, 4e-4]);
    let more: String = (0..6)
        .map(|k| {
            format!(
                "<link name=\"l{k}\">{triangle}</link><joint name=\"f{k}\" type=\"fixed\"><parent link=\"arm\"/>\
                 <child link=\"l{k}\"/></joint>"
            )
        })
        .collect();
    let entries = notes(&arm("", &triangle, &more));
    assert_eq!(codes(&entries), ["unphysical-bodies"]);
    assert_eq!(entries[0].severity, Severity::Warning);
    insta::assert_snapshot!(entries[0].message);
}

/// The arm has a moment of −1 about its joint's axis: forces would push it backwards.
#[test]
fn a_mass_matrix_that_is_not_positive_definite_is_refused() {
    let text = arm("", &inertial(1.0, "0 0 0", [-1.0, 0.0, 0.0, 1.0, 0.0, 1.0]), "");
    let problems = read(&text).unwrap_err();
    assert_eq!(problems.error_count(), 1);
    assert!(codes(problems.entries()).contains(&"mass-matrix-not-positive-definite"));
    let options = ReadOptions { accept_unphysical: true, ..ReadOptions::default() };
    let (_, entries) = from_urdf(&text, "r.urdf", &options).unwrap();
    assert!(codes(entries.entries()).contains(&"mass-matrix-not-positive-definite"));
    // The same about an axis that does not turn is not a reason to refuse anything.
    let text = arm("", &inertial(1.0, "0 0 0", [1.0, 0.0, 0.0, -1.0, 0.0, 1.0]), "");
    assert_eq!(codes(&notes(&text)), ["unphysical-bodies"]);
}

/// As Romeo's fingers: joints that carry links without mass.
#[test]
fn joints_without_inertia_cost_the_functions_with_the_inverse() {
    let finger = "<link name=\"finger\"/><joint name=\"LFinger12\" type=\"continuous\"><parent link=\"arm\"/>\
        <child link=\"finger\"/></joint>";
    let text = arm("", REAL, finger);
    let robot = module(&text, &[]);
    let found = |name: &str| robot.source.text.contains(&format!("pub fn {name}("));
    for name in ["mass_matrix", "inverse_dynamics", "inverse_dynamics_derivatives", "base_regressor"] {
        assert!(found(name), "{name}");
    }
    assert!(robot.source.text.contains("symmetric, positive semidefinite"));
    assert!(!robot.source.text.contains("symmetric, positive definite"));
    let lost = ["forward_dynamics", "forward_dynamics_derivatives", "linearize"];
    for name in lost.iter().chain(&["discretize", "step", "step_derivatives"]) {
        assert!(!found(name), "{name}");
    }
    let entries = robot.notes.entries();
    let messages = entries.iter().map(|entry| format!("{}: {}", entry.code, entry.message));
    insta::assert_snapshot!(messages.collect::<Vec<_>>().join("\n"));
    for name in ["forward_dynamics", "linearize", "step"] {
        let problems = try_module(&text, &["mass_matrix", name]).unwrap_err();
        assert_eq!(problems.error_count(), 1);
        assert!(codes(problems.entries()).contains(&"singular-mass-matrix"), "{name}");
    }
    let folder = tempfile::tempdir().unwrap();
    let strict = ["--crate-type", "lib", "-D", "warnings"];
    rustc(folder.path(), "finger", &robot.source.text, &strict).unwrap();
}

const LIMIT: &str = "<limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\"/>";

/// One revolute joint; what stands in its link, in the joint, and around.
fn one_joint(kind: &str, link: &str, joint: &str) -> String {
    format!(
        "<robot name=\"r\"><link name=\"base\"/><link name=\"arm\">{link}</link><joint name=\"j\" type=\"{kind}\">\
         <parent link=\"base\"/><child link=\"arm\"/>{joint}</joint></robot>"
    )
}

/// ROS's urdfdom takes the first of several elements of one kind.
#[test]
fn the_first_of_several_elements_counts() {
    let twice = REAL.replace("<mass value=\"1\"/>", "<mass value=\"1\"/><mass value=\"7\"/>");
    let other = LIMIT.replace("lower=\"-1\"", "lower=\"-9\"");
    let joint = format!("{LIMIT}{other}<axis xyz=\"0 0 1\"/><axis xyz=\"1 0 0\"/>");
    let text = one_joint("revolute", &format!("{twice}{}", REAL.replace("\"1\"", "\"5\"")), &joint);
    let (model, entries) = read(&text).unwrap();
    let joint = model.links[1].joint.as_ref().unwrap();
    assert_eq!(joint.axis, [0.0, 0.0, 1.0]);
    assert_eq!(joint.limits.position, Some([-1.0, 2.0]));
    assert_eq!(model.links[1].bodies[0].mass.as_number(), Some(1.0));
    assert_eq!(codes(entries.entries()), ["duplicate-element"]);
    let message = &entries.entries()[0].message;
    for owner in ["<inertial> of `arm`", "<mass> of `arm`", "<limit> of `j`", "<axis> of `j`"] {
        assert!(message.contains(owner), "{message}");
    }
}

/// Kind of the joint, its elements, the limits that are taken, and what is said.
#[test]
fn limits_are_taken_as_far_as_they_make_sense() {
    let none = (None, None, None);
    let all = (Some([-1.0, 2.0]), Some(4.0), Some(3.0));
    let amounts = (None, Some(4.0), Some(3.0));
    let swapped = LIMIT.replace("lower=\"-1\"", "lower=\"5\"");
    let fixed = "<limit effort=\"3\" velocity=\"4\"/>";
    let infinite = LIMIT.replace("\"2\"", "\"inf\"").replace("\"-1\"", "\"-1e308\"");
    let negative = LIMIT.replace("\"4\"", "\"-4\"");
    let zero = LIMIT.replace("\"3\"", "\"0\"");
    let cases: [(&str, &str, _, &[&str]); 11] = [
        ("revolute", LIMIT, all, &[]),
        ("prismatic", LIMIT, all, &[]),
        ("revolute", "", none, &["limit-missing"]),
        ("prismatic", "", none, &["limit-missing"]),
        ("continuous", "", none, &[]),
        ("continuous", fixed, amounts, &[]),
        ("continuous", LIMIT, amounts, &["continuous-limits"]),
        ("revolute", &swapped, amounts, &["limit-unusable"]),
        ("revolute", &infinite, amounts, &["limit-unset"]),
        ("revolute", &negative, (Some([-1.0, 2.0]), None, Some(3.0)), &["limit-unusable"]),
        ("revolute", &zero, (Some([-1.0, 2.0]), Some(4.0), None), &["limit-unset"]),
    ];
    for (kind, elements, expected, said) in cases {
        let (model, entries) = read(&one_joint(kind, REAL, elements)).unwrap();
        let limits = model.links[1].joint.as_ref().unwrap().limits;
        let found = (limits.position, limits.velocity, limits.effort);
        assert_eq!(found, expected, "{kind} {elements}");
        assert_eq!(codes(entries.entries()), said, "{kind} {elements}");
    }
}

/// Texts that XML forbids and ROS accepts.
#[test]
fn texts_are_taken_as_ros_takes_them() {
    let plain = one_joint("revolute", REAL, LIMIT);
    let (expected, _) = read(&plain).unwrap();
    let inside = |text: &str| plain.replace("</robot>", &format!("{text}</robot>"));
    let texts = [
        inside("<!-- a -- b ------->"),
        inside("<gazebo><sensor:camera a:b=\"1\"/></gazebo>"),
        inside("<gazebo><![CDATA[ <!-- -- ]]></gazebo>"),
        format!("\n <?xml version=\"1.0\"?>\n{plain}"),
        format!("\u{feff}<?xml version=\"1.0\"?>{plain}"),
        format!("<!-- first -- --><?xml version=\"1.0\"?><!DOCTYPE robot>{plain}"),
        plain.replace("\"1\"", "\" 1.\t\""),
    ];
    for text in texts {
        let (model, _) = read(&text).unwrap_or_else(|wrong| panic!("{text}: {wrong}"));
        assert_eq!(model, expected, "{text}");
    }
}

/// CAD programs write comments in the encoding of their country.
#[test]
fn latin_1_is_read_where_it_is_declared() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.urdf");
    let body = one_joint("revolute", REAL, LIMIT).replace("\"arm\"", "\"Ärm\"");
    let bytes = |head: &str| -> Vec<u8> {
        let text = format!("{head}{body}");
        text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect()
    };
    let load = |head: &str| {
        std::fs::write(&path, bytes(head)).unwrap();
        gelenk_codegen::read::read(&path, &ReadOptions::default())
    };
    let loaded = load("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>").unwrap();
    assert_eq!(loaded.model.links[1].name, "Ärm");
    assert!(load("<?xml version=\"1.0\"?>").is_err());
}

/// One note of each kind, and none where nothing is strange.
#[test]
fn strange_numbers_are_noted_once() {
    let degrees = LIMIT.replace("\"-1\"", "\"-90\"").replace("\"2\"", "\"180\"");
    let turned = format!("{LIMIT}<origin rpy=\"0 90 0\"/>");
    let far = REAL.replace("0 0 0.1", "0 300 0");
    let drawn = "<visual><geometry><mesh filename=\"a.stl\"/></geometry></visual>";
    let winch = LIMIT.replace("\"2\"", "\"100.5\"");
    let uneven = LIMIT.replace("\"-1\"", "\"-63\"").replace("\"2\"", "\"74.5\"");
    let cases: [(String, &[&str]); 7] = [
        (one_joint("revolute", REAL, LIMIT), &[]),
        (one_joint("revolute", REAL, &uneven), &["looks-like-degrees"]),
        (one_joint("revolute", REAL, &degrees), &["looks-like-degrees"]),
        (one_joint("revolute", REAL, &turned), &["looks-like-degrees"]),
        (one_joint("revolute", REAL, &winch), &[]),
        (one_joint("revolute", &far, LIMIT), &["far-away"]),
        (one_joint("revolute", drawn, LIMIT), &["skipped", "joints-without-inertia", "shape-without-mass"]),
    ];
    for (text, expected) in cases {
        let mut found = codes(&notes(&text)).into_iter().map(str::to_owned).collect::<Vec<_>>();
        let mut expected = expected.to_vec();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "{text}");
    }
}

#[test]
fn legs_on_a_fixed_base_are_noted() {
    let said = |names: &[&str]| {
        let mut text = "<robot name=\"r\"><link name=\"trunk\"/>".to_owned();
        for name in names {
            text += &format!(
                "<link name=\"{name}\">{REAL}</link><joint name=\"to {name}\" type=\"continuous\"><parent link=\"trunk\"/>\
                 <child link=\"{name}\"/></joint>"
            );
        }
        codes(&notes(&(text + "</robot>"))) == ["legs-on-fixed-base"]
    };
    assert!(said(&["LKneePitch", "RKneePitch"]));
    assert!(said(&["FL_calf", "FR_calf", "arm"]));
    assert!(said(&["lf_upperleg", "rf_upperleg"]));
    // A leg on a stand, a hand, a wheeled base.
    assert!(!said(&["left_leg", "arm"]));
    assert!(!said(&["allegro_1", "allegro_2"]));
    assert!(!said(&["base_footprint", "wheel_footprint"]));
}

/// The rate is exact for one joint: D/I = 2000 1/s, so that Runge–Kutta steps diverge beyond 2.785/2000 s.
#[test]
fn stiff_and_jumping_friction_is_noted() {
    let joint =
        |dynamics: &str| one_joint("revolute", REAL, &format!("{LIMIT}{dynamics}<axis xyz=\"0 0 1\"/>"));
    let said = |dynamics: &str, functions: &[&str]| {
        let robot = module(&joint(dynamics), functions);
        robot.notes.entries().to_vec()
    };
    let stiff = said("<dynamics damping=\"2000\"/>", &[]);
    assert_eq!(codes(&stiff), ["stiff-friction"]);
    assert!(stiff[0].message.ends_with("unstable for periods longer than 1.39 ms"), "{}", stiff[0].message);
    assert!(codes(&said("<dynamics damping=\"2000\"/>", &["discretize"])).is_empty());
    assert!(codes(&said("<dynamics damping=\"130\"/>", &[])).is_empty());
    let jumping = said("<dynamics friction=\"0.3\"/>", &[]);
    assert_eq!(codes(&jumping), ["sign-derivative"]);
    assert!(codes(&said("<dynamics friction=\"0.3\"/>", &["forward_dynamics"])).is_empty());
}

/// Some exporters write meshes into the file.
#[test]
fn files_of_many_megabytes_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.urdf");
    let mesh = "0.125 ".repeat(7_000_000);
    let text = one_joint("revolute", REAL, LIMIT);
    let text = text.replace("</robot>", &format!("<gazebo>{mesh}</gazebo></robot>"));
    std::fs::write(&path, text).unwrap();
    let loaded = gelenk_codegen::read::read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(loaded.model.links.len(), 2);
}
