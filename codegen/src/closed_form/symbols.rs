//! Symbols that replace the numbers of a description in closed forms.

use crate::model::Model;
use gelenk_formula::Formula;

/// A symbol that replaces a number of the description.
#[derive(Debug, Clone, PartialEq)]
pub struct Symbol {
    /// Letter of the symbol, for example `m`, `c` or `I`, or the name of a free parameter.
    pub stem: String,
    /// Subscript of the symbol: the number of the coordinate, and axes if necessary, for example `2` or `2z`.
    /// It is empty for free parameters.
    pub index: String,
    /// Value of the constant in the description. The value of a free parameter can be given to
    /// [`ClosedForms::evaluate`](super::ClosedForms::evaluate).
    pub value: Formula,
    /// Meaning of the symbol, with the unit in brackets.
    pub meaning: String,
    /// Whether the symbol is kept out of lumped constants. Symbols of drives, gravity, springs, friction and
    /// angles are kept out.
    pub is_visible: bool,
}

impl Symbol {
    /// Name of the symbol as one word, for example `c2z`, or the name of the free parameter.
    pub fn name(&self) -> String {
        format!("{}{}", self.stem, self.index)
    }
}

/// Symbols of all constants. Free parameters are first.
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

    /// Adds a symbol for a non-zero value and returns its index. If the name is in use, a prime is appended.
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
