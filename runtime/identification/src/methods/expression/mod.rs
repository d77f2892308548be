//! Expressions over named channels, for example library terms such as `v*abs(v)` and `tanh(5*v)`.
//!
//! The language is that of robot descriptions ([`gelenk_formula`]), so that a text has the same meaning here as in a description.

mod arithmetic;

pub(crate) use arithmetic::sign;

use super::super::error::{IdentificationError, Result};
use arithmetic::{binary, unary};
use gelenk_formula::{Expression, Node};

/// Parses an expression over the channels `names`.
///
/// # Errors
/// [`IdentificationError::Expression`] if a text is not a valid expression, [`IdentificationError::UnknownChannel`] if it has
/// an unknown name.
pub(crate) fn parsed(text: &str, names: &[String]) -> Result<Expression> {
    let expression = Expression::parse(text).map_err(|wrong| fault(text, wrong.to_string()))?;
    values(&expression, names, &vec![&[][..]; names.len()])?;
    Ok(expression)
}

/// Returns the value of an expression at each sample.
///
/// - `channels`: samples of the channels `names`, of the same length
///
/// # Errors
/// [`IdentificationError::UnknownChannel`] if the expression has an unknown name.
pub(crate) fn values(expression: &Expression, names: &[String], channels: &[&[f64]]) -> Result<Vec<f64>> {
    let constant = |value: f64| vec![value; channels.first().map_or(0, |channel| channel.len())];
    let operand = |of: &Expression| values(of, names, channels);
    match &expression.node {
        Node::Number(value) => Ok(constant(*value)),
        Node::Truth(value) => Ok(constant(f64::from(*value))),
        Node::Name(name) => match names.iter().position(|known| known == name) {
            Some(channel) => Ok(channels[channel].to_vec()),
            None if name == "pi" => Ok(constant(std::f64::consts::PI)),
            None => Err(IdentificationError::UnknownChannel { name: name.clone(), known: names.to_vec() }),
        },
        Node::Unary(function, a) => {
            let mut a = operand(a)?;
            unary(*function, &mut a);
            Ok(a)
        }
        Node::Power(a, exponent) => Ok(operand(a)?.into_iter().map(|a| a.powi(*exponent as i32)).collect()), // at most 16
        Node::Binary(operator, operands) => {
            let [a, b] = &**operands;
            let mut a = operand(a)?;
            binary(*operator, &mut a, &operand(b)?);
            Ok(a)
        }
    }
}

pub(crate) fn fault(text: &str, message: impl Into<String>) -> IdentificationError {
    IdentificationError::Expression { text: text.into(), message: message.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gelenk_formula::Kind;

    fn names() -> Vec<String> {
        ["beta", "v"].map(String::from).to_vec()
    }

    fn value(text: &str, beta: f64, v: f64) -> f64 {
        let expression = parsed(text, &names()).unwrap();
        values(&expression, &names(), &[&[beta], &[v]]).unwrap()[0]
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
        let expression = parsed("abs(beta) < 0.1 && abs(v) > 0.05 || !(v <= 0.99)", &names()).unwrap();
        assert_eq!(expression.kind(), Kind::Truth);
        let found = values(&expression, &names(), &[&beta, &v]).unwrap();
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
        let message = |text: &str| parsed(text, &names()).unwrap_err().to_string();
        assert_eq!(message("tanh(5*w)"), "there is no channel `w`. The channels are beta, v");
        assert!(message("v^2").contains("pow(v, 2)"));
        assert!(message("tan(v)").contains("unknown function `tan`; did you mean `tanh`?"));
        assert!(message("v + (v < 1)").contains("a number is needed here, not a truth value"));
        assert!(message("v + ").starts_with("expression `v + `"));
        assert!(message("abs(v, v)").contains("takes one argument, not 2"));
    }
}
