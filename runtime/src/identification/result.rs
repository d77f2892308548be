//! Identified friction as a table, as TOML for the generator, with units, data hash and settings.

use super::error::{IdentificationError, Result};
use std::fmt::Write;

/// One term of a friction law with what is known about its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionTerm {
    /// Expression in the joint's velocity `v`.
    pub basis: String,
    /// Factor [N·m times the inverse unit of the basis].
    pub coefficient: f64,
    /// Standard error, where known.
    pub standard_error: Option<f64>,
    /// Share of bootstrap draws with this term, where known.
    pub inclusion: Option<f64>,
}

/// The friction law of one joint and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionResult {
    /// Name of the joint in the description.
    pub joint: String,
    /// Unit of the torque, `N*m` or `N`.
    pub unit: String,
    /// Terms that were chosen.
    pub terms: Vec<FrictionTerm>,
    /// Samples used.
    pub samples: usize,
    /// Range of the velocities in the data; outside the law is extrapolated.
    pub velocity_range: [f64; 2],
    /// Residual rms.
    pub residual: f64,
    /// `1 − RSS/Σ τ²`.
    pub r_squared: f64,
    /// File name and SHA-256 of the data.
    pub data: String,
    /// Settings in words: method, λ with its convention, selection, differentiation.
    pub settings: Vec<String>,
    /// Doubts.
    pub warnings: Vec<String>,
}

impl FrictionResult {
    /// Value of the law is Σ coefficient · basis; here as one line of text.
    pub fn formula(&self) -> String {
        let terms: Vec<String> = self
            .terms
            .iter()
            .map(|t| format!("{:.6}*{}", t.coefficient, t.basis))
            .collect();
        terms.join(" + ").replace("+ -", "- ")
    }

    /// A table for people.
    pub fn table(&self) -> String {
        let mut text = String::new();
        let width = self
            .terms
            .iter()
            .map(|t| t.basis.chars().count())
            .max()
            .unwrap_or(4)
            .max(4);
        let number = |x: Option<f64>| x.map_or_else(|| "-".into(), |x| format!("{x:.6}"));
        let _ = writeln!(
            text,
            "friction of {} [{}], {} samples, {:.4} to {:.4} rad/s",
            self.joint, self.unit, self.samples, self.velocity_range[0], self.velocity_range[1]
        );
        let _ = writeln!(
            text,
            "{:<width$}  {:>14}  {:>12}  {:>9}",
            "term", "coefficient", "std. error", "inclusion"
        );
        for t in &self.terms {
            let inclusion = t
                .inclusion
                .map_or_else(|| "-".into(), |x| format!("{:.0} %", 100.0 * x));
            let _ = writeln!(
                text,
                "{:<width$}  {:>14.6}  {:>12}  {inclusion:>9}",
                t.basis,
                t.coefficient,
                number(t.standard_error)
            );
        }
        let _ = writeln!(
            text,
            "residual {:.6} {} rms, R² {:.5}",
            self.residual, self.unit, self.r_squared
        );
        for warning in &self.warnings {
            let _ = writeln!(text, "warning: {warning}");
        }
        text
    }
}

/// Friction of several joints as TOML for the generator, with its origin in comments.
///
/// # Errors
/// No terms, or a coefficient that is not finite: it would end as silent nonsense in generated code.
pub fn friction_toml(results: &[FrictionResult]) -> Result<String> {
    let mut text = String::new();
    for result in results {
        if result.terms.is_empty() {
            return Err(IdentificationError::Empty {
                what: format!("the friction law of {}", result.joint),
            });
        }
        for (row, t) in result.terms.iter().enumerate() {
            if !t.coefficient.is_finite() {
                return Err(IdentificationError::NotFinite {
                    what: format!("the coefficient of {} of joint {}", t.basis, result.joint),
                    row,
                    value: t.coefficient,
                    count: 1,
                    samples: result.terms.len(),
                });
            }
        }
        comments(result, &mut text);
        joint_toml(result, &mut text);
        text.push('\n');
    }
    Ok(text)
}

/// The keys that the generator reads; the one place that knows them.
fn joint_toml(result: &FrictionResult, text: &mut String) {
    let terms: Vec<String> = result
        .terms
        .iter()
        .map(|t| format!("[{}, {:?}]", quoted(&t.basis), t.coefficient))
        .collect();
    let _ = writeln!(text, "[[friction]]");
    let _ = writeln!(text, "joint = {}", quoted(&result.joint));
    let _ = writeln!(text, "terms = [{}]", terms.join(", "));
}

fn comments(result: &FrictionResult, text: &mut String) {
    let mut line = |content: String| {
        // A newline in a name or setting must not end the comment.
        let _ = writeln!(text, "# {}", content.replace(|c: char| c.is_control(), " "));
    };
    line(format!(
        "identified from {}, {} samples",
        result.data, result.samples
    ));
    line(format!(
        "velocities {:.6} to {:.6} rad/s; torque in {}",
        result.velocity_range[0], result.velocity_range[1], result.unit
    ));
    line(format!(
        "residual {:.6} {} rms, R² {:.6}",
        result.residual, result.unit, result.r_squared
    ));
    result.settings.iter().for_each(|s| line(s.clone()));
    result
        .warnings
        .iter()
        .for_each(|w| line(format!("warning: {w}")));
}

/// A TOML basic string.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) fn example() -> FrictionResult {
        let term = |basis: &str, coefficient| FrictionTerm {
            basis: basis.into(),
            coefficient,
            standard_error: Some(0.01),
            inclusion: Some(0.985),
        };
        FrictionResult {
            joint: "beta \"2\"".into(),
            unit: "N*m".into(),
            terms: vec![term("v", 76.556), term("tanh(5*v)", -3.924e-7)],
            samples: 3000,
            velocity_range: [-0.7, 0.71],
            residual: 0.1234,
            r_squared: 0.998,
            data: "run.csv (sha256 00ff)".into(),
            settings: vec!["λ = 0.01 in 1/(2N)‖·‖² + λ‖·‖₁".into(), "two\nlines".into()],
            warnings: vec![],
        }
    }

    #[test]
    fn toml_is_read_back_unchanged() {
        let text = friction_toml(&[example()]).unwrap();
        let table: toml::Table = toml::from_str(&text).unwrap();
        let friction = &table["friction"][0];
        assert_eq!(friction["joint"].as_str(), Some("beta \"2\""));
        assert_eq!(friction["terms"][0][0].as_str(), Some("v"));
        assert_eq!(friction["terms"][1][1].as_float(), Some(-3.924e-7));
        assert!(text.contains("# two lines\n") && text.contains("sha256 00ff"));
        let mut bad = example();
        bad.terms[1].coefficient = f64::NAN;
        let message = friction_toml(&[bad]).unwrap_err().to_string();
        assert!(
            message
                .contains("the coefficient of tanh(5*v) of joint beta \"2\" is not finite (NaN)")
        );
    }

    #[test]
    fn the_table_names_units_and_numbers() {
        let table = example().table();
        assert!(
            table.contains("friction of beta \"2\" [N*m], 3000 samples, -0.7000 to 0.7100 rad/s")
        );
        assert!(table.lines().nth(2).unwrap().ends_with("98 %"), "{table}");
        assert_eq!(example().formula(), "76.556000*v - 0.000000*tanh(5*v)");
    }
}
