//! Signatures and documentation of a C module as data, for tools that generate bindings.

use crate::layout::Extent;

/// Functions and free parameters of a module, with their names in C.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interface {
    /// Prefix of the names of functions and types in C, without the `_` that follows it. Constants have the
    /// prefix in capitals.
    pub prefix: String,
    /// Names of the free parameters, in the order of the struct's fields.
    pub parameters: Vec<String>,
    /// Functions in the order in which the module defines them.
    pub functions: Vec<Callable>,
}

/// A function. In C, its arguments are followed by the free parameters if the function takes them, then by
/// the results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Callable {
    /// Name of the function without the prefix of the module.
    pub name: String,
    /// First line of the function's documentation.
    pub summary: String,
    /// Equation of the function in Unicode; may be empty.
    pub equation: String,
    /// Arguments of the function, without the free parameters and results.
    pub arguments: Vec<Argument>,
    /// Results of the function, with names, shapes and meanings.
    pub results: Vec<Written>,
    /// Whether the function takes the free parameters. Functions that only take positions do not take them.
    pub takes_parameters: bool,
    /// Whether the only result is a number that the function returns.
    pub returns_number: bool,
    /// Name of the function for eight states at once, without the prefix; `None` if there is no such
    /// function.
    pub lanes: Option<String>,
    /// Sentence about the number of operations of the function.
    pub cost: String,
    /// Notes on method, limits and sources of the function.
    pub notes: Vec<String>,
}

/// An argument of a C function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Argument {
    /// Name of the argument in C.
    pub name: String,
    /// Lengths of the array, outermost first; empty for a number that is passed by value.
    pub extents: Vec<Extent>,
    /// Meaning of the argument, with unit and frame.
    pub meaning: String,
    /// Name and unit of each entry of the argument; empty if the entries have no separate names.
    pub entries: Vec<(String, String)>,
}

/// A result of a C function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Name of the result in C.
    pub name: String,
    /// Symbol of the result in formulas, for example `∂ÿ/∂y`.
    pub symbol: String,
    /// Lengths of the array, outermost first; empty for a number.
    pub extents: Vec<Extent>,
    /// Meaning of the result, with unit and frame.
    pub meaning: String,
}

impl Argument {
    /// Whether the argument is a number that is passed by value.
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
