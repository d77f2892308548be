//! Expressions over named channels: library terms (`v*abs(v)`, `tanh(5*v)`) and selections
//! (`abs(beta) < 0.1 && abs(v) > 0.05`).
//!
//! The text is parsed as a Rust expression, so precedence is Rust's and the same text means the same in a
//! robot description. Several expressions compile into one [`Program`] that shares common parts and works on
//! blocks of samples, one loop per operation.

use super::error::{IdentificationError, Result, require_length};
use super::kernel::{BLOCK, exp_block, sin_block, tanh_block};
use multiversion::multiversion;
use syn::{BinOp, Expr, Lit, UnOp};

/// Whether an expression yields a number or a truth value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// True (1) or false (0).
    Truth,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Operation {
    Constant(f64),
    Channel(usize),
    Unary(Unary, usize),
    Power(usize, i32),
    Binary(Binary, usize, usize),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Unary {
    Negate,
    Not,
    Abs,
    Sign,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tanh,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Or,
    Min,
    Max,
}

const FUNCTIONS: &str = "abs, sign (or sgn), sqrt, exp, ln, sin, cos, tanh, pow(x, n), min(x, y), max(x, y)";

/// Several expressions over the same channels, ready to be evaluated.
#[derive(Debug, Clone)]
pub struct Program {
    channels: usize,
    operations: Vec<Operation>,
    results: Vec<(usize, Kind)>,
}

/// Intermediate values of a [`Program`]: allocated once, reused for every block.
#[derive(Debug, Clone)]
pub struct Workspace {
    registers: Vec<f64>,
}

impl Program {
    /// Parses and compiles `texts` over the channels `names`.
    ///
    /// # Errors
    /// [`IdentificationError::Expression`] or [`IdentificationError::UnknownChannel`]
    pub fn new<S: AsRef<str>>(texts: &[S], names: &[String]) -> Result<Self> {
        let mut program = Self { channels: names.len(), operations: Vec::new(), results: Vec::new() };
        for text in texts {
            let text = text.as_ref();
            let tree: Expr = syn::parse_str(text).map_err(|e| fault(text, e.to_string()))?;
            let mut compiler = Compiler { text, names, operations: &mut program.operations };
            let result = compiler.compile(&tree)?;
            program.results.push(result);
        }
        Ok(program)
    }

    /// Number of expressions.
    pub fn len(&self) -> usize {
        self.results.len()
    }

    /// Whether there is no expression.
    pub fn is_empty(&self) -> bool {
        self.results.is_empty()
    }

    /// Number or truth value, of expression `index`.
    pub fn kind(&self, index: usize) -> Option<Kind> {
        self.results.get(index).map(|r| r.1)
    }

    /// Buffers for [`Self::evaluate`], with the constants in place.
    pub fn workspace(&self) -> Workspace {
        let mut registers = vec![0.0; self.operations.len() * BLOCK];
        for (register, operation) in registers.chunks_exact_mut(BLOCK).zip(&self.operations) {
            if let Operation::Constant(c) = operation {
                register.fill(*c);
            }
        }
        Workspace { registers }
    }

    /// Evaluates one block; `channels` hold at most 256 samples each. Values: [`Workspace::result`].
    pub(crate) fn block(&self, channels: &[&[f64]], workspace: &mut Workspace) {
        let n = channels.first().map_or(1, |c| c.len()).min(BLOCK);
        for (i, operation) in self.operations.iter().enumerate() {
            let (earlier, rest) = workspace.registers.split_at_mut(i * BLOCK);
            let argument = |a: usize| &earlier[a * BLOCK..a * BLOCK + n];
            let out = &mut rest[..n];
            match *operation {
                Operation::Constant(_) => {}
                Operation::Channel(c) => out.copy_from_slice(&channels[c][..n]),
                Operation::Unary(f, a) => unary(f, argument(a), out),
                Operation::Power(a, exponent) => power(argument(a), exponent, out),
                Operation::Binary(f, a, b) => binary(f, argument(a), argument(b), out),
            }
        }
    }

    /// Values of expression `index` after [`Self::block`], the first `n` samples.
    pub(crate) fn result<'w>(&self, index: usize, n: usize, workspace: &'w Workspace) -> &'w [f64] {
        let register = self.results[index].0;
        &workspace.registers[register * BLOCK..register * BLOCK + n]
    }

    /// Values at one sample, without allocation: `out[i]` is expression i.
    ///
    /// # Errors
    /// [`IdentificationError::Shape`] if `channels` or `out` have the wrong length.
    pub fn evaluate(&self, channels: &[f64], workspace: &mut Workspace, out: &mut [f64]) -> Result<()> {
        require_length("values of the channels", self.channels, channels.len())?;
        require_length("results of the expressions", self.len(), out.len())?;
        for (i, operation) in self.operations.iter().enumerate() {
            let (earlier, rest) = workspace.registers.split_at_mut(i * BLOCK);
            let argument = |a: usize| &earlier[a * BLOCK..=a * BLOCK];
            let out = &mut rest[..1];
            match *operation {
                Operation::Constant(_) => {}
                Operation::Channel(c) => out[0] = channels[c],
                Operation::Unary(f, a) => unary(f, argument(a), out),
                Operation::Power(a, exponent) => power(argument(a), exponent, out),
                Operation::Binary(f, a, b) => binary(f, argument(a), argument(b), out),
            }
        }
        for (out, &(register, _)) in out.iter_mut().zip(&self.results) {
            *out = workspace.registers[register * BLOCK];
        }
        Ok(())
    }

    /// Values of all expressions at all samples, one vector per expression.
    ///
    /// # Errors
    /// [`IdentificationError::Shape`] if the channels disagree in number or length.
    pub fn evaluate_columns(&self, channels: &[&[f64]]) -> Result<Vec<Vec<f64>>> {
        require_length("channels of the expressions", self.channels, channels.len())?;
        let m = channels.first().map_or(0, |c| c.len());
        for channel in channels {
            require_length("samples of a channel", m, channel.len())?;
        }
        let mut workspace = self.workspace();
        let mut columns = vec![Vec::with_capacity(m); self.len()];
        for start in (0..m).step_by(BLOCK) {
            let n = BLOCK.min(m - start);
            let slices: Vec<&[f64]> = channels.iter().map(|c| &c[start..start + n]).collect();
            self.block(&slices, &mut workspace);
            for (i, column) in columns.iter_mut().enumerate() {
                column.extend_from_slice(self.result(i, n, &workspace));
            }
        }
        Ok(columns)
    }
}

