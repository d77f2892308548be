//! Converts expressions to formulas: resolves names, and rejects functions that are not available in generated
//! code.

use super::error::FormulaError;
use super::expression::{Expression, Kind, Node, Operator, Unary};
use super::formula::{Formula, too_large};
use super::nearest::nearest;
use super::syntax::known_functions;
use std::collections::BTreeMap;
use std::ops::Range;

/// Names that a formula may contain, in addition to names of functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Allowed {
    /// Numbers and `pi`.
    Constants,
    /// Parameters and constants, but no position or velocity.
    Parameters,
    /// Parameters and the joint's velocity `v`.
    Velocity,
    /// Parameters, and the joint's position `y` and velocity `v`.
    Motion,
    /// Parameters, the distance `l` of two frames, and its rate `dl`.
    Distance,
}

impl Allowed {
    /// The name of the position in the formula, `y` or `l`; `None` if the formula may not contain it.
    fn position(self) -> Option<&'static str> {
        match self {
            Self::Constants | Self::Parameters | Self::Velocity => None,
            Self::Motion => Some("y"),
            Self::Distance => Some("l"),
        }
    }

    /// The name of the velocity in the formula, `v` or `dl`; `None` if the formula may not contain it.
    fn velocity(self) -> Option<&'static str> {
        match self {
            Self::Constants | Self::Parameters => None,
            Self::Velocity | Self::Motion => Some("v"),
            Self::Distance => Some("dl"),
        }
    }
}

type Parsed = Result<Formula, FormulaError>;

/// Reads a formula. `parameters` maps each parameter name to its index.
///
/// Returns an error if the text
///
/// - is not an [`Expression`], or is a truth value
/// - contains a name that is not allowed
/// - calls a function that is not available in generated code
/// - divides by zero or overflows
pub fn parse(text: &str, allowed: Allowed, parameters: &BTreeMap<String, usize>) -> Parsed {
    let expression = Expression::parse(text)?;
    let whole = 0..text.len();
    if expression.kind() == Kind::Truth {
        let message = format!("`{text}` is a truth value, not a number");
        let help = "comparisons only select rows of a log; write a number or a force law in a description"
            .to_owned();
        return Err(FormulaError::new("formula-kind", message, whole).with_help(help));
    }
    let formula = Scope { allowed, parameters }.formula(&expression)?;
    if !formula.is_finite() {
        let message = format!("`{text}` divides by zero or overflows");
        return Err(FormulaError::new("number-not-finite", message, whole));
    }
    if formula.is_too_large() {
        return Err(FormulaError::new("number-too-large", too_large(&format!("`{text}`")), whole));
    }
    Ok(formula)
}

struct Scope<'a> {
    allowed: Allowed,
    parameters: &'a BTreeMap<String, usize>,
}

impl Scope<'_> {
    fn formula(&self, expression: &Expression) -> Parsed {
        let place = || expression.range.clone();
        match &expression.node {
            Node::Number(value) => Ok(Formula::Number(*value)),
            Node::Name(name) => self.name(name, place()),
            Node::Unary(Unary::Negate, a) => Ok(Formula::negation(self.formula(a)?)),
            Node::Unary(Unary::Call(function), a) => Ok(Formula::call(*function, self.formula(a)?)),
            Node::Unary(Unary::Logarithm, _) => Err(not_generated("ln", place())),
            Node::Power(a, exponent) => Ok(Formula::power(self.formula(a)?, *exponent)),
            Node::Binary(operator, operands) => {
                let combine = match operator {
                    Operator::Add => Formula::sum,
                    Operator::Subtract => Formula::difference,
                    Operator::Multiply => Formula::product,
                    Operator::Divide => Formula::quotient,
                    Operator::Min => return Err(not_generated("min", place())),
                    Operator::Max => return Err(not_generated("max", place())),
                    _ => return Err(no_number(place())),
                };
                let [a, b] = &**operands;
                Ok(combine(self.formula(a)?, self.formula(b)?))
            }
            Node::Truth(_) | Node::Unary(Unary::Not, _) => Err(no_number(place())),
        }
    }

    fn name(&self, name: &str, place: Range<usize>) -> Parsed {
        match name {
            "pi" => return Ok(Formula::Number(std::f64::consts::PI)),
            own if self.own().any(|known| known == own) && self.parameters.contains_key(own) => {
                return Err(has_two_meanings(own, place));
            }
            own if self.allowed.velocity() == Some(own) => return Ok(Formula::Velocity),
            own if self.allowed.position() == Some(own) => return Ok(Formula::Position),
            _ => {}
        }
        match self.parameters.get(name) {
            Some(index) if self.allowed != Allowed::Constants => Ok(Formula::Parameter(*index)),
            Some(_) => {
                let message = format!("`{name}` is a free parameter");
                let help = "angles, axes, limits and held positions are fixed at code generation and cannot \
                            depend on free parameters";
                Err(FormulaError::new("parameter-not-allowed", message, place).with_help(help.to_owned()))
            }
            None => Err(self.unknown(name, place)),
        }
    }

    /// Names of velocity and position that the formula may contain.
    fn own(&self) -> impl Iterator<Item = &'static str> + use<> {
        [self.allowed.velocity(), self.allowed.position()].into_iter().flatten()
    }

    fn unknown(&self, name: &str, place: Range<usize>) -> FormulaError {
        let visible = self.allowed != Allowed::Constants;
        let parameters = self.parameters.keys().filter(|_| visible);
        let mut known: Vec<&str> = self.own().chain(["pi"]).collect();
        known.extend(parameters.map(String::as_str));
        // `v` and `y` are the names at a joint. This law depends on a distance instead.
        let is_distance = self.allowed.position() == Some("l");
        let help = match name {
            "v" if is_distance => Some("did you mean `dl`, the rate of the distance?".to_owned()),
            "y" if is_distance => Some("did you mean `l`, the distance?".to_owned()),
            "t" | "time" if self.own().next().is_some() => Some(timeless(self.own())),
            _ => nearest(name, known),
        };
        FormulaError::new("unknown-name", format!("unknown name `{name}`"), place).with_help(help)
    }
}

