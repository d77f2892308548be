//! Replaces multiplications `2 · x` by additions `x + x`.

use super::cost::count;
use super::{Operand, Operation, Program};

/// Replaces `2 · x` by `x + x` as long as the program has over a quarter more multiplications than additions.
/// Results keep all bits. An addition costs at most as much as a multiplication, and processors with separate
/// units for both are then used evenly.
///
/// A product that is a term of a sum is kept, because it may be fused with the sum.
pub(super) fn add_instead_of_doubling(program: &mut Program) {
    let cost = count(program);
    // Each replacement reduces 4·multiplications − 5·additions by 9.
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

/// The operand x of `2 · x`; `None` for other operations.
fn doubled(operation: Operation) -> Option<Operand> {
    match operation {
        Operation::Multiply(Operand::Constant(2.0), x) | Operation::Multiply(x, Operand::Constant(2.0)) => {
            Some(x)
        }
        _ => None,
    }
}

/// For each instruction, whether a sum or difference has its value as an operand.
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
