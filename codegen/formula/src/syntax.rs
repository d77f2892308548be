//! Parser of expressions, based on syn. Operators have the same precedence as in Rust.
//!
//! syn is a recursive-descent parser. Therefore the length of the text, the nesting of brackets and the number
//! of consecutive operators are limited before syn is called.

use super::error::FormulaError;
use super::expression::{Expression, Kind, Node, Operator, Unary};
use super::function::Function;
use super::habits;
use super::nearest::nearest;
use std::ops::Range;
use syn::spanned::Spanned;
use syn::{BinOp, Expr, Ident, UnOp};

/// Length of the longest accepted text, in bytes.
const LONGEST: usize = 1000;
/// Deepest accepted nesting of brackets.
const DEEPEST: usize = 24;
/// Largest number of consecutive operators without an operand between them.
const OPERATORS: usize = 4;
/// Largest accepted number of operators. It limits the depth of the tree, because a sum of n terms is nested
/// n deep.
const MOST_OPERATORS: usize = 200;
/// Largest accepted exponent of a power.
const LARGEST_EXPONENT: u32 = 16;
/// Characters that form operators.
const SIGNS: [char; 10] = ['+', '-', '*', '/', '<', '>', '=', '!', '&', '|'];

type Parsed<T = Expression> = Result<T, FormulaError>;

impl Expression {
    /// Reads an expression.
    ///
    /// Returns an error if the text
    ///
    /// - is not an expression
    /// - is too long or too deeply nested
    /// - calls an unknown function
    /// - contains a truth value instead of a number, or a number instead of a truth value
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        habits::check(text)?;
        check_text(text)?;
        let tree: Expr = syn::parse_str(text).map_err(|wrong| {
            let range = whole_if_empty(wrong.span().byte_range(), text);
            FormulaError::new("formula-syntax", format!("this text is not a formula: {wrong}"), range)
        })?;
        Reader { text }.expression(&tree)
    }
}

/// If something is missing at the end of the text, syn reports an empty or invalid range. The whole text is
/// then returned as the range.
fn whole_if_empty(range: Range<usize>, text: &str) -> Range<usize> {
    match text.get(range.clone()) {
        Some(part) if !part.is_empty() => range,
        _ => 0..text.len(),
    }
}

/// Checks limits that keep syn's recursion shallow.
fn check_text(text: &str) -> Parsed<()> {
    let too_long = |what: String| Err(FormulaError::new("formula-too-long", what, 0..text.len()));
    if text.len() > LONGEST {
        return too_long(format!("the formula has {} bytes; the limit is {LONGEST}", text.len()));
    }
    let operators = text.matches(SIGNS).count();
    if operators > MOST_OPERATORS {
        return too_long(format!("the formula has {operators} operators; the limit is {MOST_OPERATORS}"));
    }
    let (mut depth, mut run) = (0_usize, 0_usize);
    for (at, c) in text.char_indices() {
        let here = at..at + c.len_utf8();
        match c {
            '^' | '|' | '&' => check_sign(text, here.clone())?,
            '(' => (depth, run) = (depth + 1, 0),
            ')' => (depth, run) = (depth.saturating_sub(1), 0),
            '.' | ',' | '_' => run = 0,
            c if c.is_alphanumeric() => run = 0,
            c if SIGNS.contains(&c) || matches!(c, ' ' | '\t') => {}
            c => {
                let message = format!("{c:?} is not allowed in a formula");
                return Err(FormulaError::new("formula-syntax", message, here));
            }
        }
        run += usize::from(SIGNS.contains(&c));
        if depth > DEEPEST || run > OPERATORS {
            let message = "brackets are nested more than 24 deep, or more than 4 signs follow each other";
            return Err(FormulaError::new("formula-too-deep", message, here));
        }
    }
    Ok(())
}

/// Rejects `^`, and single `|` and `&`, with an error that names the correct spelling.
fn check_sign(text: &str, range: Range<usize>) -> Parsed<()> {
    let sign = &text[range.clone()];
    let is_pair = text[range.end..].starts_with(sign) || text[..range.start].ends_with(sign);
    let (code, help) = match sign {
        "^" => ("formula-power", "write a power as `v.powi(2)` or `pow(v, 2)`"),
        _ if is_pair => return Ok(()),
        "|" => ("formula-syntax", "write |v| as `abs(v)`; `||` is an operator of selections"),
        _ => ("formula-syntax", "`&&` is an operator of selections"),
    };
    let message = format!("`{sign}` is not an operator here");
    Err(FormulaError::new(code, message, range).with_help(help.to_owned()))
}

