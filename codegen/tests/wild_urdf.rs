//! What published URDFs have in them, and what becomes of it.

#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

mod common;

use common::rustc;
use gelenk_codegen::diagnostic::{Diagnostic, Diagnostics, Severity};
use gelenk_codegen::model::{Model, ReadOptions, from_urdf};
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};

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
    let xml = |name: &str| {
        name.replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('"', "&quot;")
    };
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
    let Some(syn::Expr::Array(array)) = value else {
        panic!("{constant} is an array")
    };
    let text = |entry: syn::Expr| match entry {
        syn::Expr::Lit(syn::ExprLit {
            lit: syn::Lit::Str(text),
            ..
        }) => text.value(),
        _ => panic!("{constant} holds texts"),
    };
    array.elems.into_iter().map(text).collect()
}

/// A ROS JointState and a CAN table are matched by these names. Each of them was changed to an identifier, or refused.
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
    for name in [
        "frame_tool_0_pose",
        "frame_tool_0_2_pose",
        "frame_u5148_pose",
    ] {
        assert!(source.contains(&format!("pub fn {name}(")), "{name}");
    }
    let parameters = texts(source, "INERTIAL_PARAMETER_NAMES");
    assert!(
        parameters.contains(&"m_joint_0.0".to_owned()),
        "{parameters:?}"
    );
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
    let robot = module(
        &chain(&["Joint 1"], &["Tool-0", "tool_0", "flange"]),
        &["frames"],
    );
    let notes: Vec<&str> = robot
        .notes
        .entries()
        .iter()
        .filter(|note| note.code == "name-mapped")
        .map(|note| note.message.as_str())
        .collect();
    let expected =
        "names in generated code: \"Tool-0\" → `frame_tool_0_…`, \"tool_0\" → `frame_tool_0_2_…`";
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
        inertial(
            1.33687,
            "0.0185 -0.1108 6.8e-18",
            [0.0, 0.0, 2.40741e-35, 0.0, 0.0, 0.0],
        ),
        inertial(
            0.526,
            "0 0 0.03045",
            [-5.42101e-20, 0.0, 0.0, -5.42101e-20, 0.0, 0.0],
        ),
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
    let plate = fixed.replace("{}", &inertial(-1.0, "0 0 0", [-1.0; 6]));
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
    let text = arm(
        "",
        &inertial(1.0, "0 0 0", [-1.0, 0.0, 0.0, 1.0, 0.0, 1.0]),
        "",
    );
    let problems = read(&text).unwrap_err();
    assert_eq!(problems.error_count(), 1);
    assert!(codes(problems.entries()).contains(&"mass-matrix-not-positive-definite"));
    let options = ReadOptions {
        accept_unphysical: true,
        ..ReadOptions::default()
    };
    let (_, entries) = from_urdf(&text, "r.urdf", &options).unwrap();
    assert!(codes(entries.entries()).contains(&"mass-matrix-not-positive-definite"));
    // The same about an axis that does not turn is no reason to refuse anything.
    let text = arm(
        "",
        &inertial(1.0, "0 0 0", [1.0, 0.0, 0.0, -1.0, 0.0, 1.0]),
        "",
    );
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
    for name in [
        "mass_matrix",
        "inverse_dynamics",
        "inverse_dynamics_derivatives",
        "base_regressor",
    ] {
        assert!(found(name), "{name}");
    }
    assert!(
        robot
            .source
            .text
            .contains("symmetric, positive semidefinite")
    );
    assert!(!robot.source.text.contains("symmetric, positive definite"));
    let lost = [
        "forward_dynamics",
        "forward_dynamics_derivatives",
        "linearize",
    ];
    for name in lost
        .iter()
        .chain(&["discretize", "step", "step_derivatives"])
    {
        assert!(!found(name), "{name}");
    }
    let entries = robot.notes.entries();
    let messages = entries
        .iter()
        .map(|entry| format!("{}: {}", entry.code, entry.message));
    insta::assert_snapshot!(messages.collect::<Vec<_>>().join("\n"));
    for name in ["forward_dynamics", "linearize", "step"] {
        let problems = try_module(&text, &["mass_matrix", name]).unwrap_err();
        assert_eq!(problems.error_count(), 1);
        assert!(
            codes(problems.entries()).contains(&"singular-mass-matrix"),
            "{name}"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let strict = ["--crate-type", "lib", "-D", "warnings"];
    rustc(folder.path(), "finger", &robot.source.text, &strict).unwrap();
}
