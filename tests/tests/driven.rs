//! Robots with driven joints: random ones against Lagrange's equations of all joints, by dual numbers, and one against
//! Pinocchio's values.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::sync::OnceLock;

use fastrand::Rng;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_tests::dual::evaluate;
use gelenk_tests::oracle::Oracle;
use gelenk_tests::random_model::{Sample, random_driven_model, random_sample};
use gelenk_tests::{Robot, relative_error, workspace};
use nalgebra::{DMatrix, DVector};
use num_dual::Dual64;
use serde_json::Value;

/// Relative to what is summed.
const TOLERANCE: f64 = 1e-11;

const FUNCTIONS: [&str; 34] = [
    "mass_matrix",
    "coriolis_forces",
    "gravity_forces",
    "spring_forces",
    "friction_torques",
    "applied_forces",
    "bias_forces",
    "input_matrix",
    "equations_of_motion",
    "mass_matrix_and_bias_forces",
    "inverse_dynamics",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "forward_dynamics_derivatives",
    "linearize",
    "kinetic_energy",
    "potential_energy",
    "inertial_parameters",
    "inertial_regressor",
    "base_regressor",
    "friction_parameters",
    "friction_regressor",
    "wrench_forces",
    "inverse_dynamics_with_wrenches",
    "forward_dynamics_with_wrenches",
    "inverse_dynamics_derivatives_with_wrenches",
    "forward_dynamics_derivatives_with_wrenches",
    "center_of_mass",
    "center_of_mass_jacobian",
    "driving_forces",
    "joint_wrenches",
    "inverse_dynamics_hessian",
    "frames",
];

/// A robot in one state.
struct Case<'a> {
    robot: &'a Robot,
    state: Sample,
    /// Position, velocity and acceleration of each driven joint.
    d: Vec<f64>,
    /// Positions, velocities and accelerations of all coordinates, driven ones last.
    all: [Vec<f64>; 3],
    size: f64,
}

impl<'a> Case<'a> {
    fn new(robot: &'a Robot, rng: &mut Rng) -> Self {
        let state = random_sample(rng, &robot.model);
        let d: Vec<f64> = (0..3 * robot.model.driven.len()).map(|_| 3.0 * rng.f64() - 1.5).collect();
        let whole =
            |own: &[f64], part: usize| own.iter().chain(d.iter().skip(part).step_by(3)).copied().collect();
        let all = [whole(&state.y, 0), whole(&state.v, 1), whole(&state.a, 2)];
        let mut case = Self { robot, state, d, all, size: 0.0 };
        case.size = case.forces().iter().map(|x| x.abs()).sum::<f64>() + case.magnitude();
        case
    }

    /// Sum of the magnitudes of the terms: M times velocities and accelerations, springs, friction, gravity.
    fn magnitude(&self) -> f64 {
        let ([y, v, a], oracle) = (&self.all, self.oracle());
        let sum = |x: &[f64]| x.iter().map(|x| x.abs()).sum::<f64>();
        let mass = oracle.mass_matrix(y).iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let own = [oracle.gravity_forces(y), oracle.spring_forces(y, v), oracle.friction_torques(y, v)];
        mass * (sum(a) + sum(v).powi(2)) + own.iter().map(|x| sum(x)).sum::<f64>()
    }

