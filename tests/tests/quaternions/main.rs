//! Robots with spherical and floating joints against Pinocchio's values, for joints of every type.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

mod coordinates;
mod layouts;
mod reference;

use coordinates::State;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::function::ConstantValue;
use gelenk_codegen::pipeline::GenerateOptions;
use gelenk_generated::go2;
use gelenk_kernels::manifold;
use gelenk_tests::{Robot, relative_error, workspace};
use nalgebra::{DMatrix, DVector, DVectorView};
use reference::{FUNCTIONS, Reference, numbers, reference};
use serde_json::Value;

/// Relative to the largest entry of an array.
const VALUES: f64 = 1e-11;
const JACOBIANS: f64 = 1e-10;

fn check(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let error = relative_error(found, expected);
    assert!(error <= tolerance, "{what}: relative error {error:e}");
}

fn rows(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.transpose().as_slice().to_vec()
}

fn agrees_with_pinocchio(name: &str) {
    let reference = reference(name, FUNCTIONS);
    let robot = &reference.robot;
    for (number, sample) in reference.samples.iter().enumerate() {
        let get = |key: &str| numbers(&sample[key]);
        let what = |key: &str| format!("{name} {number} {key}");
        let state = reference.state(sample);
        let State { y, v, a, p, steady, .. } = &state;
        let square = |flat: &[f64]| rows(&(p.transpose() * state.matrix(flat) * p));
        let forces = |ours: &[f64]| state.forces(ours).as_slice().to_vec();
        check(&what("M"), &square(&robot.first("mass_matrix", &[y])), &get("M"), VALUES);
        let nle = forces(&robot.first("inverse_dynamics", &[y, v, steady]));
        check(&what("nle"), &nle, &get("nle"), VALUES);
        let gravity: Vec<f64> = forces(&robot.first("gravity_forces", &[y])).iter().map(|x| -x).collect();
        check(&what("g"), &gravity, &get("g"), VALUES);
        let id = forces(&robot.first("inverse_dynamics", &[y, v, a]));
        check(&what("id"), &id, &get("id"), VALUES);
        let wrench = get("wrench");
        let pushed = forces(&robot.first("inverse_dynamics_with_wrenches", &[y, v, a, &wrench]));
        check(&what("id_wrench"), &pushed, &get("id_wrench"), VALUES);
        check(&what("kinetic"), &robot.first("kinetic_energy", &[y, v]), &get("kinetic"), VALUES);
        check(&what("potential"), &robot.first("potential_energy", &[y]), &get("potential"), VALUES);
        check(&what("p"), &robot.call("frame_last_pose", &[y])[0], &get("p"), VALUES);
        check(&what("R"), &robot.call("frame_last_pose", &[y])[1], &get("R"), VALUES);
        let jacobian = DMatrix::from_row_slice(6, v.len(), &robot.first("frame_last_jacobian", &[y]));
        check(&what("J"), &rows(&(&jacobian * p)), &get("J"), VALUES);
        let rate = robot.first("frame_last_jacobian_rate_times_velocity", &[y, v]);
        let swept = &jacobian * DVector::from_column_slice(steady) + DVector::from_vec(rate);
        check(&what("Jdot_v"), swept.as_slice(), &get("Jdot_v"), VALUES);
        reactions_agree(&reference, &state, sample, &what);
        forward_dynamics_agree(&reference.robot, &state, sample, &what);
        check(&what("com"), &robot.first("center_of_mass", &[y]), &get("com"), VALUES);
        let jacobian = DMatrix::from_row_slice(3, v.len(), &robot.first("center_of_mass_jacobian", &[y]));
        check(&what("Jcom"), &rows(&(jacobian * p)), &get("Jcom"), VALUES);
        check(&what("momentum"), &robot.first("centroidal_momentum", &[y, v]), &get("momentum"), VALUES);
        let matrix = DMatrix::from_row_slice(6, v.len(), &robot.first("centroidal_momentum_matrix", &[y]));
        let momentum = matrix * DVector::from_column_slice(v);
        check(&what("A v"), momentum.as_slice(), &get("momentum"), VALUES);
        let bias = robot.call("mass_matrix_and_bias_forces", &[y, v]);
        check(&what("M of both"), &square(&bias[0]), &get("M"), VALUES);
        let regressor = robot.first("inertial_regressor", &[y, v, a]);
        let parameters = DVector::from_vec(robot.first("inertial_parameters", &[]));
        let of_parameters = state.matrix(&regressor) * parameters;
        check(&what("W π"), &forces(of_parameters.as_slice()), &get("id"), VALUES);
        parts_agree(&reference, &state, sample, &what);
        jacobians_agree(&reference, &state, sample, &what);
    }
}

