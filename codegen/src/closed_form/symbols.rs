//! The named constants of a closed form: letters of a formula in place of the numbers of a description.

use crate::model::Model;
use gelenk_formula::Formula;

/// A constant with its letter.
#[derive(Debug, Clone, PartialEq)]
pub struct Symbol {
    /// Letter, or the parameter's name: `m`, `c`, `I`.
    pub stem: String,
    /// Subscript: number of the coordinate and, where needed, axes: `2`, `2z`. Empty for parameters.
    pub index: String,
    /// Described value; parameters may have others.
    pub value: Formula,
    /// The meaning of the symbol, with its unit.
    pub meaning: String,
    /// Belongs to drives, gravity or friction: shown in the entries, never hidden in a lumped constant.
    pub is_visible: bool,
}

impl Symbol {
    /// The name as one word: `c2z`, or the parameter's name.
    pub fn name(&self) -> String {
        format!("{}{}", self.stem, self.index)
    }
}

/// All constants, the free parameters first.
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

    /// A letter for a value that is not zero; a name that is taken gets a prime.
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
