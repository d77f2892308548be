//! Forces that act on single joints: springs, friction, drives.

use crate::formula::{Formula, Function};
use crate::graph::{Graph, Scalar};
use crate::kinematics::{lower, lower_with};
use crate::model::{FrictionTerm, Input, Joint, Model};
use crate::program::{Instruction, Operation, Program};

/// Forces of springs and dampers by coordinate; they add to q.
pub fn spring_forces<'g>(
    graph: &'g Graph,
    model: &Model,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
) -> Vec<Scalar<'g>> {
    let zero = graph.constant(0.0);
    let force = |(index, joint): (usize, &Joint)| {
        let forces = joint.springs.iter().map(|spring| lower_with(graph, spring, y[index], v[index]));
        forces.fold(zero, |sum, force| sum + force)
    };
    model.joints().enumerate().map(force).collect()
}

/// Tells whether a friction law depends on the position of its joint. Friction is τ(y, ẏ) then, else τ(ẏ).
pub fn friction_depends_on_position(model: &Model) -> bool {
    let terms = model.joints().flat_map(|joint| &joint.friction);
    terms.map(|term| &term.basis).any(Formula::depends_on_position)
}

/// Friction torques τ by coordinate; they are subtracted from q.
///
/// - `y`: may be empty where no law depends on the position
pub fn friction_torques<'g>(
    graph: &'g Graph,
    model: &Model,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
) -> Vec<Scalar<'g>> {
    let joints = model.joints().enumerate();
    joints.map(|(index, joint)| friction_sum(graph, &joint.friction, y.get(index), v[index])).collect()
}

/// The sum of friction terms of one joint.
pub(super) fn friction_sum<'g>(
    graph: &'g Graph,
    terms: &[FrictionTerm],
    y: Option<&Scalar<'g>>,
    v: Scalar<'g>,
) -> Scalar<'g> {
    terms.iter().fold(graph.constant(0.0), |sum, term| {
        let basis = friction_basis(graph, term, y, v);
        sum + lower(graph, &term.coefficient) * basis
    })
}

fn friction_basis<'g>(
    graph: &'g Graph,
    term: &FrictionTerm,
    y: Option<&Scalar<'g>>,
    v: Scalar<'g>,
) -> Scalar<'g> {
    let y = match (y, term.basis.depends_on_position()) {
        (Some(&y), _) => y,
        // Never read.
        (None, false) => graph.constant(0.0),
        (None, true) => unreachable!("friction that depends on y is asked for with y"),
    };
    lower_with(graph, &term.basis, y, v)
}

/// A column of the friction regressor.
#[derive(Debug, Clone, Copy)]
pub struct FrictionColumn<'g> {
    /// Coordinate that it brakes.
    pub coordinate: usize,
    /// Function of position and velocity.
    pub basis: Scalar<'g>,
}

/// The basis functions of all friction laws by coordinate, each once.
///
/// - `y`: may be empty where no law depends on the position
pub fn friction_columns<'g>(
    graph: &'g Graph,
    model: &Model,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
) -> Vec<FrictionColumn<'g>> {
    let column = |coordinate: usize, terms: &[&FrictionTerm]| FrictionColumn {
        coordinate,
        basis: friction_basis(graph, terms[0], y.get(coordinate), v[coordinate]),
    };
    model
        .joints()
        .enumerate()
        .flat_map(|(coordinate, joint)| {
            let groups = terms_by_basis(joint).into_iter();
            groups.map(move |(_, terms)| (coordinate, terms))
        })
        .map(|(coordinate, terms)| column(coordinate, &terms))
        .collect()
}

/// Coefficients of the friction regressor's columns as described, those of one basis function added up.
pub fn friction_coefficients<'g>(graph: &'g Graph, model: &Model) -> Vec<Scalar<'g>> {
    let sum = |(_, terms): (&Formula, Vec<&FrictionTerm>)| {
        let coefficients = terms.iter().map(|term| lower(graph, &term.coefficient));
        coefficients.fold(graph.constant(0.0), |sum, c| sum + c)
    };
    model.joints().flat_map(|joint| terms_by_basis(joint).into_iter().map(sum)).collect()
}

/// Names of the columns: `joint: tanh(10*v)`.
pub fn friction_names(model: &Model) -> Vec<String> {
    let parameters: Vec<&str> = model.parameters.iter().map(|p| p.name.as_str()).collect();
    let names = |joint| {
        let bases = terms_by_basis(joint).into_iter();
        let name = |(basis, _): (&Formula, _)| format!("{}: {}", joint.name, basis.text(&parameters));
        bases.map(name).collect::<Vec<_>>()
    };
    model.joints().flat_map(names).collect()
}

/// Basis functions of a joint in their order, each with its terms.
fn terms_by_basis(joint: &Joint) -> Vec<(&Formula, Vec<&FrictionTerm>)> {
    let mut groups: Vec<(&Formula, Vec<&FrictionTerm>)> = Vec::new();
    for term in &joint.friction {
        match groups.iter_mut().find(|(basis, _)| **basis == term.basis) {
            Some((_, terms)) => terms.push(term),
            None => groups.push((&term.basis, vec![term])),
        }
    }
    groups
}

/// Input matrix B, rows first: gear ratio, times the motor constant where the input is a current.
pub fn input_matrix<'g>(graph: &'g Graph, model: &Model) -> Vec<Vec<Scalar<'g>>> {
    let zero = graph.constant(0.0);
    let drives: Vec<_> = model.inputs().collect();
    let mut matrix = vec![vec![zero; drives.len()]; model.coordinates.len()];
    for (column, drive) in drives.iter().enumerate() {
        let Some(row) = drive.coordinate else {
            continue;
        };
        let ratio = lower(graph, &drive.gear_ratio);
        matrix[row][column] = match &drive.input {
            Input::Torque => ratio,
            Input::Current(constant) => ratio * lower(graph, constant),
        };
    }
    matrix
}

/// The note in a function's documentation where a force law jumps.
pub fn jump_note(model: &Model, program: &Program) -> Option<String> {
    let is_sign = |step: &Instruction| matches!(step.operation, Operation::Call(Function::Sign, _));
    (model.joints().any(Joint::jumps) && program.instructions.iter().any(is_sign)).then(|| {
        "`sign` is exact: it jumps at zero, and its derivative is taken as zero everywhere. `--smooth-sign SLOPE`, or \
         `smooth_sign` in the description, makes it `tanh(SLOPE v)`."
            .to_owned()
    })
}
