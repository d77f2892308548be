//! Formulas as text in the syntax of descriptions.

use super::formula::Formula;

/// Precedence of a formula's outermost operator. It decides whether the formula needs brackets inside another
/// one.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Sign,
    Atom,
}

impl Formula {
    /// Writes the formula in the syntax of descriptions. `parameters` contains the names of all free
    /// parameters.
    pub fn text(&self, parameters: &[&str]) -> String {
        self.bound(parameters, ["y", "v"]).0
    }

    /// Writes the formula of a force between two frames. The position is the distance `l` of the frames, and
    /// the velocity is its rate `dl`.
    pub fn distance_text(&self, parameters: &[&str]) -> String {
        self.bound(parameters, ["l", "dl"]).0
    }

    /// Returns the formula's text and the precedence of its outermost operator.
    ///
    /// - `motion`: names of position and velocity
    fn bound(&self, parameters: &[&str], motion: [&str; 2]) -> (String, Binding) {
        use Binding::{Atom, Product, Sign, Sum};
        let inner = |part: &Self| part.bound(parameters, motion).0;
        let at_least = |part: &Self, binding: Binding| match part.bound(parameters, motion) {
            (text, found) if found >= binding => text,
            (text, _) => format!("({text})"),
        };
        match self {
            Self::Number(value) if *value < 0.0 => (format!("{value}"), Sign),
            Self::Number(value) => (format!("{value}"), Atom),
            Self::Parameter(index) => (parameters[*index].to_owned(), Atom),
            Self::Position => (motion[0].to_owned(), Atom),
            Self::Velocity => (motion[1].to_owned(), Atom),
            Self::Negate(a) => (format!("-{}", at_least(a, Atom)), Sign),
            Self::Add(a, b) => (format!("{} + {}", at_least(a, Sum), at_least(b, Product)), Sum),
            Self::Subtract(a, b) => (format!("{} - {}", at_least(a, Sum), at_least(b, Product)), Sum),
            Self::Multiply(a, b) => (format!("{}*{}", at_least(a, Product), at_least(b, Sign)), Product),
            Self::Divide(a, b) => (format!("{}/{}", at_least(a, Product), at_least(b, Atom)), Product),
            Self::Power(a, exponent) => (format!("pow({}, {exponent})", inner(a)), Atom),
            Self::Call(function, a) => (format!("{}({})", function.name(), inner(a)), Atom),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Allowed, parse};
    use std::collections::BTreeMap;

    #[test]
    fn text_reads_back_as_the_same_formula() {
        let parameters = BTreeMap::from([("a".to_owned(), 0), ("b".to_owned(), 1)]);
        for text in [
            "tanh(5*v)",
            "exp(-(a*abs(v)))*tanh(3*a*v)",
            "-a - (b - v)",
            "a/(b*v)/v",
            "pow(tanh(100*v), 2)",
            "(a + b)*v - -v",
            "0.1*v + 200*sign(v - a)",
        ] {
            let formula = parse(text, Allowed::Motion, &parameters).unwrap();
            let again = parse(&formula.text(&["a", "b"]), Allowed::Motion, &parameters).unwrap();
            assert_eq!(again, formula, "{text}: {}", formula.text(&["a", "b"]));
        }
    }
}
