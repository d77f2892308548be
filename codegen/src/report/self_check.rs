//! Self-check on the page: comparison of every function with an independent evaluation of the model, and
//! eigenvalues of the mass matrix.

use gelenk_report::{Claim, Criterion};
use nalgebra::{DMatrix, SymmetricEigen};

use super::robot::Robot;
use crate::function_names;
use crate::functions::function::Function;
use crate::model::Definiteness;
use crate::program::interpret::interpret;
use crate::self_test;
use crate::verify;

/// Number of states at which the mass matrix is examined.
pub(super) const STATES: u64 = 25;

/// Rows of the self-check table: the mass matrix, each function, and all functions of frames together.
pub(super) fn claims(robot: &Robot<'_>) -> Vec<Claim> {
    let agrees = |id: &str, what: &str, functions: &[&Function]| {
        let excesses = functions.iter().map(|function| verify::worst(robot.model, function).excess);
        let name = "largest difference divided by the bound for rounding";
        Claim::new(format!("check-{id}"), format!("{what} independent evaluation of the described bodies."))
            .criterion(Criterion::at_most(name, worst(excesses), 1.0, ""))
            .flipped_by("a term, a sign or a frame differs between the two evaluations")
    };
    let (of_frames, others): (Vec<_>, Vec<_>) =
        robot.functions.iter().partition(|function| function.frame.is_some());
    let of_functions = others.into_iter().map(|function| {
        let what = format!("`{}` agrees with the", function.name);
        agrees(&function.name.replace('_', "-"), &what, &[function])
    });
    let frames = "The functions of named frames agree with the";
    let of_frames = (!of_frames.is_empty()).then(|| agrees("frames", frames, &of_frames));
    definiteness(robot).into_iter().chain(of_functions).chain(of_frames).collect()
}

fn worst(values: impl Iterator<Item = f64>) -> f64 {
    // `max` would drop a NaN.
    values.fold(0.0, |worst, value| if value <= worst { worst } else { value })
}

fn definiteness(robot: &Robot<'_>) -> Option<Claim> {
    let function = robot.function(function_names::MASS_MATRIX)?;
    let ratios = (0..STATES).map(|seed| least_eigenvalue(robot, function, seed));
    let ratios: Option<Vec<f64>> = ratios.collect();
    let least =
        ratios?.into_iter().fold(f64::INFINITY, |least, value| if value >= least { least } else { value });
    let is_singular = robot.model.definiteness() == Definiteness::Semidefinite;
    let (statement, bound) = match is_singular {
        true => (
            "The mass matrix has no negative eigenvalue, but it is singular, because some motions have no inertia.",
            -ROUNDING,
        ),
        false => ("The mass matrix is positive definite.", ROUNDING),
    };
    let name = "smallest eigenvalue of the matrix scaled to diagonal 1";
    Some(
        Claim::new("check-definite", statement)
            .criterion(Criterion::at_least(name, least, bound, ""))
            .flipped_by("a mass is negative, or a joint moves no mass"),
    )
}

/// Magnitude below which eigenvalues of the scaled mass matrix count as rounding errors.
const ROUNDING: f64 = 1e-12;

/// The smallest eigenvalue of `M_ij / √(M_ii M_jj)` with the mass matrix M at a pseudo-random state. The
/// scaling removes the units, because masses and inertias may differ by any factor.
#[expect(clippy::disallowed_methods, reason = "the matrix is finite, and of a robot with joints")]
fn least_eigenvalue(robot: &Robot<'_>, function: &Function, seed: u64) -> Option<f64> {
    let arguments = self_test::arguments(robot.model, function, seed);
    let arguments: Vec<&[f64]> = arguments.iter().map(Vec::as_slice).collect();
    let results = interpret(&function.program, &arguments, &robot.parameters).ok()?;
    let mass = DMatrix::from_row_slice(robot.n(), robot.n(), results.first()?);
    let diagonal = mass.diagonal();
    if diagonal.min() < 0.0 {
        return Some(diagonal.min() / diagonal.amax());
    }
    let scale = diagonal.map(|entry| if entry > 0.0 { entry.sqrt() } else { 1.0 });
    let scaled = DMatrix::from_fn(robot.n(), robot.n(), |i, j| mass[(i, j)] / (scale[i] * scale[j]));
    // The search for eigenvalues of NaN and infinity does not end.
    let is_finite = scaled.iter().all(|entry| entry.is_finite());
    Some(if is_finite { SymmetricEigen::new(scaled).eigenvalues.min() } else { f64::NAN })
}
