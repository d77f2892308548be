//! How a function is divided for lanes: its angles, then runs of statements without sines and cosines.

use std::collections::BTreeSet;
use std::ops::Range;

use super::super::into;
use super::super::split::{self, Reads};
use crate::program::flow::{Flow, operands};
use crate::program::{Operand, Operation, Program};

/// What stands apart in a function over lanes.
pub(in crate::emit) struct Plan {
    /// Instructions of the angles: what they are computed from, and each `SinCos`.
    pub(super) angles: Vec<usize>,
    /// The `SinCos` among them.
    pub(super) pairs: Vec<usize>,
    /// Whether an instruction stands in a part: not sines and cosines, nor what only they need.
    pub(super) is_in_part: Vec<bool>,
    /// The rest, in order.
    pub(super) parts: Vec<Part>,
}

/// A run of instructions and what it exchanges with the others.
pub(super) struct Part {
    /// Where it lies in the program.
    pub(super) range: Range<usize>,
    /// Sines, cosines and values of earlier parts that it reads.
    pub(super) takes: Vec<usize>,
    /// Values that it makes and that later parts read.
    pub(super) returns: Vec<usize>,
    /// Input arrays that it reads.
    pub(super) inputs: Vec<usize>,
    pub(super) reads_parameters: bool,
    /// Results that it writes, where they are written in place, and which of their entries: each where it is made, all
    /// others at the end.
    pub(super) results: Vec<(usize, Vec<usize>)>,
}

impl Plan {
    /// `None` where a sine is needed of what is itself computed from a sine or another function.
    ///
    /// - `longest`: statements of a part
    pub(in crate::emit) fn new(program: &Program, flow: &Flow, longest: usize) -> Option<Self> {
        let made = || (0..program.instructions.len()).filter(|&index| flow.is_made(index));
        let pairs: Vec<usize> = made().filter(|&index| is_pair(program, index)).collect();
        let angles = pairs
            .iter()
            .map(|&index| program.instructions[index].operation);
        let before = needed(program, angles.flat_map(operands), |_| true);
        if made().any(|index| before[index] && !is_arithmetic(program, index)) {
            return None;
        }
        let angles = (0..program.instructions.len())
            .filter(|&index| before[index] || pairs.binary_search(&index).is_ok());
        let needed = needed(program, entries(program), |index| {
            !is_trigonometric(program, index)
        });
        let is_in_part: Vec<bool> = (0..program.instructions.len())
            .map(|index| needed[index] && flow.is_made(index) && !is_trigonometric(program, index))
            .collect();
        Some(Self {
            angles: angles.collect(),
            pairs,
            parts: parts(program, flow, longest, &is_in_part),
            is_in_part,
        })
    }
}

/// Why a program cannot be written over lanes, or need not be.
pub(super) fn obstacle(program: &Program) -> Option<&'static str> {
    if program.inputs.iter().all(|input| input.extent.len == 0) {
        return Some("it takes no state: its result is the same for all");
    }
    if entries(program).next().is_none() {
        return Some("its result has no entries");
    }
    match Plan::new(program, &Flow::new(program), usize::MAX) {
        Some(_) => None,
        None => Some("it takes the sine of what is computed from another sine"),
    }
}

fn parts(program: &Program, flow: &Flow, longest: usize, is_in_part: &[bool]) -> Vec<Part> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    let is_empty = |range: &Range<usize>| !is_in_part[range.clone()].contains(&true);
    for part in split::parts(program, flow, longest) {
        // Where nothing but angles stands, there is nothing to loop over.
        match ranges.last_mut() {
            Some(before) if is_empty(before) => before.end = part.range.end,
            _ => ranges.push(part.range),
        }
    }
    let last = ranges.len().saturating_sub(1);
    let parts = ranges.into_iter().enumerate();
    let mut parts: Vec<Part> = parts
        .map(|(index, range)| part(program, flow, is_in_part, range, index == last))
        .collect();
    let mut read_later = BTreeSet::new();
    for part in parts.iter_mut().rev() {
        let is_own = |value: &usize| is_in_part[*value] && part.range.contains(value);
        part.returns = read_later.iter().copied().filter(is_own).collect();
        read_later.extend(part.takes.iter().copied());
    }
    parts
}

fn part(
    program: &Program,
    flow: &Flow,
    is_in_part: &[bool],
    range: Range<usize>,
    is_last: bool,
) -> Part {
    let is_own = |value: usize| is_in_part[value] && range.contains(&value);
    let is_written_here = |entry: Operand| match entry {
        Operand::Value(value) if is_in_part[flow.canonical(value)] => is_own(flow.canonical(value)),
        _ => is_last,
    };
    let in_place = into::is_large(program);
    let mut read: Vec<Operand> = range
        .clone()
        .filter(|&index| is_own(index))
        .flat_map(|index| operands(program.instructions[index].operation))
        .collect();
    read.extend(entries(program).filter(|&entry| match in_place {
        true => is_written_here(entry),
        false => is_last,
    }));
    let read = Reads::new(&read, flow);
    let written = program.outputs.iter().map(|output| {
        let entries = output.entries.iter().enumerate();
        let here = entries.filter(|&(_, &entry)| in_place && is_written_here(entry));
        here.map(|(index, _)| index).collect::<Vec<usize>>()
    });
    let results = written.enumerate().filter(|(_, here)| !here.is_empty());
    Part {
        takes: read.values.into_iter().filter(|&v| !is_own(v)).collect(),
        returns: vec![],
        inputs: read.inputs,
        reads_parameters: read.parameters,
        results: results.collect(),
        range,
    }
}

fn entries(program: &Program) -> impl Iterator<Item = Operand> {
    program
        .outputs
        .iter()
        .flat_map(|output| output.entries.iter().copied())
}

fn is_pair(program: &Program, index: usize) -> bool {
    matches!(program.instructions[index].operation, Operation::SinCos(_))
}

fn is_trigonometric(program: &Program, index: usize) -> bool {
    is_pair(program, index)
        || matches!(
            program.instructions[index].operation,
            Operation::CosineOf(_)
        )
}

fn is_arithmetic(program: &Program, index: usize) -> bool {
    !is_trigonometric(program, index)
        && !matches!(program.instructions[index].operation, Operation::Call(..))
}

/// What `roots` need, through the instructions that may be passed.
fn needed(
    program: &Program,
    roots: impl Iterator<Item = Operand>,
    passes: impl Fn(usize) -> bool,
) -> Vec<bool> {
    let mut needed = vec![false; program.instructions.len()];
    let mark = |needed: &mut Vec<bool>, operand| {
        if let Operand::Value(value) = operand {
            needed[value] = true;
        }
    };
    roots.for_each(|operand| mark(&mut needed, operand));
    for index in (0..needed.len()).rev() {
        if needed[index] && passes(index) {
            let operation = program.instructions[index].operation;
            operands(operation).for_each(|operand| mark(&mut needed, operand));
        }
    }
    needed
}
