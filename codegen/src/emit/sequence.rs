//! Assignment of instructions to statements: one each, except that one call computes sines and cosines of
//! several angles.

use crate::program::flow::Flow;
use crate::program::{Operand, Operation, Program};

/// Instructions that are printed together.
pub(super) struct Group<'i> {
    /// The instructions in order.
    pub(super) instructions: &'i [usize],
    /// The statements in order.
    pub(super) runs: Vec<Run>,
}

/// One statement.
pub(super) enum Run {
    /// A statement for one value, or for sine and cosine of one angle.
    One(usize),
    /// A statement for sines and cosines of several angles.
    Angles {
        /// The instructions with their angles.
        batch: Vec<(usize, Operand)>,
        /// How many angles the call takes: 2, 4 or 8.
        lanes: usize,
    },
}

/// Groups these instructions.
///
/// - `are_batched`: whether one call takes several angles
pub(super) fn groups<'i>(
    program: &Program,
    flow: &Flow,
    instructions: &'i [usize],
    are_batched: bool,
) -> Vec<Group<'i>> {
    let mut groups = Vec::with_capacity(instructions.len());
    let mut rest = instructions;
    while let Some((&first, others)) = rest.split_first() {
        let leading = if are_batched { leading_angles(program, flow, rest) } else { 0 };
        let (angles, after) = rest.split_at(leading);
        if angles.len() > 1 {
            groups.push(Group { instructions: angles, runs: runs(program, angles) });
            rest = after;
        } else {
            groups.push(Group { instructions: &rest[..1], runs: vec![Run::One(first)] });
            rest = others;
        }
    }
    groups
}

/// How many of the first instructions make sine and cosine of angles that are known before all of them.
fn leading_angles(program: &Program, flow: &Flow, instructions: &[usize]) -> usize {
    let start = instructions.first().copied().unwrap_or(0);
    let is_early = |&&index: &&usize| match program.instructions[index].operation {
        Operation::SinCos(Operand::Value(angle)) => flow.made_at[angle] < start,
        Operation::SinCos(_) => true,
        Operation::CosineOf(_) => true,
        _ => false,
    };
    instructions.iter().take_while(is_early).count()
}

/// One call for up to eight angles: they become lanes, and angles in registers avoid the way through
/// memory. Seven angles took 22 ns as one padded call of eight, 31 ns as calls of 4, 2 and 1, 54 ns one
/// by one (AVX2).
fn runs(program: &Program, instructions: &[usize]) -> Vec<Run> {
    let angle = |&index: &usize| match program.instructions[index].operation {
        Operation::SinCos(angle) => Some((index, angle)),
        _ => None,
    };
    let angles: Vec<(usize, Operand)> = instructions.iter().filter_map(angle).collect();
    let mut rest = angles.as_slice();
    let mut runs = Vec::new();
    while !rest.is_empty() {
        let lanes = match rest.len() {
            1 => 1,
            2 => 2,
            3..=6 => 4,
            _ => 8,
        };
        let (batch, others) = rest.split_at(lanes.min(rest.len()));
        runs.push(match batch {
            [(index, _)] => Run::One(*index),
            batch => Run::Angles { batch: batch.to_vec(), lanes },
        });
        rest = others;
    }
    runs
}
