//! Comparison of every generated function with an independent evaluation of its model at pseudo-random
//! states.
//!
//! The interpreter runs the function's program. Expected results come from the Newton–Euler equations of the
//! [`Model`], evaluated numerically. Derivatives use dual numbers. This evaluation uses neither the module
//! `kinematics` nor `dynamics`, so errors of the derivation are detected. Functions of discrete time and of
//! positions have the same text for every robot. They call functions that are checked here.

mod case;
mod functions;
mod momentum;
mod number;
mod parameters;
mod robot;
mod space;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::functions::function::Function;
use crate::model::{JointPosition, Model};
use crate::program::interpret::interpret;
use crate::self_test;
use case::Case;
use functions::expected;
use number::{Dual, Measured, Number};
use robot::{Positions, Robot};

/// Largest allowed difference between a generated and an expected result, relative to the largest entry of
/// both.
const RELATIVE: f64 = 1e-9;

/// Largest allowed difference between a generated and an expected result, divided by the running error of
/// [`Measured`]. Sums whose terms cancel agree only up to rounding errors.
const OF_ERROR: f64 = 1e-12;

/// Code of diagnostics about errors of gelenk itself.
pub const INTERNAL: &str = "internal-error";

/// A result that differs from its independent evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Disagreement {
    /// Name of the function whose result differs.
    pub function: String,
    /// Index of the result in `program.outputs`.
    pub result: usize,
    /// Largest difference of an entry, divided by the largest allowed difference.
    pub excess: f64,
    /// The entry with the largest difference: generated value, expected value.
    pub entry: [f64; 2],
}

/// Compares functions with the independent evaluation of the model.
///
/// # Errors
/// Returns [`INTERNAL`] for each function that differs. This is an error of gelenk, not of the description.
pub fn verify(model: &Model, functions: &[Function]) -> Result<(), Diagnostics> {
    let worst = functions.iter().map(|function| worst(model, function));
    let problems: Vec<Diagnostic> =
        worst.filter(|found| !found.is_rounding()).map(|found| found.problem()).collect();
    if problems.is_empty() { Ok(()) } else { Err(Diagnostics::new(problems)) }
}

/// Largest disagreement of a function with the independent evaluation, at the states of the self-test.
#[must_use]
pub fn worst(model: &Model, function: &Function) -> Disagreement {
    let found = (0..self_test::STATES).flat_map(|seed| differences(model, function, seed));
    found.reduce(worse).unwrap_or_else(|| Disagreement { excess: 0.0, ..unknown(function) })
}

impl Disagreement {
    /// Whether rounding explains the disagreement.
    #[must_use]
    pub fn is_rounding(&self) -> bool {
        self.excess <= 1.0
    }

    fn problem(&self) -> Diagnostic {
        let [found, expected] = self.entry;
        let message = format!(
            "`{}` differs from the independent evaluation of the robot: {found:e} instead of {expected:e}; the \
             difference is {:.1e} times the bound for rounding errors",
            self.function, self.excess
        );
        Diagnostic::error(INTERNAL, message).help(concat!(
            "this is a fault of gelenk, so nothing is written; please report it with the description at ",
            env!("CARGO_PKG_REPOSITORY")
        ))
    }
}

/// For each result of a function, the entry that differs most from the independent evaluation.
fn differences(model: &Model, function: &Function, seed: u64) -> Vec<Disagreement> {
    let arguments = self_test::arguments(model, function, seed);
    let parameters = model.described_parameters();
    let slices: Vec<&[f64]> = arguments.iter().map(Vec::as_slice).collect();
    let Ok(found) = interpret(&function.program, &slices, &parameters) else {
        return vec![unknown(function)];
    };
    let names: Vec<&str> = function.program.inputs.iter().map(|input| input.name.as_str()).collect();
    let given = Given { model, names: &names, arguments: &arguments };
    let expected = match function.name.strip_suffix(BY_PARAMETERS) {
        None => given.results(function, &parameters),
        Some(name) => {
            given.by_parameters(&Function { name: name.to_owned(), ..function.clone() }, &parameters)
        }
    };
    let Some((expected, condition)) = expected else {
        return vec![unknown(function)];
    };
    let is_singular = condition.is_nan() || condition * OF_ERROR >= 1.0;
    if is_singular {
        return Vec::new();
    }
    let results = found.iter().zip(&expected).enumerate();
    results
        .filter_map(|(index, (found, expected))| compare(function, index, found, expected, condition))
        .collect()
}

/// Mass matrix (row-major) and bias forces at a state, with the parameter values of the description.
#[must_use]
pub fn mass_and_bias(model: &Model, y: &[f64], v: &[f64]) -> [Vec<f64>; 2] {
    let given = Given { model, names: &["y", "v"], arguments: &[y.to_vec(), v.to_vec()] };
    let parameters = model.parameters.iter().map(|parameter| Measured::constant(parameter.default));
    let case = given.case(parameters.collect());
    let results = [case.mass_matrix(case.n()).concat(), case.bias_forces()];
    results.map(|result| result.into_iter().map(|x| x.value).collect())
}

/// Columns of the input matrix at positions of the coordinates and prescribed motions of joints, with the
/// running error of each entry.
#[must_use]
pub(crate) fn input_columns(model: &Model, parameters: &[f64], [y, d]: [&[f64]; 2]) -> Vec<Vec<[f64; 2]>> {
    let given = Given { model, names: &["y", "d"], arguments: &[y.to_vec(), d.to_vec()] };
    let case = given.case(parameters.iter().map(|&p| Measured::constant(p)).collect());
    let columns = case.input_columns().into_iter();
    columns.map(|column| column.into_iter().map(|x| [x.value, x.error]).collect()).collect()
}

