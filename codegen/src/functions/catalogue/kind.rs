//! Kinds of robots (for example with prescribed motions of joints) for which functions, exports or other
//! products differ or are missing.

use super::quantity::Quantity;
use crate::functions::function::Function;
use crate::model::Model;

/// A kind of robots, for example those with prescribed motions of joints: its condition, its additional
/// functions, and the functions and products that differ or are missing.
pub struct Kind {
    /// Property of these robots, for example `driven joints`. Documentation prints it after "robots with".
    pub robots: &'static str,
    /// Code of the errors about missing functions.
    pub code: &'static str,
    /// Condition for this kind of robots in messages. `{}` is replaced by the part of the model that
    /// [`Self::example`] names.
    pub condition: &'static str,
    /// Names the part of a model that makes the model one of this kind. The name may be empty. `None` if the
    /// model is not of this kind.
    pub example: fn(&Model) -> Option<String>,
    /// Functions that only robots of this kind have.
    pub adds: &'static [Quantity],
    /// Functions that replace functions of the same names in the catalogue for robots of this kind.
    pub replaces: &'static [Quantity],
    /// Differences from the catalogue. Each entry has the names of functions and products that differ,
    /// separated by spaces, and their difference.
    pub differences: &'static [(&'static str, Difference)],
}

/// How a function or product for one kind of robot differs from its entry in the catalogue.
#[derive(Debug, Clone, Copy)]
pub enum Difference {
    /// The documentation of the function differs.
    Documented(Otherwise),
    /// The function or product is missing.
    Missing {
        /// Reason why the function is missing. It follows the condition in messages and may be empty.
        why: &'static str,
        /// Help text for the missing function; empty for a product, because a [`Product`] has its own help
        /// text.
        help: &'static str,
    },
}

/// Changes to a function's documentation in the catalogue. If a field is `None`, the text of the catalogue is
/// kept.
#[derive(Debug, Clone, Copy)]
pub struct Otherwise {
    /// Equation that replaces the function's equation in the catalogue.
    pub equation: Option<&'static str>,
    /// Meaning that replaces the meaning of the function's first result.
    pub first_result: Option<&'static str>,
    /// Note that replaces all notes of the function in the catalogue.
    pub only_note: Option<&'static str>,
    /// Notes that are added to the function's documentation.
    pub notes: &'static [&'static str],
}

/// Difference of a product that robots of a kind lack.
pub(super) const MISSING: Difference = Difference::Missing { why: "", help: "" };

/// Difference that adds notes after the notes of the function in the catalogue.
pub(super) const fn notes(notes: &'static [&'static str]) -> Difference {
    Difference::Documented(Otherwise { notes, ..Otherwise::ROW })
}

/// Difference that replaces the equation, and adds notes after the notes of the function in the catalogue.
pub(super) const fn equation(equation: &'static str, notes: &'static [&'static str]) -> Difference {
    Difference::Documented(Otherwise { equation: Some(equation), notes, ..Otherwise::ROW })
}

impl Kind {
    /// A kind of robots without additional functions and differences, as default for fields.
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

    /// Difference of a function or product for robots of this kind; `None` if it does not differ.
    pub fn difference(&self, name: &str) -> Option<&'static Difference> {
        let mut all = self.differences.iter();
        let found = all.find(|(names, _)| names.split_whitespace().any(|other| other == name));
        found.map(|(_, difference)| difference)
    }
}

impl Otherwise {
    /// Keeps the documentation of the function in the catalogue unchanged.
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

/// Something that gelenk makes from a robot, other than generated functions.
#[derive(Debug, Clone, Copy)]
pub struct Product {
    /// Name of the product in [`Kind::differences`].
    pub name: &'static str,
    /// Beginning of the message about a robot that lacks the product.
    pub(super) missing: &'static str,
    /// Help text for users whose robot lacks the product.
    pub(super) help: &'static str,
}

const fn product(name: &'static str, missing: &'static str, help: &'static str) -> Product {
    Product { name, missing, help }
}

/// The product "loops over joints": functions as loops instead of straight-line code.
pub const LOOPS: Product =
    product("loops", "loops over joints are not available", "the functions are straight-line code");

/// The product "closed forms": short equations for humans.
pub const CLOSED_FORMS: Product = product(
    "closed-forms",
    "closed forms are not available",
    "`gelenk inspect program` prints the equations with intermediate values",
);

/// The product "functions for CasADi".
pub const CASADI: Product = product(
    "casadi",
    "functions for CasADi are not available",
    "the module itself is valid for such robots: remove `--for casadi`",
);

/// The product "functions for acados".
pub const ACADOS: Product = product(
    "acados",
    "functions for acados are not available",
    "the module itself is valid for such robots: remove `--for acados`",
);

/// The product "export to URDF or MJCF".
pub const EXPORT: Product = product(
    "export",
    "the robot cannot be exported",
    "URDF and MJCF have no prescribed motions: without `motion` the joint is a coordinate",
);

/// The product "identification": identification by the library if prescribed motions of joints are not
/// measured.
pub const IDENTIFICATION: Product = product(
    "identification",
    "the robot cannot be identified",
    "read the description with `ReadOptions::free_driven`, and name these joints by `RobotChoices::unmeasured`",
);

/// All products that gelenk makes in addition to functions.
pub const PRODUCTS: [Product; 6] = [LOOPS, CLOSED_FORMS, CASADI, ACADOS, EXPORT, IDENTIFICATION];
