//! Conversion of equations from LaTeX to MathML.

use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser, Storage, push_mathml};

use super::error::ReportError;

/// An equation in LaTeX and MathML.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Equation {
    latex: String,
    mathml: String,
}

impl Equation {
    /// A displayed equation.
    ///
    /// # Errors
    /// [`ReportError::Equation`] if `latex` cannot be typeset.
    pub fn new(latex: impl Into<String>) -> Result<Self, ReportError> {
        let latex = latex.into();
        let mathml = mathml(&latex, DisplayMode::Block)?;
        Ok(Self { latex, mathml })
    }

    /// A displayed equation that is broken into lines of at most `letters` letters, so that it fits on paper. Lines are
    /// broken before signs of the outermost sum.
    ///
    /// # Errors
    /// [`ReportError::Equation`] if `latex` cannot be typeset.
    pub fn broken(latex: &str, letters: usize) -> Result<Vec<Self>, ReportError> {
        let mut lines: Vec<String> = Vec::new();
        for summand in summands(latex) {
            match lines.last_mut() {
                Some(line) if width(line) + width(summand) <= letters => line.push_str(summand),
                Some(_) => lines.push(format!("\\qquad{summand}")),
                None => lines.push(summand.to_owned()),
            }
        }
        lines.into_iter().map(Self::new).collect()
    }

    /// The equation in LaTeX.
    #[must_use]
    pub fn latex(&self) -> &str {
        &self.latex
    }

    /// Approximate width in letters, without commands and braces.
    #[must_use]
    pub fn width(&self) -> usize {
        width(&self.latex)
    }

    /// The equation as a MathML element `math`.
    #[must_use]
    pub fn mathml(&self) -> &str {
        &self.mathml
    }
}

fn width(latex: &str) -> usize {
    let mut width = 0;
    let mut rest = latex.chars().peekable();
    while let Some(letter) = rest.next() {
        match letter {
            '\\' => {
                let mut command = String::new();
                while let Some(next) = rest.next_if(|c| c.is_ascii_alphabetic()) {
                    command.push(next);
                }
                // Commands for fonts and sizes of brackets have no width.
                let is_silent = ["left", "right", "mathrm", "operatorname", "dot", "ddot"];
                width += match command.as_str() {
                    // Escaped signs have a width, thin spaces do not.
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

/// The summands of the outermost sum. Each summand except the first one begins with ` + ` or ` - `.
fn summands(latex: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0_i32, 0, Vec::new());
    for (at, letter) in latex.char_indices() {
        let rest = &latex[at..];
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            '\\' if rest.starts_with("\\left") => depth += 1,
            '\\' if rest.starts_with("\\right") => depth -= 1,
            ' ' if depth == 0 && at > 0 && (rest.starts_with(" + ") || rest.starts_with(" - ")) => {
                parts.push(&latex[start..at]);
                start = at;
            }
            _ => {}
        }
    }
    parts.push(&latex[start..]);
    parts
}

/// An inline equation as a MathML element `math`.
pub(super) fn inline(latex: &str) -> Result<String, ReportError> {
    mathml(latex, DisplayMode::Inline)
}

fn mathml(latex: &str, display_mode: DisplayMode) -> Result<String, ReportError> {
    let fault = |message: String| ReportError::Equation { latex: latex.to_owned(), message };
    // If parsing fails, the writer would print the message in red. Here the failure is an error.
    let storage = Storage::new();
    if let Some(error) = Parser::new(latex, &storage).find_map(Result::err) {
        return Err(fault(error.to_string()));
    }
    let storage = Storage::new();
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    let mut out = String::new();
    push_mathml(&mut out, Parser::new(latex, &storage), config).map_err(|error| fault(error.to_string()))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_sums_are_broken_before_their_signs() {
        let lines = |latex: &str, letters: usize| -> Vec<String> {
            let lines = Equation::broken(latex, letters).map_err(|error| error.to_string());
            lines.unwrap().iter().map(|line| line.latex().to_owned()).collect()
        };
        let sum = r"k = a_{1} + b \, \left(c - d\right) - \frac{e + f}{2} + g";
        assert_eq!(lines(sum, 100), [sum]);
        assert_eq!(
            lines(sum, 12),
            [r"k = a_{1}", r"\qquad + b \, \left(c - d\right)", r"\qquad - \frac{e + f}{2} + g"]
        );
    }

    #[test]
    fn equations_become_mathml() {
        let equation = Equation::new(r"M_{11} = \frac{1}{2} \ddot{y}_{1} + \sin\left(\beta_2\right)")
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
