//! Cost of a program: its number of operations, counted as in the robotics literature.

use core::fmt;

use super::{Operation, Program};
use gelenk_findings::counted;
use gelenk_formula::Function;

/// Operation counts of a program.
///
/// A subtraction counts as an addition. `x * x` and `2 * x` count as one multiplication. A fused multiply-add
/// counts as one multiplication and one addition. A negation does not count. Absolute value and sign are
/// counted as selections and not as function calls, because they are a bit mask and a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cost {
    /// Number of multiplications.
    pub multiplications: usize,
    /// Number of additions and subtractions.
    pub additions: usize,
    /// Number of divisions.
    pub divisions: usize,
    /// Number of calls that compute the sine and cosine of one angle.
    pub sin_cos: usize,
    /// Number of calls of other functions: single sine or cosine, tanh, exp, square root.
    pub other_calls: usize,
    /// Number of absolute values and signs, which need a bit mask or a comparison.
    pub selections: usize,
}

impl Cost {
    /// Number of all function calls.
    #[must_use]
    pub fn calls(&self) -> usize {
        self.sin_cos + self.other_calls
    }
}

impl core::ops::Add for Cost {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            multiplications: self.multiplications + other.multiplications,
            additions: self.additions + other.additions,
            divisions: self.divisions + other.divisions,
            sin_cos: self.sin_cos + other.sin_cos,
            other_calls: self.other_calls + other.other_calls,
            selections: self.selections + other.selections,
        }
    }
}

impl core::ops::Mul<usize> for Cost {
    type Output = Self;

    fn mul(self, times: usize) -> Self {
        Self {
            multiplications: self.multiplications * times,
            additions: self.additions * times,
            divisions: self.divisions * times,
            sin_cos: self.sin_cos * times,
            other_calls: self.other_calls * times,
            selections: self.selections * times,
        }
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, {}, {}, {}",
            counted(self.multiplications, "multiplication", "multiplications"),
            counted(self.additions, "addition", "additions"),
            counted(self.divisions, "division", "divisions"),
            counted(self.calls(), "function call", "function calls"),
        )?;
        if self.sin_cos > 0 && self.other_calls > 0 {
            write!(f, " ({} `sin_cos`, {} other)", self.sin_cos, self.other_calls)?;
        } else if self.sin_cos > 0 {
            f.write_str(" (`sin_cos`)")?;
        }
        if self.selections > 0 {
            write!(f, ", {}", counted(self.selections, "selection", "selections"))?;
        }
        Ok(())
    }
}

/// Counts the operations of `program`, including operations with unused results.
#[must_use]
pub fn count(program: &Program) -> Cost {
    let mut cost = Cost::default();
    for instruction in &program.instructions {
        match instruction.operation {
            Operation::Add(..) | Operation::Subtract(..) => cost.additions += 1,
            Operation::Multiply(..) => cost.multiplications += 1,
            Operation::Divide(..) => cost.divisions += 1,
            Operation::Negate(_) | Operation::CosineOf(_) => {}
            Operation::MultiplyAdd(..) => {
                cost.multiplications += 1;
                cost.additions += 1;
            }
            Operation::SinCos(_) => cost.sin_cos += 1,
            Operation::Call(Function::Abs | Function::Sign, _) => cost.selections += 1,
            Operation::Call(..) => cost.other_calls += 1,
        }
    }
    cost
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::{Instruction, Operand};

    #[test]
    fn counts_as_papers_do() {
        let x = Operand::Input(0, 0);
        let operations = [
            Operation::SinCos(x),
            Operation::CosineOf(0),
            Operation::Multiply(x, x),
            Operation::Multiply(Operand::Constant(2.0), x),
            Operation::Subtract(x, Operand::Value(2)),
            Operation::Add(x, x),
            Operation::Negate(x),
            Operation::MultiplyAdd(x, x, x),
            Operation::Divide(x, x),
            Operation::Call(Function::Tanh, x),
            Operation::Call(Function::Sign, x),
        ];
        let instructions = operations.into_iter().enumerate();
        let program = Program {
            inputs: vec![],
            instructions: instructions
                .map(|(i, operation)| Instruction { name: format!("t{i}"), operation })
                .collect(),
            outputs: vec![],
        };
        let cost = count(&program);
        assert_eq!(
            cost,
            Cost {
                multiplications: 3,
                additions: 3,
                divisions: 1,
                sin_cos: 1,
                other_calls: 1,
                selections: 1
            }
        );
        assert_eq!(
            cost.to_string(),
            "3 multiplications, 3 additions, 1 division, 2 function calls (1 `sin_cos`, 1 other), \
             1 selection"
        );
    }
}
