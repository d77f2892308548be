//! Functions of a robot against the equations of the oracle.

pub mod truth;

use gelenk_codegen::function_names as names;
use gelenk_codegen::functions::catalogue;
use gelenk_codegen::functions::composition::Composition;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::function::{ConstantValue, Function};
use gelenk_codegen::model::Model;
use num_dual::Dual64;

use crate::Robot;
use crate::dual::evaluate;
use crate::random_model::Sample;
use truth::{State, Truth};

/// The functions that may be loops over joints.
pub const LOOPS: [&str; 4] = [
    names::INVERSE_DYNAMICS_DERIVATIVES,
    names::INVERSE_DYNAMICS_DERIVATIVES_AND_MASS_MATRIX,
    names::FORWARD_DYNAMICS_DERIVATIVES,
    names::LINEARIZE,
];

/// Largest error by rounding, see [`Compared::error`].
const TOLERANCE: f64 = 1e-10;

/// A function of a robot in a form, with its error.
#[derive(Debug, Clone)]
pub struct Compared {
    /// Its name.
    pub function: String,
    /// Whether it is loops over joints.
    pub is_loops: bool,
    /// The largest difference, relative to the largest entry of a result or to 1 unit if all are smaller; for what needs the inverse
    /// of M, divided by M's condition number.
    pub error: f64,
}

/// Every function of the catalogue. The functions over a sample time are left out: they are not expressions, and call others.
pub fn functions(model: &Model) -> Vec<String> {
    let is_composed = |name: &String| Composition::ALL.iter().any(|each| each.name() == name);
    catalogue::names(model).into_iter().filter(|name| !is_composed(name)).collect()
}

/// Functions that are compared in any case: those of parameters belong to their regressors.
const ALWAYS: [&str; 4] =
    [names::MASS_MATRIX, names::INVERSE_DYNAMICS, names::INERTIAL_PARAMETERS, names::FRICTION_PARAMETERS];

/// A third of the functions, and those of frames: tests of many robots take other functions of each.
pub fn a_third(model: &Model, number: usize) -> Vec<String> {
    let is_wanted = |name: &String| {
        let third = if LOOPS.contains(&name.as_str()) { 0 } else { 1 + name.len() % 2 };
        third == number % 3 || ALWAYS.contains(&name.as_str()) || is_of_frame(name)
    };
    functions(model).into_iter().filter(is_wanted).collect()
}

/// Tells whether a function is one of a named frame.
pub fn is_of_frame(name: &str) -> bool {
    name.starts_with("frame_")
}

/// Compares functions in a state: as straight-line code, and those that may be loops in this form too. Regressors need the
/// functions of their parameters among them.
///
/// # Panics
/// A function differs by more than the tolerance.
pub fn assert_agreement(what: &str, model: &Model, state: &State, functions: &[String]) -> Vec<Compared> {
    let truth = Truth::new(model, state);
    let in_form = |names: &[&str], form: Form| {
        let robot = Robot::in_form(model.clone(), names, form);
        let is_wanted = |function: &&Function| form == Form::Straight || function.arrays.is_some();
        let wanted = robot.functions().iter().filter(is_wanted);
        let compared = wanted.map(|function| Compared {
            function: function.name.clone(),
            is_loops: function.arrays.is_some(),
            error: error(&robot, &function.name, state, &truth),
        });
        compared.collect::<Vec<_>>()
    };
    let all: Vec<&str> = functions.iter().map(String::as_str).collect();
    let mut compared = in_form(&all, Form::Straight);
    let looping: Vec<&str> = all.into_iter().filter(|name| LOOPS.contains(name)).collect();
    if !looping.is_empty() {
        compared.extend(in_form(&looping, Form::Arrays));
    }
    let wrong: Vec<&Compared> = compared.iter().filter(|each| each.error > TOLERANCE).collect();
    assert!(wrong.is_empty(), "{what}: {wrong:#?}");
    compared
}

fn error(robot: &Robot, name: &str, state: &State, truth: &Truth<'_>) -> f64 {
    let needs_inverse = name.starts_with(names::FORWARD_DYNAMICS) || name == names::LINEARIZE;
    let growth = if needs_inverse { truth.condition } else { 1.0 };
    let [found, expected] = match truth.results(name) {
        Some(expected) => [call(robot, name, state), expected],
        None => products(robot, name, state, truth),
    };
    assert_eq!(found.len(), expected.len(), "results of {name}");
    found.iter().zip(&expected).map(|(found, expected)| difference(found, expected)).fold(0.0, f64::max)
        / growth
}

