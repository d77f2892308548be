//! Values of robots at seeded states, which `tests/mujoco/compare.py` compares with MuJoCo and Pinocchio.

use std::path::Path;

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{JointKind, JointPosition, Model};
use gelenk_codegen::verify::mass_and_bias;
use serde_json::{Value, json};

use crate::Robot;

/// Number of states of each robot.
const STATES: usize = 4;

/// Options of the comparison of a robot.
#[derive(Debug, Clone, Copy, Default)]
pub struct Compared {
    /// The joints are found by their names, else by their order.
    pub by_name: bool,
    /// Springs and dampers.
    pub passive: bool,
    /// The input matrix.
    pub inputs: bool,
    /// Joints follow others.
    pub couples: bool,
}

/// A robot with its values at seeded states, as the comparison reads them.
///
/// - `file`: the robot in the other format
pub fn values(name: &str, file: &Path, model: &Model, compared: Compared) -> Value {
    let mut model = model.clone();
    // Dry friction is a constraint there.
    for joint in model.links.iter_mut().filter_map(|link| link.joint.as_mut()) {
        joint.friction.retain(|term| term.basis == Formula::Velocity);
        joint.load_friction.clear();
    }
    for drive in &mut model.drives {
        drive.friction.retain(|term| term.basis == Formula::Velocity);
    }
    let mut functions = vec!["mass_matrix", "bias_forces"];
    let of_passive: &[&str] = if compared.passive { &["gravity_forces", "applied_forces"] } else { &[] };
    functions.extend(of_passive);
    functions.extend((compared.inputs && model.inputs().count() > 0).then_some("input_matrix"));
    let robot = Robot::of_model(model, &functions);
    let mut rng = Rng::with_seed(1606);
    let states: Vec<Value> = (0..STATES).map(|_| state(&robot, &functions, &mut rng)).collect();
    entry((name, file), &robot.model, compared, &states)
}

/// As [`values`], with M and the bias forces of the independent evaluation alone: thousands of robots take no derivation.
pub fn independent_values(name: &str, file: &Path, model: &Model) -> Value {
    let mut rng = Rng::with_seed(1606);
    let states = (0..STATES).map(|_| {
        let [y, v] = motion(model, &mut rng);
        let [mass, bias] = mass_and_bias(model, &y, &v);
        json!({ "y": y, "v": v, "mass_matrix": mass, "bias_forces": bias })
    });
    let compared = Compared { by_name: true, couples: true, ..Compared::default() };
    entry((name, file), model, compared, &states.collect::<Vec<_>>())
}

fn entry((name, file): (&str, &Path), model: &Model, compared: Compared, states: &[Value]) -> Value {
    let parameters: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    json!({
        "name": name,
        "file": file,
        "velocities": model.coordinates.len(),
        "gravity": model.gravity.each_ref().map(|g| g.evaluate(&parameters, 0.0, 0.0)),
        "joints": joints(model),
        "inputs": model.inputs().map(|input| input.name().to_owned()).collect::<Vec<_>>(),
        "by_name": compared.by_name,
        "couples": compared.couples,
        "states": states,
    })
}

/// Positions and velocities.
fn motion(model: &Model, rng: &mut Rng) -> [Vec<f64>; 2] {
    let y = positions(model, rng);
    [y, model.coordinates.iter().map(|_| 4.0 * rng.f64() - 2.0).collect()]
}

fn joints(model: &Model) -> Vec<Value> {
    let mut position = 0;
    let joints: Vec<_> = model.joints().collect();
    let entry = |joint: JointPosition<'_>| {
        let (name, kind, velocity, count) = match joint {
            JointPosition::Coordinate(coordinate) => (&joints[coordinate].name, "scalar", coordinate, 1),
            JointPosition::Quaternion(joint) => {
                (&joint.name, joint.kind.name(), joint.first, joint.kind.positions())
            }
        };
        let entry = json!({ "name": name, "kind": kind, "position": position, "velocity": velocity });
        position += count;
        entry
    };
    model.joint_positions().map(entry).collect()
}

fn state(robot: &Robot, functions: &[&str], rng: &mut Rng) -> Value {
    let [y, v] = motion(&robot.model, rng);
    let mut state = json!({ "y": y, "v": v });
    for function in functions {
        let inputs = robot.function(function).program.inputs.iter();
        let inputs: Vec<&[f64]> =
            inputs.map(|input| if input.name == "y" { &y[..] } else { &v[..] }).collect();
        let values = robot.first(function, &inputs);
        state[*function] = json!(values);
        if *function == "applied_forces" {
            let gravity = robot.first("gravity_forces", &[&y]);
            let passive = values.iter().zip(gravity).map(|(all, gravity)| all - gravity);
            state["passive"] = json!(passive.collect::<Vec<_>>());
        }
    }
    state
}

fn positions(model: &Model, rng: &mut Rng) -> Vec<f64> {
    let joints: Vec<_> = model.joints().collect();
    let mut positions = Vec::new();
    for joint in model.joint_positions() {
        let mut between = |size: f64| size * (2.0 * rng.f64() - 1.0);
        match joint {
            JointPosition::Coordinate(coordinate) if joints[coordinate].kind == JointKind::Prismatic => {
                positions.push(between(0.3));
            }
            JointPosition::Coordinate(_) => positions.push(between(2.0)),
            JointPosition::Quaternion(joint) => {
                positions.extend((0..joint.kind.quaternion()).map(|_| between(1.0)));
                let quaternion: [f64; 4] = std::array::from_fn(|_| between(1.0));
                let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
                positions.extend(quaternion.map(|x| x / length));
            }
        }
    }
    positions
}
