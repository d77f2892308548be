//! Programs: instructions with inputs, parameters and earlier values as operands.

use crate::layout::{Dimension, Extent};
use gelenk_formula::Function;

/// A straight-line program: the body of one generated function.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// Input arrays of the program, in argument order.
    pub inputs: Vec<InputArray>,
    /// Instructions in execution order. Instruction `k` defines value `k`.
    pub instructions: Vec<Instruction>,
    /// Results of the program, in order.
    pub outputs: Vec<Output>,
}

/// Largest total number of result entries that are returned by value. Larger results are written to memory of
/// the caller.
///
/// A matrix that is returned by value is stored entry by entry and then copied as vectors, and a processor
/// cannot forward such data from its store buffer. The mass matrix and bias forces of a UR5 took 119 ns if
/// returned, and 60 ns if written to memory of the caller.
const LARGEST_RETURNED: usize = 16;

impl Program {
    /// Entries of all results of the program.
    pub(crate) fn entries(&self) -> impl Iterator<Item = Operand> {
        let outputs = self.outputs.iter();
        outputs.flat_map(|output| output.entries.iter().copied())
    }

    /// A program with the same inputs and shapes of results, but without instructions. All results are zero.
    pub(crate) fn face(&self) -> Self {
        let outputs = self.outputs.iter().map(|output| Output {
            entries: vec![Operand::Constant(0.0); output.entries.len()],
            ..output.clone()
        });
        Self { inputs: self.inputs.clone(), instructions: Vec::new(), outputs: outputs.collect() }
    }

    /// Whether results are written to memory of the caller, which is faster for large results.
    pub(crate) fn has_large_results(&self) -> bool {
        self.entries().count() > LARGEST_RETURNED
    }
}

/// An input array of the function, `&[f64; len]`.
#[derive(Debug, Clone, PartialEq)]
pub struct InputArray {
    /// Argument name: `y`, `v`, `a`, `u`, …
    pub name: String,
    /// Meaning and number of the array's entries.
    pub extent: Extent,
}

/// An instruction of a program. It defines one value.
#[derive(Debug, Clone, PartialEq)]
pub struct Instruction {
    /// Name of the instruction's value: a Rust identifier, unique within the program.
    pub name: String,
    /// The operation that computes the value.
    pub operation: Operation,
}

/// An operand of an operation in a program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operand {
    /// Value of an earlier instruction, by the instruction's index.
    Value(usize),
    /// Entry of an input array: index of the array, then index of the entry.
    Input(usize, usize),
    /// Free parameter: index into `Model::parameters`.
    Parameter(usize),
    /// A finite number.
    Constant(f64),
}

/// An operation in f64 or f32 arithmetic. Its result is rounded once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operation {
    /// `a + b`
    Add(Operand, Operand),
    /// `a - b`
    Subtract(Operand, Operand),
    /// `a * b`
    Multiply(Operand, Operand),
    /// `a / b`
    Divide(Operand, Operand),
    /// `-a`
    Negate(Operand),
    /// `a * b + c` with one rounding. A program only contains this operation if fused multiply-adds are
    /// requested.
    MultiplyAdd(Operand, Operand, Operand),
    /// `sin a`. The same call computes the cosine, to which [`Operation::CosineOf`] refers by the index of
    /// this instruction.
    SinCos(Operand),
    /// The cosine computed by the [`Operation::SinCos`] at this index.
    CosineOf(usize),
    /// `f(a)` with an elementary function f, for example `tanh(a)`
    Call(Function, Operand),
}

impl Operation {
    /// The same operation with other operands. The index of a `CosineOf` is kept.
    pub(crate) fn map(self, mut change: impl FnMut(Operand) -> Operand) -> Self {
        match self {
            Self::Add(a, b) => Self::Add(change(a), change(b)),
            Self::Subtract(a, b) => Self::Subtract(change(a), change(b)),
            Self::Multiply(a, b) => Self::Multiply(change(a), change(b)),
            Self::Divide(a, b) => Self::Divide(change(a), change(b)),
            Self::Negate(a) => Self::Negate(change(a)),
            Self::MultiplyAdd(a, b, c) => Self::MultiplyAdd(change(a), change(b), change(c)),
            Self::SinCos(a) => Self::SinCos(change(a)),
            Self::CosineOf(pair) => Self::CosineOf(pair),
            Self::Call(function, a) => Self::Call(function, change(a)),
        }
    }
}

/// One result of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Name of the result for documentation.
    pub name: String,
    /// Shape of the result: number, vector or matrix.
    pub shape: Shape,
    /// Entries of the result, row-major.
    pub entries: Vec<Operand>,
}

/// Shape of a result: number, vector or matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A number: `f64`.
    Scalar,
    /// A vector: `[f64; n]`.
    Vector(Extent),
    /// A matrix: `[[f64; columns]; rows]`.
    Matrix(Extent, Extent),
}

impl Shape {
    /// The shape with these dimensions and lengths, rows first.
    ///
    /// # Panics
    /// If the number of lengths differs from the number of dimensions or exceeds two. Both are defects of a
    /// row of the catalogue.
    #[must_use]
    pub fn new(dimensions: &[Dimension], lengths: &[usize]) -> Self {
        match (dimensions, lengths) {
            ([], []) => Self::Scalar,
            (&[dimension], &[len]) => Self::Vector(Extent::new(dimension, len)),
            (&[row, column], &[rows, columns]) => {
                Self::Matrix(Extent::new(row, rows), Extent::new(column, columns))
            }
            _ => unreachable!("{lengths:?} are not lengths of {dimensions:?}"),
        }
    }

    /// Lengths of a result's dimensions, rows first; empty for a number.
    #[must_use]
    pub fn extents(self) -> Vec<Extent> {
        match self {
            Self::Scalar => vec![],
            Self::Vector(len) => vec![len],
            Self::Matrix(rows, columns) => vec![rows, columns],
        }
    }
}
