//! Library Θ of candidate terms. The terms are expressions in the language of descriptions. They are evaluated on sampled
//! signals (channels), such as a velocity.

use super::super::error::{IdentificationError, Result, require_length};
use super::expression::{fault, parsed, values};
use gelenk_findings::digits::two_digits;
use gelenk_formula::{Expression, Kind};
use nalgebra::DMatrix;

/// Library of candidate terms `θᵢ`. Each term is an expression over named channels, for example a velocity `v`, a position
/// `y`, a load torque, states or inputs.
#[derive(Debug, Clone)]
pub struct Library {
    terms: Vec<String>,
    channels: Vec<String>,
    expressions: Vec<Expression>,
}

impl Library {
    /// Parses the expressions `terms`, in which the names of `channels` refer to signals.
    ///
    /// # Errors
    /// - [`IdentificationError::Empty`]: there are no terms
    /// - [`IdentificationError::Expression`]: a term occurs twice, is a truth value, or is not a valid expression
    /// - [`IdentificationError::UnknownChannel`]: a term has an unknown name
    pub fn new<S: AsRef<str>, C: AsRef<str>>(terms: &[S], channels: &[C]) -> Result<Self> {
        let terms: Vec<String> = terms.iter().map(|t| t.as_ref().to_string()).collect();
        let channels: Vec<String> = channels.iter().map(|t| t.as_ref().to_string()).collect();
        if terms.is_empty() {
            return Err(IdentificationError::Empty { what: "the list of friction terms".into() });
        }
        let expressions = terms.iter().map(|term| parsed(term, &channels)).collect::<Result<Vec<_>>>()?;
        for (i, term) in terms.iter().enumerate() {
            if expressions[i].kind() != Kind::Number {
                return Err(fault(term, "a library term must be a number, not a truth value"));
            }
            if terms[..i].contains(term) {
                return Err(fault(term, "this term occurs twice: remove one of the two"));
            }
        }
        Ok(Self { terms, channels, expressions })
    }

    /// Creates a library of common friction terms: `[1, v, sign v, tanh 5v, tanh 10v, tanh 20v, tanh 100v]`, with
    /// v in rad/s or m/s.
    ///
    /// # Errors
    /// The errors of [`Self::new`], which cannot occur because the terms are valid.
    pub fn friction() -> Result<Self> {
        Self::new(&["1", "v", "sign(v)", "tanh(5*v)", "tanh(10*v)", "tanh(20*v)", "tanh(100*v)"], &["v"])
    }

    /// Creates the library for a joint with unknown friction: the terms of [`Self::friction`], `|v|` and `|tanh 20v|`. The
    /// last two terms make friction depend on the direction.
    ///
    /// Viscous friction `a v + b |v|` has the coefficient `a + b` forwards and `a − b` backwards. Coulomb friction `a tanh
    /// 20v + b |tanh 20v|` depends on the direction in the same way. Unlike a constant, both terms are zero at rest.
    ///
    /// # Errors
    /// The errors of [`Self::new`], which cannot occur because the terms are valid.
    pub(crate) fn joint_friction() -> Result<Self> {
        let asymmetric = ["abs(v)", "abs(tanh(20*v))"].map(String::from);
        let terms: Vec<String> = Self::friction()?.terms.into_iter().chain(asymmetric).collect();
        Self::new(&terms, &["v"])
    }

    /// Creates a library with some of the terms.
    ///
    /// - `terms`: indices of these terms
    ///
    /// # Errors
    /// [`IdentificationError::Empty`] if `terms` is empty.
    pub(crate) fn only(&self, terms: &[usize]) -> Result<Self> {
        let terms: Vec<&str> = terms.iter().map(|&i| self.terms[i].as_str()).collect();
        Self::new(&terms, &self.channels)
    }

    /// Creates the library for speeds that are `scale` times as high. In terms tanh(k v), the factor k is divided by
    /// `scale`. Other terms do not change.
    ///
    /// # Errors
    /// The errors are those of [`Self::new`], for example if two factors become equal by rounding.
    pub(crate) fn scaled(&self, scale: f64) -> Result<Self> {
        if scale == 1.0 {
            return Ok(self.clone());
        }
        let terms: Vec<String> = self.terms.iter().map(|term| term_over(term, scale)).collect();
        Self::new(&terms, &self.channels)
    }

    /// Returns the terms as texts, for example `tanh(5*v)`.
    pub fn terms(&self) -> &[String] {
        &self.terms
    }

    /// Returns the names of the channels.
    pub(crate) fn channels(&self) -> &[String] {
        &self.channels
    }

    /// Returns the number of terms p.
    pub(crate) fn len(&self) -> usize {
        self.terms.len()
    }

    /// Returns the values of each term at the samples.
    ///
    /// - `channels`: samples of each channel, in the order of the library's channels
    ///
    /// # Errors
    /// [`IdentificationError::Shape`] if the number of channels is wrong or their lengths differ.
    pub(crate) fn columns(&self, channels: &[&[f64]]) -> Result<Vec<Vec<f64>>> {
        require_length("channels of the library", self.channels.len(), channels.len())?;
        for channel in channels {
            require_length("samples of a channel", channels[0].len(), channel.len())?;
        }
        self.expressions.iter().map(|term| values(term, &self.channels, channels)).collect()
    }

    /// Returns the matrix Θ of the terms' values, with one row for each sample and one column for each term.
    ///
    /// - `channels`: samples of each channel, in the order of the library's channels
    ///
    /// # Errors
    /// [`IdentificationError::Shape`] if the number of channels is wrong or their lengths differ.
    pub fn matrix(&self, channels: &[&[f64]]) -> Result<DMatrix<f64>> {
        let columns = self.columns(channels)?;
        let m = columns[0].len();
        Ok(DMatrix::from_iterator(m, columns.len(), columns.into_iter().flatten()))
    }
}

/// Returns the text of a smooth sign `tanh(k v)` of the velocity v.
pub(crate) fn smooth_sign(factor: f64) -> String {
    format!("tanh({factor}*v)")
}

/// Returns the factor k of a term tanh(k v) for a joint whose speed v is `scale` times as high. The factor is rounded to
/// two digits.
pub(crate) fn slope(factor: f64, scale: f64) -> f64 {
    if scale == 1.0 { factor } else { two_digits(factor / scale) }
}

fn term_over(term: &str, scale: f64) -> String {
    let parts = term.split_once("tanh(").and_then(|(before, rest)| {
        let (factor, after) = rest.split_once("*v)")?;
        Some(format!("{before}{}{after}", smooth_sign(slope(factor.parse().ok()?, scale))))
    });
    parts.unwrap_or_else(|| term.to_owned())
}