/// List of the functions of formulas, for messages.
pub(crate) fn known_functions() -> String {
    format!("{} and pow(x, n)", Function::ALL.map(Function::name).join(", "))
}

struct Reader<'a> {
    text: &'a str,
}

impl Reader<'_> {
    fn expression(&self, tree: &Expr) -> Parsed {
        let node = match tree {
            Expr::Paren(inner) => return self.expression(&inner.expr),
            Expr::Group(inner) => return self.expression(&inner.expr),
            Expr::Lit(literal) => self.literal(&literal.lit)?,
            Expr::Path(path) => {
                Node::Name(path.path.get_ident().ok_or_else(|| self.refuse(path))?.to_string())
            }
            Expr::Unary(unary) => match unary.op {
                UnOp::Neg(_) => self.unary(Unary::Negate, &unary.expr)?,
                UnOp::Not(_) => self.unary(Unary::Not, &unary.expr)?,
                _ => return Err(self.refuse(unary)),
            },
            Expr::Binary(binary) => {
                let operator = operator(&binary.op).ok_or_else(|| self.refuse(binary))?;
                self.binary(operator, &binary.left, &binary.right)?
            }
            Expr::Call(call) => {
                let name = if let Expr::Path(path) = &*call.func { path.path.get_ident() } else { None };
                let name = name.ok_or_else(|| self.refuse(call))?;
                self.call(name, &call.args.iter().collect::<Vec<_>>())?
            }
            Expr::MethodCall(call) => {
                let arguments: Vec<&Expr> = std::iter::once(&*call.receiver).chain(&call.args).collect();
                self.call(&call.method, &arguments)?
            }
            other => return Err(self.refuse(other)),
        };
        Ok(Expression { node, range: self.range(tree) })
    }

    fn range(&self, node: &impl Spanned) -> Range<usize> {
        whole_if_empty(node.span().byte_range(), self.text)
    }

    fn refuse(&self, node: &impl Spanned) -> FormulaError {
        let range = self.range(node);
        let message = format!("`{}` is not allowed in a formula", &self.text[range.clone()]);
        let help = format!(
            "a formula consists of numbers, names, + - * /, brackets and the functions {}",
            known_functions()
        );
        FormulaError::new("formula-syntax", message, range).with_help(help)
    }

    fn literal(&self, literal: &syn::Lit) -> Parsed<Node> {
        let (digits, suffix) = match literal {
            syn::Lit::Bool(value) => return Ok(Node::Truth(value.value)),
            syn::Lit::Int(value) => (value.base10_digits(), value.suffix()),
            syn::Lit::Float(value) => (value.base10_digits(), value.suffix()),
            other => return Err(self.refuse(other)),
        };
        match digits.parse::<f64>() {
            Ok(value) if value.is_finite() && suffix.is_empty() => Ok(Node::Number(value)),
            _ => Err(self.refuse(literal)),
        }
    }

    /// Reads an operand, and returns an error if the operand's kind (number or truth value) is not `kind`.
    fn operand(&self, kind: Kind, tree: &Expr) -> Parsed {
        let operand = self.expression(tree)?;
        if operand.kind() == kind {
            return Ok(operand);
        }
        let message = match kind {
            Kind::Number => "a number is needed here, not a truth value",
            Kind::Truth => "a truth value is needed here, not a number",
        };
        Err(FormulaError::new("formula-kind", message, operand.range))
    }

    fn unary(&self, operation: Unary, tree: &Expr) -> Parsed<Node> {
        Ok(Node::Unary(operation, Box::new(self.operand(operation.kind(), tree)?)))
    }

    fn binary(&self, operator: Operator, left: &Expr, right: &Expr) -> Parsed<Node> {
        let operand = |tree| self.operand(operator.operands(), tree);
        Ok(Node::Binary(operator, Box::new([operand(left)?, operand(right)?])))
    }

    fn call(&self, called: &Ident, arguments: &[&Expr]) -> Parsed<Node> {
        match (called.to_string().as_str(), arguments) {
            ("pow" | "powi", [base, exponent]) => {
                let base = self.operand(Kind::Number, base)?;
                Ok(Node::Power(Box::new(base), self.exponent(exponent)?))
            }
            ("min", [a, b]) => self.binary(Operator::Min, a, b),
            ("max", [a, b]) => self.binary(Operator::Max, a, b),
            (name, [argument]) if let Some(operation) = function(name) => self.unary(operation, argument),
            (name, _) => Err(unknown_function(name, arguments.len(), self.range(called))),
        }
    }

    fn exponent(&self, tree: &Expr) -> Parsed<u32> {
        let exponent = self.operand(Kind::Number, tree)?;
        match exponent.node {
            Node::Number(value)
                if value.fract() == 0.0 && (0.0..=f64::from(LARGEST_EXPONENT)).contains(&value) =>
            {
                // The conversion is exact, because the value is an integer from 0 to 16.
                Ok(value as u32)
            }
            _ => {
                let message = format!("an exponent must be a whole number from 0 to {LARGEST_EXPONENT}");
                let help = "write a negative power as 1/pow(x, n)".to_owned();
                Err(FormulaError::new("formula-exponent", message, exponent.range).with_help(help))
            }
        }
    }
}

