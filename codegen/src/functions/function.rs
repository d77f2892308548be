//! Generated functions: programs with documentation.

pub use crate::function_names::FrameKind;
use crate::layout::Dimension;
use crate::model::Frame;
use crate::program::Program;
use crate::program::arrays::ArrayForm;
use crate::program::cost::{self, Cost};

/// A generated function: program, documentation and constants.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// Name of the function, a Rust identifier.
    pub name: String,
    /// Frame and quantity of the function; `None` for a function of the whole robot.
    pub frame: Option<FrameFunction>,
    /// First line of the function's documentation: name and symbol.
    pub summary: String,
    /// Equation of the function in Unicode.
    pub equation: String,
    /// Documentation of the input arrays, in the order of `program.inputs`.
    pub arguments: Vec<ArgumentText>,
    /// Meaning, unit and frame of each result, in the order of `program.outputs`.
    pub results: Vec<String>,
    /// Further notes of the function's documentation, for example on the derivation, limits and sources.
    pub notes: Vec<String>,
    /// Constants that are printed before the function, for example the names of its columns.
    pub constants: Vec<Constant>,
    /// The function as straight-line code.
    pub program: Program,
    /// The function as loops over joints if loops are smaller or faster; otherwise `None`. With loops,
    /// `program` has the same operations without loops.
    pub arrays: Option<ArrayForm>,
}

impl Function {
    /// Number of operations of the straight-line code.
    #[must_use]
    pub fn cost(&self) -> Cost {
        cost::count(&self.program)
    }
}

/// A function of a named frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameFunction {
    /// Identifier of the frame, as in names of functions.
    pub frame: String,
    /// Quantity of the frame that the function computes.
    pub kind: FrameKind,
}

impl FrameFunction {
    /// Creates the function of a frame for one of the frame's quantities.
    #[must_use]
    pub fn new(frame: &Frame, kind: FrameKind) -> Self {
        Self { frame: frame.identifier.clone(), kind }
    }

    /// Name of the function, for example `frame_<name>_pose`.
    #[must_use]
    pub fn name(&self) -> String {
        self.kind.function(&self.frame)
    }
}

/// Documentation of a function's argument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArgumentText {
    /// Meaning, unit and frame of the argument.
    pub meaning: String,
    /// Name and unit of each entry of the argument; empty if the entries have no names.
    pub entries: Vec<(String, &'static str)>,
}

/// A constant of a module, with name, documentation and value.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// Rust identifier, one of [`crate::functions::module_constants::NAMES`] or
    /// [`crate::module::constants::NAMES`].
    pub name: &'static str,
    /// First line of the constant's documentation.
    pub summary: String,
    /// List items of the constant's documentation; may be empty.
    pub items: Vec<String>,
    /// Value of the constant, with its type.
    pub value: ConstantValue,
}

/// Value of a constant, with its type in the module.
#[derive(Debug, Clone, PartialEq)]
pub enum ConstantValue {
    /// A count, for example of coordinates: `usize`.
    Count(usize),
    /// A hash of the robot: `u64`.
    Hash(u64),
    /// Names, for example of joints: `[&str; n]`.
    Names(Dimension, Vec<String>),
    /// Indices, for example of joints: `[usize; n]`.
    Indices(Dimension, Vec<usize>),
    /// Pairs of indices: `[[usize; 2]; n]`.
    Pairs(Vec<[usize; 2]>),
    /// Numbers with one entry per coordinate, input or other dimension: `[f64; n]`.
    Numbers(Dimension, Vec<f64>),
    /// Lowest and highest values with one pair per entry: `[[f64; 2]; n]`.
    Ranges(Dimension, Vec<[f64; 2]>),
    /// A matrix: `[[f64; columns]; n]`.
    Rows(Dimension, Vec<Vec<f64>>),
    /// The non-zero entries of a matrix with row, column and value: `[(usize, usize, f64); n]`.
    Sparse(Vec<(usize, usize, f64)>),
    /// For each entry of a matrix, whether it can be non-zero: `[[bool; columns]; rows]`.
    Pattern(Vec<Vec<bool>>),
}
