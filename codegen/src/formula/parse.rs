//! Reading a formula from text, with syn.
//!
//! syn descends recursively, so length, nesting and runs of operators are bounded before it sees the text.

use super::error::FormulaError;
use super::{Formula, Function, habits, too_large};
use crate::diagnostic::nearest;
use std::collections::BTreeMap;
use std::ops::Range;
use syn::spanned::Spanned;
use syn::{BinOp, Expr, UnOp};

/// Longest formula in bytes.
const LONGEST: usize = 1000;
/// Deepest nesting of brackets.
const DEEPEST: usize = 24;
/// Longest run of operators without an operand between them.
const OPERATORS: usize = 4;
/// Most operators; a sum of n terms nests n deep.
const MOST_OPERATORS: usize = 200;
/// Largest exponent.
const LARGEST_EXPONENT: u32 = 16;

/// The names that a formula may refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Allowed {
    /// Numbers and `pi`.
    Constants,
    /// Parameters too.
    Parameters,
    /// Also `y` and `v` of the joint.
    Motion,
    /// Also the distance `l` of two frames and its rate `dl`: position and velocity.
    Distance,
}

impl Allowed {
    /// The name of the position.
    fn position(self) -> Option<&'static str> {
        match self {
            Self::Constants | Self::Parameters => None,
            Self::Motion => Some("y"),
            Self::Distance => Some("l"),
        }
    }

    /// The name of the velocity.
    fn velocity(self) -> Option<&'static str> {
        match self {
            Self::Constants | Self::Parameters => None,
            Self::Motion => Some("v"),
            Self::Distance => Some("dl"),
        }
    }
}

type Parsed = Result<Formula, FormulaError>;

/// Reads a formula; `parameters` gives the index of each described name.
pub(crate) fn parse(text: &str, allowed: Allowed, parameters: &BTreeMap<String, usize>) -> Parsed {
    habits::check(text)?;
    check_text(text)?;
    let tree: Expr = syn::parse_str(text).map_err(|wrong| {
        let range = whole_if_empty(wrong.span().byte_range(), text);
        error("formula-syntax", format!("not a formula: {wrong}"), range)
    })?;
    let scope = Scope { text, allowed, parameters };
    let formula = scope.convert(&tree)?;
    let whole = 0..text.len();
    if !formula.is_finite() {
        let message = format!("`{text}` divides by zero or overflows");
        return Err(error("number-not-finite", message, whole));
    }
    if formula.is_too_large() {
        let message = too_large(&format!("`{text}`"));
        return Err(error("number-too-large", message, whole));
    }
    Ok(formula)
}

fn error(code: &'static str, message: impl Into<String>, range: Range<usize>) -> FormulaError {
    FormulaError { code, message: message.into(), help: None, range }
}

/// syn reports what is missing at the end of the text as an empty or foreign range.
fn whole_if_empty(range: Range<usize>, text: &str) -> Range<usize> {
    match text.get(range.clone()) {
        Some(part) if !part.is_empty() => range,
        _ => 0..text.len(),
    }
}

/// Bounds that keep syn's recursion shallow.
fn check_text(text: &str) -> Result<(), FormulaError> {
    let whole = || 0..text.len();
    if text.len() > LONGEST {
        let message = format!("a formula of {} bytes; {LONGEST} are the limit", text.len());
        return Err(error("formula-too-long", message, whole()));
    }
    let operators = text.matches(['+', '-', '*', '/']).count();
    if operators > MOST_OPERATORS {
        let message = format!("a formula of {operators} operators; {MOST_OPERATORS} are the limit");
        return Err(error("formula-too-long", message, whole()));
    }
    let (mut depth, mut run) = (0_usize, 0_usize);
    for (at, c) in text.char_indices() {
        let here = at..at + c.len_utf8();
        match c {
            '^' => return Err(power_help(here)),
            '(' => (depth, run) = (depth + 1, 0),
            ')' => (depth, run) = (depth.saturating_sub(1), 0),
            '+' | '-' | '*' | '/' => run += 1,
            ' ' | '\t' => {}
            '.' | ',' | '_' => run = 0,
            c if c.is_alphanumeric() => run = 0,
            c => {
                return Err(error("formula-syntax", format!("{c:?} cannot stand in a formula"), here));
            }
        }
        if depth > DEEPEST || run > OPERATORS {
            return Err(error("formula-too-deep", "brackets or signs are nested too deeply", here));
        }
    }
    Ok(())
}

