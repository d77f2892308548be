//! Interpreter of programs. Its results are the reference for generated code, bit for bit.
//!
//! Interpreter and compiled function perform the same operations in the same order with the same elementary
//! functions, and each operation is rounded once. Only the sign and payload of a NaN may differ, because IEEE
//! 754 does not specify them.

use core::fmt;

use super::{Operand, Operation, Program};
use gelenk_formula::Function;
use gelenk_kernels::math;

/// Errors that prevent the interpretation of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum InterpretError {
    /// The number of input arrays is wrong: expected number, given number.
    InputCount(usize, usize),
    /// The length of an input array is wrong: name, expected length, given length.
    InputLength(String, usize, usize),
    /// The instruction with this index has an invalid operand: a later value, or an index of an entry or
    /// parameter that is out of range.
    Operand(usize),
}

impl fmt::Display for InterpretError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InputCount(expected, given) => {
                write!(f, "the program takes {expected} input arrays, but {given} are given")
            }
            Self::InputLength(name, expected, given) => {
                write!(f, "input `{name}` has {expected} entries, but {given} are given")
            }
            Self::Operand(index) => {
                write!(f, "instruction {index} reads a value that does not exist")
            }
        }
    }
}

impl core::error::Error for InterpretError {}

/// Evaluates `program`. Each result is flat and row-major.
///
/// # Errors
/// [`InterpretError`] if the inputs do not match the program or an operand does not exist.
pub fn interpret(
    program: &Program,
    inputs: &[&[f64]],
    parameters: &[f64],
) -> Result<Vec<Vec<f64>>, InterpretError> {
    check_inputs(program, inputs)?;
    let mut state =
        State { inputs, parameters, values: Vec::with_capacity(program.instructions.len()), cosines: vec![] };
    for (index, instruction) in program.instructions.iter().enumerate() {
        let value = state.evaluate(index, instruction.operation).ok_or(InterpretError::Operand(index))?;
        state.values.push(value);
    }
    let end = program.instructions.len();
    let output =
        |entries: &[Operand]| entries.iter().map(|&entry| state.read(entry)).collect::<Option<Vec<f64>>>();
    program.outputs.iter().map(|o| output(&o.entries).ok_or(InterpretError::Operand(end))).collect()
}

fn check_inputs(program: &Program, inputs: &[&[f64]]) -> Result<(), InterpretError> {
    if program.inputs.len() != inputs.len() {
        return Err(InterpretError::InputCount(program.inputs.len(), inputs.len()));
    }
    match program.inputs.iter().zip(inputs).find(|(array, given)| array.extent.len != given.len()) {
        Some((array, given)) => {
            Err(InterpretError::InputLength(array.name.clone(), array.extent.len, given.len()))
        }
        None => Ok(()),
    }
}

struct State<'a> {
    inputs: &'a [&'a [f64]],
    parameters: &'a [f64],
    values: Vec<f64>,
    /// Cosines that were computed together with a sine, each with the index of the `SinCos` instruction, in
    /// ascending order.
    cosines: Vec<(usize, f64)>,
}

impl State<'_> {
    fn read(&self, operand: Operand) -> Option<f64> {
        match operand {
            Operand::Value(index) => self.values.get(index).copied(),
            Operand::Input(array, index) => self.inputs.get(array)?.get(index).copied(),
            Operand::Parameter(index) => self.parameters.get(index).copied(),
            Operand::Constant(number) => Some(number),
        }
    }

    fn evaluate(&mut self, index: usize, operation: Operation) -> Option<f64> {
        Some(match operation {
            Operation::Add(a, b) => self.read(a)? + self.read(b)?,
            Operation::Subtract(a, b) => self.read(a)? - self.read(b)?,
            Operation::Multiply(a, b) => self.read(a)? * self.read(b)?,
            Operation::Divide(a, b) => self.read(a)? / self.read(b)?,
            Operation::Negate(a) => -self.read(a)?,
            Operation::MultiplyAdd(a, b, c) => self.read(a)?.mul_add(self.read(b)?, self.read(c)?),
            Operation::SinCos(a) => {
                let (sine, cosine) = math::sin_cos(self.read(a)?);
                self.cosines.push((index, cosine));
                sine
            }
            Operation::CosineOf(pair) => {
                let place = self.cosines.binary_search_by_key(&pair, |&(index, _)| index).ok()?;
                self.cosines[place].1
            }
            Operation::Call(function, a) => call(function, self.read(a)?),
        })
    }
}

fn call(function: Function, x: f64) -> f64 {
    match function {
        Function::Sin => math::sin_cos(x).0,
        Function::Cos => math::sin_cos(x).1,
        Function::Tanh => math::tanh(x),
        Function::Exp => math::exp(x),
        Function::Abs => x.abs(),
        Function::Sign => sign(x),
        Function::Sqrt => x.sqrt(),
    }
}

/// −1, 0 or 1. The sign is 0 for both zeros, and NaN for NaN. Emitted code contains the same lines.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}