/// Functions that are parts of others, or put them together. Nothing but gravity and the wrench is applied.
fn parts_agree(reference: &Reference, state: &State, sample: &Value, what: &dyn Fn(&str) -> String) {
    let robot = &reference.robot;
    let State { y, v, a, .. } = state;
    let forces = |ours: &[f64]| state.forces(ours).as_slice().to_vec();
    let column = |x: &[f64]| DVector::from_column_slice(x);
    let get = |key: &str| column(&numbers(&sample[key]));
    // Pinocchio's accelerations 0 are ours of planar joints that turn.
    let steady = state.matrix(&robot.first("mass_matrix", &[y])) * column(&state.steady);
    let from_rest = |ours: &[f64]| forces((column(ours) + &steady).as_slice());
    let (nle, g) = (get("nle"), get("g"));
    let coriolis = robot.first("coriolis_forces", &[y, v]);
    check(&what("coriolis"), &from_rest(&coriolis), (&nle - &g).as_slice(), VALUES);
    check(&what("bias"), &from_rest(&robot.first("bias_forces", &[y, v])), nle.as_slice(), VALUES);
    let both = robot.call("mass_matrix_and_bias_forces", &[y, v]);
    check(&what("bias of both"), &from_rest(&both[1]), nle.as_slice(), VALUES);
    let all = robot.call("equations_of_motion", &[y, v]);
    check(&what("M of all"), &all[0], &robot.first("mass_matrix", &[y]), VALUES);
    check(&what("k of all"), &from_rest(&all[1]), (&nle - &g).as_slice(), VALUES);
    check(&what("q of all"), &forces(&all[2]), (-g).as_slice(), VALUES);
    let pushed = forces(&robot.first("wrench_forces", &[y, &numbers(&sample["wrench"])]));
    check(&what("wrench forces"), &pushed, (get("id") - get("id_wrench")).as_slice(), VALUES);
    let regressor = state.matrix(&robot.first("inertial_regressor", &[y, v, a]));
    base_regressor_agrees(robot, &regressor, &robot.first("base_regressor", &[y, v, a]), what);
}

/// `W_b (K π) = W π`, and the columns of `W_b` are columns of W.
fn base_regressor_agrees(
    robot: &Robot,
    regressor: &DMatrix<f64>,
    base: &[f64],
    what: &dyn Fn(&str) -> String,
) {
    let constants = &robot.function("base_regressor").constants;
    let terms = constants.iter().find_map(|constant| match &constant.value {
        ConstantValue::Sparse(terms) => Some(terms),
        _ => None,
    });
    let parameters = robot.first("inertial_parameters", &[]);
    let count = base.len() / regressor.nrows();
    let base = DMatrix::from_row_slice(regressor.nrows(), count, base);
    let mut independent = DVector::zeros(count);
    for &(row, column, factor) in terms.expect("the map of the base parameters") {
        independent[row] += factor * parameters[column];
    }
    let expected = regressor * DVector::from_vec(parameters);
    check(
        &what("W π of the base parameters"),
        (&base * independent).as_slice(),
        expected.as_slice(),
        JACOBIANS,
    );
    for column in base.column_iter() {
        let is_one = |other: DVectorView<'_, f64>| (other - column).amax() <= VALUES * column.amax();
        assert!(
            regressor.column_iter().any(is_one),
            "{}",
            what("a column of the base regressor is one of W")
        );
    }
}

