//! Pinocchio's values, and the robots that they belong to.

use std::fmt::Write as _;

use gelenk_codegen::pipeline::GenerateOptions;
use gelenk_codegen::read::ReadOptions;
use gelenk_tests::Robot;
use nalgebra::{Matrix3, UnitQuaternion};
use serde_json::Value;

use super::coordinates::State;

pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().expect("a number")],
    }
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a text")
}

fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().expect("an index")).expect("small")
}

/// A robot of the reference.
pub struct Reference {
    pub robot: Robot,
    /// First position and velocity of Pinocchio's planar joints.
    pub planar: Vec<[usize; 2]>,
    pub samples: Vec<Value>,
    /// Names of the joints.
    pub joints: Vec<String>,
}

/// A joint's type and what goes with it, as a line of the description.
fn kind(joint: &Value) -> String {
    let axis = || format!("axis = {}\n", serde_json::to_string(&joint["axis"]).expect("numbers"));
    match text(&joint["type"]) {
        "FreeFlyer" => "type = \"floating\"\n".to_owned(),
        "Spherical" => "type = \"spherical\"\n".to_owned(),
        "Planar" => "type = \"planar\"\n".to_owned(),
        "HelicalUnaligned" => format!("type = \"helical\"\npitch = {}\n{}", joint["pitch"], axis()),
        "PrismaticUnaligned" => format!("type = \"prismatic\"\n{}", axis()),
        revolute if revolute.starts_with('R') => format!("type = \"revolute\"\n{}", axis()),
        other => panic!("joint type {other}"),
    }
}

/// The description of a reference file.
fn description(name: &str, joints: &[Value], functions: &str) -> String {
    let mut text_of =
        format!("name = \"{name}\"\ngravity = [0, 0, -9.81]\n[generate]\nfunctions = {functions}\n");
    let link = |parent: &Value| match parent.as_i64() {
        Some(-1) => "base".to_owned(),
        _ => text(&joints[index(parent)]["name"]).to_owned(),
    };
    for joint in joints {
        let name = text(&joint["name"]);
        let rotation = Matrix3::from_row_slice(&numbers(&joint["R"]));
        let turn = UnitQuaternion::from_matrix(&rotation);
        let xyz = numbers(&joint["xyz"]);
        let _ = write!(
            text_of,
            "[[joints]]\nname = \"{name}\"\nparent = \"{}\"\n{}drive = \"ideal\"\n\
             origin = {{ xyz = {xyz:?}, quaternion = {{ w = {:?}, x = {:?}, y = {:?}, z = {:?} }} }}\n",
            link(&joint["parent"]),
            kind(joint),
            turn.w,
            turn.i,
            turn.j,
            turn.k,
        );
        let [xx, xy, yy, xz, yz, zz] = <[f64; 6]>::try_from(numbers(&joint["inertia"])).expect("six");
        if joint["mass"].as_f64() == Some(0.0) {
            continue;
        }
        let _ = write!(
            text_of,
            "[[bodies]]\nname = \"{name}_body\"\nlink = \"{name}\"\nmass = {}\ncenter_of_mass = {:?}\n\
             inertia = {{ xx = {xx:?}, xy = {xy:?}, xz = {xz:?}, yy = {yy:?}, yz = {yz:?}, zz = {zz:?} }}\n",
            joint["mass"],
            numbers(&joint["com"]),
        );
    }
    let last = text(&joints.last().expect("a joint")["name"]);
    let _ = write!(
        text_of,
        "[[frames]]\nname = \"last\"\nlink = \"{last}\"\n[[wrenches]]\nname = \"push\"\nframe = \"last\"\nin = \"frame\"\n"
    );
    text_of
}

/// All that are compared, some of them on request alone.
pub const FUNCTIONS: &str = "[\"mass_matrix\", \"coriolis_forces\", \"gravity_forces\", \"bias_forces\", \
    \"equations_of_motion\", \"mass_matrix_and_bias_forces\", \"inverse_dynamics\", \"forward_dynamics\", \
    \"inverse_dynamics_derivatives\", \"inverse_dynamics_derivatives_and_mass_matrix\", \"forward_dynamics_derivatives\", \
    \"linearize\", \"kinetic_energy\", \"potential_energy\", \"inertial_parameters\", \"inertial_regressor\", \
    \"base_regressor\", \"wrench_forces\", \"inverse_dynamics_with_wrenches\", \
    \"inverse_dynamics_derivatives_with_wrenches\", \"joint_wrenches\", \"center_of_mass\", \
    \"center_of_mass_jacobian\", \"centroidal_momentum\", \"centroidal_momentum_matrix\", \"frames\"]";

/// The robot of a reference file, with these functions.
pub fn reference(name: &str, functions: &str) -> Reference {
    let reference = gelenk_tests::reference(&format!("mechanisms/{name}.json"));
    let joints = reference["joints"].as_array().expect("joints").clone();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("robot.toml");
    std::fs::write(&path, description(name, &joints, functions)).expect("a file");
    let options = GenerateOptions {
        reading: ReadOptions { accept_unphysical: true, ..ReadOptions::default() },
        ..GenerateOptions::default()
    };
    let planar = joints.iter().filter(|joint| text(&joint["type"]) == "Planar");
    Reference {
        robot: Robot::derive(&path, &options),
        planar: planar.map(|joint| [index(&joint["idx_q"]), index(&joint["idx_v"])]).collect(),
        joints: joints.iter().map(|joint| text(&joint["name"]).to_owned()).collect(),
        samples: reference["samples"].as_array().expect("samples").clone(),
    }
}

impl Reference {
    pub fn state(&self, sample: &Value) -> State {
        let get = |key: &str| numbers(&sample[key]);
        State::new(get("q"), &self.planar, get("v"), get("a"))
    }
}