    fn oracle(&self) -> Oracle<'_> {
        Oracle { model: &self.robot.model, parameters: &self.state.parameters }
    }

    fn n(&self) -> usize {
        self.state.y.len()
    }

    /// M ÿ + k − q of all joints, by Lagrange's equations.
    fn forces(&self) -> Vec<f64> {
        let ([y, v, a], oracle) = (&self.all, self.oracle());
        let mut forces = oracle.inertial_forces(y, v, a);
        let acting = [oracle.gravity_forces(y), oracle.spring_forces(y, v)];
        for (force, rubs) in forces.iter_mut().zip(oracle.friction_torques(y, v)) {
            *force += rubs;
        }
        for of in acting {
            forces.iter_mut().zip(of).for_each(|(force, of)| *force -= of);
        }
        forces
    }

    /// The arguments of a function by their names.
    fn arguments(&self, name: &str) -> Vec<Vec<f64>> {
        let argument = |input: &str| match input {
            "y" => self.state.y.clone(),
            "v" => self.state.v.clone(),
            "a" => self.state.a.clone(),
            "u" => self.state.u.clone(),
            "w" => (0..6 * self.robot.model.wrenches.len()).map(|k| (k as f64).sin()).collect(),
            "lambda" => (0..self.n()).map(|k| (k as f64).cos()).collect(),
            "d" => self.d.clone(),
            other => panic!("{name} takes {other}"),
        };
        self.robot.function(name).program.inputs.iter().map(|input| argument(&input.name)).collect()
    }

    fn call(&self, name: &str) -> Vec<Vec<f64>> {
        self.call_with(name, &self.arguments(name))
    }

    fn call_with(&self, name: &str, arguments: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let arguments: Vec<&[f64]> = arguments.iter().map(Vec::as_slice).collect();
        self.robot.call_with(name, &arguments, &self.state.parameters)
    }

    /// Derivative of the first result by an argument, rows first.
    fn slope(&self, name: &str, by: &str) -> Vec<f64> {
        self.slope_of(name, 0, by)
    }

    fn slope_of(&self, name: &str, result: usize, by: &str) -> Vec<f64> {
        let program = &self.robot.function(name).program;
        let arguments = self.arguments(name);
        let moved = program.inputs.iter().position(|input| input.name == by).expect("the argument");
        let column = |j: usize| {
            let dual = |k: usize, values: &Vec<f64>| -> Vec<Dual64> {
                let rate = |i: usize| f64::from(u8::from(k == moved && i == j));
                values.iter().enumerate().map(|(i, &x)| Dual64::new(x, rate(i))).collect()
            };
            let inputs: Vec<Vec<Dual64>> =
                arguments.iter().enumerate().map(|(k, values)| dual(k, values)).collect();
            let inputs: Vec<&[Dual64]> = inputs.iter().map(Vec::as_slice).collect();
            let results = evaluate(program, &inputs, &self.state.parameters);
            results[result].iter().map(|x| x.eps).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..arguments[moved].len()).map(column).collect();
        (0..columns[0].len()).flat_map(|i| columns.iter().map(move |column| column[i])).collect()
    }

    fn close(&self, what: &str, found: &[f64], expected: &[f64], size: f64) {
        assert_eq!(found.len(), expected.len(), "{what}");
        for (a, b) in found.iter().zip(expected) {
            let error = (a - b).abs() / size.max(f64::MIN_POSITIVE);
            assert!(error <= TOLERANCE, "{what}: {a:e} for {b:e}, {error:.1e} of {size:.1e}");
        }
    }
}

const SEEDS: std::ops::Range<u64> = 4000..4008;

static ROBOTS: [OnceLock<Robot>; 8] = [const { OnceLock::new() }; 8];

/// Runs a check on all random robots, in two states. Each is derived once for all tests.
fn on_all(check: impl Fn(&Case<'_>)) {
    for (seed, robot) in SEEDS.zip(&ROBOTS) {
        let robot = robot.get_or_init(|| Robot::of_model(random_driven_model(seed, 7), &FUNCTIONS));
        let mut rng = Rng::with_seed(seed);
        for _ in 0..2 {
            check(&Case::new(robot, &mut rng));
        }
    }
}

/// The first `n` rows and columns.
fn block(matrix: &[f64], n: usize) -> Vec<f64> {
    let all = (matrix.len() as f64).sqrt() as usize;
    matrix.chunks(all).take(n).flat_map(|row| &row[..n]).copied().collect()
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn plus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// Rows first, with as many columns as x has entries.
fn times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix.chunks(x.len()).map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most, x| most.max(x.abs()))
}

