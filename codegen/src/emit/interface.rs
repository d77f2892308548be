//! Calling convention of a C module as data, for tools that write bindings.

use crate::layout::Extent;

/// Functions and parameters of a module by their names in C.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interface {
    /// Prefix of the names of functions and types, followed by `_`. Constants have the prefix in capitals.
    pub prefix: String,
    /// Field names of the free parameters, in the order of the struct.
    pub parameters: Vec<String>,
    /// Functions in the order of the module.
    pub functions: Vec<Callable>,
}

/// A function. Arguments are followed by the free parameters, if it takes them, and by the results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Callable {
    /// Name without the prefix.
    pub name: String,
    /// First line of the documentation.
    pub summary: String,
    /// Equation in Unicode; may be empty.
    pub equation: String,
    /// Arguments except the free parameters.
    pub arguments: Vec<Argument>,
    /// Results.
    pub results: Vec<Written>,
    /// Whether the function takes the free parameters; functions of positions alone do not.
    pub takes_parameters: bool,
    /// Whether the function returns its only result, a number.
    pub returns_number: bool,
    /// Name of its form over eight states, without the prefix; `None` if there is none.
    pub lanes: Option<String>,
    /// Sentence about the operations of the function.
    pub cost: String,
    /// Notes on method, limits and sources.
    pub notes: Vec<String>,
}

/// An argument of a function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Argument {
    /// Name of the argument.
    pub name: String,
    /// Lengths, outermost first; empty for a number by value.
    pub extents: Vec<Extent>,
    /// Meaning, unit and frame.
    pub meaning: String,
    /// Name and unit of each entry; empty if entries are not described one by one.
    pub entries: Vec<(String, String)>,
}

/// A result of a function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Name of the result.
    pub name: String,
    /// Symbol of the result in formulas.
    pub symbol: String,
    /// Lengths, outermost first; empty for a number.
    pub extents: Vec<Extent>,
    /// Meaning, unit and frame.
    pub meaning: String,
}

impl Argument {
    /// Whether the argument is a number by value.
    #[must_use]
    pub fn is_number(&self) -> bool {
        self.extents.is_empty()
    }
}

/// Number of entries of an array with these lengths.
#[must_use]
pub fn entries(extents: &[Extent]) -> usize {
    extents.iter().map(|extent| extent.len).product()
}