fn call(robot: &Robot, name: &str, state: &State) -> Vec<Vec<f64>> {
    let inputs = robot.function(name).program.inputs.iter();
    let inputs: Vec<&[f64]> = inputs.map(|input| state.argument(&input.name)).collect();
    robot.call_with(name, &inputs, &state.sample.parameters)
}

/// Products of a function with what gives forces, and these forces: a regressor with its parameters, the Hessian with a
/// direction. Parameters are compared with their regressors.
fn products(robot: &Robot, name: &str, state: &State, truth: &Truth<'_>) -> [Vec<Vec<f64>>; 2] {
    let first = |name: &str| call(robot, name, state).swap_remove(0);
    let (parameters, expected) = match name {
        names::INERTIAL_REGRESSOR => (first(names::INERTIAL_PARAMETERS), truth.inertial()),
        names::BASE_REGRESSOR => match base_parameters(robot, &first(names::INERTIAL_PARAMETERS)) {
            Some(parameters) => (parameters, truth.inertial()),
            None => return [vec![], vec![]],
        },
        names::FRICTION_REGRESSOR => (first(names::FRICTION_PARAMETERS), truth.friction()),
        names::INVERSE_DYNAMICS_HESSIAN => {
            let Sample { v, a, .. } = &state.sample;
            let along = [&state.lambda, v, a].map(Vec::as_slice);
            return [hessian_times(&call(robot, name, state), along), truth.hessian_along(along)];
        }
        names::POTENTIAL_ENERGY => return energy_slopes(robot, state, truth),
        _ => return [vec![], vec![]],
    };
    [vec![times(&first(name), &parameters, expected.len())], vec![expected]]
}

/// Product of a matrix of `rows` rows with a vector.
fn times(matrix: &[f64], x: &[f64], rows: usize) -> Vec<f64> {
    let row = |i: usize| matrix[i * x.len()..].iter().zip(x).map(|(entry, x)| entry * x).sum();
    (0..rows).map(row).collect()
}

/// The Hessian, by its blocks yy, yv, vv and ya, times a direction.
fn hessian_times(blocks: &[Vec<f64>], along: [&[f64]; 3]) -> Vec<Vec<f64>> {
    let n = along[0].len();
    let block = |k: usize, part: usize| times(&blocks[k], along[part], n);
    let transposed = |k: usize, part: usize| {
        let entry = |i: usize, j: usize| blocks[k][j * n + i] * along[part][j];
        (0..n).map(|i| (0..n).map(|j| entry(i, j)).sum()).collect::<Vec<f64>>()
    };
    let sum = |parts: &[Vec<f64>]| (0..n).map(|i| parts.iter().map(|part| part[i]).sum()).collect();
    vec![
        sum(&[block(0, 0), block(1, 1), block(3, 2)]),
        sum(&[transposed(1, 0), block(2, 1)]),
        transposed(3, 0),
    ]
}

/// The slopes of the potential energy along small motions, and the forces of gravity and of laws between frames: what constants
/// the energies have is nobody's concern.
fn energy_slopes(robot: &Robot, state: &State, truth: &Truth<'_>) -> [Vec<Vec<f64>>; 2] {
    let program = &robot.function(names::POTENTIAL_ENERGY).program;
    let slope = |positions: Vec<Dual64>| {
        let driven: Vec<Dual64> = state.d.iter().map(|&d| Dual64::from(d)).collect();
        let inputs: Vec<&[Dual64]> =
            [&positions[..state.sample.y.len()], &driven].into_iter().take(program.inputs.len()).collect();
        -evaluate(program, &inputs, &state.sample.parameters)[0][0].eps
    };
    let (positions, expected) = truth.conservative();
    [vec![positions.into_iter().map(slope).collect()], vec![expected]]
}

/// Base parameters of inertial ones. Their map is not a constant if it depends on free parameters: `regressors.rs` looks at the rank
/// of the regressor there.
fn base_parameters(robot: &Robot, parameters: &[f64]) -> Option<Vec<f64>> {
    let constants = &robot.function(names::BASE_REGRESSOR).constants;
    let terms = constants.iter().find_map(|constant| match &constant.value {
        ConstantValue::Sparse(terms) => Some(terms),
        _ => None,
    });
    let terms = terms?;
    let count = terms.iter().map(|term| term.0 + 1).max().unwrap_or(0);
    let mut base = vec![0.0; count];
    for &(row, column, factor) in terms {
        base[row] += factor * parameters[column];
    }
    Some(base)
}

fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let size = expected.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
    let differences = found.iter().zip(expected).map(|(a, b)| (a - b).abs() / size);
    // `max` would drop a NaN.
    differences.fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x) })
}
