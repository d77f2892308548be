//! Robots with spherical and floating joints against Pinocchio's values, for joints of every type.

use std::fmt::Write as _;

use gelenk_codegen::functions::form::Form;
use gelenk_codegen::pipeline::GenerateOptions;
use gelenk_kernels::manifold;
use gelenk_tests::{Robot, relative_error, shared, workspace};
use nalgebra::{DMatrix, DVector, Matrix3, UnitQuaternion};
use serde_json::Value;

/// Relative to the largest entry of an array.
const VALUES: f64 = 1e-11;
const JACOBIANS: f64 = 1e-10;

fn numbers(value: &Value) -> Vec<f64> {
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

/// A robot of the reference and how its coordinates differ from ours.
struct Reference {
    robot: Robot,
    /// First position and velocity of Pinocchio's planar joints, whose velocities are in the body's frame and whose
    /// angle is given by cosine and sine.
    planar: Vec<[usize; 2]>,
    samples: Vec<Value>,
    /// Names of the joints.
    joints: Vec<String>,
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
fn description(name: &str, joints: &[Value]) -> String {
    let mut text_of =
        format!("name = \"{name}\"\ngravity = [0, 0, -9.81]\n[generate]\nfunctions = {FUNCTIONS}\n");
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
const FUNCTIONS: &str = "[\"mass_matrix\", \"coriolis_forces\", \"gravity_forces\", \"bias_forces\", \
    \"equations_of_motion\", \"mass_matrix_and_bias_forces\", \"inverse_dynamics\", \"forward_dynamics\", \
    \"inverse_dynamics_derivatives\", \"inverse_dynamics_derivatives_and_mass_matrix\", \"forward_dynamics_derivatives\", \
    \"linearize\", \"kinetic_energy\", \"potential_energy\", \"inertial_parameters\", \"inertial_regressor\", \
    \"base_regressor\", \"wrench_forces\", \"inverse_dynamics_with_wrenches\", \
    \"inverse_dynamics_derivatives_with_wrenches\", \"joint_wrenches\", \"center_of_mass\", \
    \"center_of_mass_jacobian\", \"centroidal_momentum\", \"centroidal_momentum_matrix\", \"frames\"]";

fn reference(name: &str) -> Option<Reference> {
    let path = shared()?.join("reference/mechanisms").join(format!("{name}.json"));
    let text_of =
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let reference: Value = serde_json::from_str(&text_of).expect("reference files are JSON");
    let joints = reference["joints"].as_array().expect("joints").clone();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("robot.toml");
    std::fs::write(&path, description(name, &joints)).expect("a file");
    let options = GenerateOptions { accept_unphysical: true, ..GenerateOptions::default() };
    let planar = joints.iter().filter(|joint| text(&joint["type"]) == "Planar");
    Some(Reference {
        robot: Robot::derive(&path, &options),
        planar: planar.map(|joint| [index(&joint["idx_q"]), index(&joint["idx_v"])]).collect(),
        joints: joints.iter().map(|joint| text(&joint["name"]).to_owned()).collect(),
        samples: reference["samples"].as_array().expect("samples").clone(),
    })
}

/// A state in our coordinates, and how Pinocchio's velocities turn into ours.
struct State {
    y: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// `v = P v'` with Pinocchio's velocities.
    p: DMatrix<f64>,
    /// First velocity and angle of each planar joint.
    planar: Vec<(usize, f64)>,
    /// Pinocchio's velocities and accelerations.
    theirs: [DVector<f64>; 2],
}

impl Reference {
    fn state(&self, sample: &Value) -> State {
        let get = |key: &str| DVector::from_vec(numbers(&sample[key]));
        let mut y = numbers(&sample["q"]);
        let n = get("v").len();
        let mut p = DMatrix::identity(n, n);
        let mut rate = DMatrix::zeros(n, n);
        let mut planar = Vec::new();
        for &[position, velocity] in self.planar.iter().rev() {
            let angle = y[position + 3].atan2(y[position + 2]);
            y.splice(position + 2..position + 4, [angle]);
            turn(&mut p, velocity, angle, 1.0);
            turn(&mut rate, velocity, angle + std::f64::consts::FRAC_PI_2, get("v")[velocity + 2]);
            planar.push((velocity, angle));
        }
        let (v, a) = (get("v"), get("a"));
        let ours = (&p * &v, &p * &a + &rate * &v);
        State { y, v: ours.0.as_slice().to_vec(), a: ours.1.as_slice().to_vec(), p, planar, theirs: [v, a] }
    }
}

/// Sets a block of two rows to a rotation times a factor.
fn turn(matrix: &mut DMatrix<f64>, first: usize, angle: f64, factor: f64) {
    let (sine, cosine) = angle.sin_cos();
    matrix[(first, first)] = cosine * factor;
    matrix[(first, first + 1)] = -sine * factor;
    matrix[(first + 1, first)] = sine * factor;
    matrix[(first + 1, first + 1)] = cosine * factor;
}

impl State {
    fn len(&self) -> usize {
        self.v.len()
    }

    fn matrix(&self, flat: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.len(), flat.len() / self.len(), flat)
    }

    fn forces(&self, ours: &[f64]) -> DVector<f64> {
        self.p.transpose() * DVector::from_column_slice(ours)
    }

    /// Derivatives of P x along Pinocchio's tangent, which only the planar joints' angles change.
    fn by_angle(&self, x: &DVector<f64>, quarter_turns: f64) -> DMatrix<f64> {
        let n = self.len();
        let mut result = DMatrix::zeros(n, n);
        for &(first, angle) in &self.planar {
            let mut turned = DMatrix::zeros(n, n);
            turn(&mut turned, first, angle + quarter_turns * std::f64::consts::FRAC_PI_2, 1.0);
            let column = &turned * x;
            result.column_mut(first + 2).copy_from(&column);
        }
        result
    }

    /// Pinocchio's Jacobians of `Pᵀ f(y, P v', P a' + Ṗ v')` from ours of f.
    fn jacobians(&self, forces: &[f64], by_y: &[f64], by_v: &[f64], mass: &[f64]) -> [DMatrix<f64>; 2] {
        let [v, a] = &self.theirs;
        let [by_y, by_v, mass] = [by_y, by_v, mass].map(|flat| self.matrix(flat));
        let n = self.len();
        let velocities = self.by_angle(v, 1.0);
        let mut spins = DMatrix::zeros(n, n);
        let mut by_velocity = DMatrix::zeros(n, n);
        for &(first, angle) in &self.planar {
            let mut one = DMatrix::zeros(n, n);
            turn(&mut one, first, angle + std::f64::consts::FRAC_PI_2, 1.0);
            // Ṗ = ω P', and P'' = −P in the block.
            spins.column_mut(first + 2).copy_from(&(&one * v));
            by_velocity += &one * v[first + 2];
        }
        let accelerations = self.by_angle(a, 1.0) + {
            let mut second = self.by_angle(v, 2.0);
            for &(first, _) in &self.planar {
                let scaled = second.column(first + 2) * v[first + 2];
                second.column_mut(first + 2).copy_from(&scaled);
            }
            second
        };
        let mut position =
            self.p.transpose() * (&by_y * &self.p + &by_v * velocities + &mass * accelerations);
        for &(first, angle) in &self.planar {
            let mut one = DMatrix::zeros(n, n);
            turn(&mut one, first, angle + std::f64::consts::FRAC_PI_2, 1.0);
            let turned = one.transpose() * DVector::from_column_slice(forces);
            let column = position.column(first + 2) + turned;
            position.column_mut(first + 2).copy_from(&column);
        }
        let velocity = self.p.transpose() * (&by_v * &self.p + &mass * (by_velocity + spins));
        [position, velocity]
    }
}

fn check(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let error = relative_error(found, expected);
    assert!(error <= tolerance, "{what}: relative error {error:e}");
}

fn rows(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.transpose().as_slice().to_vec()
}

fn agrees_with_pinocchio(name: &str) {
    let Some(reference) = reference(name) else { return };
    let robot = &reference.robot;
    for (number, sample) in reference.samples.iter().enumerate() {
        let get = |key: &str| numbers(&sample[key]);
        let what = |key: &str| format!("{name} {number} {key}");
        let state = reference.state(sample);
        let State { y, v, a, p, .. } = &state;
        let square = |flat: &[f64]| rows(&(p.transpose() * state.matrix(flat) * p));
        let forces = |ours: &[f64]| state.forces(ours).as_slice().to_vec();
        // At Pinocchio's accelerations 0 ours are not 0 where a planar joint turns.
        let still = State { a: vec![0.0; v.len()], ..reference.state(sample) };
        let steady = {
            let mut sample = sample.clone();
            sample["a"] = serde_json::json!(still.a);
            reference.state(&sample).a
        };
        check(&what("M"), &square(&robot.first("mass_matrix", &[y])), &get("M"), VALUES);
        let nle = forces(&robot.first("inverse_dynamics", &[y, v, &steady]));
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
        let swept = &jacobian * DVector::from_column_slice(&steady) + DVector::from_vec(rate);
        check(&what("Jdot_v"), swept.as_slice(), &get("Jdot_v"), VALUES);
        reactions_agree(&reference, &state, sample, &what);
        forward_dynamics_agree(&reference, &state, sample, &steady, &what);
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
        jacobians_agree(&reference, &state, sample, &what);
    }
}

/// What passes through each joint; a planar one passes it on to its last part.
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

fn forward_dynamics_agree(
    reference: &Reference,
    state: &State,
    sample: &Value,
    steady: &[f64],
    what: &dyn Fn(&str) -> String,
) {
    let get = |key: &str| numbers(&sample[key]);
    let u = &state.p * DVector::from_vec(get("tau"));
    let inputs: [&[f64]; 3] = [&state.y, &state.v, u.as_slice()];
    let ours = DVector::from_vec(reference.robot.first("forward_dynamics", &inputs));
    let theirs = state.p.transpose() * (&ours - DVector::from_column_slice(steady));
    check(&what("fd"), theirs.as_slice(), &get("fd"), VALUES);
    if !reference.planar.is_empty() {
        return;
    }
    let all = reference.robot.call("forward_dynamics_derivatives", &inputs);
    check(&what("fd of all"), &all[0], &get("fd"), VALUES);
    check(&what("dfd_dq"), &all[1], &get("dfd_dq"), JACOBIANS);
    check(&what("dfd_dv"), &all[2], &get("dfd_dv"), JACOBIANS);
    let linear = reference.robot.call("linearize", &inputs);
    check(&what("A_y"), &linear[0], &get("dfd_dq"), JACOBIANS);
    check(&what("A_v"), &linear[1], &get("dfd_dv"), JACOBIANS);
    let known = state.matrix(&linear[1]) * DVector::from_column_slice(&state.v)
        + state.matrix(&linear[2]) * &u
        + DVector::from_column_slice(&linear[3]);
    check(&what("A_v v + B u + c"), known.as_slice(), &get("fd"), 1e-8);
}

fn jacobians_agree(reference: &Reference, state: &State, sample: &Value, what: &dyn Fn(&str) -> String) {
    let robot = &reference.robot;
    let State { y, v, a, .. } = state;
    let get = |key: &str| numbers(&sample[key]);
    inverse_jacobians_agree(robot, state, sample, what);
    let wrench = get("wrench");
    let all = robot.call("inverse_dynamics_derivatives_with_wrenches", &[y, v, a, &wrench]);
    let mass = robot.first("mass_matrix", &[y]);
    let [by_q, _] = state.jacobians(&all[0], &all[1], &all[2], &mass);
    check(&what("did_dq_wrench"), &rows(&by_q), &get("did_dq_wrench"), JACOBIANS);
}

fn inverse_jacobians_agree(robot: &Robot, state: &State, sample: &Value, what: &dyn Fn(&str) -> String) {
    let State { y, v, a, .. } = state;
    let get = |key: &str| numbers(&sample[key]);
    let all = robot.call("inverse_dynamics_derivatives_and_mass_matrix", &[y, v, a]);
    let [by_q, by_v] = state.jacobians(&all[0], &all[1], &all[2], &all[3]);
    check(&what("did_dq"), &rows(&by_q), &get("did_dq"), JACOBIANS);
    check(&what("did_dv"), &rows(&by_v), &get("did_dv"), JACOBIANS);
}

/// Jacobians as loops over joints.
fn loops_agree_with_pinocchio(name: &str) {
    let Some(reference) = reference(name) else { return };
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
        let still = {
            let mut sample = sample.clone();
            sample["a"] = serde_json::json!(vec![0.0; state.v.len()]);
            reference.state(&sample).a
        };
        inverse_jacobians_agree(&reference.robot, &state, sample, &what);
        forward_dynamics_agree(&reference, &state, sample, &still, &what);
    }
}

#[test]
fn loops_over_joints_agree_with_pinocchio() {
    for name in ["go2_floating", "iris_floating", "zoo_1", "zoo_2"] {
        loops_agree_with_pinocchio(name);
    }
}

#[test]
fn a_quadruped_agrees_with_pinocchio() {
    agrees_with_pinocchio("go2_floating");
}

#[test]
fn a_quadrotor_agrees_with_pinocchio() {
    agrees_with_pinocchio("iris_floating");
}

#[test]
fn joints_of_every_type_agree_with_pinocchio() {
    agrees_with_pinocchio("zoo_1");
    agrees_with_pinocchio("zoo_2");
}

/// `cargo test -p gelenk-tests --test quaternions -- --ignored`
#[test]
#[ignore = "the same for more robots takes some twenty seconds more"]
fn more_robots_agree_with_pinocchio() {
    for name in ["solo12_floating", "zoo_3", "zoo_4"] {
        agrees_with_pinocchio(name);
        loops_agree_with_pinocchio(name);
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
