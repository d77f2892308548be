//! Equations: LaTeX in, MathML out.

use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser, Storage, push_mathml};

use super::ReportError;

/// An equation that can be set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Equation {
    latex: String,
    mathml: String,
}

impl Equation {
    /// An equation on a line of its own.
    ///
    /// # Errors
    /// [`ReportError::Equation`] where `latex` cannot be set.
    pub fn new(latex: impl Into<String>) -> Result<Self, ReportError> {
        let latex = latex.into();
        let mathml = mathml(&latex, DisplayMode::Block)?;
        Ok(Self { latex, mathml })
    }

    /// The equation as it was given.
    #[must_use]
    pub fn latex(&self) -> &str {
        &self.latex
    }

    /// Roughly how many letters wide it is: what is left when commands and braces are gone.
    pub(super) fn width(&self) -> usize {
        let mut width = 0;
        let mut rest = self.latex.chars().peekable();
        while let Some(letter) = rest.next() {
            match letter {
                '\\' => {
                    let mut command = String::new();
                    while let Some(next) = rest.next_if(|c| c.is_ascii_alphabetic()) {
                        command.push(next);
                    }
                    // Fonts and sizes of brackets take no room.
                    let is_silent = ["left", "right", "mathrm", "operatorname", "dot", "ddot"];
                    width += match command.as_str() {
                        // Escaped signs are seen, thin spaces are not.
                        "" => usize::from(rest.next().is_some_and(|sign| "{}_%#&$".contains(sign))),
                        silent if is_silent.contains(&silent) => 0,
                        "sin" | "cos" | "tanh" | "exp" => 3,
                        _ => 1,
                    };
                }
                '{' | '}' | '_' | '^' | ' ' | '$' => {}
                '=' | '+' | '-' => width += 2,
                _ => width += 1,
            }
        }
        width
    }

    /// A `math` element.
    #[must_use]
    pub fn mathml(&self) -> &str {
        &self.mathml
    }
}

/// An equation within a line, as a `math` element.
pub(super) fn inline(latex: &str) -> Result<String, ReportError> {
    mathml(latex, DisplayMode::Inline)
}

fn mathml(latex: &str, display_mode: DisplayMode) -> Result<String, ReportError> {
    let fault = |message: String| ReportError::Equation {
        latex: latex.to_owned(),
        message,
    };
    // Where the parser stumbles the writer would set the message in red; here it is an error.
    let storage = Storage::new();
    if let Some(error) = Parser::new(latex, &storage).find_map(Result::err) {
        return Err(fault(error.to_string()));
    }
    let storage = Storage::new();
    let config = RenderConfig {
        display_mode,
        ..RenderConfig::default()
    };
    let mut out = String::new();
    push_mathml(&mut out, Parser::new(latex, &storage), config)
        .map_err(|error| fault(error.to_string()))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_become_mathml() {
        let equation =
            Equation::new(r"M_{11} = \frac{1}{2} \ddot{y}_{1} + \sin\left(\beta_2\right)")
                .map_err(|error| error.to_string())
                .unwrap();
        let mathml = equation.mathml();
        for part in ["<math display=\"block\"", "<mfrac>", "<msub>", "β", "sin"] {
            assert!(mathml.contains(part), "no {part} in {mathml}");
        }
    }

    #[test]
    fn what_is_no_latex_is_an_error() {
        for latex in [r"\frac{1", r"\nosuchcommand", "a^b^c", "}"] {
            let error = Equation::new(latex).unwrap_err().to_string();
            assert!(error.contains(latex), "{error}");
        }
    }

    #[test]
    fn widths_count_what_is_seen() {
        let width = |latex| Equation::new(latex).map_or(0, |one| one.width());
        assert_eq!(width(r"\mathrm{moment}_{\beta,z} = 2 \, t_{5}"), 14);
        assert_eq!(width(r"\sin\left(y_{2}\right)"), 7);
    }

    #[test]
    fn markup_is_escaped() {
        let mathml = inline(r"\text{<script>} < y").map_err(|error| error.to_string());
        assert!(!mathml.unwrap().contains("<script"));
    }
}
