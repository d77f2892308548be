//! Functions that nobody could compile or read are refused before they are written.

use super::composite;
use super::formulation::Formulation;
use super::function::Function;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::graph::{Cost, Graph};
use crate::kinematics::Mechanism;
use crate::model::Model;
use crate::program::cost::count;

/// Operations up to which a function is generated, unless more are asked for: `linearize` of 30 joints takes two thirds
/// of it; how long rustc takes for it is not measured yet.
pub const MOST_OPERATIONS: usize = 300_000;

/// Functions that do at least the work of the mass matrix, whose size grows with the square of the joints' number.
const AT_LEAST_MASS_MATRIX: [&str; 8] = [
    "mass_matrix",
    "equations_of_motion",
    "mass_matrix_and_bias_forces",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "forward_dynamics_derivatives",
    "linearize",
];

/// Functions with a block of ten columns for each joint and each link that it moves.
const REGRESSORS: [&str; 2] = ["inertial_regressor", "base_regressor"];

/// Operations of such a block: 39 for the UR5, 75 for a chain of 30 right angles.
const OPERATIONS_PER_BLOCK: usize = 40;

/// Operations of a function, as far as they are known before it is derived.
type Estimate = fn(&Model) -> usize;

/// Joints up to which no function is so large that deriving it takes long.
const FEW_JOINTS: usize = 50;

/// Refuses what is too large, as far as that is known before anything is derived.
///
/// # Errors
/// `too-large`, one entry per function.
pub fn check_before(model: &Model, names: &[&str], most: usize) -> Result<(), Diagnostics> {
    if model.coordinates.len() <= FEW_JOINTS {
        return Ok(());
    }
    let groups: [(&[&str], Estimate); 2] = [
        (&AT_LEAST_MASS_MATRIX, mass_matrix_operations),
        (&REGRESSORS, regressor_operations),
    ];
    let mut refusals = Vec::new();
    for (group, estimate) in groups {
        let wanted: Vec<&&str> = names.iter().filter(|name| group.contains(name)).collect();
        if wanted.is_empty() {
            continue;
        }
        let operations = estimate(model);
        if operations > most {
            let takes = format!("about {operations} operations or more");
            let refused = wanted.into_iter();
            refusals.extend(refused.map(|name| refusal(model, name, &takes, operations, most)));
        }
    }
    match refusals.is_empty() {
        true => Ok(()),
        false => Err(Diagnostics::new(refusals)),
    }
}

/// Refuses a function that became too large.
///
/// # Errors
/// `too-large`
pub fn check(model: &Model, function: &Function, most: usize) -> Result<(), Diagnostics> {
    let cost = count(&function.program);
    let operations = cost.multiplications + cost.additions + cost.divisions;
    if operations <= most {
        return Ok(());
    }
    let takes = format!("{operations} operations");
    Err(Diagnostics::new(vec![refusal(
        model,
        &function.name,
        &takes,
        operations,
        most,
    )]))
}

fn refusal(model: &Model, name: &str, takes: &str, operations: usize, most: usize) -> Diagnostic {
    let joints = model.coordinates.len();
    Diagnostic::error(
        "too-large",
        format!("`{name}` of {joints} joints takes {takes}; {most} are the limit"),
    )
    .help(format!(
        "lift the limit (`--max-operations {}`), or generate smaller functions (`gelenk generate --functions inverse_dynamics`)",
        rounded_up(operations)
    ))
}

/// To two digits, with room for the estimate.
fn rounded_up(operations: usize) -> usize {
    let unit = 10_usize.pow(operations.max(10).ilog10() - 1);
    (operations / unit + 2) * unit
}

/// Operations of M in the plain formulation: the search for a cheaper one would take minutes where this is large.
fn mass_matrix_operations(model: &Model) -> usize {
    let graph = Graph::new();
    let y: Vec<_> = (0..model.coordinates.len())
        .map(|k| graph.input(0, k))
        .collect();
    let formulation = Formulation::plain(y.len());
    let mechanism = formulation.mechanism(&graph, model);
    let matrix = composite::mass_matrix(&mechanism, &formulation, &y).concat();
    let edges: Vec<_> = matrix.iter().map(|x| x.edge()).collect();
    let cost = Cost::of(&graph, &edges);
    usize::try_from(cost.multiplications + cost.additions).unwrap_or(usize::MAX)
}

/// Operations of the regressor, from the number of its blocks.
fn regressor_operations(model: &Model) -> usize {
    let graph = Graph::new();
    let mechanism = Mechanism::new(&graph, model);
    let mut depths: Vec<usize> = Vec::with_capacity(mechanism.len());
    for body in &mechanism.bodies {
        depths.push(body.parent.map_or(1, |parent| depths[parent] + 1));
    }
    OPERATIONS_PER_BLOCK * depths.iter().sum::<usize>()
}
