//! Division of long programs into parts, because compile time grows faster than the length of a function.
//!
//! Parts follow each other in the order of the program. No operation moves, so results keep all bits. Each
//! part can become a function. Its arguments are the earlier values that the part uses, and its results are
//! the values that later parts use.

use std::collections::BTreeSet;
use std::ops::Range;

use super::flow::{Flow, operands};
use super::{Operand, Program};

/// A part of a long program: a sequence of instructions, and the values that it exchanges with other parts.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// Range of the part's instructions in the program.
    pub(crate) range: Range<usize>,
    /// Values of earlier parts that the part uses.
    pub(crate) takes: Vec<usize>,
    /// Values that later parts use, and results of the program if the part does not write them.
    pub(crate) returns: Vec<usize>,
    /// Input arrays that the part uses.
    pub(crate) inputs: Vec<usize>,
    /// Whether the part uses free parameters.
    pub(crate) reads_parameters: bool,
    /// Results that the part writes, each with the indices of the written entries. Empty if results are
    /// written after all parts.
    pub(crate) results: Vec<(usize, Vec<usize>)>,
}

impl Part {
    /// Makes a part of a program with the given operands, without results.
    ///
    /// - `is_own`: returns whether the part computes a value
    pub(super) fn new(
        range: Range<usize>,
        read: impl IntoIterator<Item = Operand>,
        flow: &Flow,
        is_own: impl Fn(usize) -> bool,
    ) -> Self {
        let read = Reads::new(read.into_iter(), flow);
        let takes = read.values.into_iter();
        Self {
            takes: takes.filter(|&value| !is_own(value)).collect(),
            returns: vec![],
            inputs: read.inputs,
            reads_parameters: read.parameters,
            results: vec![],
            range,
        }
    }
}

/// Divides a program into parts. A program with at most `longest` statements has one part.
pub(crate) fn parts(program: &Program, flow: &Flow, longest: usize) -> Vec<Part> {
    let cuts = cuts(program, flow, longest.max(1));
    let parts = cuts.windows(2).map(|cut| {
        let range = cut[0]..cut[1];
        let made = range.clone().filter(|&index| flow.is_made(index));
        let read = made.flat_map(|index| operands(program.instructions[index].operation));
        let is_own = |value: usize| flow.made_at[value] >= range.start;
        Part::new(range.clone(), read, flow, is_own)
    });
    let mut parts: Vec<Part> = parts.collect();
    let results = values(program.entries(), flow);
    hand_on(&mut parts, results, |part, value| part.range.contains(&flow.made_at[value]));
    parts
}

/// Sets the values that each part returns: values that later parts use, or that are in `read_later`.
pub(super) fn hand_on(
    parts: &mut [Part],
    mut read_later: BTreeSet<usize>,
    is_own: impl Fn(&Part, usize) -> bool,
) {
    for part in parts.iter_mut().rev() {
        let returns = read_later.iter().copied();
        part.returns = returns.filter(|&value| is_own(part, value)).collect();
        read_later.extend(&part.takes);
    }
}

fn values(operands: impl Iterator<Item = Operand>, flow: &Flow) -> BTreeSet<usize> {
    let value = |operand| match operand {
        Operand::Value(index) => Some(flow.canonical(index)),
        _ => None,
    };
    operands.filter_map(value).collect()
}

/// Values that a sequence of instructions uses.
pub(crate) struct Reads {
    values: BTreeSet<usize>,
    /// Input arrays that the instructions use.
    pub(crate) inputs: Vec<usize>,
    /// Whether the instructions use free parameters.
    pub(crate) parameters: bool,
}

impl Reads {
    pub(crate) fn new(operands: impl Iterator<Item = Operand>, flow: &Flow) -> Self {
        let operands: Vec<Operand> = operands.collect();
        let arrays = operands.iter().filter_map(|operand| match operand {
            Operand::Input(array, _) => Some(*array),
            _ => None,
        });
        let arrays: BTreeSet<usize> = arrays.collect();
        let is_parameter = |operand: &Operand| matches!(operand, Operand::Parameter(_));
        Self {
            inputs: arrays.into_iter().collect(),
            parameters: operands.iter().any(is_parameter),
            values: values(operands.into_iter(), flow),
        }
    }
}

/// Boundaries of the parts. The first boundary is 0, and the last is the number of instructions. Each part
/// has at most `longest` statements. A part ends in the second half of this range, at the place with the
/// fewest values that are used later.
fn cuts(program: &Program, flow: &Flow, longest: usize) -> Vec<usize> {
    let len = program.instructions.len();
    let alive = alive_before(program, flow);
    let statements: Vec<usize> = (0..len).filter(|&index| flow.is_made(index)).collect();
    let mut cuts = vec![0];
    let mut done = 0;
    while statements.len() - done > longest {
        let candidates = done + longest.div_ceil(2)..=done + longest;
        let best = candidates.rev().min_by_key(|&next| alive[statements[next]]).unwrap_or(done + longest);
        cuts.push(statements[best]);
        done = best;
    }
    cuts.push(len);
    cuts
}

/// For each instruction and for the end of the program: the number of values that are computed earlier and
/// used at this instruction or later.
fn alive_before(program: &Program, flow: &Flow) -> Vec<usize> {
    let len = program.instructions.len();
    let mut last_read: Vec<Option<usize>> = vec![None; len];
    for index in (0..len).filter(|&index| flow.is_made(index)) {
        for value in values(operands(program.instructions[index].operation), flow) {
            last_read[value] = Some(index);
        }
    }
    for value in values(program.entries(), flow) {
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
    running.take(len + 1).collect()
}

/// Largest number of values that are in use at the same time. Results are in use until the end.
pub(crate) fn most_alive(program: &Program, flow: &Flow) -> usize {
    alive_before(program, flow).into_iter().max().unwrap_or(0)
}