/// Compares the wrench through each joint; a planar joint passes it on to its last part.
fn reactions_agree(reference: &Reference, state: &State, sample: &Value, what: &dyn Fn(&str) -> String) {
    let model = &reference.robot.model;
    let ours = reference.robot.first("joint_wrenches", &[&state.y, &state.v, &state.a]);
    let names: Vec<&str> = model.carrying_joints().iter().map(|joint| joint.name).collect();
    assert_eq!(ours.len(), 6 * names.len());
    let theirs = sample["reactions"].as_array().expect("one for each joint");
    for (name, theirs) in reference.joints.iter().zip(theirs) {
        let last = format!("{name}_theta");
        let row = names.iter().position(|ours| ours == name || **ours == last).expect("the joint");
        check(&what(&format!("reaction at {name}")), &ours[6 * row..6 * row + 6], &numbers(theirs), VALUES);
    }
}

fn forward_dynamics_agree(robot: &Robot, state: &State, sample: &Value, what: &dyn Fn(&str) -> String) {
    let get = |key: &str| numbers(&sample[key]);
    let torques = DVector::from_vec(get("tau"));
    let u = &state.p * &torques;
    let inputs: [&[f64]; 3] = [&state.y, &state.v, u.as_slice()];
    let ours = robot.first("forward_dynamics", &inputs);
    check(&what("fd"), state.accelerations(&ours).as_slice(), &get("fd"), VALUES);
    let all = robot.call("forward_dynamics_derivatives", &inputs);
    check(&what("fd of all"), state.accelerations(&all[0]).as_slice(), &get("fd"), VALUES);
    let linear = robot.call("linearize", &inputs);
    for (name, [by_y, by_v, by_u]) in
        [("", [&all[1], &all[2], &all[3]]), (" of A", [&linear[0], &linear[1], &linear[2]])]
    {
        // All drives are ideal: u are the forces.
        let [by_q, by_v] = state.forward_jacobians([&ours, by_y, by_v, by_u], &torques);
        check(&what(&format!("dfd_dq{name}")), &rows(&by_q), &get("dfd_dq"), JACOBIANS);
        check(&what(&format!("dfd_dv{name}")), &rows(&by_v), &get("dfd_dv"), JACOBIANS);
    }
    let known = state.matrix(&linear[1]) * DVector::from_column_slice(&state.v)
        + state.matrix(&linear[2]) * &u
        + DVector::from_column_slice(&linear[3]);
    check(&what("A_v v + B u + c"), known.as_slice(), &ours, 1e-8);
}

fn jacobians_agree(reference: &Reference, state: &State, sample: &Value, what: &dyn Fn(&str) -> String) {
    let robot = &reference.robot;
    let State { y, v, a, .. } = state;
    let get = |key: &str| numbers(&sample[key]);
    inverse_jacobians_agree(robot, state, sample, what);
    let wrench = get("wrench");
    let all = robot.call("inverse_dynamics_derivatives_with_wrenches", &[y, v, a, &wrench]);
    let mass = robot.first("mass_matrix", &[y]);
    let [by_q, _] = state.inverse_jacobians([&all[0], &all[1], &all[2], &mass]);
    check(&what("did_dq_wrench"), &rows(&by_q), &get("did_dq_wrench"), JACOBIANS);
}

