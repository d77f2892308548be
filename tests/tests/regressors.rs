//! Functions that are linear in parameters: regressors against the inverse dynamics and friction that they
//! stand for, base parameters against the rank of stacked regressors.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::path::Path;

use fastrand::Rng;
use gelenk_codegen::functions::function::ConstantValue;
use gelenk_codegen::model::Joint;
use gelenk_codegen::model::Model;
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_codegen::read::{ReadOptions, read};
use gelenk_identification::inertial::margin;
use gelenk_tests::positions::positions;
use gelenk_tests::random_model::{Sample, random_helical_model, random_model, random_sample};
use gelenk_tests::{Robot, descriptions, oracle, robot_of_others, workspace};
use nalgebra::DMatrix;

const FUNCTIONS: [&str; 8] = [
    "inertial_parameters",
    "inertial_regressor",
    "base_regressor",
    "friction_parameters",
    "friction_regressor",
    "friction_torques",
    "spring_forces",
    "inverse_dynamics",
];

/// Rounding error relative to the sum of the magnitudes.
const TOLERANCE: f64 = 1e-12;

/// Base parameters are rounded to 1e-12 for each parameter.
const BASE_TOLERANCE: f64 = 1e-10;

/// A random state, its positions with quaternions where joints have them.
fn sample_of(rng: &mut Rng, model: &Model) -> Sample {
    let sample = random_sample(rng, model);
    Sample { y: positions(model, &sample.y), ..sample }
}

/// Robots of models/ and random trees of up to 12 joints of every kind.
fn robots() -> Vec<Robot> {
    let described = descriptions().into_iter().map(|path| {
        let loaded = read(&path, &ReadOptions::default());
        loaded.unwrap_or_else(|problems| panic!("{problems}")).model
    });
    // Functions of robots with driven joints take one argument more; `driven.rs` is about them.
    let described = described.filter(|model| model.driven.is_empty());
    let random = (100..140).map(|seed| random_model(seed, 12));
    let helical = (2100..2104).map(|seed| random_helical_model(seed, 6));
    described.chain(random).chain(helical).map(|model| Robot::of_model(model, &FUNCTIONS)).collect()
}

fn names<'r>(robot: &'r Robot, function: &str) -> &'r [String] {
    let constants = &robot.function(function).constants;
    let names = constants.iter().find_map(|constant| match &constant.value {
        ConstantValue::Names(_, names) => Some(names),
        _ => None,
    });
    names.expect("names of columns")
}

/// The map of the base parameters; none where it is not a constant.
fn base_terms(robot: &Robot) -> Option<&[(usize, usize, f64)]> {
    let constants = &robot.function("base_regressor").constants;
    constants.iter().find_map(|constant| match &constant.value {
        ConstantValue::Sparse(terms) => Some(terms.as_slice()),
        _ => None,
    })
}

/// `matrix · x`, and the sum of the products' magnitudes.
fn times(matrix: &[f64], x: &[f64]) -> Vec<(f64, f64)> {
    let row = |row: &[f64]| {
        let products = row.iter().zip(x).map(|(w, x)| w * x);
        products.fold((0.0, 0.0), |(sum, size): (f64, f64), p| (sum + p, size + p.abs()))
    };
    matrix.chunks(x.len().max(1)).map(row).collect()
}

fn close(what: &str, name: &str, found: f64, expected: f64, size: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= tolerance * size,
        "{name}, {what}: {found} is not {expected}, of sums as large as {size}"
    );
}

