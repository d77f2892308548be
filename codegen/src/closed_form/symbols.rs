//! Named constants of a closed form: symbols that replace the numbers of a description.

use crate::model::Model;
use gelenk_formula::Formula;

/// A constant and its symbol.
#[derive(Debug, Clone, PartialEq)]
pub struct Symbol {
    /// Base of the name: `m`, `c`, `I`, or the name of a parameter.
    pub stem: String,
    /// Subscript: number of the coordinate, and axes if necessary: `2`, `2z`. Empty for parameters.
    pub index: String,
    /// Described value; parameters may be set to others.
    pub value: Formula,
    /// Meaning of the symbol, with its unit.
    pub meaning: String,
    /// Whether the symbol appears in the entries and never within a lumped constant: symbols of drives,
    /// gravity and friction.
    pub is_visible: bool,
}

impl Symbol {
    /// The name as one word: `c2z`, or the parameter's name.
    pub fn name(&self) -> String {
        format!("{}{}", self.stem, self.index)
    }
}

/// All constants; free parameters are first.
#[derive(Debug, Clone)]
pub(super) struct Symbols {
    pub entries: Vec<Symbol>,
}

impl Symbols {
    pub fn new(model: &Model) -> Self {
        let entry = |(index, parameter): (usize, &crate::model::Parameter)| Symbol {
            stem: parameter.name.clone(),
            index: String::new(),
            value: Formula::Parameter(index),
            meaning: meaning(&parameter.description, &parameter.unit),
            is_visible: false,
        };
        Self { entries: model.parameters.iter().enumerate().map(entry).collect() }
    }

    /// Adds a symbol for a non-zero value; appends a prime if the name is in use.
    pub fn add(&mut self, stem: &str, index: &str, value: Formula, meaning: String) -> usize {
        let mut symbol =
            Symbol { stem: stem.to_owned(), index: index.to_owned(), value, meaning, is_visible: false };
        while self.entries.iter().any(|other| other.name() == symbol.name()) {
            symbol.index.push('\'');
        }
        self.entries.push(symbol);
        self.entries.len() - 1
    }
}

fn meaning(description: &str, unit: &str) -> String {
    match (description, unit) {
        ("", "") => "free parameter".to_owned(),
        ("", unit) => format!("free parameter [{unit}]"),
        (text, "") => text.to_owned(),
        (text, unit) => format!("{text} [{unit}]"),
    }
}
