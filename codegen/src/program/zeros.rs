//! Entries of results that are zero in every state.

use super::{Operand, Operation, Program};

/// For each entry of each output, `false` if constants of the program make it zero in every state, and `true`
/// otherwise.
pub fn nonzero_entries(program: &Program) -> Vec<Vec<bool>> {
    let mut is_zero: Vec<bool> = Vec::with_capacity(program.instructions.len());
    for instruction in &program.instructions {
        let zero = |operand: Operand| operand_is_zero(&is_zero, operand);
        let value = match instruction.operation {
            Operation::Add(a, b) | Operation::Subtract(a, b) => zero(a) && zero(b),
            Operation::Multiply(a, b) => zero(a) || zero(b),
            Operation::MultiplyAdd(a, b, c) => (zero(a) || zero(b)) && zero(c),
            Operation::Divide(a, _) | Operation::Negate(a) => zero(a),
            Operation::SinCos(_) | Operation::CosineOf(_) | Operation::Call(..) => false,
        };
        is_zero.push(value);
    }
    let entries = |entries: &[Operand]| -> Vec<bool> {
        let entries = entries.iter();
        entries.map(|&entry| !operand_is_zero(&is_zero, entry)).collect()
    };
    let outputs = program.outputs.iter();
    outputs.map(|output| entries(&output.entries)).collect()
}

fn operand_is_zero(values: &[bool], operand: Operand) -> bool {
    match operand {
        Operand::Value(index) => values[index],
        Operand::Constant(number) => number == 0.0,
        Operand::Input(..) | Operand::Parameter(_) => false,
    }
}
