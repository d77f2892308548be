//! From the text of an expression to operations, each of which stands once.

use super::arithmetic::{Binary, Operation, Unary, binary, unary};
use super::{Kind, fault};
use crate::error::{IdentificationError, Result};
use syn::{BinOp, Expr, Lit, UnOp};

const FUNCTIONS: &str = "abs, sign (or sgn), sqrt, exp, ln, sin, cos, tanh, pow(x, n), min(x, y), max(x, y)";

/// Appends the operations of one expression to those of earlier ones.
pub(super) struct Compiler<'a> {
    pub text: &'a str,
    pub names: &'a [String],
    pub operations: &'a mut Vec<Operation>,
}

impl Compiler<'_> {
    pub fn compile(&mut self, tree: &Expr) -> Result<(usize, Kind)> {
        match tree {
            Expr::Paren(e) => self.compile(&e.expr),
            Expr::Group(e) => self.compile(&e.expr),
            Expr::Lit(e) => self.literal(&e.lit),
            Expr::Path(e) => match e.path.get_ident() {
                Some(name) => self.channel(&name.to_string()),
                None => Err(self.fault("paths are not possible, only names of channels")),
            },
            Expr::Unary(e) => self.unary(&e.op, &e.expr),
            Expr::Binary(e) => self.binary(&e.op, &e.left, &e.right),
            Expr::Call(e) => {
                let Expr::Path(path) = &*e.func else {
                    return Err(self.fault("only named functions can be called"));
                };
                let name = path.path.get_ident().map(ToString::to_string).unwrap_or_default();
                self.call(&name, &e.args.iter().collect::<Vec<_>>())
            }
            Expr::MethodCall(e) => {
                let mut arguments = vec![&*e.receiver];
                arguments.extend(&e.args);
                self.call(&e.method.to_string(), &arguments)
            }
            _ => Err(self
                .fault("only numbers, channels, + - * /, comparisons, &&, ||, ! and functions are possible")),
        }
    }

    fn fault(&self, message: impl Into<String>) -> IdentificationError {
        fault(self.text, message.into())
    }

    /// Adds an operation, or finds the same one; operations on constants are done here.
    fn push(&mut self, operation: Operation) -> usize {
        let operation = self.folded(operation);
        if let Some(i) = self.operations.iter().position(|o| *o == operation) {
            return i;
        }
        self.operations.push(operation);
        self.operations.len() - 1
    }

    fn folded(&self, operation: Operation) -> Operation {
        let constant = |a: usize| match self.operations[a] {
            Operation::Constant(c) => Some([c]),
            _ => None,
        };
        let mut out = [0.0];
        match operation {
            Operation::Unary(f, a) if let Some(a) = constant(a) => unary(f, &a, &mut out),
            Operation::Binary(f, a, b) if let (Some(a), Some(b)) = (constant(a), constant(b)) => {
                binary(f, &a, &b, &mut out);
            }
            _ => return operation,
        }
        Operation::Constant(out[0])
    }

    fn number(&mut self, tree: &Expr) -> Result<usize> {
        let (register, kind) = self.compile(tree)?;
        if kind == Kind::Number {
            return Ok(register);
        }
        Err(self.fault("a truth value stands where a number is needed"))
    }

    fn truth(&mut self, tree: &Expr) -> Result<usize> {
        let (register, kind) = self.compile(tree)?;
        if kind == Kind::Truth {
            return Ok(register);
        }
        Err(self.fault("a number stands where a truth value is needed"))
    }

    fn literal(&mut self, literal: &Lit) -> Result<(usize, Kind)> {
        let value = match literal {
            Lit::Int(l) if l.suffix().is_empty() => l.base10_digits().parse::<f64>().ok(),
            Lit::Float(l) if l.suffix().is_empty() => l.base10_digits().parse::<f64>().ok(),
            Lit::Bool(l) => {
                return Ok((self.push(Operation::Constant(f64::from(l.value))), Kind::Truth));
            }
            _ => None,
        };
        let value =
            value.filter(|v| v.is_finite()).ok_or_else(|| self.fault("a literal is not a finite number"))?;
        Ok((self.push(Operation::Constant(value)), Kind::Number))
    }

    fn channel(&mut self, name: &str) -> Result<(usize, Kind)> {
        if let Some(i) = self.names.iter().position(|n| n == name) {
            return Ok((self.push(Operation::Channel(i)), Kind::Number));
        }
        if name == "pi" {
            return Ok((self.push(Operation::Constant(std::f64::consts::PI)), Kind::Number));
        }
        Err(IdentificationError::UnknownChannel { name: name.into(), known: self.names.to_vec() })
    }

    fn unary(&mut self, op: &UnOp, tree: &Expr) -> Result<(usize, Kind)> {
        match op {
            UnOp::Neg(_) => {
                let a = self.number(tree)?;
                Ok((self.push(Operation::Unary(Unary::Negate, a)), Kind::Number))
            }
            UnOp::Not(_) => {
                let a = self.truth(tree)?;
                Ok((self.push(Operation::Unary(Unary::Not, a)), Kind::Truth))
            }
            _ => Err(self.fault("`*` before an operand is not possible")),
        }
    }

    fn binary(&mut self, op: &BinOp, left: &Expr, right: &Expr) -> Result<(usize, Kind)> {
        let (f, kind) = match op {
            BinOp::Add(_) => (Binary::Add, Kind::Number),
            BinOp::Sub(_) => (Binary::Subtract, Kind::Number),
            BinOp::Mul(_) => (Binary::Multiply, Kind::Number),
            BinOp::Div(_) => (Binary::Divide, Kind::Number),
            BinOp::Lt(_) => (Binary::Less, Kind::Truth),
            BinOp::Le(_) => (Binary::LessEqual, Kind::Truth),
            BinOp::Gt(_) => (Binary::Greater, Kind::Truth),
            BinOp::Ge(_) => (Binary::GreaterEqual, Kind::Truth),
            BinOp::Eq(_) => (Binary::Equal, Kind::Truth),
            BinOp::Ne(_) => (Binary::NotEqual, Kind::Truth),
            BinOp::And(_) => (Binary::And, Kind::Truth),
            BinOp::Or(_) => (Binary::Or, Kind::Truth),
            BinOp::BitXor(_) => return Err(self.fault("a power is written pow(x, n), not x^n")),
            _ => return Err(self.fault("this operator is not possible")),
        };
        let logical = matches!(f, Binary::And | Binary::Or);
        let (a, b) = if logical {
            (self.truth(left)?, self.truth(right)?)
        } else {
            (self.number(left)?, self.number(right)?)
        };
        Ok((self.push(Operation::Binary(f, a, b)), kind))
    }

    fn call(&mut self, name: &str, arguments: &[&Expr]) -> Result<(usize, Kind)> {
        let f = match name {
            "abs" => Unary::Abs,
            "sign" | "sgn" => Unary::Sign,
            "sqrt" => Unary::Sqrt,
            "exp" => Unary::Exp,
            "ln" => Unary::Ln,
            "sin" => Unary::Sin,
            "cos" => Unary::Cos,
            "tanh" => Unary::Tanh,
            "powi" | "pow" | "min" | "max" => return self.call_with_two(name, arguments),
            _ => {
                return Err(self.fault(format!("unknown function `{name}`; known are {FUNCTIONS}")));
            }
        };
        let [argument] = arguments else {
            return Err(self.fault(format!("`{name}` takes one argument, {} given", arguments.len())));
        };
        let a = self.number(argument)?;
        Ok((self.push(Operation::Unary(f, a)), Kind::Number))
    }

    fn call_with_two(&mut self, name: &str, arguments: &[&Expr]) -> Result<(usize, Kind)> {
        let [first, second] = arguments else {
            return Err(self.fault(format!("`{name}` takes two arguments, {} given", arguments.len())));
        };
        let a = self.number(first)?;
        let operation = match name {
            "powi" | "pow" => Operation::Power(a, self.exponent(second)?),
            "min" => Operation::Binary(Binary::Min, a, self.number(second)?),
            _ => Operation::Binary(Binary::Max, a, self.number(second)?),
        };
        Ok((self.push(operation), Kind::Number))
    }

    fn exponent(&self, tree: &Expr) -> Result<i32> {
        if let Expr::Lit(e) = tree
            && let Lit::Int(l) = &e.lit
            && let Ok(n) = l.base10_parse::<u8>()
        {
            return Ok(i32::from(n));
        }
        Err(self.fault("the exponent of powi must be a whole number from 0 to 255"))
    }
}
