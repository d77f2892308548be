//! Data flow of a program: which values are used, and which instructions compute them.

use super::{Operand, Operation, Program};

/// Data flow between the instructions of a program.
#[derive(Debug, Clone)]
pub(crate) struct Flow {
    /// For each value, whether the text uses it by name and a result depends on it.
    pub(crate) is_read: Vec<bool>,
    /// For each `SinCos` instruction, the value of its cosine; `None` if the cosine is not used.
    pub(crate) cosine: Vec<Option<usize>>,
    /// For each value, the index of the instruction that computes it. For a cosine it is the index of the
    /// `SinCos` instruction.
    pub(crate) made_at: Vec<usize>,
}

impl Flow {
    pub(crate) fn new(program: &Program) -> Self {
        let len = program.instructions.len();
        let made_at = (0..len)
            .map(|index| match program.instructions[index].operation {
                Operation::CosineOf(pair) => pair,
                _ => index,
            })
            .collect();
        let mut flow = Self { is_read: vec![false; len], cosine: vec![None; len], made_at };
        program.outputs.iter().flat_map(|output| &output.entries).for_each(|&entry| flow.read(entry));
        for index in (0..len).rev() {
            flow.visit(index, program.instructions[index].operation);
        }
        flow
    }

    fn visit(&mut self, index: usize, operation: Operation) {
        if let Operation::CosineOf(pair) = operation {
            // The first cosine of a `SinCos` names the value. The loop runs backwards, so the first cosine is
            // visited last.
            if self.is_read[index] && pair < self.cosine.len() {
                self.cosine[pair] = Some(index);
            }
        } else if self.is_made(index) {
            operands(operation).for_each(|operand| self.read(operand));
        }
    }

    fn read(&mut self, operand: Operand) {
        if let Operand::Value(index) = operand
            && let Some(is_read) = self.is_read.get_mut(index)
        {
            *is_read = true;
        }
    }

    /// Whether the program needs a statement for this instruction.
    pub(crate) fn is_made(&self, index: usize) -> bool {
        self.is_read[index] || self.cosine[index].is_some()
    }

    /// Index of the first value that is equal to value `index`. All cosines of one `SinCos` instruction are
    /// equal.
    pub(crate) fn canonical(&self, index: usize) -> usize {
        let pair = self.made_at[index];
        if pair == index { index } else { self.cosine.get(pair).copied().flatten().unwrap_or(index) }
    }
}

/// Operands of an operation. For a `CosineOf`, the instruction that computes the cosine is not included.
pub(crate) fn operands(operation: Operation) -> impl Iterator<Item = Operand> {
    let operands = match operation {
        Operation::Add(a, b)
        | Operation::Subtract(a, b)
        | Operation::Multiply(a, b)
        | Operation::Divide(a, b) => [Some(a), Some(b), None],
        Operation::MultiplyAdd(a, b, c) => [Some(a), Some(b), Some(c)],
        Operation::Negate(a) | Operation::SinCos(a) | Operation::Call(_, a) => [Some(a), None, None],
        Operation::CosineOf(_) => [None, None, None],
    };
    operands.into_iter().flatten()
}