#[test]
fn forces_are_rows_of_lagranges_equations_of_all_joints() {
    on_all(|case| {
        let ([y, v, _], n, oracle) = (&case.all, case.n(), case.oracle());
        let row = |forces: Vec<f64>| forces[..n].to_vec();
        let forces = case.forces();
        case.close("M ÿ + k − q", &case.call("inverse_dynamics")[0], &forces[..n], case.size);
        case.close("f_d", &case.call("driving_forces")[0], &forces[n..], case.size);
        let mass = oracle.mass_matrix(y);
        let size = largest(&mass);
        case.close("M", &case.call("mass_matrix")[0], &block(&mass, n), size);
        // k has what the driven accelerations need.
        let mut given = vec![0.0; n];
        given.extend(case.d.iter().skip(2).step_by(3));
        let coriolis = row(oracle.inertial_forces(y, v, &given));
        let gravity = row(oracle.gravity_forces(y));
        let springs = row(oracle.spring_forces(y, v));
        let friction = row(oracle.friction_torques(y, v));
        let applied = minus(&plus(&gravity, &springs), &friction);
        case.close("k", &case.call("coriolis_forces")[0], &coriolis, case.size);
        case.close("bias", &case.call("bias_forces")[0], &minus(&coriolis, &gravity), case.size);
        case.close("g", &case.call("gravity_forces")[0], &gravity, case.size);
        case.close("springs", &case.call("spring_forces")[0], &springs, case.size);
        case.close("τ", &case.call("friction_torques")[0], &friction, case.size);
        case.close("q", &case.call("applied_forces")[0], &applied, case.size);
        for name in ["equations_of_motion", "mass_matrix_and_bias_forces"] {
            let found = case.call(name);
            case.close("M of all", &found[0], &block(&mass, n), size);
            let second =
                if name == "equations_of_motion" { coriolis.clone() } else { minus(&coriolis, &gravity) };
            case.close(name, &found[1], &second, case.size);
        }
        let energy = case.call("kinetic_energy")[0][0];
        case.close("T", &[energy], &[oracle.kinetic_energy(y, v)], case.size * (1.0 + largest(v)));
        let inputs = oracle.input_columns(y);
        let expected: Vec<f64> = (0..n).flat_map(|i| inputs.iter().map(move |column| column[i])).collect();
        case.close("B", &case.call("input_matrix")[0], &expected, 1.0 + largest(&expected));
        let regressor = case.call("inertial_regressor");
        let parameters = case.call("inertial_parameters");
        let inertial = minus(&row(oracle.inertial_forces(y, v, &case.all[2])), &gravity);
        case.close("W π", &times(&regressor[0], &parameters[0]), &inertial, case.size);
        let rubbing = (case.call("friction_regressor"), case.call("friction_parameters"));
        let rubs = if rubbing.1[0].is_empty() { vec![0.0; n] } else { times(&rubbing.0[0], &rubbing.1[0]) };
        case.close("R φ", &rubs, &friction, case.size);
    });
}

#[test]
fn accelerations_satisfy_the_rows_of_the_free_joints() {
    on_all(|case| {
        let n = case.n();
        let found = case.call("forward_dynamics").swap_remove(0);
        let mut arguments = case.arguments("inverse_dynamics");
        let at =
            case.robot.function("inverse_dynamics").program.inputs.iter().position(|input| input.name == "a");
        arguments[at.expect("accelerations")] = found.clone();
        let forces = case.call_with("inverse_dynamics", &arguments).swap_remove(0);
        let matrix = case.call("input_matrix").swap_remove(0);
        let expected = if case.state.u.is_empty() { vec![0.0; n] } else { times(&matrix, &case.state.u) };
        let mass = case.call("mass_matrix").swap_remove(0);
        let growth =
            DMatrix::from_row_slice(n, n, &mass).try_inverse().expect("regular").norm() * largest(&mass);
        let size = case.size + largest(&mass) * largest(&found) + growth * largest(&expected);
        case.close("B u", &forces, &expected, size * growth);
    });
}