fn power_help(range: Range<usize>) -> FormulaError {
    let help = Some("write `v.powi(2)` or `pow(v, 2)`".to_owned());
    FormulaError { help, ..error("formula-power", "`^` is no operator here", range) }
}

struct Scope<'a> {
    text: &'a str,
    allowed: Allowed,
    parameters: &'a BTreeMap<String, usize>,
}

impl Scope<'_> {
    fn convert(&self, tree: &Expr) -> Parsed {
        match tree {
            Expr::Lit(literal) => self.number(&literal.lit),
            Expr::Path(path) => self.name(path),
            Expr::Paren(inner) => self.convert(&inner.expr),
            Expr::Group(inner) => self.convert(&inner.expr),
            Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => {
                Ok(Formula::negation(self.convert(&unary.expr)?))
            }
            Expr::Binary(binary) => self.binary(binary),
            Expr::Call(call) => self.call(call),
            Expr::MethodCall(call) => self.method(call),
            other => Err(self.refuse(other)),
        }
    }

    fn refuse(&self, node: &impl Spanned) -> FormulaError {
        let range = whole_if_empty(node.span().byte_range(), self.text);
        let part = self.text.get(range.clone()).unwrap_or("").to_owned();
        let known = Function::ALL.map(Function::name).join(", ");
        let help = Some(format!("a formula has numbers, names, + - * /, brackets, {known} and pow(x, n)"));
        FormulaError { help, ..error("formula-syntax", format!("`{part}` cannot stand in a formula"), range) }
    }

    fn number(&self, literal: &syn::Lit) -> Parsed {
        let (digits, suffix) = match literal {
            syn::Lit::Int(value) => (value.base10_digits(), value.suffix()),
            syn::Lit::Float(value) => (value.base10_digits(), value.suffix()),
            other => return Err(self.refuse(other)),
        };
        match digits.parse::<f64>() {
            Ok(value) if value.is_finite() && suffix.is_empty() => Ok(Formula::Number(value)),
            _ => Err(self.refuse(literal)),
        }
    }

    fn name(&self, path: &syn::ExprPath) -> Parsed {
        let Some(name) = path.path.get_ident().map(ToString::to_string) else {
            return Err(self.refuse(path));
        };
        match name.as_str() {
            "pi" => return Ok(Formula::Number(std::f64::consts::PI)),
            own if self.own().contains(&own) && self.parameters.contains_key(own) => {
                return Err(self.has_two_meanings(own, path));
            }
            own if self.allowed.velocity() == Some(own) => return Ok(Formula::Velocity),
            own if self.allowed.position() == Some(own) => return Ok(Formula::Position),
            _ => {}
        }
        match self.parameters.get(&name) {
            Some(index) if self.allowed != Allowed::Constants => Ok(Formula::Parameter(*index)),
            Some(_) => Err(FormulaError {
                help: Some(
                    "angles, axes, limits and held positions are fixed when code is generated".to_owned(),
                ),
                ..error("parameter-not-allowed", format!("`{name}` is a free parameter"), self.range(path))
            }),
            None => Err(self.unknown(&name, path)),
        }
    }

    /// Names of the motion.
    fn own(&self) -> Vec<&'static str> {
        [self.allowed.velocity(), self.allowed.position()].into_iter().flatten().collect()
    }

    fn has_two_meanings(&self, name: &str, node: &impl Spanned) -> FormulaError {
        let help =
            Some("give the parameter another name: here `l` is the distance and `dl` its rate".to_owned());
        let message = format!("`{name}` is a parameter, and has a meaning of its own in this law");
        FormulaError { help, ..error("ambiguous-name", message, self.range(node)) }
    }

    fn unknown(&self, name: &str, node: &impl Spanned) -> FormulaError {
        let own = self.own().into_iter().chain(["pi"]);
        let visible = self.allowed != Allowed::Constants;
        let parameters = self.parameters.keys().map(String::as_str).filter(|_| visible);
        let known = own.chain(parameters);
        let help = nearest(name, known);
        FormulaError { help, ..error("unknown-name", format!("unknown name `{name}`"), self.range(node)) }
    }

    fn range(&self, node: &impl Spanned) -> Range<usize> {
        whole_if_empty(node.span().byte_range(), self.text)
    }

    fn binary(&self, binary: &syn::ExprBinary) -> Parsed {
        let combine = match binary.op {
            BinOp::Add(_) => Formula::sum,
            BinOp::Sub(_) => Formula::difference,
            BinOp::Mul(_) => Formula::product,
            BinOp::Div(_) => Formula::quotient,
            _ => return Err(self.refuse(binary)),
        };
        Ok(combine(self.convert(&binary.left)?, self.convert(&binary.right)?))
    }

    fn call(&self, call: &syn::ExprCall) -> Parsed {
        let name = match &*call.func {
            Expr::Path(path) => path.path.get_ident().map(ToString::to_string),
            _ => None,
        };
        let Some(name) = name else {
            return Err(self.refuse(call));
        };
        self.apply(&name, &call.func, &call.args.iter().collect::<Vec<_>>())
    }

    fn method(&self, call: &syn::ExprMethodCall) -> Parsed {
        let arguments: Vec<&Expr> = std::iter::once(&*call.receiver).chain(&call.args).collect();
        self.apply(&call.method.to_string(), &call.method, &arguments)
    }

    fn apply(&self, name: &str, place: &impl Spanned, arguments: &[&Expr]) -> Parsed {
        match (name, arguments) {
            ("pow" | "powi", [base, exponent]) => {
                Ok(Formula::power(self.convert(base)?, self.exponent(exponent)?))
            }
            (_, [argument]) => match Function::ALL.into_iter().find(|known| known.name() == name) {
                Some(function) => Ok(Formula::call(function, self.convert(argument)?)),
                None => Err(self.unknown_function(name, place)),
            },
            _ => Err(self.unknown_function(name, place)),
        }
    }

    fn unknown_function(&self, name: &str, place: &impl Spanned) -> FormulaError {
        let known = Function::ALL.map(Function::name).into_iter().chain(["pow"]);
        let (message, help) = match name {
            _ if name == "pow"
                || name == "powi"
                || Function::ALL.iter().any(|known| known.name() == name) =>
            {
                (
                    format!("wrong number of arguments for `{name}`"),
                    Some("sin(x), … take one, pow(x, n) two".to_owned()),
                )
            }
            "signum" => {
                ("`signum` is not used here".to_owned(), Some("write `sign(v)`; it is 0 at 0".to_owned()))
            }
            _ => (format!("unknown function `{name}`"), nearest(name, known)),
        };
        FormulaError { help, ..error("unknown-function", message, self.range(place)) }
    }

    fn exponent(&self, tree: &Expr) -> Result<u32, FormulaError> {
        match self.convert(tree)? {
            Formula::Number(value)
                if value.fract() == 0.0 && (0.0..=f64::from(LARGEST_EXPONENT)).contains(&value) =>
            {
                // Exact: an integer from 0 to 16.
                Ok(value as u32)
            }
            _ => {
                let message = format!("an exponent is a whole number from 0 to {LARGEST_EXPONENT}");
                let help = Some("write a reciprocal as 1/pow(x, n)".to_owned());
                Err(FormulaError { help, ..error("formula-exponent", message, self.range(tree)) })
            }
        }
    }
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

    #[test]
    fn longest_and_deepest_formulas_fit_a_small_stack() {
        let long = vec!["v"; MOST_OPERATORS + 1].join("+");
        let deep = format!("{}v{}", "sin(-(-".repeat(12), "))".repeat(12));
        let returns = "return ".repeat(140) + "v";
        let small = std::thread::Builder::new().stack_size(512 << 10);
        let thread = small.spawn(move || {
            assert!(parse(&long, Allowed::Motion, &BTreeMap::new()).is_ok());
            assert!(parse(&deep, Allowed::Motion, &BTreeMap::new()).is_ok());
            assert!(parse(&returns, Allowed::Motion, &BTreeMap::new()).is_err());
        });
        thread.unwrap().join().unwrap();
    }
}
