//! Compilation of expressions to operations. Equal operations exist only once.

use super::arithmetic::{Operation, binary, unary};
use crate::error::{IdentificationError, Result};
use gelenk_formula::{Expression, Node};

/// Compiler that appends the operations of one expression to those of earlier expressions.
pub(super) struct Compiler<'a> {
    pub names: &'a [String],
    pub operations: &'a mut Vec<Operation>,
}

impl Compiler<'_> {
    /// Returns the register that contains the value of the expression.
    pub(crate) fn compile(&mut self, expression: &Expression) -> Result<usize> {
        let operation = match &expression.node {
            Node::Number(value) => Operation::Constant(*value),
            Node::Truth(value) => Operation::Constant(f64::from(*value)),
            Node::Name(name) => self.channel(name)?,
            Node::Unary(f, a) => Operation::Unary(*f, self.compile(a)?),
            Node::Power(a, exponent) => Operation::Power(self.compile(a)?, *exponent),
            Node::Binary(f, operands) => {
                let [a, b] = &**operands;
                Operation::Binary(*f, self.compile(a)?, self.compile(b)?)
            }
        };
        Ok(self.push(operation))
    }

    fn channel(&self, name: &str) -> Result<Operation> {
        match self.names.iter().position(|n| n == name) {
            Some(channel) => Ok(Operation::Channel(channel)),
            None if name == "pi" => Ok(Operation::Constant(std::f64::consts::PI)),
            None => {
                Err(IdentificationError::UnknownChannel { name: name.into(), known: self.names.to_vec() })
            }
        }
    }

    /// Adds an operation, or finds an equal one. Operations on constants are evaluated here.
    fn push(&mut self, operation: Operation) -> usize {
        let operation = self.folded(operation);
        if let Some(i) = self.operations.iter().position(|o| *o == operation) {
            return i;
        }
        self.operations.push(operation);
        self.operations.len() - 1
    }

    fn folded(&self, operation: Operation) -> Operation {
        let constant = |a: usize| match self.operations[a] {
            Operation::Constant(c) => Some([c]),
            _ => None,
        };
        let mut out = [0.0];
        match operation {
            Operation::Unary(f, a) if let Some(a) = constant(a) => unary(f, &a, &mut out),
            Operation::Binary(f, a, b) if let (Some(a), Some(b)) = (constant(a), constant(b)) => {
                binary(f, &a, &b, &mut out);
            }
            _ => return operation,
        }
        Operation::Constant(out[0])
    }
}