#[test]
fn derivatives_are_slopes() {
    on_all(|case| {
        for (name, of, is_forward) in [
            ("inverse_dynamics_derivatives", "inverse_dynamics", false),
            ("inverse_dynamics_derivatives_and_mass_matrix", "inverse_dynamics", false),
            ("inverse_dynamics_derivatives_with_wrenches", "inverse_dynamics_with_wrenches", false),
            ("forward_dynamics_derivatives", "forward_dynamics", true),
            ("forward_dynamics_derivatives_with_wrenches", "forward_dynamics_with_wrenches", true),
        ] {
            let found = case.call(name);
            let own = case.call(of).swap_remove(0);
            let mass = case.call("mass_matrix").swap_remove(0);
            let inverse = DMatrix::from_row_slice(case.n(), case.n(), &mass).try_inverse().expect("regular");
            let growth =
                if is_forward { inverse.norm() * (1.0 + inverse.norm() * largest(&mass)) } else { 1.0 };
            case.close(name, &found[0], &own, case.size * growth);
            for (found, by) in found[1..3].iter().zip(["y", "v"]) {
                let slope = case.slope(of, by);
                case.close(&format!("{name} by {by}"), found, &slope, (case.size + largest(&slope)) * growth);
            }
        }
        let affine = case.call("linearize");
        let derivatives = case.call("forward_dynamics_derivatives");
        let size = largest(&derivatives[1]) + largest(&derivatives[2]) + largest(&derivatives[0]);
        case.close("A_y", &affine[0], &derivatives[1], size);
        case.close("A_v", &affine[1], &derivatives[2], size);
        let parts = [(&affine[0], &case.state.y), (&affine[1], &case.state.v), (&affine[2], &case.state.u)];
        let parts = parts.iter().filter(|(_, x)| !x.is_empty()).map(|(matrix, x)| times(matrix, x));
        let total = parts.fold(affine[3].clone(), |sum, part| plus(&sum, &part));
        case.close("A x + B u + c", &total, &derivatives[0], 1e2 * (size + largest(&affine[2]) * 5.0));
    });
}

/// The Hessian of λᵀ (M ÿ + k − q) against slopes of the Jacobians.
#[test]
fn second_derivatives_are_slopes_of_the_first() {
    on_all(|case| {
        let n = case.n();
        let hessian = case.call("inverse_dynamics_hessian");
        let weighted = |slopes: Vec<f64>| -> Vec<f64> {
            // Rows are entries (i, k) of a Jacobian: summed over the forces i.
            let entry = |at: usize| (0..n).map(|i| (i as f64).cos() * slopes[i * n * n + at]).sum();
            (0..n * n).map(entry).collect()
        };
        for (block, (result, by)) in hessian.iter().zip([(1, "y"), (1, "v"), (2, "v"), (1, "a")]) {
            let expected = weighted(case.slope_of("inverse_dynamics_derivatives", result, by));
            let size = case.size + largest(&expected);
            case.close(&format!("H by {by}"), block, &expected, 10.0 * size);
        }
    });
}

/// Velocities and accelerations in space, the driven joints' included.
#[test]
fn frames_move_with_the_driven_joints() {
    on_all(|case| {
        let ([y, v, _], oracle) = (&case.all, case.oracle());
        let size = 4.0 * case.robot.model.links.len() as f64;
        let speed: f64 = 1.0 + v.iter().map(|v| v.abs()).sum::<f64>();
        for frame in &case.robot.model.frames {
            let name = |suffix: &str| format!("frame_{}_{suffix}", frame.identifier);
            let (origin, _) = oracle.frame(frame, y);
            case.close("p", &case.call(&name("pose"))[0], &origin, size);
            let columns: Vec<[f64; 6]> = (0..y.len()).map(|j| oracle.jacobian_column(frame, y, j)).collect();
            let expected: Vec<f64> =
                (0..6).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
            case.close("J", &case.call(&name("jacobian"))[0], &expected, size);
            let mut given = vec![0.0; case.n()];
            given.extend(case.d.iter().skip(2).step_by(3));
            let rate = oracle.jacobian_rate_times_velocity(frame, y, v);
            let expected = plus(&rate, &times(&expected, &given));
            case.close(
                "p̈",
                &case.call(&name("jacobian_rate_times_velocity"))[0],
                &expected,
                size * speed * speed,
            );
        }
        let jacobian = case.call("center_of_mass_jacobian").swap_remove(0);
        let own = case.slope("center_of_mass", "y");
        let of_driven = case.slope("center_of_mass", "d");
        let expected: Vec<f64> = (0..3)
            .flat_map(|i| {
                let driven = of_driven[i * case.d.len()..(i + 1) * case.d.len()].iter().step_by(3);
                own[i * case.n()..(i + 1) * case.n()].iter().chain(driven).copied().collect::<Vec<_>>()
            })
            .collect();
        case.close("J_c", &jacobian, &expected, size);
    });
}

/// All numbers below a value, in order.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().expect("a number")],
    }
}

