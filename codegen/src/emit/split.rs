//! Splits a long program into parts, since the time that rustc needs grows faster than the length of a function.
//!
//! Parts follow one another in the order of the program; no operation moves, so that every bit of the results stays.
//! Each becomes a private function that takes the values it reads and returns those that are read later.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::program::flow::{Flow, operands};
use crate::program::{Operand, Program};

/// A run of instructions and what it exchanges with the others.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// Its instructions.
    pub(super) range: Range<usize>,
    /// Values made before that it reads.
    pub(super) takes: Vec<usize>,
    /// Values that it makes and that later parts or the results read.
    pub(super) returns: Vec<usize>,
    /// Input arrays that it reads.
    pub(super) inputs: Vec<usize>,
    /// Whether it reads parameters.
    pub(super) reads_parameters: bool,
}

/// The parts of a program: one, unless it has more than `longest` statements.
pub(super) fn parts(program: &Program, flow: &Flow, longest: usize) -> Vec<Part> {
    let cuts = cuts(program, flow, longest.max(1));
    let mut parts: Vec<Part> = cuts
        .windows(2)
        .map(|cut| part(program, flow, cut[0]..cut[1]))
        .collect();
    let mut read_later: BTreeSet<usize> = values(
        program.outputs.iter().flat_map(|output| &output.entries),
        flow,
    );
    for part in parts.iter_mut().rev() {
        part.returns = read_later
            .iter()
            .copied()
            .filter(|&value| part.range.contains(&flow.made_at[value]))
            .collect();
        read_later.extend(&part.takes);
    }
    parts
}

fn values<'a>(operands: impl Iterator<Item = &'a Operand>, flow: &Flow) -> BTreeSet<usize> {
    operands
        .filter_map(|operand| match operand {
            Operand::Value(index) => Some(flow.canonical(*index)),
            _ => None,
        })
        .collect()
}

fn part(program: &Program, flow: &Flow, range: Range<usize>) -> Part {
    let made = range.clone().filter(|&index| flow.is_made(index));
    let read: Vec<Operand> = made
        .flat_map(|index| operands(program.instructions[index].operation))
        .collect();
    let read = Reads::new(&read, flow);
    let before = read.values.into_iter();
    Part {
        takes: before
            .filter(|&value| flow.made_at[value] < range.start)
            .collect(),
        returns: vec![],
        inputs: read.inputs,
        reads_parameters: read.parameters,
        range,
    }
}

/// What a run of instructions reads.
pub(super) struct Reads {
    pub(super) values: BTreeSet<usize>,
    /// Input arrays.
    pub(super) inputs: Vec<usize>,
    /// Whether there are parameters among it.
    pub(super) parameters: bool,
}

impl Reads {
    pub(super) fn new(operands: &[Operand], flow: &Flow) -> Self {
        let arrays = operands.iter().filter_map(|operand| match operand {
            Operand::Input(array, _) => Some(*array),
            _ => None,
        });
        let arrays: BTreeSet<usize> = arrays.collect();
        let is_parameter = |operand: &Operand| matches!(operand, Operand::Parameter(_));
        Self {
            values: values(operands.iter(), flow),
            inputs: arrays.into_iter().collect(),
            parameters: operands.iter().any(is_parameter),
        }
    }
}

/// Boundaries of the parts, first 0 and last the number of instructions. Each part has at most `longest` statements
/// and ends, within its second half, where the fewest values are alive.
fn cuts(program: &Program, flow: &Flow, longest: usize) -> Vec<usize> {
    let len = program.instructions.len();
    let alive = alive_before(program, flow);
    let statements: Vec<usize> = (0..len).filter(|&index| flow.is_made(index)).collect();
    let mut cuts = vec![0];
    let mut done = 0;
    while statements.len() - done > longest {
        let candidates = done + longest.div_ceil(2)..=done + longest;
        let best = candidates
            .rev()
            .min_by_key(|&next| alive[statements[next]])
            .unwrap_or(done + longest);
        cuts.push(statements[best]);
        done = best;
    }
    cuts.push(len);
    cuts
}

/// For each instruction, how many values made before it are read by it or later.
fn alive_before(program: &Program, flow: &Flow) -> Vec<usize> {
    let len = program.instructions.len();
    let mut last_read: Vec<Option<usize>> = vec![None; len];
    for index in (0..len).filter(|&index| flow.is_made(index)) {
        for value in values(
            operands(program.instructions[index].operation)
                .collect::<Vec<_>>()
                .iter(),
            flow,
        ) {
            last_read[value] = Some(index);
        }
    }
    for value in values(
        program.outputs.iter().flat_map(|output| &output.entries),
        flow,
    ) {
        last_read[value] = Some(len);
    }
    let mut change = vec![0_isize; len + 2];
    for (value, last) in last_read.iter().enumerate() {
        if let Some(last) = last {
            change[flow.made_at[value] + 1] += 1;
            change[last + 1] -= 1;
        }
    }
    let running = change.iter().scan(0_isize, |alive, step| {
        *alive += step;
        Some(usize::try_from(*alive).unwrap_or(0))
    });
    running.take(len).collect()
}