fn inverse_jacobians_agree(robot: &Robot, state: &State, sample: &Value, what: &dyn Fn(&str) -> String) {
    let State { y, v, a, .. } = state;
    let get = |key: &str| numbers(&sample[key]);
    let all = robot.call("inverse_dynamics_derivatives_and_mass_matrix", &[y, v, a]);
    let [by_q, by_v] = state.inverse_jacobians([&all[0], &all[1], &all[2], &all[3]]);
    check(&what("did_dq"), &rows(&by_q), &get("did_dq"), JACOBIANS);
    check(&what("did_dv"), &rows(&by_v), &get("did_dv"), JACOBIANS);
}

/// Jacobians as loops over joints.
fn loops_agree_with_pinocchio(name: &str) {
    let reference = reference(name, "[\"mass_matrix\"]");
    let derivatives = [
        "inverse_dynamics_derivatives_and_mass_matrix",
        "forward_dynamics",
        "forward_dynamics_derivatives",
        "linearize",
    ];
    let robot = Robot::in_form(reference.robot.model.clone(), &derivatives, Form::Arrays);
    for name in derivatives {
        assert!(name == "forward_dynamics" || robot.function(name).arrays.is_some(), "{name}");
    }
    let reference = Reference { robot, ..reference };
    for (number, sample) in reference.samples.iter().enumerate() {
        let what = |key: &str| format!("{name} {number} {key} by loops");
        let state = reference.state(sample);
        inverse_jacobians_agree(&reference.robot, &state, sample, &what);
        forward_dynamics_agree(&reference.robot, &state, sample, &what);
    }
}

#[test]
fn loops_over_joints_agree_with_pinocchio() {
    for name in ["go2_floating", "solo12_floating", "iris_floating", "zoo_1", "zoo_2", "zoo_3", "zoo_4"] {
        loops_agree_with_pinocchio(name);
    }
}

/// A field that nobody asks for would pass unseen. Those of ⊕ are compared in `codegen/tests/manifold/pinocchio.rs`.
#[test]
fn every_field_is_asked_for() {
    let [values, states, positions] = [
        include_str!("main.rs"),
        include_str!("reference.rs"),
        include_str!("../../../codegen/tests/manifold/pinocchio.rs"),
    ];
    for name in ["go2_floating", "solo12_floating", "iris_floating", "zoo_1", "zoo_2", "zoo_3", "zoo_4"] {
        let Reference { samples, .. } = reference(name, "[\"mass_matrix\"]");
        assert!(!samples.is_empty(), "{name}");
        for key in samples.iter().flat_map(|sample| sample.as_object().expect("fields").keys()) {
            let asked = [format!("get(\"{key}\")"), format!("sample[\"{key}\"]")];
            let here = asked.iter().any(|asked| values.contains(asked) || states.contains(asked));
            assert!(here || positions.contains(&format!("\"{key}\"")), "{name}: nothing compares {key}");
        }
    }
}

#[test]
fn quadrupeds_agree_with_pinocchio() {
    agrees_with_pinocchio("go2_floating");
    agrees_with_pinocchio("solo12_floating");
}

/// `models/go2.toml` is written by hand; the reference was made from Unitree's URDF.
#[test]
fn the_described_go2_is_that_of_unitree() {
    let Reference { samples, .. } = reference("go2_floating", "[\"mass_matrix\"]");
    let functions = ["mass_matrix", "inverse_dynamics"].map(str::to_owned).into();
    let options = GenerateOptions { functions, ..GenerateOptions::default() };
    let robot = Robot::derive(&workspace().join("models/go2.toml"), &options);
    for (number, sample) in samples.iter().enumerate() {
        let get = |key: &str| numbers(&sample[key]);
        let what = |key: &str| format!("go2.toml {number} {key}");
        let (y, v, a) = (get("q"), get("v"), get("a"));
        check(&what("M"), &robot.first("mass_matrix", &[&y]), &get("M"), VALUES);
        check(&what("id"), &robot.first("inverse_dynamics", &[&y, &v, &a]), &get("id"), VALUES);
        check(&what("nle"), &robot.first("inverse_dynamics", &[&y, &v, &[0.0; go2::N]]), &get("nle"), VALUES);
        generated_go2_agrees(sample, &what);
    }
}

