//! A kind of robots, and how its functions differ from their rows; products other than functions.

use super::quantity::Quantity;
use crate::functions::function::Function;
use crate::model::Model;

/// A kind of robots: its condition, its own functions, and the functions and products that differ or are missing.
pub struct Kind {
    /// Property of these robots in documentation, `driven joints`.
    pub robots: &'static str,
    /// Code of errors about missing functions.
    pub code: &'static str,
    /// The condition in messages, with `{}` in place of the example.
    pub condition: &'static str,
    /// The part of a model that makes it one of this kind, may be empty; `None` if it is not.
    pub example: fn(&Model) -> Option<String>,
    /// Rows of functions that other robots lack.
    pub adds: &'static [Quantity],
    /// Rows that replace those of the same names.
    pub replaces: &'static [Quantity],
    /// Differences, each of the functions and products of some names.
    pub differences: &'static [(&'static str, Difference)],
}

/// Difference between a function of such robots and its row; without one the row holds.
#[derive(Debug, Clone, Copy)]
pub enum Difference {
    /// The function is documented otherwise.
    Documented(Otherwise),
    /// The function is missing.
    Missing {
        /// The cause after the condition, may be empty.
        why: &'static str,
        /// The remedy; empty for a product, which has its own.
        help: &'static str,
    },
}

/// Documentation in place of a row's.
#[derive(Debug, Clone, Copy)]
pub struct Otherwise {
    /// The equation in place of the row's.
    pub equation: Option<&'static str>,
    /// In place of the meaning of the first result.
    pub first_result: Option<&'static str>,
    /// In place of all notes that there are.
    pub only_note: Option<&'static str>,
    /// Additional notes.
    pub notes: &'static [&'static str],
}

/// A product that is missing.
pub(super) const MISSING: Difference = Difference::Missing { why: "", help: "" };

/// Notes after those of the row.
pub(super) const fn notes(notes: &'static [&'static str]) -> Difference {
    Difference::Documented(Otherwise { notes, ..Otherwise::ROW })
}

/// Another equation, and notes after those of the row.
pub(super) const fn equation(equation: &'static str, notes: &'static [&'static str]) -> Difference {
    Difference::Documented(Otherwise { equation: Some(equation), notes, ..Otherwise::ROW })
}

impl Kind {
    /// A kind without functions of its own.
    pub(super) const PLAIN: Self = Self {
        robots: "",
        code: "",
        condition: "",
        example: |_| None,
        adds: &[],
        replaces: &[],
        differences: &[],
    };

    /// Whether a model is of this kind.
    pub fn includes(&self, model: &Model) -> bool {
        (self.example)(model).is_some()
    }

    /// The difference of a function or product.
    pub fn difference(&self, name: &str) -> Option<&'static Difference> {
        let mut all = self.differences.iter();
        let found = all.find(|(names, _)| names.split_whitespace().any(|other| other == name));
        found.map(|(_, difference)| difference)
    }
}

impl Otherwise {
    /// The documentation of the row.
    pub(super) const ROW: Self = Self { equation: None, first_result: None, only_note: None, notes: &[] };

    /// Changes the documentation of a function.
    pub(in crate::functions) fn describe(&self, function: &mut Function) {
        if let Some(equation) = self.equation {
            equation.clone_into(&mut function.equation);
        }
        if let (Some(meaning), Some(first)) = (self.first_result, function.results.first_mut()) {
            meaning.clone_into(first);
        }
        if let Some(note) = self.only_note {
            function.notes = vec![note.to_owned()];
        }
        for note in self.notes {
            // Several kinds may have the same note.
            if !function.notes.iter().any(|known| known == note) {
                function.notes.push((*note).to_owned());
            }
        }
    }
}

/// A product of a robot other than its functions.
#[derive(Debug, Clone, Copy)]
pub struct Product {
    /// Its name in the table.
    pub name: &'static str,
    /// The beginning of the sentence about a robot without it.
    pub(super) missing: &'static str,
    /// The remedy.
    pub(super) help: &'static str,
}

const fn product(name: &'static str, missing: &'static str, help: &'static str) -> Product {
    Product { name, missing, help }
}

/// Functions as loops over joints.
pub const LOOPS: Product =
    product("loops", "there are no loops over joints", "the functions are straight-line code");

/// Formulas for people.
pub const CLOSED_FORMS: Product = product(
    "closed-forms",
    "there are no closed forms",
    "`gelenk inspect program` shows the equations with their abbreviations",
);

/// Functions for CasADi.
pub const CASADI: Product = product(
    "casadi",
    "there are no functions for CasADi",
    "the module itself holds for such robots: leave out `--for casadi`",
);

/// Functions for acados.
pub const ACADOS: Product = product(
    "acados",
    "there are no functions for acados",
    "the module itself holds for such robots: leave out `--for acados`",
);

/// Descriptions in other formats.
pub const EXPORT: Product = product(
    "export",
    "a robot is not exported",
    "neither format prescribes motions: without `motion` the joint is a coordinate",
);

/// Identification by the library, without the measured motion of driven joints.
pub const IDENTIFICATION: Product = product(
    "identification",
    "robots are not identified",
    "read the description with `ReadOptions::free_driven`, and name these joints by `RobotChoices::unmeasured`",
);

/// All products.
pub const PRODUCTS: [Product; 6] = [LOOPS, CLOSED_FORMS, CASADI, ACADOS, EXPORT, IDENTIFICATION];
