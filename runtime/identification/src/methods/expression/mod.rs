//! Expressions over named channels, for example library terms such as `v*abs(v)` and `tanh(5*v)`.
//!
//! The language is that of robot descriptions ([`gelenk_formula`]), so that a text has the same meaning here as in a description.
//! Several expressions are compiled to one `Program`, which computes common parts once. It processes blocks of samples,
//! with one loop per operation.

mod arithmetic;
mod compiler;

pub(crate) use arithmetic::sign;

use super::super::error::{IdentificationError, Result, require_length};
use super::super::numeric::kernel::BLOCK;
use arithmetic::{Operation, binary, power, unary};
use compiler::Compiler;
use gelenk_formula::Expression;
pub(crate) use gelenk_formula::Kind;

/// Several compiled expressions over the same channels.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    channels: usize,
    operations: Vec<Operation>,
    results: Vec<(usize, Kind)>,
}

/// Buffers for intermediate values of compiled expressions. They are allocated once and reused for every block.
#[derive(Debug, Clone)]
pub(crate) struct Workspace {
    registers: Vec<f64>,
}

impl Program {
    /// Parses and compiles `texts` over the channels `names`.
    ///
    /// # Errors
    /// [`IdentificationError::Expression`] if a text is not a valid expression, [`IdentificationError::UnknownChannel`] if
    /// a text has an unknown name.
    pub(crate) fn new<S: AsRef<str>>(texts: &[S], names: &[String]) -> Result<Self> {
        let mut program = Self { channels: names.len(), operations: Vec::new(), results: Vec::new() };
        for text in texts {
            let text = text.as_ref();
            let expression = Expression::parse(text).map_err(|wrong| fault(text, wrong.to_string()))?;
            let mut compiler = Compiler { names, operations: &mut program.operations };
            let register = compiler.compile(&expression)?;
            program.results.push((register, expression.kind()));
        }
        Ok(program)
    }

    /// Returns the number of expressions.
    pub(crate) fn len(&self) -> usize {
        self.results.len()
    }

    /// Returns the kind of the expression `index`, number or truth value; `None` if the index is too large.
    pub(crate) fn kind(&self, index: usize) -> Option<Kind> {
        self.results.get(index).map(|r| r.1)
    }

    /// Returns buffers for [`Self::block`], which already contain the constants.
    pub(crate) fn workspace(&self) -> Workspace {
        let mut registers = vec![0.0; self.operations.len() * BLOCK];
        for (register, operation) in registers.chunks_exact_mut(BLOCK).zip(&self.operations) {
            if let Operation::Constant(c) = operation {
                register.fill(*c);
            }
        }
        Workspace { registers }
    }

    /// Evaluates one block. `channels` have at most 256 samples each. [`Self::result`] returns the values.
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

    /// Returns the values of the expression `index` after [`Self::block`], for the first `n` samples.
    pub(crate) fn result<'w>(&self, index: usize, n: usize, workspace: &'w Workspace) -> &'w [f64] {
        let register = self.results[index].0;
        &workspace.registers[register * BLOCK..register * BLOCK + n]
    }

    /// Returns the values of all expressions at all samples, one vector per expression.
    ///
    /// # Errors
    /// [`IdentificationError::Shape`] if the number of channels is wrong or their lengths differ.
    pub(crate) fn evaluate_columns(&self, channels: &[&[f64]]) -> Result<Vec<Vec<f64>>> {
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

pub(crate) fn fault(text: &str, message: impl Into<String>) -> IdentificationError {
    IdentificationError::Expression { text: text.into(), message: message.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Vec<String> {
        ["beta", "v"].map(String::from).to_vec()
    }

    fn value(text: &str, beta: f64, v: f64) -> f64 {
        let program = Program::new(&[text], &names()).unwrap();
        program.evaluate_columns(&[&[beta], &[v]]).unwrap()[0][0]
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
    fn truth_values_follow_rust_precedence() {
        let beta: Vec<f64> = (0..1000).map(|i| f64::from(i) * 1e-3 - 0.5).collect();
        let v: Vec<f64> = beta.iter().map(|b| (20.0 * b).sin()).collect();
        let program = Program::new(&["abs(beta) < 0.1 && abs(v) > 0.05 || !(v <= 0.99)"], &names()).unwrap();
        assert_eq!(program.kind(0), Some(Kind::Truth));
        let found = program.evaluate_columns(&[&beta, &v]).unwrap().remove(0);
        for (i, found) in found.into_iter().enumerate() {
            let expected = beta[i].abs() < 0.1 && v[i].abs() > 0.05 || v[i] > 0.99;
            assert_eq!(found, f64::from(expected));
        }
    }

    #[test]
    fn unknown_numbers_compare_false_and_are_not_hidden() {
        assert_eq!(value("v < 2", 1.0, f64::NAN), 0.0);
        assert!(
            value("max(v, beta)", 1.0, f64::NAN).is_nan() && value("min(v, beta)", f64::NAN, 0.0).is_nan()
        );
    }

    #[test]
    fn faults_are_named() {
        let message = |text: &str| Program::new(&[text], &names()).unwrap_err().to_string();
        assert_eq!(message("tanh(5*w)"), "there is no channel `w`. The channels are beta, v");
        assert!(message("v^2").contains("pow(v, 2)"));
        assert!(message("tan(v)").contains("unknown function `tan`; did you mean `tanh`?"));
        assert!(message("v + (v < 1)").contains("a number is needed here, not a truth value"));
        assert!(message("v + ").starts_with("expression `v + `"));
        assert!(message("abs(v, v)").contains("takes one argument, not 2"));
    }
}