/// Rows for which `text` is true.
///
/// - `names`, `channels`: the channels and their samples
/// - returns the row numbers in ascending order; a row where a used channel is NaN is not selected by a
///   comparison
///
/// # Errors
/// Faulty text, a number where a truth value is needed, or no row at all
/// ([`IdentificationError::NothingSelected`]).
pub fn select(text: &str, names: &[String], channels: &[&[f64]]) -> Result<Vec<usize>> {
    let program = Program::new(&[text], names)?;
    if program.kind(0) != Some(Kind::Truth) {
        return Err(fault(
            text,
            "a selection must be true or false; compare the number with something".into(),
        ));
    }
    let flags = program.evaluate_columns(channels)?.remove(0);
    let rows: Vec<usize> = (0..flags.len()).filter(|&i| flags[i] == 1.0).collect();
    if rows.is_empty() {
        return Err(IdentificationError::NothingSelected { selection: text.into(), samples: flags.len() });
    }
    Ok(rows)
}

fn fault(text: &str, message: String) -> IdentificationError {
    IdentificationError::Expression { text: text.into(), message }
}

struct Compiler<'a> {
    text: &'a str,
    names: &'a [String],
    operations: &'a mut Vec<Operation>,
}

impl Compiler<'_> {
    fn compile(&mut self, tree: &Expr) -> Result<(usize, Kind)> {
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

fn power(a: &[f64], exponent: i32, out: &mut [f64]) {
    for (o, a) in out.iter_mut().zip(a) {
        *o = a.powi(exponent);
    }
}

/// −1, 0 or 1; NaN stays NaN.
pub(crate) fn sign(x: f64) -> f64 {
    if x == 0.0 || x.is_nan() { x } else { x.signum() }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
fn unary(f: Unary, a: &[f64], out: &mut [f64]) {
    let map = |f: fn(f64) -> f64, out: &mut [f64]| {
        for (o, a) in out.iter_mut().zip(a) {
            *o = f(*a);
        }
    };
    match f {
        Unary::Negate => map(|a| -a, out),
        Unary::Not => map(|a| 1.0 - a, out),
        Unary::Abs => map(f64::abs, out),
        Unary::Sign => map(sign, out),
        Unary::Sqrt => map(f64::sqrt, out),
        Unary::Exp => exp_block(a, out),
        Unary::Ln => map(f64::ln, out),
        Unary::Sin => sin_block(a, out),
        Unary::Cos => map(f64::cos, out),
        Unary::Tanh => tanh_block(a, out),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
fn binary(f: Binary, a: &[f64], b: &[f64], out: &mut [f64]) {
    #[inline(always)]
    fn map(a: &[f64], b: &[f64], out: &mut [f64], f: impl Fn(f64, f64) -> f64) {
        for ((o, a), b) in out.iter_mut().zip(a).zip(b) {
            *o = f(*a, *b);
        }
    }
    fn truth(flag: bool) -> f64 {
        f64::from(u8::from(flag))
    }
    match f {
        Binary::Add => map(a, b, out, |a, b| a + b),
        Binary::Subtract => map(a, b, out, |a, b| a - b),
        Binary::Multiply | Binary::And => map(a, b, out, |a, b| a * b),
        Binary::Divide => map(a, b, out, |a, b| a / b),
        Binary::Less => map(a, b, out, |a, b| truth(a < b)),
        Binary::LessEqual => map(a, b, out, |a, b| truth(a <= b)),
        Binary::Greater => map(a, b, out, |a, b| truth(a > b)),
        Binary::GreaterEqual => map(a, b, out, |a, b| truth(a >= b)),
        Binary::Equal => map(a, b, out, |a, b| truth(a == b)),
        Binary::NotEqual => map(a, b, out, |a, b| truth(a != b)),
        Binary::Or | Binary::Max => map(a, b, out, larger),
        Binary::Min => map(a, b, out, |a, b| -larger(-a, -b)),
    }
}

/// The larger of two numbers; NaN if one is NaN, so that it is never hidden.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Vec<String> {
        ["beta", "v"].map(String::from).to_vec()
    }

    fn value(text: &str, beta: f64, v: f64) -> f64 {
        let program = Program::new(&[text], &names()).unwrap();
        let mut out = [0.0];
        program.evaluate(&[beta, v], &mut program.workspace(), &mut out).unwrap();
        out[0]
    }

    #[test]
    fn values_follow_the_standard_library() {
        let (b, v) = (0.3_f64, -1.7_f64);
        let expected = 2.0 * v - (5.0 * v).tanh() / (1.0 + (-v.abs()).exp()) + v.powi(3) * (b + 0.5).sqrt();
        let got = value("2*v - tanh(5*v)/(1 + exp(-abs(v))) + v.powi(3)*sqrt(beta + 0.5)", b, v);
        assert!((got - expected).abs() < 1e-13);
        assert_eq!(value("sgn(v)*max(beta, 2) - min(v, beta)", b, v), -2.0 + 1.7);
        assert_eq!(value("sign(0)", b, v), 0.0);
        assert!(
            (value("cos(pi*beta) + sin(v) + ln(2)", b, v)
                - ((b * std::f64::consts::PI).cos() + v.sin() + 2f64.ln()))
            .abs()
                < 1e-14
        );
    }

    #[test]
    fn selections_follow_rust_precedence() {
        let beta: Vec<f64> = (0..1000).map(|i| f64::from(i) * 1e-3 - 0.5).collect();
        let v: Vec<f64> = beta.iter().map(|b| (20.0 * b).sin()).collect();
        let rows =
            select("abs(beta) < 0.1 && abs(v) > 0.05 || !(v <= 0.99)", &names(), &[&beta, &v]).unwrap();
        let expected: Vec<usize> =
            (0..1000).filter(|&i| beta[i].abs() < 0.1 && v[i].abs() > 0.05 || v[i] > 0.99).collect();
        assert_eq!(rows, expected);
    }

    #[test]
    fn unknown_numbers_are_not_selected_and_not_hidden() {
        let (nan, one) = ([f64::NAN, 1.0], [1.0, 1.0]);
        assert_eq!(select("v < 2", &names(), &[&one, &nan]).unwrap(), vec![1]);
        assert!(
            value("max(v, beta)", 1.0, f64::NAN).is_nan() && value("min(v, beta)", f64::NAN, 0.0).is_nan()
        );
    }

    #[test]
    fn faults_are_named() {
        let message = |text: &str| Program::new(&[text], &names()).unwrap_err().to_string();
        assert_eq!(message("tanh(5*w)"), "there is no channel `w`; known are beta, v");
        assert!(message("v^2").contains("pow(x, n)"));
        assert!(message("tan(v)").contains("unknown function `tan`; known are abs"));
        assert!(message("v + (v < 1)").contains("a truth value stands where a number is needed"));
        assert!(message("v + ").starts_with("expression `v + `"));
        assert!(message("abs(v, v)").contains("takes one argument, 2 given"));
        assert!(select("v", &names(), &[&[1.0], &[1.0]]).unwrap_err().to_string().contains("true or false"));
        let nothing = select("v > 3", &names(), &[&[1.0], &[1.0]]).unwrap_err().to_string();
        assert_eq!(nothing, "the selection `v > 3` keeps none of 1 rows");
    }
}