fn operator(sign: &BinOp) -> Option<Operator> {
    Some(match sign {
        BinOp::Add(_) => Operator::Add,
        BinOp::Sub(_) => Operator::Subtract,
        BinOp::Mul(_) => Operator::Multiply,
        BinOp::Div(_) => Operator::Divide,
        BinOp::Lt(_) => Operator::Less,
        BinOp::Le(_) => Operator::LessEqual,
        BinOp::Gt(_) => Operator::Greater,
        BinOp::Ge(_) => Operator::GreaterEqual,
        BinOp::Eq(_) => Operator::Equal,
        BinOp::Ne(_) => Operator::NotEqual,
        BinOp::And(_) => Operator::And,
        BinOp::Or(_) => Operator::Or,
        _ => return None,
    })
}

fn function(name: &str) -> Option<Unary> {
    match name {
        "ln" => Some(Unary::Logarithm),
        "sgn" => Some(Unary::Call(Function::Sign)),
        _ => Function::ALL.into_iter().find(|known| known.name() == name).map(Unary::Call),
    }
}

fn unknown_function(name: &str, given: usize, range: Range<usize>) -> FormulaError {
    let (message, help) = match name {
        "pow" | "powi" | "min" | "max" => (format!("`{name}` takes two arguments, not {given}"), None),
        _ if function(name).is_some() => (format!("`{name}` takes one argument, not {given}"), None),
        "signum" => (
            "`signum` is not a function of formulas".to_owned(),
            Some("write `sign(v)`, which is 0 at v = 0".to_owned()),
        ),
        _ => {
            let known = Function::ALL.map(Function::name).into_iter().chain(["pow"]);
            (format!("unknown function `{name}`"), nearest(name, known))
        }
    };
    FormulaError::new("unknown-function", message, range).with_help(help)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Allowed, parse};
    use std::collections::BTreeMap;

    #[test]
    fn longest_and_deepest_formulas_fit_a_small_stack() {
        let long = vec!["v"; MOST_OPERATORS + 1].join("+");
        let deep = format!("{}v{}", "sin(-(-".repeat(12), "))".repeat(12));
        let choices = vec!["v"; MOST_OPERATORS / 2 + 1].join("||");
        let assignments = vec!["v"; MOST_OPERATORS + 1].join("=");
        let returns = "return ".repeat(140) + "v";
        let small = std::thread::Builder::new().stack_size(512 << 10);
        let thread = small.spawn(move || {
            assert!(parse(&long, Allowed::Motion, &BTreeMap::new()).is_ok());
            assert!(parse(&deep, Allowed::Motion, &BTreeMap::new()).is_ok());
            assert!(Expression::parse(&choices).is_err());
            assert!(Expression::parse(&choices.replace('v', "true")).is_ok());
            assert!(Expression::parse(&assignments).is_err());
            assert!(parse(&returns, Allowed::Motion, &BTreeMap::new()).is_err());
        });
        thread.unwrap().join().unwrap();
    }
}
