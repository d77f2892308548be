//! Moves sines and cosines to the beginning if their angles are known there, so that one call can compute
//! several of them.

use super::flow::operands;
use super::{Operand, Operation, Output, Program};

/// Moves each `SinCos` to the front if its angle depends on no other function. The computation of the angle
/// is moved, too. Angles of one input array keep their order. Operations do not change, so results keep all
/// bits.
///
/// The moved `SinCos` instructions are adjacent. The cosine of an angle follows its `SinCos` if the program
/// needs the cosine.
pub(super) fn angles_first(program: Program) -> Program {
    let early = early_angles(&program);
    let mut is_moved = vec![false; program.instructions.len()];
    let mut order = Vec::with_capacity(is_moved.len());
    for &angle in &early {
        move_operands(&program, angle, &mut is_moved, &mut order);
    }
    for &angle in &early {
        is_moved[angle] = true;
        order.push(angle);
        let cosines = (angle + 1..is_moved.len())
            .take_while(|&next| program.instructions[next].operation == Operation::CosineOf(angle));
        for cosine in cosines {
            is_moved[cosine] = true;
            order.push(cosine);
        }
    }
    order.extend((0..is_moved.len()).filter(|&index| !is_moved[index]));
    reordered(program, &order)
}

/// Indices of all `SinCos` whose angle depends on no other function. Angles that are input entries are first.
fn early_angles(program: &Program) -> Vec<usize> {
    let mut needs_function = Vec::with_capacity(program.instructions.len());
    let mut early = Vec::new();
    for (index, instruction) in program.instructions.iter().enumerate() {
        let reads_function = operands(instruction.operation)
            .any(|operand| matches!(operand, Operand::Value(value) if needs_function[value]));
        let is_cheap = matches!(
            instruction.operation,
            Operation::Add(..) | Operation::Subtract(..) | Operation::Multiply(..) | Operation::Negate(_)
        );
        if matches!(instruction.operation, Operation::SinCos(_)) && !reads_function {
            early.push(index);
        }
        needs_function.push(reads_function || !is_cheap);
    }
    early.sort_by_key(|&index| match program.instructions[index].operation {
        Operation::SinCos(Operand::Input(array, entry)) => (0, array, entry),
        _ => (1, index, 0),
    });
    early
}

/// Appends the operands of an instruction to the new order, earliest first. There are few operands, because
/// an angle is a sum of a few joint positions.
fn move_operands(program: &Program, index: usize, is_moved: &mut [bool], order: &mut Vec<usize>) {
    let mut pending: Vec<(usize, bool)> = read_values(program, index);
    while let Some((value, is_ready)) = pending.pop() {
        if is_moved[value] {
            continue;
        }
        if is_ready {
            is_moved[value] = true;
            order.push(value);
        } else {
            pending.push((value, true));
            pending.extend(read_values(program, value));
        }
    }
}

fn read_values(program: &Program, index: usize) -> Vec<(usize, bool)> {
    operands(program.instructions[index].operation)
        .filter_map(|operand| match operand {
            Operand::Value(value) => Some((value, false)),
            _ => None,
        })
        .collect()
}

/// The program with its instructions in this order. Operands must precede the instructions that use them.
pub(super) fn reordered(program: Program, order: &[usize]) -> Program {
    let mut place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new;
    }
    let moved = |operand: Operand| match operand {
        Operand::Value(value) => Operand::Value(place[value]),
        other => other,
    };
    let instructions = order.iter().map(|&old| {
        let mut instruction = program.instructions[old].clone();
        instruction.operation = match instruction.operation {
            Operation::CosineOf(pair) => Operation::CosineOf(place[pair]),
            operation => operation.map(moved),
        };
        instruction
    });
    let outputs = program.outputs.iter().map(|output| Output {
        entries: output.entries.iter().map(|&entry| moved(entry)).collect(),
        ..output.clone()
    });
    Program {
        instructions: instructions.collect(),
        outputs: outputs.collect(),
        inputs: program.inputs.clone(),
    }
}
