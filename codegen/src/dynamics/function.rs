//! What a generated function is: its program and the facts of its documentation.

use crate::program::Program;

/// A function to emit.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// Rust identifier.
    pub name: String,
    /// First line of the documentation: what it is, with its symbol.
    pub summary: String,
    /// The equation in Unicode.
    pub equation: String,
    /// Meaning, unit and frame of each input array, in the order of `program.inputs`.
    pub arguments: Vec<String>,
    /// Meaning, unit and frame of each result, in the order of `program.outputs`.
    pub results: Vec<String>,
    /// Further sentences: which formulation was cheapest, limits, sources.
    pub notes: Vec<String>,
    /// The body.
    pub program: Program,
}
