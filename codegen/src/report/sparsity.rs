//! Sparsity patterns of a robot's matrices on its page.

use gelenk_report::Pattern;

use super::robot::Robot;
use crate::program::{Program, Shape, nonzero_entries};

/// Matrices whose patterns are shown: function, index among its results, identifier, title.
const MATRICES: &[(&str, usize, &str, &str)] = &[
    ("mass_matrix", 0, "pattern-m", "$M$"),
    ("input_matrix", 0, "pattern-b", "$B$"),
    ("inverse_dynamics_derivatives", 1, "pattern-f-y", r"$\partial f/\partial y$"),
    ("inverse_dynamics_derivatives", 2, "pattern-f-v", r"$\partial f/\partial \dot y$"),
    ("linearize", 0, "pattern-a-y", r"$\partial \ddot y/\partial y$"),
    ("linearize", 1, "pattern-a-v", r"$\partial \ddot y/\partial \dot y$"),
    ("linearize", 2, "pattern-b-x", r"$\partial \ddot y/\partial u$"),
];

/// Patterns of all non-empty matrices.
pub(super) fn patterns(robot: &Robot<'_>) -> Vec<Pattern> {
    let joints: Vec<String> = robot.joints().iter().map(|joint| joint.name.clone()).collect();
    let drives: Vec<String> = robot.inputs().iter().map(|input| input.name().to_owned()).collect();
    let pattern = |&(function, result, id, title): &(&str, usize, &str, &str)| {
        let program = &robot.function(function)?.program;
        let entries = entries(program, result)?;
        let is_by_inputs = matches!(id, "pattern-b" | "pattern-b-x");
        let columns = if is_by_inputs { &drives } else { &joints };
        Some(Pattern::new(id, title, joints.clone(), columns.clone(), entries))
    };
    MATRICES.iter().filter_map(pattern).collect()
}

fn entries(program: &Program, result: usize) -> Option<Vec<Vec<bool>>> {
    let Shape::Matrix(_, columns) = program.outputs.get(result)?.shape else {
        return None;
    };
    if columns.len == 0 {
        return None;
    }
    let entries = nonzero_entries(program).swap_remove(result);
    Some(entries.chunks(columns.len).map(<[bool]>::to_vec).collect())
}