fn has_two_meanings(name: &str, place: Range<usize>) -> FormulaError {
    let help = "rename the parameter: in this law `l` is the distance and `dl` its rate".to_owned();
    let message = format!("the parameter `{name}` has the name of a variable of this law");
    FormulaError::new("ambiguous-name", message, place).with_help(help)
}

/// Help for a force law that contains the time.
fn timeless(own: impl Iterator<Item = &'static str>) -> String {
    let own: Vec<String> = own.map(|name| format!("`{name}`")).collect();
    format!(
        "a law depends on {} and parameters, not on time; for a force that changes with time use an input, \
         or a factor under `[parameters]` that your program changes",
        own.join(", ")
    )
}

fn not_generated(function: &str, place: Range<usize>) -> FormulaError {
    let message = format!("the function `{function}` is not available in descriptions");
    let help = format!("formulas may call {}", known_functions());
    FormulaError::new("unknown-function", message, place).with_help(help)
}

fn no_number(place: Range<usize>) -> FormulaError {
    FormulaError::new("formula-kind", "a number is needed here, not a truth value", place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> BTreeMap<String, usize> {
        ["a1", "a2", "a3"].into_iter().enumerate().map(|(k, name)| (name.to_owned(), k)).collect()
    }

    fn value(text: &str) -> f64 {
        let formula = parse(text, Allowed::Motion, &names()).unwrap();
        formula.evaluate(&[2.0, 3.0, 0.5], 0.25, -1.5)
    }

    #[test]
    fn values_are_those_of_rust() {
        let (a1, a2, a3, y, v) = (2.0_f64, 3.0_f64, 0.5_f64, 0.25_f64, -1.5_f64);
        assert_eq!(value("a1*v + a2*tanh(a3*v)"), a1 * v + a2 * (a3 * v).tanh());
        assert_eq!(value("-v.powi(2)"), -(v.powi(2)));
        assert_eq!(value("a1 - y - v"), a1 - y - v);
        assert_eq!(value("a1/y/v"), a1 / y / v);
        assert_eq!(value("exp(-a3*abs(v))*sign(v)"), -(-a3 * v.abs()).exp());
        assert_eq!(
            value("-(y + 1)*cos(pi/3) + v.sin()"),
            -(y + 1.0) * (std::f64::consts::PI / 3.0).cos() + v.sin()
        );
        assert_eq!(value("26.45*0.0254"), 26.45 * 0.0254);
        assert_eq!(value("pow(v, 3) + v.powi(0)"), v.powi(3) + 1.0);
    }

    /// A law with a position lacks the time; elsewhere `t` is an unknown name.
    #[test]
    fn laws_over_time_are_refused_with_the_reason() {
        let message = |text: &str, allowed| parse(text, allowed, &names()).unwrap_err().to_string();
        for (text, allowed, own) in [
            ("sin(3*t)*v", Allowed::Motion, "`v`, `y`"),
            ("a1*time", Allowed::Velocity, "`v`"),
            ("100*(l - 0.1*t)", Allowed::Distance, "`dl`, `l`"),
        ] {
            let message = message(text, allowed);
            assert!(
                message.contains(&format!("a law depends on {own} and parameters, not on time")),
                "{message}"
            );
        }
        assert!(!message("2*t", Allowed::Parameters).contains("not on time"));
    }

    #[test]
    fn constants_fold() {
        let half_pi = parse("pi/2", Allowed::Constants, &names()).unwrap();
        assert_eq!(half_pi, Formula::Number(std::f64::consts::FRAC_PI_2));
        assert_eq!(parse("0*v + 1*a1", Allowed::Motion, &names()).unwrap(), Formula::Parameter(0));
    }

    #[test]
    fn laws_split_into_linear_terms() {
        let law = parse("-a1*v + 2*a2*tanh(a3*v)/4 - (3 - v*y)", Allowed::Motion, &names()).unwrap();
        let terms = law.clone().linear_terms();
        assert_eq!(terms.len(), 4);
        assert!(terms.iter().all(|(coefficient, _)| !coefficient.depends_on_motion()));
        let p = [2.0, 3.0, 0.5];
        let sum: f64 =
            terms.iter().map(|(c, b)| c.evaluate(&p, 0.25, -1.5) * b.evaluate(&p, 0.25, -1.5)).sum();
        assert!((sum - law.evaluate(&p, 0.25, -1.5)).abs() < 1e-15);
    }

    /// Syntax that only selections and libraries have is refused with its reason and its place.
    #[test]
    fn the_language_of_selections_is_refused() {
        let message = |text: &str| parse(text, Allowed::Motion, &names()).unwrap_err().to_string();
        assert!(message("v < 1 && true").starts_with("`v < 1 && true` is a truth value, not a number"));
        assert!(message("v + max(v, 1)").starts_with("the function `max` is not available in descriptions"));
        assert!(message("v + (v < 1)").contains("a number is needed here, not a truth value"));
        assert!(message("|v|").contains("write |v| as `abs(v)`"));
        assert!(message("v & y").contains("`&&` is an operator of selections"));
        assert_eq!(parse("a1*ln(v)", Allowed::Motion, &names()).unwrap_err().range, 3..8);
        assert_eq!(parse("sgn(v)", Allowed::Motion, &names()), parse("sign(v)", Allowed::Motion, &names()));
    }
}