#[test]
fn inertial_regressor_times_parameters_is_the_inverse_dynamics() {
    for robot in robots() {
        let name = &robot.model.name;
        let mut rng = Rng::with_seed(7);
        for _ in 0..5 {
            let Sample { y, v, a, parameters, .. } = sample_of(&mut rng, &robot.model);
            let first = |name, inputs: &[&[f64]]| robot.call_with(name, inputs, &parameters).swap_remove(0);
            let pi = first("inertial_parameters", &[]);
            assert_eq!(pi.len(), names(&robot, "inertial_parameters").len());
            let bodies = times(&first("inertial_regressor", &[&y, &v, &a]), &pi);
            let arguments = robot.friction_arguments("friction_torques", &y, &v);
            let friction = first("friction_torques", &arguments);
            let springs = first("spring_forces", &[&y, &v]);
            let forces = first("inverse_dynamics", &[&y, &v, &a]);
            let share = |i: usize, joint: &Joint| -> f64 {
                let value = |formula| oracle::value(formula, &parameters, y[i], v[i]);
                joint.load_friction.iter().map(|term| value(&term.coefficient) * value(&term.basis)).sum()
            };
            let shares = robot.model.joints().enumerate().map(|(i, joint)| share(i, joint));
            let shares: Vec<f64> = shares.collect();
            for (i, &(sum, size)) in bodies.iter().enumerate() {
                let load = sum - springs[i];
                let found = load + friction[i] + load.abs() * shares[i];
                let size = size + friction[i].abs() + springs[i].abs() + largest(&forces);
                close("W π + τ − springs + |τ_l| s₁", name, found, forces[i], size, TOLERANCE);
            }
        }
    }
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

#[test]
fn friction_regressor_times_parameters_is_the_friction() {
    let mut columns = 0;
    for robot in robots() {
        let mut rng = Rng::with_seed(8);
        let sample = sample_of(&mut rng, &robot.model);
        let first =
            |name, inputs: &[&[f64]]| robot.call_with(name, inputs, &sample.parameters).swap_remove(0);
        let coefficients = first("friction_parameters", &[]);
        let arguments = robot.friction_arguments("friction_regressor", &sample.y, &sample.v);
        assert_eq!(coefficients.len(), names(&robot, "friction_parameters").len());
        columns += coefficients.len();
        let found = match coefficients.is_empty() {
            true => vec![(0.0, 0.0); sample.v.len()],
            false => times(&first("friction_regressor", &arguments), &coefficients),
        };
        for ((sum, size), expected) in found.into_iter().zip(first("friction_torques", &arguments)) {
            close("R φ", &robot.model.name, sum, expected, size, TOLERANCE);
        }
    }
    assert!(columns > 100, "{columns} columns in all");
}

/// A regressor over random states, one below the other, at random values of the free parameters.
fn stacked(robot: &Robot, function: &str, rng: &mut Rng) -> DMatrix<f64> {
    let model = &robot.model;
    let mut rows = Vec::new();
    let parameters = random_sample(rng, model).parameters;
    for _ in 0..40 {
        let Sample { y, v, a, .. } = sample_of(rng, model);
        let result = robot.call_with(function, &[&y, &v, &a], &parameters);
        rows.extend(result.into_iter().next().unwrap_or_default());
    }
    let count = 40 * model.coordinates.len();
    DMatrix::from_row_slice(count, rows.len() / count, &rows)
}

/// Numerical rank of a matrix whose columns are scaled to length 1.
fn rank(mut matrix: DMatrix<f64>) -> usize {
    for mut column in matrix.column_iter_mut() {
        let length = column.norm();
        if length > 0.0 {
            column /= length;
        }
    }
    let values = matrix.singular_values();
    values.iter().filter(|value| **value > 1e-9 * values.max()).count()
}

#[test]
fn base_regressor_has_full_rank_and_no_column_more() {
    for robot in robots() {
        let name = &robot.model.name;
        let base = stacked(&robot, "base_regressor", &mut Rng::with_seed(9));
        let full = stacked(&robot, "inertial_regressor", &mut Rng::with_seed(9));
        let count = base.ncols();
        assert_eq!(count, names(&robot, "base_regressor").len());
        assert_eq!(rank(base.clone()), count, "{name}: full rank");
        let longest = full.column_iter().map(|column| column.norm());
        // Columns that are zero but for rounding have no direction.
        let rounding = 1e-13 * longest.fold(0.0, f64::max);
        let directions = base.qr().q();
        for column in full.column_iter() {
            let shares = directions.transpose() * column;
            let left = (column - &directions * shares).norm();
            assert!(left <= rounding.max(1e-9 * column.norm()), "{name}: one more column leaves {left:e}");
        }
    }
}

#[test]
fn base_regressor_times_base_parameters_is_all_that_moves() {
    let (mut free, mut left_out) = (0, 0);
    for robot in robots() {
        let name = &robot.model.name;
        let leaders = names(&robot, "base_regressor");
        let Some(terms) = base_terms(&robot) else {
            left_out += 1;
            continue;
        };
        free += usize::from(!robot.model.parameters.is_empty());
        let all = names(&robot, "inertial_parameters");
        for (group, leader) in leaders.iter().enumerate() {
            let first = terms.iter().find(|term| term.0 == group);
            assert_eq!(first.map(|term| (&all[term.1], term.2)), Some((leader, 1.0)));
        }
        let mut rng = Rng::with_seed(10);
        for _ in 0..5 {
            // The map holds for any values of the free parameters.
            let sample = sample_of(&mut rng, &robot.model);
            let Sample { y, v, a, parameters, .. } = &sample;
            let first = |name, inputs: &[&[f64]]| robot.call_with(name, inputs, parameters).swap_remove(0);
            let pi = first("inertial_parameters", &[]);
            let mut beta = vec![0.0; leaders.len()];
            let mut sizes = beta.clone();
            for &(group, parameter, coefficient) in terms {
                beta[group] += coefficient * pi[parameter];
                sizes[group] += (coefficient * pi[parameter]).abs();
            }
            let full = times(&first("inertial_regressor", &[y, v, a]), &pi);
            let y = first("base_regressor", &[y, v, a]);
            let sums = times(&y, &sizes);
            for ((found, expected), size) in times(&y, &beta).iter().zip(&full).zip(sums) {
                let size = expected.1 + size.1;
                close("Y β", name, found.0, expected.0, size, BASE_TOLERANCE);
            }
        }
    }
    assert!(free >= 5, "{free} maps of robots with free parameters");
    assert!(left_out >= 5, "{left_out} maps that are no constants");
}

/// Whatever changes the groups: the gear ratio of a rotor on the base (i² J), the distance of the next axis,
/// the direction of gravity. What only scales columns, as the size of gravity, changes nothing.
#[test]
fn maps_that_depend_on_free_parameters_are_left_out() {
    let arm = |gear: &str, length: &str, gravity: &str| {
        let text = format!(
            r#"
            gravity = [0, 0, {gravity}]
            [[joints]]
            name = "a"
            axis = [0, 1, 0]
            drive = {{ gear_ratio = {gear}, rotor_inertia = 1e-4 }}
            [[joints]]
            name = "b"
            axis = [0, 1, 0]
            origin = {{ xyz = [0, 0, {length}] }}
            drive = "ideal"
            [[bodies]]
            link = "a"
            mass = {{ free = 2.0 }}
            inertia = 0.1
            [[bodies]]
            link = "b"
            mass = 1
            center_of_mass = [0, 0, 0.2]
            inertia = 0.1
            "#
        );
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("arm.toml");
        std::fs::write(&path, text).expect("a description");
        let options =
            GenerateOptions { functions: vec!["base_regressor".to_owned()], ..GenerateOptions::default() };
        let robot = generate(&path, &options).unwrap_or_else(|problems| panic!("{problems}"));
        let has_map = robot.source.text.contains("pub const BASE_PARAMETER_TERMS");
        assert_eq!(has_map, !robot.notes.to_string().contains("`BASE_PARAMETER_TERMS` is omitted"));
        let groups = robot.source.text.contains("c(p) ");
        assert_eq!(has_map, !groups);
        has_map
    };
    assert!(arm("50", "0.3", "-9.81"));
    assert!(arm("50", "0.3", "{ free = -9.81 }"));
    assert!(!arm("{ free = 50 }", "0.3", "-9.81"));
    assert!(!arm("50", "{ free = 0.3 }", "-9.81"));
    // Described as zero, which is a length like any other.
    assert!(!arm("50", "{ free = 0 }", "-9.81"));
}

/// As many base parameters as the stacked regressor has independent columns, by its singular values.
#[test]
fn base_parameters_are_as_many_as_the_rank_of_the_regressor() {
    for name in ["powercube", "puma560", "ur5", "two_arm"] {
        let path = workspace().join(format!("models/{name}.toml"));
        let model = read(&path, &ReadOptions::default()).expect("the model").model;
        let robot = Robot::of_model(model, &FUNCTIONS);
        let regressor = stacked(&robot, "inertial_regressor", &mut Rng::with_seed(11));
        let values = regressor.singular_values();
        let rank = values.iter().filter(|value| **value > 1e-11 * values.max()).count();
        let leaders = robot.function("base_regressor").program.outputs[0].entries.len();
        let leaders = leaders / robot.model.coordinates.len();
        assert_eq!(rank, leaders, "{name}");
        if name == "ur5" {
            for link in robot.first("inertial_parameters", &[]).chunks_exact(10) {
                let link = link.try_into().expect("ten parameters");
                assert!(margin(link) > 0.0, "{link:?}");
            }
        }
    }
}

/// The base's six rows tell all base parameters of robots without rotors (Ayusawa, Venture and Nakamura 2014): legs need no
/// sensors of effort.
#[test]
fn rows_of_a_floating_base_have_the_rank_of_all_rows() {
    for name in ["go2", "quadrotor", "satellite"] {
        rows_of_the_base_have_the_rank_of_all_rows(&workspace().join(format!("models/{name}.toml")), false);
    }
}

#[test]
#[cfg_attr(not(robots_of_others), ignore = "no URDF: python3 tests/reference/robots.py")]
fn rows_of_the_base_of_solo12_have_the_rank_of_all_rows() {
    rows_of_the_base_have_the_rank_of_all_rows(&robot_of_others("solo12"), true);
}

fn rows_of_the_base_have_the_rank_of_all_rows(path: &Path, floating_base: bool) {
    let options = ReadOptions { floating_base, ..ReadOptions::default() };
    let model = read(path, &options).unwrap_or_else(|problems| panic!("{problems}")).model;
    let robot = Robot::of_model(model, &["base_regressor"]);
    let base = stacked(&robot, "base_regressor", &mut Rng::with_seed(12));
    let of_the_base = (0..base.nrows()).filter(|row| row % robot.model.coordinates.len() < 6);
    let rows = base.select_rows(&of_the_base.collect::<Vec<_>>());
    let count = names(&robot, "base_regressor").len();
    println!("{}: {count} base parameters", robot.model.name);
    assert_eq!(rank(rows), count, "{}", robot.model.name);
}

/// Both axes are horizontal and parallel: of each link the two first moments across them count, and one
/// moment of inertia. The rotor of the first drive only adds to the latter; that of the second couples both
/// joints.
#[test]
fn base_parameters_of_the_published_arm() {
    let path = workspace().join("models/powercube.toml");
    let model = read(&path, &ReadOptions::default()).expect("the model").model;
    let robot = Robot::of_model(model, &FUNCTIONS);
    let expected = ["mcx_beta", "mcz_beta", "Iyy_beta", "mcx_gamma", "mcz_gamma", "Iyy_gamma", "J_gamma"];
    assert_eq!(names(&robot, "base_regressor"), expected);
    // The published equations: M22 less its rotor, and h over the distance between the axes.
    let pi = robot.first("inertial_parameters", &[]);
    let group = |name: &str| {
        let group = expected.iter().position(|found| *found == name).expect(name);
        let terms = base_terms(&robot).expect("a constant map").iter();
        let terms = terms.filter(|term| term.0 == group);
        terms.map(|&(_, parameter, c)| c * pi[parameter]).sum::<f64>()
    };
    assert!((group("Iyy_gamma") - 0.6608899068565).abs() < 1e-12);
    assert!((group("mcz_gamma") - 0.3107549862 / 0.18).abs() < 1e-12);
    assert!((group("J_gamma") - 5.267e-5).abs() < 1e-18);
}