/// The functions that are compared with Pinocchio.
const COMPARED: [&str; 7] = [
    "mass_matrix",
    "inverse_dynamics",
    "driving_forces",
    "forward_dynamics",
    "bias_forces",
    "inverse_dynamics_derivatives",
    "joint_wrenches",
];

/// Two joints of `tests/reference/joints.toml` are driven: what Pinocchio computes for the robot of all joints has the
/// rows of this one, and its accelerations solve them.
#[test]
fn driven_joints_agree_with_rows_of_pinocchio() {
    let folder = workspace().join("tests/reference");
    let text = std::fs::read_to_string(folder.join("joints.json")).expect("committed values");
    let reference: Value = serde_json::from_str(&text).expect("JSON");
    let model =
        read::read(&folder.join("driven_joints.toml"), &ReadOptions::default()).expect("a robot").model;
    let robot = Robot::of_model(model, &COMPARED);
    let all: Vec<&str> =
        reference["joints"].as_array().expect("names").iter().filter_map(Value::as_str).collect();
    let place = |name: &str| all.iter().position(|other| *other == name).expect("a joint of the reference");
    let free: Vec<usize> = robot.model.joints().map(|joint| place(&joint.name)).collect();
    let driven: Vec<usize> = robot.model.driven_joints().map(|joint| place(&joint.name)).collect();
    assert_eq!((free.len(), driven.len()), (all.len() - 2, 2));
    for sample in reference["samples"].as_array().expect("samples") {
        let get = |key: &str| numbers(&sample[key]);
        let (mass, count) = (get("M"), all.len());
        let pick = |x: &[f64], at: &[usize]| -> Vec<f64> { at.iter().map(|&k| x[k]).collect() };
        let chosen = |matrix: &[f64], columns: &[usize]| -> Vec<f64> {
            free.iter()
                .flat_map(|&i| columns.iter().map(move |&j| (i, j)))
                .map(|(i, j)| matrix[i * count + j])
                .collect()
        };
        let [y, v, a] = ["y", "v", "a"].map(get);
        let d: Vec<f64> = driven.iter().flat_map(|&k| [y[k], v[k], a[k]]).collect();
        let (y, v, a, d_accelerations) =
            (pick(&y, &free), pick(&v, &free), pick(&a, &free), pick(&a, &driven));
        let check = |what: &str, found: &[f64], expected: &[f64], tolerance: f64| {
            let error = relative_error(found, expected);
            assert!(error <= tolerance, "{what}: relative error {error:e}");
        };
        check("M", &robot.first("mass_matrix", &[&y, &d]), &chosen(&mass, &free), 1e-11);
        let id = get("id");
        check("id", &robot.first("inverse_dynamics", &[&y, &v, &a, &d]), &pick(&id, &free), 1e-11);
        check("f_d", &robot.first("driving_forces", &[&y, &v, &a, &d]), &pick(&id, &driven), 1e-11);
        let reactions = get("reactions");
        let rows = free.iter().chain(&driven).flat_map(|&k| &reactions[6 * k..6 * (k + 1)]).copied();
        let rows: Vec<f64> = rows.collect();
        check("reactions", &robot.first("joint_wrenches", &[&y, &v, &a, &d]), &rows, 1e-11);
        let coupled = times(&chosen(&mass, &driven), &d_accelerations);
        let bias = plus(&pick(&get("nle"), &free), &coupled);
        check("nle", &robot.first("bias_forces", &[&y, &v, &d]), &bias, 1e-11);
        let found = robot.call("inverse_dynamics_derivatives", &[&y, &v, &a, &d]);
        check("did_dy", &found[1], &chosen(&get("did_dy"), &free), 1e-10);
        check("did_dv", &found[2], &chosen(&get("did_dv"), &free), 1e-10);
        let driving = pick(&get("tau"), &free);
        let right = DVector::from_vec(minus(&driving, &bias));
        let solved =
            DMatrix::from_row_slice(free.len(), free.len(), &chosen(&mass, &free)).lu().solve(&right);
        let fd = robot.first("forward_dynamics", &[&y, &v, &get("u"), &d]);
        check("fd", &fd, solved.expect("regular").as_slice(), 1e-11);
    }
}
