//! Forces that act on single joints: springs, friction, drives.

use crate::formula::Function;
use crate::graph::{Graph, Scalar};
use crate::kinematics::{lower, lower_with};
use crate::model::{Input, Joint, Model};

/// The joint of each coordinate.
fn joints(model: &Model) -> impl Iterator<Item = &Joint> {
    model
        .coordinates
        .iter()
        .filter_map(|&link| model.links[link].joint.as_ref())
}

/// Forces of springs and dampers by coordinate; they add to q.
pub fn spring_forces<'g>(
    graph: &'g Graph,
    model: &Model,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
) -> Vec<Scalar<'g>> {
    let zero = graph.constant(0.0);
    let force = |(index, joint): (usize, &Joint)| {
        let forces = joint
            .springs
            .iter()
            .map(|spring| lower_with(graph, spring, y[index], v[index]));
        forces.fold(zero, |sum, force| sum + force)
    };
    joints(model).enumerate().map(force).collect()
}

/// Friction torques τ(ẏ) by coordinate; they are subtracted from q.
pub fn friction_torques<'g>(graph: &'g Graph, model: &Model, v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    let terms = friction_terms(graph, model, v);
    let zero = graph.constant(0.0);
    terms
        .iter()
        .map(|terms| {
            terms
                .iter()
                .fold(zero, |sum, &(factor, basis)| sum + factor * basis)
        })
        .collect()
}

/// Coefficient and basis function of each friction term, by coordinate.
pub fn friction_terms<'g>(
    graph: &'g Graph,
    model: &Model,
    v: &[Scalar<'g>],
) -> Vec<Vec<(Scalar<'g>, Scalar<'g>)>> {
    let zero = graph.constant(0.0);
    let lowered = |(index, joint): (usize, &Joint)| {
        let terms = joint.friction.iter().map(|term| {
            let basis = lower_with(graph, &term.basis, zero, v[index]);
            (lower(graph, &term.coefficient), basis)
        });
        terms.collect()
    };
    joints(model).enumerate().map(lowered).collect()
}

/// Input matrix B, rows first: gear ratio, times the motor constant where the input is a current.
pub fn input_matrix<'g>(graph: &'g Graph, model: &Model) -> Vec<Vec<Scalar<'g>>> {
    let zero = graph.constant(0.0);
    let drives: Vec<_> = model
        .drives
        .iter()
        .filter(|drive| drive.coordinate.is_some())
        .collect();
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

/// Whether any friction law has a term that jumps.
pub fn has_jumps(model: &Model) -> bool {
    joints(model).any(|joint| {
        let bases = joint.friction.iter().map(|term| &term.basis);
        bases
            .chain(&joint.springs)
            .any(|formula| formula.calls(Function::Sign))
    })
}
