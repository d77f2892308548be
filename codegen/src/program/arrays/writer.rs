//! Writer of a program's instructions.

use crate::program::{Instruction, Operand, Operation};

/// A straight-line program under construction. Instructions get their names at the end.
pub(super) struct Writer {
    pub(super) instructions: Vec<Instruction>,
    /// Whether products and sums are contracted to fused multiply-adds.
    pub(super) is_fused: bool,
}

impl Writer {
    pub(super) fn push(&mut self, operation: Operation) -> Operand {
        self.instructions.push(Instruction { name: String::new(), operation });
        Operand::Value(self.instructions.len() - 1)
    }

    /// The sum `sum + a · b`, fused if the function's products and sums are fused.
    pub(super) fn add_product(&mut self, sum: Operand, a: Operand, b: Operand) -> Operand {
        if self.is_fused {
            return self.push(Operation::MultiplyAdd(a, b, sum));
        }
        let product = self.push(Operation::Multiply(a, b));
        self.push(Operation::Add(sum, product))
    }

    pub(super) fn sum_of_products(&mut self, terms: &[(Operand, Operand)]) -> Operand {
        let mut sum = None;
        for &(a, b) in terms {
            sum = Some(match sum {
                None => self.push(Operation::Multiply(a, b)),
                Some(sum) => self.add_product(sum, a, b),
            });
        }
        sum.unwrap_or(Operand::Constant(0.0))
    }
}