/// Suffix of the name of a function's derivative with respect to the free parameters.
const BY_PARAMETERS: &str = "_by_parameters";

/// The disagreement that is returned for a function without an independent evaluation, or whose program
/// cannot run.
fn unknown(function: &Function) -> Disagreement {
    let entry = [f64::NAN; 2];
    Disagreement { function: function.name.clone(), result: 0, excess: f64::INFINITY, entry }
}

fn compare(
    function: &Function,
    result: usize,
    found: &[f64],
    expected: &[Measured],
    condition: f64,
) -> Option<Disagreement> {
    let largest = found
        .iter()
        .copied()
        .chain(expected.iter().map(|x| x.value))
        .fold(0.0, |most: f64, x| most.max(x.abs()));
    let error = expected.iter().fold(0.0, |most: f64, x| most.max(x.error));
    let allowed = (RELATIVE * largest).max(OF_ERROR * error) * condition;
    let excess = |(found, expected): (&f64, &Measured)| {
        let difference = (found - expected.value).abs();
        let is_nowhere = !found.is_finite() && !expected.value.is_finite();
        let excess = if difference == 0.0 || is_nowhere { 0.0 } else { difference / allowed };
        Disagreement { function: function.name.clone(), result, excess, entry: [*found, expected.value] }
    };
    if found.len() != expected.len() {
        return Some(unknown(function));
    }
    found.iter().zip(expected).map(excess).reduce(worse)
}

/// The larger disagreement; NaN counts as larger than any number.
fn worse(one: Disagreement, other: Disagreement) -> Disagreement {
    if other.excess <= one.excess || one.excess.is_nan() { one } else { other }
}

/// Arguments of a function by their names.
struct Given<'a> {
    model: &'a Model,
    names: &'a [&'a str],
    arguments: &'a [Vec<f64>],
}

impl<'a> Given<'a> {
    fn results(&self, function: &Function, parameters: &[f64]) -> Option<(Vec<Vec<Measured>>, f64)> {
        let parameters = parameters.iter().map(|&p| Measured::constant(p)).collect();
        let found = expected(&self.case(parameters), function)?;
        Some((found.results, found.condition))
    }

    /// Derivatives of a function's results with respect to each free parameter: a row for each entry of each
    /// result.
    fn by_parameters(&self, function: &Function, parameters: &[f64]) -> Option<(Vec<Vec<Measured>>, f64)> {
        let mut columns: Vec<Vec<Vec<Measured>>> = Vec::new();
        let mut condition = 1.0;
        for index in 0..parameters.len() {
            let mut seeded: Vec<Dual<Measured>> = parameters.iter().map(|&p| Dual::constant(p)).collect();
            seeded[index].eps = Measured::constant(1.0);
            let found = expected(&self.case(seeded), function)?;
            condition = found.condition;
            columns.push(found.results.iter().map(|result| result.iter().map(|x| x.eps).collect()).collect());
        }
        let results = 0..columns.first().map_or(0, Vec::len);
        let result = |k: usize| {
            let entries = 0..columns[0][k].len();
            entries.flat_map(|entry| columns.iter().map(move |column| column[k][entry])).collect()
        };
        Some((results.map(result).collect(), condition))
    }

    fn argument(&self, name: &str) -> Option<&'a [f64]> {
        self.names.iter().position(|other| *other == name).map(|index| self.arguments[index].as_slice())
    }

    /// The state with the given arguments. Arguments that the function does not have are zero.
    fn case<T: Number>(&self, parameters: Vec<T>) -> Case<'a, T> {
        let model = self.model;
        let driven = self.argument("d").unwrap_or_default();
        let all = |name: &str, part: usize| -> Vec<T> {
            let own = match self.argument(name) {
                Some(own) => own.to_vec(),
                None => vec![0.0; model.coordinates.len()],
            };
            let driven = driven.iter().skip(part).step_by(3);
            let mut all: Vec<T> = own.iter().chain(driven).map(|&x| T::constant(x)).collect();
            all.resize(model.motion_count(), T::zero());
            all
        };
        let plain = |name: &str| -> Vec<T> {
            self.argument(name).unwrap_or_default().iter().map(|&x| T::constant(x)).collect()
        };
        Case {
            robot: Robot::new(model, parameters),
            at: self.positions(driven),
            v: all("v", 1),
            a: all("a", 2),
            u: plain("u"),
            w: plain("w"),
            lambda: plain("lambda"),
        }
    }

    fn positions<T: Number>(&self, driven: &[f64]) -> Positions<T> {
        let model = self.model;
        let zeros;
        let y = match self.argument("y") {
            Some(y) => y,
            None => {
                zeros = model.positions_by(&vec![0.0; model.coordinates.len()]);
                &zeros
            }
        };
        let mut scalars = vec![T::zero(); model.motion_count()];
        let mut poses = Vec::new();
        let mut next = 0;
        for joint in model.joint_positions() {
            match joint {
                JointPosition::Coordinate(coordinate) => {
                    scalars[coordinate] = T::constant(y[next]);
                    next += 1;
                }
                JointPosition::Quaternion(joint) => {
                    let entries = &y[next..next + joint.kind.positions()];
                    let (origin, q) = entries.split_at(joint.kind.quaternion());
                    let origin: [f64; 3] = origin.try_into().unwrap_or_default();
                    poses.push((origin.map(T::constant), [q[0], q[1], q[2], q[3]].map(T::constant)));
                    next += entries.len();
                }
            }
        }
        for (k, position) in driven.iter().step_by(3).enumerate() {
            scalars[model.coordinates.len() + k] = T::constant(*position);
        }
        Positions { scalars, poses }
    }
}
