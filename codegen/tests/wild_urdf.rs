//! What published URDFs have in them, and what becomes of it.

#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

mod common;

use common::rustc;
use gelenk_codegen::model::{Model, ReadOptions, from_urdf};
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};

/// Reads a URDF whose elements are given; friction stays, mimic joints are independent.
fn model(elements: &str) -> Model {
    let options = ReadOptions {
        ignore_mimic: true,
        ..ReadOptions::default()
    };
    let text = format!("<robot name=\"r\">{elements}</robot>");
    from_urdf(&text, "r.urdf", &options)
        .unwrap_or_else(|wrong| panic!("{wrong}"))
        .0
}

/// The module of a URDF.
fn module(text: &str, functions: &[&str]) -> Generated {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.urdf");
    std::fs::write(&path, text).unwrap();
    let options = GenerateOptions {
        functions: functions.iter().map(|&name| name.to_owned()).collect(),
        ..GenerateOptions::default()
    };
    generate(&path, &options).unwrap_or_else(|wrong| panic!("{wrong}"))
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