/// The generated functions. Pinocchio's forces on the base are a wrench on its origin, in the axes of the base.
fn generated_go2_agrees(sample: &Value, what: &dyn Fn(&str) -> String) {
    let get = |key: &str| numbers(&sample[key]);
    let y: [f64; go2::NY] = get("q").try_into().expect("positions");
    let [v, a, tau] = ["v", "a", "tau"].map(|key| <[f64; go2::N]>::try_from(get(key)).expect("a vector"));
    let mut wrenches = [[0.0; 6]; go2::WRENCHES];
    let forces = go2::inverse_dynamics_with_wrenches(&y, &v, &a, &wrenches);
    check(&what("generated id"), &forces, &get("id"), VALUES);
    let (_, axes) = go2::frame_middle_pose(&y);
    let pushed = |i: usize| (0..3).map(|c| axes[i % 3][c] * tau[i / 3 * 3 + c]).sum();
    wrenches[4] = std::array::from_fn(pushed);
    let (_, torques) = tau.split_last_chunk().expect("torques of the joints");
    let accelerations = go2::forward_dynamics_with_wrenches(&y, &v, torques, &wrenches);
    check(&what("generated fd"), &accelerations, &get("fd"), VALUES);
}

#[test]
fn a_quadrotor_agrees_with_pinocchio() {
    agrees_with_pinocchio("iris_floating");
}

#[test]
fn joints_of_every_type_agree_with_pinocchio() {
    for name in ["zoo_1", "zoo_2", "zoo_3", "zoo_4"] {
        agrees_with_pinocchio(name);
    }
}

/// The Hessian of `δ ↦ λᵀ f(y ⊕ δ)`: the chart's gradient is the right Jacobian of ⊕, transposed, times that along small
/// motions.
#[test]
fn hessians_are_those_of_the_chart() {
    const J: usize = 5;
    const N: usize = 12;
    const NY: usize = 14;
    const H: f64 = 1e-5;
    let path = workspace().join("models/satellite.toml");
    let options = GenerateOptions {
        functions: ["inverse_dynamics_hessian", "inverse_dynamics_derivatives"].map(str::to_owned).into(),
        ..GenerateOptions::default()
    };
    let robot = Robot::derive(&path, &options);
    let widths: [usize; J] = [7, 1, 1, 1, 4];
    let numbers = |scale: f64| -> [f64; N] { std::array::from_fn(|k| scale * (1.0 + k as f64).sin()) };
    let (v, a, multipliers) = (numbers(0.8), numbers(-1.3), numbers(0.6));
    let y: [f64; NY] = manifold::integrate(&widths, &manifold::neutral(&widths), &numbers(1.1));
    let hessian = robot.first("inverse_dynamics_hessian", &[&y, &v, &a, &multipliers]);
    let gradient = |d: &[f64; N]| {
        let moved: [f64; NY] = manifold::integrate(&widths, &y, d);
        let by_y = &robot.call("inverse_dynamics_derivatives", &[&moved, &v, &a])[1];
        let (_, tangent) = manifold::integrate_derivatives(&widths, d);
        let along = DMatrix::from_row_slice(N, N, by_y).transpose() * DVector::from_row_slice(&multipliers);
        let tangent = DMatrix::from_row_slice(N, N, tangent.as_flattened());
        tangent.transpose() * along
    };
    for k in 0..N {
        let at = |size: f64| gradient(&std::array::from_fn(|i| if i == k { size } else { 0.0 }));
        let expected = (at(H) - at(-H)) / (2.0 * H);
        let found: Vec<f64> = (0..N).map(|i| hessian[i * N + k]).collect();
        check(&format!("H_yy {k}"), &found, expected.as_slice(), 1e-7);
    }
}
