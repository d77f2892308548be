//! Formulas of descriptions in LaTeX.

use crate::program::display::{latex_letters, latex_number};
use gelenk_formula::{Formula, Function};

/// Symbols of position and velocity in a formula, for example y₂ and ẏ₂. The indices differ after joints with
/// quaternions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub letter: char,
    pub position: usize,
    pub velocity: usize,
}

impl Motion {
    /// Position and velocity with the same letter and index, for example y₂ and ẏ₂.
    pub fn numbered(letter: char, number: usize) -> Self {
        Self { letter, position: number, velocity: number }
    }
}

/// A formula in LaTeX.
///
/// - `parameters`: names of the free parameters
/// - `motion`: symbols of position and velocity
pub(super) fn latex(formula: &Formula, parameters: &[String], motion: Motion) -> String {
    Printer { parameters, motion }.print(formula, Binding::Sum)
}

/// A formula in LaTeX as [`latex`] writes it, but in brackets unless it is a factor.
pub(super) fn factor(formula: &Formula, parameters: &[String], motion: Motion) -> String {
    Printer { parameters, motion }.print(formula, Binding::Product)
}

/// The sum of formulas in LaTeX.
pub(super) fn sum(formulas: &[Formula], parameters: &[String], motion: Motion) -> String {
    let summands = formulas.iter().map(|one| latex(one, parameters, motion));
    summands.reduce(|sum, summand| join(&sum, &summand)).unwrap_or_default()
}

/// How strongly a formula's operator binds. A formula that binds less strongly than its place requires gets
/// brackets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    /// The formula is a sum, or a text that begins with a sign.
    Sum,
    /// The formula is a product, a quotient or a call.
    Product,
    /// The formula is a single letter or number, for example in an exponent.
    Letter,
}

struct Printer<'a> {
    parameters: &'a [String],
    motion: Motion,
}

impl Printer<'_> {
    fn print(&self, formula: &Formula, place: Binding) -> String {
        let text = self.bare(formula);
        if binding(formula) >= place { text } else { format!("\\left({text}\\right)") }
    }

    fn bare(&self, formula: &Formula) -> String {
        let sum = |part: &Formula| self.print(part, Binding::Sum);
        let factor = |part: &Formula| self.print(part, Binding::Product);
        match formula {
            Formula::Number(value) => latex_number(*value),
            Formula::Parameter(index) => latex_letters(&self.parameters[*index]),
            Formula::Position => format!("{}_{{{}}}", self.motion.letter, self.motion.position),
            Formula::Velocity => format!("\\dot{{{}}}_{{{}}}", self.motion.letter, self.motion.velocity),
            Formula::Negate(a) => format!("-{}", factor(a)),
            Formula::Add(a, b) => join(&sum(a), &sum(b)),
            Formula::Subtract(a, b) => format!("{} - {}", sum(a), factor(b)),
            // A sign in front needs no brackets.
            Formula::Multiply(a, b) if is_negative(a) => format!("{} \\, {}", sum(a), factor(b)),
            Formula::Multiply(a, b) => format!("{} \\, {}", factor(a), factor(b)),
            Formula::Divide(a, b) => format!("\\frac{{{}}}{{{}}}", sum(a), sum(b)),
            Formula::Power(a, exponent) => {
                format!("{}^{{{exponent}}}", self.print(a, Binding::Letter))
            }
            Formula::Call(Function::Abs, a) => format!("\\left|{}\\right|", sum(a)),
            Formula::Call(Function::Sign, a) => {
                format!("\\operatorname{{sign}}\\left({}\\right)", sum(a))
            }
            Formula::Call(Function::Sqrt, a) => format!("\\sqrt{{{}}}", sum(a)),
            Formula::Call(function, a) => format!("\\{}\\left({}\\right)", function.name(), sum(a)),
        }
    }
}

/// The sum of two sums. The sign at the beginning of the second sum is kept.
fn join(a: &str, b: &str) -> String {
    match b.strip_prefix('-') {
        Some(subtracted) => format!("{a} - {subtracted}"),
        None => format!("{a} + {b}"),
    }
}

fn is_negative(formula: &Formula) -> bool {
    formula.as_number().is_some_and(f64::is_sign_negative)
}

fn binding(formula: &Formula) -> Binding {
    match formula {
        Formula::Multiply(a, _) if is_negative(a) => Binding::Sum,
        Formula::Add(..) | Formula::Subtract(..) | Formula::Negate(_) => Binding::Sum,
        Formula::Number(value) if value.is_sign_negative() => Binding::Sum,
        Formula::Number(value) if format!("{value:?}").contains('e') => Binding::Product,
        Formula::Number(_) | Formula::Parameter(_) | Formula::Position | Formula::Velocity => Binding::Letter,
        _ => Binding::Product,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_stand_where_they_are_needed() {
        let (v, a) = (|| Formula::Velocity, || Formula::Parameter(0));
        let sum = || Formula::Add(Box::new(v()), Box::new(a()));
        let negative = || Formula::Number(-2.0);
        let cases = [
            (Formula::Multiply(Box::new(a()), Box::new(sum())), r"a_{1} \, \left(\dot{y}_{2} + a_{1}\right)"),
            (Formula::Power(Box::new(sum()), 2), r"\left(\dot{y}_{2} + a_{1}\right)^{2}"),
            (Formula::Power(Box::new(v()), 3), r"\dot{y}_{2}^{3}"),
            (Formula::Add(Box::new(sum()), Box::new(negative())), r"\dot{y}_{2} + a_{1} - 2"),
            (
                Formula::Subtract(Box::new(v()), Box::new(sum())),
                r"\dot{y}_{2} - \left(\dot{y}_{2} + a_{1}\right)",
            ),
            (
                Formula::Divide(Box::new(sum()), Box::new(Formula::Number(5e-9))),
                r"\frac{\dot{y}_{2} + a_{1}}{5 \cdot 10^{-9}}",
            ),
            (Formula::Multiply(Box::new(negative()), Box::new(v())), r"-2 \, \dot{y}_{2}"),
            (
                Formula::Multiply(
                    Box::new(v()),
                    Box::new(Formula::Multiply(Box::new(negative()), Box::new(a()))),
                ),
                r"\dot{y}_{2} \, \left(-2 \, a_{1}\right)",
            ),
            (Formula::Call(Function::Abs, Box::new(v())), r"\left|\dot{y}_{2}\right|"),
        ];
        for (formula, expected) in cases {
            assert_eq!(
                latex(&formula, &["a1".to_owned()], Motion { letter: 'y', position: 9, velocity: 2 }),
                expected
            );
        }
        let product = Formula::Multiply(Box::new(negative()), Box::new(v()));
        let springs = [product.clone(), product, v()];
        assert_eq!(
            super::sum(&springs, &[], Motion { letter: 'y', position: 9, velocity: 1 }),
            r"-2 \, \dot{y}_{1} - 2 \, \dot{y}_{1} + \dot{y}_{1}"
        );
    }
}
