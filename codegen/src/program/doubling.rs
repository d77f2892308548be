//! `x + x` instead of `2 · x`, where that evens out the kinds of operations.

use super::cost::count;
use super::{Operand, Operation, Program};

/// Replaces doublings by additions as long as the program multiplies a quarter more often than it adds: the
/// bits are the same, an addition costs at most what a multiplication does, and processors with a unit for
/// each wait less for the multiplier. Where the two are almost even nothing is gained.
///
/// A doubling that a sum reads stays, because it may be fused with the sum.
pub(super) fn add_instead_of_doubling(program: &mut Program) {
    let cost = count(program);
    // Each change takes 9 from 4·multiplications − 5·additions.
    let surplus = (4 * cost.multiplications).saturating_sub(5 * cost.additions) / 9;
    let in_sum = read_by_sums(program);
    let doublings = program.instructions.iter_mut().zip(in_sum).filter(|(_, in_sum)| !in_sum);
    let mut left = surplus;
    for (instruction, _) in doublings {
        let Some(x) = doubled(instruction.operation).filter(|_| left > 0) else {
            continue;
        };
        instruction.operation = Operation::Add(x, x);
        left -= 1;
    }
}

/// The x of `2 · x`.
fn doubled(operation: Operation) -> Option<Operand> {
    match operation {
        Operation::Multiply(Operand::Constant(2.0), x) | Operation::Multiply(x, Operand::Constant(2.0)) => {
            Some(x)
        }
        _ => None,
    }
}

/// Whether a sum reads the value of each instruction.
fn read_by_sums(program: &Program) -> Vec<bool> {
    let mut read = vec![false; program.instructions.len()];
    for instruction in &program.instructions {
        if let Operation::Add(a, b) | Operation::Subtract(a, b) = instruction.operation {
            for operand in [a, b] {
                if let Operand::Value(index) = operand {
                    read[index] = true;
                }
            }
        }
    }
    read
}
