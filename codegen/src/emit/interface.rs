//! Calling convention of a module in C as a plain value, for tools that write bindings.

use crate::layout::Extent;

/// The functions and parameters of a module by their names in C.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interface {
    /// Prefix of the names of functions and types, followed by `_`; constants have it in capitals.
    pub prefix: String,
    /// Field names of the free parameters, in the order of the struct.
    pub parameters: Vec<String>,
    /// All functions, in the order of the module.
    pub functions: Vec<Callable>,
}

/// A function: its arguments, then the free parameters where it takes them, then its results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Callable {
    /// Its name without the beginning.
    pub name: String,
    /// First line of the documentation.
    pub summary: String,
    /// The equation in Unicode, may be empty.
    pub equation: String,
    /// Arguments except the free parameters.
    pub arguments: Vec<Argument>,
    /// Results.
    pub results: Vec<Written>,
    /// It is true if it takes the free parameters; functions of positions alone do not.
    pub takes_parameters: bool,
    /// It is true if its only result is a number, which it returns.
    pub returns_number: bool,
    /// Its form over eight states, without the beginning of its name; none if it has none.
    pub lanes: Option<String>,
    /// The sentence about its operations.
    pub cost: String,
    /// Method, limits, sources.
    pub notes: Vec<String>,
}

/// An argument of a function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Argument {
    /// Its name.
    pub name: String,
    /// Its lengths, outermost first; none for a number by value.
    pub extents: Vec<Extent>,
    /// Meaning, unit and frame.
    pub meaning: String,
    /// Name and unit of each entry; empty if these are not told one by one.
    pub entries: Vec<(String, String)>,
}

/// A result of a function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Its name.
    pub name: String,
    /// Its symbol in formulas.
    pub symbol: String,
    /// Its lengths, outermost first; none for a number.
    pub extents: Vec<Extent>,
    /// Meaning, unit and frame.
    pub meaning: String,
}

impl Argument {
    /// It is true for a number by value.
    #[must_use]
    pub fn is_number(&self) -> bool {
        self.extents.is_empty()
    }
}

/// The number of entries of an array with these lengths.
#[must_use]
pub fn entries(extents: &[Extent]) -> usize {
    extents.iter().map(|extent| extent.len).product()
}
