//! Divides a function over lanes (several states at once) into two kinds of code: the angles with their sines and
//! cosines, and parts without sines and cosines.

use std::collections::BTreeSet;
use std::ops::Range;

use super::flow::{Flow, operands};
use super::split::{self, Part};
use super::{Operand, Operation, Program};

/// Division of a function over lanes (several states at once) into parts.
pub(crate) struct Plan {
    /// Indices of the instructions that compute the angles, and of the `SinCos` instructions.
    pub(crate) angles: Vec<usize>,
    /// Indices of the `SinCos` instructions, which compute sine and cosine of an angle.
    pub(crate) pairs: Vec<usize>,
    /// For each instruction, whether it is in a part. Sines and cosines, and values that only they use, are
    /// not in a part.
    pub(crate) is_in_part: Vec<bool>,
    /// Parts of the function with all instructions except sines, cosines and the values that only they use,
    /// in order.
    pub(crate) parts: Vec<Part>,
}

impl Plan {
    /// Divides a program into its angles and parts. `None` if an angle of the program depends on a sine or
    /// another function.
    ///
    /// - `longest`: largest number of statements of a part
    pub(crate) fn new(program: &Program, flow: &Flow, longest: usize) -> Option<Self> {
        let made = || (0..program.instructions.len()).filter(|&index| flow.is_made(index));
        let pairs: Vec<usize> = made().filter(|&index| is_pair(program, index)).collect();
        let angles = pairs.iter().map(|&index| program.instructions[index].operation);
        let before = needed(program, angles.flat_map(operands), |_| true);
        if made().any(|index| before[index] && !is_arithmetic(program, index)) {
            return None;
        }
        let angles = (0..program.instructions.len())
            .filter(|&index| before[index] || pairs.binary_search(&index).is_ok());
        let needed = needed(program, program.entries(), |index| !is_trigonometric(program, index));
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

/// Reason why a program cannot be written over lanes (several states at once); `None` if it can.
pub(crate) fn obstacle(program: &Program) -> Option<&'static str> {
    if program.inputs.iter().all(|input| input.extent.len == 0) {
        return Some("it has no argument, so its result is the same for all states");
    }
    if program.entries().next().is_none() {
        return Some("its result has no entries");
    }
    match Plan::new(program, &Flow::new(program), usize::MAX) {
        Some(_) => None,
        None => Some("it contains a sine whose angle depends on another sine"),
    }
}

fn parts(program: &Program, flow: &Flow, longest: usize, is_in_part: &[bool]) -> Vec<Part> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    let is_empty = |range: &Range<usize>| !is_in_part[range.clone()].contains(&true);
    for part in split::parts(program, flow, longest) {
        // A range without other instructions than angles needs no loop.
        match ranges.last_mut() {
            Some(before) if is_empty(before) => before.end = part.range.end,
            _ => ranges.push(part.range),
        }
    }
    let last = ranges.len().saturating_sub(1);
    let parts = ranges.into_iter().enumerate();
    let mut parts: Vec<Part> =
        parts.map(|(index, range)| part(program, flow, is_in_part, range, index == last)).collect();
    split::hand_on(&mut parts, BTreeSet::new(), |part, value| {
        is_in_part[value] && part.range.contains(&value)
    });
    parts
}

/// Makes a part of a function for several states at once. Entries of large results are written in the part
/// that computes them. All other entries are written at the end.
fn part(program: &Program, flow: &Flow, is_in_part: &[bool], range: Range<usize>, is_last: bool) -> Part {
    let is_own = |value: usize| is_in_part[value] && range.contains(&value);
    let in_place = program.has_large_results();
    let is_written_here = |entry: Operand| match entry {
        Operand::Value(value) if in_place && is_in_part[flow.canonical(value)] => {
            is_own(flow.canonical(value))
        }
        _ => is_last,
    };
    let own = range.clone().filter(|&index| is_own(index));
    let read = own.flat_map(|index| operands(program.instructions[index].operation));
    let read = read.chain(program.entries().filter(|&entry| is_written_here(entry)));
    let written = program.outputs.iter().map(|output| {
        let entries = output.entries.iter().enumerate();
        let here = entries.filter(|&(_, &entry)| in_place && is_written_here(entry));
        here.map(|(index, _)| index).collect::<Vec<usize>>()
    });
    let results = written.enumerate().filter(|(_, here)| !here.is_empty());
    Part { results: results.collect(), ..Part::new(range.clone(), read, flow, is_own) }
}

fn is_pair(program: &Program, index: usize) -> bool {
    matches!(program.instructions[index].operation, Operation::SinCos(_))
}

fn is_trigonometric(program: &Program, index: usize) -> bool {
    is_pair(program, index) || matches!(program.instructions[index].operation, Operation::CosineOf(_))
}

fn is_arithmetic(program: &Program, index: usize) -> bool {
    !is_trigonometric(program, index) && !matches!(program.instructions[index].operation, Operation::Call(..))
}

/// For each instruction, whether `roots` depend on it through instructions for which `passes` returns true.
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
